//! Moves the hand and the held part from place to place.

use nalgebra::{Translation3, Vector3};
use ramp_motion::MotionError;
use ramp_planner::{End, FineAction, Impossible, Item, Place, Target};
use ramp_robot::Cause;

use super::contract::{ActionKind, Call, Effect, Skill};
use super::regrasp::Regrasp;
use crate::Pose;
use crate::cell::Workcell;
use crate::fault::{Fault, SkillError};
use crate::grasp::{Grasp, peg_over_hole, peg_rotations, yaw_of};
use crate::parameters::Parameters;
use crate::parameters::skills::MoveToParameters;
use crate::rehearsal::outline::{Motion, Outline, Stage};
use crate::rehearsal::scene::Scene;
use crate::way::Way;

/// Moves the hand and the held part from place to place.
#[derive(Clone)]
pub struct MoveTo {
    parameters: MoveToParameters,
    regrasp: Regrasp,
}

impl Skill for MoveTo {
    fn name(&self) -> &str {
        "move_to"
    }

    fn serves(&self) -> &[ActionKind] {
        &[ActionKind::Move]
    }

    fn parameters(&self) -> &[&'static str] {
        &["move_to", "insertion", "peg_search"]
    }

    fn expects(&self) -> &[Effect] {
        &[]
    }

    /// The way to a part is rehearsed by the skill that grasps it.
    fn rehearse(&self, scene: &Scene, call: &Call) -> Outline {
        match call.action {
            FineAction::Move { to: Place::Approach(Target::Beam(_)) } => call
                .beam(scene.assembly)
                .map_or_else(|_| Outline::nothing(), |beam| self.rehearse_beam(scene, beam)),
            FineAction::Move { to: Place::Approach(Target::Connection(_)) } if scene.now.held.is_some() => {
                call.connection(scene.assembly)
                    .map_or_else(|_| Outline::nothing(), |connection| self.rehearse_peg(scene, connection))
            }
            _ => Outline::nothing(),
        }
    }

    fn blame(&self, call: &Call) -> Option<Impossible> {
        match call.action {
            FineAction::Move { to: Place::Input(Item::Beam(_)) } => call.cannot_grasp(End::Start),
            FineAction::Move { to: Place::Approach(Target::Beam(_)) } => call.cannot_grasp(End::Place),
            _ => None,
        }
    }

    fn run(&self, cell: &mut Workcell, call: &Call) -> Result<(), SkillError> {
        let FineAction::Move { to } = call.action else { return Err(call.no_skill().into()) };
        match to {
            // The motion that follows goes by way of travelling height on its own, without a rest there.
            Place::Above(_) => Ok(()),
            // A part in the hand is put down there by the skill that follows.
            Place::Input(_) if cell.hand.held.is_some() => Ok(()),
            Place::Input(item) => self.hover(cell, item.name(), call.link()),
            // With an empty hand the skill that follows moves on its own.
            Place::Approach(_) | Place::Target(_) if cell.hand.held.is_none() => Ok(()),
            Place::Approach(Target::Beam(_)) => {
                let beam = call.beam(cell.assembly)?;
                self.approach_beam(cell, beam)
            }
            Place::Approach(Target::Connection(_)) => {
                let connection = call.connection(cell.assembly)?;
                self.approach_hole(cell, connection)
            }
            Place::Target(_) => Ok(()),
        }
    }
}

impl MoveTo {
    /// The held beam goes to where its insertion begins.
    fn rehearse_beam(&self, scene: &Scene, beam: usize) -> Outline {
        let name = &scene.assembly.beams[beam].beam.name;
        let (Some(held), Some(path)) = (scene.holds(name), scene.paths.get(&beam)) else {
            return Outline::nothing();
        };
        let goal = scene.x_wb_goal(beam, path.depth);
        let back = scene.kit.x_wa().rotation * path.direction * -(path.distance + path.depth);
        let start = Translation3::from(back + Vector3::z() * scene.parameters.insertion.clear) * goal;
        let x_wt = start * held.x_tp.inverse();
        Outline::one(vec![Motion::Travel { x_wt, open: scene.width(name), stage: Stage::Approach }])
    }

    /// The held peg goes over its hole, in any rotation that fits.
    fn rehearse_peg(&self, scene: &Scene, connection: usize) -> Outline {
        let mouth = scene.x_wp_seated(connection).translation.vector;
        let heights = self.heights(&scene.parameters);
        let open = scene.parameters.grip.peg_open;
        let over = peg_rotations(yaw_of(&scene.x_wt())).map(|rotation| {
            let [x_wt, _] = peg_over_hole(&mouth, heights, rotation);
            vec![Motion::Travel { x_wt, open, stage: Stage::Approach }]
        });
        Outline::Alternatives(over.to_vec())
    }

    /// With these numbers.
    pub fn new(parameters: &Parameters) -> MoveTo {
        MoveTo { parameters: parameters.move_to.clone(), regrasp: Regrasp::new(parameters) }
    }

    /// The height over a hole to which a peg is carried: the height from which it is lowered, and more above
    /// it, m.
    fn heights(&self, parameters: &Parameters) -> [f64; 2] {
        [parameters.peg_search.over, self.parameters.above]
    }

