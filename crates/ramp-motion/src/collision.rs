//! Collision checks of the arm and the part in its hand with each other and with obstacles.
//!
//! A [`Checker`] is built once for a motion and used at every sample of it. It lists the solids of the arm
//! and of the held part, each with a ball around it, and the boxes around the arm with their bounds along the
//! axes of the world. Most solids are ruled out by the bounds of all boxes together, most boxes by their own;
//! the rest is tested exactly. Then the hand, the held part and the links are tested against those links that
//! are far enough up the arm.

use nalgebra::{Point3, Translation3, UnitQuaternion, Vector3};
use parry3d_f64::math::{Pose as ParryPose, Rotation, Vector};
use parry3d_f64::query::intersection_test;
use parry3d_f64::shape::{Capsule, Cuboid, Shape};
use ramp_robot::arm::{ArmBox, ArmModel};

use crate::kinematics::{Frames, Kinematics};
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

/// Extra distance to obstacles, beyond the margin, that the arm keeps where it could take another path, m:
/// the poses of parts are uncertain.
const CLEAR: f64 = 5.0e-3;

/// Least number of joints between two bodies of the arm that may collide. Nearer ones are kept apart by the
/// joints' ranges, and their capsules, which are wider than the arm, overlap.
const JOINTS_BETWEEN: usize = 3;

/// Bounds along the axes of the world, m.
#[derive(Clone, Copy)]
struct Bounds {
    low: Vector3<f64>,
    high: Vector3<f64>,
}

impl Bounds {
    /// Bounds of nothing.
    const NONE: Bounds = Bounds {
        low: Vector3::new(f64::MAX, f64::MAX, f64::MAX),
        high: Vector3::new(f64::MIN, f64::MIN, f64::MIN),
    };

    fn with(&self, other: &Bounds) -> Bounds {
        Bounds { low: self.low.inf(&other.low), high: self.high.sup(&other.high) }
    }

    fn is_apart(&self, other: &Bounds) -> bool {
        (0..3).any(|axis| other.high[axis] < self.low[axis] || other.low[axis] > self.high[axis])
    }
}

/// The boxes around the arm, each enlarged by a margin.
struct Surroundings {
    bounds: Vec<Bounds>,
    boxes: Vec<(ParryPose, Cuboid)>,
    /// Bounds of all of them.
    whole: Bounds,
}

impl Surroundings {
    fn new(around: &[Obstacle], margin: f64) -> Surroundings {
        let boxes: Vec<(ParryPose, Cuboid)> = around
            .iter()
            .map(|obstacle| {
                let [x, y, z] = obstacle.half;
                (parry(&obstacle.x), Cuboid::new(Vector::new(x + margin, y + margin, z + margin)))
            })
            .collect();
        let bounds: Vec<Bounds> = boxes.iter().map(|(pose, shape)| bounds(shape, pose)).collect();
        let whole = bounds.iter().fold(Bounds::NONE, |whole, bounds| whole.with(bounds));
        Surroundings { bounds, boxes, whole }
    }
}

/// The body to which a solid is fixed.
#[derive(Clone, Copy)]
enum Body {
    Base,
    Link(usize),
    Hand,
}

impl Body {
    fn frame<'a, const N: usize>(&self, frames: &'a Frames<N>, world: &'a Pose) -> &'a Pose {
        match self {
            Body::Base => world,
            Body::Link(link) => &frames.links[*link],
            Body::Hand => &frames.hand,
        }
    }

    /// Number of joints that carry it, in an arm of `joints`.
    fn carried_by(&self, joints: usize) -> usize {
        match self {
            Body::Base => 0,
            Body::Link(link) => link + 1,
            Body::Hand => joints,
        }
    }

    /// May it come near to something around the arm? The base and the first link do not move there.
    fn reaches_out(&self) -> bool {
        !matches!(self, Body::Base | Body::Link(0))
    }
}

enum Form {
    Capsule(Capsule),
    Box(Cuboid),
}

/// A solid of the arm.
struct Solid {
    body: Body,
    form: Form,
    /// Its own pose in the body's frame.
    offset: ParryPose,
    /// Centre of a ball around it, in the body's frame.
    centre: Point3<f64>,
    /// Radius of that ball, m.
    radius: f64,
}

/// The object that the arm touches.
enum Touched {
    Table,
    /// A box around it, by number.
    Box(usize),
    /// Another body of its own.
    Itself,
}

