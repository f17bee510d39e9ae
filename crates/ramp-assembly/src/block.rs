//! Upright boxes, and their collisions along a straight sweep.
//!
//! Every part consists of a few boxes ([`ramp_kit::shape`]), rotated about Z only. The intervals of
//! the sweep on which two boxes overlap follow in closed form from the separating axis test, so no
//! collision can be missed between two steps.

use nalgebra::{Point3, Translation3, UnitQuaternion, Vector2, Vector3};
use ramp_kit::Pose;
use ramp_kit::shape::Shape;

/// Parts with a penetration below this touch, m.
pub const TOUCH: f64 = 0.01e-3;
/// Shortest straight motion of an insertion, m: this far out a beam can be lowered beside its goal
/// pose.
pub const LEAST_DISTANCE: f64 = 60.0e-3;
/// Longest straight motion that is considered, m.
pub const MOST_DISTANCE: f64 = 1.0;
/// Clearance around a beam, seen from above, where its straight motion begins, m: there it can be
/// lowered.
pub const MARGIN: f64 = 5.0e-3;

/// Number of separating axes that decide whether two boxes overlap seen from above, for
/// [`Block::meets`].
pub const FROM_ABOVE: usize = 4;
/// Number of all separating axes, for [`Block::meets`].
pub const ALL_AXES: usize = 5;

/// An upright box: a rectangle in the plane, rotated by a yaw, between two heights.
#[derive(Clone, Copy, Debug)]
pub struct Block {
    /// Its centre, m in the assembly frame.
    pub centre: Vector3<f64>,
    /// Half its axis-aligned bounding box along X, Y and Z, m.
    pub extent: Vector3<f64>,
    /// The unit vectors along its edges in the plane.
    axes: [Vector2<f64>; 2],
    /// Half its edges, m.
    half: Vector3<f64>,
}

impl Block {
    /// A shape of a beam in its goal pose. The chamfer of a nose is filled, which makes the tests
    /// stricter.
    pub fn new(shape: &Shape, x_ab: &Pose) -> Block {
        let (cuboid, x_ab) = match shape {
            Shape::Turned { about, angle, piece } => {
                let turned = Pose::from_parts(
                    Translation3::new(*about, 0.0, 0.0),
                    UnitQuaternion::from_axis_angle(&Vector3::z_axis(), *angle),
                );
                (piece.bounds(), x_ab * turned)
            }
            plain => (plain.bounds(), *x_ab),
        };
        let centre = (x_ab * Point3::from(cuboid.centre())).coords;
        let along = x_ab.rotation * Vector3::x();
        // A rotation of a beam by 180° about its own axis maps its boxes onto boxes of the same
        // size.
        let x = Vector2::new(along.x, along.y).normalize();
        let half: Vector3<f64> = cuboid.half().into();
        let extent = Vector3::new(
            half.x * x.x.abs() + half.y * x.y.abs(),
            half.x * x.y.abs() + half.y * x.x.abs(),
            half.z,
        );
        Block { centre, extent, axes: [x, Vector2::new(-x.y, x.x)], half }
    }

    /// Half its extent along a unit vector of the plane.
    fn reach(&self, axis: &Vector2<f64>) -> f64 {
        self.half.x * self.axes[0].dot(axis).abs() + self.half.y * self.axes[1].dot(axis).abs()
    }

    /// Along one candidate separating axis: the signed distance of the centres, its change per
    /// metre of motion of `self` along `shift`, and the distance at which the boxes touch. The last
    /// axis is the vertical.
    fn axis_to(&self, other: &Block, shift: &Vector3<f64>, axis: usize) -> (f64, f64, f64) {
        let between = other.centre - self.centre;
        let axis = match axis {
            0 | 1 => &self.axes[axis],
            2 | 3 => &other.axes[axis - 2],
            _ => return (between.z, -shift.z, self.half.z + other.half.z),
        };
        (between.xy().dot(axis), -shift.xy().dot(axis), self.reach(axis) + other.reach(axis))
    }

    /// Penetration, m; negative when they are apart (then only a lower bound of the distance).
    pub fn depth(&self, other: &Block) -> f64 {
        (0..ALL_AXES)
            .map(|axis| self.axis_to(other, &Vector3::zeros(), axis))
            .map(|(between, _, touch)| touch - between.abs())
            .fold(f64::INFINITY, f64::min)
    }

    /// The range of t > 0 in which `self`, moved by t along `shift`, penetrates `other` deeper than
    /// `slack`. The first `axes` of the separating axes are used: [`ALL_AXES`] or [`FROM_ABOVE`].
    pub fn meets(&self, other: &Block, shift: &Vector3<f64>, slack: f64, axes: usize) -> Option<[f64; 2]> {
        let mut range = [0.0f64, MOST_DISTANCE];
        for (between, rate, touch) in (0..axes).map(|axis| self.axis_to(other, shift, axis)) {
            let reach = touch - slack;
            // |between + rate · t| < reach
            if rate.abs() < 1e-12 {
                if between.abs() >= reach {
                    return None;
                }
                continue;
            }
            let (a, b) = ((-reach - between) / rate, (reach - between) / rate);
            range = [range[0].max(a.min(b)), range[1].min(a.max(b))];
            if range[0] >= range[1] {
                return None;
            }
        }
        (range[0] < range[1]).then_some(range)
    }

    /// The distance between two blocks, m; 0 when they overlap.
    pub fn gap(&self, other: &Block) -> f64 {
        let corner_to = |from: &Block, to: &Block| {
            let signs = [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)];
            let distance = |(sx, sy): (f64, f64)| {
                let corner =
                    from.centre.xy() + from.axes[0] * (sx * from.half.x) + from.axes[1] * (sy * from.half.y)
                        - to.centre.xy();
                let outside = |axis: usize| (corner.dot(&to.axes[axis]).abs() - to.half[axis]).max(0.0);
                outside(0).hypot(outside(1))
            };
            signs.into_iter().map(distance).fold(f64::INFINITY, f64::min)
        };
        let apart = |axis: usize| {
            let (between, _, touch) = self.axis_to(other, &Vector3::zeros(), axis);
            between.abs() - touch
        };
        let plane = if (0..FROM_ABOVE).any(|axis| apart(axis) > 0.0) {
            corner_to(self, other).min(corner_to(other, self))
        } else {
            0.0
        };
        plane.hypot(apart(FROM_ABOVE).max(0.0))
    }
}

/// Sorted ranges, with touching ones merged: `[1, 3], [0, 2], [5, 6]` become `[0, 3], [5, 6]`.
pub fn merge(mut ranges: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    ranges.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let mut merged: Vec<[f64; 2]> = Vec::new();
    for range in ranges {
        match merged.last_mut() {
            Some(last) if range[0] <= last[1] => last[1] = last[1].max(range[1]),
            _ => merged.push(range),
        }
    }
    merged
}
