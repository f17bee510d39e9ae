//! Compliant search of an insertion that stalls on an edge.
//!
//! The arm pushes the beam softly along its insertion path. While the beam stands still, the arm sweeps it
//! across that path with growing amplitude, until it slips off the edge.

use nalgebra::{Translation3, UnitQuaternion, Vector3};
use ramp_robot::Search;

use crate::Pose;
use crate::cell::Workcell;
use crate::fault::SkillError;
use crate::hand::trim::Trim;
use crate::parameters::contact::ComplianceParameters;

impl Workcell<'_, '_> {
    /// The motion of a search through sleeves that little holds, or through others.
    pub fn compliance(&self, loose: bool) -> ComplianceParameters {
        let (loosely, firmly) = (&self.parameters.search_loose, &self.parameters.search_sleeve);
        if loose { loosely.clone() } else { firmly.clone() }
    }

    /// Searches compliantly with a stalled beam: a light push along the insertion path, and a slow swing of
    /// growing size across it, up and down, and about both, until the beam slips off the edge. An unchamfered
    /// edge (thru-m) stops dead unless it meets its female within 0.3 mm. Returns the longest time for which
    /// the beam stood still, s.
    pub fn compliant_search(
        &mut self,
        part: &str,
        goal: &Pose,
        direction: &Vector3<f64>,
        compliance: &ComplianceParameters,
    ) -> Result<f64, SkillError> {
        let begin = self.hand.time();
        let across = Vector3::z().cross(direction);
        let (mut stalled_since, mut stood) = (begin, 0.0_f64);
        let mut looked = begin;
        let mut best = self.belief.remaining(part, goal, direction)?;
        let mut paced = (begin, best);
        // The line of the insertion path, as a correction of the setpoint that each look renews.
        let mut line = self.hand.setpoint;
        // Joint friction holds the tip off that line by more than the sleeve forgives.
        let mut bounds = self.hand.trim_bounds();
        bounds.time = self.parameters.search.keep_time;
        bounds.most *= compliance.kept;
        bounds.most_turn *= compliance.kept_turn;
        let mut trim = Trim::at_named_poses(bounds, *direction);
        let mut ticks = 0u32;
        while self.hand.time() - begin < self.parameters.search.longest {
            if ticks.is_multiple_of(20) {
                // A part that does not move may have moved in the hand.
                if stalled_since.max(looked) + self.parameters.search.look_every < self.hand.time() {
                    self.belief.parts.update(&mut self.hand)?;
                    looked = self.hand.time();
                } else {
                    self.glance()?;
                }
                let x_wp = self.belief.parts.pose(part)?;
                let remaining = self.belief.remaining(part, goal, direction)?;
                if remaining < compliance.near {
                    break;
                }
                if self.hand.time() - paced.0 > compliance.pace_time {
                    if paced.1 - remaining < self.parameters.search.pace_distance {
                        break;
                    }
                    paced = (self.hand.time(), remaining);
                }
                stood = stood.max(self.hand.time() - stalled_since);
                if remaining < best - self.parameters.search.progress {
                    best = remaining;
                    stalled_since = self.hand.time();
                }
                // The pose of the tip with the part on the line, at its current advance.
                let on_line = Translation3::from(direction * -remaining) * goal;
                line = on_line * x_wp.inverse() * self.hand.seen.x_wt;
            }
            ticks += 1;
            let time = self.hand.time() - begin;
            let stalled = self.hand.time() - stalled_since;
            // Straight on while it moves; then a swing that grows, and begins small again.
            let grown = ((stalled - self.parameters.search.patience).max(0.0) % self.parameters.search.cycle
                / self.parameters.search.growth)
                .min(1.0);
            let swings = if stalled < self.parameters.search.patience { 0.0 } else { 1.0 };
            let wave = |hertz: f64| (std::f64::consts::TAU * hertz * time).sin();
            let swing =
                |[begin, end]: [f64; 2], hertz: f64| swings * (begin + (end - begin) * grown) * wave(hertz);
            // Harder once it takes longer than a swing to grow.
            let long =
                ((time - self.parameters.search.growth) / self.parameters.search.cycle).clamp(0.0, 1.0);
            let [begins, ends] = compliance.force;
            let lead = (begins + (ends - begins) * long) / self.hand.stiffness.x;
            let shift = across * swing(compliance.across, compliance.across_rate)
                + Vector3::z() * swing(compliance.up, compliance.up_rate);
            let yaw = compliance.yaw * grown * wave(compliance.yaw_rate);
            let roll = compliance.roll * grown * wave(compliance.roll_rate);
            let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), yaw)
                * UnitQuaternion::from_scaled_axis(across * roll);
            let swung =
                Pose::from_parts(Translation3::from(line.translation.vector + shift), turn * line.rotation);
            let kept = trim.trimmed(&swung, &self.hand.seen.x_wt);
            self.hand.setpoint = Translation3::from(direction * lead) * kept;
            self.hand.tick()?;
        }
        let duration = Some(self.hand.time() - begin);
        self.record(Search { method: "compliant".into(), part: part.to_string(), duration, attempts: None });
        Ok(stood)
    }
}
