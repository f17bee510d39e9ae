//! Friction of the joints: bristles that bend before they slip (Canudas de Wit, Olsson, Åström, Lischinsky: A
//! new model for control of systems with friction, 1995).
//!
//! A joint at rest is held by its bristles like by a stiff spring, up to the friction at which it breaks
//! away; one that moves is braked by dry friction. The engine computes viscous friction.

use ramp_control::JointVector;
use ramp_robot::PERIOD;
use ramp_world::groups::{Arm, Friction};

/// Damping ratio of a bristle with the inertia of its drive. Chosen: it does not ring.
const DAMPING: f64 = 0.7;

/// Friction of all joints.
pub(crate) struct JointFriction {
    friction: Friction,
    /// Stiffness (N·m/rad) and damping (N·m·s/rad) of each.
    stiffness: JointVector,
    damping: JointVector,
}

impl JointFriction {
    /// The bristles of these drives.
    pub fn new(friction: &Friction, arm: &Arm) -> JointFriction {
        let stiffness = JointVector::from(friction.coulomb) / friction.presliding;
        let damping =
            JointVector::from_fn(|joint, _| 2.0 * DAMPING * (stiffness[joint] * arm.armature[joint]).sqrt());
        JointFriction { friction: friction.clone(), stiffness, damping }
    }

    /// The torques of friction on the joints, against these velocities (rad/s), after one more period, N·m.
    /// `deflections` (rad) are those of the bristles, zero at first.
    pub fn step(&self, deflections: &mut JointVector, velocities: &JointVector) -> JointVector {
        let Friction { coulomb, breakaway, stribeck, asymmetry, .. } = &self.friction;
        JointVector::from_fn(|joint, _| {
            if coulomb[joint] <= 0.0 {
                return 0.0;
            }
            let velocity = velocities[joint];
            let direction = 1.0 + asymmetry[joint] * velocity.signum();
            let most =
                coulomb[joint] * direction * (1.0 + breakaway * (-(velocity / stribeck).powi(2)).exp());
            // Equilibrium deflection of the bristle at this velocity, and the decay towards it: exact over
            // the period.
            let slipping = velocity.signum() * most / self.stiffness[joint];
            let fade = (-velocity.abs() * self.stiffness[joint] / most * PERIOD).exp();
            let before = deflections[joint];
            let bent = slipping + (before - slipping) * fade;
            deflections[joint] = bent;
            -(self.stiffness[joint] * bent + self.damping[joint] * (bent - before) / PERIOD)
        })
    }
}

/// Shares of the friction that act on the motor's side and on the link's side of the torque sensor.
pub(crate) fn shares(friction: &Friction) -> [f64; 2] {
    [1.0 - friction.past_sensor, friction.past_sensor]
}

#[cfg(test)]
mod tests {
    use ramp_robot::DOF;
    use ramp_world::World;

    use super::*;

    /// One joint with the inertia of its drive alone, under a torque that grows to its full size within a
    /// second: its final position, velocity and friction torque.
    fn pushed(torque: f64, periods: usize) -> (f64, f64, f64) {
        let physics = World::shipped("hard").map(|world| world.draw(1));
        let Some(mut physics) = physics else { return (0.0, 0.0, 0.0) };
        physics.friction.coulomb = [1.0; DOF];
        physics.friction.breakaway = 0.5;
        physics.friction.asymmetry = [0.0; DOF];
        let mut deflections = JointVector::zeros();
        let friction = JointFriction::new(&physics.friction, &physics.arm);
        let (mut position, mut velocity, mut braked) = (0.0, 0.0, 0.0);
        for period in 0..periods {
            let torque = torque * (period as f64 * PERIOD).min(1.0);
            braked = friction.step(&mut deflections, &JointVector::repeat(velocity))[0];
            velocity += (torque + braked) / physics.arm.armature[0] * PERIOD;
            position += velocity * PERIOD;
        }
        (position, velocity, braked)
    }

    /// Under a torque below the static friction a joint gives a little and stays. Above it, the joint moves,
    /// and only dry friction brakes it.
    #[test]
    fn a_joint_breaks_away_at_its_friction_at_rest() {
        let (position, velocity, _) = pushed(1.4, 3000);
        assert!(position < 1e-3 && velocity.abs() < 1e-6, "{position} {velocity}");
        let (_, velocity, braked) = pushed(1.6, 3000);
        assert!(velocity > 1.0, "{velocity}");
        assert!((braked + 1.0).abs() < 0.01, "{braked}");
    }
}
