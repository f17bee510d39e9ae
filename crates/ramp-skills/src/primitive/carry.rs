//! Brings the held part above a place, and to a pose in free space.

use crate::Pose;
use crate::cell::Workcell;
use crate::fault::SkillError;

impl Workcell<'_, '_> {
    /// Carries the held part above a place, where the tip is at `down` (world), with the tip at a height that
    /// follows from that at the place, m. Gives the pose of the tip at the place, which is another one when
    /// the part moved in the hand.
    ///
    /// # Errors
    /// [`Fault::NotHeld`](crate::Fault::NotHeld) when it left the hand meanwhile; [`SkillError::Motion`] when
    /// no motion is found; the robot's.
    pub fn carry_above(&mut self, mut down: Pose, height: impl Fn(f64) -> f64) -> Result<Pose, SkillError> {
        for attempt in 1.. {
            let mut above = down;
            above.translation.z = height(down.translation.z);
            self.travel(&above)?;
            // A part that is tilted between the ribs of the fingers may turn back by its own weight.
            self.hand.pushed |= attempt == 1 && self.is_tilted();
            if !self.hand.pushed || attempt == self.parameters.carry.tries {
                break;
            }
            let Some(before) = self.hand.held.clone() else { break };
            self.check_grip(&before.part)?;
            let Some(held) = &self.hand.held else { break };
            let moved = before.x_tp * held.x_tp.inverse();
            down *= moved;
            if moved.rotation.angle() < self.parameters.carry.tilted {
                break;
            }
        }
        Ok(down)
    }

    /// Brings the held part to a pose in free space, looking again as it moves.
    pub fn bring_to(&mut self, part: &str, x_wp_goal: &Pose) -> Result<(), SkillError> {
        for _ in 0..self.parameters.carry.corrections {
            self.glance()?;
            let x_wp = self.belief.parts.pose(part)?;
            let shift = (x_wp.translation.vector - x_wp_goal.translation.vector).norm();
            if shift < self.parameters.carry.near
                && x_wp.rotation.angle_to(&x_wp_goal.rotation) < self.parameters.carry.near_turn
            {
                break;
            }
            self.correct_freely(&x_wp, x_wp_goal)?;
        }
        self.hand.relax();
        Ok(())
    }

    /// Brings the held part, which is free and now at `x_wp`, to `x_wp_goal`, a little way off: by the
    /// joints' positions, which friction turns aside by less than the hand's springs.
    ///
    /// # Errors
    /// [`Fault::Overload`](crate::Fault::Overload), and the robot's.
    pub fn correct_freely(&mut self, x_wp: &Pose, x_wp_goal: &Pose) -> Result<(), SkillError> {
        let start = self.hand.start();
        let told = self.planner.kinematics.tip(&start);
        let target = self.hand.corrected_from(&told, x_wp, x_wp_goal);
        match self.planner.straight(&start, &target) {
            Some(line) => self.hand.follow(&self.law().time(&line)),
            None => {
                self.hand.relax();
                self.hand.correct(x_wp, x_wp_goal, self.parameters.carry.speed)?;
                self.hand.settle()
            }
        }
    }
}
