//! What stands around the arm, what it carries, and whether they touch.

use nalgebra::Point3;
use parry3d_f64::math::{Pose as ParryPose, Rotation, Vector};
use parry3d_f64::query::intersection_test;
use parry3d_f64::shape::{Capsule, Cuboid, Shape};
use ramp_robot::arm::{ArmBox, ArmModel};

use crate::kinematics::Frames;
use crate::space::Pose;

/// A box somewhere in the world (or on the hand), named after the part it belongs to.
#[derive(Clone, Debug)]
pub struct Obstacle {
    /// The part's name, by which it can be left out.
    pub name: String,
    /// Pose of the box's centre: in the world, or in the tip's frame for a held part.
    pub x: Pose,
    /// Half its edges, m.
    pub half: [f64; 3],
}

/// How much further than its margin the arm keeps from everything where it could take another way, m: parts are not exactly
/// where they are believed to be.
const CLEAR: f64 = 5.0e-3;

struct Placed {
    name: String,
    pose: ParryPose,
    shape: Cuboid,
    low: Point3<f64>,
    high: Point3<f64>,
}

enum Solid {
    Capsule(Capsule),
    Box(ParryPose, Cuboid),
}

impl Solid {
    /// The shape and its own offset in the frame it is attached to.
    fn shape(&self) -> (&dyn Shape, ParryPose) {
        match self {
            Solid::Capsule(capsule) => (capsule, ParryPose::IDENTITY),
            Solid::Box(offset, cuboid) => (cuboid, *offset),
        }
    }

    /// A radius around the attached frame's origin that encloses it, m.
    fn reach(&self) -> f64 {
        match self {
            Solid::Capsule(capsule) => {
                capsule.segment.a.length().max(capsule.segment.b.length()) + capsule.radius
            }
            Solid::Box(offset, cuboid) => offset.translation.length() + cuboid.half_extents.length(),
        }
    }
}

/// Tells whether the arm, opened or closed and with or without a part, touches anything.
pub struct Checker {
    /// Solids of links 2 to 7 (the first cannot reach the table), by link.
    links: Vec<(usize, Solid)>,
    hand: Vec<Solid>,
    fingers: [Vec<Solid>; 2],
    held: Vec<Obstacle>,
    around: Vec<Placed>,
    /// The same with more room.
    widely: Vec<Placed>,
    tip: f64,
    width: f64,
}

fn parry(x: &Pose) -> ParryPose {
    let q = x.rotation.quaternion();
    let t = x.translation.vector;
    ParryPose::from_parts(Vector::new(t.x, t.y, t.z), Rotation::from_xyzw(q.i, q.j, q.k, q.w))
}

/// A finger's box in the frame of its finger, which has its origin and directions at the hand: heights in the arm
/// file count from the tip towards the hand.
fn finger_box(piece: &ArmBox, tip: f64) -> Solid {
    let [x0, y0, z0] = piece.min;
    let [x1, y1, z1] = piece.max;
    boxed(&ArmBox { min: [x0, y0, tip - z1], max: [x1, y1, tip - z0] })
}

fn boxed(piece: &ArmBox) -> Solid {
    let centre = Vector::new(
        (piece.min[0] + piece.max[0]) / 2.0,
        (piece.min[1] + piece.max[1]) / 2.0,
        (piece.min[2] + piece.max[2]) / 2.0,
    );
    let half = Vector::new(
        (piece.max[0] - piece.min[0]) / 2.0,
        (piece.max[1] - piece.min[1]) / 2.0,
        (piece.max[2] - piece.min[2]) / 2.0,
    );
    Solid::Box(ParryPose::from_parts(centre, Rotation::IDENTITY), Cuboid::new(half))
}

