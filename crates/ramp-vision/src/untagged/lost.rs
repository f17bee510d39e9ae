//! A peg that may be anywhere: found by its colour where the drawing has none of it.
//!
//! It may stand, lean in a hole, or lie. So its coloured area is compared with that of pegs in many
//! positions, and the best of them are fitted as any other part is.

use nalgebra::{Matrix6, Point3, Translation3, UnitQuaternion, Vector3, Vector6};
use ramp_kit::joint::{HEAD_HEIGHT, HEAD_WIDTH};
use ramp_robot::Pose;

use super::acceptance::LEAST_SHARE;
use super::canvas::{Canvas, GROUND};
use super::depths::{measured, sigma};
use super::look::Look;
use super::scene::{Believed, Found, Scene};

/// Side of the cells in which colours are compared, pixels.
pub(super) const CELL: usize = 2;
/// Cells around what the drawing has of the colour that do not count as unexplained.
const MARGIN: usize = 3;
/// Least red of a peg, linear, and least ratio of its red to its blue.
const RED: f32 = 0.1;
const RATIO: f32 = 4.0;
/// Least area of a coloured area that may be a peg, as a share of that of a head seen from the front.
const LEAST_AREA: f64 = 0.25;
/// Angles between a peg's axis and the vertical that are tried, degrees: standing, leaning, and lying on head
/// and tip.
const LEANS: [f64; 6] = [0.0, 8.0, 20.0, 40.0, 60.0, 76.0];
/// Steps of its direction and of its turn about its axis, degrees.
const DIRECTION: f64 = 30.0;
const TURN: f64 = 22.5;
/// Heights of the head's middle above the table that are tried, m: of a peg that leans or lies, and of one
/// that stands, in a hole or a holder or on what its stem has met.
const HEIGHTS: [f64; 4] = [0.014, 0.035, 0.05, 0.07];
const STANDING_HEIGHTS: [f64; 8] = [0.02, 0.03, 0.036, 0.042, 0.048, 0.054, 0.062, 0.075];
/// Largest angle of a peg that counts as standing, degrees.
const STANDING: f64 = 10.0;
/// Those where depth tells the height of what shows: below it, m.
const BELOW: [f64; 4] = [0.0, 0.004, 0.008, 0.012];
/// The largest standard deviation of a depth that tells a height, m.
const TELLS: f64 = 3.0e-3;
/// Number of positions that are fitted, and number of coloured areas that are looked at.
const BEST: usize = 8;
const AREAS: usize = 3;
/// Standard deviations of those positions before the fit: m, and degrees.
const START: ([f64; 3], f64) = ([2.0e-3, 2.0e-3, 4.0e-3], 8.0);
/// Standard deviations of a peg of which only the coloured area was found: across the line of sight and along
/// it, m, and of its rotation, degrees.
const ROUGH: (f64, f64, f64) = (8.0e-3, 25.0e-3, 60.0);

/// What an image tells of a lost peg.
#[derive(Clone, Debug)]
pub enum Trace {
    /// Its pose.
    Pose(Found),
    /// Where something of its colour is: a pose with hardly any knowledge of its rotation, and its covariance
    /// (m, rad, axes of the world).
    Area {
        /// The pose.
        x_wp: Pose,
        /// Its covariance.
        covariance: Matrix6<f64>,
    },
}

/// A coloured area that the drawing does not explain: its cells and their middle, pixels of the drawing.
pub(super) struct Area {
    pub cells: Vec<[usize; 2]>,
    pub middle: [f64; 2],
}

impl Area {
    /// The middles of its cells, pixels of the drawing.
    pub fn pixels(&self) -> impl Iterator<Item = [f64; 2]> {
        self.cells.iter().map(|cell| cell.map(|index| (index as f64 + 0.5) * CELL as f64))
    }
}

/// Looks for a peg of the scene that may be anywhere; `None` where nothing has its colour.
pub fn trace(look: &Look, canvas: &mut Canvas, part: &Believed) -> Option<Trace> {
    let (areas, near) = unexplained(look, canvas);
    let mut found: Option<Found> = None;
    for area in areas.iter().take(AREAS) {
        for x_wp in positions(look, canvas, part, (area, &near)) {
            let (position, turn) = START;
            let turn = turn.to_radians();
            let sigma = Vector6::new(position[0], position[1], position[2], turn, turn, turn);
            let covariance = Matrix6::from_diagonal(&sigma.map(|sigma| sigma * sigma));
            let start = Believed { x_wp, covariance, lying: None, ..part.clone() };
            let others = look.scene.parts.iter().filter(|it| it.part != part.part).cloned();
            let parts: Vec<Believed> = others.chain([start]).collect();
            let scene = Scene { parts: &parts, ..*look.scene };
            let fitted = look.of(&scene).all(canvas, &|it| it.part == part.part);
            let better = |it: &Found| found.as_ref().is_none_or(|best| it.share > best.share);
            found = fitted.found.into_iter().next().filter(better).or(found);
        }
    }
    if let Some(found) = found.filter(|found| found.share >= LEAST_SHARE) {
        return Some(Trace::Pose(found));
    }
    let area = areas.first()?;
    let measured = height_of(look, canvas, area);
    let at = on_height(look, canvas, area.middle, measured.unwrap_or(HEIGHTS[2]));
    let along = if measured.is_some() { ROUGH.0 } else { ROUGH.1 };
    let (across, turn) = (ROUGH.0, ROUGH.2.to_radians());
    let sight = (at.coords - look.x_wc.translation.vector).normalize();
    let mut covariance = Matrix6::identity() * (turn * turn);
    let shift = nalgebra::Matrix3::identity() * across.powi(2) + sight * sight.transpose() * along.powi(2);
    covariance.fixed_view_mut::<3, 3>(0, 0).copy_from(&shift);
    let x_wp = Pose::from_parts(Translation3::from(at.coords), part.x_wp.rotation);
    Some(Trace::Area { x_wp, covariance })
}

