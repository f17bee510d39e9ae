//! Common steps of all insertions of a held beam: attempts, start, push, retreat.

use nalgebra::{Point3, Translation3, Vector3};
use ramp_robot::{EventKind, Retry};

use super::contract::Call;
use crate::Pose;
use crate::cell::Workcell;
use crate::fault::{Fault, SkillError};
use crate::grasp::BEAM_WIDTH;
use crate::hand::Rise;
use crate::parameters::Parameters;
use crate::parameters::insertions::InsertionParameters;
use crate::rehearsal::outline::{Motion, Outline, Stage};
use crate::rehearsal::scene::Scene;

/// Common parameters of all insertions.
#[derive(Clone)]
pub struct Insertion {
    parameters: InsertionParameters,
}

/// An insertion that is to be pushed in.
pub struct Aim {
    /// Final pose of the beam in the world.
    pub goal: Pose,
    /// The direction of the insertion: a unit vector, axes of the world.
    pub direction: Vector3<f64>,
    /// Beams, by name, that the beam passes through and that little holds.
    pub loose: Vec<String>,
    /// The arm feels too little to tell that it drags one of those along: images have to.
    pub watched: bool,
}

/// Outcome of a push.
pub struct Pushed {
    /// It met more force than its limit, or dragged a sleeve along.
    pub stopped: bool,
    /// It dragged a sleeve along.
    pub dragged: bool,
    /// The force against it at its end, N.
    pub force: f64,
}

impl Insertion {
    /// With these numbers.
    pub fn new(parameters: &Parameters) -> Insertion {
        Insertion { parameters: parameters.insertion.clone() }
    }

    /// Tries up to [`InsertionParameters::tries`] times, until one try succeeds.
    ///
    /// # Errors
    /// The fault of the last try; at once [`Fault::NotHeld`], [`Fault::Robot`] and the robot's errors.
    pub fn tries(
        &self,
        cell: &mut Workcell,
        beam: usize,
        mut once: impl FnMut(&mut Workcell, usize) -> Result<(), SkillError>,
    ) -> Result<(), SkillError> {
        let name = cell.assembly.beams[beam].beam.name.clone();
        cell.hand.relax();
        let mut last = None;
        for attempt in 0..self.parameters.tries {
            if attempt > 0 {
                cell.record(Retry::new("insert", &name).attempt(attempt + 1));
            }
            match once(cell, attempt) {
                // After a stop of the arm, the beam may be anywhere in the hand.
                Err(SkillError::Fault(fault @ (Fault::NotHeld { .. } | Fault::Robot { .. }))) => {
                    return Err(fault.into());
                }
                Err(SkillError::Fault(fault)) => last = Some(fault),
                Err(error) => return Err(error),
                Ok(()) => {
                    last = None;
                    break;
                }
            }
            // Beams that were displaced or have swung about their peg must be realigned first.
            if !cell.belief.displaced()?.is_empty() || !cell.belief.swung()?.is_empty() {
                break;
            }
        }
        last.map_or(Ok(()), |fault| Err(fault.into()))
    }

    /// Looks at the joints that are to meet, and brings the held beam to where its insertion begins, `height`
    /// (m) over its insertion path and at least a little.
    ///
    /// # Errors
    /// [`Fault::NotHeld`], [`Fault::NoPath`], [`Fault::Unseen`], or the fault that stopped the motion.
    pub fn begin(
        &self,
        cell: &mut Workcell,
        beam: usize,
        height: f64,
        attempt: usize,
    ) -> Result<Aim, SkillError> {
        let name = cell.assembly.beams[beam].beam.name.clone();
        cell.see(&cell.belief.meeting(beam), self.parameters.known)?;
        if attempt == 0 {
            cell.diagnose_standing();
        }
        cell.check_grip(&name)?;
        let place = cell.belief.target(beam)?;
        let direction = cell.belief.insertion_direction(beam, &place)?;
        let goal = Translation3::from(direction * cell.belief.path(beam)?.depth) * place;
        let clear = if attempt == 0 { self.parameters.clear } else { 0.0 };
        let start = cell.belief.insertion_start(beam, clear)?;
        // A beam that comes down on the table first need not be exactly over its path.
        let x_wb = cell.belief.parts.pose(&name)?;
        let off = (x_wb.translation.vector - start.translation.vector).norm();
        let turned = x_wb.rotation.angle_to(&start.rotation);
        if attempt > 0 || off > self.parameters.near || turned > self.parameters.near_turn {
            cell.bring_to(&name, &start)?;
        }
        if attempt == 0 {
            cell.touch_table(beam)?;
        }
        cell.bring_to(&name, &cell.belief.insertion_start(beam, height.max(self.parameters.lowest))?)?;
        cell.hand.zero()?;
        // A loose beam turns about a single peg, too.
        let loose = cell.belief.loose_sleeves(beam, 1);
        let watched = !loose.is_empty() && cell.is_rough();
        Ok(Aim { goal, direction, loose, watched })
    }

