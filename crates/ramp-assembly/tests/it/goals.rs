//! The nine goals of the benchmark: every pose, every gap, and the order of insertions of each.

use ramp_assembly::{Assembly, Class, Insertion, read_goal, report};
use ramp_kit::{Kit, read_kit};
use std::path::PathBuf;

fn data() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../data")
}

fn kit() -> Kit {
    read_kit(&data().join("kit.xml")).unwrap()
}

fn goal(name: &str) -> Assembly {
    read_goal(&data().join("goals").join(format!("{name}.xml")), &kit())
        .unwrap_or_else(|error| panic!("{error:#}"))
}

/// A beam, the position of its j1 hole (mm) and its yaw (degrees); b7 is at the origin, b8 always
/// flipped.
type Poses = &'static [(&'static str, f64, f64, f64)];

/// The name, the poses, the number of pegs and the largest distance between two holes, mm.
const GOALS: [(&str, Poses, usize, f64); 9] = [
    ("easy-1", &[("b1", 246.8, 0.0, 90.0), ("b4", 0.0, 0.0, 90.0), ("b5", 493.6, 0.0, 90.0)], 3, 0.0),
    ("easy-2", &[("b4", 0.0, 0.0, 90.0), ("b8", 0.0, 292.4, 0.0), ("b9", 0.0, 146.2, 0.0)], 3, 0.0),
    ("easy-3", &[("b4", 0.0, 0.0, 90.0), ("b5", 493.6, 0.0, 90.0), ("b8", 0.0, 292.4, 0.0)], 4, 0.0),
    ("medium-1", &[("b1", 246.8, 0.0, 90.0), ("b4", 0.0, 0.0, 90.0), ("b9", 0.0, 146.2, 0.0)], 4, 0.0),
    (
        "medium-2",
        &[
            ("b4", 0.0, 0.0, 90.0),
            ("b5", 493.6, 0.0, 90.0),
            ("b6", 126.2, 0.0, 50.4809),
            ("b8", 0.0, 292.4, 0.0),
        ],
        6,
        0.0051,
    ),
    (
        "medium-3",
        &[
            ("b1", 126.2, 0.0, 90.0),
            ("b2", 367.4, 0.0, 90.0),
            ("b4", 0.0, 0.0, 90.0),
            ("b5", 493.6, 0.0, 90.0),
            ("b8", 0.0, 292.4, 0.0),
        ],
        8,
        0.0,
    ),
    (
        "hard-1",
        &[
            ("b1", 126.2, 0.0, 90.0),
            ("b2", 367.4, 0.0, 90.0),
            ("b3", 246.8, 0.0, 90.0),
            ("b4", 0.0, 0.0, 90.0),
            ("b5", 493.6, 0.0, 90.0),
            ("b8", 0.0, 292.4, 0.0),
            ("b9", 0.0, 146.2, 0.0),
        ],
        15,
        0.0,
    ),
    (
        "hard-2",
        &[
            ("b4", 0.0, 0.0, 90.0),
            ("b5", 493.6, 0.0, 90.0),
            ("b6", 126.2, 0.0, 50.4809),
            ("b8", 0.0, 292.4, 0.0),
            ("b9", 0.0, 146.2, 0.0),
        ],
        9,
        0.0051,
    ),
    (
        "hard-3",
        &[
            ("b1", 246.8, 0.0, 90.0),
            ("b5", 393.0, 292.4, 180.0),
            ("b6", 126.2, 0.0, 129.5191),
            ("b8", -120.6, 146.2, 0.0),
        ],
        5,
        0.0026,
    ),
];

