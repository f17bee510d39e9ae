//! Pictures of the cell as its cameras take them, by a software rasteriser: no graphics card, no display, and
//! the same bits every time.
//!
//! Data passes one way: [`looks`] makes meshes, tags and the sheet's picture from the kit and the arm, once;
//! [`draw`] finds, for poses of all bodies and a camera, what each pixel shows; [`sensor`] turns that into an
//! image with the lens's blur, the exposure and the noise of a real sensor, and [`stereo`] measures its
//! depth. What a pixel shows is decided by triangles bent through the [`lens`]; where on a tag or on the
//! sheet it looks is worked out from the pixel's own direction, so that tags are as exact as the lens
//! model.

pub mod draw;
mod error;
pub mod free_camera;
pub mod lens;
pub mod looks;
pub mod mesh;
pub mod sensor;
pub mod stereo;
mod texture;

pub use draw::{Renderer, Scene};
pub use error::LooksError;
pub use lens::Lens;
pub use looks::Looks;
pub use sensor::Sensor;
pub use stereo::{StereoErrors, StereoSensor};
