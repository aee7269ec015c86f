//! Whole pictures of an app off screen: Bevy's lights, cameras, passes, transparency, culling, wind, and the life of a bird.
//! What an edit costs, devices below the limits, debug views, and pictures of reference (`golden.rs`).
//! Needs a GPU or Mesa's lavapipe; without either it fails, unless `PLUMAGE_NO_GPU=1`.

mod accumulate;
mod bare;
mod borders;
mod cameras;
mod culling;
mod debug;
mod edge;
mod edit_cost;
mod environment;
mod far;
mod fit;
mod golden;
mod hidden;
mod life_cycle;
mod lights;
mod limits;
mod lists;
mod near;
mod order;
mod passes;
mod picture;
mod transparency;
mod vertex_light;
mod weather;
mod wind;
mod wind_motion;
mod without_gpu;
mod worn;
