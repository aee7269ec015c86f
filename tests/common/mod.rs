//! Code that the integration tests share.
#![allow(dead_code)]

pub mod app;
pub mod geometry;
pub mod gpu;
pub mod stability;
pub mod stack;
pub mod sweep;
pub mod view;
