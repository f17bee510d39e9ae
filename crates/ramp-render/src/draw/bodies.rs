//! Bodies and the tags on them, drawn into the buffers.

use super::lamp::{FULLY, Lit};
use super::light::{lamp_on, linear, mixed, reflection, shade_on};
use super::occluder::along_light;
use super::renderer::{Face, NOTHING, Renderer, SeenTag, TAG};
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
        let mut corner_light = std::mem::take(&mut self.corner_light);
        corner_light.clear();
        corner_light.resize(mesh.points.len(), None);
        for ((triangle, normal), colour) in mesh.triangles.iter().zip(&surface.normals).zip(&mesh.colours) {
            let [a, b, c] = *triangle;
            let corners = [self.screen[a as usize], self.screen[b as usize], self.screen[c as usize]];
            let next = self.faces.len() as u32;
            if self.triangle(&corners, next) {
                let turned = world.turned(normal);
                let (shade, lamp) = (shade_on(&turned) * body.tone, lamp_on(&turned) * body.tone);
                let place = |corner: u32| world.moved(&mesh.points[corner as usize]);
                // A face that turns away from the lamp may still mirror it a little at its edge.
                let lit = if lamp > 0.0 {
                    let mut known = triangle.map(|corner| corner_light[corner as usize]);
                    let at = triangle.map(|corner| along_light(&place(corner)));
                    let lit = self.lit(&at, index as u16, &mut known);
                    triangle
                        .iter()
                        .zip(known)
                        .for_each(|(corner, known)| corner_light[*corner as usize] = known);
                    lit
                } else {
                    Lit::Evenly(FULLY)
                };
                let glint = if looks.glint > 0.0 && *colour == METAL {
                    looks.glint * reflection(&turned, &eye, &place(triangle[0]))
                } else {
                    0.0
                };
                let full = colour.map(|share| linear(share * (shade + lamp) + glint));
                let dark = || colour.map(|share| linear(share * shade));
                let (shown, dark) = match lit {
                    Lit::Evenly(FULLY) => (full, None),
                    Lit::Evenly(lit) => (mixed(full, dark(), lit), None),
                    Lit::Partly => (full, Some(dark())),
                };
                let metal = *colour == METAL;
                self.faces.push(Face { colour: shown, dark, body: index as u16, metal });
            }
        }
        self.corner_light = corner_light;
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
        let normal = [normal.x as f32, normal.y as f32, normal.z as f32];
        let world = Rigid::new(&(x_wb * sticker.place.x_pg));
        let half = 0.5 * sticker.size;
        let corners = [[-half, -half, 0.0], [half, -half, 0.0], [half, half, 0.0], [-half, half, 0.0]];
        let [a, b, c, d] = corners.map(|at| along_light(&world.moved(&at)));
        let (shade, lamp) = (shade_on(&normal), lamp_on(&normal));
        // The sheet's own tag is drawn without shadows, since cameras are calibrated by it.
        let lit = if body == NOTHING {
            Lit::Evenly(FULLY)
        } else {
            let [lit, other] = [[a, b, c], [a, c, d]].map(|at| self.lit(&at, body, &mut [None; 3]));
            if lit == other { lit } else { Lit::Partly }
        };
        let levels = |light: f32| -> [u16; PLACES + 1] {
            let [white, black] = TAG_LIGHT.map(|share| share * light);
            let share = |count: usize| count as f32 / PLACES as f32;
            std::array::from_fn(|count| linear(black + (white - black) * share(count)))
        };
        self.tags.push(SeenTag {
            sticker: sticker.clone(),
            rows: [row(0), row(1), last],
            light: levels(match lit {
                Lit::Evenly(lit) => shade + lamp * lit as f32 / FULLY as f32,
                Lit::Partly => shade + lamp,
            }),
            dark: (lit == Lit::Partly).then(|| levels(shade)),
            body,
        });
    }
}
