//! Pixels that show the table, the sheet on it, the floor or the wall.

use super::light::{dimmed, light_on, linear, shine};
use super::map::{ABOVE, DETAIL, FLOOR, PAPER, TABLE_TOP, WALL, kind, on_sheet, shade_at};
use super::rigid::Rigid;
use crate::looks::Looks;
use crate::sensor::FULL;
use crate::texture::Level;
use ramp_robot::{CameraModel, Pose};

/// The colours of the table, of the floor around it, and of the background.
const TABLE_COLOUR: [f32; 3] = [0.33, 0.31, 0.28];
const FLOOR_COLOUR: [f32; 3] = [0.13, 0.13, 0.13];
const WALL_COLOUR: [f32; 3] = [0.55, 0.57, 0.60];
/// Pixels along a row between two whose places on the table are worked out, from near and from far, and how
/// far apart those may be, m: twice the bare area known around a cell, and less than the width of any shadow.
const STRIDES: [usize; 2] = [16, 8];
const BARE: f32 = 20.0e-3;

/// A place on the table.
#[derive(Clone, Copy, Default)]
pub(super) struct Node {
    /// m in the world.
    at: [f32; 2],
    /// Its content, [`DETAIL`] to [`WALL`].
    kind: u8,
    on_sheet: bool,
    /// Light that reaches it, of 256.
    left: u32,
}

impl Node {
    fn is_close(&self, other: &Node) -> bool {
        (other.at[0] - self.at[0]).abs().max((other.at[1] - self.at[1]).abs()) < BARE
    }

    /// Is there one thing between two places, and nothing to be seen on it?
    fn is_plain(&self, other: &Node) -> bool {
        self.kind == other.kind && self.kind != DETAIL
    }
}

/// The view of the table.
pub(super) struct Table<'a> {
    turn: [[f32; 3]; 3],
    eye: [f32; 3],
    /// One of [`STRIDES`].
    pub(super) stride: usize,
    /// The sheet's picture, about as fine as the image.
    sheet: Level<'a>,
    /// The sheet's colours by their numbers where no shadow falls.
    ink: [[u16; 3]; 256],
    /// Colours without shadows by content, [`TABLE_TOP`] to [`WALL`].
    plain: [[u16; 3]; WALL as usize + 1],
}

