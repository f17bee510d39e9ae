//! From poses and a camera to pixels: a depth buffer says which triangle each pixel shows, then every pixel
//! is coloured once.
//!
//! `picture` goes through the stages on the buffers of the `renderer`: `shadow` (each `occluder` on the `map`
//! of the table), `bodies` (with `triangles`, and `lamp` for their light), and `expose` (with `table` where
//! no body is seen).

mod bodies;
mod expose;
mod lamp;
mod light;
mod map;
mod occluder;
mod picture;
mod renderer;
mod rigid;
mod scene;
mod shadow;
mod table;
mod triangles;

pub use renderer::{NOTHING, Renderer};
pub use scene::Scene;
