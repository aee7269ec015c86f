//! Feathers, fibre tables, cards and albedo as the shaders read them.
//!
//! What lives here turns assets into bytes, once per bird or edit.
//! It may not know entities, materials or passes.

mod albedo;
mod cards;
mod layout;
mod mips;
mod outlines;
mod stacks;
mod tables;

pub use albedo::{albedo_array, albedo_front, same_paint};
pub use cards::{CARD_VEC4S, MAX_REGIONS, pack_cards};
pub use layout::{FEATHER_STRIDE, HEADER_LENGTH, header};
pub use outlines::outline_array;
pub use stacks::{Layers, StackTables, find as find_stack, stack};
pub use tables::{TableCache, pack_feathers};
