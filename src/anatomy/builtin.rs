//! The two feathers that the crate itself needs, read from the files shipped with it.

use super::Feather;
use crate::asset::RonAsset;

/// A neutral contour feather: what a bird without a groom gets.
pub fn contour() -> Feather {
    let bytes = include_bytes!("../../assets/feathers/contour.feather.ron");
    Feather::from_ron(bytes, "contour").unwrap_or_default()
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
        #[cfg(any(feature = "inspector", feature = "photo"))]
        assert_eq!(primary().name, "primary");
    }
}