    /// Moves the tip fast towards `target` (world) up to where the males come to the mouths of their joints.
    /// A beam that passes through a sleeve is in it from the start, and would drag it along.
    ///
    /// # Errors
    /// The fault that stopped the motion, or the robot's error.
    pub fn approach_mouths(
        &self,
        cell: &mut Workcell,
        beam: usize,
        aim: &Aim,
        target: &Pose,
    ) -> Result<(), SkillError> {
        let from = cell.hand.setpoint;
        let way = (target.translation.vector - from.translation.vector).dot(&aim.direction);
        let free = way - cell.belief.path(beam)?.depth - self.parameters.mouth;
        if free > 0.0 && cell.belief.sleeves(beam).next().is_none() {
            cell.hand.go(&from.lerp_slerp(target, free / way), self.parameters.free_speed)?;
        }
        Ok(())
    }

    /// Pushes the tip to `target` (world) until the beam meets more than `limit` (N, through a loosely held
    /// sleeve a rise of the force), and adds the shifts that the push may have caused to the belief. A beam
    /// with a pose to `arrive` at (world) is brought onto its line during the motion. A `watched` push goes
    /// in steps, with a look after each.
    ///
    /// # Errors
    /// The fault that stopped the motion, or the robot's error.
    pub fn push_in(
        &self,
        cell: &mut Workcell,
        beam: usize,
        aim: &Aim,
        target: &Pose,
        arrive: Option<&Pose>,
        limit: f64,
    ) -> Result<Pushed, SkillError> {
        let direction = aim.direction;
        let name = &cell.assembly.beams[beam].beam.name;
        let x_pt = cell.belief.parts.pose(name)?.inverse() * cell.hand.seen.x_wt;
        let arrives = arrive.map(|x_wp| x_wp * x_pt);
        let mut rise = Rise::new(direction, &cell.parameters.rise);
        let loose = !aim.loose.is_empty();
        let InsertionParameters { speed, acceleration, loose_speed, loose_acceleration, .. } =
            self.parameters;
        let pace = if loose { (loose_speed, loose_acceleration) } else { (speed, acceleration) };
        let way = (target.translation.vector - cell.hand.setpoint.translation.vector).dot(&direction);
        let steps = if aim.watched { (way / self.parameters.watched_step).ceil().max(1.0) } else { 1.0 };
        let before = self.sleeve_holes(cell, beam, aim)?;
        let (mut stopped, mut dragged) = (false, false);
        for step in 1..=steps as usize {
            let left = Translation3::from(direction * -(way * (1.0 - step as f64 / steps)));
            let arrives = arrives.map(|arrives| left * arrives);
            stopped = cell.hand.drive_in_line(&(left * target), arrives.as_ref(), pace, |hand| {
                let force = hand.force().dot(&direction);
                // A rise that is slow is no edge; yet what meets this much does not go on.
                if loose {
                    rise.sense(hand) > limit || force > self.parameters.loose_most
                } else {
                    force > limit
                }
            })?;
            dragged = aim.watched && self.drags(cell, beam, aim, &before)?;
            stopped |= dragged;
            if stopped {
                break;
            }
        }
        let force = cell.hand.force().dot(&direction);
        cell.hand.wait(self.parameters.rest)?;
        // A beam that meets an edge moves the sleeve: it may rotate about two pegs that are close together.
        let sleeves =
            cell.belief.sleeves(beam).map(|sleeve| cell.assembly.beams[sleeve.beam].beam.name.clone());
        let sleeves: Vec<String> = sleeves.collect();
        for (met, _) in cell.belief.meeting(beam) {
            let carried = aim.loose.contains(&met) || (stopped && sleeves.contains(&met));
            let bump = match sleeves.contains(&met) {
                _ if carried => (self.parameters.loose_bump, self.parameters.loose_bump_turn),
                true => (self.parameters.sleeve_bump, self.parameters.sleeve_bump_turn),
                false => (self.parameters.bump, self.parameters.bump_turn),
            };
            cell.belief.parts.bumped(&met, bump);
        }
        cell.glance()?;
        Ok(Pushed { stopped, dragged, force })
    }

    /// Looks whether the sleeves that little holds have moved along, from where they were `before`, m in the
    /// world.
    fn drags(
        &self,
        cell: &mut Workcell,
        beam: usize,
        aim: &Aim,
        before: &[Point3<f64>],
    ) -> Result<bool, SkillError> {
        for sleeve in &aim.loose {
            let bump = (self.parameters.loose_bump, self.parameters.loose_bump_turn);
            cell.belief.parts.bumped(sleeve, bump);
        }
        cell.look_again(1)?;
        let now = self.sleeve_holes(cell, beam, aim)?;
        let moved = before.iter().zip(&now).map(|(before, now)| (now - before).norm());
        Ok(moved.fold(0.0, f64::max) > self.parameters.watched_moved)
    }

    /// Believed places of the sleeves of an insertion that little holds, m in the world.
    fn sleeve_holes(&self, cell: &Workcell, beam: usize, aim: &Aim) -> Result<Vec<Point3<f64>>, SkillError> {
        let sleeves = cell.belief.sleeves(beam);
        let loose = sleeves.filter(|it| aim.loose.contains(&cell.assembly.beams[it.beam].beam.name));
        loose.map(|sleeve| cell.belief.parts.hole(cell.assembly, sleeve)).collect()
    }

