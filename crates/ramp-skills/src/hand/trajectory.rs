//! Follows timed joint paths.

use ramp_motion::{Joints, Trajectory};
use ramp_robot::{Observation, PERIOD};

use super::access::{Arrival, Hand};
use crate::fault::SkillError;

impl Hand<'_> {
    /// Runs a timed joint path and waits until the arm has come to rest at its end.
    ///
    /// # Errors
    /// [`Fault::Overload`](crate::Fault::Overload), and the robot's.
    pub fn follow(&mut self, trajectory: &Trajectory) -> Result<(), SkillError> {
        self.follow_and(trajectory, &Arrival::default())
    }

    /// The same, with actions shortly before the end.
    ///
    /// # Errors
    /// [`Fault::Overload`](crate::Fault::Overload), and the robot's.
    pub fn follow_and(&mut self, trajectory: &Trajectory, arrival: &Arrival) -> Result<(), SkillError> {
        let measured = |seen: &Observation| {
            (seen.wrench.fixed_rows::<3>(0).norm(), seen.wrench.fixed_rows::<3>(3).norm())
        };
        let (force, moment) = measured(&self.seen);
        let most = self.parameters.pushed_moment.max(self.parameters.pushed_usual * self.usual_force);
        let samples = trajectory.samples();
        let early = (self.dead_time.least.unwrap_or(0.0) / PERIOD) as usize;
        let look = arrival.look.map(|ahead| samples.len().saturating_sub((ahead / PERIOD) as usize));
        for (index, q) in samples.iter().enumerate().skip(1) {
            if let Some(closing) =
                arrival.closing.filter(|_| samples.len() - index < early && !self.seen.gripper_busy)
            {
                self.gripper = closing;
            }
            if look == Some(index) {
                self.expose()?;
            }
            self.joint_step(*q)?;
            self.guard()?;
            let (now, turning) = measured(&self.seen);
            self.pushed |=
                (now - force).abs() > self.parameters.pushed_force || (turning - moment).abs() > most;
        }
        let end = trajectory.end();
        for _ in 0..300 {
            self.joint_step(end)?;
            self.guard()?;
            if Joints::from(self.seen.velocities).amax() < 0.002 && (self.joints() - end).amax() < 0.004 {
                break;
            }
        }
        Ok(())
    }

    /// Runs a timed joint path until its end, or until `stop` returns true: the hand then yields where it is.
    /// Returns true if it was stopped.
    ///
    /// # Errors
    /// [`Fault::Overload`](crate::Fault::Overload), and the robot's.
    pub fn follow_until(
        &mut self,
        trajectory: &Trajectory,
        mut stop: impl FnMut(&Hand) -> bool,
    ) -> Result<bool, SkillError> {
        for q in trajectory.samples().iter().skip(1) {
            self.joint_step(*q)?;
            self.guard()?;
            if stop(self) {
                self.relax();
                return Ok(true);
            }
        }
        Ok(false)
    }
}