/// Tells whether the arm, opened or closed and with or without a part, touches anything.
pub struct Checker {
    /// Solids of the base, the links, the hand, the fingers, and the held part.
    solids: Vec<Solid>,
    /// Those of them that may meet each other, by number.
    pairs: Vec<[usize; 2]>,
    around: Surroundings,
    /// The same with more room.
    widely: Surroundings,
    /// Names of the obstacles.
    names: Vec<String>,
}

fn parry(x: &Pose) -> ParryPose {
    let q = x.rotation.quaternion();
    let t = x.translation.vector;
    ParryPose::from_parts(Vector::new(t.x, t.y, t.z), Rotation::from_xyzw(q.i, q.j, q.k, q.w))
}

fn bounds(shape: &dyn Shape, pose: &ParryPose) -> Bounds {
    let aabb = shape.compute_aabb(pose);
    let vector = |v: Vector| Vector3::new(v.x, v.y, v.z);
    Bounds { low: vector(aabb.mins), high: vector(aabb.maxs) }
}

impl Solid {
    fn capsule(body: Body, capsule: &ramp_robot::arm::Capsule) -> Solid {
        let (a, b) = (Vector::from(capsule.from), Vector::from(capsule.to));
        let centre = (a + b) / 2.0;
        Solid {
            body,
            form: Form::Capsule(Capsule::new(a, b, capsule.radius)),
            offset: ParryPose::IDENTITY,
            centre: Point3::new(centre.x, centre.y, centre.z),
            radius: (b - a).length() / 2.0 + capsule.radius,
        }
    }

    /// A box on the hand: half its edges (m), and its centre's pose in the hand's frame.
    fn on_hand(half: [f64; 3], x: &Pose) -> Solid {
        let half = Vector::from(half);
        Solid {
            body: Body::Hand,
            form: Form::Box(Cuboid::new(half)),
            offset: parry(x),
            centre: Point3::from(x.translation.vector),
            radius: half.length(),
        }
    }

    fn shape(&self) -> &dyn Shape {
        match &self.form {
            Form::Capsule(capsule) => capsule,
            Form::Box(cuboid) => cuboid,
        }
    }

    /// Do the two touch, each at a pose of its body?
    fn meets(&self, frame: &Pose, other: &Solid, other_frame: &Pose) -> bool {
        let (pose, other_pose) = (parry(frame) * self.offset, parry(other_frame) * other.offset);
        intersection_test(&pose, self.shape(), &other_pose, other.shape())
            .is_ok_and(|result| result.intersecting)
    }

    /// The obstacle that it touches, at a pose of its body.
    fn touches(&self, frame: &Pose, around: &Surroundings) -> Option<Touched> {
        let centre = (frame * self.centre).coords;
        let ball = Bounds {
            low: centre.map(|value| value - self.radius),
            high: centre.map(|value| value + self.radius),
        };
        // The table: nothing may reach below it.
        if ball.low.z >= 0.0 && ball.is_apart(&around.whole) {
            return None;
        }
        let pose = parry(frame) * self.offset;
        let own = bounds(self.shape(), &pose);
        if own.low.z < 0.0 {
            return Some(Touched::Table);
        }
        let mut boxes = around.bounds.iter().zip(&around.boxes);
        let touched = boxes.position(|(bounds, (placed, shape))| {
            !own.is_apart(bounds)
                && !intersection_test(&pose, self.shape(), placed, shape)
                    .is_ok_and(|result| !result.intersecting)
        });
        touched.map(Touched::Box)
    }
}

/// Half the edges and the centre of a box.
fn half_and_centre(piece: &ArmBox) -> ([f64; 3], Vector3<f64>) {
    let (low, high) = (Vector3::from(piece.min), Vector3::from(piece.max));
    (((high - low) / 2.0).into(), (low + high) / 2.0)
}

/// The boxes of both fingers on the hand, opened to `width` (m).
fn fingers<const N: usize>(arm: &ArmModel<N>, width: f64) -> impl Iterator<Item = Solid> {
    [0.0, std::f64::consts::PI].into_iter().flat_map(move |turn| {
        let x_hf = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), turn)
            * Translation3::new(0.0, width / 2.0, 0.0);
        arm.finger.pads.iter().chain(&arm.finger.boxes).map(move |piece| {
            // Heights in the arm file count from the tip towards the hand.
            let (half, centre) = half_and_centre(piece);
            let centre = Translation3::new(centre.x, centre.y, arm.hand.tip - centre.z);
            Solid::on_hand(half, &(x_hf * centre))
        })
    })
}

