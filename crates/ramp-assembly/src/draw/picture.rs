//! One goal seen from above: beams, joints, pegs and their numbers.

use super::legend::{LEGEND, legend, rows};
use super::marks::{FAINT, INK, MARGIN, PAPER, arrow, numbered};
use crate::assembly::{Assembly, PlacedBeam};
use nalgebra::Point3;
use ramp_kit::Joint;
use ramp_kit::joint::{BODY_WIDTH, EXTRUSION, MALE_TIP};
use ramp_kit::shape::Shape;
use ramp_kit::strokes::{Align, fit, text};
use std::fmt::Write;

/// Millimetres in a metre.
const MM: f64 = 1e3;
/// Height of the title above the assembly, mm.
const TITLE: f64 = 40.0;
/// Radius of a peg, mm.
const PEG: f64 = 6.8;
const METAL: &str = "#eef1f4";
const METAL_EDGE: &str = "#a3adb8";
/// Fill and edge of the printed joints: the base first, then by the order of insertion.
const COLOURS: [[&str; 2]; 9] = [
    ["#cdd3da", "#6b7683"],
    ["#a9d0f0", "#2d74a8"],
    ["#fbc98c", "#b56c14"],
    ["#a5dc98", "#3c8b30"],
    ["#d3bdea", "#71509f"],
    ["#f6b0ac", "#b4433f"],
    ["#f5e08d", "#96800f"],
    ["#9adfd8", "#25827b"],
    ["#f6bfdb", "#a94a82"],
];

/// A goal with its position on the paper, mm.
pub(super) struct Picture<'a> {
    assembly: &'a Assembly,
    /// For each beam its index in the order of insertion: 0 for the base, then from 1.
    step: Vec<usize>,
    /// The connections in the order in which their pegs are inserted.
    pegs: Vec<usize>,
    /// The assembly's extent, mm.
    low: [f64; 2],
    high: [f64; 2],
}

