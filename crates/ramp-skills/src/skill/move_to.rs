//! Moves the hand, and what it holds, from place to place.

use std::f64::consts::TAU;

use nalgebra::{Translation3, Vector3};
use ramp_kit::joint::STEM_LENGTH;
use ramp_motion::MotionError;
use ramp_planner::{FineAction, Place, Target};
use ramp_robot::Cause;

use super::contract::{ActionKind, Call, Effect, Skill};
use super::regrasp::Regrasp;
use crate::Pose;
use crate::cell::Workcell;
use crate::fault::{Fault, SkillError};
use crate::grasp::{PEG_HEIGHT, hand_down};
use crate::parameters::Parameters;
use crate::parameters::skills::MoveToParameters;
use crate::primitive::travel::Way;

/// Moves the hand, and what it holds, from place to place.
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

    fn run(&self, cell: &mut Workcell, call: &Call) -> Result<(), SkillError> {
        let FineAction::Move { to } = call.action else { return Err(call.no_skill().into()) };
        match to {
            // The motion that follows goes by way of travelling height on its own, without a rest there.
            Place::Above(_) => Ok(()),
            Place::Input(item) => self.hover(cell, item.name(), call.link()),
            // With an empty hand the skill that follows moves on its own.
            Place::Approach(_) | Place::Target(_) if cell.hand.held.is_none() => Ok(()),
            Place::Approach(Target::Beam(_)) => {
                let beam = call.beam(cell)?;
                self.approach_beam(cell, beam)
            }
            Place::Approach(Target::Connection(_)) => {
                let connection = call.connection(cell)?;
                self.approach_hole(cell, connection)
            }
            Place::Target(_) => Ok(()),
        }
    }
}

impl MoveTo {
    /// With these numbers.
    pub fn new(parameters: &Parameters) -> MoveTo {
        MoveTo { parameters: parameters.move_to.clone(), regrasp: Regrasp::new(parameters) }
    }

    /// Moves the open hand over a part, at travelling height.
    ///
    /// # Errors
    /// When the part is unseen or out of reach, or the robot stops.
    fn hover(&self, cell: &mut Workcell, part: &str, link: Option<&str>) -> Result<(), SkillError> {
        // Where a beam is to go is easier to see before it is in the hand.
        if let Some(beam) = cell.assembly.beam_index(part) {
            let mut meeting = cell.meeting(beam);
            meeting.retain(|(other, _)| other != part);
            if !meeting.is_empty() {
                cell.see(&meeting, self.parameters.known)?;
            }
        }
        cell.see_to_grip(part)?;
        cell.diagnose_standing();
        if cell.kit.beam(part).is_none() {
            if cell.belief.pose(part).is_err() {
                cell.diagnose(Cause::PartMissing, part, format!("{part} is not in its holder"));
            }
            cell.diagnose_holder(part);
        }
        let (mut x_wt, open, _) = cell.choose_grasp(part, link)?;
        cell.hand.gripper.width = open;
        x_wt.translation.z = cell.parameters.travel.height;
        cell.travel_to_look(&x_wt)?;
        cell.diagnose_force()?;
        Ok(())
    }

    /// Carries the held beam to where its insertion begins, a little above its insertion path. A beam that the hand
    /// holds too far out for that is laid on a free place of the table and grasped again.
    ///
    /// # Errors
    /// [`SkillError::Motion`] when no motion is found; [`Fault::NotHeld`], [`Fault::Overload`], and the robot's.
    fn approach_beam(&self, cell: &mut Workcell, beam: usize) -> Result<(), SkillError> {
        let name = cell.assembly.beams[beam].beam.name.clone();
        cell.check_grip(&name)?;
        self.regrasp.level(cell, beam)?;
        let start = cell.insertion_start(beam, cell.parameters.insertion.clear)?;
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

    /// Carries the held beam through free space to a pose. If something pushed it, the agent looks at it before
    /// it lowers it: a beam that turned in the hand would meet the table with an end.
    fn carry(&self, cell: &mut Workcell, beam: usize, x_wb_goal: &Pose) -> Result<(), SkillError> {
        let part = &cell.assembly.beams[beam].beam.name;
        for attempt in 1.. {
            let Some(held) = &cell.hand.held else { break };
            let x_wt = x_wb_goal * held.x_tp.inverse();
            let mut above = x_wt;
            above.translation.z = above.translation.z.max(cell.parameters.travel.height);
            cell.travel(&above)?;
            if !cell.hand.pushed || attempt == cell.parameters.insertion.tries {
                return cell.travel(&x_wt);
            }
            cell.check_grip(part)?;
            self.regrasp.level(cell, beam)?;
        }
        Err(Fault::NotHeld { part: part.clone() }.into())
    }

    /// Carries the held peg over the hole of a connection.
    ///
    /// # Errors
    /// [`SkillError::Motion`] when no motion is found; [`Fault::NotHeld`], [`Fault::Overload`], and the robot's.
    fn approach_hole(&self, cell: &mut Workcell, connection: usize) -> Result<(), SkillError> {
        cell.see(
            &[cell.hole(cell.assembly.connections[connection].female)],
            cell.parameters.peg_search.hole_known,
        )?;
        cell.diagnose_standing();
        let mouth = cell.mouth(connection)?;
        let Some(part) = cell.hand.held.as_ref().map(|held| held.part.clone()) else {
            return Err(Fault::NotHeld { part: "the peg".into() }.into());
        };
        cell.check_grip(&part)?;
        let height =
            mouth.z + cell.parameters.peg_search.over + self.parameters.above + STEM_LENGTH + PEG_HEIGHT;
        let q = cell.hand.joints();
        let x = cell.hand.seen.x_wt.rotation * Vector3::x();
        let yaw = x.y.atan2(x.x);
        // Any turn of the square head will do. What counts is how far the joints stay from their ends while the peg
        // goes in, in the posture in which the arm arrives there.
        let candidates = [0.0, 1.0, -1.0, 2.0, -2.0, 3.0, -3.0, 4.0, -4.0, 5.0, -5.0, 6.0].map(|step| {
            let rotation = hand_down(yaw + step * TAU / 12.0);
            let over = Pose::from_parts(Translation3::new(mouth.x, mouth.y, height), rotation);
            let seated =
                Pose::from_parts(Translation3::new(mouth.x, mouth.y, mouth.z + PEG_HEIGHT), rotation);
            let arrival = cell.planner.solve(&over, &q);
            let margin = arrival.map_or(-1.0, |arrival| cell.planner.straight_margin(&arrival, &seated));
            (over, Way { margin, ..cell.way(&[over]) })
        });
        if let Some(x_wt) = cell.choose(&candidates) {
            return cell.travel_to_look(&x_wt);
        }
        // On no level path does the arm arrive so that the peg can go in: it takes another posture over the hole.
        for (over, _) in candidates {
            let down = Translation3::new(0.0, 0.0, mouth.z + PEG_HEIGHT - height) * over;
            let Some(arrival) = cell.planner.posture_for(&over, &down) else { continue };
            match cell.take_posture(&arrival) {
                Err(SkillError::Motion(_)) => {}
                other => return other,
            }
        }
        Err(Fault::NoGrasp { part }.into())
    }
}
