//! The pose of every beam of a goal, from the clamped beam outwards, connection by connection.
//!
//! A goal file states which holes share a peg, not the poses of the beams. They are inferred by
//! these rules, in this order:
//!
//! 1. A beam with two of its holes on placed beams is fixed by them.
//! 2. A beam with one hole in (or around) a square female is at a right angle to its neighbour.
//! 3. Two beams that are connected with each other, each with one more hole on a placed beam, close
//!    a triangle.
//! 4. A beam with only one hole known, in a long female, lies along X or Y by default.
//!
//! If two answers remain (the opposite direction, or the mirror image of a triangle), the usual
//! one is tried first: beams point along +X and +Y, as in the published goals. The search
//! backtracks when holes do not meet or when a male would enter a female at an invalid angle. It
//! does not backtrack when beams overlap: a beam printed as the mirror image of the right one must
//! be an error, not another assembly.

use nalgebra::{Point2, Rotation2, Translation3, UnitQuaternion, Vector2, Vector3};
use ramp_kit::joint::{AXIS_HEIGHT, BODY_WIDTH};
use ramp_kit::{Beam, JointType, Pose};
use std::f64::consts::{FRAC_PI_2, PI};

/// Largest distance between the holes of a connection, m: half of what a peg with 0.25 mm of play
/// in each can bridge.
pub const MAX_RESIDUAL: f64 = 0.25e-3;
/// The largest angle between a male and the normal of an `angle-f` around it, rad.
pub const MAX_ENTRY_ANGLE: f64 = 40.7 * PI / 180.0;
/// The play of a male in any other female, rad.
pub const MAX_SQUARE_ANGLE: f64 = 1.29 * PI / 180.0;
/// An angle computed from two holes snaps to a multiple of 90° within this tolerance: the lengths
/// are only accurate to 0.01 mm.
const SNAP: f64 = 0.005 * PI / 180.0;
/// Largest number of partial placements that the search visits.
const BUDGET: usize = 20_000;

/// The pose of a beam in the plane of the table, in the assembly frame: its j1 hole (m) and yaw (rad).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Planar {
    pub at: Point2<f64>,
    pub yaw: f64,
}

impl Planar {
    /// The hole at `offset` along the beam.
    pub fn hole(&self, offset: f64) -> Point2<f64> {
        self.at + Rotation2::new(self.yaw) * Vector2::new(offset, 0.0)
    }

    /// The pose at `yaw` that puts the hole at `offset` on `point`.
    pub fn with_hole(point: Point2<f64>, offset: f64, yaw: f64) -> Planar {
        let yaw = snap(yaw);
        Planar { at: point - Rotation2::new(yaw) * Vector2::new(offset, 0.0), yaw }
    }
}

/// A beam to be placed; `yaw` if the file states it.
pub(crate) struct Piece<'a> {
    pub beam: &'a Beam,
    pub flipped: bool,
    pub yaw: Option<f64>,
}

/// One side of a connection: a piece and a joint of it.
pub(crate) type Side = (usize, usize);

/// Reasons why the beams cannot be placed.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Misfit {
    /// The holes of a connection do not meet; `distance` between them, m.
    Apart { connection: usize, distance: f64 },
    /// A male enters at an invalid angle; both angles rad.
    Angle { connection: usize, angle: f64, limit: f64 },
    /// No chain of connections leads from the base to this beam.
    Loose { beam: usize },
    /// The search reached its limit.
    TooHard,
}

/// Places every piece. `connections` are (female, male).
pub(crate) fn place(
    pieces: &[Piece<'_>],
    base: usize,
    connections: &[(Side, Side)],
) -> Result<Vec<Planar>, Misfit> {
    let mut poses = vec![None; pieces.len()];
    poses[base] = Some(Planar { at: Point2::origin(), yaw: 0.0 });
    let mut search = Search { pieces, connections, misfit: None, budget: BUDGET, placed: vec![base] };
    search.extend(&mut poses).ok_or(search.misfit.unwrap_or(Misfit::TooHard))
}

struct Search<'a> {
    pieces: &'a [Piece<'a>],
    connections: &'a [(Side, Side)],
    /// The first conflict, in the most plausible branch.
    misfit: Option<Misfit>,
    budget: usize,
    /// The placed pieces in the order in which they were placed.
    placed: Vec<usize>,
}

