//! Proportions of the posed birds at rest against photographs.

use super::order::groomed;
use bevy::math::Vec3;
use plumage_tests::scene_bird::SceneBird;

/// Height of a slice in which the width is measured, metres.
const SLICE: f32 = 0.01;

/// A bird at rest as a cloud of points, with the row or region of each card's points.
struct Rest {
    points: Vec<Vec3>,
    /// Of secondaries and tertials.
    inner: Vec<Vec3>,
    /// Height of the crown, of the tip of the tail, and of what the bird stands on.
    crown: f32,
    tail: f32,
    perch: f32,
}

fn rest(name: &'static str, perch: f32) -> Rest {
    let (bird, coat) = groomed(name);
    let pose = bird.skinning(Some(0.0));
    let posed = bird.pose(
        &SceneBird::vertices(coat, &pose),
        &SceneBird::carries(coat, &pose),
        &pose,
    );
    let regions = ["secondaries", "tertials"].map(|name| {
        let row = bird.groom.rows.iter().position(|row| row.name == name);
        (bird.groom.regions.len() + row.expect("a wing")) as u16
    });
    let mut inner = Vec::new();
    for (card, geometry) in coat.cards.iter().zip(&coat.geometry) {
        if regions.contains(&card.region) {
            let first = geometry.first_vertex as usize;
            inner.extend(&posed.cards[first..first + geometry.vertex_count as usize]);
        }
    }
    let mut points = posed.cards;
    points.extend(posed.body.iter().flatten());
    let heights = || points.iter().map(|p| p.y);
    Rest {
        inner,
        crown: heights().fold(f32::MIN, f32::max),
        tail: heights().fold(f32::MAX, f32::min),
        perch,
        points,
    }
}

impl Rest {
    /// The greatest width of a slice above the perch, seen from `angle` degrees off the bird's axis, without the outermost four-hundredth
    /// of the points on either side: single feathers.
    fn width(&self, angle: f32) -> f32 {
        let (sine, cosine) = angle.to_radians().sin_cos();
        let count = ((self.crown - self.perch) / SLICE) as usize;
        let mut slices = vec![Vec::new(); count + 1];
        for p in self.points.iter().filter(|p| p.y > self.perch) {
            let slice = ((p.y - self.perch) / SLICE) as usize;
            slices[slice].push(p.x * cosine - p.z * sine);
        }
        let width = |slice: &mut Vec<f32>| {
            slice.sort_by(f32::total_cmp);
            let cut = slice.len() / 400;
            match slice.len() {
                0 => 0.0,
                n => slice[n - 1 - cut] - slice[cut],
            }
        };
        slices.iter_mut().map(width).fold(0.0, f32::max)
    }
}

#[test]
fn birds_at_rest_have_the_proportions_of_photographs() {
    // Width from behind over crown to tail tip, sleek; width in three-quarter view over crown to perch.
    for (name, perch, behind, quarter) in
        [("parrot", 0.024, 0.24, 0.56), ("eagle", 0.060, 0.40, 0.67)]
    {
        let rest = rest(name, perch);
        let width = rest.width(0.0);
        let slender = width / (rest.crown - rest.tail);
        let wide = rest.width(45.0) / (rest.crown - rest.perch);
        let inner = rest.inner.iter().map(|p| p.x.abs());
        let parted = 2.0 * inner.fold(f32::MAX, f32::min) / width;
        println!(
            "{name}: behind {slender:.3}, three-quarter {wide:.3}, wings parted by {parted:.3}"
        );
        let off = |found: f32, photograph: f32| (found / photograph - 1.0).abs();
        assert!(off(slender, behind) < 0.10, "{name}: {slender}");
        assert!(off(wide, quarter) < 0.15, "{name}: {wide}");
        // The wings meet over the rump.
        assert!(parted < 0.12, "{name}: {parted}");
    }
}

#[test]
fn the_owl_has_the_measures_of_its_species() {
    let (bird, coat) = groomed("owl");
    let pose = bird.skinning(Some(0.0));
    let posed = bird.pose(
        &SceneBird::vertices(coat, &pose),
        &SceneBird::carries(coat, &pose),
        &pose,
    );
    // Points of a row's feathers on the left.
    let points = |name: &str| -> Vec<Vec3> {
        let row = bird.groom.rows.iter().position(|row| row.name == name);
        let region = (bird.groom.regions.len() + row.expect("a row")) as u16;
        let cards = coat.cards.iter().zip(&coat.geometry);
        cards
            .filter(|(card, _)| card.region == region)
            .flat_map(|(_, geometry)| {
                let first = geometry.first_vertex as usize;
                &posed.cards[first..first + geometry.vertex_count as usize]
            })
            .copied()
            .filter(|point| point.x > 0.0)
            .collect()
    };
    let furthest = |from: &[Vec3], to: &[Vec3]| {
        let pairs = from.iter().flat_map(|a| to.iter().map(|b| a.distance(*b)));
        pairs.fold(0.0, f32::max)
    };
    // From the wrist, where the primaries' coverts begin, to the tip; from the root of the tail to its end. Millimetres.
    let wing = 1000.0 * furthest(&points("primary_coverts"), &points("primaries"));
    let rectrices = points("rectrices");
    let tail = 1000.0 * furthest(&rectrices, &rectrices);
    let rest = rest("owl", 0.024);
    let inner = rest.inner.iter().map(|p| p.x.abs());
    let parted = 2.0 * inner.fold(f32::MAX, f32::min) / rest.width(0.0);
    let slender = rest.width(0.0) / (rest.crown - rest.tail);
    println!(
        "owl: wing {wing:.0}, tail {tail:.0}, behind {slender:.3}, wings parted by {parted:.3}"
    );
    assert!((268.0..296.0).contains(&wing), "{wing}");
    assert!((107.0..126.0).contains(&tail), "{tail}");
    assert!(parted < 0.12, "{parted}");
}
