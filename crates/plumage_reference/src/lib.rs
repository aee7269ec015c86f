//! Ground truth for bevy_plumage: slow references that share no code with what they judge, the methods as published, and synthetic
//! photographs. Not published, and in no game's build.
//!
//! | module | what |
//! |---|---|
//! | [`coverage`] | coverage of a footprint by dense quadrature in `f64` |
//! | [`query_published`] | the range query as printed |
//! | [`fibre_traced`] | rays through a real fibre |
//! | [`fibre_published`] | the fibre's scattering as printed |
//! | [`curves`] | a feather of explicit fibres |
//! | [`thin_film`] | thin films by recursion, their energy layer by layer |
//! | [`color_difference`] | CIEDE2000 |
//! | [`crossing`] | how far feathers poke through those that should cover them |
//! | [`visible`] | pixels that show a feather which another one should cover |
//! | [`photograph`] | synthetic photographs of feathers |
//! | [`undercoat`] | references for down and fur, and the published forms of their methods |
//!
//! It may use the library; the library may not use it.

pub mod color_difference;
pub mod coverage;
pub mod crossing;
pub mod curves;
pub mod fibre_published;
pub mod fibre_traced;
pub mod judged;
pub mod photograph;
pub mod query_published;
pub mod thin_film;
pub mod undercoat;
pub mod visible;