/// A connection of a piece with a placed one: the offset of its own joint, and the target point.
#[derive(Clone, Copy)]
struct Tie {
    connection: usize,
    offset: f64,
    point: Point2<f64>,
    /// Position of the placed neighbour in the order of placing.
    rank: usize,
    /// The yaw of the neighbour minus the rotations of both joints relative to their beams: the yaw
    /// of a beam that lies along it.
    neighbour_yaw: f64,
}

impl Search<'_> {
    /// Depth-first; at most as deep as the number of pieces.
    fn extend(&mut self, poses: &mut Vec<Option<Planar>>) -> Option<Vec<Planar>> {
        if self.budget == 0 {
            return None;
        }
        self.budget -= 1;
        if self.placed.len() == self.pieces.len() {
            return Some(poses.iter().copied().flatten().collect());
        }
        for step in self.candidates(poses) {
            let depth = self.placed.len();
            let mut misfit = None;
            for &(piece, pose) in &step {
                poses[piece] = Some(pose);
                self.placed.push(piece);
                misfit = misfit.or_else(|| self.check(piece, poses));
            }
            let found = match misfit {
                Some(misfit) => {
                    self.misfit.get_or_insert(misfit);
                    None
                }
                None => self.extend(poses),
            };
            if found.is_some() {
                return found;
            }
            for &(piece, _) in &step {
                poses[piece] = None;
            }
            self.placed.truncate(depth);
        }
        None
    }

    /// The candidates for the next placement, the most plausible first; one rule decides per step.
    fn candidates(&mut self, poses: &[Option<Planar>]) -> Vec<Vec<(usize, Planar)>> {
        let ties: Vec<Vec<Tie>> = (0..self.pieces.len())
            .map(|piece| if poses[piece].is_some() { Vec::new() } else { self.ties(piece, poses) })
            .collect();
        // The unplaced pieces connected with placed ones, in the order of their connections in the
        // file.
        let mut next: Vec<usize> = (0..ties.len()).filter(|&piece| !ties[piece].is_empty()).collect();
        next.sort_by_key(|&piece| ties[piece].iter().map(|tie| tie.connection).min());
        if next.is_empty() {
            let beam = poses.iter().position(Option::is_none).unwrap_or_default();
            self.misfit.get_or_insert(Misfit::Loose { beam });
            return Vec::new();
        }
        for &piece in &next {
            if let Some(yaw) = self.pieces[piece].yaw {
                let tie = ties[piece][0];
                return vec![vec![(piece, Planar::with_hole(tie.point, tie.offset, yaw))]];
            }
            if let Some(pose) = from_two_holes(&ties[piece]) {
                return vec![vec![(piece, pose)]];
            }
        }
        let square = |piece: usize, axes: &[f64]| -> Vec<Vec<(usize, Planar)>> {
            let tie = ties[piece][0];
            let mut yaws = axes.to_vec();
            yaws.push(usual_direction(tie.neighbour_yaw + FRAC_PI_2));
            let both = yaws.into_iter().flat_map(|yaw| [yaw, yaw + PI]);
            both.map(|yaw| vec![(piece, Planar::with_hole(tie.point, tie.offset, yaw))]).collect()
        };
        let in_long_female = |piece: &usize| {
            let (female, _) = self.connections[ties[*piece][0].connection];
            self.kind(female) == JointType::AngleF
        };
        if let Some(&piece) = next.iter().find(|piece| !in_long_female(piece)) {
            return square(piece, &[]);
        }
        for (index, &a) in next.iter().enumerate() {
            for &b in &next[index + 1..] {
                let triangles = self.triangles(a, ties[a][0], b, ties[b][0]);
                if !triangles.is_empty() {
                    return triangles;
                }
            }
        }
        // Next to an oblique beam, a beam along X or Y is more plausible than one at a right angle
        // to it.
        let first = next[0];
        if is_square(ties[first][0].neighbour_yaw) {
            square(first, &[])
        } else {
            square(first, &[0.0, FRAC_PI_2])
        }
    }

    fn kind(&self, (piece, joint): Side) -> JointType {
        self.pieces[piece].beam.joints[joint].kind
    }

    fn turn(&self, (piece, joint): Side) -> f64 {
        turn(self.kind((piece, joint)), self.pieces[piece].flipped)
    }

    fn offset(&self, (piece, joint): Side) -> f64 {
        self.pieces[piece].beam.joints[joint].offset
    }

    /// The connections of an unplaced piece with placed ones, those with the earliest placed first.
    fn ties(&self, piece: usize, poses: &[Option<Planar>]) -> Vec<Tie> {
        let mut ties: Vec<Tie> = Vec::new();
        for (connection, &(female, male)) in self.connections.iter().enumerate() {
            for (own, other) in [(female, male), (male, female)] {
                let (true, Some(pose)) = (own.0 == piece, poses[other.0]) else { continue };
                let rank = self.placed.iter().position(|&placed| placed == other.0).unwrap_or(usize::MAX);
                ties.push(Tie {
                    connection,
                    offset: self.offset(own),
                    point: pose.hole(self.offset(other)),
                    rank,
                    neighbour_yaw: pose.yaw + self.turn(other) - self.turn(own),
                });
            }
        }
        ties.sort_by_key(|tie| (tie.rank, tie.connection));
        ties
    }

    /// Two unplaced pieces, each connected with one point and with each other: their common hole is
    /// the intersection of two circles.
    fn triangles(&self, a: usize, tie_a: Tie, b: usize, tie_b: Tie) -> Vec<Vec<(usize, Planar)>> {
        let mut found: Vec<(f64, Vec<(usize, Planar)>)> = Vec::new();
        for &(female, male) in self.connections {
            let (own_a, own_b) = match (female.0, male.0) {
                (x, y) if (x, y) == (a, b) => (female, male),
                (x, y) if (x, y) == (b, a) => (male, female),
                _ => continue,
            };
            let (arm_a, arm_b) = (self.offset(own_a) - tie_a.offset, self.offset(own_b) - tie_b.offset);
            if arm_a.abs() < MAX_RESIDUAL || arm_b.abs() < MAX_RESIDUAL {
                continue;
            }
            for corner in circles(tie_a.point, arm_a.abs(), tie_b.point, arm_b.abs()) {
                let (mut pose_a, mut pose_b) = (aim_at(tie_a, arm_a, corner), aim_at(tie_b, arm_b, corner));
                // A piece that comes out square stays so, and the other absorbs the rounding.
                if is_square(pose_b.yaw) {
                    pose_a = aim_at(tie_a, arm_a, pose_b.hole(self.offset(own_b)));
                } else if is_square(pose_a.yaw) {
                    pose_b = aim_at(tie_b, arm_b, pose_a.hole(self.offset(own_a)));
                }
                let steepness = [(pose_a, tie_a), (pose_b, tie_b)]
                    .map(|(pose, tie)| off_square(pose.yaw - tie.neighbour_yaw))
                    .into_iter()
                    .fold(0.0, f64::max);
                found.push((steepness, vec![(a, pose_a), (b, pose_b)]));
            }
        }
        // A flatter entry angle is more plausible.
        found.sort_by(|x, y| x.0.total_cmp(&y.0));
        found.into_iter().map(|(_, step)| step).collect()
    }

    /// Checks that the last placed piece fits those placed before.
    fn check(&self, piece: usize, poses: &[Option<Planar>]) -> Option<Misfit> {
        for (connection, &(female, male)) in self.connections.iter().enumerate() {
            if female.0 != piece && male.0 != piece {
                continue;
            }
            let (Some(around), Some(inside)) = (poses[female.0], poses[male.0]) else { continue };
            let distance = (around.hole(self.offset(female)) - inside.hole(self.offset(male))).norm();
            if distance > MAX_RESIDUAL {
                return Some(Misfit::Apart { connection, distance });
            }
            let angle = off_square(inside.yaw + self.turn(male) - around.yaw);
            let limit = entry_limit(self.kind(female));
            if angle > limit {
                return Some(Misfit::Angle { connection, angle, limit });
            }
        }
        None
    }
}

