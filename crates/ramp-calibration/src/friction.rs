//! Friction of the joints, from a recording of their velocities and the torques that moved them.
//!
//! A commanded torque beyond that of the arm's masses is taken, while the joint moves evenly, as
//! `coulomb · sign(v) + viscous · v + offset`. The offset is the error of the arm's own compensation of
//! gravity. It is the friction between command and motion: that which the arm's inner loop compensates is not
//! in it.

use ramp_motion::{Dynamics, Joints};
use ramp_robot::DOF;
use ramp_robot::arm::ArmModel;

use nalgebra::{Matrix3, Vector3};

use crate::error::CalibrationError;
use crate::jackknife::standard_error;
use crate::records::JointSample;
use crate::verdict::{Measure, Verdict};

/// Least velocity of a joint that moves, rad/s: twice that below which world `real` has stiction.
pub const MOVING: f64 = 0.1;
/// Largest acceleration of a joint that moves evenly, rad/s²: its drive's own inertia, which is not known,
/// then takes 0.04 N·m at most.
pub const EVEN: f64 = 0.2;
/// Fewest samples of a joint that moves evenly, for each direction.
pub const LEAST_SAMPLES: usize = 50;
/// Least ratio between a fast and a slow motion of a joint: one speed alone cannot tell dry from viscous
/// friction.
pub const LEAST_RATIO: f64 = 2.0;
/// Largest residual of a good estimate, N·m: 0.1 N·m at each joint moves the tip of an FR3 by 0.15 mm at the
/// baseline's stiffness, less than the play of a peg.
pub const RESIDUAL: f64 = 0.1;
/// Largest standard error of the dry friction, N·m: a quarter of what Franka tells of each joint.
pub const ERROR: f64 = 0.05;
/// Half of the time over which velocities are differentiated, s.
const WINDOW: f64 = 0.05;
/// Most samples from which an acceleration is computed: those of 1 kHz.
const MOST_NEAR: usize = 100;
/// Pieces of a recording that are left out one after another.
const PIECES: usize = 10;

/// The friction of one joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointFriction {
    /// Dry friction, N·m.
    pub coulomb: f64,
    /// Friction that grows with the velocity, N·m·s/rad.
    pub viscous: f64,
    /// Torque that is left in both directions alike, N·m.
    pub offset: f64,
    /// Root of the mean of the squares of the residuals, N·m.
    pub residual: f64,
    /// Standard errors of dry and viscous friction, N·m and N·m·s/rad.
    pub errors: [f64; 2],
    /// Number of samples.
    pub samples: usize,
}

/// The friction of all joints.
#[derive(Clone, Debug, PartialEq)]
pub struct Friction {
    /// From the base to the hand.
    pub joints: [JointFriction; DOF],
}

impl Friction {
    /// Is it good enough?
    pub fn verdict(&self) -> Verdict {
        let worst = |of: fn(&JointFriction) -> f64| self.joints.iter().map(of).fold(0.0, f64::max);
        let measure = |name, value, limit| Measure { name, value, limit, unit: "N·m" };
        Verdict {
            measures: vec![
                measure("residual of the worst joint", worst(|it| it.residual), RESIDUAL),
                measure("standard error of its dry friction", worst(|it| it.errors[0]), ERROR),
                // Friction brakes.
                measure("dry friction that drives a joint", worst(|it| -it.coulomb), 0.0),
            ],
        }
    }
}

/// Fits the friction of each joint of `arm` to a recording.
///
/// # Errors
/// A joint with too few samples in a direction, or with one speed only.
pub fn calibrate(arm: &ArmModel, samples: &[JointSample]) -> Result<Friction, CalibrationError> {
    let left = left_over(arm, samples);
    let mut joints = Vec::new();
    for joint in 0..DOF {
        let even: Vec<[f64; 2]> = left
            .iter()
            .filter(|it| it.velocities[joint].abs() >= MOVING && it.accelerations[joint].abs() <= EVEN)
            .map(|it| [it.velocities[joint], it.torques[joint]])
            .collect();
        joints.push(of_joint(joint, &even)?);
    }
    let joints = std::array::from_fn(|joint| joints[joint]);
    Ok(Friction { joints })
}

/// A moment with what is left of the torques.
struct Left {
    velocities: Joints,
    accelerations: Joints,
    torques: Joints,
}

