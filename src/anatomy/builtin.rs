//! The two feathers that the crate itself needs, read from the files shipped with it.

use super::Feather;
use crate::asset::RonAsset;

/// A neutral contour feather.
pub fn contour() -> Feather {
    let bytes = include_bytes!("../../assets/feathers/contour.feather.ron");
    Feather::from_ron(bytes, "contour").unwrap_or_default()
}

/// What a bird without a groom gets: a contour feather that is closed, and in the color of the skin, down to its base, because nobody has
/// said what lies over it.
pub fn covering() -> Feather {
    let mut feather = contour();
    feather.name = "covering".into();
    for vane in [&mut feather.left, &mut feather.right] {
        vane.downy = 0.0;
        vane.fringe = 0.03;
    }
    feather.gaps.count = 0;
    for stop in &mut feather.albedo.front.stops {
        stop.tint = 1.0;
    }
    feather
}

/// A neutral primary: what a photograph does not show is taken from it.
#[cfg(any(feature = "inspector", feature = "photo"))]
pub fn primary() -> Feather {
    let bytes = include_bytes!("../../assets/feathers/primary.feather.ron");
    Feather::from_ron(bytes, "primary").unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_files_are_read() {
        assert_eq!(contour().name, "contour");
        assert!(covering().validate("covering").is_ok());
        #[cfg(any(feature = "inspector", feature = "photo"))]
        assert_eq!(primary().name, "primary");
    }
}