impl<'a> Table<'a> {
    /// The table from a camera.
    pub(super) fn new(looks: &'a Looks, x_wc: &Pose, model: &CameraModel) -> Table<'a> {
        let rigid = Rigid::new(x_wc);
        // Size of a pixel where the optical axis meets the table, or straight below.
        let down = -rigid.turn[2][2];
        let distance = if down > 0.3 { rigid.shift[2] / down } else { rigid.shift[2] };
        let pixel = distance.max(0.01) / model.focal[0] as f32;
        // A margin for points further away than the middle.
        let [near, far] = STRIDES;
        let stride = if 1.5 * pixel * (near as f32) < BARE { near } else { far };
        let sheet = looks.sheet.on(looks.sheet.level(pixel));
        let lit = light_on(&[0.0, 0.0, 1.0]);
        let colour = |colour: [f32; 3], light: f32| colour.map(|share| linear(share * light));
        let of_255 = (lit * f32::from(FULL) / 255.0 * 256.0) as u32;
        let ink = std::array::from_fn(|number| shine(sheet.colour(number as u8), of_255));
        let mut plain = [[0; 3]; WALL as usize + 1];
        plain[usize::from(TABLE_TOP)] = colour(TABLE_COLOUR, lit);
        plain[usize::from(PAPER)] = shine(looks.sheet.paper(), of_255);
        plain[usize::from(FLOOR)] = colour(FLOOR_COLOUR, 0.8 * lit);
        plain[usize::from(WALL)] = colour(WALL_COLOUR, 1.0);
        Table { turn: rigid.turn, eye: rigid.shift, stride, sheet, ink, plain }
    }

    /// Point on the table that a pixel shows, m in the world.
    #[inline]
    pub(super) fn place(&self, dx: f32, dy: f32) -> [f32; 2] {
        let [tx, ty, tz] = self.turn;
        let fall = tz[0] * dx + tz[1] * dy + tz[2];
        let t = -self.eye[2] / fall;
        let (x, y) = (tx[0] * dx + tx[1] * dy + tx[2], ty[0] * dx + ty[1] * dy + ty[2]);
        let down = fall <= -1e-3;
        [(self.eye[0], x), (self.eye[1], y)].map(|(eye, way)| if down { eye + t * way } else { ABOVE })
    }

    /// Sets what there is at the places of each `stride`th pixel of a row and of its last.
    pub(super) fn place_nodes(&self, looks: &Looks, bare: &[u8], [dx, dy]: [&[f32]; 2], nodes: &mut [Node]) {
        for (index, node) in nodes.iter_mut().enumerate() {
            let x = (index * self.stride).min(dx.len() - 1);
            node.at = self.place(dx[x], dy[x]);
            node.kind = kind(bare, node.at);
            node.on_sheet = node.kind == PAPER || node.kind == DETAIL && on_sheet(looks, node.at);
        }
    }

    /// Sets the light at these places.
    pub(super) fn light_nodes(&self, soft: &[u32], nodes: &mut [Node]) {
        for node in nodes {
            node.left = if node.kind < FLOOR { shade_at(soft, node.at) } else { 256 };
        }
    }

    /// Colours the pixels from `x` on, which all show the table and lie between two of the `nodes` of their
    /// row: where these are close to each other, places and shadows go straight.
    pub(super) fn stretch(
        &self,
        looks: &Looks,
        (bare, soft): (&[u8], &[u32]),
        [dx, dy]: [&[f32]; 2],
        nodes: &[Node],
        x: usize,
        light: &mut [u16],
    ) {
        let (index, skip) = (x / self.stride, x % self.stride);
        let (from, to) = (&nodes[index], &nodes[index + 1]);
        let pixels = light.as_chunks_mut().0;
        if !from.is_close(to) {
            return self.each(looks, (bare, soft), [&dx[x..], &dy[x..]], pixels);
        }
        let on_sheet = from.on_sheet && to.on_sheet;
        let plain = if from.is_plain(to) {
            Some(self.plain[usize::from(from.kind)])
        } else if on_sheet && self.is_blank(looks, from, to) {
            Some(self.plain[usize::from(PAPER)])
        } else {
            None
        };
        let share = 1.0 / (dx.len() - 1 - index * self.stride).clamp(1, self.stride) as f32;
        // In 65536th parts.
        let fade = ((to.left as f32 - from.left as f32) * 65536.0 * share) as i32;
        let begin = ((from.left as i32) << 16) + skip as i32 * fade;
        let lefts = (0..).map(|step| ((begin + step * fade) >> 16) as u32);
        match plain {
            Some(colour) if fade == 0 => pixels.fill(dimmed(colour, from.left)),
            Some(colour) => {
                pixels.iter_mut().zip(lefts).for_each(|(light, left)| *light = dimmed(colour, left))
            }
            None if on_sheet => {
                let step = [(to.at[0] - from.at[0]) * share, (from.at[1] - to.at[1]) * share];
                let skip = skip as f32;
                let at = [
                    from.at[0] - looks.sheet_corner[0] + skip * step[0],
                    looks.sheet_corner[1] - from.at[1] + skip * step[1],
                ];
                for ((light, number), left) in pixels.iter_mut().zip(self.sheet.along(at, step)).zip(lefts) {
                    *light = self.faded(number, left);
                }
            }
            None => self.each(looks, (bare, soft), [&dx[x..], &dy[x..]], pixels),
        }
    }

    /// From `x` on, which lies after a node, up to `end`: the one colour of the pixels up to another node,
    /// if they all show the table and have one, and the first pixel after them.
    pub(super) fn even(&self, nodes: &[Node], x: usize, end: usize) -> Option<([u16; 3], usize)> {
        let first = x / self.stride;
        let here = nodes[first];
        let even = |pair: &[Node]| {
            pair[0].is_close(&pair[1]) && here.is_plain(&pair[1]) && here.left == pair[1].left
        };
        let most = (end - 1) / self.stride + 1 - first;
        let count = nodes[first..].windows(2).take(most).take_while(|pair| even(pair)).count();
        let colour = || dimmed(self.plain[usize::from(here.kind)], here.left);
        (count > 0).then(|| (colour(), end.min((first + count) * self.stride)))
    }

    /// Is nothing printed on the sheet between two places on it?
    fn is_blank(&self, looks: &Looks, from: &Node, to: &Node) -> bool {
        let on = |node: &Node| [node.at[0] - looks.sheet_corner[0], looks.sheet_corner[1] - node.at[1]];
        self.sheet.is_blank(on(from), on(to))
    }

    /// Colours pixels, each by itself, that see the table along these directions.
    fn each(&self, looks: &Looks, map: (&[u8], &[u32]), [dx, dy]: [&[f32]; 2], light: &mut [[u16; 3]]) {
        for ((light, dx), dy) in light.iter_mut().zip(dx).zip(dy) {
            *light = self.colour(looks, map, self.place(*dx, *dy));
        }
    }

    /// The colour of that number on the sheet, of which shadows leave `left` of 256.
    #[inline]
    fn faded(&self, number: u8, left: u32) -> [u16; 3] {
        dimmed(self.ink[usize::from(number)], left)
    }

    fn colour(&self, looks: &Looks, (bare, soft): (&[u8], &[u32]), at: [f32; 2]) -> [u16; 3] {
        let what = kind(bare, at);
        if what >= FLOOR {
            return self.plain[usize::from(what)];
        }
        let left = shade_at(soft, at);
        if on_sheet(looks, at) {
            let number = self.sheet.at(at[0] - looks.sheet_corner[0], looks.sheet_corner[1] - at[1]);
            return self.faded(number, left);
        }
        dimmed(self.plain[usize::from(TABLE_TOP)], left)
    }
}
