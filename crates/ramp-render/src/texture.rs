//! The printed sheet as pixels, in several sizes so that a far look at it does not flicker, and the cells of
//! tags.

use ramp_kit::{Kit, sheet, tags};
use resvg::{tiny_skia, usvg};

use crate::error::LooksError;

/// Pixels of the sheet's finest picture per millimetre.
const SCALE: f64 = 3.2;

/// Edge of the squares in which pixels are stored, so that those that are neighbours are so in memory too,
/// whichever way the camera is turned.
const TILE: usize = 8;

/// Index of a stored pixel.
#[inline]
fn place(width: usize, column: usize, row: usize) -> usize {
    let tiles = width.div_ceil(TILE);
    ((row / TILE * tiles + column / TILE) * TILE + row % TILE) * TILE + column % TILE
}

/// The number of a colour of the sheet, which is printed in grey and red: how bright its green is in steps of
/// two, and above them the same for red.
fn number(colour: u32) -> u8 {
    let [red, green] = [colour & 255, colour >> 8 & 255];
    (green / 2) as u8 | if red > green + 24 { 128 } else { 0 }
}

/// The colours of these numbers. The sheet's red throws back half of the red light.
fn colours() -> Vec<u32> {
    let colour = |number: u32| {
        let green = (number & 127) * 2;
        let red = if number & 128 == 0 { green } else { green.max(110) };
        red | green << 8 | green << 16
    };
    (0..256).map(colour).collect()
}

fn tiled(width: usize, height: usize, pixels: &[u32]) -> Vec<u8> {
    let mut tiled = vec![0; width.div_ceil(TILE) * height.div_ceil(TILE) * TILE * TILE];
    for (row, line) in pixels.chunks_exact(width).enumerate() {
        for (column, pixel) in line.iter().enumerate() {
            tiled[place(width, column, row)] = number(*pixel);
        }
    }
    tiled
}

/// Edge of the squares of pixels of the finest level of which it is known whether anything is printed there:
/// those of the levels up to [`BLANK_LEVEL`] lie in one of them each.
const SQUARE: usize = 8;
/// See [`SQUARE`].
const BLANK_LEVEL: usize = SQUARE.trailing_zeros() as usize;

/// Number of squares in front of and above a place that have something printed on them.
#[derive(Clone, Debug)]
struct Printed {
    columns: usize,
    /// By rows, one row and one column more than there are squares.
    counts: Vec<u32>,
}

impl Printed {
    /// Of pixels of which `is_paper` knows those without print.
    fn new(width: usize, height: usize, is_paper: impl Fn(usize, usize) -> bool) -> Printed {
        let (columns, rows) = (width.div_ceil(SQUARE) + 1, height.div_ceil(SQUARE) + 1);
        let mut counts = vec![0; columns * rows];
        for row in 1..rows {
            let mut here = 0;
            for column in 1..columns {
                let within = |at: usize, end: usize| (at - 1) * SQUARE..(at * SQUARE).min(end);
                let blank = within(row, height).all(|y| within(column, width).all(|x| is_paper(x, y)));
                here += u32::from(!blank);
                counts[row * columns + column] = counts[(row - 1) * columns + column] + here;
            }
        }
        Printed { columns, counts }
    }

    /// Is nothing printed on these squares, the first and the last of both directions?
    #[inline]
    fn is_blank(&self, [left, right]: [usize; 2], [top, low]: [usize; 2]) -> bool {
        let rows = [top, low + 1].map(|row| self.counts.get(row * self.columns..));
        let [Some(above), Some(below)] = rows else { return false };
        let count = |row: &[u32]| Some(row.get(right + 1)?.wrapping_sub(*row.get(left)?));
        right + 1 < self.columns && count(above) == count(below)
    }
}

/// A picture on the table.
#[derive(Clone, Debug)]
pub struct Texture {
    /// From fine to coarse: width, height and pixels in tiles, each a number of a colour. A byte each,
    /// because most of the time of looking them up is waiting for memory.
    levels: Vec<(usize, usize, Vec<u8>)>,
    /// The colours: red, green, blue in linear light, lowest byte first.
    colours: Vec<u32>,
    /// Pixels of the finest level per metre.
    pub per_metre: f32,
    /// The number of bare paper's colour.
    paper: u8,
    printed: Printed,
}