#[test]
fn every_beam_is_at_its_place() {
    for (name, poses, ..) in GOALS {
        let goal = goal(name);
        assert_eq!(goal.name, name);
        assert_eq!(goal.class.map(Class::name), name.split_once('-').map(|(class, _)| class.to_string()));
        assert_eq!(goal.beams.len(), poses.len() + 1, "{name}");
        assert_eq!(goal.beams[goal.base].beam.name, "b7");
        for &(beam, x, y, yaw) in poses.iter().chain(&[("b7", 0.0, 0.0, 0.0)]) {
            let placed = &goal.beams[goal.beam_index(beam).unwrap()];
            let at = placed.x_ab.translation.vector * 1e3;
            for (found, expected) in [(at.x, x), (at.y, y), (at.z, 16.6)] {
                assert!((found - expected).abs() < 0.01, "{name} {beam}: {found} instead of {expected}");
            }
            let along = placed.x_ab.rotation * nalgebra::Vector3::x();
            let off = (along.y.atan2(along.x).to_degrees() - yaw + 540.0).rem_euclid(360.0) - 180.0;
            assert!(off.abs() < 0.01, "{name} {beam}: yaw {off} off");
            let up = placed.x_ab.rotation * nalgebra::Vector3::z();
            assert_eq!(placed.flipped, beam == "b8");
            assert!((up.z - if placed.flipped { -1.0 } else { 1.0 }).abs() < 1e-12, "{name} {beam}");
        }
    }
}

#[test]
fn every_hole_meets_and_every_gap_is_the_clearance() {
    for (name, _, pegs, residual) in GOALS {
        let goal = goal(name);
        let report = report(&goal);
        assert_eq!(report.fits.len(), pegs, "{name}");
        for (fit, connection) in report.fits.iter().zip(&goal.connections) {
            assert!(fit.residual * 1e3 <= residual + 0.0001, "{name} {}: {fit:?}", connection.name);
            assert!((fit.gap * 1e3 - 0.3).abs() < 0.001, "{name} {}: {fit:?}", connection.name);
        }
        assert!((report.smallest_gap.unwrap().width * 1e3 - 0.3).abs() < 0.001, "{name}");
        assert_eq!(report.overlaps, [], "{name}");
        assert_eq!(report.insertions.as_deref(), Some(goal.insertions.as_slice()), "{name}");
    }
}

/// The beams in order and the directions in which they move; `*` is along a beam's own axis.
const ORDERS: [(&str, &[(&str, &str)]); 9] = [
    ("easy-1", &[("b4", "-Y"), ("b5", "-Y"), ("b1", "-Y")]),
    ("easy-2", &[("b4", "-Y"), ("b9", "-X"), ("b8", "-Y")]),
    ("easy-3", &[("b4", "-Y"), ("b5", "-Y"), ("b8", "-Y")]),
    ("medium-1", &[("b4", "-Y"), ("b9", "-X"), ("b1", "-Y")]),
    ("medium-2", &[("b4", "-Y"), ("b5", "-Y"), ("b6", "*"), ("b8", "-Y")]),
    ("medium-3", &[("b4", "-Y"), ("b5", "-Y"), ("b1", "-Y"), ("b2", "-Y"), ("b8", "-Y")]),
    (
        "hard-1",
        &[("b4", "-Y"), ("b9", "-X"), ("b1", "-Y"), ("b2", "-Y"), ("b3", "-Y"), ("b5", "-X"), ("b8", "-Y")],
    ),
    ("hard-2", &[("b4", "-Y"), ("b9", "-X"), ("b6", "*"), ("b5", "-X"), ("b8", "-Y")]),
    ("hard-3", &[("b8", "-Z"), ("b1", "-Y"), ("b6", "*"), ("b5", "-Y")]),
];

fn in_words(goal: &Assembly, insertion: &Insertion) -> &'static str {
    let direction = insertion.direction.into_inner();
    for (word, axis) in [("-X", [-1.0, 0.0, 0.0]), ("-Y", [0.0, -1.0, 0.0]), ("-Z", [0.0, 0.0, -1.0])] {
        if (direction - nalgebra::Vector3::from(axis)).norm() < 1e-9 {
            return word;
        }
    }
    let along = goal.beams[insertion.beam].x_ab.rotation * nalgebra::Vector3::x();
    if (direction.dot(&along).abs() - 1.0).abs() < 1e-9 { "*" } else { "?" }
}