/// The pairs of solids that may meet: enough joints are between them, and they are apart with the arm at
/// home.
fn may_meet<const N: usize>(arm: &ArmModel<N>, solids: &[Solid]) -> Vec<[usize; 2]> {
    let (frames, world) = (Kinematics::new(arm).frames(&arm.home.into()), Pose::identity());
    let mut pairs = Vec::new();
    for (first, one) in solids.iter().enumerate() {
        for (second, other) in solids.iter().enumerate().skip(first + 1) {
            let between = other.body.carried_by(N).saturating_sub(one.body.carried_by(N));
            let apart =
                || !one.meets(one.body.frame(&frames, &world), other, other.body.frame(&frames, &world));
            if between >= JOINTS_BETWEEN && apart() {
                pairs.push([first, second]);
            }
        }
    }
    pairs
}

impl Checker {
    /// A checker for `arm` with the gripper opened to `width` (m, both fingers together), carrying `held`
    /// (boxes in the tip's frame), among `around` (boxes in the world), keeping `margin` (m) from everything.
    /// The table is always there, at z = 0.
    pub fn new<const N: usize>(
        arm: &ArmModel<N>,
        width: f64,
        held: Vec<Obstacle>,
        around: &[Obstacle],
        margin: f64,
    ) -> Checker {
        let base = arm.base.capsules.iter().map(|capsule| Solid::capsule(Body::Base, capsule));
        let links = arm.joints.iter().enumerate().flat_map(|(index, joint)| {
            joint.link.capsules.iter().map(move |capsule| Solid::capsule(Body::Link(index), capsule))
        });
        let hand = arm.hand.boxes.iter().map(|piece| {
            let (half, centre) = half_and_centre(piece);
            Solid::on_hand(half, &Translation3::from(centre).into())
        });
        let x_ht = Translation3::new(0.0, 0.0, arm.hand.tip);
        let held = held.iter().map(|piece| Solid::on_hand(piece.half, &(x_ht * piece.x)));
        let solids: Vec<Solid> =
            base.chain(links).chain(hand).chain(fingers(arm, width)).chain(held).collect();
        let pairs = may_meet(arm, &solids);
        Checker {
            solids,
            pairs,
            around: Surroundings::new(around, margin),
            widely: Surroundings::new(around, margin + CLEAR),
            names: around.iter().map(|obstacle| obstacle.name.clone()).collect(),
        }
    }

    /// Is the arm clear of everything with its frames here?
    pub fn is_free<const N: usize>(&self, frames: &Frames<N>) -> bool {
        self.first(frames, &self.around).is_none()
    }

    /// Is it clear of everything by some millimetres more?
    pub fn is_clear<const N: usize>(&self, frames: &Frames<N>) -> bool {
        self.first(frames, &self.widely).is_none()
    }

    /// The object that the arm touches with these frames: the name of a part, `the table`, or `itself`.
    pub fn touched<const N: usize>(&self, frames: &Frames<N>) -> Option<&str> {
        let touched = self.first(frames, &self.around)?;
        Some(match touched {
            Touched::Table => "the table",
            Touched::Box(number) => &self.names[number],
            Touched::Itself => "itself",
        })
    }

    /// The object that the first colliding solid touches.
    fn first<const N: usize>(&self, frames: &Frames<N>, around: &Surroundings) -> Option<Touched> {
        let world = Pose::identity();
        let out = self.solids.iter().filter(|solid| solid.body.reaches_out());
        let touched = out.map(|solid| solid.touches(solid.body.frame(frames, &world), around));
        if let Some(touched) = touched.flatten().next() {
            return Some(touched);
        }
        let centre = |solid: &Solid| solid.body.frame(frames, &world) * solid.centre;
        let centres: Vec<Point3<f64>> = self.solids.iter().map(centre).collect();
        let meet = |&[one, other]: &[usize; 2]| {
            let apart = (centres[one] - centres[other]).norm_squared();
            let [one, other] = [&self.solids[one], &self.solids[other]];
            apart < (one.radius + other.radius).powi(2)
                && one.meets(one.body.frame(frames, &world), other, other.body.frame(frames, &world))
        };
        self.pairs.iter().any(meet).then_some(Touched::Itself)
    }
}