impl Texture {
    /// The start sheet of a kit, with its tag or without.
    ///
    /// # Errors
    /// A sheet that cannot be drawn.
    pub fn sheet(kit: &Kit, tag: bool) -> Result<Texture, LooksError> {
        let drawing = if tag { sheet::start_sheet(kit) } else { sheet::start_sheet_without_tag(kit) }?;
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
        let paper = number(linear[255] * 0x01_01_01);
        let (width, height, finest) = &levels[0];
        let printed = Printed::new(*width, *height, |x, y| number(finest[y * width + x]) == paper);
        let levels = levels
            .iter()
            .map(|(width, height, pixels)| (*width, *height, tiled(*width, *height, pixels)))
            .collect();
        Ok(Texture { levels, colours: colours(), per_metre: (SCALE * 1e3) as f32, paper, printed })
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

    /// The colour of paper on which nothing is printed.
    pub fn paper(&self) -> u32 {
        self.colours[usize::from(self.paper)]
    }

    /// Is nothing printed around a place (m from the upper left corner), `size` (m) wide?
    pub fn is_blank(&self, [x, y]: [f32; 2], size: f32) -> bool {
        let (width, height, pixels) = &self.levels[0];
        let range = |value: f32, end: usize| {
            let at = |value: f32| ((value * self.per_metre).max(0.0) as usize).min(end - 1);
            at(value - size / 2.0)..=at(value + size / 2.0)
        };
        range(y, *height)
            .all(|row| range(x, *width).all(|column| pixels[place(*width, column, row)] == self.paper))
    }

    /// The picture on a level.
    pub fn on(&self, level: usize) -> Level<'_> {
        let (width, height, pixels) = &self.levels[level];
        let colours = &self.colours;
        Level {
            width: *width,
            height: *height,
            pixels,
            colours,
            scale: self.per_metre / (1u32 << level) as f32,
            printed: (level <= BLANK_LEVEL).then_some((&self.printed, self.per_metre)),
        }
    }
}

/// A [`Texture`] in one size.
pub struct Level<'a> {
    width: usize,
    height: usize,
    pixels: &'a [u8],
    colours: &'a [u32],
    scale: f32,
    /// The print, and the finest level's pixels per metre; none on coarse levels.
    printed: Option<(&'a Printed, f32)>,
}

impl Level<'_> {
    /// The number of the colour of the pixel at a place in metres from the upper left corner.
    #[inline]
    pub fn at(&self, x: f32, y: f32) -> u8 {
        self.pixel((x * self.scale) as usize, (y * self.scale) as usize)
    }

    #[inline]
    fn pixel(&self, column: usize, row: usize) -> u8 {
        let (column, row) = (column.min(self.width - 1), row.min(self.height - 1));
        self.pixels.get(place(self.width, column, row)).copied().unwrap_or_default()
    }

    /// Is nothing printed between two places, in metres from the upper left corner? Not always known.
    #[inline]
    pub fn is_blank(&self, a: [f32; 2], b: [f32; 2]) -> bool {
        let Some((printed, per_metre)) = self.printed else { return false };
        let squares = |a: f32, b: f32| {
            // A pixel more on both sides, for what is rounded.
            let low = (a.min(b) * per_metre - 1.0).max(0.0) as usize;
            let high = (a.max(b) * per_metre + 1.0).max(0.0) as usize;
            [low / SQUARE, high / SQUARE]
        };
        printed.is_blank(squares(a[0], b[0]), squares(a[1], b[1]))
    }

    /// The numbers of the colours along a straight line, from a place on the picture (as for [`Level::at`])
    /// in equal steps for as long as it does not leave the picture.
    #[inline]
    pub fn along(&self, from: [f32; 2], step: [f32; 2]) -> impl Iterator<Item = u8> {
        // Whole pixels and their 65536th parts: nothing to be rounded from pixel to pixel.
        let fixed = |value: f32| (value * self.scale * 65536.0) as i32;
        let ([mut x, mut y], [step_x, step_y]) = (from.map(fixed), step.map(fixed));
        std::iter::repeat_with(move || {
            let number = self.pixel((x.max(0) >> 16) as usize, (y.max(0) >> 16) as usize);
            (x, y) = (x.wrapping_add(step_x), y.wrapping_add(step_y));
            number
        })
    }

    /// The colour of that number: red, green and blue in the bytes, lowest first.
    #[inline]
    pub fn colour(&self, number: u8) -> u32 {
        self.colours[usize::from(number)]
    }
}

