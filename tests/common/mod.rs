//! Code that the integration tests share.
#![allow(dead_code)]

pub mod gpu;
pub mod sweep;
