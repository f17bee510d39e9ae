//! A beam or a holder on the table: whether it is clear of another one, and whether the fingers have room
//! beside its links.

use nalgebra::Point3;
use ramp_kit::shape::{Cuboid, Shape, beam_shapes};
use ramp_kit::{Beam, Footprint, Holder, Pose};

/// Half of the extent of a finger along a beam, m: 20 mm, and room on both sides.
const FINGER_HALF: f64 = 12.0e-3;
/// Extent of a finger of the open hand across a beam, from the beam's axis, m: from 18 to 28 mm with the
/// fingers 38 mm apart, and room on both sides.
const FINGER_ACROSS: [f64; 2] = [16.0e-3, 30.0e-3];
/// Distance between the points of a link at which the fingers are tried, m.
const STEP: f64 = 4.0e-3;

/// A beam or a holder on the table.
pub struct Body {
    /// Its name.
    pub name: String,
    /// Its pose in the world.
    pub x: Pose,
    /// The point about which it is turned, in its frame, m.
    pub middle: Point3<f64>,
    /// Its boxes, in its frame.
    boxes: Vec<Cuboid>,
    /// Radius of a circle about its middle that holds it, m.
    radius: f64,
    /// The stretch of each link on which the hand may grip, m from the j1 hole.
    links: Vec<[f64; 2]>,
}

impl Body {
    /// A beam.
    pub fn beam(beam: &Beam, x_wb: Pose) -> Body {
        let middle = Point3::new(beam.span() / 2.0, 0.0, 0.0);
        let boxes = beam_shapes(beam).iter().map(Shape::bounds).collect();
        let mut body = Body::new(&beam.name, x_wb, middle, boxes);
        body.links = beam.links.iter().map(|link| link.grasp).collect();
        body
    }

    /// A holder.
    pub fn holder(holder: &Holder, x_wh: Pose) -> Body {
        Body::new(&holder.name, x_wh, Point3::origin(), Holder::blocks().to_vec())
    }

    /// A body of these boxes, in its frame, that is turned about `middle`.
    pub fn new(name: &str, x: Pose, middle: Point3<f64>, boxes: Vec<Cuboid>) -> Body {
        let reach = |it: &Cuboid| {
            let [x, y] = [0, 1].map(|axis| (it.centre()[axis] - middle[axis]).abs() + it.half()[axis]);
            x.hypot(y)
        };
        let radius = boxes.iter().map(reach).fold(0.0, f64::max);
        Body { name: name.to_string(), x, middle, boxes, radius, links: Vec::new() }
    }

    /// Which of its links, from j1 on, the hand can grip at some point, with no bodies around but these. A
    /// hand that closes on a beam is over everything else, so only its fingers need room.
    pub fn grippable(&self, others: &[&Body]) -> Vec<bool> {
        let near: Vec<&&Body> =
            others.iter().filter(|other| self.is_near(&self.x, other, FINGER_ACROSS[1])).collect();
        let free = |s: f64| {
            let [low, high] = FINGER_ACROSS;
            [[low, high], [-high, -low]].into_iter().all(|across| {
                let finger = Cuboid::new([s - FINGER_HALF, s + FINGER_HALF], across, [0.0, 0.0]);
                let finger = Footprint::new(&self.x, &finger);
                near.iter().all(|other| {
                    other.boxes.iter().all(|their| finger.is_clear(&Footprint::new(&other.x, their), 0.0))
                })
            })
        };
        let points = |[from, to]: [f64; 2]| {
            let room = (to - from - 2.0 * FINGER_HALF).max(0.0);
            let first = (from + to - room) / 2.0;
            (0..=(room / STEP) as usize).map(move |step| first + step as f64 * STEP)
        };
        self.links.iter().map(|link| points(*link).any(free)).collect()
    }

    /// Its rectangles on the table.
    pub fn footprints(&self) -> impl Iterator<Item = Footprint> {
        self.boxes.iter().map(|cuboid| Footprint::new(&self.x, cuboid))
    }

    /// Whether another body may be nearer than `clearance` (m) to this one at `x`: by the circles that hold
    /// them.
    fn is_near(&self, x: &Pose, other: &Body, clearance: f64) -> bool {
        let apart = (x * self.middle).xy() - (other.x * other.middle).xy();
        apart.norm() <= self.radius + other.radius + clearance
    }

    /// Whether this body, put at `x`, is at least `clearance` (m) from another one, seen from above.
    pub fn is_clear(&self, x: &Pose, other: &Body, clearance: f64) -> bool {
        if !self.is_near(x, other, clearance) {
            return true;
        }
        let own = self.boxes.iter().map(|cuboid| Footprint::new(x, cuboid));
        own.into_iter().all(|own| {
            other.boxes.iter().all(|their| own.is_clear(&Footprint::new(&other.x, their), clearance))
        })
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{Translation3, UnitQuaternion, Vector3};

    use super::*;

    fn body(x: f64, y: f64, yaw: f64) -> Body {
        let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), yaw);
        let box_ = Cuboid::new([-0.1, 0.1], [-0.02, 0.02], [0.0, 0.03]);
        let x = Pose::from_parts(Translation3::new(x, y, 0.0), turn);
        Body::new("test", x, Point3::origin(), vec![box_])
    }

    fn clear(one: &Body, other: &Body) -> bool {
        let clear = one.is_clear(&one.x, other, 0.005);
        assert_eq!(clear, other.is_clear(&other.x, one, 0.005));
        clear
    }

    #[test]
    fn the_gap_between_two_bodies_decides() {
        let first = body(0.0, 0.0, 0.0);
        assert!(clear(&first, &body(0.0, 0.0451, 0.0)));
        assert!(!clear(&first, &body(0.0, 0.0449, 0.0)));
        assert!(clear(&first, &body(0.2051, 0.0, 0.0)));
        assert!(!clear(&first, &body(0.0, 0.0, 0.0)));
        // Turned by 5°, its ends come nearer by 8.7 mm.
        assert!(!clear(&first, &body(0.0, 0.0500, 0.0873)));
        assert!(clear(&first, &body(0.0, 0.0550, 0.0873)));
    }
}
