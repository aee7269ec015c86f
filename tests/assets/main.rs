//! Files and what is made of them: feathers, grooms and downs are read, validated, saved and reloaded; damaged ones are errors
//! that name file, field, value and range. Packed cards and tables make the round trip to the GPU.
//! Every variant of every shader that a camera or a quality can ask for is composed and validated.

mod anatomy;
mod card;
mod card_gpu;
mod downs;
mod feathers;
mod grooms;
mod iridescence;
mod layouts;
mod loader;
mod mutations;
mod order_gpu;
mod shaders;
mod version_1;
mod vertex_light_gpu;
