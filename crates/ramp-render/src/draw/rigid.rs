//! Rigid poses in single precision.

use ramp_robot::Pose;

/// A rotation and a translation in single precision.
#[derive(Clone, Copy)]
pub(super) struct Rigid {
    pub(super) turn: [[f32; 3]; 3],
    pub(super) shift: [f32; 3],
}

impl Rigid {
    /// A pose.
    pub(super) fn new(x: &Pose) -> Rigid {
        let m = x.rotation.to_rotation_matrix();
        Rigid {
            turn: std::array::from_fn(|row| std::array::from_fn(|column| m[(row, column)] as f32)),
            shift: std::array::from_fn(|axis| x.translation.vector[axis] as f32),
        }
    }

    /// A direction.
    #[inline]
    pub(super) fn turned(&self, v: &[f32; 3]) -> [f32; 3] {
        std::array::from_fn(|row| {
            self.turn[row][0] * v[0] + self.turn[row][1] * v[1] + self.turn[row][2] * v[2]
        })
    }

    /// A point, m.
    #[inline]
    pub(super) fn moved(&self, p: &[f32; 3]) -> [f32; 3] {
        let turned = self.turned(p);
        std::array::from_fn(|axis| turned[axis] + self.shift[axis])
    }
}
