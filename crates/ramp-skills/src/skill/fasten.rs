//! Pins two joints with a peg: touch, search, press, check, try again.

use nalgebra::{Translation3, UnitQuaternion, Vector3};
use ramp_kit::joint::STEM_LENGTH;
use ramp_planner::Impossible;
use ramp_robot::{Cause, Retry, Search};

use super::contract::{ActionKind, Call, Effect, Need, Skill};
use crate::Pose;
use crate::cell::Workcell;
use crate::fault::{Fault, SkillError};
use crate::grasp::{PEG_HEIGHT, PEG_WIDTH, hand_down, peg_over_hole, yaw_of};
use crate::parameters::Parameters;
use crate::parameters::skills::FastenParameters;
use crate::rehearsal::outline::{Motion, Outline, Stage};
use crate::rehearsal::scene::Scene;

/// Pins two joints with the held peg.
#[derive(Clone)]
pub struct Fasten {
    parameters: FastenParameters,
}

impl Skill for Fasten {
    fn name(&self) -> &str {
        "fasten"
    }

    fn serves(&self) -> &[ActionKind] {
        &[ActionKind::Fasten]
    }

    fn needs(&self) -> &[Need] {
        &[Need::HoldsPart]
    }

    fn parameters(&self) -> &[&'static str] {
        &["fasten", "peg_search", "press"]
    }

    fn expects(&self) -> &[Effect] {
        &[Effect::PegSeated, Effect::HandEmpty]
    }

    /// Straight down from over the hole, in the rotation in which the hand has arrived.
    fn rehearse(&self, scene: &Scene, call: &Call) -> Outline {
        let Ok(connection) = call.connection(scene.assembly) else { return Outline::nothing() };
        if scene.now.held.is_none() {
            return Outline::nothing();
        }
        let mouth = scene.x_wp_seated(connection).translation.vector;
        let [_, x_wt] = peg_over_hole(&mouth, [0.0; 2], hand_down(yaw_of(&scene.x_wt())));
        let open = scene.parameters.grip.peg_open;
        let would_touch = "the hand with the peg would touch";
        Outline::one(vec![
            Motion::Straight { x_wt, open, around: None, stage: Stage::Insertion, would_touch },
            Motion::Fingers(open - PEG_WIDTH),
            Motion::Retreat,
        ])
    }

    fn blame(&self, call: &Call) -> Option<Impossible> {
        let connection = call.action.connection()?.to_string();
        Some(Impossible::Fasten { connection })
    }

    fn run(&self, cell: &mut Workcell, call: &Call) -> Result<(), SkillError> {
        let connection = call.connection(cell.assembly)?;
        self.fasten(cell, connection)
    }
}

impl Fasten {
    /// With these numbers.
    pub fn new(parameters: &Parameters) -> Fasten {
        Fasten { parameters: parameters.fasten.clone() }
    }

    /// Pins a connection with the held peg, which is over its hole, and lets go of it.
    ///
    /// # Errors
    /// [`Fault::HoleNotFound`] or [`Fault::NotSeated`] after the last try.
    fn fasten(&self, cell: &mut Workcell, connection: usize) -> Result<(), SkillError> {
        let Some(peg) = cell.hand.held.as_ref().map(|held| held.part.clone()) else {
            return Err(Fault::NotHeld { part: "the peg".into() }.into());
        };
        cell.hand.relax();
        let mut last = None;
        for attempt in 0..self.parameters.tries {
            match self.fasten_once(cell, connection, &peg, attempt) {
                Err(SkillError::Fault(fault @ (Fault::NotHeld { .. } | Fault::Robot { .. }))) => {
                    return Err(fault.into());
                }
                Err(SkillError::Fault(fault)) => {
                    cell.record(fault.clone());
                    // The hole is where it was seen, so the tip cannot be where it is believed to be.
                    let lost = matches!(fault, Fault::HoleNotFound { .. });
                    cell.diagnose(if lost { Cause::GripMoved } else { Cause::Jam }, peg.as_str(), &fault);
                    last = Some(fault);
                    // Another try would end in the same place: the beams must be pushed.
                    if cell.belief.apart.contains(&connection) {
                        break;
                    }
                }
                Err(error) => return Err(error),
                Ok(()) => {
                    last = None;
                    break;
                }
            }
            if attempt + 1 < self.parameters.tries {
                // Up and out of the hole, look again, and once more.
                let mut up = cell.hand.setpoint;
                up.translation.z = cell.belief.mouth(connection)?.z
                    + cell.parameters.peg_search.over
                    + STEM_LENGTH
                    + PEG_HEIGHT;
                cell.hand.go(&up, self.parameters.back_speed)?;
                let name = &cell.assembly.connections[connection].name;
                cell.record(Retry::new("fasten", name).attempt(attempt + 2));
            }
        }
        if let Some(fault) = last {
            return Err(fault.into());
        }
        cell.release()?;
        // Letting go may draw a peg up a little.
        cell.seat_peg(connection, &peg)
    }