impl<'a> Picture<'a> {
    /// The picture of a goal.
    pub(super) fn new(assembly: &'a Assembly) -> Picture<'a> {
        let mut step = vec![0; assembly.beams.len()];
        for (index, insertion) in assembly.insertions.iter().enumerate() {
            step[insertion.beam] = index + 1;
        }
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for placed in &assembly.beams {
            for joint in &placed.beam.joints {
                let hole = placed.x_ab * Point3::new(joint.offset, 0.0, 0.0);
                for axis in 0..2 {
                    low[axis] = low[axis].min(hole[axis] * MM - 16.0);
                    high[axis] = high[axis].max(hole[axis] * MM + 16.0);
                }
            }
        }
        Picture { assembly, step, pegs: assembly.peg_order(), low, high }
    }

    /// Adds it to an SVG file.
    pub(super) fn draw(&self, svg: &mut String) {
        self.title(svg);
        self.axes(svg);
        for (index, placed) in self.assembly.beams.iter().enumerate() {
            self.links(svg, placed);
            self.joints(svg, index, placed, true);
        }
        // Females are drawn over the males inside them and are transparent.
        for (index, placed) in self.assembly.beams.iter().enumerate() {
            self.joints(svg, index, placed, false);
        }
        for placed in &self.assembly.beams {
            self.beam_name(svg, placed);
        }
        self.pegs(svg);
        legend(svg, self.assembly, &self.pegs, self.size(), |beam| self.colour(beam));
    }

    fn drawing(&self) -> [f64; 2] {
        [self.high[0] - self.low[0] + 2.0 * MARGIN, self.high[1] - self.low[1] + 2.0 * MARGIN + TITLE + 26.0]
    }

    /// Width and height with the legend, mm.
    pub(super) fn size(&self) -> [f64; 2] {
        let [width, height] = self.drawing();
        let rows = rows(self.assembly.insertions.len(), self.pegs.len());
        [width + LEGEND, height.max(rows + 2.0 * MARGIN)]
    }

    /// A point of the assembly frame on the paper.
    fn at(&self, point: Point3<f64>) -> [f64; 2] {
        [point.x * MM - self.low[0] + MARGIN, self.high[1] - point.y * MM + MARGIN + TITLE]
    }

    /// Fill and edge of a beam.
    fn colour(&self, beam: usize) -> [&'static str; 2] {
        match self.step[beam] {
            0 => COLOURS[0],
            step => COLOURS[1 + (step - 1) % (COLOURS.len() - 1)],
        }
    }

    fn title(&self, svg: &mut String) {
        let assembly = self.assembly;
        // Names from a file can be long.
        let room = self.drawing()[0] - 2.0 * MARGIN;
        let height = fit(&assembly.name, 13.0, room);
        text(svg, [MARGIN, MARGIN + 10.0], Align::Left, height, INK, &assembly.name);
        let class = assembly.class.map_or(String::new(), |class| format!("{class}, "));
        let words = format!("{class}{} beams, {} pegs", assembly.beams.len(), self.pegs.len());
        text(svg, [MARGIN, MARGIN + 27.0], Align::Left, 6.6, FAINT, &words);
    }

    /// The directions X and Y and a scale bar, below the assembly.
    fn axes(&self, svg: &mut String) {
        let [_, height] = self.drawing();
        let (x, y) = (MARGIN, height - 14.0);
        arrow(svg, [x, y], [x + 26.0, y], FAINT, 1.1);
        arrow(svg, [x, y], [x, y - 26.0], FAINT, 1.1);
        text(svg, [x + 31.0, y + 3.0], Align::Left, 6.0, FAINT, "X");
        text(svg, [x + 6.0, y - 21.0], Align::Left, 6.0, FAINT, "Y, away from the robot");
        let (from, to) = (x + 60.0, x + 160.0);
        let _ = writeln!(
            svg,
            r#"<path d="M{from:.1} {:.1}V{:.1}M{from:.1} {y:.1}H{to:.1}M{to:.1} {:.1}V{:.1}" fill="none" stroke="{FAINT}" stroke-width="1.1"/>"#,
            y - 3.0,
            y + 3.0,
            y - 3.0,
            y + 3.0,
        );
        text(svg, [to + 6.0, y + 3.0], Align::Left, 6.0, FAINT, "100 mm");
    }

    fn links(&self, svg: &mut String, placed: &PlacedBeam) {
        for pair in placed.beam.joints.windows(2) {
            let from = pair[0].offset + pair[0].kind.sleeve();
            let to = pair[1].offset - pair[1].kind.sleeve();
            self.rectangle(svg, placed, [from, to], EXTRUSION / 2.0, [METAL, METAL_EDGE], 1.0);
            let ends = [from, to].map(|x| self.at(placed.x_ab * Point3::new(x, 0.0, 0.0)));
            let _ = writeln!(
                svg,
                r#"<path d="M{:.2} {:.2}L{:.2} {:.2}" stroke="{METAL_EDGE}" stroke-width="3" stroke-opacity="0.35"/>"#,
                ends[0][0], ends[0][1], ends[1][0], ends[1][1],
            );
        }
    }

    fn joints(&self, svg: &mut String, index: usize, placed: &PlacedBeam, males: bool) {
        let last = placed.beam.joints.len().saturating_sub(1);
        for (position, joint) in
            placed.beam.joints.iter().enumerate().filter(|(_, j)| j.kind.is_male() == males)
        {
            let outward = if position == 0 && last > 0 { -1.0 } else { 1.0 };
            let opacity = if males { 1.0 } else { 0.72 };
            let half = BODY_WIDTH / 2.0;
            let colour = self.colour(index);
            if joint.kind.form().turn != 0.0 {
                self.turned(svg, placed, joint, outward, colour);
            } else {
                self.rectangle(svg, placed, extent(joint, outward), half, colour, opacity);
            }
            if !males {
                self.walls(svg, placed, joint, outward, colour[1]);
            }
            let [x, y] = self.at(placed.x_ab * Point3::new(joint.offset, 0.0, 0.0));
            let _ = writeln!(
                svg,
                r#"<circle cx="{x:.2}" cy="{y:.2}" r="4.2" fill="{PAPER}" fill-opacity="0.8" stroke="{}" stroke-width="0.8"/>"#,
                colour[1],
            );
        }
    }

    /// A bent male end: its sections seen from above, without the lines between them.
    fn turned(&self, svg: &mut String, placed: &PlacedBeam, joint: &Joint, outward: f64, colour: [&str; 2]) {
        let mut shapes = Vec::new();
        ramp_kit::shape::joint_at(joint, outward, &mut shapes);
        for stroke in [1.8, 0.0] {
            for shape in &shapes {
                let (bounds, turn) = match shape {
                    Shape::Turned { angle, piece, .. } => (piece.bounds(), *angle),
                    _ => continue,
                };
                let (sin, cos) = turn.sin_cos();
                let corners = [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(i, j)| {
                    let (x, y) = ([bounds.min[0], bounds.max[0]][i], [bounds.min[1], bounds.max[1]][j]);
                    let (x, y) = (joint.offset + x * cos - y * sin, x * sin + y * cos);
                    let [x, y] = self.at(placed.x_ab * Point3::new(x, y, 0.0));
                    format!("{x:.2},{y:.2}")
                });
                // First all edges, then the fills over those that are inside.
                let _ = writeln!(
                    svg,
                    r#"<polygon points="{}" fill="{}" stroke="{}" stroke-width="{stroke}" stroke-linejoin="round"/>"#,
                    corners.join(" "),
                    colour[0],
                    colour[1],
                );
            }
        }
    }

    /// The inner edge of each wall of a female, which shows the open sides.
    fn walls(&self, svg: &mut String, placed: &PlacedBeam, joint: &Joint, outward: f64, edge: &str) {
        let half = BODY_WIDTH / 2.0;
        let (inside, across) = (joint.kind.form().cavity, half);
        let closed = joint.opens.map(|side| -side.sign() * (half - 3.0e-3));
        let mut line = |a: [f64; 2], b: [f64; 2]| {
            let [a, b] = [a, b].map(|[x, y]| self.at(placed.x_ab * Point3::new(joint.offset + x, y, 0.0)));
            let _ = writeln!(
                svg,
                r#"<path d="M{:.2} {:.2}L{:.2} {:.2}" stroke="{edge}" stroke-width="0.8"/>"#,
                a[0], a[1], b[0], b[1]
            );
        };
        // An end is open where the beam stops; on its closed side a wall runs along the beam.
        line([-outward * inside, -across], [-outward * inside, across]);
        if !joint.kind.is_end() {
            line([outward * inside, -across], [outward * inside, across]);
        }
        if let Some(y) = closed {
            line([-inside, y], [inside, y]);
        }
    }

    fn rectangle(
        &self,
        svg: &mut String,
        placed: &PlacedBeam,
        x: [f64; 2],
        half: f64,
        colour: [&str; 2],
        opacity: f64,
    ) {
        let corners = [(x[0], -half), (x[1], -half), (x[1], half), (x[0], half)];
        let points = corners.map(|(x, y)| {
            let [x, y] = self.at(placed.x_ab * Point3::new(x, y, 0.0));
            format!("{x:.2},{y:.2}")
        });
        let _ = writeln!(
            svg,
            r#"<polygon points="{}" fill="{}" fill-opacity="{opacity}" stroke="{}" stroke-width="0.9" stroke-linejoin="round"/>"#,
            points.join(" "),
            colour[0],
            colour[1],
        );
    }

    /// The beam's name on the longest bare link.
    fn beam_name(&self, svg: &mut String, placed: &PlacedBeam) {
        let bare = |pair: &[Joint]| {
            let (from, to) = (pair[0].offset + pair[0].kind.sleeve(), pair[1].offset - pair[1].kind.sleeve());
            (to - from, (from + to) / 2.0)
        };
        let longest = placed.beam.joints.windows(2).map(bare).max_by(|a, b| a.0.total_cmp(&b.0));
        let Some((_, middle)) = longest else { return };
        let [x, y] = self.at(placed.x_ab * Point3::new(middle, 0.0, 0.0));
        let half = ramp_kit::strokes::width(&placed.beam.name, 7.4) / 2.0 + 4.0;
        let _ = writeln!(
            svg,
            r#"<rect x="{:.2}" y="{:.2}" width="{:.2}" height="14" rx="7" fill="{PAPER}" stroke="{METAL_EDGE}" stroke-width="0.7"/>"#,
            x - half,
            y - 7.0,
            2.0 * half,
        );
        text(svg, [x, y + 3.7], Align::Middle, 7.4, INK, &placed.beam.name);
    }

    fn pegs(&self, svg: &mut String) {
        for (number, &index) in self.pegs.iter().enumerate() {
            let at = self.at(self.assembly.p_a_hole(self.assembly.connections[index].female));
            numbered(svg, at, PEG, number + 1);
        }
    }
}

/// The range of a joint's outside along the beam, m, without the tag plate, which is thin.
fn extent(joint: &Joint, outward: f64) -> [f64; 2] {
    let form = joint.kind.form();
    let inward = joint.kind.sleeve();
    let past = match (form.male, form.end) {
        (true, true) => MALE_TIP,
        (false, true) => form.cavity,
        (_, false) => inward,
    };
    [joint.offset - outward * inward, joint.offset + outward * past]
}
