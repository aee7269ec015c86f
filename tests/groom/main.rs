//! Growing feathers on a mesh: scattering, rows, order of the coat, paint, and the component in an app.
//! The baked birds and their grooms are complete and fit together.
//! No renderer is needed.

mod authored;
mod birds;
mod blender;
mod coat;
mod fit;
mod mask_textures;
mod order;
mod paint;
mod plugin;
mod proportions;
mod skin_color;
mod stretch;
mod weathering;
mod wrong_input;
