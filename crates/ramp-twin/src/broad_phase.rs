//! Selection of the bodies that the engine considers in its search for contacts.
//!
//! MuJoCo's broad phase makes a box of each body from all of its geoms at every step, also of those that
//! sleep or are fixed; in the whole scene with its rings of boxes around holes that is more than half of a
//! step. Here, a body that nothing can touch in this step is left out before: one that is neither awake nor
//! near anything that is, or that may wake. The engine finds the same contacts in the same order, so no bit
//! of the physics changes. Of the bodies that are left, pieces that nothing can meet are left out as well
//! ([`pieces`](crate::pieces)).

use std::sync::Arc;

use mujoco_rs::mujoco_c::mj_step;
use mujoco_rs::prelude::*;
use nalgebra::Vector3;

use crate::extent::Extent;
use crate::mjcf::classes::is_arm;
use crate::pieces::{Piece, Pieces, part_of};

/// Enlargement of the boxes, m: poses are those of the step before, and no body moves at 20 m/s.
const MOTION: f64 = 20e-3;

/// Leaves out what nothing can touch. Keeps nothing from one step to the next but the boxes of bodies that
/// have not moved.
#[derive(Clone)]
pub(crate) struct BroadPhase {
    /// The extent of what can collide of each body, in its frame; `None` where nothing can.
    extents: Vec<Option<Extent>>,
    /// The same in the world, enlarged, and the poses for which they were placed.
    boxes: Vec<Option<Extent>>,
    poses: Vec<([f64; 3], [f64; 4])>,
    /// Whether a body is left in.
    near: Vec<bool>,
    /// Bodies whose neighbours are to be left in.
    queue: Vec<usize>,
    /// Contact types and affinities of bodies, as the engine is to see them.
    masks: [Vec<i32>; 2],
    /// Bodies that touch nothing.
    gone: Vec<usize>,
    /// Pieces of parts, of which only some are needed.
    pieces: Pieces,
    /// The bodies of the arm.
    arm: Vec<usize>,
    /// The number of geoms of the world and the arm, which come first in the model.
    first_geoms: i64,
}

impl BroadPhase {
    pub fn new(model: &MjModel) -> BroadPhase {
        let bodies = model.body_geomnum().len();
        let mut extents = vec![None; bodies];
        let (mut arm, mut first_geoms) = (Vec::new(), 0);
        let masks = model.geom_contype().iter().zip(model.geom_conaffinity());
        for (geom, (contype, conaffinity)) in masks.enumerate() {
            let Ok(body) = usize::try_from(model.geom_bodyid()[geom]) else { continue };
            if body > 0 && (*contype != 0 || *conaffinity != 0) {
                let own = extent(model, geom);
                extents[body] = Some(extents[body].map_or(own, |other: Extent| other.union(&own)));
            }
            if is_arm(*contype) {
                first_geoms = geom as i64 + 1;
                if arm.last() != Some(&body) {
                    arm.push(body);
                }
            }
        }
        let pieces = Pieces::new(model, &extents);
        // A part is as large as all of its pieces.
        for body in (0..bodies).filter(|body| Piece::of(model, *body).is_some()) {
            let Some(piece) = extents[body].take() else { continue };
            let moved = Extent { centre: piece.centre + Vector3::from(model.body_pos()[body]), ..piece };
            let part = part_of(model, body);
            extents[part] = Some(extents[part].map_or(moved, |own| own.union(&moved)));
        }
        let masks = [vec![0; bodies], vec![0; bodies]];
        let near = vec![false; bodies];
        let (boxes, queue, gone) = (extents.clone(), Vec::new(), Vec::new());
        let poses = vec![([f64::NAN; 3], [f64::NAN; 4]); bodies];
        BroadPhase { extents, boxes, poses, near, queue, masks, gone, pieces, arm, first_geoms }
    }

    /// Lets these bodies touch nothing any more.
    pub fn without(mut self, bodies: &[usize]) -> BroadPhase {
        self.gone = bodies.to_vec();
        self
    }

