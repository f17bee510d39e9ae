//! Pictures of the work for a person: larger than those of a policy, and from near by.

use nalgebra::Point3;
use ramp_render::free_camera::FreeCamera;
use ramp_render::{Looks, LooksError, Renderer, Scene, Sensor};
use ramp_robot::Robot;
use ramp_twin::Twin;

use crate::benchmark::Benchmark;
use crate::pictures::{SAMPLES, average};

/// Width and height of a picture, pixels.
pub const SIZE: [usize; 2] = [640, 480];
/// From the tip of the hand to the camera, m, axes of the world.
const OFFSET: [f64; 3] = [0.30, -0.36, 0.26];
/// Focal length, image widths.
const FOCAL: f64 = 1.05;

/// A camera beside the hand.
pub struct Onlooker {
    camera: FreeCamera,
    renderer: Renderer,
    sensor: Sensor,
    /// The bodies and the place of the tip when the twin was last seen.
    seen: Option<(Scene, Point3<f64>)>,
}

impl Onlooker {
    /// For the arm and the parts of a benchmark.
    ///
    /// # Errors
    /// When there is nothing to draw.
    pub fn new(benchmark: &Benchmark) -> Result<Onlooker, LooksError> {
        let looks = Looks::shared(&benchmark.kit, &benchmark.arm)?;
        let camera = FreeCamera::new(SIZE.map(|side| side * SAMPLES), FOCAL, OFFSET);
        let renderer = Renderer::new(looks, camera.model());
        Ok(Onlooker { camera, renderer, sensor: Sensor::steady(), seen: None })
    }

    /// Looks at the twin. This is quick: only [`Onlooker::picture`] draws.
    ///
    /// # Errors
    /// When the parts of the episode cannot be drawn.
    pub fn look(&mut self, twin: &Twin) -> Result<(), LooksError> {
        self.renderer.dress(twin.looks()?);
        let tip = Point3::from(twin.observe().x_wt.translation.vector);
        self.seen = Some((twin.picture(self.renderer.looks()), tip));
        Ok(())
    }

    /// What was last looked at: red, green and blue of each pixel, row by row from the top left. Nothing if
    /// the twin was never looked at.
    pub fn picture(&mut self) -> Option<Vec<u8>> {
        let (scene, tip) = self.seen.as_ref()?;
        let x_wc = self.camera.follow(*tip);
        Some(average(&self.renderer.render(scene, &x_wc, &mut self.sensor), SIZE))
    }
}
