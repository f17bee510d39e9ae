//! Inverse dynamics: the torques that a motion asks of the joints, by the recursive algorithm of Newton and
//! Euler.
//!
//! Velocities and accelerations pass from the base outwards, forces and moments back. The hand, its closed
//! fingers and the held part count as part of the last link. Friction and the inertia of the motors are left
//! out: arm files do not have them.

use nalgebra::{Isometry3, Matrix3, Quaternion, SMatrix, Translation3, UnitQuaternion, Vector3};
use ramp_robot::arm::ArmModel;
use ramp_robot::{DOF, GRAVITY};

use crate::space::Joints;

/// A rigid body: a link, or the held part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Inertia {
    /// kg.
    pub mass: f64,
    /// Centre of mass, m.
    pub centre: Vector3<f64>,
    /// Inertia about the centre of mass, kg·m².
    pub moment: Matrix3<f64>,
}

impl Inertia {
    /// The hand of `arm` with its fingers closed, in the frame of the last joint.
    pub fn of_hand<const N: usize>(arm: &ArmModel<N>) -> Inertia {
        let [hand, left, right] = hand_and_fingers(arm);
        hand.with(&left).with(&right)
    }

    /// From the numbers of an arm file.
    fn of(mass: f64, centre: [f64; 3], inertia: [f64; 6]) -> Inertia {
        let [xx, yy, zz, xy, xz, yz] = inertia;
        let moment = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
        Inertia { mass, centre: Vector3::from(centre), moment }
    }

    /// The same body in another frame, in which its own frame stands at `x`.
    fn at(&self, x: &Isometry3<f64>) -> Inertia {
        self.turned(&x.rotation.to_rotation_matrix().into_inner(), &x.translation.vector)
    }

    /// The same body in another frame, in which its own frame is turned by `turn` and has its origin at
    /// `origin`.
    fn turned(&self, turn: &Matrix3<f64>, origin: &Vector3<f64>) -> Inertia {
        Inertia {
            mass: self.mass,
            centre: turn * self.centre + origin,
            moment: turn * self.moment * turn.transpose(),
        }
    }

    /// Both bodies as one; all in the same frame.
    fn with(&self, other: &Inertia) -> Inertia {
        let mass = self.mass + other.mass;
        let centre = (self.mass * self.centre + other.mass * other.centre) / mass;
        let about = |body: &Inertia| {
            let d = body.centre - centre;
            body.moment + body.mass * (Matrix3::identity() * d.norm_squared() - d * d.transpose())
        };
        Inertia { mass, centre, moment: about(self) + about(other) }
    }
}

/// The moving masses of an arm.
#[derive(Clone, Debug)]
pub struct Dynamics<const N: usize = DOF> {
    /// Rotation of each joint's frame at angle zero in the frame before, and its origin there, m.
    fixed: [(Matrix3<f64>, Vector3<f64>); N],
    links: [Inertia; N],
    /// The tip's frame in the frame of the last joint.
    x_nt: Isometry3<f64>,
}

/// The chain at joint positions.
pub struct Chain<'a, const N: usize = DOF> {
    dynamics: &'a Dynamics<N>,
    /// Rotation of each joint's frame in the frame before.
    turns: [Matrix3<f64>; N],
}

fn pose(position: [f64; 3], [w, x, y, z]: [f64; 4]) -> Isometry3<f64> {
    let rotation = UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z));
    Isometry3::from_parts(Translation3::from(position), rotation)
}

/// The hand and the closed fingers, in the frame of the last joint.
fn hand_and_fingers<const N: usize>(arm: &ArmModel<N>) -> [Inertia; 3] {
    let (hand, finger) = (&arm.hand, &arm.finger);
    let x_nh = pose(hand.position, hand.quat_wxyz);
    let finger_at = |turn: f64| {
        let x_hf = Translation3::new(0.0, 0.0, finger.origin)
            * UnitQuaternion::from_axis_angle(&Vector3::z_axis(), turn);
        Inertia::of(finger.mass, finger.centre, finger.inertia).at(&(x_nh * x_hf))
    };
    [
        Inertia::of(hand.mass, hand.centre, hand.inertia).at(&x_nh),
        finger_at(0.0),
        finger_at(std::f64::consts::PI),
    ]
}

impl<const N: usize> Dynamics<N> {
    /// The dynamics of `arm` with an empty hand.
    pub fn new(arm: &ArmModel<N>) -> Dynamics<N> {
        hand_and_fingers(arm).iter().fold(Dynamics::without_hand(arm), Dynamics::ending_in)
    }

