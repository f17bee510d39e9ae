//! A new joint type and a new beam, by file only: checked, placed, drawn, written again.

use ramp_assembly::{draw_svg, read_goal, report};
use ramp_kit::{Kit, kit_xml, read_kit, read_kit_str};
use std::path::PathBuf;

fn examples() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../data/examples")
}

fn kit() -> Kit {
    read_kit(&examples().join("kit-45.xml")).unwrap_or_else(|error| panic!("{error:#}"))
}

#[test]
fn the_beam_is_what_the_file_says() {
    let kit = kit();
    let beam = kit.beam("b10").unwrap();
    let kind = beam.joints[0].kind;
    assert_eq!(kind.name(), "in-m-end-45");
    assert!(kind.is_male() && kind.is_end() && !kind.has_opening());
    assert!((beam.span() - (36.0 + 100.0 + 8.6) * 1e-3).abs() < 1e-12);
    assert!((kind.form().turn.to_degrees() - 45.0).abs() < 1e-9);
    // Somewhat more plastic than the straight one.
    assert!(kind.mass() > 23e-3 && kind.mass() < 60e-3, "{}", kind.mass());
    // The same description read twice is the same type, and writing it reproduces the file.
    let again = read_kit_str("again.xml", &kit_xml(&kit, "again")).unwrap();
    assert_eq!(again.beams, kit.beams);
    assert_eq!(again.beam("b10").unwrap().joints[0].kind, kind);
}

#[test]
fn a_goal_with_it_is_placed_checked_and_drawn() {
    let kit = kit();
    let goal = read_goal(&examples().join("corner-45.xml"), &kit).unwrap_or_else(|error| panic!("{error:#}"));
    let index = goal.beam_index("b10").unwrap();
    let x_ab = goal.beams[index].x_ab;
    let along = x_ab.rotation * nalgebra::Vector3::x();
    // Its tip points straight towards the robot, so the beam extends at 45°.
    let yaw = along.y.atan2(along.x).to_degrees();
    assert!((yaw - 45.0).abs() < 1e-6, "{yaw}");
    let report = report(&goal);
    assert_eq!(report.overlaps, []);
    for fit in &report.fits {
        assert!(fit.residual < 1e-9 && (fit.gap - 0.3e-3).abs() < 1e-6, "{fit:?}");
    }
    // It is inserted straight towards the robot, not along its own axis.
    let insertion = goal.insertions.iter().find(|insertion| insertion.beam == index).unwrap();
    assert!((insertion.direction.y + 1.0).abs() < 1e-9, "{insertion:?}");
    let svg = draw_svg(&goal);
    assert!(svg.contains("aria-label=\"b10\"") && roxmltree::Document::parse(&svg).is_ok());
}

#[test]
fn it_is_refused_where_it_cannot_be() {
    let text = std::fs::read_to_string(examples().join("kit-45.xml")).unwrap();
    let refuse = |from: &str, to: &str| {
        assert!(text.contains(from));
        let error = read_kit_str("kit.xml", &text.replacen(from, to, 1)).err().unwrap();
        error.to_string()
    };
    assert!(refuse("socket=\"36\"", "socket=\"30\"").contains("its socket needs to be 35.53 mm or more"));
    assert!(refuse("turn=\"45\"", "turn=\"80\"").contains("from -60 to 60 degrees"));
    assert!(refuse("turn=\"45\"", "turn=\"1\"").contains("the turn of a male end is at least 5°"));
    assert!(refuse("turn=\"45\"", "turn=\"45\" cavity=\"20\"").contains("only a female has a cavity"));
    assert!(refuse("<part name=\"in-m-end-45\"", "<part name=\"thru-f\"").contains("already"));
    assert!(refuse("place=\"end\"", "place=\"middle\"").contains("only a male end can be turned"));
    let short = "mates=\"female\" place=\"middle\" socket=\"36\" cavity=\"12\" open=\"both\"";
    assert!(
        refuse("mates=\"male\" place=\"end\" socket=\"36\" turn=\"45\"", short).contains("does not go into")
    );
    for (wall, clearance) in [("0.9", "0.3"), ("3", "-0.1"), ("NaN", "0.3"), ("3", "0")] {
        let to = format!("wall=\"{wall}\" clearance=\"{clearance}\"");
        let words = refuse("wall=\"3\" clearance=\"0.3\"", &to);
        assert!(words.contains("expected a number from"), "{words}");
    }
}
