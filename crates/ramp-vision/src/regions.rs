//! The regions of an image in which a tag can be, so that the detector looks at nothing else.
//!
//! A tag is a black square with white cells inside and white around it. The regions are found as the detector
//! finds its candidates: pixels are told black from white by the contrast nearby, and black ones that touch
//! are one blob. A blob is a candidate if it is large enough, its hull is about a parallelogram, and some of
//! that is white. All of this is decided with a margin: a region too many costs time, a missing one a tag.

use crate::blobs::{Blob, Run, blobs};
use crate::image::Grey;
use ramp_kit::tags::BLACK_CELLS;
use std::ops::Range;

/// Edge of the squares of pixels from which the contrast is computed, as the detector has it, pixels.
const TILE: usize = 4;
/// Fewest pixels of a blob that the detector uses.
const LEAST_PIXELS: f64 = 25.0;
/// Least area of the box around a blob, pixels: the detector wants a square of seven pixels.
const LEAST_BOX: usize = 40;
/// Largest share of the image that a tag's black square covers: with the white around it, a larger one would
/// not fit into the image.
const LARGEST: f64 = 0.25;
/// Least and largest share of white pixels in the hull of a blob. 4288 tags of 180 images had 0.13 to 0.36.
const WHITE: [f64; 2] = [0.1, 0.4];
/// Least share of the hull that is black or white, in a tag of small cells: there is contrast everywhere.
/// The same tags had 0.81 and more.
const COVERED: f64 = 0.7;
/// From an edge on there is contrast so far to both sides together, pixels: in larger cells only there.
const SEEN: f64 = 8.0;
/// Least and largest area of the hull over the root of the determinant of its covariance: 12 for a square and
/// for what it looks like from aside, 10.4 for a triangle, 12.6 for an ellipse. The same tags had 10.9 to
/// 12.3.
const SQUARE: [f64; 2] = [10.7, 12.5];
/// Largest ratio of the hull's length to its width: a square that is seen at 80° from its normal.
const LONGEST: f64 = 6.0;
/// The region of a blob is the ellipse with the covariance of its hull's pixels times this: a square with the
/// ring of white around it, a seventh of its edge wide, just fits into 9.9.
const AROUND: f64 = 10.5;
/// And this much wider to all sides, pixels.
const MARGIN: f64 = 2.0;
/// Distance of the middle of a tag from that of its blob's hull, as a share of the larger edge of the box
/// around its region, and in pixels: a view from nearby shifts it.
const OFF_MIDDLE: (f64, f64) = (0.1, 1.0);

/// Least and largest area of the tag over that of its blob's hull, which the edges of the image may cut.
const AREA: [f64; 2] = [0.7, 1.6];

/// An ellipse in an image in which a tag can be, or all of the image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Region {
    /// First column of the box around it, pixels. Its edges lie on those of tiles or of the image.
    pub left: usize,
    /// First row.
    pub top: usize,
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// The tag; none for all of an image.
    hull: Option<Hull>,
}

/// The hull of a blob.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Hull {
    /// Middle of the tag, pixels.
    middle: [f64; 2],
    /// Within this distance along both axes, pixels.
    off: f64,
    /// Pixels.
    area: f64,
    /// The region's ellipse: half its width squared, the same times the slope of its middle, and half its
    /// height squared, pixels².
    ellipse: [f64; 3],
}

impl Region {
    /// A whole image, with tags anywhere.
    pub fn whole(grey: &Grey) -> Region {
        let Grey { width, height, .. } = *grey;
        Region { left: 0, top: 0, width, height, hull: None }
    }

    /// The region of a blob in an image of `width` by `height` pixels.
    fn around(blob: &Blob, width: usize, height: usize) -> Region {
        let (middle, hull) = blob.shape();
        let wider = |square: f64| ((square * AROUND).sqrt() + MARGIN).powi(2);
        let [xx, yy] = [wider(hull[0]), wider(hull[2])];
        let xy = hull[1] * (xx * yy / (hull[0] * hull[2])).sqrt();
        let reach = [xx.sqrt(), yy.sqrt()];
        let tile = |at: f64, end: usize| (at.max(0.0) as usize).next_multiple_of(TILE).min(end);
        let low = |axis: usize| (middle[axis] - reach[axis]).max(0.0) as usize / TILE * TILE;
        let (left, top) = (low(0), low(1));
        let off = OFF_MIDDLE.0 * 2.0 * reach[0].max(reach[1]) + OFF_MIDDLE.1;
        Region {
            left,
            top,
            width: tile((middle[0] + reach[0]).ceil(), width) - left,
            height: tile((middle[1] + reach[1]).ceil(), height) - top,
            hull: Some(Hull { middle, off, area: blob.area(), ellipse: [xx, xy, yy] }),
        }
    }

    /// Is it for the tag with its middle at this pixel and this area, pixels?
    pub fn is_for(&self, middle: [f64; 2], area: f64) -> bool {
        let Some(hull) = &self.hull else { return true };
        let near = (0..2).all(|axis| (middle[axis] - hull.middle[axis]).abs() <= hull.off);
        near && within(area / hull.area, AREA)
    }

    /// Is it all of an image?
    pub fn is_whole(&self) -> bool {
        self.hull.is_none()
    }

    /// Its columns in a row of the image, of those of its box.
    pub fn columns(&self, row: usize) -> Range<usize> {
        let end = self.left + self.width;
        let Some(Hull { middle, ellipse: [xx, xy, yy], .. }) = self.hull else { return self.left..end };
        let y = row as f64 + 0.5 - middle[1];
        let half = ((xx - xy * xy / yy) * (1.0 - y * y / yy)).max(0.0).sqrt();
        let middle = middle[0] + y * xy / yy;
        let from = ((middle - half).max(0.0) as usize).clamp(self.left, end);
        from..((middle + half).max(0.0).ceil() as usize).clamp(from, end)
    }
}