    /// Moves the open hand over a part, at travelling height.
    ///
    /// # Errors
    /// When the part is unseen or out of reach, or the robot stops.
    fn hover(&self, cell: &mut Workcell, part: &str, link: Option<&str>) -> Result<(), SkillError> {
        // The place of a beam is easier to see before the beam is in the hand.
        if let Some(beam) = cell.assembly.beam_index(part) {
            let mut meeting = cell.belief.meeting(beam);
            meeting.retain(|(other, _)| other != part);
            if !meeting.is_empty() {
                cell.see(&meeting, self.parameters.known)?;
            }
        }
        cell.see_to_grip(part)?;
        cell.diagnose_standing();
        if cell.kit.beam(part).is_none() {
            if cell.belief.parts.pose(part).is_err() {
                cell.diagnose(Cause::PartMissing, part, format!("{part} is not in its holder"));
            }
            cell.diagnose_holder(part);
        }
        let Grasp { mut x_wt, open, .. } = cell.choose_grasp(part, link)?;
        cell.hand.gripper.width = open;
        x_wt.translation.z = cell.parameters.travel.height;
        cell.travel_to_look(&x_wt)?;
        cell.diagnose_force()?;
        Ok(())
    }

    /// Carries the held beam to where its insertion begins, a little above its insertion path. A beam that
    /// the hand holds too far out for that is laid on a free place of the table and grasped again.
    ///
    /// # Errors
    /// [`SkillError::Motion`] when no motion is found; [`Fault::NotHeld`], [`Fault::Overload`], and the
    /// robot's.
    fn approach_beam(&self, cell: &mut Workcell, beam: usize) -> Result<(), SkillError> {
        let name = cell.assembly.beams[beam].beam.name.clone();
        cell.check_grip(&name)?;
        self.regrasp.level(cell, beam)?;
        let start = cell.belief.insertion_start(beam, cell.parameters.insertion.clear)?;
        match self.carry(cell, beam, &start) {
            Err(SkillError::Motion(MotionError::Unreachable(_))) => {
                self.regrasp.grasp_again(cell, beam)?;
                self.carry(cell, beam, &start)?;
            }
            other => other?,
        }
        // A beam that turned in the hand meanwhile cannot be inserted as it is.
        cell.check_grip(&name)?;
        if !cell.is_tilted() {
            return Ok(());
        }
        self.regrasp.level(cell, beam)?;
        self.carry(cell, beam, &start)
    }

    /// Carries the held beam through free space to a pose. If something pushes it, the motion halts, and the
    /// agent raises it and looks at it before it goes on: a beam that turned in the hand would meet the table
    /// with an end.
    fn carry(&self, cell: &mut Workcell, beam: usize, x_wb_goal: &Pose) -> Result<(), SkillError> {
        let part = &cell.assembly.beams[beam].beam.name;
        for attempt in 1.. {
            let Some(held) = &cell.hand.held else { break };
            let x_wt = x_wb_goal * held.x_tp.inverse();
            if attempt == cell.parameters.insertion.tries {
                return cell.travel(&x_wt);
            }
            cell.travel_until_pushed(&x_wt)?;
            if !cell.hand.pushed {
                return Ok(());
            }
            cell.retreat()?;
            cell.check_grip(part)?;
            self.regrasp.level(cell, beam)?;
        }
        Err(Fault::NotHeld { part: part.clone() }.into())
    }

    /// Carries the held peg over the hole of a connection.
    ///
    /// # Errors
    /// [`SkillError::Motion`] when no motion is found; [`Fault::NotHeld`], [`Fault::Overload`], and the
    /// robot's.
    fn approach_hole(&self, cell: &mut Workcell, connection: usize) -> Result<(), SkillError> {
        cell.see(
            &[cell.belief.hole(cell.assembly.connections[connection].female)],
            cell.parameters.peg_search.hole_known,
        )?;
        cell.diagnose_standing();
        let mouth = cell.belief.mouth(connection)?;
        let Some(part) = cell.hand.held.as_ref().map(|held| held.part.clone()) else {
            return Err(Fault::NotHeld { part: "the peg".into() }.into());
        };
        cell.check_grip(&part)?;
        let q = cell.hand.joints();
        let heights = self.heights(&cell.parameters);
        let rotations = peg_rotations(yaw_of(&cell.hand.seen.x_wt));
        // Of the rotations that fit, the one that leaves the joints most room while the peg goes in, in the
        // posture in which the arm arrives there.
        let candidates = rotations.map(|rotation| {
            let [over, seated] = peg_over_hole(&mouth, heights, rotation);
            let arrival = cell.planner.solve(&over, &q);
            let margin = arrival.map_or(-1.0, |arrival| cell.planner.straight_margin(&arrival, &seated));
            (over, Way { margin, ..cell.way(&[over]) })
        });
        if let Some(x_wt) = cell.choose(&candidates) {
            return cell.travel_to_look(&x_wt);
        }
        // On no level path does the arm arrive so that the peg can go in: it takes another posture over the
        // hole.
        for rotation in rotations {
            let [over, down] = peg_over_hole(&mouth, heights, rotation);
            let Some(arrival) = cell.planner.posture_for(&over, &down) else { continue };
            match cell.take_posture(&arrival) {
                Err(SkillError::Motion(_)) => {}
                other => return other,
            }
        }
        Err(Fault::NoGrasp { part }.into())
    }
}
