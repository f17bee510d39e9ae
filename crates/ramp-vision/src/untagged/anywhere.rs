//! Beams and standing pegs that may lie or stand anywhere on the table.
//!
//! A beam has black joints at its ends. So two black areas that the drawing does not explain, as far apart as
//! the ends of a beam, are a start for it, with either end first. Each start is fitted as any other part is;
//! of starts in one place the one that the image supports best is a beam. A peg shows its head, which is
//! orange.

use nalgebra::{Matrix2, Matrix6, Point3, Translation3, UnitQuaternion, Vector2, Vector3, Vector6};
use ramp_kit::Holder;
use ramp_kit::joint::{HEAD_HEIGHT, HEAD_WIDTH};
use ramp_robot::Pose;

use super::canvas::{Canvas, GROUND};
use super::contours::GROUNDS;
use super::look::Look;
use super::lost::{Area, CELL, areas_of, colour, is_peg, on_height};
use super::scene::{Believed, Found, Scene};
use super::solids::Surface;
use crate::Lying;

/// Largest light of a black joint, linear, in each channel.
const BLACK: f32 = 0.08;
/// Cells around one that must be black, too: printed lines are thinner.
const THICK: usize = 1;
/// Cells around one that must be orange, too: the heads of neighbours in a holder nearly touch.
const HEAD_THICK: usize = 2;
/// Least area of a black area that may be a joint, as a share of the square of [`JOINT`]; and the largest.
const JOINT_AREA: [f64; 2] = [0.15, 12.0];
/// About the width of a joint, m.
const JOINT: f64 = 25.0e-3;
/// Cells around what is drawn in which nothing is looked for.
const MARGIN: usize = 3;
/// How much the middle of a black area may be off that of the joint, m.
pub(super) const OFF: f64 = 9.0e-3;
/// Two black stretches of a beam that are nearer than this are one, m.
const GAP: f64 = 1.0e-3;
/// Standard deviations along the table, m, and of the turn about the vertical, degrees: of a start from black
/// areas, and of a part that was found from one.
const START: (f64, f64) = (4.0e-3, 2.0);
const FOUND: (f64, f64) = (2.5e-3, 0.7);
/// Share of that in height and tilt of what lies flat.
const FLAT: f64 = 0.2;
/// Least difference of two drawings of one place that tells which is right, grey levels.
const CONTESTED: f64 = 25.0;
/// The channel in which drawings are compared.
const GREEN: usize = 1;
/// Axes of two beams on the table that come nearer than this are those of one beam, m.
const ONE_PLACE: f64 = 12.0e-3;
/// Least red of a head from above, linear.
const HEAD_RED: f32 = 0.25;
/// Area of the heads of a holder, or one of them, against that of a head seen from the front.
const HEAD_AREA: [f64; 2] = [0.03, 4.5];

/// A beam that is looked for.
#[derive(Clone, Debug)]
pub struct Strewn {
    /// Its name.
    pub part: String,
    /// A pose in which it lies flat, in the world: its place and its turn about the vertical do not matter.
    pub flat: Pose,
    /// The knowledge of its height and tilt, if there is any.
    pub lying: Option<Lying>,
}

impl Strewn {
    /// Its pose with the points of its axis at `along` (m) nearest to two places on the table.
    fn through(&self, along: [f64; 2], from: &Vector2<f64>, to: &Vector2<f64>) -> Pose {
        let x = self.flat.rotation * Vector3::x();
        let direction = (to - from).normalize();
        let yaw = direction.y.atan2(direction.x) - x.y.atan2(x.x);
        let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), yaw);
        let origin = (from + to) / 2.0 - direction * ((along[0] + along[1]) / 2.0);
        Pose::from_parts(
            Translation3::new(origin.x, origin.y, self.flat.translation.z),
            turn * self.flat.rotation,
        )
    }
}

/// Middles of the black stretches of a beam along its axis, m, from its first end.
pub(super) fn joints(surface: &Surface) -> Vec<f64> {
    let black =
        |index: usize| surface.patches[surface.patch_of[index] as usize].1.iter().all(|it| *it < BLACK);
    let mut stretches: Vec<[f64; 2]> = (0..surface.triangles.len())
        .filter(|index| black(*index))
        .map(|index| {
            let xs = surface.triangles[index].map(|corner| f64::from(surface.points[corner as usize][0]));
            [
                xs.iter().copied().fold(f64::INFINITY, f64::min),
                xs.iter().copied().fold(f64::NEG_INFINITY, f64::max),
            ]
        })
        .collect();
    stretches.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let mut joints: Vec<[f64; 2]> = Vec::new();
    for [from, to] in stretches {
        match joints.last_mut() {
            Some([_, last]) if from < *last + GAP => *last = last.max(to),
            _ => joints.push([from, to]),
        }
    }
    joints.iter().map(|[from, to]| (from + to) / 2.0).collect()
}