impl Checker {
    /// A checker for `arm` with the gripper opened to `width` (m, both fingers together), carrying `held` (boxes
    /// in the tip's frame), among `around` (boxes in the world), keeping `margin` (m) from everything. The table
    /// is always there, at z = 0.
    pub fn new(arm: &ArmModel, width: f64, held: Vec<Obstacle>, around: &[Obstacle], margin: f64) -> Checker {
        let mut links = Vec::new();
        for (index, joint) in arm.joints.iter().enumerate().skip(1) {
            for capsule in &joint.link.capsules {
                let (a, b) = (Vector::from(capsule.from), Vector::from(capsule.to));
                links.push((index, Solid::Capsule(Capsule::new(a, b, capsule.radius))));
            }
        }
        let finger = || {
            let pieces = arm.finger.pads.iter().chain(&arm.finger.boxes);
            pieces.map(|piece| finger_box(piece, arm.hand.tip)).collect::<Vec<_>>()
        };
        let placed = |margin: f64| {
            let place = move |obstacle: &Obstacle| {
                let [x, y, z] = obstacle.half;
                let shape = Cuboid::new(Vector::new(x + margin, y + margin, z + margin));
                let pose = parry(&obstacle.x);
                let bounds = shape.aabb(&pose);
                Placed {
                    name: obstacle.name.clone(),
                    pose,
                    shape,
                    low: Point3::new(bounds.mins.x, bounds.mins.y, bounds.mins.z),
                    high: Point3::new(bounds.maxs.x, bounds.maxs.y, bounds.maxs.z),
                }
            };
            around.iter().map(place).collect()
        };
        Checker {
            links,
            hand: arm.hand.boxes.iter().map(boxed).collect(),
            fingers: [finger(), finger()],
            held,
            around: placed(margin),
            widely: placed(margin + CLEAR),
            tip: arm.hand.tip,
            width,
        }
    }

    /// Is the arm clear of everything with its frames here?
    pub fn is_free(&self, frames: &Frames) -> bool {
        self.touched(frames).is_none()
    }

    /// Is it clear of everything by some millimetres more?
    pub fn is_clear(&self, frames: &Frames) -> bool {
        self.touched_of(frames, &self.widely).is_none()
    }

    /// What the arm touches with its frames here: the name of a part, or `the table`.
    pub fn touched(&self, frames: &Frames) -> Option<&str> {
        self.touched_of(frames, &self.around)
    }

    fn touched_of<'p>(&self, frames: &Frames, around: &'p [Placed]) -> Option<&'p str> {
        let mut links = self.links.iter();
        let links = links.find_map(|(link, solid)| touched_by(&frames.links[*link], solid, around));
        let hand = || self.hand.iter().find_map(|solid| touched_by(&frames.hand, solid, around));
        let mut fingers = self.fingers.iter().enumerate();
        let fingers = || {
            fingers.find_map(|(index, solids)| {
                let turn = if index == 0 { 0.0 } else { std::f64::consts::PI };
                let x = frames.hand
                    * nalgebra::UnitQuaternion::from_axis_angle(&nalgebra::Vector3::z_axis(), turn)
                    * nalgebra::Translation3::new(0.0, self.width / 2.0, 0.0);
                solids.iter().find_map(|solid| touched_by(&x, solid, around))
            })
        };
        let tip = frames.hand * nalgebra::Translation3::new(0.0, 0.0, self.tip);
        let held = || {
            self.held.iter().find_map(|piece| {
                let [x, y, z] = piece.half;
                let solid = Solid::Box(ParryPose::IDENTITY, Cuboid::new(Vector::new(x, y, z)));
                touched_by(&(tip * piece.x), &solid, around)
            })
        };
        links.or_else(hand).or_else(fingers).or_else(held)
    }
}

fn touched_by<'p>(frame: &Pose, solid: &Solid, around: &'p [Placed]) -> Option<&'p str> {
    let centre = frame.translation.vector;
    let reach = solid.reach();
    let (shape, offset) = solid.shape();
    let pose = parry(frame) * offset;
    // The table: nothing may reach below it.
    if centre.z < reach && shape.compute_aabb(&pose).mins.z < 0.0 {
        return Some("the table");
    }
    let touched = around.iter().find(|placed| {
        // A box around the obstacle and a ball around the solid rule most pairs out.
        let apart = (0..3)
            .any(|axis| centre[axis] + reach < placed.low[axis] || centre[axis] - reach > placed.high[axis]);
        !apart
            && !intersection_test(&pose, shape, &placed.pose, &placed.shape)
                .is_ok_and(|result| !result.intersecting)
    });
    touched.map(|placed| placed.name.as_str())
}
