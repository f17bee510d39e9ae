//! The kit of the benchmark, against the measured parts.

use ramp_kit::{Beam, JointType, Kit, Side, read_kit};
use std::path::Path;

fn kit() -> Kit {
    read_kit(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/kit.xml")).unwrap()
}

fn beam<'a>(kit: &'a Kit, name: &str) -> &'a Beam {
    kit.beam(name).unwrap()
}

#[track_caller]
fn near(found: f64, expected: f64, within: f64) {
    assert!((found - expected).abs() <= within, "found {found}, expected {expected}");
}

/// Name, hole offsets (mm), mass (g), tags.
const BEAMS: [(&str, &[f64], f64, [u32; 2]); 9] = [
    ("b1", &[0.0, 146.2, 292.4], 209.2, [1, 2]),
    ("b2", &[0.0, 146.2, 292.4], 209.2, [3, 4]),
    ("b3", &[0.0, 146.2, 292.4], 209.2, [5, 6]),
    ("b4", &[0.0, 146.2, 292.4], 196.2, [7, 8]),
    ("b5", &[0.0, 146.2, 292.4], 196.2, [9, 10]),
    ("b6", &[0.0, 189.52, 379.04], 252.3, [11, 12]),
    ("b7", &[0.0, 126.2, 246.8, 367.4, 493.6], 278.4, [13, 14]),
    ("b8", &[0.0, 126.2, 246.8, 367.4, 493.6], 278.4, [15, 16]),
    ("b9", &[0.0, 126.2, 246.8, 367.4, 493.6], 302.8, [17, 18]),
];

#[test]
fn beams_are_as_measured() {
    let kit = kit();
    assert_eq!(kit.beams.len(), 9);
    for (name, offsets, mass, tags) in BEAMS {
        let beam = beam(&kit, name);
        assert_eq!(beam.joints.len(), offsets.len(), "{name}");
        assert_eq!(beam.links.len(), offsets.len() - 1, "{name}");
        for (index, (joint, offset)) in beam.joints.iter().zip(offsets).enumerate() {
            assert_eq!(joint.name, format!("{name}j{}", index + 1));
            near(joint.offset * 1e3, *offset, 0.005);
            assert_eq!(joint.opens.is_some(), joint.kind.has_opening(), "{}", joint.name);
        }
        near(beam.mass() * 1e3, mass, 0.5);
        assert_eq!(beam.joints.first().unwrap().tag, Some(tags[0]));
        assert_eq!(beam.joints.last().unwrap().tag, Some(tags[1]));
        assert_eq!(beam.joints.iter().filter(|joint| joint.tag.is_some()).count(), 2);
    }
}

#[test]
fn joint_types_are_the_published_ones() {
    use JointType::*;
    let kit = kit();
    let kinds = |name: &str| -> Vec<JointType> {
        kit.beam(name).unwrap().joints.iter().map(|joint| joint.kind).collect()
    };
    for name in ["b1", "b2", "b3", "b6"] {
        assert_eq!(kinds(name), [InMEnd, ThruM, InMEnd], "{name}");
    }
    for name in ["b4", "b5"] {
        assert_eq!(kinds(name), [InMEndFeet, InF, InMEndFeet], "{name}");
    }
    for name in ["b7", "b8"] {
        assert_eq!(kinds(name), [InFEnd, AngleF, ThruF, AngleF, InFEnd], "{name}");
    }
    assert_eq!(kinds("b9"), [InMEnd, ThruF, AngleF, ThruF, InMEnd]);
    assert_eq!(beam(&kit, "b4").joints[1].opens, Some(Side::Right));
    assert_eq!(beam(&kit, "b5").joints[1].opens, Some(Side::Left));
    for name in ["b7", "b8"] {
        assert_eq!(beam(&kit, name).joints[0].opens, Some(Side::Left));
        assert_eq!(beam(&kit, name).joints[4].opens, Some(Side::Left));
    }
}

#[test]
fn grasp_spans_are_as_measured() {
    let kit = kit();
    let expected: [(&str, &[[f64; 2]]); 4] = [
        ("b1", &[[55.65, 108.6], [183.8, 236.75]]),
        ("b6", &[[55.65, 151.92], [227.12, 323.39]]),
        ("b8", &[[43.2, 73.2], [179.2, 209.2], [284.4, 314.4], [420.4, 450.4]]),
        ("b9", &[[55.65, 88.6], [163.8, 193.8], [299.8, 329.8], [405.0, 437.95]]),
    ];
    for (name, spans) in expected {
        for (link, span) in beam(&kit, name).links.iter().zip(spans) {
            near(link.grasp[0] * 1e3, span[0], 0.005);
            near(link.grasp[1] * 1e3, span[1], 0.005);
        }
    }
}