/// The regions in which a tag can be. `contrast` is the least difference between black and white nearby,
/// levels of 255.
pub fn regions(grey: &Grey, contrast: u8) -> Vec<Region> {
    if grey.width < TILE || grey.height < TILE {
        return Vec::new();
    }
    let limits = Limits::new(grey, contrast);
    let found = blobs(grey.height, |row, runs| limits.runs(grey, row, runs));
    let largest = LARGEST * (grey.width * grey.height) as f64;
    let candidates = found.iter().filter(|blob| is_candidate(blob, largest));
    candidates.map(|blob| Region::around(blob, grey.width, grey.height)).collect()
}

fn within(value: f64, [least, most]: [f64; 2]) -> bool {
    value >= least && value <= most
}

/// Can this be a tag, of an area of at most `largest` pixels? Around one there is white.
fn is_candidate(blob: &Blob, largest: f64) -> bool {
    let (wide, high) = (blob.right - blob.left, blob.end - blob.top);
    if wide * high < LEAST_BOX || blob.pixels < LEAST_PIXELS || blob.area() > largest {
        return false;
    }
    let (_, [xx, xy, yy]) = blob.shape();
    // Standard deviations along and across.
    let (mean, half) = ((xx + yy) / 2.0, ((xx - yy) / 2.0).hypot(xy));
    let [length, breadth] = [mean + half, (mean - half).max(1e-3)].map(f64::sqrt);
    let cell = blob.area().sqrt() / BLACK_CELLS as f64;
    let covered = COVERED * (SEEN / cell).min(1.0);
    within(blob.white / blob.area(), WHITE)
        && blob.white + blob.pixels >= covered * blob.area()
        && within(blob.area() / (length * breadth), SQUARE)
        && length <= LONGEST * breadth
}

/// For each tile the light below which a pixel is black; 0 where there is no contrast.
struct Limits {
    columns: usize,
    rows: usize,
    limits: Vec<u8>,
}

impl Limits {
    fn new(grey: &Grey, contrast: u8) -> Limits {
        let (columns, rows) = (grey.width / TILE, grey.height / TILE);
        let mut low = vec![u8::MAX; columns * rows];
        let mut high = vec![0; columns * rows];
        let mut four = [vec![0; grey.width], vec![0; grey.width]];
        for (row, pixels) in grey.pixels.chunks_exact(TILE * grey.width).enumerate() {
            let [darkest, brightest] = &mut four;
            darkest.copy_from_slice(&pixels[..grey.width]);
            brightest.copy_from_slice(&pixels[..grey.width]);
            for line in pixels[grey.width..].chunks_exact(grey.width) {
                darkest.iter_mut().zip(line).for_each(|(low, pixel)| *low = (*low).min(*pixel));
                brightest.iter_mut().zip(line).for_each(|(high, pixel)| *high = (*high).max(*pixel));
            }
            let tiles = row * columns..(row + 1) * columns;
            for (low, [a, b, c, d]) in low[tiles.clone()].iter_mut().zip(darkest.as_chunks().0) {
                *low = *a.min(b).min(c.min(d));
            }
            for (high, [a, b, c, d]) in high[tiles].iter_mut().zip(brightest.as_chunks().0) {
                *high = *a.max(b).max(c.max(d));
            }
        }
        let low = with_neighbours(&low, columns, u8::min);
        let high = with_neighbours(&high, columns, u8::max);
        let limit = |(low, high): (&u8, &u8)| {
            let difference = high - low;
            if difference < contrast { 0 } else { low + difference / 2 + 1 }
        };
        Limits { columns, rows, limits: low.iter().zip(&high).map(limit).collect() }
    }

    /// The runs of black pixels in a row, and the white ones before each.
    fn runs(&self, grey: &Grey, row: usize, runs: &mut Vec<Run>) {
        let Some(limits) = self.limits.chunks_exact(self.columns).nth((row / TILE).min(self.rows - 1)) else {
            return;
        };
        let pixels = &grey.pixels[row * grey.width..][..grey.width];
        let mut white = 0;
        let mut open = false;
        for (tile, (limit, four)) in limits.iter().zip(pixels.as_chunks::<TILE>().0).enumerate() {
            if *limit == 0 {
                open = false;
                continue;
            }
            for (place, pixel) in four.iter().enumerate() {
                if pixel >= limit {
                    white += 1;
                    open = false;
                    continue;
                }
                let at = TILE * tile + place;
                match runs.last_mut() {
                    Some(run) if open => run.end = at + 1,
                    _ => runs.push(Run { from: at, end: at + 1, white }),
                }
                open = true;
            }
        }
    }
}

/// Each value joined with those of the eight tiles around it.
fn with_neighbours(values: &[u8], columns: usize, join: impl Fn(u8, u8) -> u8) -> Vec<u8> {
    let mut across = values.to_vec();
    for (across, values) in across.chunks_exact_mut(columns).zip(values.chunks_exact(columns)) {
        across[1..].iter_mut().zip(values).for_each(|(to, value)| *to = join(*to, *value));
        across.iter_mut().zip(&values[1..]).for_each(|(to, value)| *to = join(*to, *value));
    }
    let mut all = across.clone();
    all[columns..].iter_mut().zip(&across).for_each(|(to, value)| *to = join(*to, *value));
    all.iter_mut().zip(&across[columns..]).for_each(|(to, value)| *to = join(*to, *value));
    all
}
