//! Two parts that were found in one place.

use nalgebra::Point3;
use ramp_vision::untagged::is_one_place;

#[test]
fn parts_along_one_another_are_in_one_place() {
    let beam = |y: f64, from: f64, to: f64| [from, to].map(|x| Point3::new(x, y, 0.0166));
    assert!(is_one_place(beam(0.0, 0.0, 0.3), beam(0.005, 0.45, -0.1)));
    // Side by side on the sheet, in line with a joint in common, and across one another in a joint.
    assert!(!is_one_place(beam(0.0, 0.0, 0.3), beam(0.04, 0.0, 0.3)));
    assert!(!is_one_place(beam(0.0, 0.0, 0.3), beam(0.0, 0.28, 0.6)));
    assert!(!is_one_place(beam(0.0, 0.0, 0.3), [-0.2, 0.2].map(|y| Point3::new(0.15, y, 0.0166))));
    // Pegs, and a peg in a beam.
    let peg = |x: f64| [-0.03, 0.03].map(|by| Point3::new(x + by, 0.0, 0.03));
    assert!(is_one_place(peg(0.0), peg(0.008)));
    assert!(!is_one_place(peg(0.0), peg(0.026)));
    assert!(!is_one_place(peg(0.1), beam(0.0, 0.0, 0.3)));
}
