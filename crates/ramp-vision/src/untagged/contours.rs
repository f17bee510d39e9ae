//! The places of a drawing where its colour steps, and the part to which each belongs: the nearer of the two
//! sides.

use super::canvas::{Canvas, GROUND};
use super::solids::Colour;

/// Least step of a channel, grey levels after gamma.
const LEAST_STEP: i32 = 14;
/// The share of light that a shadow leaves: beside the ground, a step must be there in light and in shadow.
const SHADOW: f32 = 0.55;
/// Pixels that are looked at together.
const BLOCK: usize = 16;
/// Pixels at the border of the window in which no step is taken: its profile would leave it.
const BORDER: usize = 8;

/// Paper, and bare table, in even light.
pub const GROUNDS: [Colour; 2] = [[0.85; 3], [0.33, 0.31, 0.28]];

/// A place where the drawn colour steps.
#[derive(Clone, Copy, Debug)]
pub struct Step {
    /// Between two pixels.
    pub at: [f64; 2],
    /// The channel of the largest step: red, green or blue.
    pub channel: usize,
    /// Grey levels after gamma.
    strength: i32,
    /// The index of the pixel on the nearer side.
    pub inside: usize,
    /// What the ground beside it would be.
    pub ground: Colour,
    /// Whether both sides are of one material: light alone tells them apart, and a shadow may hide it.
    pub by_light: bool,
}

/// The steps of a part: one in each cell of the image that has some, row by row.
pub type Contour = Vec<Step>;

/// Grey levels of linear light.
fn level(light: f32) -> i32 {
    (light.max(0.0).powf(1.0 / 2.2) * 255.0) as i32
}

/// What is needed to judge a place of a drawing.
struct Drawing<'a> {
    canvas: &'a Canvas,
    /// By face: the part in the list, and grey levels.
    owner: Vec<Option<usize>>,
    levels: Vec<[i32; 3]>,
    /// By ground: grey levels in light and in shadow.
    bare: [[[i32; 3]; 2]; 2],
    ground: &'a dyn Fn([f64; 2]) -> usize,
}

/// The contours of the parts `0..count`, whose place in the list `part_of` gives by body. `cell` is the size
/// (pixels) of the squares of which each gives one step; `ground` tells which of [`GROUNDS`] is at a pixel.
pub fn contours(
    canvas: &Canvas,
    part_of: &dyn Fn(u16) -> Option<usize>,
    count: usize,
    cell: usize,
    ground: &dyn Fn([f64; 2]) -> usize,
) -> Vec<Contour> {
    let width = canvas.lens.size[0];
    let shade = level(SHADOW);
    let bare = GROUNDS.map(|colour| {
        let levels = colour.map(level);
        [levels, levels.map(|level| level * shade / 255)]
    });
    let owner = canvas.faces.iter().map(|face| part_of(face.body)).collect();
    let levels = canvas.faces.iter().map(|face| face.colour.map(level)).collect();
    let drawing = Drawing { canvas, owner, levels, bare, ground };
    let mut kept = Kept::new(canvas, cell);
    let [[left, right], [top, bottom]] = canvas.window();
    let right = right.saturating_sub(BORDER);
    for y in top + BORDER..bottom.saturating_sub(BORDER) {
        let row = y * width;
        let mut first = left + BORDER;
        while first < right {
            let last = (first + BLOCK).min(right);
            let here = &canvas.shown[row + first..row + last];
            let beside = &canvas.shown[row + first + 1..row + last + 1];
            let below = &canvas.shown[row + width + first..row + width + last];
            // Most blocks show one face each.
            if here != beside || here != below {
                for x in first..last {
                    let here = row + x;
                    let (x_middle, y_middle) = (x as f64 + 0.5, y as f64 + 0.5);
                    if let Some((part, step)) = drawing.step(here, here + 1, [x_middle + 0.5, y_middle]) {
                        kept.take(part, step, [x, y]);
                    }
                    if let Some((part, step)) = drawing.step(here, here + width, [x_middle, y_middle + 0.5]) {
                        kept.take(part, step, [x, y]);
                    }
                }
            }
            first = last;
        }
    }
    kept.by_part(count)
}

/// The strongest step of each cell, the first of several.
struct Kept {
    cell: usize,
    columns: usize,
    /// By cell: one more than the index of its last step in `all`.
    last: Vec<u32>,
    /// Part, cell and step.
    all: Vec<(usize, usize, Step)>,
}

impl Kept {
    fn new(canvas: &Canvas, cell: usize) -> Kept {
        let [columns, rows] = canvas.lens.size.map(|size| size.div_ceil(cell));
        Kept { cell, columns, last: vec![0; columns * rows], all: Vec::new() }
    }

    #[inline]
    fn take(&mut self, part: usize, step: Step, [x, y]: [usize; 2]) {
        let slot = (y / self.cell) * self.columns + x / self.cell;
        let last = &mut self.last[slot];
        match self.all.get_mut((*last as usize).wrapping_sub(1)) {
            Some((other, _, kept)) if *other == part => {
                if kept.strength < step.strength {
                    *kept = step;
                }
            }
            _ => {
                self.all.push((part, slot, step));
                *last = self.all.len() as u32;
            }
        }
    }

    /// By part, in the order of the cells.
    fn by_part(mut self, count: usize) -> Vec<Contour> {
        self.all.sort_by_key(|(part, slot, step)| (*part, *slot, -step.strength));
        self.all.dedup_by_key(|(part, slot, _)| (*part, *slot));
        let mut contours = vec![Contour::new(); count];
        for (part, _, step) in self.all {
            contours[part].push(step);
        }
        contours
    }
}

impl Drawing<'_> {
    /// The step between two neighbouring pixels, and the part to which it belongs.
    #[inline]
    fn step(&self, here: usize, there: usize, at: [f64; 2]) -> Option<(usize, Step)> {
        let canvas = self.canvas;
        let (a, b) = (canvas.shown[here], canvas.shown[there]);
        if a == b {
            return None;
        }
        let inside = if canvas.near[here] >= canvas.near[there] { here } else { there };
        let part = self.owner[canvas.shown[inside] as usize]?;
        let beside_ground = a == GROUND || b == GROUND;
        let ground = if beside_ground { (self.ground)(at) } else { 0 };
        let levels = |face: u32, shaded: usize| match face {
            GROUND => self.bare[ground][shaded],
            face => self.levels[face as usize],
        };
        let (from, to) = (levels(a, 0), levels(b, 0));
        // Only the ground may lie in a shadow that is not drawn.
        let (dark_from, dark_to) = if beside_ground { (levels(a, 1), levels(b, 1)) } else { (from, to) };
        let mut strongest = (0, 0);
        for channel in 0..3 {
            let step = from[channel] - to[channel];
            let other = dark_from[channel] - dark_to[channel];
            let strength = step.abs().min(other.abs());
            if step.signum() == other.signum() && strength > strongest.0 {
                strongest = (strength, channel);
            }
        }
        let (strength, channel) = strongest;
        let material = |face: u32| canvas.faces[face as usize].material;
        let by_light = !beside_ground && material(a) == material(b);
        let step = Step { at, channel, strength, inside, ground: GROUNDS[ground], by_light };
        (strength >= LEAST_STEP).then_some((part, step))
    }
}
