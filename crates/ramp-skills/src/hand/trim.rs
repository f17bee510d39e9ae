//! Keeps the tip on the line of a straight motion against friction.

use nalgebra::{Translation3, UnitQuaternion, Vector3};
use ramp_robot::PERIOD;

use super::access::Hand;
use crate::Pose;
use crate::parameters::hand::TrimParameters;

/// Integral correction that keeps the tip on a line. All in the world.
pub struct Trim {
    pub(super) parameters: TrimParameters,
    /// A setpoint of the motion, and the pose of the tip that belongs to it.
    setpoint: Pose,
    tip: Pose,
    /// The tip turns as the setpoint turns.
    turns: bool,
    /// Direction of the motion, a unit vector. Along it nothing is corrected.
    direction: Vector3<f64>,
    /// Correction of the setpoint: translation, m, and rotation vector, rad.
    shift: Vector3<f64>,
    turn: Vector3<f64>,
}

impl Trim {
    /// For a motion of the hand to `x_wt`, where the tip `arrives` at a pose, or keeps the distance from the
    /// setpoint that it has at the beginning.
    pub(super) fn new(hand: &Hand, x_wt: &Pose, arrives: Option<&Pose>) -> Trim {
        let way = x_wt.translation.vector - hand.setpoint.translation.vector;
        let (setpoint, tip) = arrives.map_or((hand.setpoint, hand.seen.x_wt), |arrives| (*x_wt, *arrives));
        Trim {
            parameters: hand.trim_bounds(),
            setpoint,
            tip,
            turns: arrives.is_none(),
            direction: way.try_normalize(1e-9).unwrap_or_default(),
            shift: Vector3::zeros(),
            turn: Vector3::zeros(),
        }
    }

    /// For a tip that is to be at the pose that each period names, within these bounds. Along
    /// `direction`, a unit vector, nothing is corrected.
    pub fn at_named_poses(parameters: TrimParameters, direction: Vector3<f64>) -> Trim {
        let (setpoint, tip) = (Pose::identity(), Pose::identity());
        let (shift, turn) = (Vector3::zeros(), Vector3::zeros());
        Trim { parameters, setpoint, tip, turns: true, direction, shift, turn }
    }

    /// The setpoint for a point of the line, with the tip at `seen`.
    pub fn trimmed(&mut self, line: &Pose, seen: &Pose) -> Pose {
        let wanted = self.tip.translation.vector + line.translation.vector - self.setpoint.translation.vector;
        let off = wanted - seen.translation.vector;
        let off = off - self.direction * off.dot(&self.direction);
        let with_line = line.rotation * self.setpoint.rotation.inverse();
        let turn = if self.turns { with_line } else { UnitQuaternion::identity() };
        let turned = turn * self.tip.rotation * seen.rotation.inverse();
        let gain = PERIOD / self.parameters.time;
        self.shift = (self.shift + off * gain).cap_magnitude(self.parameters.most);
        self.turn = (self.turn + turned.scaled_axis() * gain).cap_magnitude(self.parameters.most_turn);
        Pose::from_parts(
            Translation3::from(line.translation.vector + self.shift),
            UnitQuaternion::from_scaled_axis(self.turn) * line.rotation,
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parameters::Parameters;

    /// Joint friction holds the tip a third of a millimetre and 3 mrad off its line: the setpoint goes the
    /// other way until the tip is back, along the motion it stays as it was, and it goes no further than its
    /// bounds.
    #[test]
    fn the_trim_brings_the_tip_back_to_its_line() {
        let parameters = Parameters::baseline().trim.clone();
        let trim = |direction| Trim::at_named_poses(parameters.clone(), direction);
        let friction = Pose::new(Vector3::new(-0.4e-3, 0.0, -0.3e-3), Vector3::new(0.0, 3.0e-3, 0.0));
        let mut kept = trim(Vector3::x());
        let mut setpoint = Pose::identity();
        for _ in 0..2000 {
            setpoint = kept.trimmed(&Pose::identity(), &(setpoint * friction));
        }
        let tip = setpoint * friction;
        assert!(tip.translation.z.abs() < 0.01e-3 && tip.rotation.angle() < 0.1e-3, "{tip}");
        assert!(setpoint.translation.x.abs() < 1e-6, "{setpoint}");
        let mut held = trim(Vector3::x());
        for _ in 0..20_000 {
            setpoint = held.trimmed(&Pose::identity(), &Pose::translation(0.0, 0.0, -5.0e-3));
        }
        assert!((setpoint.translation.z - parameters.most).abs() < 1e-9, "{setpoint}");
    }

    /// A hand that stands beside its line when the motion begins, turned by 2 mrad, is on it before it has
    /// gone 30 mm: the end of a long beam would else meet its joint a millimetre too high.
    #[test]
    fn the_trim_brings_the_tip_onto_the_line_on_which_it_arrives() {
        let setpoint = Pose::translation(45.0e-3, 0.0, 0.0);
        let mut trim = Trim {
            parameters: Parameters::baseline().trim.clone(),
            setpoint,
            tip: setpoint,
            turns: false,
            direction: Vector3::x(),
            shift: Vector3::zeros(),
            turn: Vector3::zeros(),
        };
        let off = Pose::new(Vector3::new(0.0, 0.3e-3, 1.0e-3), Vector3::new(0.0, 2.0e-3, 0.0));
        let mut seen = off;
        for period in 0..600 {
            let line = Pose::translation(50.0e-3 * f64::from(period) * PERIOD, 0.0, 0.0);
            seen = trim.trimmed(&line, &seen) * off;
        }
        let left = seen.translation.vector.yz().norm();
        assert!(left < 0.05e-3 && seen.rotation.angle() < 0.1e-3, "{seen}");
        assert!((seen.translation.x - 30.0e-3).abs() < 0.1e-3, "{seen}");
    }
}