/// Reflectance of a tag's white and black.
pub const TAG_LIGHT: [f32; 2] = [0.82, 0.035];

/// Cells across a tag with the ring of white that the sticker adds.
const ACROSS: usize = tags::CELLS + 2;
/// Places in a pixel that are asked whether they are white where a pixel shows more than one cell.
pub const PLACES: usize = 16;

/// A tag's cells in a frame that begins at the sticker's corner.
#[derive(Clone, Debug)]
pub struct Cells {
    /// By row from the top, with a ring of white around for the sticker's edge: a bit for each white cell,
    /// the lowest the one on the left. As many rows as four bits can count, so that no index is out of range.
    bright: [u16; 16],
    /// Cells per metre.
    per_metre: f32,
}

impl Cells {
    /// The tag of that id with a black edge of `edge` metres; `None` for an id the family does not have.
    pub fn new(id: u32, edge: f64) -> Option<Cells> {
        const { assert!(ACROSS <= 16) };
        let cells = tags::cells(id)?;
        let mut bright = [u16::MAX; 16];
        for (row, line) in cells.iter().enumerate() {
            for (column, black) in line.iter().enumerate() {
                bright[row + 1] &= !(u16::from(*black) << (column + 1));
            }
        }
        Some(Cells { bright, per_metre: (tags::BLACK_CELLS as f64 / edge) as f32 })
    }

    /// As many cells, all of them white.
    #[must_use]
    pub fn blank(&self) -> Cells {
        Cells { bright: [u16::MAX; 16], per_metre: self.per_metre }
    }

    /// The row or column at a place that many cells from the first one's beginning, less a half: the nearest
    /// one then. In a form that processors do four at a time; adding two to the power of 23 leaves the whole
    /// number in the lowest bits.
    #[inline]
    fn nearest(value: f32) -> usize {
        const LAST: f32 = (ACROSS - 1) as f32;
        let value = if value > 0.0 { value } else { 0.0 };
        let value = if value < LAST { value } else { LAST };
        ((value + 8_388_608.0).to_bits() & 15) as usize
    }

    /// Number of the [`PLACES`] in a parallelogram around (x, y) with the sides `a` and `b` are white, all
    /// in the tag's frame G (x right, y up, m).
    #[inline]
    pub fn white(&self, x: f32, y: f32, a: [f32; 2], b: [f32; 2]) -> usize {
        const MIDDLE: f32 = ACROSS as f32 / 2.0 - 0.5;
        // From here on in cells, from the left and from the top.
        let (column, row) = (MIDDLE + x * self.per_metre, MIDDLE - y * self.per_metre);
        let [a, b] = [a, b].map(|[x, y]| [x * self.per_metre, -y * self.per_metre]);
        let (hx, hy) = (0.5 * (a[0].abs() + b[0].abs()), 0.5 * (a[1].abs() + b[1].abs()));
        // Is all that could be seen of one colour?
        let (left, right) = (Self::nearest(column - hx), Self::nearest(column + hx));
        let (top, low) = (Self::nearest(row - hy), Self::nearest(row + hy));
        let mask = (2u16 << right).wrapping_sub(1 << left);
        let (mut all, mut any) = (mask, 0);
        for row in top..=low {
            all &= self.bright[row & 15];
            any |= self.bright[row & 15];
        }
        if all == mask {
            return PLACES;
        }
        if any & mask == 0 {
            return 0;
        }
        // No two of them in one row or column of the pixel.
        let mut places = [[0; 2]; PLACES];
        for (place, [u, v]) in places.iter_mut().zip(SPREAD) {
            *place = [Self::nearest(row + u * a[1] + v * b[1]), Self::nearest(column + u * a[0] + v * b[0])];
        }
        places.iter().map(|[row, column]| usize::from(self.bright[row & 15] >> (column & 15) & 1)).sum()
    }
}

/// Positions of the [`PLACES`] in a pixel, as shares of its sides from its middle.
const SPREAD: [[f32; 2]; PLACES] = {
    let mut places = [[0.0; 2]; PLACES];
    let mut place = 0;
    while place < PLACES {
        places[place] = [
            (place as f32 + 0.5) / PLACES as f32 - 0.5,
            ((place * 5 % PLACES) as f32 + 0.5) / PLACES as f32 - 0.5,
        ];
        place += 1;
    }
    places
};
