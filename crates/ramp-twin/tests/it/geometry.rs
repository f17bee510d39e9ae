//! The twin's collision geometry is that of the printed parts: random points are drawn around every part, and
//! the twin's geoms and the kit's solids must agree on which are inside, up to 0.1 mm at their surfaces.
//! Cavities, holes and rounded edges are among them, so no clearance is smaller or larger than it is in
//! plastic. Each is asked for what can get there: holes for stems, rounded heads for fingers.

use std::path::Path;

use mujoco_rs::prelude::*;
use mujoco_rs::wrappers::mj_model::MjtObjBase;
use nalgebra::{Isometry3, Point3, Quaternion, Translation3, UnitQuaternion};
use ramp_assembly::Task;
use ramp_kit::Kit;
use ramp_kit::joint::{
    BODY_WIDTH, HEAD_HEIGHT, HEAD_ROUNDING, HEAD_WIDTH, HOLE_RADIUS, MALE_CHAMFER, STEM_CONE, STEM_LENGTH,
    STEM_RADIUS, STEM_TIP_RADIUS,
};
use ramp_kit::shape::{Cuboid, Shape, beam_shapes};
use ramp_robot::Track;
use ramp_robot::arm::ArmModel;
use ramp_robot::random::Stream;
use ramp_twin::{Setup, Start, Twin};

/// Largest gap between the twin's collision geometry and the printed part, m.
const GAP: f64 = 0.1e-3;
/// Points thrown at each part.
const POINTS: usize = 60_000;

/// Signed distance of a point from a box, m: negative inside (an approximation outside of corners is enough
/// here).
fn from_box(p: &Point3<f64>, cuboid: &Cuboid) -> f64 {
    (0..3).map(|axis| (cuboid.min[axis] - p[axis]).max(p[axis] - cuboid.max[axis])).fold(f64::MIN, f64::max)
}

/// Signed distance of a point from a printed beam, m, as nearly as its flats and holes give it. Without
/// `holes`, as something meets it that is too large for them.
fn from_beam(p: &Point3<f64>, shapes: &[Shape], holes: bool) -> f64 {
    let one = |shape: &Shape| match shape {
        Shape::Solid(cuboid) | Shape::Foot(cuboid) => from_box(p, cuboid),
        Shape::Plate { cuboid, .. } if !holes => from_box(p, cuboid),
        Shape::Plate { cuboid, hole } => {
            let outside_hole = HOLE_RADIUS - (p.x - hole[0]).hypot(p.y - hole[1]);
            from_box(p, cuboid).max(outside_hole)
        }
        Shape::Nose { x0, x1 } => {
            let w = BODY_WIDTH / 2.0;
            let along = (p.x - x0) * (x1 - x0).signum();
            let slanted = (p.y.abs().max(p.z.abs()) + along - w) / 2.0_f64.sqrt();
            slanted.max(-along).max(along - MALE_CHAMFER).max(p.y.abs() - w).max(p.z.abs() - w)
        }
        Shape::Turned { .. } => f64::MAX,
    };
    shapes.iter().map(one).fold(f64::MAX, f64::min)
}

/// Signed distance of a point from a printed peg, m, whose head is rounded with the radius `r`, m.
fn from_peg(p: &Point3<f64>, r: f64) -> f64 {
    let half = [HEAD_WIDTH / 2.0 - r, HEAD_WIDTH / 2.0 - r, HEAD_HEIGHT / 2.0 - r];
    let q: [f64; 3] = [p.x.abs() - half[0], p.y.abs() - half[1], (p.z - HEAD_HEIGHT / 2.0).abs() - half[2]];
    let outside = q.iter().map(|value| value.max(0.0).powi(2)).sum::<f64>().sqrt();
    let head = outside + q.iter().copied().fold(f64::MIN, f64::max).min(0.0) - r;
    let radial = p.x.hypot(p.y);
    let cone_begin = -(STEM_LENGTH - STEM_CONE);
    let taper = STEM_RADIUS - (STEM_RADIUS - STEM_TIP_RADIUS) * ((cone_begin - p.z) / STEM_CONE).max(0.0);
    let stem = (radial - taper).max(-STEM_LENGTH - p.z).max(p.z - 1e-3);
    head.min(stem)
}

/// A collision geom in its part's frame.
enum Geom {
    Box(Isometry3<f64>, Cuboid),
    Capsule(Isometry3<f64>, f64, f64),
}

/// The geoms of a part that one of `who` can touch, meshes aside: `who` are the kinds of a geom, and
/// those that it meets.
fn geoms(model: &MjModel, part: &str, who: [i32; 2]) -> Vec<Geom> {
    let mut list = Vec::new();
    for id in 0..model.geom_bodyid().len() {
        let body = model.geom_bodyid()[id] as usize;
        let name = model.id_to_name(MjtObjBase::mjOBJ_BODY, body).unwrap_or("");
        let own = name == part || name.split_once('/').is_some_and(|(whole, _)| whole == part);
        if !own || model.geom_contype()[id] & who[1] == 0 && model.geom_conaffinity()[id] & who[0] == 0 {
            continue;
        }
        // Pieces are not turned in their part.
        let at = if name == part { [0.0; 3] } else { model.body_pos()[body] };
        let p: [f64; 3] = std::array::from_fn(|axis| model.geom_pos()[id][axis] + at[axis]);
        let q = model.geom_quat()[id];
        let x = Isometry3::from_parts(
            Translation3::new(p[0], p[1], p[2]),
            UnitQuaternion::from_quaternion(Quaternion::new(q[0], q[1], q[2], q[3])),
        );
        let s = model.geom_size()[id];
        let kind = model.geom_type()[id] as i32;
        if kind == MjtGeom::mjGEOM_BOX as i32 {
            list.push(Geom::Box(x, Cuboid { min: [-s[0], -s[1], -s[2]], max: [s[0], s[1], s[2]] }));
        } else if kind == MjtGeom::mjGEOM_CAPSULE as i32 {
            list.push(Geom::Capsule(x, s[0], s[1]));
        }
    }
    list
}

