//! Straight motions under impedance.

use nalgebra::{Translation3, UnitQuaternion};
use ramp_motion::Joints;
use ramp_robot::PERIOD;

use super::access::Hand;
use super::speed_profile::SpeedProfile;
use super::trim::Trim;
use crate::Pose;
use crate::fault::SkillError;

impl Hand<'_> {
    /// Moves the setpoint in a straight line to `x_wt` (world), until it arrives or `stop` returns true.
    /// Trapezoidal speed profile with `speed` (m/s) as the largest speed, slowed when a joint nears its
    /// velocity limit. Returns true if it was stopped; the setpoint then stays where it was.
    ///
    /// # Errors
    /// [`Fault::Overload`](crate::Fault::Overload), and the robot's.
    pub fn drive(
        &mut self,
        x_wt: &Pose,
        speed: f64,
        stop: impl FnMut(&Hand) -> bool,
    ) -> Result<bool, SkillError> {
        self.drive_trimmed(x_wt, (speed, self.parameters.acceleration), None, stop)
    }

    /// The same along a line that the tip must keep. Friction moves the tip off its line; the setpoint is
    /// corrected until the tip is on the line again, within the bounds of the trim. The line ends where the
    /// tip `arrives` (world), in the orientation of that pose throughout. Without that pose, it is the line
    /// on which the tip keeps its distance from the setpoint. Largest speed (m/s) and acceleration (m/s²) are
    /// the motion's own.
    ///
    /// # Errors
    /// [`Fault::Overload`](crate::Fault::Overload), and the robot's.
    pub fn drive_in_line(
        &mut self,
        x_wt: &Pose,
        arrives: Option<&Pose>,
        (speed, acceleration): (f64, f64),
        stop: impl FnMut(&Hand) -> bool,
    ) -> Result<bool, SkillError> {
        let trim = Trim::new(self, x_wt, arrives);
        self.drive_trimmed(x_wt, (speed, acceleration), Some(trim), stop)
    }

    fn drive_trimmed(
        &mut self,
        x_wt: &Pose,
        (speed, acceleration): (f64, f64),
        mut trim: Option<Trim>,
        mut stop: impl FnMut(&Hand) -> bool,
    ) -> Result<bool, SkillError> {
        let from = self.setpoint;
        let distance = (x_wt.translation.vector - from.translation.vector).norm();
        let angle = from.rotation.angle_to(&x_wt.rotation);
        let shift = SpeedProfile::new(distance, speed, acceleration);
        let turn = SpeedProfile::new(angle, self.parameters.turn_speed, self.parameters.turn_acceleration);
        let way = if shift.duration() > turn.duration() { shift } else { turn };
        let duration = way.duration();
        let (mut time, mut s) = (0.0, 0.0);
        while s < 1.0 {
            time += PERIOD * self.pace();
            s = if time >= duration { 1.0 } else { way.share(time) };
            let p = from.translation.vector.lerp(&x_wt.translation.vector, s);
            let rotation = from.rotation.try_slerp(&x_wt.rotation, s, 1e-9).unwrap_or(x_wt.rotation);
            let line = Pose::from_parts(Translation3::from(p), rotation);
            self.setpoint = match &mut trim {
                Some(trim) => trim.trimmed(&line, &self.seen.x_wt),
                None => line,
            };
            self.tick()?;
            if stop(self) {
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// The share of its speed at which a straight motion continues: less than 1 where a joint nears its
    /// velocity limit.
    fn pace(&self) -> f64 {
        const CREEP: f64 = 0.05;
        let [slower, creep] = self.parameters.hurry;
        let hurry = Joints::from(self.seen.velocities).component_div(&self.fastest).amax();
        ((creep - hurry) / (creep - slower).max(f64::EPSILON)).clamp(CREEP, 1.0)
    }

    /// Moves without a condition to stop.
    ///
    /// # Errors
    /// [`Fault::Overload`](crate::Fault::Overload), and the robot's.
    pub fn go(&mut self, x_wt: &Pose, speed: f64) -> Result<(), SkillError> {
        self.drive(x_wt, speed, |_| false).map(|_| ())
    }

    /// Moves the setpoint at `speed` (m/s) so that the held part, now at `x_wp`, comes to `x_wp_goal` (both
    /// in the world). The setpoint keeps its lead over the tip.
    ///
    /// # Errors
    /// [`Fault::Overload`](crate::Fault::Overload), and the robot's.
    pub fn correct(&mut self, x_wp: &Pose, x_wp_goal: &Pose, speed: f64) -> Result<(), SkillError> {
        let target = self.corrected(x_wp, x_wp_goal);
        self.go(&target, speed)
    }

    /// The setpoint that brings a held part from `x_wp` to `x_wp_goal`.
    pub fn corrected(&self, x_wp: &Pose, x_wp_goal: &Pose) -> Pose {
        self.corrected_from(&self.setpoint, x_wp, x_wp_goal)
    }

    /// The same, with the tip commanded to be at `commanded` (world).
    pub fn corrected_from(&self, commanded: &Pose, x_wp: &Pose, x_wp_goal: &Pose) -> Pose {
        let x_wt = self.seen.x_wt;
        let x_wt_goal = x_wp_goal * x_wp.inverse() * x_wt;
        let shift = x_wt_goal.translation.vector - x_wt.translation.vector;
        let turn: UnitQuaternion<f64> = x_wt_goal.rotation * x_wt.rotation.inverse();
        Pose::from_parts(Translation3::from(commanded.translation.vector + shift), turn * commanded.rotation)
    }
}