fn left_over(arm: &ArmModel, samples: &[JointSample]) -> Vec<Left> {
    let dynamics = Dynamics::new(arm);
    let (mut before, mut after) = (0, 0);
    let mut left = Vec::new();
    for sample in samples {
        while samples[before].time < sample.time - WINDOW {
            before += 1;
        }
        while after + 1 < samples.len() && samples[after + 1].time <= sample.time + WINDOW {
            after += 1;
        }
        // At the ends, and where samples are missing, there is no acceleration.
        let near = &samples[before..=after];
        if near[near.len() - 1].time - near[0].time < 1.5 * WINDOW {
            continue;
        }
        let accelerations = slope(near);
        let velocities = Joints::from(sample.velocities);
        let moving = dynamics.at(&Joints::from(sample.positions)).moving(&velocities, &accelerations);
        left.push(Left { velocities, accelerations, torques: Joints::from(sample.torques) - moving });
    }
    left
}

/// The accelerations of the joints, rad/s²: the slopes of the straight lines through their velocities.
fn slope(samples: &[JointSample]) -> Joints {
    let samples: Vec<&JointSample> = samples.iter().step_by(samples.len() / MOST_NEAR + 1).collect();
    let middle = samples.iter().map(|it| it.time).sum::<f64>() / samples.len() as f64;
    let (mut products, mut squares) = (Joints::zeros(), 0.0);
    for sample in samples {
        let time = sample.time - middle;
        products += Joints::from(sample.velocities) * time;
        squares += time * time;
    }
    products / squares
}

/// Fits one joint to its velocities (rad/s) and torques (N·m).
fn of_joint(joint: usize, even: &[[f64; 2]]) -> Result<JointFriction, CalibrationError> {
    let help = "move each joint back and forth at two or more even speeds above 0.1 rad/s, several times";
    for (direction, sign) in [("forwards", 1.0), ("backwards", -1.0)] {
        let found = even.iter().filter(|[velocity, _]| velocity * sign > 0.0).count();
        if found < LEAST_SAMPLES {
            let why = format!(
                "joint {} moves evenly {direction} in {found} samples, expected at least {LEAST_SAMPLES}",
                joint + 1
            );
            return Err(CalibrationError::Degenerate { why, help });
        }
    }
    let mut speeds: Vec<f64> = even.iter().map(|[velocity, _]| velocity.abs()).collect();
    speeds.sort_by(f64::total_cmp);
    let (slow, fast) = (speeds[speeds.len() / 10], speeds[speeds.len() * 9 / 10]);
    let one_speed = || {
        let why = format!(
            "joint {} moves at {slow:.2} to {fast:.2} rad/s, expected a fast motion of {LEAST_RATIO} times the speed of a slow one",
            joint + 1
        );
        CalibrationError::Degenerate { why, help }
    };
    if fast < LEAST_RATIO * slow {
        return Err(one_speed());
    }
    let found = fit(even.iter()).ok_or_else(one_speed)?;
    let squares: f64 = even.iter().map(|it| rest(it, &found).powi(2)).sum();
    let mut differences = [Vec::new(), Vec::new()];
    for piece in 0..PIECES {
        let is_kept = |index: usize| index * PIECES / even.len() != piece;
        let kept = even.iter().enumerate().filter(|(index, _)| is_kept(*index)).map(|(_, it)| it);
        let other = fit(kept).ok_or_else(one_speed)?;
        for (axis, differences) in differences.iter_mut().enumerate() {
            differences.push((other[axis] - found[axis]).powi(2));
        }
    }
    Ok(JointFriction {
        coulomb: found[0],
        viscous: found[1],
        offset: found[2],
        residual: (squares / even.len() as f64).sqrt(),
        errors: differences.map(|it| standard_error(&it)),
        samples: even.len(),
    })
}

fn row([velocity, _]: &[f64; 2]) -> Vector3<f64> {
    Vector3::new(velocity.signum(), *velocity, 1.0)
}

fn rest(sample: &[f64; 2], found: &Vector3<f64>) -> f64 {
    sample[1] - row(sample).dot(found)
}

/// Least squares: dry friction, viscous friction, offset.
fn fit<'a>(samples: impl Iterator<Item = &'a [f64; 2]>) -> Option<Vector3<f64>> {
    let (mut matrix, mut vector) = (Matrix3::zeros(), Vector3::zeros());
    for sample in samples {
        let row = row(sample);
        matrix += row * row.transpose();
        vector += row * sample[1];
    }
    Some(matrix.cholesky()?.solve(&vector))
}
