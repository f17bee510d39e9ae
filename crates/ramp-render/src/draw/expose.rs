//! Every pixel coloured once, and blurred as the lens does.

use super::renderer::{Renderer, SeenTag, TAG};
use super::table::Table;
use crate::looks::Looks;
use ramp_robot::Pose;

/// Pixels along a row for which the way to the next direction is taken to be the same.
const STRETCH: usize = 16;

impl Renderer {
    /// Colours every pixel, blurs as the lens does, and hands over the linear light of one row after another.
    pub(super) fn expose(&mut self, looks: &Looks, x_wc: &Pose, mut row: impl FnMut(&[u16])) {
        let (width, height) = (self.lens.model.width, self.lens.model.height);
        // A row of linear light with its first and last pixel repeated, and the last three rows, blurred.
        let mut light = vec![0u16; 3 * (width + 2)];
        let mut rows = vec![vec![0u16; 3 * width]; 3];
        let mut mixed = vec![0u16; 3 * width];
        let table = Table::new(looks, x_wc, &self.lens.model);
        let mut nodes = vec![[0.0; 2]; width.div_ceil(table.stride) + 1];
        for y in 0..=height {
            if y < height {
                self.colour_row(looks, &table, y, &mut nodes, &mut light[3..3 * (width + 1)]);
                light.copy_within(3..6, 0);
                light.copy_within(3 * width..3 * (width + 1), 3 * (width + 1));
                blur(&mut rows[y % 3], &light, &light[3..], &light[6..]);
            }
            if y == 0 {
                continue;
            }
            let above = &rows[y.saturating_sub(2) % 3];
            let here = &rows[(y - 1) % 3];
            let below = &rows[y.min(height - 1) % 3];
            blur(&mut mixed, above, here, below);
            row(&mixed);
        }
    }

    fn colour_row(
        &self,
        looks: &Looks,
        table: &Table<'_>,
        y: usize,
        nodes: &mut [[f32; 2]],
        light: &mut [u16],
    ) {
        let width = self.lens.model.width;
        let [dx, dy] = self.lens.row(y);
        for (index, node) in nodes.iter_mut().enumerate() {
            let x = (index * table.stride).min(width - 1);
            *node = table.place(dx[x], dy[x]);
        }
        let shown = &self.shown[y * width..][..width];
        let mut x = 0;
        while x < width {
            // A run of pixels that show one thing.
            let what = shown[x];
            let end = x + run(&shown[x..]);
            if what == 0 {
                let mut from = x;
                while from < end {
                    let to = end.min((from / table.stride + 1) * table.stride);
                    let light = &mut light[3 * from..3 * to];
                    table.stretch(looks, (&self.bare, &self.soft), [dx, dy], nodes, from, light);
                    from = to;
                }
            } else if what & TAG == 0 {
                let colour = self.palette[what as usize];
                light[3 * x..3 * end].chunks_exact_mut(3).for_each(|light| light.copy_from_slice(&colour));
            } else {
                let tag = &self.tags[(what & !TAG) as usize];
                let mut steps = [[0.0; 2]; 2];
                for (light, at) in light[3 * x..3 * end].chunks_exact_mut(3).zip(x..end) {
                    if (at - x).is_multiple_of(STRETCH) {
                        steps = self.lens.step(at, y);
                    }
                    light.fill(tag_pixel(tag, steps, [dx[at], dy[at]]));
                }
            }
            x = end;
        }
    }
}

/// Number of pixels that show the same as the first, compared several at a time.
#[inline]
fn run(shown: &[u32]) -> usize {
    const MANY: usize = 8;
    let what = shown.first().copied().unwrap_or_default();
    let same = |many: &[u32; MANY]| many.iter().fold(0, |others, next| others | next ^ what) == 0;
    let whole = MANY * shown.as_chunks().0.iter().take_while(|many| same(many)).count();
    whole + shown[whole..].iter().take_while(|next| **next == what).count()
}

/// Brightness of a pixel that sees a tag along a direction; `steps` lead to the next pixels' directions.
#[inline]
fn tag_pixel(tag: &SeenTag, steps: [[f32; 2]; 2], [dx, dy]: [f32; 2]) -> u16 {
    let [[xx, xy, xz], [yx, yy, yz], [wx, wy, wz]] = tag.rows;
    let one = 1.0 / (wx * dx + wy * dy + wz);
    let at = [(xx * dx + xy * dy + xz) * one, (yx * dx + yy * dy + yz) * one];
    // Distance to the next pixels on the tag.
    let [right, below] = steps.map(|[sx, sy]| {
        let fall = wx * sx + wy * sy;
        [(xx * sx + xy * sy - at[0] * fall) * one, (yx * sx + yy * sy - at[1] * fall) * one]
    });
    tag.light[tag.sticker.cells.white(at[0], at[1], right, below)]
}

/// The lens's blur across three neighbours, a standard deviation of 0.6 pixels.
fn blur(mixed: &mut [u16], before: &[u16], here: &[u16], after: &[u16]) {
    for (((mixed, before), here), after) in mixed.iter_mut().zip(before).zip(here).zip(after) {
        // Twelve bits times sixteen just fit.
        *mixed = (3 * before + 10 * here + 3 * after) >> 4;
    }
}