    /// Steps the physics, as [`MjData::step`] does.
    pub fn step(&mut self, data: &mut MjData<Arc<MjModel>>) {
        self.place(data);
        self.find(data);
        let model = data.model();
        // The whole world's geoms collide with whatever is awake.
        self.near[0] = true;
        self.gone.iter().for_each(|body| self.near[*body] = false);
        self.pieces.choose(data, &mut self.near, &self.boxes, &self.arm, MOTION / 2.0);
        for (mask, all) in self.masks.iter_mut().zip([model.body_contype(), model.body_conaffinity()]) {
            for ((mask, all), near) in mask.iter_mut().zip(all).zip(&self.near) {
                *mask = if *near { *all } else { 0 };
            }
        }
        // The model is shared and never changes: the engine gets a table of contents of its own, with other
        // columns for what can touch something. It also sorts bodies along the axes in which all geoms spread
        // most, and takes that spread anew at every step. The geoms of the arm do as well: the pairs that it
        // finds do not depend on the axes.
        let mut view = model.ffi().clone();
        let [contype, conaffinity] = &mut self.masks;
        (view.body_contype, view.body_conaffinity) = (contype.as_mut_ptr(), conaffinity.as_mut_ptr());
        view.ngeom = self.first_geoms;
        #[expect(unsafe_code, reason = "the engine's own step takes no model but the data's")]
        // SAFETY: all pointers of `view` are those of the data's model, which lives as long as the data, but
        // for two arrays of the same length, which live longer than the call. It has fewer geoms than they
        // hold. The engine keeps no pointer to a model.
        unsafe {
            mj_step(&raw const view, data.ffi_mut());
        }
    }

    /// Places the boxes of all bodies in the world.
    fn place(&mut self, data: &MjData<Arc<MjModel>>) {
        for (body, (extent, placed)) in self.extents.iter().zip(&mut self.boxes).enumerate() {
            let Some(extent) = extent else { continue };
            let pose = (data.xpos()[body], data.xquat()[body]);
            if self.poses[body] == pose {
                continue;
            }
            self.poses[body] = pose;
            *placed = Some(extent.placed(&data.xpos()[body], &data.xmat()[body], MOTION / 2.0));
        }
    }

    /// Keeps bodies that are awake, those that their boxes touch, those that these would wake, and so on.
    fn find(&mut self, data: &MjData<Arc<MjModel>>) {
        let model = data.model();
        let (trees, asleep) = (model.body_treeid(), data.tree_asleep());
        self.near.fill(false);
        self.queue.clear();
        for (body, tree) in trees.iter().enumerate() {
            let Ok(tree) = usize::try_from(*tree) else { continue };
            if asleep[tree] < 0 || data.body_awake()[body] == MjtSleepState::mjS_AWAKE {
                self.enter(body);
            } else if pushed(data, body) {
                self.enter_island(data, tree);
            }
        }
        while let Some(body) = self.queue.pop() {
            let Some(own) = self.boxes[body] else { continue };
            for (other, tree) in trees.iter().enumerate().skip(1) {
                if self.near[other] || !self.boxes[other].is_some_and(|it| it.touches(&own)) {
                    continue;
                }
                match usize::try_from(*tree) {
                    Ok(tree) => self.enter_island(data, tree),
                    // A fixed body moves no other.
                    Err(_) => self.near[other] = true,
                }
            }
        }
    }

    fn enter(&mut self, body: usize) {
        if !std::mem::replace(&mut self.near[body], true) {
            self.queue.push(body);
        }
    }

    /// Leaves in all that wakes with a tree: trees that fell asleep together wake together.
    fn enter_island(&mut self, data: &MjData<Arc<MjModel>>, first: usize) {
        let model = data.model();
        let mut tree = first;
        for _ in 0..data.tree_asleep().len() {
            let from = model.tree_bodyadr()[tree].max(0) as usize;
            let count = model.tree_bodynum()[tree].max(0) as usize;
            (from..from + count).for_each(|body| self.enter(body));
            match usize::try_from(data.tree_asleep()[tree]) {
                Ok(next) if next != first => tree = next,
                _ => break,
            }
        }
    }
}

/// Whether something pushes a body that sleeps, or has given it a velocity: the engine then wakes it.
fn pushed(data: &MjData<Arc<MjModel>>, body: usize) -> bool {
    let model = data.model();
    let from = model.body_dofadr()[body].max(0) as usize;
    let dofs = from..from + model.body_dofnum()[body].max(0) as usize;
    data.xfrc_applied()[body] != [0.0; 6]
        || data.qvel()[dofs.clone()].iter().chain(&data.qfrc_applied()[dofs]).any(|it| *it != 0.0)
}

/// The extent of a geom in its body's frame, with the distance at which its contacts begin.
fn extent(model: &MjModel, geom: usize) -> Extent {
    let [x, y, z, a, b, c] = model.geom_aabb()[geom];
    let [w, i, j, k] = model.geom_quat()[geom];
    let turn = nalgebra::UnitQuaternion::from_quaternion(nalgebra::Quaternion::new(w, i, j, k));
    let turn = turn.to_rotation_matrix().into_inner();
    let margin = model.geom_margin()[geom] + model.geom_gap()[geom];
    Extent {
        centre: Vector3::from(model.geom_pos()[geom]) + turn * Vector3::new(x, y, z),
        half: turn.abs() * Vector3::new(a, b, c) + Vector3::repeat(margin),
    }
}
