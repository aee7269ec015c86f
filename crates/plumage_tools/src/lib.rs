//! Programs that bake assets, draw charts and preview grooms, each in `bin`; what they share is here.
//!
//! It may use the library, its references and the tests' support; nothing may use it.

pub mod judge;
pub mod plot;
pub mod presets;
