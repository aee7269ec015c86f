//! The benchmarks of bevy_plumage: see `make bench`.
