//! The drawings, measured on pixels. The tags are read by the reference detector.

use apriltag::{DetectorBuilder, Family, Image};
use ramp_kit::drawing::{self, Drawing};
use ramp_kit::{Kit, board, read_kit, sheet, tags, tiles};
use resvg::{tiny_skia, usvg};
use std::path::Path;

fn kit() -> Kit {
    read_kit(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/kit.xml")).unwrap()
}

/// Grey pixels of a page, `scale` to the millimetre.
struct Pixels {
    width: usize,
    height: usize,
    scale: f64,
    grey: Vec<u8>,
}

impl Pixels {
    fn of(drawing: &Drawing, scale: f64) -> Pixels {
        let options = usvg::Options { dpi: 25.4, ..usvg::Options::default() };
        let tree = usvg::Tree::from_str(&drawing.svg(), &options).unwrap();
        // At one unit per millimetre, its size on paper is the drawing's.
        let [width, height] = drawing.size;
        assert!((f64::from(tree.size().width()) - width).abs() < 1e-3, "{:?}", tree.size());
        assert!((f64::from(tree.size().height()) - height).abs() < 1e-3);
        let (width, height) = ((width * scale).round() as u32, (height * scale).round() as u32);
        let mut pixmap = tiny_skia::Pixmap::new(width, height).unwrap();
        let zoom = tiny_skia::Transform::from_scale(scale as f32, scale as f32);
        resvg::render(&tree, zoom, &mut pixmap.as_mut());
        let grey = pixmap.pixels().iter().map(|p| p.green()).collect();
        Pixels { width: width as usize, height: height as usize, scale, grey }
    }

    fn tags(&self) -> Vec<(usize, [f64; 2], [[f64; 2]; 4])> {
        let mut detector = DetectorBuilder::new().add_family_bits(Family::tag_25h9(), 1).build().unwrap();
        detector.set_decimation(1.0);
        let mut image = Image::zeros_with_alignment(self.width, self.height, 16).unwrap();
        let stride = image.stride();
        for (row, pixels) in self.grey.chunks_exact(self.width).enumerate() {
            image.as_slice_mut()[row * stride..][..self.width].copy_from_slice(pixels);
        }
        let mm = |p: [f64; 2]| p.map(|v| v / self.scale);
        let mut found: Vec<_> =
            detector.detect(&image).iter().map(|d| (d.id(), mm(d.center()), d.corners().map(mm))).collect();
        found.sort_by_key(|(id, ..)| *id);
        found
    }

    /// The dark lines on a straight segment from `from` to `to` (mm): the middle of each, mm along
    /// the segment.
    fn crossings(&self, from: [f64; 2], to: [f64; 2]) -> Vec<f64> {
        let length = (to[0] - from[0]).hypot(to[1] - from[1]);
        let steps = (length * self.scale * 2.0) as usize;
        let mut found = Vec::new();
        let mut run: Option<(f64, f64)> = None;
        for step in 0..=steps {
            let share = step as f64 / steps as f64;
            let at = |axis: usize| (from[axis] + (to[axis] - from[axis]) * share) * self.scale;
            let (column, row) = (at(0) as usize, at(1) as usize);
            let dark = self.grey[row.min(self.height - 1) * self.width + column.min(self.width - 1)] < 128;
            let along = length * share;
            run = match (dark, run) {
                (true, None) => Some((along, along)),
                (true, Some((begin, _))) => Some((begin, along)),
                (false, Some((begin, end))) => {
                    found.push((begin + end) / 2.0);
                    None
                }
                (false, None) => None,
            };
        }
        found
    }
}

#[track_caller]
fn near(found: f64, expected: f64) {
    assert!((found - expected).abs() < 0.2, "found {found} mm, expected {expected} mm");
}

#[test]
fn our_tags_are_the_family_s() {
    for id in 0..tags::COUNT {
        let mut drawing = Drawing::new("tag", [40.0, 40.0]);
        let cells = tags::cells(id).unwrap();
        for (row, line) in cells.iter().enumerate() {
            for (column, _) in line.iter().enumerate().filter(|(_, black)| **black) {
                let at = [6.5 + 3.0 * column as f64, 6.5 + 3.0 * row as f64];
                drawing.rectangle(at, [3.0; 2], Some(drawing::BLACK), None);
            }
        }
        let found = Pixels::of(&drawing, 6.0).tags();
        assert_eq!(found.len(), 1, "{id}");
        assert_eq!(found[0].0, id as usize);
    }
    assert_eq!(tags::cells(tags::COUNT), None);
}

#[test]
fn the_sheet_is_a2_and_its_outlines_are_where_the_kit_says() {
    let kit = kit();
    let drawing = sheet::start_sheet(&kit).unwrap();
    assert_eq!(drawing.size, drawing::A2);
    let pdf = drawing::pdf("sheet", std::slice::from_ref(&drawing));
    let text = String::from_utf8_lossy(&pdf);
    let media = text.split("/MediaBox [").nth(1).unwrap().split(']').next().unwrap();
    let size: Vec<f64> = media.split_whitespace().map(|n| n.parse::<f64>().unwrap() / 72.0 * 25.4).collect();
    assert!((size[2] - 594.0).abs() < 0.001 && (size[3] - 420.0).abs() < 0.001, "{media}");
    assert!(text.contains("/PrintScaling /None"));
    assert_eq!(pdf, drawing::pdf("sheet", &[sheet::start_sheet(&kit).unwrap()]));

    let pixels = Pixels::of(&drawing, 8.0);
    for beam in &kit.beams {
        let Some(start) = beam.start else { continue };
        let [x, y] = start.at.map(|v| v * 1e3);
        let ends = |kind: ramp_kit::JointType| if kind.is_male() { 10.0 } else { 13.6 };
        let (first, last) = (beam.joints.first().unwrap(), beam.joints.last().unwrap());
        // Along the beam beside its holes, from outside one end to outside the other.
        let row = y + 6.0;
        let (from, to) = (x - 17.0, x + beam.span() * 1e3 + 17.0);
        let found = pixels.crossings([from, row], [to.min(593.9), row]);
        near(from + found.first().unwrap(), x - ends(first.kind));
        near(from + found.last().unwrap(), x + beam.span() * 1e3 + ends(last.kind));
        // Across it: 26.6 wide at every joint.
        for joint in &beam.joints {
            let column = x + joint.offset * 1e3 - if joint.offset > 0.0 { 6.5 } else { -6.5 };
            let (above, below) = (y - 16.0, y + 16.0);
            let found = pixels.crossings([column, above], [column, below]);
            near(above + found.first().unwrap(), y - 13.3);
            near(above + found.last().unwrap(), y + 13.3);
        }
    }
    for holder in &kit.holders {
        let [x, y] = holder.centre.map(|v| v * 1e3);
        let column = x + 20.0;
        let found = pixels.crossings([column, y - 21.0], [column, y + 21.0]);
        near(y - 21.0 + found.first().unwrap(), y - 20.0);
        near(y - 21.0 + found.last().unwrap(), y + 20.0);
    }
}

#[test]
fn the_tag_on_the_sheet_is_read_where_it_is() {
    let kit = kit();
    let found = Pixels::of(&sheet::start_sheet(&kit).unwrap(), 5.0).tags();
    assert_eq!(found.len(), 1, "{found:?}");
    let (id, centre, corners) = &found[0];
    assert_eq!(*id, 0);
    near(centre[0], 524.58);
    near(centre[1], 320.45);
    // The detector starts at the lower left corner of an upright tag and proceeds anticlockwise.
    for (corner, sign) in corners.iter().zip([[-1.0, 1.0], [1.0, 1.0], [1.0, -1.0], [-1.0, -1.0]]) {
        near(corner[0], 524.58 + sign[0] * 75.5 / 2.0);
        near(corner[1], 320.45 + sign[1] * 75.5 / 2.0);
    }
}

#[test]
fn every_sticker_is_read_with_the_right_id() {
    let kit = kit();
    for paper in [drawing::A4, drawing::LETTER] {
        assert_eq!(ids_on(&sheet::tag_sheets(&kit, paper), paper), (1..=33).collect::<Vec<usize>>());
    }
}

/// The tags of the pages in order; each has its size and its label.
#[test]
fn the_calibration_sheet_is_read_where_its_tags_are() {
    let [width, height] = drawing::A4;
    let [short, long] = drawing::LETTER;
    for paper in [[height, width], [long, short]] {
        let found = Pixels::of(&sheet::calibration_sheet(paper), 8.0).tags();
        let places = board::places();
        assert_eq!(found.len(), places.len());
        for ((id, centre, _), place) in found.iter().zip(&places) {
            assert_eq!(*id, place.id as usize);
            let at = place.x_pg.translation.vector * 1e3;
            near(centre[0], paper[0] / 2.0 + at.x);
            near(centre[1], paper[1] / 2.0 - at.y);
        }
    }
}

fn ids_on(pages: &[Drawing], paper: [f64; 2]) -> Vec<usize> {
    let mut ids = Vec::new();
    for page in pages {
        assert_eq!(page.size, paper);
        let svg = page.svg();
        for (id, _, corners) in Pixels::of(page, 8.0).tags() {
            for side in 0..4 {
                let (a, b) = (corners[side], corners[(side + 1) % 4]);
                near((a[0] - b[0]).hypot(a[1] - b[1]), 19.0);
            }
            // Its label stands below it.
            assert!(svg.contains(&format!("– {id}\"")), "{id}");
            ids.push(id);
        }
    }
    ids.sort_unstable();
    ids
}

/// Each tile shows its part of the sheet at true scale, and the tiles together all of it.
#[test]
fn tiles_of_small_paper_join_to_the_sheet() {
    let sheet = sheet::start_sheet(&kit()).unwrap();
    let whole = Pixels::of(&sheet, 2.0);
    for paper in [drawing::A4, drawing::LETTER] {
        let tiles = tiles::tiles(&sheet, paper);
        assert_eq!(tiles.len(), 8);
        let mut covered = vec![false; whole.grey.len()];
        for (index, tile) in tiles.iter().enumerate() {
            assert_eq!(tile.size, paper);
            let pixels = Pixels::of(tile, 2.0);
            // Four tiles in a row: 156 mm of the sheet each, 146 mm apart; two rows of 215 mm.
            let from = [(index % 4) as f64 * 146.0, (index / 4) as f64 * 205.0];
            let at = [(paper[0] - 156.0) / 2.0, (paper[1] - 215.0) / 2.0];
            let (mut dark, mut missing) = (0, 0);
            for y in 4..426 {
                for x in 4..308 {
                    let place = |from: [f64; 2], pixels: &Pixels| {
                        let [x, y] =
                            [(x, 0), (y, 1)].map(|(v, axis)| v + (from[axis] * 2.0).round() as usize);
                        y * pixels.width + x
                    };
                    let here = place(from, &whole);
                    covered[here] = true;
                    // Black ink of the sheet is black on the tile; marks may add some.
                    if whole.grey[here] < 130 {
                        dark += 1;
                        missing += usize::from(pixels.grey[place(at, &pixels)] > 220);
                    }
                }
            }
            assert!(dark > 100 && missing * 20 < dark, "tile {index}: {missing} of {dark}");
            if index == 7 {
                let [(0, _, corners)] = pixels.tags()[..] else { panic!("no tag 0 on the last tile") };
                near((corners[0][0] - corners[1][0]).hypot(corners[0][1] - corners[1][1]), 75.5);
            }
        }
        let inside = |index: &usize| {
            let (x, y) = (index % whole.width, index / whole.width);
            (4..whole.width - 4).contains(&x) && (4..whole.height - 4).contains(&y)
        };
        assert!((0..covered.len()).filter(inside).all(|index| covered[index]));
    }
}