    /// The dynamics of `arm` without hand and fingers.
    pub fn without_hand(arm: &ArmModel<N>) -> Dynamics<N> {
        let fixed = arm.joints.each_ref().map(|joint| {
            let x = pose(joint.position, joint.quat_wxyz);
            (x.rotation.to_rotation_matrix().into_inner(), x.translation.vector)
        });
        let links = arm
            .joints
            .each_ref()
            .map(|joint| Inertia::of(joint.link.mass, joint.link.centre, joint.link.inertia));
        let x_nh = pose(arm.hand.position, arm.hand.quat_wxyz);
        Dynamics { fixed, links, x_nt: x_nh * Translation3::new(0.0, 0.0, arm.hand.tip) }
    }

    /// The same with one more body fixed to the last link, given in the frame of the last joint.
    #[must_use]
    pub fn ending_in(mut self, body: &Inertia) -> Dynamics<N> {
        self.links[N - 1] = self.links[N - 1].with(body);
        self
    }

    /// The same with `load` in the hand, given in the tip's frame.
    #[must_use]
    pub fn carrying(self, load: &Inertia) -> Dynamics<N> {
        let load = load.at(&self.x_nt);
        self.ending_in(&load)
    }

    /// The chain at joint positions `q` (rad).
    pub fn at(&self, q: &Joints<N>) -> Chain<'_, N> {
        let turns = std::array::from_fn(|joint| {
            let (sin, cos) = q[joint].sin_cos();
            self.fixed[joint].0 * Matrix3::new(cos, -sin, 0.0, sin, cos, 0.0, 0.0, 0.0, 1.0)
        });
        Chain { dynamics: self, turns }
    }
}

/// Acceleration of a base that has the effect of gravity, m/s².
const RISE: Vector3<f64> = Vector3::new(0.0, 0.0, GRAVITY);

impl<const N: usize> Chain<'_, N> {
    /// The joints' torques, N·m, at these velocities (rad/s) and accelerations (rad/s²), against gravity.
    pub fn torques(&self, velocity: &Joints<N>, acceleration: &Joints<N>) -> Joints<N> {
        self.forces(velocity, acceleration, RISE)
    }

    /// Their part that holds the arm up, N·m.
    pub fn holding(&self) -> Joints<N> {
        self.forces(&Joints::zeros(), &Joints::zeros(), RISE)
    }

    /// The torques that hold the arm up against this gravity (m/s², in the frame of the base), N·m.
    pub fn holding_against(&self, gravity: &Vector3<f64>) -> Joints<N> {
        self.forces(&Joints::zeros(), &Joints::zeros(), -gravity)
    }

    /// Their part that moves the arm, N·m.
    pub fn moving(&self, velocity: &Joints<N>, acceleration: &Joints<N>) -> Joints<N> {
        self.forces(velocity, acceleration, Vector3::zeros())
    }

    /// The joint-space inertia, kg·m², without that of the motors: the algorithm of composite bodies.
    pub fn inertia(&self) -> SMatrix<f64, N, N> {
        let mut inertia = SMatrix::<f64, N, N>::zeros();
        let mut outwards: Option<Inertia> = None;
        for joint in (0..N).rev() {
            let link = &self.dynamics.links[joint];
            let body = outwards.map_or(*link, |outwards| link.with(&outwards));
            // The body turns about the joint's axis with a unit of acceleration.
            let mut force = Vector3::z().cross(&body.centre) * body.mass;
            let mut moment = body.moment * Vector3::z() + body.centre.cross(&force);
            inertia[(joint, joint)] = moment.z;
            for inner in (0..joint).rev() {
                let (turn, origin) = (&self.turns[inner + 1], &self.dynamics.fixed[inner + 1].1);
                force = turn * force;
                moment = turn * moment + origin.cross(&force);
                inertia[(inner, joint)] = moment.z;
                inertia[(joint, inner)] = moment.z;
            }
            outwards = Some(body.turned(&self.turns[joint], &self.dynamics.fixed[joint].1));
        }
        inertia
    }

    fn forces(&self, velocity: &Joints<N>, acceleration: &Joints<N>, mut rise: Vector3<f64>) -> Joints<N> {
        let axis = Vector3::z();
        let (mut spin, mut gain) = (Vector3::zeros(), Vector3::zeros());
        let mut forces = [(Vector3::zeros(), Vector3::zeros()); N];
        for joint in 0..N {
            let (turn, origin) = (&self.turns[joint], &self.dynamics.fixed[joint].1);
            rise = turn.tr_mul(&(rise + gain.cross(origin) + spin.cross(&spin.cross(origin))));
            let carried = turn.tr_mul(&spin);
            let rate = axis * velocity[joint];
            gain = turn.tr_mul(&gain) + axis * acceleration[joint] + carried.cross(&rate);
            spin = carried + rate;
            let link = &self.dynamics.links[joint];
            let centre = rise + gain.cross(&link.centre) + spin.cross(&spin.cross(&link.centre));
            let force = centre * link.mass;
            let moment = link.moment * gain + spin.cross(&(link.moment * spin)) + link.centre.cross(&force);
            forces[joint] = (force, moment);
        }
        let mut torques = Joints::zeros();
        let (mut force, mut moment) = (Vector3::zeros(), Vector3::zeros());
        for joint in (0..N).rev() {
            force += forces[joint].0;
            moment += forces[joint].1;
            torques[joint] = moment.z;
            let (turn, origin) = (&self.turns[joint], &self.dynamics.fixed[joint].1);
            force = turn * force;
            moment = turn * moment + origin.cross(&force);
        }
        torques
    }
}

