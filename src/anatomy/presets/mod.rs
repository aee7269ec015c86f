//! Feathers ready to wear: two birds and one neutral feather per type.
//!
//! `macaw_*` and `eagle_*` follow the tables of the bird study (feather sizes, microstructure, colours); the neutral ones
//! take the medians of measured birds. The files in `assets/feathers` are made from these by the example `bake_feathers`.
//! The left vane is the leading, narrower one of a flight feather; grooms mirror it where needed.

mod eagle;
mod generic;
mod macaw;
mod profiles;
mod template;

use super::Feather;

fn templates() -> impl Iterator<Item = template::Template> {
    macaw::all()
        .into_iter()
        .chain(eagle::all())
        .chain(generic::all())
}

/// Every preset; its name is [`Feather::name`], its file `NAME.feather.ron`.
pub fn all() -> Vec<Feather> {
    templates().map(|template| template.build()).collect()
}

/// The preset of that name.
pub fn by_name(name: &str) -> Option<Feather> {
    templates()
        .find(|template| template.name == name)
        .map(|template| template.build())
}
