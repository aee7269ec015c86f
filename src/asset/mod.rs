//! Asset files in RON: one trait, loader, saver, check and error for all of them.
//! Here lives what is the same for every kind of file; what one kind means lives in the room of its type.
//! Nothing here may know a feather or a bird, add a system to an app, or import from another room.

mod check;
mod error;
mod link;
mod load;
mod ron;

pub use error::AssetError;
pub use link::AssetLink;
pub use load::{RonLoader, RonSaver};
pub use ron::RonAsset;

pub(crate) use ron::parse;
#[cfg(feature = "inspector")]
pub(crate) use ron::write_whole;
