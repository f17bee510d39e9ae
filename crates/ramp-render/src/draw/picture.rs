//! One picture, from the scene to the image.

use super::renderer::{Face, NOTHING, Renderer};
use super::rigid::Rigid;
use super::scene::Scene;
use crate::looks::Looks;
use crate::sensor::{FULL, Sensor};
use ramp_robot::Pose;
use std::sync::Arc;

/// As many moments as sixteen bits hold the light of.
const MOST_MOMENTS: usize = (u16::MAX / FULL) as usize;

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
    /// together, at most sixteen, each with the scene and the pose of the optical frame. Depth and
    /// segmentation are those of the middle one.
    pub fn render_moving(&mut self, moments: &[(Scene, Pose)], sensor: &mut Sensor) -> Vec<u8> {
        let moments = &moments[..moments.len().min(MOST_MOMENTS)];
        let mut image = self.image();
        let row = 3 * self.lens.model.width;
        let mut sum = vec![0u16; row * self.lens.model.height];
        // The middle one last: its buffers stay.
        let (before, after) = moments.split_at(moments.len() / 2);
        let middle = after.iter().take(1);
        for (scene, x_wc) in before.iter().chain(after.iter().skip(1)).chain(middle) {
            let mut rows = sum.chunks_exact_mut(row);
            self.draw(scene, x_wc, |light| {
                let here = rows.next().into_iter().flatten();
                here.zip(light).for_each(|(sum, light)| *sum += light);
            });
        }
        sensor.begin();
        let count = moments.len().max(1) as u16;
        // A shift of several values at once takes far less time than as many divisions.
        let half = count.is_power_of_two().then(|| count.trailing_zeros());
        for light in sum.chunks_exact_mut(row) {
            match half {
                Some(bits) => light.iter_mut().for_each(|sum| *sum >>= bits),
                None => light.iter_mut().for_each(|sum| *sum /= count),
            }
            sensor.expose(light, &mut image);
        }
        image
    }

    fn image(&self) -> Vec<u8> {
        Vec::with_capacity(3 * self.lens.model.width * self.lens.model.height)
    }

    /// Which body each pixel would show, as [`Renderer::segmentation`] has it, without a picture.
    pub fn bodies(&mut self, scene: &Scene, x_wc: &Pose) -> Vec<u16> {
        self.place(scene, x_wc, false);
        self.segmentation()
    }

    /// Draws one moment, and hands over the linear light of one row after another.
    fn draw(&mut self, scene: &Scene, x_wc: &Pose, row: impl FnMut(&[u16])) {
        let looks = self.place(scene, x_wc, true);
        if let Some(tag) = &looks.sheet_tag {
            self.tag(tag, &Pose::identity(), &x_wc.inverse(), NOTHING);
        }
        self.expose(&looks, x_wc, row);
    }

    /// Clears the buffers and draws all bodies into them, with or without shadows.
    fn place(&mut self, scene: &Scene, x_wc: &Pose, with_shadows: bool) -> Arc<Looks> {
        self.near.fill(0.0);
        self.shown.fill(0);
        self.faces.clear();
        self.tags.clear();
        self.x_wc = *x_wc;
        // Face 0 is nothing.
        self.faces.push(Face { colour: [0; 3], dark: None, body: NOTHING, metal: false });
        let looks = Arc::clone(&self.looks);
        let x_cw = x_wc.inverse();
        self.occluders.clear();
        if with_shadows {
            self.cast_shadows(&looks, scene, &Rigid::new(&x_cw));
        }
        for (index, x_wb) in &scene.bodies {
            self.body(&looks, *index, x_wb, &(x_cw * x_wb));
        }
        looks
    }
}
