//! Pieces of parts: rigid bodies that hold the shapes which are seldom needed, and when each is needed.
//!
//! A piece is left out of the search for contacts where nothing is near that could meet it. Then nothing
//! changes. Only one choice changes the physics: a stem whose peg is seated meets square holes, the four
//! boxes around each round one. Its play grows from 0.25 to 0.35 mm on the diagonals, and stays so when
//! another stem comes near. All follows from the poses of the moment, so a snapshot and a replay make the
//! same choice.

use std::sync::Arc;

use mujoco_rs::prelude::*;
use mujoco_rs::wrappers::mj_model::MjtObjBase;
use nalgebra::{Matrix3, Vector3};

use crate::extent::Extent;

/// Separates the name of a part from that of its piece: no part has it in its name.
const SEPARATOR: char = '/';
/// A stem's axis is at most so far from that of its hole, m. Chosen: six times its play.
const ASIDE: f64 = 1.5e-3;
/// The head of a seated peg is at most so far from the plate, m. Chosen: more than the referee allows.
const FLUSH: f64 = 0.7e-3;

/// The kinds of pieces.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Piece {
    /// The boxes around the square of a joint's hole, at the hole.
    Hole,
    /// The boxes in the corners of that square.
    Ring,
    /// A peg's stem with its cone.
    Stem,
    /// A peg's head with rounded edges.
    Grip,
}

impl Piece {
    const ALL: [(Piece, &'static str); 4] =
        [(Piece::Hole, "hole"), (Piece::Ring, "ring"), (Piece::Stem, "stem"), (Piece::Grip, "grip")];

    /// The name of the body of this piece of a part; `index` tells pieces of one kind apart.
    pub fn name(self, part: &str, index: usize) -> String {
        let kind = Piece::ALL.iter().find(|(piece, _)| *piece == self).map_or("", |(_, name)| name);
        format!("{part}{SEPARATOR}{kind}{index}")
    }

    /// The kind of piece of a body; `None` for a part, the arm or the world.
    pub fn of(model: &MjModel, body: usize) -> Option<Piece> {
        let name = model.id_to_name(MjtObjBase::mjOBJ_BODY, body)?;
        let (_, kind) = name.split_once(SEPARATOR)?;
        Piece::ALL.iter().find(|(_, name)| kind.starts_with(name)).map(|(piece, _)| *piece)
    }
}

/// The part to which a body belongs: the body itself, unless it is a piece.
pub(crate) fn part_of(model: &MjModel, body: usize) -> usize {
    match Piece::of(model, body) {
        Some(_) => model.body_parentid()[body].max(0) as usize,
        None => body,
    }
}

/// A piece in the scene.
#[derive(Clone)]
struct Placed {
    body: usize,
    part: usize,
    kind: Piece,
    /// The extent of its shapes, in its frame.
    extent: Extent,
}

/// A stem that something may meet now.
#[derive(Clone)]
struct Stem {
    body: usize,
    extent: Extent,
    is_seated: bool,
}

/// All pieces of a scene.
#[derive(Clone)]
pub(crate) struct Pieces {
    pieces: Vec<Placed>,
    stems: Vec<Stem>,
}

impl Pieces {
    /// Of a model, with the extent of each body (in its frame).
    pub fn new(model: &MjModel, extents: &[Option<Extent>]) -> Pieces {
        let placed = |(body, extent): (usize, &Option<Extent>)| {
            let kind = Piece::of(model, body)?;
            Some(Placed { body, part: part_of(model, body), kind, extent: (*extent)? })
        };
        Pieces { pieces: extents.iter().enumerate().filter_map(placed).collect(), stems: Vec::new() }
    }

    /// Leaves those in that something may meet now. `near` holds which bodies are left in; `boxes` are the
    /// extents of parts in the world, `arm` the bodies of the arm, and `room` (m) is how far a body moves in
    /// a period.
    pub fn choose(
        &mut self,
        data: &MjData<Arc<MjModel>>,
        near: &mut [bool],
        boxes: &[Option<Extent>],
        arm: &[usize],
        room: f64,
    ) {
        self.stems.clear();
        for stem in self.pieces.iter().filter(|piece| piece.kind == Piece::Stem && near[piece.part]) {
            let extent = in_world(data, stem, room);
            let is_seated = self.pieces.iter().any(|hole| {
                hole.kind == Piece::Hole
                    && near[hole.part]
                    && boxes[hole.part].is_some_and(|it| it.touches(&extent))
                    && is_seated(data, stem, hole)
            });
            self.stems.push(Stem { body: stem.body, extent, is_seated });
        }
        for piece in &self.pieces {
            near[piece.body] = near[piece.part]
                && match piece.kind {
                    Piece::Stem => true,
                    Piece::Hole | Piece::Ring if self.stems.is_empty() => false,
                    Piece::Hole => {
                        let own = in_world(data, piece, 0.0);
                        self.stems.iter().any(|stem| stem.extent.touches(&own))
                    }
                    Piece::Ring => {
                        let own = in_world(data, piece, 0.0);
                        let mut near = self.stems.iter().filter(|stem| stem.extent.touches(&own));
                        // A hole that a seated stem fills has no room for another one.
                        let is_filled =
                            |stem: &Stem| stem.is_seated && is_in(&seen_from(data, stem.body, piece));
                        near.clone().any(|stem| !stem.is_seated) && !near.any(is_filled)
                    }
                    Piece::Grip => {
                        let own = in_world(data, piece, room);
                        arm.iter().any(|body| boxes[*body].is_some_and(|it| it.touches(&own)))
                    }
                };
        }
    }
}

/// Whether the peg of a stem is seated in a hole: its head lies on the plate, and its axis is that of the
/// hole.
fn is_seated(data: &MjData<Arc<MjModel>>, stem: &Placed, hole: &Placed) -> bool {
    let at = seen_from(data, stem.body, hole);
    is_in(&at) && (at.z.abs() - hole.extent.half.z).abs() < FLUSH
}

/// The origin of a body in the frame of a hole, m.
fn seen_from(data: &MjData<Arc<MjModel>>, body: usize, hole: &Placed) -> Vector3<f64> {
    let apart = Vector3::from(data.xpos()[body]) - Vector3::from(data.xpos()[hole.body]);
    Matrix3::from_row_slice(&data.xmat()[hole.body]).transpose() * apart
}

/// Whether a place in the frame of a hole is on the hole's axis.
fn is_in(at: &Vector3<f64>) -> bool {
    at.x.abs() < ASIDE && at.y.abs() < ASIDE
}

fn in_world(data: &MjData<Arc<MjModel>>, piece: &Placed, room: f64) -> Extent {
    piece.extent.placed(&data.xpos()[piece.body], &data.xmat()[piece.body], room)
}
