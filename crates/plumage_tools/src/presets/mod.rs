//! Feathers made in code: three birds and one neutral feather per type. Only numbers of feathers live here.
//!
//! `macaw_*`, `eagle_*` and `owl_*` follow docs/book/birds.md#sources-of-the-data; the neutral ones
//! take the medians of measured birds, and four shimmer. The tool `bake_feathers` makes the files in `assets/feathers` from these.
//! The left vane is the leading, narrower one of a flight feather; grooms mirror it where needed.

mod eagle;
mod generic;
mod iridescent;
mod macaw;
mod owl;
mod profiles;
mod template;

use bevy_plumage::anatomy::Feather;

fn templates() -> impl Iterator<Item = template::Template> {
    macaw::all()
        .into_iter()
        .chain(eagle::all())
        .chain(generic::all())
        .chain(owl::all())
}

/// Every preset; its name is [`Feather::name`], its file `NAME.feather.ron`.
pub fn all() -> Vec<Feather> {
    templates()
        .map(|template| template.build())
        .chain(iridescent::all())
        .collect()
}

/// The preset of that name.
pub fn by_name(name: &str) -> Option<Feather> {
    all().into_iter().find(|feather| feather.name == name)
}

#[cfg(test)]
mod tests {
    use super::*;
    use plumage_tests::shipped;

    #[test]
    fn the_files_are_made_from_the_presets() {
        let presets = all();
        let mut made: Vec<&str> = presets
            .iter()
            .map(|feather| feather.name.as_str())
            .collect();
        let mut files = shipped::FEATHERS;
        made.sort_unstable();
        files.sort_unstable();
        assert_eq!(made, files);
        for preset in &presets {
            let file = shipped::feather(&preset.name);
            assert!(preset == &file, "{}: run make feathers", preset.name);
        }
    }
}
