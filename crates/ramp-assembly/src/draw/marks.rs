//! Colours, arrows and numbers that every part of the picture uses.

use nalgebra::Vector3;
use ramp_kit::strokes::{Align, text};
use std::fmt::Write;

pub(super) const PAPER: &str = "#ffffff";
pub(super) const INK: &str = "#2b3440";
pub(super) const FAINT: &str = "#7a8594";

/// Space around the assembly, mm.
pub(super) const MARGIN: f64 = 26.0;

/// A peg: a white disc with its number.
pub(super) fn numbered(svg: &mut String, at: [f64; 2], radius: f64, number: usize) {
    let _ = writeln!(
        svg,
        r#"<circle cx="{:.2}" cy="{:.2}" r="{}" fill="{PAPER}" stroke="{INK}" stroke-width="1"/>"#,
        at[0], at[1], radius,
    );
    text(svg, [at[0], at[1] + 2.9], Align::Middle, 5.8, INK, &number.to_string());
}

/// The direction of an insertion in words.
pub(super) fn way(direction: &Vector3<f64>) -> String {
    let near = |value: f64, target: f64| (value - target).abs() < 1e-3;
    for (axis, name) in ["X", "Y", "Z"].into_iter().enumerate() {
        if near(direction[axis].abs(), 1.0) {
            let sign = if direction[axis] < 0.0 { '−' } else { '+' };
            return if name == "Z" { "laid from above".to_string() } else { format!("along {sign}{name}") };
        }
    }
    let degrees = direction.y.atan2(direction.x).to_degrees();
    format!("at {}{:.1}°", if degrees < 0.0 { "−" } else { "" }, degrees.abs())
}

/// An arrow in the direction of an insertion, or a cross in a ring (seen from behind) for one from above.
pub(super) fn direction_mark(svg: &mut String, at: [f64; 2], direction: &Vector3<f64>) {
    let [x, y] = at;
    if direction.z.abs() > 0.5 {
        let _ = writeln!(
            svg,
            r#"<path d="M{:.2} {:.2}l6 6m0 -6l-6 6" stroke="{INK}" stroke-width="1.1"/><circle cx="{x:.2}" cy="{y:.2}" r="5" fill="none" stroke="{INK}" stroke-width="1.1"/>"#,
            x - 3.0,
            y - 3.0,
        );
        return;
    }
    let (dx, dy) = (direction.x * 6.5, -direction.y * 6.5);
    arrow(svg, [x - dx, y - dy], [x + dx, y + dy], INK, 1.3);
}

/// An arrow.
pub(super) fn arrow(svg: &mut String, from: [f64; 2], to: [f64; 2], colour: &str, stroke: f64) {
    let (dx, dy) = (to[0] - from[0], to[1] - from[1]);
    let length = dx.hypot(dy).max(1e-9);
    let (ux, uy) = (dx / length, dy / length);
    let barb = |side: f64| [to[0] - 4.0 * ux + side * 2.6 * uy, to[1] - 4.0 * uy - side * 2.6 * ux];
    let (a, b) = (barb(1.0), barb(-1.0));
    let _ = writeln!(
        svg,
        r#"<path d="M{:.2} {:.2}L{:.2} {:.2}M{:.2} {:.2}L{:.2} {:.2}L{:.2} {:.2}" fill="none" stroke="{colour}" stroke-width="{stroke}" stroke-linecap="round" stroke-linejoin="round"/>"#,
        from[0], from[1], to[0], to[1], a[0], a[1], to[0], to[1], b[0], b[1],
    );
}
