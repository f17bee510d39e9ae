//! A goal as a picture: the finished assembly from above, with the order in which it is built.
//!
//! X points right and Y up, as the robot sees it, which stands below the picture. One unit of the drawing is 1 mm.

use crate::assembly::{Assembly, PlacedBeam};
use nalgebra::{Point3, Vector3};
use ramp_kit::Joint;
use ramp_kit::joint::{BODY_WIDTH, EXTRUSION, MALE_TIP};
use ramp_kit::shape::Shape;
use ramp_kit::strokes::{Align, escape, fit, text};
use std::fmt::Write;

/// Millimetres in a metre.
const MM: f64 = 1e3;
/// Pixels for one millimetre where an SVG is shown at its own size.
const ZOOM: f64 = 1.5;
/// Space around the assembly, mm.
const MARGIN: f64 = 26.0;
/// Width of the legend, mm.
const LEGEND: f64 = 178.0;
/// Height of the title above the assembly, mm.
const TITLE: f64 = 40.0;
/// Height of a row of the legend, mm.
const ROW: f64 = 17.0;
/// Height of a row in the list of pegs, mm.
const PEG_ROW: f64 = 15.5;
/// Radius of a peg, mm.
const PEG: f64 = 6.8;
/// Radius of a peg in the legend, mm.
const SMALL_PEG: f64 = 6.2;

const PAPER: &str = "#ffffff";
const INK: &str = "#2b3440";
const FAINT: &str = "#7a8594";
const RULE: &str = "#dfe4ea";
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

