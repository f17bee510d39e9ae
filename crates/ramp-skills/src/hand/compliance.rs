//! Motion under impedance: one control period at a time, guarded against large forces.

use nalgebra::{Vector3, Vector6};
use ramp_motion::Joints;
use ramp_robot::{ArmCommand, Command, GRAVITY, Impedance, PERIOD, RobotError};

use super::access::Hand;
use crate::fault::{Fault, SkillError};

impl Hand<'_> {
    /// Begins to move under impedance from where the tip is: setpoint and posture become the present ones.
    pub fn relax(&mut self) {
        self.setpoint = self.seen.x_wt;
        self.posture = self.joints();
        self.stiffness = Vector6::from(self.parameters.stiffness);
    }

    /// One control period under impedance at the present setpoint.
    ///
    /// # Errors
    /// [`Fault::Overload`], and the robot's.
    pub fn tick(&mut self) -> Result<(), SkillError> {
        self.impedance_step()?;
        self.guard()
    }

    /// Stops a motion at a force larger than any skill needs: the setpoint becomes the present pose. The
    /// guard acts once, until the force has fallen to half of the limit, so that a skill can move the hand
    /// away.
    pub(super) fn guard(&mut self) -> Result<(), SkillError> {
        let force = self.seen.wrench.fixed_rows::<3>(0).norm();
        if force < 0.5 * self.parameters.guard {
            self.struck = false;
        }
        if force < self.parameters.guard || self.struck {
            return Ok(());
        }
        self.struck = true;
        self.relax();
        for _ in 0..(self.parameters.yield_time / PERIOD).round() as usize {
            self.impedance_step()?;
        }
        Err(Fault::Overload { force }.into())
    }

    fn impedance_step(&mut self) -> Result<(), RobotError> {
        let impedance = Impedance {
            x_wt: self.setpoint,
            stiffness: self.stiffness,
            damping_ratio: 1.0,
            feed_forward: self.weight(),
            posture: self.posture.into(),
        };
        self.command(Command { arm: ArmCommand::CartesianImpedance(impedance), gripper: self.gripper })
    }

    /// The wrench at the tip that carries the held part.
    fn weight(&self) -> Vector6<f64> {
        let Some(held) = &self.held else { return Vector6::zeros() };
        let lift = Vector3::new(0.0, 0.0, held.mass * GRAVITY);
        let lever = self.seen.x_wt.rotation * (held.x_tp * held.p_centre).coords;
        let moment = lever.cross(&lift);
        Vector6::new(0.0, 0.0, lift.z, moment.x, moment.y, moment.z)
    }

    /// Waits under impedance, s.
    ///
    /// # Errors
    /// [`Fault::Overload`], and the robot's.
    pub fn wait(&mut self, seconds: f64) -> Result<(), SkillError> {
        for _ in 0..(seconds / PERIOD).round() as usize {
            self.tick()?;
        }
        Ok(())
    }

    /// Waits under impedance until the arm is still. A hand that is still before it reaches its setpoint may
    /// only be stuck by friction for a moment.
    ///
    /// # Errors
    /// [`Fault::Overload`], and the robot's.
    pub fn settle(&mut self) -> Result<(), SkillError> {
        let [near, near_turn] = self.parameters.arrived;
        let mut still = 0.0;
        for _ in 0..(self.parameters.settled / PERIOD).round() as usize {
            self.tick()?;
            let moves = Joints::from(self.seen.velocities).amax() >= self.parameters.at_rest;
            still = if moves { 0.0 } else { still + PERIOD };
            let off = (self.setpoint.translation.vector - self.seen.x_wt.translation.vector).norm();
            let turned = self.setpoint.rotation.angle_to(&self.seen.x_wt.rotation);
            if still > self.parameters.stuck || (still > 0.0 && off < near && turned < near_turn) {
                break;
            }
        }
        Ok(())
    }
}
