//! The printed sheet as pixels, in several sizes so that a far look at it does not flicker, and the cells of tags.

use ramp_kit::{Kit, sheet, tags};
use resvg::{tiny_skia, usvg};

use crate::looks::LooksError;

/// Pixels of the sheet's finest picture per millimetre.
const SCALE: f64 = 3.2;

/// A picture on the table.
#[derive(Clone, Debug)]
pub struct Texture {
    /// From fine to coarse: width, height and pixels (red, green, blue in linear light, lowest byte first).
    levels: Vec<(usize, usize, Vec<u32>)>,
    /// Pixels of the finest level per metre.
    pub per_metre: f32,
}

impl Texture {
    /// The start sheet of a kit.
    ///
    /// # Errors
    /// A sheet that cannot be drawn.
    pub fn sheet(kit: &Kit) -> Result<Texture, LooksError> {
        let drawing = sheet::start_sheet(kit)?;
        let options = usvg::Options { dpi: 25.4, ..usvg::Options::default() };
        let tree = usvg::Tree::from_str(&drawing.svg(), &options)
            .map_err(|error| LooksError::Sheet(error.to_string()))?;
        let [width, height] = drawing.size.map(|edge| (edge * SCALE).ceil() as u32);
        let mut pixmap = tiny_skia::Pixmap::new(width, height)
            .ok_or_else(|| LooksError::Sheet(format!("it has no size: {width} × {height}")))?;
        let zoom = tiny_skia::Transform::from_scale(SCALE as f32, SCALE as f32);
        resvg::render(&tree, zoom, &mut pixmap.as_mut());
        // Paper reflects 80 % of the light.
        let linear: Vec<u32> =
            (0..256).map(|value| ((value as f64 / 255.0).powf(2.2) * 0.8 * 255.0).round() as u32).collect();
        let pixels: Vec<u32> = pixmap
            .pixels()
            .iter()
            .map(|p| {
                let [r, g, b] = [p.red(), p.green(), p.blue()].map(|value| linear[value as usize]);
                r | g << 8 | b << 16
            })
            .collect();
        let mut levels = vec![(width as usize, height as usize, pixels)];
        while let Some((width, height, pixels)) = levels.last().filter(|level| level.0.min(level.1) > 32) {
            let (w, h) = (width / 2, height / 2);
            let mut half = Vec::with_capacity(w * h);
            for y in 0..h {
                for x in 0..w {
                    let at = |dx: usize, dy: usize| pixels[(2 * y + dy) * width + 2 * x + dx];
                    let four = [at(0, 0), at(1, 0), at(0, 1), at(1, 1)];
                    let mean = |shift: u32| (four.iter().map(|p| p >> shift & 255).sum::<u32>() + 2) / 4;
                    half.push(mean(0) | mean(8) << 8 | mean(16) << 16);
                }
            }
            levels.push((w, h, half));
        }
        Ok(Texture { levels, per_metre: (SCALE * 1e3) as f32 })
    }

    /// The level on which a pixel that covers `size` metres should be looked up.
    pub fn level(&self, size: f32) -> usize {
        let texels = size * self.per_metre;
        let last = self.levels.len() - 1;
        // As fine as the pixel: the lens's blur does the rest.
        let mut level = 0;
        while level < last && texels > (1.5 * (1u32 << level) as f32) {
            level += 1;
        }
        level
    }

    /// The picture on a level.
    pub fn on(&self, level: usize) -> Level<'_> {
        let (width, height, pixels) = &self.levels[level];
        Level { width: *width, height: *height, pixels, scale: self.per_metre / (1u32 << level) as f32 }
    }
}

/// A [`Texture`] in one size.
pub struct Level<'a> {
    width: usize,
    height: usize,
    pixels: &'a [u32],
    scale: f32,
}

impl Level<'_> {
    /// The colour of the pixel at a place in metres from the upper left corner; red, green and blue in the bytes of the
    /// answer, lowest first.
    #[inline]
    pub fn at(&self, x: f32, y: f32) -> u32 {
        let column = ((x * self.scale) as usize).min(self.width - 1);
        let row = ((y * self.scale) as usize).min(self.height - 1);
        self.pixels.get(row * self.width + column).copied().unwrap_or_default()
    }
}

/// How much light a tag's white and black throw back.
pub const TAG_LIGHT: [f32; 2] = [0.82, 0.035];

/// A tag's cells in a frame that begins at the sticker's corner.
#[derive(Clone, Debug)]
pub struct Cells {
    /// By row from the top, with a ring of white around for the sticker's edge.
    bright: [[bool; tags::CELLS + 2]; tags::CELLS + 2],
    /// Edge of a cell, m.
    pub cell: f32,
}

impl Cells {
    /// The tag of that id with a black edge of `edge` metres; `None` for an id the family does not have.
    pub fn new(id: u32, edge: f64) -> Option<Cells> {
        let cells = tags::cells(id)?;
        let mut bright = [[true; tags::CELLS + 2]; tags::CELLS + 2];
        for (row, line) in cells.iter().enumerate() {
            for (column, black) in line.iter().enumerate() {
                bright[row + 1][column + 1] = !black;
            }
        }
        Some(Cells { bright, cell: (edge / tags::BLACK_CELLS as f64) as f32 })
    }

    /// The cell at a place in the tag's frame G (x right, y up, m).
    #[inline]
    fn index(&self, x: f32, y: f32) -> (usize, usize) {
        let middle = (tags::CELLS + 2) as f32 / 2.0;
        let last = (tags::CELLS + 1) as f32;
        let clamp = |value: f32| value.max(0.0).min(last) as usize;
        (clamp(middle - y / self.cell), clamp(middle + x / self.cell))
    }

    /// Share of white in a parallelogram around (x, y) with the sides `a` and `b`, all in G, m.
    #[inline]
    pub fn white(&self, x: f32, y: f32, a: [f32; 2], b: [f32; 2]) -> f32 {
        let (hx, hy) = (0.5 * (a[0].abs() + b[0].abs()), 0.5 * (a[1].abs() + b[1].abs()));
        let (low, high) = (self.index(x - hx, y - hy), self.index(x + hx, y + hy));
        if low == high {
            return f32::from(u8::from(self.bright[low.0][low.1]));
        }
        // Sixteen places, no two of them in one row or column of the pixel.
        let mut count = 0;
        for place in 0..16u32 {
            let u = (place as f32 + 0.5) / 16.0 - 0.5;
            let v = ((place * 5 % 16) as f32 + 0.5) / 16.0 - 0.5;
            let (row, column) = self.index(x + u * a[0] + v * b[0], y + u * a[1] + v * b[1]);
            count += u32::from(self.bright[row][column]);
        }
        count as f32 / 16.0
    }
}