fn from_geoms(p: &Point3<f64>, geoms: &[Geom]) -> f64 {
    let one = |geom: &Geom| match geom {
        Geom::Box(x, cuboid) => from_box(&x.inverse_transform_point(p), cuboid),
        Geom::Capsule(x, radius, half) => {
            let q = x.inverse_transform_point(p);
            let along = q.z - q.z.clamp(-half, *half);
            (q.x * q.x + q.y * q.y + along * along).sqrt() - radius
        }
    };
    geoms.iter().map(one).fold(f64::MAX, f64::min)
}

fn world() -> (Kit, Twin) {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data");
    let kit = ramp_kit::read_kit(&data.join("kit.xml")).unwrap();
    let assembly = ramp_assembly::read_goal(&data.join("goals/easy-3.xml"), &kit).unwrap();
    let arm = ArmModel::read(&data.join("arms/panda.json")).unwrap();
    let setup = Setup {
        assembly: &assembly,
        arm: &arm,
        track: Track::State,
        seed: 1,
        start: Start::sheet(),
        world: ramp_twin::World::ideal(),
        state: None,
        task: Task::Build,
        fault: None,
    };
    let twin = Twin::new(&setup).unwrap();
    (kit, twin)
}

/// Throws points into `around`; a point that is clearly inside the one must not be clearly outside the other.
fn agree(
    name: &str,
    around: &Cuboid,
    printed: impl Fn(&Point3<f64>) -> f64,
    collided: impl Fn(&Point3<f64>) -> f64,
) {
    let mut stream = Stream::new(1, name);
    let mut inside = 0;
    for _ in 0..POINTS {
        let p = Point3::from(std::array::from_fn::<f64, 3, _>(|axis| {
            around.min[axis] + (around.max[axis] - around.min[axis]) * stream.uniform()
        }));
        let (a, b) = (printed(&p), collided(&p));
        inside += usize::from(a < 0.0);
        assert!(
            !(a < -GAP && b > 1e-9),
            "{name}: plastic at {p:?} ({:.3} mm deep) does not collide",
            -a * 1e3
        );
        assert!(
            !(b < -GAP && a > 1e-9),
            "{name}: at {p:?} there is no plastic ({:.3} mm), but it collides",
            a * 1e3
        );
    }
    assert!(inside > POINTS / 20, "{name}: hardly any point was inside");
}

/// Kinds and met kinds of the first geom of a body that touches something.
fn masks(model: &MjModel, body: &str) -> [i32; 2] {
    let body = model.name_to_id(MjtObjBase::mjOBJ_BODY, body).unwrap();
    let own = |id: &usize| {
        let masks = model.geom_contype()[*id] | model.geom_conaffinity()[*id];
        model.geom_bodyid()[*id] as usize == body && masks != 0
    };
    let id = (0..model.geom_bodyid().len()).find(own).unwrap();
    [model.geom_contype()[id], model.geom_conaffinity()[id]]
}

#[test]
fn beams_collide_as_they_are_printed() {
    let (kit, twin) = world();
    let model = twin.model();
    let metal = kit.beams.iter().find(|beam| !beam.links.is_empty()).unwrap();
    for (who, holes) in [
        (masks(model, "p1/stem0"), true),
        (masks(model, &metal.name), false),
        (masks(model, "p1"), false),
        (masks(model, "finger1"), false),
    ] {
        for beam in &kit.beams {
            let geoms = geoms(model, &beam.name, who);
            let shapes = beam_shapes(beam);
            // The noses are convex hulls of the very corners used here; they are compared by their own
            // formula.
            let nose = |p: &Point3<f64>| {
                let noses: Vec<Shape> =
                    shapes.iter().filter(|shape| matches!(shape, Shape::Nose { .. })).copied().collect();
                if noses.is_empty() { f64::MAX } else { from_beam(p, &noses, holes) }
            };
            let around = Cuboid::new([-0.02, beam.span() + 0.02], [-0.018, 0.018], [-0.018, 0.018]);
            let printed = |p: &Point3<f64>| from_beam(p, &shapes, holes);
            agree(&beam.name, &around, printed, |p| from_geoms(p, &geoms).min(nose(p)));
        }
    }
}

#[test]
fn pegs_collide_as_they_are_printed() {
    let (kit, twin) = world();
    let model = twin.model();
    // A finger meets the rounded head, a plate the sharp one, which is outside of it.
    for (who, rounding) in [("finger1", HEAD_ROUNDING), (kit.holders[0].name.as_str(), 0.0)] {
        let peg = &kit.pegs[0].name;
        let geoms = geoms(model, peg, masks(model, who));
        // The cone, with the last 4 mm of the stem above it, is a hull of 24 corners on each of its circles:
        // at most 0.034 mm inside them.
        let hull = 4.0e-3 - (STEM_LENGTH - STEM_CONE);
        let cone = |p: &Point3<f64>| if p.z < hull { from_peg(p, rounding) } else { f64::MAX };
        let around = Cuboid::new([-0.016, 0.016], [-0.016, 0.016], [-0.035, 0.026]);
        agree(peg, &around, |p| from_peg(p, rounding), |p| from_geoms(p, &geoms).min(cone(p)));
    }
}
