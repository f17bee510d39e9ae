//! Seats a peg: presses it with growing force and a small circle, by its head once it stands.

use std::f64::consts::TAU;

use nalgebra::Vector6;
use ramp_kit::joint::STEM_LENGTH;
use ramp_robot::{Cause, EventKind, Retry};

use crate::cell::Workcell;
use crate::fault::{Fault, SkillError};
use crate::grasp::peg_grasps;
use crate::parameters::Parameters;
use ramp_robot::PERIOD;

impl Workcell<'_, '_> {
    /// Seats a peg that stands in its hole: presses it by its head, as often as it takes. A head that seems
    /// a little too high and that two presses in a row do not lower rests on the plate: contact tells it
    /// better than the cameras.
    ///
    /// # Errors
    /// [`Fault::NotSeated`] after the last try.
    pub fn seat_peg(&mut self, connection: usize, peg: &str) -> Result<(), SkillError> {
        let (mut before, mut unmoved) = (f64::INFINITY, 0);
        for attempt in 0.. {
            self.see_gap(connection, peg)?;
            let gap = self.belief.gap(connection, peg)?;
            if gap <= 2.0 * self.parameters.press.seated {
                break;
            }
            unmoved = if before - gap < self.parameters.press.unmoved { unmoved + 1 } else { 0 };
            if unmoved == 2 && gap < self.parameters.press.height_error {
                let gap = gap * 1e3;
                let text =
                    format!("{peg} seems {gap:.2} mm over the plate and goes no lower: it rests there");
                self.record(EventKind::Note { text });
                break;
            }
            before = gap;
            let name = self.assembly.connections[connection].name.clone();
            let fault = Fault::NotSeated { peg: peg.to_string(), connection: name, gap };
            if attempt == self.parameters.press.tries {
                return Err(fault.into());
            }
            self.record(Retry::new("press", peg).attempt(attempt + 1).off(gap).because(&fault));
            let [grasp, _] = peg_grasps(&self.belief.parts.pose(peg)?, &self.parameters.grip);
            self.grasp(peg, &grasp)?;
            self.hand.zero()?;
            self.press(connection, peg)?;
            self.release()?;
        }
        Ok(())
    }

    /// Presses the peg down with growing force and a small circle, until it is seated, or sinks no further:
    /// soon where its head seems to be at the plate, and after a while where it stands on the joint below.
    /// Shortly before the plate, fingers with a dead time are commanded to open; the press ends before they
    /// do.
    pub fn press(&mut self, connection: usize, peg: &str) -> Result<(), SkillError> {
        let begin = self.hand.time();
        let plate = self.belief.mouth(connection)?.z;
        let mut centre = self.hand.seen.x_wt.translation.vector;
        let mut force: f64 = 0.0;
        let (mut ticks, mut measured) = (0u32, Vector6::zeros());
        let (mut lowest_seen, mut sunk_at) = (f64::INFINITY, 0.0);
        // A held peg creeps in the fingers under load: a blocked peg seems to sink slowly.
        let (mut stands_at, mut pressed_at) = (f64::INFINITY, 0.0);
        let mut opens_at = None;
        self.hand.setpoint.translation = self.hand.seen.x_wt.translation;
        while self.hand.time() - begin < self.parameters.press.time {
            let elapsed = self.hand.time() - begin;
            force = (force + self.parameters.press.rate * PERIOD).min(self.parameters.press.force);
            // Gently while it falls freely; the circle starts when it has not simply dropped in.
            let radius = if elapsed < 1.0 { 0.0 } else { self.parameters.press.circle };
            let phase = TAU * self.parameters.press.circle_rate * elapsed;
            let here = self.hand.seen.x_wt.translation.vector;
            // The centre drifts to where the hole draws the peg.
            centre.x += (here.x - centre.x) * 0.003;
            centre.y += (here.y - centre.y) * 0.003;
            let lead = force / self.hand.stiffness.z;
            let gap = self.hand.x_wp_held().map_or(0.0, |x_wp| x_wp.translation.z - plate);
            let lands = gap < self.parameters.press.landing;
            if opens_at.is_none() && gap.max(self.belief.gap(connection, peg)?) < self.parameters.press.ahead
            {
                let Parameters { press, grip, .. } = &*self.parameters;
                let falls = (press.ahead - press.landing).max(0.0) / press.speed;
                let within = falls + press.landing / press.landing_speed + press.hold;
                let opened = self.hand.open_ahead(grip.peg_open, grip.opening_force, within);
                opens_at = opened.map(|at| at - press.hold);
            }
            if opens_at.is_some_and(|at| self.hand.time() > at) {
                break;
            }
            // Once its head has landed the force may grow fast.
            let landing = lands && elapsed - sunk_at < self.parameters.press.landed;
            let speed =
                if landing { self.parameters.press.landing_speed } else { self.parameters.press.speed };
            let lowest = self.hand.setpoint.translation.z - speed * PERIOD;
            let setpoint = &mut self.hand.setpoint.translation;
            setpoint.x = centre.x + radius * phase.cos();
            setpoint.y = centre.y + radius * phase.sin();
            setpoint.z = (here.z - lead).max(lowest);
            self.hand.tick()?;
            let sinks = here.z < lowest_seen - self.parameters.press.sunk;
            if sinks {
                (lowest_seen, sunk_at) = (here.z, elapsed);
            }
            let goes_on = here.z < stands_at - self.parameters.press.creep;
            if goes_on || force < self.parameters.press.force {
                (stands_at, pressed_at) = (here.z, elapsed);
                measured = Vector6::zeros();
            } else {
                measured += self.hand.wrench();
            }
            ticks += 1;
            if ticks.is_multiple_of(20) {
                self.glance()?;
                let gap = self.belief.parts.pose(peg)?.translation.z - plate;
                if gap < 0.3 * self.parameters.press.seated
                    || elapsed - sunk_at > self.parameters.press.stall && gap < self.parameters.press.nearly
                    || elapsed - pressed_at > self.parameters.press.stands && gap > STEM_LENGTH / 2.0
                {
                    break;
                }
            }
        }
        let seconds = self.hand.time() - begin;
        let gap = self.belief.parts.pose(peg)?.translation.z - plate;
        if seconds > self.parameters.press.long || gap > STEM_LENGTH / 2.0 {
            let beside = self.tip_beside(&measured, plate).dot(&self.across()).abs();
            if gap > STEM_LENGTH / 2.0 && beside > self.parameters.press.beside {
                let evidence = format!("{peg} presses {:.0} mm beside the hand", beside * 1e3);
                self.diagnose(Cause::GripMoved, peg, evidence);
            } else {
                self.diagnose(Cause::Jam, peg, format!("{peg} was pressed for {seconds:.1} s"));
            }
        }
        Ok(())
    }
}