#[test]
fn every_goal_is_built_in_the_proven_order() {
    for (name, order) in ORDERS {
        let goal = goal(name);
        let found: Vec<(&str, &str)> = goal
            .insertions
            .iter()
            .map(|insertion| (goal.beams[insertion.beam].beam.name.as_str(), in_words(&goal, insertion)))
            .collect();
        assert_eq!(found, order, "{name}");
    }
}

#[test]
fn beams_that_pass_through_others_start_clear_of_them() {
    let distance = |name: &str, beam: &str| {
        let goal = goal(name);
        let index = goal.beam_index(beam).unwrap();
        goal.insertions.iter().find(|insertion| insertion.beam == index).unwrap().distance * 1e3
    };
    assert_eq!(distance("easy-1", "b4"), 60.0);
    assert_eq!(distance("hard-1", "b8"), 60.0);
    // b1's tip, 10 mm beyond its hole, must leave b9, 146.2 mm away and 13.3 mm to either side,
    // with 5 mm to spare.
    let through = 146.2 + 13.3 + 10.0 + 5.0;
    assert!((distance("medium-1", "b1") - through).abs() < 0.01);
    assert!((distance("hard-3", "b1") - through).abs() < 0.01);
    assert!(distance("hard-2", "b6") > 200.0);
}

