//! Forces of the hand on the world, and their rise.

use nalgebra::{Vector3, Vector6};
use ramp_robot::PERIOD;

use super::access::Hand;
use crate::fault::SkillError;
use crate::parameters::hand::RiseParameters;

/// Rise of the force in one direction over its running mean. It detects an obstacle whatever bias and
/// friction the measured force has, since friction is constant at constant speed.
pub struct Rise {
    direction: Vector3<f64>,
    /// The running mean (N) and how long it has been taken, s.
    mean: f64,
    time: f64,
    parameters: RiseParameters,
}

impl Rise {
    /// In a direction, a unit vector in the world.
    pub fn new(direction: Vector3<f64>, parameters: &RiseParameters) -> Rise {
        Rise { direction, mean: 0.0, time: 0.0, parameters: parameters.clone() }
    }

    /// Rise over the force at the beginning of the motion: for a slow motion, whose force rises slowly.
    pub fn over_beginning(direction: Vector3<f64>, parameters: &RiseParameters) -> Rise {
        let parameters = RiseParameters { mean: f64::INFINITY, ..parameters.clone() };
        Rise { direction, mean: 0.0, time: 0.0, parameters }
    }

    /// The rise after another control period, N; 0 while the motion begins.
    pub fn sense(&mut self, hand: &Hand) -> f64 {
        self.over(hand.seen.wrench.fixed_rows::<3>(0).dot(&self.direction))
    }

    /// The rise of a force (N) in the direction, one control period after the last.
    fn over(&mut self, force: f64) -> f64 {
        self.time += PERIOD;
        if self.time < self.parameters.begin {
            self.mean = force;
        }
        let rise = force - self.mean;
        self.mean += rise * PERIOD / self.parameters.mean;
        rise
    }
}

impl Hand<'_> {
    /// Takes the present reading of the wrist as zero.
    ///
    /// # Errors
    /// [`Fault::Overload`](crate::Fault::Overload), and the robot's.
    pub fn zero(&mut self) -> Result<(), SkillError> {
        // The sensor's filter has a time constant of 20 ms: let the last motion fade out of it.
        self.wait(self.parameters.rest)?;
        self.tare = self.seen.wrench;
        Ok(())
    }

    /// Force of the hand on the world since [`Hand::zero`], axes of the world, N.
    pub fn force(&self) -> Vector3<f64> {
        (self.seen.wrench - self.tare).fixed_rows::<3>(0).into_owned()
    }

    /// Wrench of the hand on the world at the wrist since [`Hand::zero`], axes of the world: N, N·m.
    pub fn wrench(&self) -> Vector6<f64> {
        self.seen.wrench - self.tare
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parameters::Parameters;

    /// The force of a push into a loose sleeve has a bias, a step of friction at the start, a slow drift, and
    /// then an edge. Only the edge is detected, and soon.
    #[test]
    fn an_edge_is_told_apart_from_bias_and_friction() {
        let parameters = Parameters::baseline();
        let limit = parameters.assemble.loose_limit;
        let mut rise = Rise::new(Vector3::x(), &parameters.rise);
        let mut detected = None;
        for period in 0..2000 {
            let time = f64::from(period) * PERIOD;
            let friction = if time < 0.03 { 0.0 } else { 1.3 };
            let edge = (time - 1.5).max(0.0) * 75.0;
            if detected.is_none() && rise.over(-2.0 + friction + 0.5 * time + edge) > limit {
                detected = Some(time);
            }
        }
        assert!(detected.is_some_and(|time| (1.5..1.52).contains(&time)), "{detected:?}");
    }

    /// A slow touch is detected by its rise since the beginning. A running mean would follow it.
    #[test]
    fn a_slow_touch_is_detected() {
        let parameters = Parameters::baseline();
        let force = |time: f64| 2.0 + (time - 0.5).max(0.0) * 15.0;
        let largest = |mut rise: Rise| {
            (0..1200).map(|period| rise.over(force(f64::from(period) * PERIOD))).fold(0.0, f64::max)
        };
        let limit = parameters.touch.press;
        assert!(largest(Rise::new(Vector3::x(), &parameters.rise)) < limit);
        assert!(largest(Rise::over_beginning(Vector3::x(), &parameters.rise)) > limit);
    }
}