/// The point at a height (m) that a pixel of the drawing shows.
pub(super) fn on_height(look: &Look, canvas: &Canvas, pixel: [f64; 2], height: f64) -> Point3<f64> {
    let [x, y] = canvas.lens.direction(pixel);
    let d = look.x_wc.rotation * Vector3::new(x, y, 1.0);
    let eye = look.x_wc.translation.vector;
    Point3::from(eye + d * ((height - eye.z) / d.z.min(-0.05)))
}

/// The height of an area above the table, m, where depth tells it: the middle one of those of its cells.
fn height_of(look: &Look, canvas: &Canvas, area: &Area) -> Option<f64> {
    let height = |cell: &[usize; 2]| {
        let pixel = cell.map(|index| (index * CELL) as f64 + 0.5);
        let distance = measured(look.image, &look.photograph, pixel)?;
        let [x, y] = canvas.lens.direction(pixel);
        let told = sigma(look.image.camera, canvas.lens.focal[0], distance) < TELLS;
        told.then(|| (look.x_wc * Point3::new(x * distance, y * distance, distance)).z)
    };
    let mut heights: Vec<f64> = area.cells.iter().filter_map(height).collect();
    heights.sort_by(f64::total_cmp);
    // Some of an area is enough: metal and what the second lens does not see have none.
    let enough = 4 * heights.len() >= area.cells.len();
    heights.get(heights.len() / 2).copied().filter(|_| enough)
}

/// Whether a colour is that of a peg.
pub(super) fn is_peg([r, _, b]: [f32; 3]) -> bool {
    r > RED && r > RATIO * b
}

/// Areas of a peg's colour in the image where the drawing of all that is known has none, the largest first;
/// and one over the distance of that drawing, 1/m, by cell.
fn unexplained(look: &Look, canvas: &mut Canvas) -> (Vec<Area>, Vec<f32>) {
    let [w, h] = canvas.lens.size;
    look.draw_all(canvas);
    let [columns, rows] = [w / CELL, h / CELL];
    let mut drawn = vec![false; columns * rows];
    let mut near = vec![0.0; columns * rows];
    for row in 0..rows {
        for column in 0..columns {
            let shown = canvas.shown[(row * CELL) * w + column * CELL];
            near[row * columns + column] = canvas.near[(row * CELL) * w + column * CELL];
            drawn[row * columns + column] = shown != GROUND && is_peg(canvas.faces[shown as usize].colour);
        }
    }
    let mut left = vec![false; columns * rows];
    for row in MARGIN..rows - MARGIN {
        for column in MARGIN..columns - MARGIN {
            let around = [-1i32, 0, 1].map(|step| step * MARGIN as i32);
            let explained = around.iter().any(|dy| {
                around.iter().any(|dx| {
                    let (x, y) = ((column as i32 + dx) as usize, (row as i32 + dy) as usize);
                    drawn[y * columns + x]
                })
            });
            left[row * columns + column] = !explained && is_peg(colour(look, [column, row]));
        }
    }
    let mut areas = areas_of(left, columns);
    areas.retain(|area| {
        let at = on_height(look, canvas, area.middle, HEIGHTS[1]);
        let distance = (at - Point3::from(look.x_wc.translation.vector)).norm();
        let head = (HEAD_WIDTH * canvas.lens.focal[0] / distance / CELL as f64).powi(2);
        area.cells.len() as f64 > LEAST_AREA * head
    });
    areas.sort_by_key(|area| std::cmp::Reverse(area.cells.len()));
    (areas, near)
}

/// The connected areas of marked cells, given row by row. No cell at the border is marked.
pub(super) fn areas_of(mut left: Vec<bool>, columns: usize) -> Vec<Area> {
    let mut areas = Vec::new();
    for start in 0..left.len() {
        if !left[start] {
            continue;
        }
        left[start] = false;
        let (mut todo, mut cells) = (vec![start], Vec::new());
        while let Some(index) = todo.pop() {
            cells.push([index % columns, index / columns]);
            for next in [index - 1, index + 1, index - columns, index + columns] {
                if std::mem::take(&mut left[next]) {
                    todo.push(next);
                }
            }
        }
        let count = cells.len() as f64;
        let middle = [0, 1].map(|axis| {
            let sum: f64 = cells.iter().map(|cell| cell[axis] as f64 + 0.5).sum();
            sum / count * CELL as f64
        });
        areas.push(Area { cells, middle });
    }
    areas
}

