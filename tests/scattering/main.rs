//! Light and fibres: energy of the scattering model, its series and tables, sampling, the near field, and whole feathers against
//! rays to explicit curves; each in Rust against quadrature or tracing, and in the shader against its twin.
//! Figures of the README: `cargo test -p plumage_tests --test scattering -- --nocapture`.

mod cost;
mod curves_plugin;
mod curves_rays;
mod facets;
mod feather;
mod fibre;
mod gpu;
mod gpu_facets;
mod gpu_near;
mod interference;
mod interpolated;
mod judged;
mod near;
mod sample;
mod short;
mod traced;