    /// Backs a jammed beam out to where its insertion began, free of the joint. A beam that catches on an
    /// edge on its way out, or of which one end stays behind in a joint, searches compliantly for the way, as
    /// on its way in. One that does not come out is let go of where it is: lifted, it would tear at the
    /// frame. From then on it counts as standing, short of its place.
    ///
    /// # Errors
    /// Always: [`Fault::Jammed`], or the fault that stopped the motion.
    pub fn back_out(
        &self,
        cell: &mut Workcell,
        beam: usize,
        direction: &Vector3<f64>,
        remaining: f64,
        force: f64,
    ) -> Result<(), SkillError> {
        let part = cell.assembly.beams[beam].beam.name.clone();
        let jam = Fault::Jammed { part: part.clone(), remaining, force };
        cell.record(jam.clone());
        let mut back = cell.hand.setpoint;
        back.translation = cell.hand.seen.x_wt.translation;
        let path = cell.belief.path(beam)?;
        back.translation.vector -= direction * (path.distance + path.depth - remaining).max(0.0);
        let out = -direction;
        let caught = cell.hand.drive(&back, self.parameters.back_speed, |hand| {
            hand.force().dot(&out) > self.parameters.back_limit
        })?;
        cell.glance()?;
        let start = cell.belief.insertion_start(beam, 0.0)?;
        if caught || cell.belief.remaining(&part, &start, &out)? > self.parameters.back_short {
            cell.compliant_search(&part, &start, &out, &cell.compliance(false))?;
            let left = cell.belief.remaining(&part, &start, &out)?;
            if left > self.parameters.back_caught {
                let text = format!("{part} does not come out by {:.0} mm: it is let go of there", left * 1e3);
                cell.record(EventKind::Note { text });
                self.let_go(cell, beam)?;
                cell.belief.standing.push(beam);
                cell.remember_standing(&[beam]);
            }
        }
        Err(jam.into())
    }

    /// Lets go of the held beam where it is if it is caught in a joint: lifted, it would tear at the frame.
    /// From then on it counts as standing, short of its place.
    ///
    /// # Errors
    /// The fault that stopped the motion, or the robot's error.
    pub fn let_go_of_caught(&self, cell: &mut Workcell) -> Result<(), SkillError> {
        let held = cell.hand.held.as_ref().and_then(|held| cell.assembly.beam_index(&held.part));
        let Some(beam) = held.filter(|beam| cell.belief.paths.contains_key(beam)) else { return Ok(()) };
        let name = cell.assembly.beams[beam].beam.name.clone();
        let start = cell.belief.insertion_start(beam, 0.0)?;
        let x_wb = cell.belief.parts.pose(&name)?;
        let direction = cell.belief.insertion_direction(beam, &cell.belief.target(beam)?)?;
        let way = x_wb.translation.vector - start.translation.vector;
        let entered = way.dot(&direction);
        let aside = (way - direction * entered).norm();
        if entered > self.parameters.back_caught && aside < self.parameters.back_caught {
            let text = format!("{name} is {:.0} mm in its joint: it is let go of there", entered * 1e3);
            cell.record(EventKind::Note { text });
            // One that was pushed stands already.
            if !cell.belief.standing.contains(&beam) {
                cell.belief.standing.push(beam);
            }
            self.let_go(cell, beam)?;
            cell.remember_standing(&[beam]);
        }
        Ok(())
    }

    /// Lowers the free end of the inserted beam onto the table, and lets go.
    ///
    /// # Errors
    /// The fault that stopped the motion, or the robot's error.
    pub fn let_go(&self, cell: &mut Workcell, beam: usize) -> Result<(), SkillError> {
        cell.settle(beam)?;
        cell.release()
    }
}

/// The motions of an insertion, from where it begins: the held beam goes straight to its place, the fingers
/// open, and the hand retreats. Joints that go into each other overlap as boxes, so the check is one of arm
/// and hand alone.
pub fn rehearse_insertion(scene: &Scene, call: &Call) -> Outline {
    let Ok(beam) = call.beam(scene.assembly) else { return Outline::nothing() };
    let name = &scene.assembly.beams[beam].beam.name;
    let Some(held) = scene.holds(name) else { return Outline::nothing() };
    let depth = scene.paths.get(&beam).map_or(0.0, |path| path.depth);
    let x_wt = scene.x_wb_goal(beam, depth) * held.x_tp.inverse();
    let would_touch = "on its insertion path the hand would touch";
    Outline::one(vec![
        Motion::Straight { x_wt, open: BEAM_WIDTH, around: None, stage: Stage::Insertion, would_touch },
        // The planner's geometry knows that the fingers have room to open at some point of the link.
        Motion::Fingers(scene.parameters.grip.beam_release - BEAM_WIDTH),
        Motion::Retreat,
    ])
}
