//! Forces of the hand on the world, and their rise.

use nalgebra::{Vector3, Vector6};
use ramp_robot::PERIOD;

use super::access::Hand;
use crate::Pose;
use crate::fault::SkillError;
use crate::parameters::hand::RiseParameters;

/// Rise of the force in one direction over its running mean. It detects an obstacle whatever bias and
/// friction the measured force has, since friction is constant at constant speed. While a motion begins,
/// the friction of the joints rises until the tip follows its setpoint. That rise is known from the error of
/// the force in free space, so that a tip that is blocked from the beginning is told apart.
pub struct Rise {
    direction: Vector3<f64>,
    /// The running mean (N) and how long it has been taken, s.
    mean: f64,
    time: f64,
    begins: Option<Beginning>,
    parameters: RiseParameters,
}

/// A motion that begins.
struct Beginning {
    /// The first force, N.
    force: f64,
    /// Places of setpoint and tip one control period before, m in the direction.
    before: [f64; 2],
    /// Their smoothed speeds, m/s.
    speeds: [f64; 2],
}

impl Rise {
    /// In a direction, a unit vector in the world.
    pub fn new(direction: Vector3<f64>, parameters: &RiseParameters) -> Rise {
        Rise { direction, mean: 0.0, time: 0.0, begins: None, parameters: parameters.clone() }
    }

    /// Rise over the force at the beginning of the motion: for a slow motion, whose force rises slowly.
    pub fn over_beginning(direction: Vector3<f64>, parameters: &RiseParameters) -> Rise {
        Rise::new(direction, &RiseParameters { mean: f64::INFINITY, ..parameters.clone() })
    }

    /// The rise after another control period, N; 0 while the motion begins.
    pub fn sense(&mut self, hand: &Hand) -> f64 {
        let along = |x: &Pose| x.translation.vector.dot(&self.direction);
        let at = [along(&hand.setpoint), along(&hand.seen.x_wt)];
        self.over(hand.seen.wrench.fixed_rows::<3>(0).dot(&self.direction), at, hand.usual_force)
    }

    /// The rise of a force (N) in the direction, one control period after the last, with setpoint and tip
    /// `at` these places in it, m. The force in free space is off by `usual`, N.
    fn over(&mut self, force: f64, at: [f64; 2], usual: f64) -> f64 {
        if self.time == 0.0 {
            self.begins = Some(Beginning { force, before: at, speeds: [0.0; 2] });
        }
        self.time += PERIOD;
        if let Some(begins) = &mut self.begins {
            self.mean = force;
            let [setpoint, tip] = begins.moved(at, self.parameters.smooth);
            if force - begins.force > (self.parameters.friction * usual).max(self.parameters.least) {
                self.mean = begins.force;
                self.begins = None;
            } else if self.time >= self.parameters.begin && tip >= self.parameters.follows * setpoint {
                self.begins = None;
            }
        }
        let rise = force - self.mean;
        self.mean += rise * PERIOD / self.parameters.mean;
        rise
    }
}

impl Beginning {
    /// The smoothed speeds of setpoint and tip, m/s, when they are `at` these places.
    fn moved(&mut self, at: [f64; 2], smooth: f64) -> [f64; 2] {
        for ((speed, now), before) in self.speeds.iter_mut().zip(at).zip(self.before) {
            *speed += ((now - before) / PERIOD - *speed) * PERIOD / smooth;
        }
        self.before = at;
        self.speeds
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

    /// Setpoint and tip of a motion at 50 mm/s that friction does not hold back.
    fn free(time: f64) -> [f64; 2] {
        [0.05 * time, 0.05 * time]
    }

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
            let force = -2.0 + friction + 0.5 * time + edge;
            if detected.is_none() && rise.over(force, free(time), 0.4) > limit {
                detected = Some(time);
            }
        }
        assert!(detected.is_some_and(|time| (1.5..1.52).contains(&time)), "{detected:?}");
    }

    /// The joints of an arm with much friction break away late: the force rises by 4.5 N in 0.25 s, and the
    /// tip stands still meanwhile. That is no edge. A tip that is blocked as long as it is pushed harder has
    /// met one.
    #[test]
    fn friction_that_holds_the_tip_back_is_no_edge() {
        let parameters = Parameters::baseline();
        let usual = 2.2;
        let limit = parameters.assemble.loose_usual * usual;
        let push = |breaks_away: f64| {
            let mut rise = Rise::new(Vector3::x(), &parameters.rise);
            (0..2000).map(f64::from).map(|period| period * PERIOD).find(|&time| {
                let held = time.min(breaks_away);
                rise.over(18.0 * held, [0.05 * time, 0.05 * (time - held)], usual) > limit
            })
        };
        assert_eq!(push(0.25), None);
        let detected = push(f64::INFINITY);
        assert!(detected.is_some_and(|time| time < 0.4), "{detected:?}");
    }

    /// A slow touch is detected by its rise since the beginning. A running mean would follow it.
    #[test]
    fn a_slow_touch_is_detected() {
        let parameters = Parameters::baseline();
        let force = |time: f64| 2.0 + (time - 0.5).max(0.0) * 15.0;
        let largest = |mut rise: Rise| {
            let times = (0..1200).map(|period| f64::from(period) * PERIOD);
            times.map(|time| rise.over(force(time), free(time), 0.4)).fold(0.0, f64::max)
        };
        let limit = parameters.touch.press;
        assert!(largest(Rise::new(Vector3::x(), &parameters.rise)) < limit);
        assert!(largest(Rise::over_beginning(Vector3::x(), &parameters.rise)) > limit);
    }
}