/// Draws the goal as SVG.
///
/// Text is drawn as strokes, so no fonts are needed; each text is in the `aria-label` of its path.
pub fn draw_svg(assembly: &Assembly) -> String {
    let picture = Picture::new(assembly);
    let mut svg = String::new();
    let [width, height] = picture.size();
    // Writing to a string does not fail.
    let _ = writeln!(
        svg,
        r#"<svg xmlns="http://www.w3.org/2000/svg" width="{:.0}" height="{:.0}" viewBox="0 0 {width:.1} {height:.1}" role="img">"#,
        width * ZOOM,
        height * ZOOM,
    );
    let _ = writeln!(svg, "<title>{}</title>", escape(&assembly.name));
    let _ = writeln!(svg, r#"<rect width="100%" height="100%" fill="{PAPER}"/>"#);
    picture.draw(&mut svg);
    svg.push_str("</svg>\n");
    svg
}

/// Draws several goals as one SVG, in rows of three, all at the same scale.
pub fn draw_all_svg(assemblies: &[Assembly]) -> String {
    /// Goals in a row.
    const ROW_LENGTH: usize = 3;
    let pictures: Vec<Picture<'_>> = assemblies.iter().map(Picture::new).collect();
    let sizes: Vec<[f64; 2]> = pictures.iter().map(Picture::size).collect();
    let widths: Vec<f64> = (0..ROW_LENGTH)
        .map(|column| sizes.iter().skip(column).step_by(ROW_LENGTH).map(|size| size[0]).fold(0.0, f64::max))
        .collect();
    let heights: Vec<f64> =
        sizes.chunks(ROW_LENGTH).map(|row| row.iter().map(|size| size[1]).fold(0.0, f64::max)).collect();
    let (width, height): (f64, f64) = (widths.iter().sum(), heights.iter().sum());
    let mut svg = String::new();
    // Writing to a string does not fail.
    let _ = writeln!(
        svg,
        r#"<svg xmlns="http://www.w3.org/2000/svg" width="{width:.0}" height="{height:.0}" viewBox="0 0 {width:.1} {height:.1}" role="img">"#
    );
    let _ = writeln!(svg, "<title>{} goals</title>", assemblies.len());
    let _ = writeln!(svg, r#"<rect width="100%" height="100%" fill="{PAPER}"/>"#);
    for (index, picture) in pictures.iter().enumerate() {
        let (row, column) = (index / ROW_LENGTH, index % ROW_LENGTH);
        let (x, y): (f64, f64) = (widths[..column].iter().sum(), heights[..row].iter().sum());
        let _ = writeln!(svg, r#"<g transform="translate({x:.1} {y:.1})">"#);
        picture.draw(&mut svg);
        svg.push_str("</g>\n");
    }
    svg.push_str("</svg>\n");
    svg
}

/// Draws the goal as PNG, `width` pixels wide (at least 64, at most 8192).
///
/// # Errors
/// A picture that has too many pixels.
#[cfg(feature = "png")]
pub fn draw_png(assembly: &Assembly, width: u32) -> Result<Vec<u8>, DrawError> {
    png(&draw_svg(assembly), width)
}

/// Draws several goals as one PNG, `width` pixels wide, see [`draw_all_svg`].
///
/// # Errors
/// A picture that has too many pixels.
#[cfg(feature = "png")]
pub fn draw_all_png(assemblies: &[Assembly], width: u32) -> Result<Vec<u8>, DrawError> {
    png(&draw_all_svg(assemblies), width)
}

#[cfg(feature = "png")]
fn png(svg: &str, width: u32) -> Result<Vec<u8>, DrawError> {
    use resvg::{tiny_skia, usvg};
    let tree =
        usvg::Tree::from_str(svg, &usvg::Options::default()).map_err(|error| DrawError(error.to_string()))?;
    let width = width.clamp(64, 8192);
    let scale = width as f32 / tree.size().width();
    let height = (tree.size().height() * scale).ceil() as u32;
    let mut pixmap = tiny_skia::Pixmap::new(width, height)
        .ok_or_else(|| DrawError(format!("{width} x {height} pixels are too many")))?;
    resvg::render(&tree, tiny_skia::Transform::from_scale(scale, scale), &mut pixmap.as_mut());
    pixmap.encode_png().map_err(|error| DrawError(error.to_string()))
}

/// A drawing that could not be turned into pixels.
#[cfg(feature = "png")]
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
#[error("cannot draw the goal: {0}")]
pub struct DrawError(String);

struct Picture<'a> {
    assembly: &'a Assembly,
    /// For each beam its place in the order of insertion: 0 for the base, then from 1.
    step: Vec<usize>,
    /// The connections in the order in which their pegs go in.
    pegs: Vec<usize>,
    /// The assembly's extent, mm.
    low: [f64; 2],
    high: [f64; 2],
}

impl<'a> Picture<'a> {
    fn new(assembly: &'a Assembly) -> Picture<'a> {
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

    fn draw(&self, svg: &mut String) {
        self.title(svg);
        self.axes(svg);
        for (index, placed) in self.assembly.beams.iter().enumerate() {
            self.links(svg, placed);
            self.joints(svg, index, placed, true);
        }
        // Females lie over the males in them and let them shine through.
        for (index, placed) in self.assembly.beams.iter().enumerate() {
            self.joints(svg, index, placed, false);
        }
        for placed in &self.assembly.beams {
            self.beam_name(svg, placed);
        }
        self.pegs(svg);
        self.legend(svg);
    }

    fn rows(&self) -> f64 {
        let steps = (self.assembly.insertions.len() + 1) as f64;
        2.0 * 24.0 + steps * ROW + 10.0 + self.pegs.len() as f64 * PEG_ROW
    }

    fn drawing(&self) -> [f64; 2] {
        [self.high[0] - self.low[0] + 2.0 * MARGIN, self.high[1] - self.low[1] + 2.0 * MARGIN + TITLE + 26.0]
    }

    fn size(&self) -> [f64; 2] {
        let [width, height] = self.drawing();
        [width + LEGEND, height.max(self.rows() + 2.0 * MARGIN)]
    }

    /// A point of the assembly frame on the paper.
    fn at(&self, point: Point3<f64>) -> [f64; 2] {
        [point.x * MM - self.low[0] + MARGIN, self.high[1] - point.y * MM + MARGIN + TITLE]
    }

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
        let class = assembly.class.map_or(String::new(), |class| format!("{}, ", class.name()));
        let words = format!("{class}{} beams, {} pegs", assembly.beams.len(), self.pegs.len());
        text(svg, [MARGIN, MARGIN + 27.0], Align::Left, 6.6, FAINT, &words);
    }

    /// The directions X and Y and a length to compare with, below the assembly.
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

    /// A male end that is turned: its pieces seen from above, without the lines between them.
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

    /// The inner edge of each wall of a female, so that one sees where it is open.
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

    fn legend(&self, svg: &mut String) {
        let assembly = self.assembly;
        let [width, height] = self.size();
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
            let [fill, edge] = self.colour(beam);
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
        for (number, &index) in self.pegs.iter().enumerate() {
            let connection = &assembly.connections[index];
            numbered(svg, [x + 6.0, y], SMALL_PEG, number + 1);
            let words = format!(
                "{} in {}",
                assembly.joint_name(connection.male),
                assembly.joint_name(connection.female)
            );
            text(svg, [x + 22.0, y + 3.2], Align::Left, fit(&words, 6.2, 78.0), INK, &words);
            let name = &connection.name;
            text(svg, [x + 104.0, y + 3.2], Align::Left, fit(name, 6.2, 50.0), FAINT, name);
            y += PEG_ROW;
        }
    }
}

/// From where to where a joint's outside reaches along the beam, m; without the tag plate, which is thin.
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

/// A peg: a white disc with its number.
fn numbered(svg: &mut String, at: [f64; 2], radius: f64, number: usize) {
    let _ = writeln!(
        svg,
        r#"<circle cx="{:.2}" cy="{:.2}" r="{}" fill="{PAPER}" stroke="{INK}" stroke-width="1"/>"#,
        at[0], at[1], radius,
    );
    text(svg, [at[0], at[1] + 2.9], Align::Middle, 5.8, INK, &number.to_string());
}

/// The direction of an insertion in words.
fn way(direction: &Vector3<f64>) -> String {
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
fn direction_mark(svg: &mut String, at: [f64; 2], direction: &Vector3<f64>) {
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

fn arrow(svg: &mut String, from: [f64; 2], to: [f64; 2], colour: &str, stroke: f64) {
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