/// The image's colour in the middle of a cell, linear; black outside.
pub(super) fn colour(look: &Look, [column, row]: [usize; 2]) -> [f32; 3] {
    let pixel = [column, row].map(|index| (index * CELL) as f64 + 0.5);
    let at = look.photograph.place(pixel);
    [0, 1, 2].map(|channel| look.photograph.light(channel, at).map_or(0.0, |light| light as f32))
}

/// Poses in which a peg shows about this area, behind what is nearer, the best first.
fn positions(look: &Look, canvas: &mut Canvas, part: &Believed, (area, near): (&Area, &[f32])) -> Vec<Pose> {
    let Some(surface) = look.bodies.surfaces.get(&part.part) else { return Vec::new() };
    let x_cw = look.x_wc.inverse();
    let up = (x_cw.rotation * Vector3::z()).map(|value| value as f32).into();
    let middle = Vector3::new(0.0, 0.0, HEAD_HEIGHT / 2.0);
    let told = height_of(look, canvas, area).map(|height| BELOW.map(|below| (height - below).max(0.0)));
    let mut rated: Vec<(f64, Pose)> = Vec::new();
    for (lean, rotation) in rotations() {
        let any = if lean < STANDING { &STANDING_HEIGHTS[..] } else { &HEIGHTS[..] };
        for &height in told.as_ref().map_or(any, |told| &told[..]) {
            let mut x_wp = Pose::from_parts(
                Translation3::from(on_height(look, canvas, area.middle, height).coords - rotation * middle),
                rotation,
            );
            // Twice: its own middle is not that of its head.
            for _ in 0..2 {
                let Some((share, own)) = overlap(canvas, surface, &(x_cw * x_wp), (area, near), up) else {
                    break;
                };
                let [from, to] = [own, area.middle].map(|pixel| on_height(look, canvas, pixel, height));
                rated.push((share, x_wp));
                x_wp = Translation3::from(to - from) * x_wp;
            }
        }
    }
    rated.sort_by(|(a, _), (b, _)| b.total_cmp(a));
    rated.into_iter().take(BEST).map(|(_, x_wp)| x_wp).collect()
}

/// Rotations of a peg that stands, leans or lies, each with the angle of its axis and the vertical, degrees.
fn rotations() -> Vec<(f64, UnitQuaternion<f64>)> {
    let about = |axis, degrees: f64| UnitQuaternion::from_axis_angle(&axis, degrees.to_radians());
    let turns = (0..4).map(|step| f64::from(step) * TURN);
    let mut all = Vec::new();
    for lean in LEANS {
        let directions = if lean == 0.0 { 1 } else { (360.0 / DIRECTION) as i32 };
        for direction in 0..directions {
            let direction = about(Vector3::z_axis(), f64::from(direction) * DIRECTION);
            let leaning = direction * about(Vector3::x_axis(), lean) * direction.inverse();
            all.extend(turns.clone().map(|turn| (lean, leaning * about(Vector3::z_axis(), turn))));
        }
    }
    all
}

/// The area that a surface at `x_cb` and an area have in common, as a share of that of both together, and the
/// middle of the surface's own, pixels.
fn overlap(
    canvas: &mut Canvas,
    surface: &super::solids::Surface,
    x_cb: &Pose,
    (area, near): (&Area, &[f32]),
    up: [f32; 3],
) -> Option<(f64, [f64; 2])> {
    let bounds = canvas.bounds(surface, x_cb)?;
    canvas.begin(bounds.map(|[from, to]| [from.floor() as usize, to.ceil() as usize]));
    canvas.draw(surface, x_cb, 0, up);
    let width = canvas.lens.size[0];
    let columns = width / CELL;
    let [[x0, x1], [y0, y1]] = canvas.window();
    let shows = |column: usize, row: usize| {
        let index = row * CELL * width + column * CELL;
        canvas.shown[index] != GROUND
            && near.get(row * columns + column).is_some_and(|it| canvas.near[index] > *it)
    };
    let (mut own, mut sum) = (0usize, [0.0; 2]);
    for row in y0.div_ceil(CELL)..y1.div_ceil(CELL) {
        for column in x0.div_ceil(CELL)..x1.div_ceil(CELL) {
            if shows(column, row) {
                own += 1;
                sum = [sum[0] + column as f64 + 0.5, sum[1] + row as f64 + 0.5];
            }
        }
    }
    if own == 0 {
        return None;
    }
    let inside = |[column, row]: &&[usize; 2]| {
        let (x, y) = (column * CELL, row * CELL);
        (x0..x1).contains(&x) && (y0..y1).contains(&y) && shows(*column, *row)
    };
    let common = area.cells.iter().filter(inside).count();
    let share = common as f64 / (own + area.cells.len() - common) as f64;
    Some((share, sum.map(|value| value / own as f64 * CELL as f64)))
}