/// The same by brute force: in steps of 1 mm, with the beams' own boxes and an independent test.
#[test]
fn no_insertion_meets_anything_on_its_way() {
    use ramp_kit::shape::{Shape, beam_shapes};
    type Corners = Vec<[f64; 2]>;
    let slabs = |goal: &Assembly, beam: usize, shift: nalgebra::Vector3<f64>| -> Vec<(Corners, [f64; 2])> {
        let placed = &goal.beams[beam];
        let slab = |shape: &Shape| {
            let bounds = Shape::bounds(shape);
            let (low, high) = (bounds.min, bounds.max);
            // Reduced by the tolerance of the test.
            let s = 0.005e-3;
            let corner = |x: f64, y: f64, z: f64| placed.x_ab * nalgebra::Point3::new(x, y, z) + shift;
            let (low, high) = (low.map(|v| v + s), high.map(|v| v - s));
            let plane: Corners = [(0, 0), (1, 0), (1, 1), (0, 1)]
                .map(|(i, j)| {
                    let p = corner([low[0], high[0]][i], [low[1], high[1]][j], 0.0);
                    [p.x, p.y]
                })
                .to_vec();
            let (a, b) = (corner(0.0, 0.0, low[2]).z, corner(0.0, 0.0, high[2]).z);
            (plane, [a.min(b), a.max(b)])
        };
        beam_shapes(&placed.beam).iter().map(slab).collect()
    };
    let separated = |a: &Corners, b: &Corners| {
        let by = |a: &Corners, b: &Corners| {
            (0..4).any(|edge| {
                let (p, q) = (a[edge], a[(edge + 1) % 4]);
                let side = |r: &[f64; 2]| (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
                let own = side(&a[(edge + 2) % 4]);
                b.iter().all(|r| side(r) * own <= 0.0)
            })
        };
        by(a, b) || by(b, a)
    };
    for (name, ..) in GOALS {
        let goal = goal(name);
        let mut standing = vec![goal.base];
        for insertion in &goal.insertions {
            let obstacles: Vec<_> =
                standing.iter().flat_map(|&beam| slabs(&goal, beam, nalgebra::Vector3::zeros())).collect();
            let steps = (insertion.distance / 1e-3).ceil() as usize;
            for step in 0..=steps {
                let back =
                    -insertion.direction.into_inner() * (insertion.distance * step as f64 / steps as f64);
                for (plane, z) in slabs(&goal, insertion.beam, back) {
                    for (other, other_z) in &obstacles {
                        let apart = z[1] <= other_z[0] || other_z[1] <= z[0] || separated(&plane, other);
                        assert!(apart, "{name}: {insertion:?} after {step} mm");
                    }
                }
            }
            standing.push(insertion.beam);
        }
    }
}

#[test]
fn pegs_follow_the_beams() {
    let goal = goal("hard-3");
    let names: Vec<&str> =
        goal.peg_order().into_iter().map(|index| goal.connections[index].name.as_str()).collect();
    assert_eq!(names, ["C2", "C4", "C1", "C3", "C5"]);
    for (name, _, pegs, _) in GOALS {
        let mut order = self::goal(name).peg_order();
        order.sort_unstable();
        assert_eq!(order, (0..pegs).collect::<Vec<_>>());
    }
}

#[test]
fn the_published_form_of_hard_2() {
    let seven = read_goal(&data().join("goals/variants/hard-2-seven.xml"), &kit()).unwrap();
    let nine = goal("hard-2");
    assert_eq!(seven.connections.len(), 7);
    for (a, b) in seven.beams.iter().zip(&nine.beams) {
        assert!((a.x_ab.translation.vector - b.x_ab.translation.vector).norm() < 1e-5, "{}", a.beam.name);
    }
}

#[test]
fn the_order_of_the_file_does_not_change_the_poses() {
    for (name, ..) in GOALS {
        let text = std::fs::read_to_string(data().join(format!("goals/{name}.xml"))).unwrap();
        let mut blocks: Vec<String> =
            text.split("  <connection").skip(1).map(|b| format!("  <connection{b}")).collect();
        let head = text.split("  <connection").next().unwrap();
        let last = blocks.last_mut().unwrap();
        *last = last.replace("</assembly>", "");
        blocks.reverse();
        let reversed = format!("{head}{}</assembly>", blocks.concat());
        let reversed =
            ramp_assembly::read_goal_str(name, &reversed, &kit()).unwrap_or_else(|e| panic!("{e:#}"));
        for (a, b) in reversed.beams.iter().zip(&goal(name).beams) {
            assert!(
                (a.x_ab.translation.vector - b.x_ab.translation.vector).norm() < 1e-5,
                "{name} {}",
                a.beam.name
            );
            assert!(a.x_ab.rotation.angle_to(&b.x_ab.rotation) < 1e-4, "{name} {}", a.beam.name);
        }
    }
}

#[test]
fn the_catalogue() {
    let folder = data().join("goals");
    let names = ramp_assembly::goal_names(&folder).unwrap();
    assert_eq!(names, GOALS.map(|(name, ..)| name));
    ramp_assembly::check_known("easy-3", &names, "goals").unwrap();
    let unknown = |name: &str| ramp_assembly::check_known(name, &names, "goals").unwrap_err().help.unwrap();
    assert_eq!(unknown("easy-33"), "did you mean `easy-3`?");
    assert_eq!(unknown("eazy3"), "did you mean `easy-3`?");
    assert_eq!(unknown("Hard-2"), "did you mean `hard-2`?");
    assert!(unknown("chair").starts_with("the goals are easy-1, easy-2"));
    ramp_assembly::goal_names(&folder.join("none")).unwrap_err();
}

#[test]
fn drawings_are_xml_with_all_names() {
    for (name, ..) in GOALS {
        let goal = goal(name);
        let svg = ramp_assembly::draw_svg(&goal);
        assert!(svg.contains(&format!("aria-label=\"{name}\"")));
        for placed in &goal.beams {
            assert!(svg.contains(&format!("aria-label=\"{}\"", placed.beam.name)), "{name}");
        }
        assert!(!svg.contains("NaN") && !svg.contains("inf\""), "{name}");
        assert_eq!(svg, ramp_assembly::draw_svg(&goal));
        assert!(roxmltree::Document::parse(&svg).is_ok(), "{name}");
    }
}

#[cfg(feature = "png")]
#[test]
fn drawings_as_png() {
    let png = ramp_assembly::draw::draw_png(&goal("easy-3"), 300).unwrap();
    assert_eq!(png[..8], *b"\x89PNG\r\n\x1a\n");
}
