//! Small images: square, without the benchmark's sensor noise, two by two samples for each pixel.

use std::sync::Arc;

use ramp_render::looks::HOUSING;
use ramp_render::{Looks, LooksError, Renderer, Sensor};
use ramp_robot::{Camera, CameraModel, Robot};
use ramp_twin::Twin;

use crate::benchmark::Benchmark;

/// Samples along each side of a pixel.
pub(crate) const SAMPLES: usize = 2;
/// The smallest and largest side of an image, pixels.
pub const SIZES: [usize; 2] = [16, 512];

/// A camera of an environment: the middle square of the benchmark's camera, scaled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct View {
    /// Which camera.
    pub camera: Camera,
    /// Pixels along each side, within [`SIZES`].
    pub size: usize,
    /// Whether there is a depth image, too.
    pub depth: bool,
}

impl View {
    /// The lens and the mounting of its images; `tip` is the distance from the hand's frame to the tip's
    /// along z, m.
    pub fn lens(&self, tip: f64) -> CameraModel {
        let whole = CameraModel::nominal(self.camera, tip);
        let scale = self.size as f64 / whole.height as f64;
        CameraModel {
            width: self.size,
            height: self.size,
            focal: whole.focal.map(|it| it * scale),
            centre: [self.size as f64 / 2.0; 2],
            ..whole
        }
    }
}

/// Draws what one camera sees.
pub struct Painter {
    view: View,
    model: CameraModel,
    renderer: Renderer,
    sensor: Sensor,
    housing: Option<usize>,
    /// Red, green and blue of each pixel, row by row from the top left, gamma 2.2.
    pub colour: Vec<u8>,
    /// Distance along the optical axis, m; infinite where nothing is.
    pub depth: Vec<f32>,
}

impl Painter {
    /// For the arm and the parts of a benchmark.
    ///
    /// # Errors
    /// When there is nothing to draw.
    pub fn of(view: View, benchmark: &Benchmark) -> Result<Painter, LooksError> {
        let looks = Looks::shared(&benchmark.kit, &benchmark.arm)?;
        Ok(Painter::new(view, looks, benchmark.arm.hand.tip))
    }

    /// With these looks; `tip` is the distance from the hand's frame to the tip's along z, m.
    pub fn new(view: View, looks: Arc<Looks>, tip: f64) -> Painter {
        // Of its samples.
        let model = View { size: view.size * SAMPLES, ..view }.lens(tip);
        Painter {
            view,
            housing: looks.body(HOUSING),
            renderer: Renderer::new(looks, &model),
            model,
            sensor: Sensor::steady(),
            colour: vec![0; view.size * view.size * 3],
            depth: if view.depth { vec![0.0; view.size * view.size] } else { Vec::new() },
        }
    }

    /// Draws the parts as they are in the episode of a twin from now on: their shapes, brightness and glints.
    ///
    /// # Errors
    /// When there is nothing to draw.
    pub fn dress(&mut self, twin: &Twin) -> Result<(), LooksError> {
        let looks = twin.looks()?;
        self.housing = looks.body(HOUSING);
        self.renderer.dress(looks);
        Ok(())
    }

    /// The scene that it draws.
    pub fn view(&self) -> View {
        self.view
    }

    /// Draws the scene as it is now, with the looks of [`Painter::dress`].
    pub fn paint(&mut self, twin: &Twin) {
        let mut scene = twin.picture(self.renderer.looks());
        if self.view.camera == Camera::Wrist {
            scene.bodies.retain(|(index, _)| Some(*index) != self.housing);
        }
        let x_wc = self.model.x_wc(&twin.observe().x_wt);
        let samples = self.renderer.render(&scene, &x_wc, &mut self.sensor);
        let size = self.view.size;
        self.colour = average(&samples, [size, size]);
        if self.view.depth {
            let depth = self.renderer.depth();
            for y in 0..size {
                for x in 0..size {
                    self.depth[y * size + x] = depth[y * SAMPLES * size * SAMPLES + x * SAMPLES];
                }
            }
        }
    }
}

/// The mean colour of the samples of each pixel, for an image of `width` by `height` pixels.
pub(crate) fn average(samples: &[u8], [width, height]: [usize; 2]) -> Vec<u8> {
    let row = width * SAMPLES * 3;
    let mut image = Vec::with_capacity(width * height * 3);
    for y in 0..height {
        for x in 0..width {
            for channel in 0..3 {
                let at = |dy: usize, dx: usize| {
                    u32::from(samples[(y * SAMPLES + dy) * row + (x * SAMPLES + dx) * 3 + channel])
                };
                image.push(((at(0, 0) + at(0, 1) + at(1, 0) + at(1, 1)) / 4) as u8);
            }
        }
    }
    image
}
