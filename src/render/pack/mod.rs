//! Feathers, fibre tables, cards and albedo as the shaders read them.
//!
//! What lives here turns assets into bytes, once per bird or edit.
//! It may not know entities, materials or passes.

mod albedo;
mod cards;
mod mips;
mod stacks;
mod tables;

pub use albedo::{albedo_array, albedo_front, same_paint};
pub use cards::{CARD_VEC4S, MAX_REGIONS, pack_cards};
pub use stacks::{Layers, StackTables, find as find_stack, stack};
pub use tables::{FEATHER_STRIDE, HEADER_LENGTH, TableCache, header, pack_feathers};
