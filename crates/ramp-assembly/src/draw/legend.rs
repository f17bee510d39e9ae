//! The list beside a picture: the beams and the pegs in their order.

use super::marks::{FAINT, INK, MARGIN, direction_mark, numbered, way};
use crate::assembly::Assembly;
use ramp_kit::strokes::{Align, fit, text};
use std::fmt::Write;

/// Width of the legend, mm.
pub(super) const LEGEND: f64 = 178.0;
/// Height of a row of the legend, mm.
const ROW: f64 = 17.0;
/// Height of a row in the list of pegs, mm.
const PEG_ROW: f64 = 15.5;
/// Radius of a peg in the legend, mm.
const SMALL_PEG: f64 = 6.2;
const RULE: &str = "#dfe4ea";

/// The height of a legend with this number of insertions and pegs, mm.
pub(super) fn rows(insertions: usize, pegs: usize) -> f64 {
    2.0 * 24.0 + (insertions + 1) as f64 * ROW + 10.0 + pegs as f64 * PEG_ROW
}

/// Adds the legend to a picture of this width and height, mm. `pegs` are connections in their
/// order, and `colour` returns fill and edge colour of a beam.
pub(super) fn legend(
    svg: &mut String,
    assembly: &Assembly,
    pegs: &[usize],
    [width, height]: [f64; 2],
    colour: impl Fn(usize) -> [&'static str; 2],
) {
    let x = width - LEGEND + 6.0;
    let _ = writeln!(
        svg,
        r#"<path d="M{:.1} {MARGIN}V{:.1}" stroke="{RULE}" stroke-width="1"/>"#,
        x - 14.0,
        height - MARGIN
    );
    let mut y = MARGIN + 8.0;
    text(svg, [x, y], Align::Left, 7.4, INK, "Beams, in order");
    y += 16.0;
    let row = |svg: &mut String, number: &str, beam: usize, y: f64| {
        let [fill, edge] = colour(beam);
        text(svg, [x, y + 3.2], Align::Left, 6.4, FAINT, number);
        let _ = writeln!(
            svg,
            r#"<rect x="{:.1}" y="{:.1}" width="13" height="11" rx="2" fill="{fill}" stroke="{edge}" stroke-width="0.9"/>"#,
            x + 13.0,
            y - 5.5,
        );
        let name = &assembly.beams[beam].beam.name;
        text(svg, [x + 32.0, y + 3.4], Align::Left, fit(name, 6.8, 24.0), INK, name);
    };
    row(svg, "", assembly.base, y);
    text(svg, [x + 58.0, y + 3.2], Align::Left, 6.2, FAINT, "clamped to the table");
    for (number, insertion) in assembly.insertions.iter().enumerate() {
        y += ROW;
        row(svg, &(number + 1).to_string(), insertion.beam, y);
        let direction = insertion.direction.into_inner();
        direction_mark(svg, [x + 64.0, y], &direction);
        text(svg, [x + 78.0, y + 3.2], Align::Left, 6.2, FAINT, &way(&direction));
    }
    y += ROW + 10.0;
    text(svg, [x, y + 4.0], Align::Left, 7.4, INK, "Pegs, in order");
    y += 18.0;
    for (number, &index) in pegs.iter().enumerate() {
        let connection = &assembly.connections[index];
        numbered(svg, [x + 6.0, y], SMALL_PEG, number + 1);
        let words =
            format!("{} in {}", assembly.joint_name(connection.male), assembly.joint_name(connection.female));
        text(svg, [x + 22.0, y + 3.2], Align::Left, fit(&words, 6.2, 78.0), INK, &words);
        let name = &connection.name;
        text(svg, [x + 104.0, y + 3.2], Align::Left, fit(name, 6.2, 50.0), FAINT, name);
        y += PEG_ROW;
    }
}
