//! The solids against the measured parts, against themselves (a snapshot that guards upgrades of
//! the modeller), and against the twin's collision shapes.

use ramp_kit::joint::{
    BODY_WIDTH, FEMALE_HEIGHT, FORMS, HOLE_RADIUS, MALE_CHAMFER, STEM_CONE, STEM_LENGTH, STEM_RADIUS,
    STEM_TIP_RADIUS,
};
use ramp_kit::shape::{Cuboid, Piece, Shape, beam_shapes};
use ramp_kit::solid::{self, Solid};
use ramp_kit::{Beam, Dimensions, Joint, JointForm, JointType, Side, stl};

const D: Dimensions = Dimensions::BENCHMARK;

/// Name, volume (mm³), genus, corner with the smallest and with the largest coordinates (mm).
type Row = (&'static str, f64, i32, [f64; 3], [f64; 3]);

const SNAPSHOT: [Row; 12] = [
    ("in-m-end", 18905.71, 2, [-13.3, -55.650, 0.0], [13.3, 10.0, 26.6]),
    ("in-m-end-feet", 19021.21, 2, [-13.3, -55.650, -3.3], [13.3, 10.0, 26.6]),
    ("thru-m", 34431.52, 3, [-13.3, -37.6, 0.0], [13.3, 37.6, 26.6]),
    ("in-f-end", 18656.35, 3, [-13.3, -43.2, 0.0], [13.3, 13.6, 33.2]),
    ("in-f", 23939.66, 4, [-13.3, -37.6, 0.0], [13.3, 37.6, 33.2]),
    ("thru-f", 21720.14, 5, [-13.3, -37.6, 0.0], [13.3, 37.6, 33.2]),
    ("angle-f", 26635.82, 5, [-13.3, -53.0, 0.0], [13.3, 53.0, 33.2]),
    ("peg", 21672.12, 0, [-14.5, -14.5, -33.2], [14.5, 14.5, 24.0]),
    ("holder", 44027.55, 6, [-51.5, -20.0, 0.0], [51.5, 20.0, 37.2]),
    ("fingertip", 10282.47, 1, [-10.0, -1.5, -19.0], [10.0, 19.0, 21.0]),
    ("clamp", 24893.46, 6, [-40.0, -15.0, 0.0], [40.0, 15.0, 26.850]),
    ("extrusion-70", 12881.50, 1, [-10.0, -10.0, 0.0], [10.0, 10.0, 70.0]),
];

/// The published joints, peg and holder, mm³, as measured.
const MEASURED: [(&str, f64); 9] = [
    ("in-m-end", 18906.3),
    ("in-m-end-feet", 19021.8),
    // Measured 34677.6 with one socket of 20.3 instead of 20.6; both of ours are 20.6.
    ("thru-m", 34677.6 - (20.6 * 20.6 - 20.3 * 20.3) * 20.0),
    ("in-f-end", 18656.5),
    ("in-f", 23939.9),
    ("thru-f", 21720.4),
    ("angle-f", 26636.0),
    ("peg", 21660.2),
    ("holder", 44005.4),
];

fn parts() -> Vec<(&'static str, Solid)> {
    let mut parts: Vec<(&'static str, Solid)> =
        JointType::ALL.into_iter().map(|kind| (kind.name(), solid::joint(kind, &D).unwrap())).collect();
    parts.push(("peg", solid::peg(&D).unwrap()));
    parts.push(("holder", solid::holder(&D).unwrap()));
    parts.push(("fingertip", solid::fingertip().unwrap()));
    parts.push(("clamp", solid::clamp(&D).unwrap()));
    parts.push(("extrusion-70", solid::extrusion(70.0).unwrap()));
    parts
}

#[test]
fn snapshot() {
    let parts = parts();
    assert_eq!(parts.len(), SNAPSHOT.len());
    for ((name, solid), (expected, volume, genus, low, high)) in parts.iter().zip(SNAPSHOT) {
        assert_eq!(*name, expected);
        assert!((solid.volume() - volume).abs() < 0.01, "{name}: {}", solid.volume());
        assert_eq!(solid.genus(), genus, "{name}");
        for (found, expected) in solid.mesh().bounds().iter().zip([low, high]) {
            for axis in 0..3 {
                assert!((found[axis] - expected[axis]).abs() < 1e-3, "{name}: {found:?}");
            }
        }
    }
}

#[test]
fn volumes_are_as_measured() {
    let parts = parts();
    for (name, measured) in MEASURED {
        let (_, solid) = parts.iter().find(|(part, _)| *part == name).unwrap();
        let off = solid.volume() / measured - 1.0;
        assert!(off.abs() < 1e-3, "{name}: {:.1}, {:+.3} %", solid.volume(), off * 100.0);
    }
    // The source of the masses agrees with the printed parts.
    for kind in JointType::ALL {
        let (_, solid) = parts.iter().find(|(part, _)| *part == kind.name()).unwrap();
        let off = kind.form().volume() * 1e9 / solid.volume() - 1.0;
        assert!(off.abs() < 3e-4, "{}: {:+.4} %", kind.name(), off * 100.0);
    }
    // 184.1 mm² of aluminium.
    let (_, extrusion) = parts.iter().find(|(part, _)| *part == "extrusion-70").unwrap();
    assert!((extrusion.volume() / 70.0 - 184.1).abs() < 0.1);
}

#[test]
fn the_stl_read_back_is_closed_and_the_right_way_out() {
    for (name, solid) in parts() {
        let bytes = stl::write(&solid.mesh(), name);
        assert_eq!(bytes, stl::write(&solid.mesh(), name));
        assert!(!bytes.starts_with(b"solid"));
        let mesh = stl::read(&bytes).unwrap();
        assert!(mesh.is_closed(), "{name}");
        assert!((mesh.volume() / solid.volume() - 1.0).abs() < 1e-6, "{name}: {}", mesh.volume());
        // Every normal points to where its triangle's corners go round anticlockwise.
        for record in bytes[84..].chunks_exact(50) {
            let number = |at: usize| f64::from(f32::from_le_bytes(record[at..at + 4].try_into().unwrap()));
            let vector = |at: usize| nalgebra::Vector3::new(number(at), number(at + 4), number(at + 8));
            let (a, b, c) = (vector(12), vector(24), vector(36));
            let normal = (b - a).cross(&(c - a));
            // Slivers between two corners of a circle may round to a line.
            assert!(normal.norm() < 1e-6 || normal.normalize().dot(&vector(0)) > 0.999, "{name}");
        }
        assert!(stl::read(&bytes[..bytes.len() - 1]).is_err());
    }
    assert!(stl::read(b"solid nothing").is_err());
}

/// Boxes that touch leave no gap between them, m.
const SEAM: f64 = 1e-9;

/// Whether the point (m, in the beam's frame) is inside one of the twin's collision shapes.
fn collides(shapes: &[Shape], p: [f64; 3]) -> bool {
    let within = |c: &Cuboid, p: [f64; 3]| {
        (0..3).all(|axis| c.min[axis] - SEAM < p[axis] && p[axis] < c.max[axis] + SEAM)
    };
    let clear_of_hole = |x: f64, y: f64| x.hypot(y) > HOLE_RADIUS;
    let nose = |x0: f64, x1: f64, p: [f64; 3]| {
        let depth = (p[0] - x0) / (x1 - x0);
        let half = BODY_WIDTH / 2.0 - depth * MALE_CHAMFER;
        (0.0..1.0).contains(&depth) && p[1].abs() < half && p[2].abs() < half
    };
    shapes.iter().any(|shape| match *shape {
        Shape::Solid(c) | Shape::Foot(c) => within(&c, p),
        Shape::Plate { cuboid, hole } => within(&cuboid, p) && clear_of_hole(p[0] - hole[0], p[1] - hole[1]),
        Shape::Nose { x0, x1 } => nose(x0, x1, p),
        Shape::Turned { about, angle, piece } => {
            let (sin, cos) = angle.sin_cos();
            let (x, y) = (p[0] - about, p[1]);
            let q = [x * cos + y * sin, y * cos - x * sin, p[2]];
            match piece {
                Piece::Solid(c) => within(&c, q),
                Piece::Plate(c) => within(&c, q) && clear_of_hole(q[0], q[1]),
                Piece::Nose { x0, x1 } => nose(x0, x1, q),
            }
        }
    })
}

/// Points on the surface of a solid with the outward directions, mm: several on every triangle.
fn surface(solid: &Solid) -> Vec<[nalgebra::Vector3<f64>; 2]> {
    let mesh = solid.mesh();
    let mut points = Vec::new();
    for triangle in &mesh.triangles {
        let [a, b, c] = triangle.map(|index| nalgebra::Vector3::from(mesh.points[index as usize]));
        let Some(normal) = (b - a).cross(&(c - a)).try_normalize(1e-9) else { continue };
        let steps = ((b - a).norm().max((c - a).norm()) / 0.8).ceil().clamp(3.0, 60.0) as i32;
        for i in 1..steps {
            for j in 1..steps - i {
                let (u, v) = (f64::from(i) / f64::from(steps), f64::from(j) / f64::from(steps));
                points.push([a + (b - a) * u + (c - a) * v, normal]);
            }
        }
    }
    points
}

/// Largest distance from a solid's surface to the twin's shapes below it, mm. Sockets, screw holes
/// and recesses are filled, as they are by the extrusion, the screws and the tags.
fn largest_gap(kind: JointType) -> f64 {
    let form = kind.form();
    let (socket, w) = (20.6 / 2.0, BODY_WIDTH * 1e3 / 2.0);
    let axis = if form.male { w } else { FEMALE_HEIGHT * 1e3 / 2.0 };
    let (floor, sleeve) = (form.socket_offset * 1e3, kind.sleeve() * 1e3);
    let mut fill = Vec::new();
    let ways: &[f64] = if form.end { &[-1.0] } else { &[-1.0, 1.0] };
    for way in ways {
        let mut y = [way * floor, way * sleeve];
        y.sort_by(f64::total_cmp);
        fill.push(Solid::cuboid([-socket, socket], y, [axis - socket, axis + socket]));
        let middle = way * (floor + 10.0);
        // The wall around the screw, on both sides.
        fill.push(Solid::cuboid([-w, w], [middle - 6.0, middle + 6.0], [axis - 6.0, axis + 6.0]));
    }
    if let Some(offset) = kind.tag_offset() {
        let (at, half) = (-offset * 1e3, 12.75);
        let depth = if form.male { 0.5 } else { 0.3 };
        let recess = |z: f64| Solid::cuboid([-half, half], [at - half, at + half], [z - depth, z]);
        fill.push(recess(axis + w));
        if !form.male {
            fill.push(recess(axis - w + depth));
        }
    }
    fill.push(solid::joint(kind, &D).unwrap());
    let solid = Solid::union(&fill);
    // A beam of this joint alone, along +x.
    let side = if form.end { Side::Left } else { Side::Right };
    let opens = form.one_sided.then_some(side);
    let joint = Joint { name: "j".into(), kind, offset: 0.0, opens, tag: None };
    let beam = Beam { name: "b".into(), joints: vec![joint], links: Vec::new(), start: None };
    let shapes = beam_shapes(&beam);
    let inside =
        |p: nalgebra::Vector3<f64>| collides(&shapes, [p.y * 1e-3, -p.x * 1e-3, (p.z - axis) * 1e-3]);
    let mut largest: f64 = 0.0;
    for [point, normal] in surface(&solid) {
        let fits = |gap: f64| inside(point - normal * gap) && !inside(point + normal * gap);
        let gap = [0.001, 0.01, 0.02, 0.05, 0.1].into_iter().find(|gap| fits(*gap)).unwrap_or(f64::INFINITY);
        assert!(gap.is_finite(), "{}: {point:?} {normal:?}", kind.name());
        largest = largest.max(gap);
    }
    largest
}

#[test]
fn the_twin_collides_what_is_printed() {
    for kind in JointType::ALL {
        let gap = largest_gap(kind);
        // A polygon of 64 corners approximates the round hole; every flat is exact, so no clearance
        // changes.
        assert!(gap <= 0.01, "{}: {gap} mm", kind.name());
    }
}

#[test]
fn the_twin_collides_a_type_of_the_kit_s_own() {
    for degrees in [45.0, -30.0, 60.0] {
        let form = JointForm { socket_offset: 60.0e-3, turn: f64::to_radians(degrees), ..FORMS[0] };
        let kind = JointType::added(&format!("in-m-end-{degrees}"), form);
        assert!(largest_gap(kind) <= 0.01, "{degrees}");
        let solid = solid::joint(kind, &D).unwrap();
        let off = kind.form().volume() * 1e9 / solid.volume() - 1.0;
        assert!(off.abs() < 2e-3, "{degrees}: {:+.3} %", off * 100.0);
    }
    let long = JointForm { cavity: 40.0e-3, socket_offset: 44.0e-3, ..FORMS[6] };
    assert!(largest_gap(JointType::added("long-f", long)) <= 0.01);
}

#[test]
fn the_twin_collides_the_peg_that_is_printed() {
    let peg = solid::peg(&D).unwrap();
    let head = ramp_kit::shape::peg_head();
    for [point, normal] in surface(&peg) {
        if point.z < -0.01 {
            // The stem and its cone; in the twin a capsule and a cone of these radii.
            let cone = (-point.z - (STEM_LENGTH - STEM_CONE) * 1e3).max(0.0) / (STEM_CONE * 1e3);
            let radius = (STEM_RADIUS - cone * (STEM_RADIUS - STEM_TIP_RADIUS)) * 1e3;
            let at_tip = normal.z < -0.99;
            assert!(at_tip || (point.xy().norm() - radius).abs() < 0.01, "{point:?}");
            continue;
        }
        // Flats of the head agree; its edges are round, and sharp in the twin; the groove is 0.2 deep.
        let flat = normal.iter().any(|c| c.abs() > 0.9999);
        let beyond = (0..3).map(|axis| {
            let (low, high) = (head.min[axis] * 1e3, head.max[axis] * 1e3);
            (point[axis] - high).max(low - point[axis])
        });
        let outside = beyond.fold(f64::NEG_INFINITY, f64::max);
        assert!(
            outside < 1e-6 && outside > if flat { -0.201 } else { -0.75 },
            "{point:?} {normal:?} {outside}"
        );
    }
}

#[test]
fn dimensions_that_make_no_part_are_refused() {
    // The kit reader refuses these; set in code, they give an error, not a broken file.
    let thin = Dimensions { wall: 0.0, ..D };
    assert!(solid::joint(JointType::ThruF, &thin).is_err());
    // Other valid dimensions give parts that fit each other.
    let loose = Dimensions { clearance: 0.4e-3, ..D };
    for kind in JointType::ALL {
        let [_, high] = solid::joint(kind, &loose).unwrap().mesh().bounds();
        assert!((high[0] - 13.4).abs() < 1e-9);
        assert!((high[2] - if kind.is_male() { 26.8 } else { 33.6 }).abs() < 1e-9);
    }
}
