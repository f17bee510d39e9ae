//! The elements of an assembly: placed beams, joints to be pinned, and the insertion of each beam.

use nalgebra::{Unit, Vector3};
use ramp_kit::{Beam, Pose};

/// A beam in its goal pose.
#[derive(Clone, Debug)]
pub struct PlacedBeam {
    /// The beam, from the kit.
    pub beam: Beam,
    /// Rotated by 180° about its own axis.
    pub flipped: bool,
    /// Its pose in the assembly frame, the flip included.
    pub x_ab: Pose,
}

/// A joint of a beam of the assembly.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct JointRef {
    /// Index into [`Assembly::beams`](crate::Assembly::beams).
    pub beam: usize,
    /// Index into that beam's joints.
    pub joint: usize,
}

/// Two joints to be pinned by one peg.
#[derive(Clone, Debug, PartialEq)]
pub struct Connection {
    /// Its name in the file, for example `C1`.
    pub name: String,
    /// The joint around the other.
    pub female: JointRef,
    /// The joint inside the other.
    pub male: JointRef,
}

/// One straight insertion.
#[derive(Clone, Debug, PartialEq)]
pub struct Insertion {
    /// Index into [`Assembly::beams`](crate::Assembly::beams).
    pub beam: usize,
    /// Direction of the motion in the assembly frame.
    pub direction: Unit<Vector3<f64>>,
    /// Length of the straight motion that ends at the goal pose, m; it is collision-free.
    pub distance: f64,
}

impl PlacedBeam {
    /// Whether it lies along X or Y.
    pub fn is_square(&self) -> bool {
        let along = self.x_ab.rotation * Vector3::x();
        along.x.abs() < 1e-6 || along.y.abs() < 1e-6
    }
}
