//! Every pixel coloured once, and blurred as the lens does.

use super::lamp::FULLY;
use super::light::mixed;
use super::renderer::{Face, Renderer, SeenTag, TAG};
use super::rigid::Rigid;
use super::table::{Node, Table};
use crate::looks::Looks;
use ramp_robot::Pose;

/// Pixels along a row for which the way to the next direction is taken to be the same.
const STRETCH: usize = 16;
/// Pixels on a body over which the lamp's light goes straight: fewer than the edge of a shadow has.
const FADE: usize = 8;
/// Values of a block of a row: 16 pixels. A block of one colour, with neighbours of the same, stays as it is.
const BLOCK: usize = 3 * 16;

/// A row of linear light after the blur along it.
#[derive(Clone)]
struct Blurred {
    light: Vec<u16>,
    /// For each of its blocks: does it show one colour, as the pixels before and after it do?
    even: Vec<bool>,
}

impl Blurred {
    fn new(width: usize) -> Blurred {
        Blurred { light: vec![0; 3 * width], even: vec![false; (3 * width).div_ceil(BLOCK)] }
    }

    /// Takes over a row, of which the first and the last pixel are there twice.
    fn take(&mut self, light: &[u16]) {
        for ((mixed, even), from) in
            self.light.chunks_mut(BLOCK).zip(&mut self.even).zip((0..).step_by(BLOCK))
        {
            let end = from + mixed.len();
            *even = light[from..end + 3] == light[from + 3..end + 6];
            if *even {
                copy(mixed, &light[from..end]);
            } else {
                blur(mixed, &light[from..end], &light[from + 3..end + 3], &light[from + 6..end + 6]);
            }
        }
    }

    /// Blurs across the rows: this one, and those above and below.
    fn mix(&self, [above, below]: [&Blurred; 2], mixed: &mut [u16]) {
        for ((mixed, index), from) in mixed.chunks_mut(BLOCK).zip(0..).zip((0..).step_by(BLOCK)) {
            let block = from..from + mixed.len();
            let colour = |row: &Blurred| row.even[index].then(|| [0, 1, 2].map(|at| row.light[from + at]));
            let even =
                colour(self).is_some_and(|here| [above, below].iter().all(|row| colour(row) == Some(here)));
            let [above, here, below] = [above, self, below].map(|row| &row.light[block.clone()]);
            if even {
                copy(mixed, here);
            } else {
                blur(mixed, above, here, below);
            }
        }
    }
}

impl Renderer {
    /// Colours every pixel, blurs as the lens does, and hands over the linear light of one row after another.
    pub(super) fn expose(&mut self, looks: &Looks, x_wc: &Pose, mut row: impl FnMut(&[u16])) {
        let (width, height) = (self.lens.model.width, self.lens.model.height);
        // A row of linear light with its first and last pixel repeated, and the last three rows, blurred.
        let mut light = vec![0u16; 3 * (width + 2)];
        let mut rows = vec![Blurred::new(width); 3];
        let mut mixed = vec![0u16; 3 * width];
        let table = Table::new(looks, x_wc, &self.lens.model);
        let columns = width.div_ceil(table.stride) + 1;
        let camera = Rigid::new(x_wc);
        // From a place that the camera has kept, the places that it sees on the table are the same.
        let known = self.nodes_from == Some(*x_wc);
        let mut nodes = std::mem::take(&mut self.nodes);
        nodes.resize(columns * height, Node::default());
        for y in 0..=height {
            if y < height {
                let nodes = &mut nodes[y * columns..][..columns];
                let map: (&[u8], &[u32]) = (&self.bare, &self.soft);
                if !known {
                    table.place_nodes(looks, map.0, self.lens.row(y), nodes);
                }
                table.light_nodes(map.1, nodes);
                self.colour_row(looks, (&table, &camera), y, nodes, &mut light[3..3 * (width + 1)]);
                light.copy_within(3..6, 0);
                light.copy_within(3 * width..3 * (width + 1), 3 * (width + 1));
                rows[y % 3].take(&light);
            }
            if y == 0 {
                continue;
            }
            let above = &rows[y.saturating_sub(2) % 3];
            let here = &rows[(y - 1) % 3];
            let below = &rows[y.min(height - 1) % 3];
            here.mix([above, below], &mut mixed);
            row(&mixed);
        }
        (self.nodes, self.nodes_from) = (nodes, Some(*x_wc));
    }

