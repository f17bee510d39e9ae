//! Bodies and the tags on them, drawn into the buffers.

use super::light::{light_on, linear, reflection};
use super::renderer::{Renderer, SeenTag, TAG};
use super::rigid::Rigid;
use super::triangles::NEAR;
use crate::looks::{Looks, METAL, Sticker};
use crate::texture::{PLACES, TAG_LIGHT};
use nalgebra::Vector3;
use ramp_robot::Pose;

/// Distance by which a tag counts as nearer in the depth test, m: more than the details that meshes
/// leave out.
const STICKER_LIFT: f32 = 1.0e-3;
/// A body of which a pixel covers more than this is drawn with less detail, m.
const FAR_PIXEL: f32 = 0.8e-3;

impl Renderer {
    /// Draws a body of this index.
    pub(super) fn body(&mut self, looks: &Looks, index: usize, x_wb: &Pose, x_cb: &Pose) {
        let Some(body) = looks.bodies().get(index) else { return };
        let (camera, world) = (Rigid::new(x_cb), Rigid::new(x_wb));
        if !self.in_view(&camera, body.ball) {
            return;
        }
        // The area that a pixel covers on it decides the level of detail.
        let distance = camera.moved(&body.ball.0)[2] - body.ball.1;
        let far = distance > FAR_PIXEL * self.lens.model.focal[0] as f32;
        let surface = &body.surfaces[usize::from(far)];
        self.project(&camera, &surface.mesh);
        let mesh = &surface.mesh;
        let eye = Rigid::new(&self.x_wc).shift;
        for ((triangle, normal), colour) in mesh.triangles.iter().zip(&surface.normals).zip(&mesh.colours) {
            let corners = triangle.map(|corner| self.screen[corner as usize]);
            let next = self.palette.len() as u32;
            if self.triangle(&corners, next) {
                let turned = world.turned(normal);
                let light = light_on(&turned) * body.tone;
                let glint = if looks.glint > 0.0 && *colour == METAL {
                    looks.glint * reflection(&turned, &eye, &world.moved(&mesh.points[triangle[0] as usize]))
                } else {
                    0.0
                };
                let [r, g, b] = colour.map(|share| linear(share * light + glint));
                self.palette.push([r, g, b]);
                self.owner.push(index as u16);
                self.metal.push(*colour == METAL);
            }
        }
        for sticker in &body.tags {
            self.tag(sticker, x_wb, x_cb, index as u16);
        }
    }

    /// Draws a tag of a body.
    pub(super) fn tag(&mut self, sticker: &Sticker, x_wb: &Pose, x_cb: &Pose, body: u16) {
        const PARTS: usize = 4;
        let x_cg = x_cb * sticker.place.x_pg;
        let p_g_camera = x_cg.inverse().translation.vector;
        if p_g_camera.z <= 0.0 {
            return;
        }
        let camera = Rigid::new(&x_cg);
        if !self.in_view(&camera, ([0.0; 3], 0.8 * sticker.size)) {
            return;
        }
        let number = TAG | self.tags.len() as u32;
        let corner = |row: usize, column: usize| {
            let at = |index: usize| sticker.size * (index as f32 / PARTS as f32 - 0.5);
            camera.moved(&[at(column), at(row), 0.0])
        };
        for row in 0..PARTS {
            for column in 0..PARTS {
                let quad = [
                    corner(row, column),
                    corner(row, column + 1),
                    corner(row + 1, column + 1),
                    corner(row + 1, column),
                ];
                if quad.iter().any(|p| p[2] < NEAR) {
                    continue;
                }
                let [a, b, c, d] = quad.map(|p| {
                    let [x, y] = self.lens.project(p);
                    [x, y, 1.0 / (p[2] - STICKER_LIFT)]
                });
                self.triangle(&[a, b, c], number);
                self.triangle(&[a, c, d], number);
            }
        }
        // A direction d of C meets the plane z = 0 of G where o + t R d has z = 0, o being the camera in G.
        let turn = x_cg.rotation.inverse().to_rotation_matrix();
        let o = p_g_camera;
        let row = |axis: usize| -> [f32; 3] {
            std::array::from_fn(|column| (o[axis] * turn[(2, column)] - o.z * turn[(axis, column)]) as f32)
        };
        let last = std::array::from_fn(|column| turn[(2, column)] as f32);
        let normal = (x_wb * sticker.place.x_pg).rotation * Vector3::z();
        let light = light_on(&[normal.x as f32, normal.y as f32, normal.z as f32]);
        let [white, black] = TAG_LIGHT.map(|share| share * light);
        let share = |count: usize| count as f32 / PLACES as f32;
        self.tags.push(SeenTag {
            sticker: sticker.clone(),
            rows: [row(0), row(1), last],
            light: std::array::from_fn(|count| linear(black + (white - black) * share(count))),
            body,
        });
    }
}