/// A beam that was fitted from a start.
struct Fit {
    found: Found,
    /// The middles of the joints at its ends on the table, m.
    ends: [Vector2<f64>; 2],
}

impl Fit {
    fn new(found: Found, ends: [f64; 2]) -> Fit {
        let end = |along: f64| (found.x_wp * Point3::new(along, 0.0, 0.0)).xy().coords;
        Fit { ends: ends.map(end), found }
    }
}

/// Beams on the table that the scene does not have, each under the name of one of the beams that are looked
/// for.
pub fn beams(look: &Look, canvas: &mut Canvas, wanted: &[Strewn]) -> Vec<(String, Pose)> {
    let black = black_areas(look, canvas);
    let mut fits: Vec<Fit> = Vec::new();
    for beam in wanted {
        let Some(surface) = look.bodies.surfaces.get(&beam.part) else { continue };
        let joints = joints(surface);
        let height = beam.flat.translation.z;
        let on_table = |pixel: [f64; 2]| on_height(look, canvas, pixel, height).xy().coords;
        let at: Vec<Vector2<f64>> = black.iter().map(|area| on_table(area.middle)).collect();
        let all: Vec<Vector2<f64>> = black.iter().flat_map(|area| area.pixels()).map(on_table).collect();
        for (index, from) in at.iter().enumerate() {
            for (_, to) in at.iter().enumerate().filter(|(other, _)| *other != index) {
                let Some(ends) = joins(&joints, from, to, &all) else { continue };
                let found = fit(look, canvas, beam, &beam.through(ends, from, to), START);
                fits.extend(found.map(|found| Fit::new(found, ends)));
            }
        }
    }
    fits.sort_by(|a, b| b.found.share.total_cmp(&a.found.share));
    let mut found: Vec<Fit> = Vec::new();
    for fit in fits {
        if found.iter().all(|other| distance(&fit.ends, &other.ends) > ONE_PLACE) {
            found.push(fit);
        }
    }
    found.into_iter().map(|fit| (fit.found.part, fit.found.x_wp)).collect()
}

/// The places along a beam's axis of its joints at the ends, m, if black areas at two places may be those: as
/// far apart, and with others where the beam has joints between them.
fn joins(joints: &[f64], from: &Vector2<f64>, to: &Vector2<f64>, black: &[Vector2<f64>]) -> Option<[f64; 2]> {
    let ends = [*joints.first()?, *joints.last()?];
    let (span, apart) = (ends[1] - ends[0], (to - from).norm());
    if (apart - span).abs() > 2.0 * OFF {
        return None;
    }
    let is_black = |joint: &f64| {
        let at = from + (to - from) * ((joint - ends[0]) / span.max(JOINT));
        black.iter().any(|area| (area - at).norm() < OFF)
    };
    joints.iter().all(is_black).then_some(ends)
}

/// Covariance of a part that was found anywhere, axes of the world, m and rad: of one that is known to lie
/// `flat`, or of another.
pub fn strewn_covariance(flat: bool) -> Matrix6<f64> {
    covariance(FOUND, flat)
}

fn covariance((shift, turn): (f64, f64), flat: bool) -> Matrix6<f64> {
    let turn = turn.to_radians();
    let rest = if flat { FLAT } else { 1.0 };
    let sigma = Vector6::new(shift, shift, rest * shift, rest * turn, rest * turn, turn);
    Matrix6::from_diagonal(&sigma.map(|sigma| sigma * sigma))
}

/// How beams that may lie in one place explain an image of it.
#[derive(Clone, Debug)]
pub struct Comparison {
    /// Of each beam, the pose in the world that the image supports best.
    pub poses: Vec<Pose>,
    /// Of each beam and each other one: how far off the image is from the drawing of the first (grey levels),
    /// summed over the pixels in which the drawings of those two differ.
    pub off: Vec<Vec<f64>>,
}