#[cfg(test)]
mod tests {
    // A failed unwrap here is a failed test.
    #![allow(clippy::unwrap_used)]

    use super::*;
    use crate::Kinematics;
    use ramp_robot::random::Stream;
    use std::path::Path;

    /// A load in the hand needs the torques of the transposed Jacobian.
    #[test]
    fn a_load_weighs_on_the_joints_as_its_force_at_the_tip() {
        let arm: ArmModel = ArmModel::read(Path::new("../../data/arms/panda.json")).unwrap();
        let (kinematics, empty) = (Kinematics::new(&arm), Dynamics::new(&arm));
        let load = Inertia { mass: 2.0, centre: Vector3::zeros(), moment: Matrix3::zeros() };
        let loaded = empty.clone().carrying(&load);
        let mut stream = Stream::new(1, "load");
        for _ in 0..100 {
            let q = Joints::from(arm.home).map(|angle| angle + stream.symmetric(0.5));
            let frames = kinematics.frames(&q);
            let weight = kinematics.jacobian(&frames).row(2).transpose() * load.mass * GRAVITY;
            let more = loaded.at(&q).holding() - empty.at(&q).holding();
            assert!((more - weight).amax() < 1e-10, "{more} {weight}");
        }
    }

    /// The inertia's columns are the torques of unit accelerations.
    #[test]
    fn the_inertia_is_that_of_unit_accelerations() {
        let arm: ArmModel = ArmModel::read(Path::new("../../data/arms/fr3.json")).unwrap();
        let dynamics = Dynamics::new(&arm);
        let mut stream = Stream::new(3, "inertia");
        for _ in 0..100 {
            let q = Joints::from_fn(|_, _| stream.symmetric(1.5));
            let chain = dynamics.at(&q);
            let inertia = chain.inertia();
            for joint in 0..DOF {
                let mut acceleration = Joints::zeros();
                acceleration[joint] = 1.0;
                let torques = chain.moving(&Joints::zeros(), &acceleration);
                assert!((inertia.column(joint) - torques).amax() < 1e-12);
            }
        }
    }

    /// Power is the rate at which the energy changes: a torque that broke this would be none of this arm.
    #[test]
    fn torques_do_the_work_that_becomes_kinetic_energy() {
        let arm: ArmModel = ArmModel::read(Path::new("../../data/arms/panda.json")).unwrap();
        let dynamics = Dynamics::new(&arm);
        let mut stream = Stream::new(2, "work");
        let energy = |q: &Joints, v: &Joints| v.dot(&dynamics.at(q).moving(&Joints::zeros(), v)) / 2.0;
        for _ in 0..100 {
            let q = Joints::from_fn(|_, _| stream.symmetric(1.5));
            let v = Joints::from_fn(|_, _| stream.symmetric(2.0));
            let a = Joints::from_fn(|_, _| stream.symmetric(10.0));
            let h = 1e-5;
            let after = energy(&(q + v * h + a * (h * h / 2.0)), &(v + a * h));
            let before = energy(&(q - v * h + a * (h * h / 2.0)), &(v - a * h));
            let power = v.dot(&dynamics.at(&q).moving(&v, &a));
            assert!(((after - before) / (2.0 * h) - power).abs() < 1e-6 * power.abs().max(1.0));
        }
    }
}
