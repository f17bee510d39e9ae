//! One picture, from the scene to the image.

use super::renderer::{NOTHING, Renderer};
use super::rigid::Rigid;
use super::scene::Scene;
use crate::sensor::Sensor;
use ramp_robot::Pose;
use std::sync::Arc;

impl Renderer {
    /// Takes a picture: red, green and blue of each pixel, gamma 2.2. `x_wc` is the pose of the optical frame in the
    /// world.
    pub fn render(&mut self, scene: &Scene, x_wc: &Pose, sensor: &mut Sensor) -> Vec<u8> {
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
        self.expose(&looks, x_wc, sensor)
    }
}
