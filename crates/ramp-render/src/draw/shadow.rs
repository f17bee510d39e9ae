//! Shadows: bodies drawn onto the map of the table as the lamp sees them. Those on the table have soft edges.

use super::light::LIGHT;
use super::map::{WIDE, cells, shadow_size, spread};
use super::occluder::{along_light, plane};
use super::renderer::Renderer;
use super::rigid::Rigid;
use super::scene::Scene;
use crate::looks::Looks;

/// Distance beyond the visible part of the table up to which shadows are cast, m: more than the width of
/// their edges.
const SHADOW_EDGE: f32 = 0.1;

impl Renderer {
    /// Sets what the lamp meets above each cell of the map, of all that throws a shadow on what `camera` (the
    /// world's pose in it) may see, and the shadows on the table.
    pub(super) fn cast_shadows(&mut self, looks: &Looks, scene: &Scene, camera: &Rigid) {
        let [columns, _] = shadow_size();
        for (index, x_wb) in &scene.bodies {
            let Some(body) = looks.bodies().get(*index) else { continue };
            let world = Rigid::new(x_wb);
            let (centre, radius) = body.ball;
            let [x, y, z] = world.moved(&centre);
            // Something in its shadow lies between it and the table.
            let half = 0.5 * z.max(0.0) / LIGHT[2];
            let middle = [x - LIGHT[0] * half, y - LIGHT[1] * half, 0.5 * z];
            if !self.in_view(camera, (middle, half + radius / LIGHT[2] + SHADOW_EDGE)) {
                continue;
            }
            self.screen.clear();
            self.screen.extend(body.shadow.points.iter().map(|point| along_light(&world.moved(point))));
            for triangle in &body.shadow.triangles {
                let corners = triangle.map(|corner| self.screen[corner as usize]);
                let height = plane(&corners);
                cells(&corners, |row, from, to| {
                    let height = |column| height(column, row as f32 + 0.5);
                    self.occluders.raise(row, [from, to], *index as u16, height);
                });
            }
        }
        self.occluders.tile();
        // Soft edges: the lamp is not a point. Then, wider, where there is any shadow at all.
        let [sums, marks] = &mut self.sums;
        for (sum, any) in sums.iter_mut().zip(self.occluders.any()) {
            *sum = if any { 255 } else { 0 };
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
