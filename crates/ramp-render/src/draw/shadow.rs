//! Shadows on the table: bodies drawn onto its map as the lamp sees them, with soft edges.

use super::light::LIGHT;
use super::map::{SHADOW_SCALE, TABLE, WIDE, fill, shadow_size, spread};
use super::renderer::Renderer;
use super::rigid::Rigid;
use super::scene::Scene;
use crate::looks::Looks;

/// Distance beyond the visible part of the table up to which shadows are cast, m: more than the width of
/// their edges.
const SHADOW_EDGE: f32 = 0.1;

impl Renderer {
    /// Marks on a map of the table the cells in shadow that `camera` (the world's pose in it) may see.
    pub(super) fn cast_shadows(&mut self, looks: &Looks, scene: &Scene, camera: &Rigid) {
        let [columns, rows] = shadow_size();
        self.shadow.fill(0);
        for (index, x_wb) in &scene.bodies {
            let Some(body) = looks.bodies().get(*index) else { continue };
            let world = Rigid::new(x_wb);
            let (centre, radius) = body.ball;
            let [x, y, z] = world.moved(&centre);
            let down = z / LIGHT[2];
            let middle = [x - LIGHT[0] * down, y - LIGHT[1] * down, 0.0];
            if !self.in_view(camera, (middle, radius / LIGHT[2] + SHADOW_EDGE)) {
                continue;
            }
            self.screen.clear();
            for point in &body.shadow.points {
                let [x, y, z] = world.moved(point);
                let down = z.max(0.0) / LIGHT[2];
                self.screen.push([
                    (x - LIGHT[0] * down - TABLE[0][0]) * SHADOW_SCALE,
                    (y - LIGHT[1] * down - TABLE[1][0]) * SHADOW_SCALE,
                    0.0,
                ]);
            }
            for triangle in &body.shadow.triangles {
                let corners = triangle.map(|corner| self.screen[corner as usize]);
                fill(&mut self.shadow, columns, rows, &corners);
            }
        }
        // Soft edges: the lamp is not a point. Then, wider, where there is any shadow at all.
        let [sums, marks] = &mut self.sums;
        for (sum, shadow) in sums.iter_mut().zip(&self.shadow) {
            *sum = u16::from(*shadow);
        }
        spread(sums, marks, columns);
        for (mark, sum) in marks.iter_mut().zip(&*sums) {
            *mark = sum / (WIDE * WIDE);
        }
        // The last cells, which have no neighbours, are never in shadow: see [`spread`].
        let inner = marks.len() - columns - 1;
        let [a, b, c, d] = [0, 1, columns, columns + 1].map(|step| &marks[step..][..inner]);
        for ((((soft, a), b), c), d) in self.soft.iter_mut().zip(a).zip(b).zip(c).zip(d) {
            *soft = u32::from(*a) | u32::from(*b) << 8 | u32::from(*c) << 16 | u32::from(*d) << 24;
        }
    }
}