/// A piece rotated about its connected hole so that it points at `corner`.
fn aim_at(tie: Tie, arm: f64, corner: Point2<f64>) -> Planar {
    let way = (corner - tie.point) * arm.signum();
    Planar::with_hole(tie.point, tie.offset, way.y.atan2(way.x))
}

/// The pose fixed by two holes: exact at the first tie, its direction from the furthest hole.
fn from_two_holes(ties: &[Tie]) -> Option<Planar> {
    let first = ties.first()?;
    let far = |tie: &Tie| (tie.offset - first.offset).abs();
    let second = ties.iter().max_by(|x, y| far(x).total_cmp(&far(y)))?;
    if far(second) < MAX_RESIDUAL {
        return None;
    }
    let way = (second.point - first.point) * (second.offset - first.offset).signum();
    Some(Planar::with_hole(first.point, first.offset, way.y.atan2(way.x)))
}

/// The points at distance `r` from `p` and `s` from `q`: two, one or none.
pub(crate) fn circles(p: Point2<f64>, r: f64, q: Point2<f64>, s: f64) -> Vec<Point2<f64>> {
    let way = q - p;
    let distance = way.norm();
    if distance < MAX_RESIDUAL {
        return Vec::new();
    }
    let along = (r * r - s * s + distance * distance) / (2.0 * distance);
    let height = r * r - along * along;
    // Circles that miss each other by a rounding error touch.
    if height < -(MAX_RESIDUAL * r) {
        return Vec::new();
    }
    let foot = p + way * (along / distance);
    let side = Vector2::new(-way.y, way.x) * (height.max(0.0).sqrt() / distance);
    vec![foot + side, foot - side]
}

