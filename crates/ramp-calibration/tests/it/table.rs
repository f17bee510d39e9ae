//! The table's plane.

use ramp_calibration::{CalibrationError, table};

const SHEET: [[f64; 2]; 4] = [[0.053, 0.6], [0.647, 0.6], [0.647, 0.18], [0.053, 0.18]];

/// Touches of a plane at a height with slopes along x and y, each off by its own error, m.
fn touches(height: f64, slopes: [f64; 2], places: &[([f64; 2], f64)]) -> Vec<[f64; 3]> {
    places.iter().map(|([x, y], error)| [*x, *y, height + slopes[0] * x + slopes[1] * y + error]).collect()
}

#[test]
fn a_plane_is_found() {
    let places = [([0.1, 0.2], 0.0), ([0.6, 0.2], 0.0), ([0.6, 0.6], 0.0), ([0.1, 0.6], 0.0)];
    let found = table::calibrate(&touches(-0.004, [0.002, -0.001], &places), &SHEET).unwrap();
    assert!(found.verdict().is_good(), "{:?}", found.verdict());
    assert!((found.height + 0.004).abs() < 1e-12 && found.residual < 1e-12);
    assert!((found.height_at(0.5, 0.5) + 0.0035).abs() < 1e-12);
    assert!((found.tilt() - 0.002_f64.hypot(0.001)).abs() < 1e-6);
    // Three points make a plane, too.
    assert!(table::calibrate(&touches(0.0, [0.0; 2], &places[..3]), &SHEET).unwrap().verdict().is_good());
}

#[test]
fn bad_touches_are_refused_or_not_good_enough() {
    let flat = |places: &[([f64; 2], f64)]| table::calibrate(&touches(0.0, [0.0; 2], places), &SHEET);
    let error = flat(&[([0.1, 0.2], 0.0), ([0.6, 0.2], 0.0)]).unwrap_err();
    assert!(matches!(error, CalibrationError::TooFew { found: 2, least: 3, .. }), "{error}");
    let line = [0.1, 0.3, 0.5, 0.6].map(|x| ([x, 0.2 + 0.3 * x], 0.0));
    assert!(flat(&line).unwrap_err().to_string().contains("lie on a line"));
    assert!(flat(&[([0.3, 0.3], 0.0); 4]).unwrap_err().to_string().contains("lie on a line"));
    // One touch pressed too hard.
    let pressed = [([0.1, 0.2], 0.0), ([0.6, 0.2], -3e-3), ([0.6, 0.6], 0.0), ([0.1, 0.6], 0.0)];
    assert!(!flat(&pressed).unwrap().verdict().is_good());
    // All touches at one end of the sheet.
    let bunched = [([0.1, 0.2], 0.0), ([0.16, 0.2], 0.0), ([0.1, 0.26], 0.0), ([0.16, 0.26], 0.0)];
    assert!(!flat(&bunched).unwrap().verdict().is_good());
    // A table that stands askew.
    let places = [([0.1, 0.2], 0.0), ([0.6, 0.2], 0.0), ([0.6, 0.6], 0.0), ([0.1, 0.6], 0.0)];
    let askew = table::calibrate(&touches(0.0, [0.02, 0.0], &places), &SHEET).unwrap();
    assert!(!askew.verdict().is_good());
}