    fn fasten_once(
        &self,
        cell: &mut Workcell,
        connection: usize,
        peg: &str,
        attempt: usize,
    ) -> Result<(), SkillError> {
        let name = cell.assembly.connections[connection].name.clone();
        cell.check_grip(peg)?;
        // Upright over the hole, as exactly as the eyes allow.
        cell.see(
            &[cell.belief.hole(cell.assembly.connections[connection].female)],
            cell.parameters.peg_search.hole_known,
        )?;
        cell.see(&[cell.belief.middle(peg)], self.parameters.known)?;
        cell.diagnose_standing();
        for _ in 0..cell.parameters.carry.corrections {
            cell.glance()?;
            let x_wp = cell.belief.parts.pose(peg)?;
            let mouth = cell.belief.mouth(connection)?;
            let x = x_wp.rotation * Vector3::x();
            let yaw = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), x.y.atan2(x.x));
            let goal = Pose::from_parts(
                Translation3::new(mouth.x, mouth.y, mouth.z + cell.parameters.peg_search.over + STEM_LENGTH),
                yaw,
            );
            let off = (goal.translation.vector - x_wp.translation.vector).norm();
            if off < cell.parameters.carry.near
                && goal.rotation.angle_to(&x_wp.rotation) < self.parameters.upright
            {
                break;
            }
            cell.correct_freely(&x_wp, &goal)?;
        }
        cell.hand.relax();
        cell.hand.zero()?;
        let plate = cell.belief.mouth(connection)?.z;
        cell.check_width(peg)?;
        let off = cell.lower(plate, cell.parameters.peg_search.over)?;
        if !cell.is_in(plate) {
            let begin = cell.hand.time();
            let upright = self.search(cell, connection, peg, attempt, off)?;
            let seconds = cell.hand.time() - begin;
            let (method, part) = ("spiral".to_string(), name.clone());
            cell.record(Search { method, part, duration: Some(seconds), attempts: None });
            if seconds > self.parameters.near_time
                && cell.is_deeper(plate, 0.5 * cell.parameters.peg_search.found)
                && !upright
            {
                let words = format!("{peg} went into {name} only after {seconds:.0} s");
                cell.diagnose(Cause::GripMoved, peg, words);
            }
        }
        if !cell.is_deeper(plate, 0.5 * cell.parameters.peg_search.found) {
            return Err(Fault::HoleNotFound { peg: peg.to_string(), connection: name }.into());
        }
        cell.press(connection, peg)?;
        // The fingers may have pressed on without it.
        cell.check_width(peg)?;
        if cell.belief.gap(connection, peg)? > STEM_LENGTH / 2.0 {
            // Through the female's plate, and on the male's: its hole is searched with a light force as well.
            let tip = plate + cell.belief.gap(connection, peg)? - STEM_LENGTH;
            let begin = cell.hand.time();
            let here = cell.hand.seen.x_wt.translation.vector;
            cell.spiral(tip, &here, self.parameters.near_time, None)?;
            let (method, part) = ("spiral_inside".to_string(), name.clone());
            let duration = Some(cell.hand.time() - begin);
            cell.record(Search { method, part, duration, attempts: None });
            cell.press(connection, peg)?;
        }
        for joint in
            [cell.assembly.connections[connection].female, cell.assembly.connections[connection].male]
        {
            let (beam, _) = cell.belief.hole(joint);
            cell.belief.parts.bumped(&beam, (self.parameters.bump, self.parameters.bump_turn));
        }
        // The look after the hand is off is more accurate. If the peg is too high, it is then pressed again
        // by its head.
        if cell.belief.gap(connection, peg)? < cell.parameters.press.nearly || cell.hand.opens() {
            return Ok(());
        }
        cell.see_gap(connection, peg)?;
        let gap = cell.belief.gap(connection, peg)?;
        // Only what is sure: there is a better look when the hand is off.
        if gap > cell.parameters.press.seated + 2.0 * cell.belief.gap_deviation(connection, peg) {
            // Its tip is in the female and goes no further.
            if (STEM_LENGTH / 2.0..STEM_LENGTH - cell.parameters.peg_search.found).contains(&gap)
                && !cell.belief.apart.contains(&connection)
            {
                cell.belief.apart.push(connection);
            }
            return Err(Fault::NotSeated { peg: peg.to_string(), connection: name, gap }.into());
        }
        Ok(())
    }

    /// Searches with the tip of the peg, which touches the plate, for the hole. `off` is the error of the
    /// moment at the tip, N·m. Returns whether the peg was tilted, and is upright in the hole.
    fn search(
        &self,
        cell: &mut Workcell,
        connection: usize,
        peg: &str,
        attempt: usize,
        off: f64,
    ) -> Result<bool, SkillError> {
        let mouth = cell.belief.mouth(connection)?;
        let plate = mouth.z;
        let (slipped, mut upright) = (cell.hand.slipped, false);
        if slipped {
            let evidence = format!("the fingers held {peg} loosely");
            cell.diagnose(Cause::GripMoved, peg, evidence);
        }
        // A search that failed once would fail again.
        let sure = slipped || attempt > 0;
        if !slipped {
            cell.spiral(plate, &cell.over_mouth(&mouth), self.parameters.near_time, Some(off))?;
        }
        if !cell.is_in(plate) {
            upright = cell.search_tilted(connection, peg, plate, sure)?;
        }
        if !cell.is_in(plate) {
            cell.spiral(plate, &cell.over_mouth(&mouth), self.parameters.search_time, None)?;
        }
        if cell.is_in(plate) && !upright {
            upright = cell.set_upright_if_beside(peg, &mouth, false)?;
        }
        Ok(upright)
    }
}
