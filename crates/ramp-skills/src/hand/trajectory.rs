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

    /// The same, with actions shortly before the end, or a halt on the way.
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
        let mut pushed_at = None;
        for (index, q) in samples.iter().enumerate().skip(1) {
            if let Some(at) = pushed_at.filter(|_| arrival.halts) {
                return self.halt(&samples[at..]);
            }
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
            if (now - force).abs() > self.parameters.pushed_force || (turning - moment).abs() > most {
                self.pushed = true;
                pushed_at = Some(index);
            }
        }
        self.come_to_rest(trajectory.end())
    }

    /// Slows down along the rest of a timed joint path, evenly and smoothly, and comes to rest on it.
    fn halt(&mut self, rest: &[Joints]) -> Result<(), SkillError> {
        let periods = (self.parameters.halt / PERIOD).max(1.0);
        let last = rest.len() - 1;
        let (mut period, mut along) = (0.0, 0.0);
        while period < periods && along < last as f64 {
            period += 1.0;
            let share: f64 = period / periods;
            // From the whole speed to none, with no jump of the acceleration.
            along = (along + 1.0 - share * share * (3.0 - 2.0 * share)).min(last as f64);
            let before = (along as usize).min(last - 1);
            self.joint_step(rest[before].lerp(&rest[before + 1], along - before as f64))?;
            self.guard()?;
        }
        let before = (along as usize).min(last.saturating_sub(1));
        let end = rest[before].lerp(&rest[(before + 1).min(last)], along - before as f64);
        self.come_to_rest(end)
    }

    /// Waits until the arm has come to rest at the end of a motion.
    fn come_to_rest(&mut self, end: Joints) -> Result<(), SkillError> {
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
                // A wait repeats the last command: one that yields, and not one of a joint in motion.
                self.tick()?;
                return Ok(true);
            }
        }
        Ok(false)
    }
}