/// Compares beams that may lie in one place by how they explain an image; `None` where it supports none of
/// them.
pub fn compare(look: &Look, canvas: &mut Canvas, beams: &[(&Strewn, Pose)]) -> Option<Comparison> {
    let fits: Vec<Option<Found>> =
        beams.iter().map(|(beam, x_wb)| fit(look, canvas, beam, x_wb, FOUND)).collect();
    if fits.iter().all(Option::is_none) {
        return None;
    }
    let (mut poses, mut drawings, mut window) = (Vec::new(), Vec::new(), [[f64::INFINITY, 0.0]; 2]);
    let lens = canvas.lens.clone();
    let ground = look.ground(&lens);
    for ((beam, given), found) in beams.iter().zip(&fits) {
        let x_wb = found.as_ref().map_or(*given, |found| found.x_wp);
        let parts = with(look, beam, &x_wb, FOUND);
        look.of(&Scene { parts: &parts, ..*look.scene }).draw_all(canvas);
        let surface = look.bodies.surfaces.get(&beam.part)?;
        let bounds = canvas.bounds(surface, &(look.x_wc.inverse() * x_wb))?;
        for (range, [from, to]) in window.iter_mut().zip(bounds) {
            *range = [range[0].min(from), range[1].max(to)];
        }
        poses.push(x_wb);
        drawings.push(levels(canvas, &ground));
    }
    let [w, h] = canvas.lens.size;
    let [columns, rows] = [0, 1].map(|axis| {
        let [from, to] = window[axis];
        from.max(0.0) as usize..(to.max(0.0).ceil() as usize).min([w, h][axis])
    });
    let mut off = vec![vec![0.0; beams.len()]; beams.len()];
    for y in rows {
        for x in columns.clone() {
            let drawn: Vec<f64> = drawings.iter().map(|levels| levels[y * w + x]).collect();
            if drawn.iter().all(|other| (other - drawn[0]).abs() < CONTESTED / 2.0) {
                continue;
            }
            let at = look.photograph.place([x as f64 + 0.5, y as f64 + 0.5]);
            let Some(light) = look.photograph.light(GREEN, at) else { continue };
            let seen = level(light);
            for (a, off) in off.iter_mut().enumerate() {
                for (b, off) in off.iter_mut().enumerate() {
                    if (drawn[a] - drawn[b]).abs() >= CONTESTED {
                        *off += (seen - drawn[a]).abs();
                    }
                }
            }
        }
    }
    Some(Comparison { poses, off })
}

/// Grey levels of linear light.
fn level(light: f64) -> f64 {
    light.max(0.0).powf(1.0 / 2.2) * 255.0
}

/// Grey levels of the green light of a drawing, by pixel.
fn levels(canvas: &Canvas, ground: &dyn Fn([f64; 2]) -> usize) -> Vec<f64> {
    let w = canvas.lens.size[0];
    let of_face: Vec<f64> = canvas.faces.iter().map(|face| level(f64::from(face.colour[GREEN]))).collect();
    let of_ground = GROUNDS.map(|colour| level(f64::from(colour[GREEN])));
    let level = |(index, face): (usize, &u32)| match *face {
        GROUND => of_ground[ground([(index % w) as f64 + 0.5, (index / w) as f64 + 0.5])],
        face => of_face[face as usize],
    };
    canvas.shown.iter().enumerate().map(level).collect()
}

/// Fits a beam that is known to be near a pose, with these standard deviations.
fn fit(look: &Look, canvas: &mut Canvas, beam: &Strewn, x_wb: &Pose, known: (f64, f64)) -> Option<Found> {
    let parts = with(look, beam, x_wb, known);
    let scene = Scene { parts: &parts, ..*look.scene };
    look.of(&scene).all(canvas, &|it| it.part == beam.part).found.into_iter().next()
}

/// The parts of the scene, and a beam near a pose.
fn with(look: &Look, beam: &Strewn, x_wb: &Pose, known: (f64, f64)) -> Vec<Believed> {
    let start = Believed {
        part: beam.part.clone(),
        x_wp: *x_wb,
        covariance: covariance(known, beam.lying.is_some()),
        lying: beam.lying.clone(),
        held: false,
    };
    let others = look.scene.parts.iter().filter(|it| it.part != beam.part).cloned();
    others.chain([start]).collect()
}

/// Distance of two lines on the table, each by its ends, m.
fn distance(a: &[Vector2<f64>; 2], b: &[Vector2<f64>; 2]) -> f64 {
    let to_line = |p: &Vector2<f64>, [from, to]: &[Vector2<f64>; 2]| {
        let along = to - from;
        let share = ((p - from).dot(&along) / along.norm_squared().max(1.0e-9)).clamp(0.0, 1.0);
        (from + along * share - p).norm()
    };
    let cross = |u: &Vector2<f64>, v: &Vector2<f64>| u.perp(v);
    let sides = |[from, to]: &[Vector2<f64>; 2], other: &[Vector2<f64>; 2]| {
        let along = to - from;
        cross(&along, &(other[0] - from)) * cross(&along, &(other[1] - from)) < 0.0
    };
    if sides(a, b) && sides(b, a) {
        return 0.0;
    }
    let ends = a.iter().map(|p| to_line(p, b)).chain(b.iter().map(|p| to_line(p, a)));
    ends.fold(f64::INFINITY, f64::min)
}

