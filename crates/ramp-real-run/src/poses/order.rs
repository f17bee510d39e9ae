//! The order of the numbers of a quaternion in a log.

use nalgebra::Quaternion;

/// Which numbers of a quaternion the fields `w`, `x`, `y`, `z` of a rotation hold.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum QuaternionOrder {
    /// Each field holds the number of its name.
    #[default]
    Wxyz,
    /// They hold x, y, z, w: the source wrote x first, and its writer took it for w.
    Xyzw,
    /// They hold z, w, x, y: the source wrote w first, and its writer took it for x.
    Zwxy,
}

impl QuaternionOrder {
    /// All of them, the usual one first.
    pub const ALL: [QuaternionOrder; 3] =
        [QuaternionOrder::Wxyz, QuaternionOrder::Xyzw, QuaternionOrder::Zwxy];

    /// The name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            QuaternionOrder::Wxyz => "wxyz",
            QuaternionOrder::Xyzw => "xyzw",
            QuaternionOrder::Zwxy => "zwxy",
        }
    }

    /// The quaternion that the fields `w`, `x`, `y`, `z` hold in this order.
    pub(super) fn quaternion(self, [w, x, y, z]: [f64; 4]) -> Quaternion<f64> {
        match self {
            QuaternionOrder::Wxyz => Quaternion::new(w, x, y, z),
            QuaternionOrder::Xyzw => Quaternion::new(z, w, x, y),
            QuaternionOrder::Zwxy => Quaternion::new(x, y, z, w),
        }
    }
}