/// The same angle in (−180°, 180°], exact for multiples of 90°.
fn snap(yaw: f64) -> f64 {
    let turned = yaw.rem_euclid(2.0 * PI);
    let turned = if turned > PI + SNAP { turned - 2.0 * PI } else { turned };
    let quarters = (turned / FRAC_PI_2).round();
    if (turned - quarters * FRAC_PI_2).abs() < SNAP { quarters * FRAC_PI_2 } else { turned }
}

fn is_square(yaw: f64) -> bool {
    (yaw / FRAC_PI_2).fract() == 0.0
}

/// The usual one of the two directions on a line: towards +X, or exactly along +Y.
fn usual_direction(yaw: f64) -> f64 {
    let half_turn = yaw.rem_euclid(PI);
    if half_turn > FRAC_PI_2 + SNAP { half_turn - PI } else { half_turn }
}

/// Mating direction of a joint relative to its beam's +x, rad; non-zero only for a bent male end.
pub(crate) fn turn(kind: JointType, flipped: bool) -> f64 {
    // A flip of the beam swaps left and right.
    if flipped { -kind.form().turn } else { kind.form().turn }
}

/// Largest angle from straight at which a male may enter a female of this type, rad.
pub(crate) fn entry_limit(kind: JointType) -> f64 {
    match kind {
        JointType::AngleF => MAX_ENTRY_ANGLE,
        JointType::Added(_) => kind.form().entry_angle(BODY_WIDTH),
        _ => MAX_SQUARE_ANGLE,
    }
}

/// Deviation of two beams from a right angle, rad, from 0 to 90°.
pub(crate) fn off_square(between: f64) -> f64 {
    (between.rem_euclid(PI) - FRAC_PI_2).abs()
}

/// The pose of a beam in the assembly frame: first flipped about its own axis, then rotated, at
/// assembled height.
pub(crate) fn x_ab(pose: &Planar, flipped: bool) -> Pose {
    let roll = if flipped { std::f64::consts::PI } else { 0.0 };
    Pose::from_parts(
        Translation3::new(pose.at.x, pose.at.y, AXIS_HEIGHT),
        UnitQuaternion::from_axis_angle(&Vector3::z_axis(), pose.yaw)
            * UnitQuaternion::from_axis_angle(&Vector3::x_axis(), roll),
    )
}