/// The middles of the heads of standing pegs that the scene does not have, m, in the world.
pub fn heads(look: &Look, canvas: &mut Canvas) -> Vec<Point3<f64>> {
    let height = Holder::HEIGHT + HEAD_HEIGHT / 2.0;
    // Between heads it is darker.
    let is_head = |colour: [f32; 3]| is_peg(colour) && colour[0] > HEAD_RED;
    let areas = areas(look, canvas, HEAD_THICK, &is_head);
    let heads = |area: &Area| {
        let at = on_height(look, canvas, area.middle, height);
        let one = cells(look, canvas, &at, HEAD_WIDTH);
        let count = area.cells.len() as f64 / one;
        let fits = (HEAD_AREA[0]..HEAD_AREA[1]).contains(&count);
        let middles = if fits { row_of_heads(area, one.sqrt()) } else { Vec::new() };
        middles.into_iter().map(|middle| on_height(look, canvas, middle, height)).collect::<Vec<_>>()
    };
    areas.iter().flat_map(heads).collect()
}

/// The middles (pixels of the drawing) of the heads of which an area consists: those of neighbours in a
/// holder may touch. `width` is that of a head in cells.
fn row_of_heads(area: &Area, width: f64) -> Vec<[f64; 2]> {
    let middle = Vector2::from(area.middle);
    let off = || area.pixels().map(|pixel| (Vector2::from(pixel) - middle) / CELL as f64);
    let spread = off().map(|off| off * off.transpose()).sum::<Matrix2<f64>>();
    let axes = spread.symmetric_eigen();
    let along = axes.eigenvectors.column(axes.eigenvalues.imax()).into_owned();
    let far = off().map(|off| off.dot(&along));
    let [low, high] = far.fold([0.0; 2], |[low, high], it| [it.min(low), it.max(high)]);
    // Cells at its border do not belong to it.
    let one = (width - 2.0 * HEAD_THICK as f64).max(1.0);
    let pitch = Holder::PITCH / HEAD_WIDTH * width;
    let others = ((high - low - one) / pitch).round().max(0.0);
    let place = |index: usize| middle + along * ((index as f64 - others / 2.0) * pitch * CELL as f64);
    (0..=others as usize).map(|index| place(index).into()).collect()
}

/// Areas of the size of a joint that are black where the drawing of all that is known has nothing.
pub(super) fn black_areas(look: &Look, canvas: &mut Canvas) -> Vec<Area> {
    // Outside of the image all is black.
    let is_black = |[r, g, b]: [f32; 3]| r > 0.0 && r.max(g).max(b) < BLACK;
    let mut areas = areas(look, canvas, THICK, &is_black);
    areas.retain(|area| {
        let at = on_height(look, canvas, area.middle, JOINT);
        let [low, high] = JOINT_AREA.map(|share| share * cells(look, canvas, &at, JOINT));
        (low..high).contains(&(area.cells.len() as f64))
    });
    areas
}

/// Number of cells of a square of this width (m) at a place.
fn cells(look: &Look, canvas: &Canvas, at: &Point3<f64>, width: f64) -> f64 {
    let distance = (look.x_wc.inverse() * at).z.max(0.05);
    (width * canvas.lens.focal[0] / distance / CELL as f64).powi(2)
}

/// Areas of cells that have a colour with all cells around them (`thick`), where the drawing of all that is
/// known has nothing.
fn areas(look: &Look, canvas: &mut Canvas, thick: usize, is: &dyn Fn([f32; 3]) -> bool) -> Vec<Area> {
    look.draw_all(canvas);
    let [w, h] = canvas.lens.size;
    let [columns, rows] = [w / CELL, h / CELL];
    let cell = |index: usize| [index % columns, index / columns];
    let has: Vec<bool> = (0..columns * rows).map(|index| is(colour(look, cell(index)))).collect();
    let bare = |index: usize| {
        let [column, row] = cell(index);
        canvas.shown[(row * CELL) * w + column * CELL] == GROUND
    };
    let bare: Vec<bool> = (0..columns * rows).map(bare).collect();
    let around = |cells: &[bool], column: usize, row: usize, by: usize| {
        (row - by..=row + by).all(|y| (column - by..=column + by).all(|x| cells[y * columns + x]))
    };
    let mut left = vec![false; columns * rows];
    for row in MARGIN..rows - MARGIN {
        for column in MARGIN..columns - MARGIN {
            left[row * columns + column] =
                around(&has, column, row, thick) && around(&bare, column, row, MARGIN);
        }
    }
    areas_of(left, columns)
}
