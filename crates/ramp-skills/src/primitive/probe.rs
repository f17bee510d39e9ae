//! Probing for the mouth of a joint: the beam backs off, moves aside, and is pushed again.
//!
//! A beam that is pressed on the edge of a sleeve is held there by friction, and a rough arm cannot swing it
//! off that edge. Backed off, it moves freely. The probes go over a grid across the insertion path, the
//! nearest place first, until the beam advances past the edge.

use nalgebra::{Translation3, Vector3};
use ramp_robot::Search;

use crate::Pose;
use crate::cell::Workcell;
use crate::fault::SkillError;

impl Workcell<'_, '_> {
    /// Probes with a stalled beam for the mouth that its leading end meets. Returns whether the beam has
    /// entered: it is then some millimetres past the edge.
    ///
    /// # Errors
    /// [`Fault::Overload`](crate::Fault::Overload), [`Fault::Unseen`](crate::Fault::Unseen), and the robot's.
    pub fn probe(&mut self, part: &str, goal: &Pose, direction: &Vector3<f64>) -> Result<bool, SkillError> {
        let probe = self.parameters.probe.clone();
        let begin = self.hand.time();
        let across = Vector3::z().cross(direction);
        self.belief.parts.follow(&self.hand);
        let stalled = self.belief.remaining(part, goal, direction)?;
        let pace = (probe.speed, self.parameters.hand.acceleration);
        let (mut entered, mut probes) = (false, 0);
        for [aside, up] in probe.places() {
            probes += 1;
            let x_wp = self.belief.parts.pose(part)?;
            let x_pt = x_wp.inverse() * self.hand.seen.x_wt;
            let shifted = Translation3::from(across * aside + Vector3::z() * up) * goal;
            let at = |remaining: f64| Translation3::from(-direction * remaining) * shifted;
            // Off the edge and aside, with no lead of the setpoint; then straight on, to beyond the edge.
            let off = at(stalled + probe.back);
            let target = self.hand.corrected_from(&self.hand.seen.x_wt, &x_wp, &off);
            self.hand.drive_in_line(&target, Some(&(off * x_pt)), pace, |_| false)?;
            self.belief.parts.follow(&self.hand);
            let beyond = at(stalled - probe.beyond);
            let target = self.hand.corrected(&self.belief.parts.pose(part)?, &beyond);
            self.hand.drive_in_line(&target, Some(&(beyond * x_pt)), pace, |hand| {
                hand.force().dot(direction) > probe.limit
            })?;
            self.belief.parts.follow(&self.hand);
            if stalled - self.belief.remaining(part, goal, direction)? > probe.entered {
                entered = true;
                break;
            }
        }
        let duration = Some(self.hand.time() - begin);
        let (method, part) = ("probe".to_string(), part.to_string());
        self.record(Search { method, part, duration, attempts: Some(probes) });
        Ok(entered)
    }
}
