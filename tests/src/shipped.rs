//! The feathers and grooms that are shipped with the library, read from its files.

use bevy_plumage::{
    anatomy::Feather, asset::RonAsset, groom::Groom, maths::scattering::interference::Iridescence,
};

/// The names of all feathers: the macaw's, the eagle's, one neutral feather of each type; then, behind those that synthetic
/// photographs show, what came later.
pub const FEATHERS: [&str; 62] = [
    "macaw_head",
    "macaw_face_line",
    "macaw_neck",
    "macaw_contour",
    "macaw_soft",
    "macaw_blue",
    "macaw_semiplume",
    "macaw_lesser",
    "macaw_greater",
    "macaw_primary",
    "macaw_secondary",
    "macaw_rectrix",
    "macaw_leg",
    "eagle_head",
    "eagle_bristle",
    "eagle_hackle",
    "eagle_contour",
    "eagle_soft",
    "eagle_semiplume",
    "eagle_lesser",
    "eagle_greater",
    "eagle_primary",
    "eagle_secondary",
    "eagle_rectrix",
    "eagle_trouser",
    "eagle_tarsal",
    "primary",
    "secondary",
    "rectrix",
    "alula",
    "greater_covert",
    "median_covert",
    "lesser_covert",
    "contour",
    "semiplume",
    "down",
    "hackle",
    "bristle",
    "filoplume",
    "eagle_body",
    "peacock_eye",
    "mallard_speculum",
    "pigeon_neck",
    "hummingbird_gorget",
    "owl_head",
    "owl_disc",
    "owl_ruff",
    "owl_mantle",
    "owl_breast",
    "owl_spot",
    "owl_soft",
    "owl_semiplume",
    "owl_lesser",
    "owl_greater",
    "owl_primary",
    "owl_secondary",
    "owl_rectrix",
    "owl_leg",
    "owl_tarsal",
    "macaw_primary_covert",
    "macaw_alula",
    "owl_covert",
];

/// How many of them synthetic photographs show: a corpus stays the same whatever feathers are added.
const PHOTOGRAPHED: usize = 39;

/// The asset in a file below `assets/`.
pub fn read<A: RonAsset>(path: &str) -> A {
    let path = crate::asset(path);
    let name = path.display().to_string();
    let bytes = std::fs::read(&path).unwrap_or_else(|error| panic!("{name}: {error}"));
    A::from_ron(&bytes, &name).unwrap_or_else(|error| panic!("{error}"))
}

/// The feather of this name.
pub fn feather(name: &str) -> Feather {
    read(&format!("feathers/{name}.feather.ron"))
}

/// All feathers, in the order of [`FEATHERS`].
pub fn feathers() -> Vec<Feather> {
    FEATHERS.into_iter().map(feather).collect()
}

/// Those of synthetic photographs, in their order.
pub fn photographed() -> Vec<Feather> {
    let mut all = feathers();
    all.truncate(PHOTOGRAPHED);
    all
}

/// The groom of this name.
pub fn groom(name: &str) -> Groom {
    read(&format!("grooms/{name}.groom.ron"))
}

/// Published stacks of thin layers, by name.
pub fn stacks() -> Vec<(String, Iridescence)> {
    let path = crate::asset("stacks.ron");
    let text = std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{error}"));
    ron::from_str(&text).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// The stack of this name.
pub fn stack(name: &str) -> Iridescence {
    let found = stacks().into_iter().find(|(known, _)| known == name);
    found.unwrap_or_else(|| panic!("no stack {name}")).1
}
