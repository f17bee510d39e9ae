//! Boxes that lie flat, seen from above.

use nalgebra::{Point2, Point3, Vector2, Vector3};

use crate::Pose;
use crate::shape::Cuboid;

/// A rectangle on the table, seen from above.
#[derive(Clone, Debug, PartialEq)]
pub struct Footprint {
    /// Its centre in the world, m.
    pub centre: Point2<f64>,
    /// Its two directions.
    axes: [Vector2<f64>; 2],
    /// Half of its edges along them, m.
    half: [f64; 2],
}

impl Footprint {
    /// Of a box of a body that lies flat: `x` is the pose of the body in the world.
    pub fn new(x: &Pose, cuboid: &Cuboid) -> Footprint {
        let [half_x, half_y, _] = cuboid.half();
        let axis = |axis: Vector3<f64>| (x.rotation * axis).xy();
        Footprint {
            centre: (x * Point3::from(cuboid.centre())).xy(),
            axes: [axis(Vector3::x()), axis(Vector3::y())],
            half: [half_x, half_y],
        }
    }

    /// A rectangle along the axes of the world, from its ranges of x and y, m.
    pub fn of_ranges(x: [f64; 2], y: [f64; 2]) -> Footprint {
        Footprint::new(&Pose::identity(), &Cuboid::new(x, y, [0.0, 0.0]))
    }

    /// Its corners in the world, m.
    pub fn corners(&self) -> [Point2<f64>; 4] {
        let [x, y] = [0, 1].map(|side| self.axes[side] * self.half[side]);
        [x + y, x - y, -x + y, -x - y].map(|corner| self.centre + corner)
    }

    /// Half of its width along a direction, m.
    fn half_width(&self, along: &Vector2<f64>) -> f64 {
        self.axes.iter().zip(self.half).map(|(axis, half)| axis.dot(along).abs() * half).sum()
    }

    /// Whether a line of the given width, m, fits between the two along an edge of one of them.
    pub fn is_clear(&self, other: &Footprint, clearance: f64) -> bool {
        let apart = self.centre - other.centre;
        self.axes
            .iter()
            .chain(&other.axes)
            .any(|axis| apart.dot(axis).abs() >= self.half_width(axis) + other.half_width(axis) + clearance)
    }
}