#[test]
fn start_layout() {
    let kit = kit();
    let clamped: Vec<&str> =
        kit.beams.iter().filter(|beam| beam.start.is_none()).map(|beam| beam.name.as_str()).collect();
    assert_eq!(clamped, ["b7"]);
    // The j1 hole in the world, mm, and the height of the axis.
    let expected = [("b8", 133.17, 575.77, 16.6), ("b6", 249.18, 464.45, 13.3), ("b5", 326.95, 210.09, 16.6)];
    for (name, x, y, z) in expected {
        let beam = beam(&kit, name);
        let pose = kit.x_wb_start(beam).unwrap();
        near(pose.translation.x * 1e3, x, 0.005);
        near(pose.translation.y * 1e3, y, 0.005);
        near(pose.translation.z * 1e3, z, 1e-9);
        // The last hole lies further along +x of the world, flipped or not.
        let last = pose * beam.p_b_hole(beam.joints.len() - 1);
        near(last.x - pose.translation.x, beam.span(), 1e-9);
        near(last.y, pose.translation.y, 1e-9);
    }
    let flipped: Vec<&str> = kit
        .beams
        .iter()
        .filter(|beam| beam.start.is_some_and(|start| start.flipped))
        .map(|beam| beam.name.as_str())
        .collect();
    assert_eq!(flipped, ["b8"]);
    assert_eq!(kit.x_wb_start(beam(&kit, "b7")), None);
}

#[test]
fn pegs_and_holders() {
    let kit = kit();
    assert_eq!((kit.pegs.len(), kit.holders.len()), (15, 5));
    for (index, peg) in kit.pegs.iter().enumerate() {
        assert_eq!(peg.name, format!("p{}", index + 1));
        assert_eq!(peg.tag, 19 + index as u32);
        assert_eq!(peg.holder, format!("h{}", index / 3 + 1));
        assert_eq!(peg.slot, index as i32 % 3 - 1);
    }
    let pose = kit.x_wp_start(kit.peg("p1").unwrap()).unwrap();
    near(pose.translation.x * 1e3, 53.0 + 424.58 - 34.0, 1e-6);
    near(pose.translation.y * 1e3, 600.0 - 192.48, 1e-6);
    near(pose.translation.z * 1e3, 37.2, 1e-6);
}

#[test]
fn no_two_parts_lie_on_each_other() {
    // Seen from above: each part as the rectangle around it, in the world, m.
    let kit = kit();
    let mut rectangles: Vec<(String, [f64; 4])> = Vec::new();
    for beam in &kit.beams {
        let Some(pose) = kit.x_wb_start(beam) else { continue };
        let (from, to) = (pose.translation.x - 13.6e-3, pose.translation.x + beam.span() + 13.6e-3);
        let y = pose.translation.y;
        rectangles.push((beam.name.clone(), [from, to, y - 13.3e-3, y + 13.3e-3]));
    }
    for holder in &kit.holders {
        let centre = kit.sheet_to_world(holder.centre);
        let half = ramp_kit::Holder::BASE.map(|edge| edge / 2.0);
        rectangles.push((
            holder.name.clone(),
            [centre.x - half[0], centre.x + half[0], centre.y - half[1], centre.y + half[1]],
        ));
    }
    for (index, (name, a)) in rectangles.iter().enumerate() {
        for (other, b) in &rectangles[index + 1..] {
            let apart = a[1] <= b[0] || b[1] <= a[0] || a[3] <= b[2] || b[3] <= a[2];
            assert!(apart, "{name} and {other}");
        }
    }
}

#[test]
fn the_order_of_the_file_does_not_matter() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/kit.xml");
    let text = std::fs::read_to_string(path).unwrap();
    let start = text.find("<joint name=\"b4j1\"").unwrap();
    let end = text.find("<joint name=\"b4j2\"").unwrap();
    let after = text[end..].find("<link name=\"b4l1\"").unwrap() + end;
    let shuffled = format!("{}{}{}{}", &text[..start], &text[end..after], &text[start..end], &text[after..]);
    let shuffled = ramp_kit::read_kit_str("kit.xml", &shuffled).unwrap();
    assert_eq!(shuffled.beams, kit().beams);
}

#[test]
fn a_published_file_has_none_of_our_additions() {
    let text = r#"<?xml version="1.0"?>
<data>
  <beam name="b4">
    <joint name="b4j3" part="in-m-end-feet" marker="8"><parent link="b4l2"/></joint>
    <joint name="b4j2" part="in-f" marker=""><child link="b4l2"/><parent link="b4l1"/></joint>
    <joint name="b4j1" part="in-m-end-feet" marker="7"><child link="b4l1"/></joint>
    <link name="b4l2" length="120"><parent joint="b4j2"/><child joint="b4j3"/></link>
    <link name="b4l1" length="120"><parent joint="b4j1"/><child joint="b4j2"/></link>
  </beam>
</data>"#;
    let kit = ramp_kit::read_kit_str("published.xml", text).unwrap();
    let names: Vec<&str> = kit.beams[0].joints.iter().map(|joint| joint.name.as_str()).collect();
    assert_eq!(names, ["b4j1", "b4j2", "b4j3"]);
    assert_eq!(kit.beams[0].joints[1].opens, Some(Side::Left));
    assert_eq!(kit.beams[0].start, None);
    assert!(kit.pegs.is_empty() && kit.holders.is_empty());
    assert_eq!(kit.sheet.size, [0.594, 0.420]);
    assert_eq!(kit.base_xy, [0.310, 0.0268]);
}
