//! One picture, from the scene to the image.

use super::renderer::{NOTHING, Renderer};
use super::rigid::Rigid;
use super::scene::Scene;
use crate::sensor::Sensor;
use ramp_robot::Pose;
use std::sync::Arc;

impl Renderer {
    /// Takes a picture: red, green and blue of each pixel, gamma 2.2. `x_wc` is the pose of the optical frame
    /// in the world.
    pub fn render(&mut self, scene: &Scene, x_wc: &Pose, sensor: &mut Sensor) -> Vec<u8> {
        let mut image = self.image();
        sensor.begin();
        self.draw(scene, x_wc, |light| sensor.expose(light, &mut image));
        image
    }

    /// As [`Renderer::render`], of what moved while the shutter was open: the light of these moments
    /// together, each with the scene and the pose of the optical frame. Depth and segmentation are those of
    /// the last.
    pub fn render_moving(&mut self, moments: &[(Scene, Pose)], sensor: &mut Sensor) -> Vec<u8> {
        let mut image = self.image();
        let row = 3 * self.lens.model.width;
        let mut sum = vec![0u32; row * self.lens.model.height];
        for (scene, x_wc) in moments {
            let mut rows = sum.chunks_exact_mut(row);
            self.draw(scene, x_wc, |light| {
                let here = rows.next().into_iter().flatten();
                here.zip(light).for_each(|(sum, light)| *sum += u32::from(*light));
            });
        }
        sensor.begin();
        let count = moments.len().max(1) as u32;
        for row in sum.chunks_exact(row) {
            let light: Vec<u16> = row.iter().map(|sum| (sum / count) as u16).collect();
            sensor.expose(&light, &mut image);
        }
        image
    }

    fn image(&self) -> Vec<u8> {
        Vec::with_capacity(3 * self.lens.model.width * self.lens.model.height)
    }

    /// Draws one moment, and hands over the linear light of one row after another.
    fn draw(&mut self, scene: &Scene, x_wc: &Pose, row: impl FnMut(&[u16])) {
        self.near.fill(0.0);
        self.shown.fill(0);
        self.palette.clear();
        self.owner.clear();
        self.tags.clear();
        self.x_wc = *x_wc;
        // Colour 0 is nothing.
        self.palette.push([0; 3]);
        self.owner.push(NOTHING);
        let looks = Arc::clone(&self.looks);
        let x_cw = x_wc.inverse();
        for (index, x_wb) in &scene.bodies {
            self.body(&looks, *index, x_wb, &(x_cw * x_wb));
        }
        self.tag(&looks.sheet_tag, &Pose::identity(), &x_cw, NOTHING);
        self.cast_shadows(&looks, scene, &Rigid::new(&x_cw));
        self.expose(&looks, x_wc, row);
    }
}