    fn colour_row(
        &self,
        looks: &Looks,
        (table, camera): (&Table<'_>, &Rigid),
        y: usize,
        nodes: &mut [Node],
        light: &mut [u16],
    ) {
        let width = self.lens.model.width;
        let [dx, dy] = self.lens.row(y);
        let map: (&[u8], &[u32]) = (&self.bare, &self.soft);
        let (shown, near) = (&self.shown[y * width..][..width], &self.near[y * width..][..width]);
        // Light of the lamp at the place that a pixel shows.
        let lamp = |at: usize, body: u16| {
            let far = 1.0 / near[at];
            self.lamp_at(&camera.moved(&[dx[at] * far, dy[at] * far, far]), body)
        };
        let mut x = 0;
        while x < width {
            // A run of pixels that show one thing.
            let what = shown[x];
            let end = x + run(&shown[x..]);
            if what == 0 {
                let mut from = x;
                while from < end {
                    if let Some((colour, to)) = table.even(nodes, from, end) {
                        light[3 * from..3 * to].as_chunks_mut().0.fill(colour);
                        from = to;
                        continue;
                    }
                    let to = end.min((from / table.stride + 1) * table.stride);
                    table.stretch(looks, map, [dx, dy], nodes, from, &mut light[3 * from..3 * to]);
                    from = to;
                }
            } else if what & TAG == 0 {
                let Face { colour, dark, body, .. } = self.faces[what as usize];
                let pixels = light[3 * x..3 * end].as_chunks_mut().0;
                match dark {
                    None => pixels.fill(colour),
                    Some(dark) => {
                        let mut from = lamp(x, body) as i32;
                        for (pixels, at) in pixels.chunks_mut(FADE).zip((x..).step_by(FADE)) {
                            let next = (at + FADE).min(end - 1);
                            let to = lamp(next, body) as i32;
                            let step = ((to - from) << 8) / (next - at).max(1) as i32;
                            for (light, count) in pixels.iter_mut().zip(0..) {
                                *light = mixed(colour, dark, (from + ((count * step) >> 8)) as u32);
                            }
                            from = to;
                        }
                    }
                }
            } else {
                let tag = &self.tags[(what & !TAG) as usize];
                let mut steps = [[0.0; 2]; 2];
                for (light, at) in light[3 * x..3 * end].chunks_exact_mut(3).zip(x..end) {
                    if (at - x).is_multiple_of(STRETCH) {
                        steps = self.lens.step(at, y);
                    }
                    let count = tag_pixel(tag, steps, [dx[at], dy[at]]);
                    let lit = tag.dark.map(|dark| (dark[count], lamp(at, tag.body)));
                    let full = tag.light[count];
                    light.fill(match lit {
                        Some((dark, lit)) if lit < FULLY => mixed([full; 3], [dark; 3], lit)[0],
                        _ => full,
                    });
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

/// How many of a pixel's places are white that sees a tag along a direction; `steps` lead to the next pixels'
/// directions.
#[inline]
fn tag_pixel(tag: &SeenTag, steps: [[f32; 2]; 2], [dx, dy]: [f32; 2]) -> usize {
    let [[xx, xy, xz], [yx, yy, yz], [wx, wy, wz]] = tag.rows;
    let one = 1.0 / (wx * dx + wy * dy + wz);
    let at = [(xx * dx + xy * dy + xz) * one, (yx * dx + yy * dy + yz) * one];
    // Distance to the next pixels on the tag.
    let [right, below] = steps.map(|[sx, sy]| {
        let fall = wx * sx + wy * sy;
        [(xx * sx + xy * sy - at[0] * fall) * one, (yx * sx + yy * sy - at[1] * fall) * one]
    });
    tag.sticker.cells.white(at[0], at[1], right, below)
}

/// Copies a block or what is left of one; a whole one without a call.
#[inline]
fn copy(to: &mut [u16], from: &[u16]) {
    match (to.first_chunk_mut::<BLOCK>(), from.first_chunk::<BLOCK>()) {
        (Some(to), Some(from)) => *to = *from,
        _ => to.copy_from_slice(from),
    }
}

/// The lens's blur across three neighbours, a standard deviation of 0.6 pixels.
fn blur(mixed: &mut [u16], before: &[u16], here: &[u16], after: &[u16]) {
    for (((mixed, before), here), after) in mixed.iter_mut().zip(before).zip(here).zip(after) {
        // Twelve bits times sixteen just fit.
        *mixed = (3 * before + 10 * here + 3 * after) >> 4;
    }
}
