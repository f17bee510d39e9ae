//! A drawing, and two output formats: SVG and PDF, both at true scale.
//!
//! Millimetres, y down, the origin at the top left corner of the paper. Text is drawn as strokes
//! ([`crate::strokes`]), so a drawing looks the same everywhere and needs no fonts. The output does
//! not depend on the date or the machine.

use crate::strokes::{self, Align};
use pdf_writer::types::{LineCapStyle, LineJoinStyle};
use pdf_writer::{Content, Finish, Name, Pdf, Rect, Ref, TextStr};
use std::f64::consts::PI;
use std::fmt::Write;

/// Red, green and blue.
pub type Colour = [u8; 3];

/// The colour of lines and words.
pub const BLACK: Colour = [0, 0, 0];
/// Less important lines and words.
pub const GREY: Colour = [110, 118, 128];
/// Fills.
pub const PALE: Colour = [228, 232, 237];
/// Paper.
pub const WHITE: Colour = [255, 255, 255];
/// Warnings.
pub const RED: Colour = [196, 43, 36];

/// A4, upright, mm.
pub const A4: [f64; 2] = [210.0, 297.0];
/// US Letter, standing, mm.
pub const LETTER: [f64; 2] = [215.9, 279.4];
/// A2, lying, mm.
pub const A2: [f64; 2] = [594.0, 420.0];

/// A segment of a path, mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Segment {
    /// Lift the pen and go there.
    Move([f64; 2]),
    /// A straight line to there.
    Line([f64; 2]),
    /// A Bézier curve with two handles, to the last point.
    Curve([f64; 2], [f64; 2], [f64; 2]),
    /// Back to the start of this path.
    Close,
}

/// Style of a line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pen {
    /// Its colour.
    pub colour: Colour,
    /// Its width, mm.
    pub width: f64,
    /// Length of the dashes and of the gaps between them, mm; 0 for a line without gaps.
    pub dash: f64,
}

impl Pen {
    /// A plain line.
    pub const fn new(colour: Colour, width: f64) -> Pen {
        Pen { colour, width, dash: 0.0 }
    }

    /// A line of dashes.
    pub const fn dashed(colour: Colour, width: f64, dash: f64) -> Pen {
        Pen { colour, width, dash }
    }
}

#[derive(Clone, Debug, PartialEq)]
struct Shape {
    line: Vec<Segment>,
    fill: Option<Colour>,
    pen: Option<Pen>,
    words: Option<String>,
}

/// One page.
#[derive(Clone, Debug, PartialEq)]
pub struct Drawing {
    /// Its title.
    pub title: String,
    /// Width and height, mm.
    pub size: [f64; 2],
    shapes: Vec<Shape>,
    inset: Option<Inset>,
}

/// A part of another page, below the shapes of this one.
#[derive(Clone, Debug, PartialEq)]
struct Inset {
    shapes: Vec<Shape>,
    /// Corner with the smallest coordinates, and size, mm. Nothing outside is shown.
    at: [f64; 2],
    size: [f64; 2],
}

impl Drawing {
    /// An empty page.
    pub fn new(title: &str, size: [f64; 2]) -> Drawing {
        Drawing { title: title.to_string(), size, shapes: Vec::new(), inset: None }
    }

    /// Shows a part of another page below everything else: the rectangle at `from` of this size, at true
    /// scale, with its corner at `at`. It replaces an earlier one.
    pub fn inset(&mut self, page: &Drawing, from: [f64; 2], size: [f64; 2], at: [f64; 2]) {
        let moved = |[x, y]: [f64; 2]| [x - from[0] + at[0], y - from[1] + at[1]];
        let shapes = page.shapes.iter().map(|shape| {
            let line = shape.line.iter().map(|segment| match *segment {
                Segment::Move(p) => Segment::Move(moved(p)),
                Segment::Line(p) => Segment::Line(moved(p)),
                Segment::Curve(a, b, p) => Segment::Curve(moved(a), moved(b), moved(p)),
                Segment::Close => Segment::Close,
            });
            Shape { line: line.collect(), ..shape.clone() }
        });
        self.inset = Some(Inset { shapes: shapes.collect(), at, size });
    }

    /// Adds a path with its fill.
    pub fn path(&mut self, line: Vec<Segment>, fill: Option<Colour>, pen: Option<Pen>) {
        self.shapes.push(Shape { line, fill, pen, words: None });
    }

    /// Adds closed polygons; an inner one is a hole.
    pub fn polygons(&mut self, lines: &[Vec<[f64; 2]>], fill: Option<Colour>, pen: Option<Pen>) {
        let mut path = Vec::new();
        for line in lines {
            path.extend(
                line.iter().enumerate().map(|(index, &point)| {
                    if index == 0 { Segment::Move(point) } else { Segment::Line(point) }
                }),
            );
            path.push(Segment::Close);
        }
        self.path(path, fill, pen);
    }

    /// Adds straight lines from point to point.
    pub fn line(&mut self, points: &[[f64; 2]], pen: Pen) {
        let step = |(index, &point): (usize, &[f64; 2])| {
            if index == 0 { Segment::Move(point) } else { Segment::Line(point) }
        };
        self.path(points.iter().enumerate().map(step).collect(), None, Some(pen));
    }

    /// Adds a rectangle from its corner with the smallest coordinates and its size.
    pub fn rectangle(&mut self, at: [f64; 2], size: [f64; 2], fill: Option<Colour>, pen: Option<Pen>) {
        let [x, y] = at;
        let (right, bottom) = (x + size[0], y + size[1]);
        self.polygons(&[vec![[x, y], [right, y], [right, bottom], [x, bottom]]], fill, pen);
    }

    /// Adds a circle.
    pub fn circle(&mut self, at: [f64; 2], radius: f64, fill: Option<Colour>, pen: Option<Pen>) {
        let mut line = vec![Segment::Move([at[0] + radius, at[1]])];
        curve(&mut line, at, [radius; 2], 0.0, 2.0 * PI);
        line.push(Segment::Close);
        self.path(line, fill, pen);
    }

    /// Adds text with its baseline at y and capitals of height `height`.
    pub fn text(&mut self, at: [f64; 2], align: Align, height: f64, colour: Colour, words: &str) {
        let mut line = Vec::new();
        let width = strokes::draw(at, align, height, words, &mut |command, n| match (command, n) {
            ('M', &[x, y]) => line.push(Segment::Move([x, y])),
            ('L', &[x, y]) => line.push(Segment::Line([x, y])),
            ('C', &[a, b, c, d, x, y]) => line.push(Segment::Curve([a, b], [c, d], [x, y])),
            ('A', &[rx, ry, large, sweep, x, y]) => ellipse(&mut line, [rx, ry], [large, sweep], [x, y]),
            _ => {}
        });
        let pen = Pen::new(colour, width);
        self.shapes.push(Shape { line, fill: None, pen: Some(pen), words: Some(words.to_string()) });
    }

    /// Adds a 100 mm ruler from `at` to the right, to verify the scale of a print.
    pub fn ruler(&mut self, at: [f64; 2]) {
        let pen = Pen::new(BLACK, 0.2);
        let [x, y] = at;
        let mut line = vec![Segment::Move([x, y]), Segment::Line([x + 100.0, y])];
        for mark in 0..=100 {
            let length = if mark % 10 == 0 {
                4.0
            } else if mark % 5 == 0 {
                3.0
            } else {
                1.8
            };
            let x = x + f64::from(mark);
            line.extend([Segment::Move([x, y]), Segment::Line([x, y - length])]);
        }
        self.path(line, None, Some(pen));
        for mark in (0..=100).step_by(50) {
            let at = [x + f64::from(mark), y + 3.4];
            self.text(at, Align::Middle, 2.0, BLACK, &mark.to_string());
        }
        let words = "mm: printed at 100 %, this line is 100 mm long";
        self.text([x + 105.0, y + 0.2], Align::Left, 2.2, BLACK, words);
    }

    /// As SVG; one unit is 1 mm.
    pub fn svg(&self) -> String {
        let [width, height] = self.size;
        // Writing to a string does not fail.
        let mut svg = String::new();
        let _ = writeln!(
            svg,
            r#"<svg xmlns="http://www.w3.org/2000/svg" width="{width}mm" height="{height}mm" viewBox="0 0 {width} {height}" role="img">"#
        );
        let _ = writeln!(svg, "<title>{}</title>", strokes::escape(&self.title));
        let _ = writeln!(svg, "<rect width=\"{width}\" height=\"{height}\" fill=\"#ffffff\"/>");
        if let Some(Inset { shapes, at: [x, y], size: [width, height] }) = &self.inset {
            let _ = writeln!(
                svg,
                r#"<clipPath id="inset"><rect x="{x}" y="{y}" width="{width}" height="{height}"/></clipPath>"#
            );
            svg.push_str("<g clip-path=\"url(#inset)\">\n");
            Drawing::write_shapes(&mut svg, shapes);
            svg.push_str("</g>\n");
        }
        Drawing::write_shapes(&mut svg, &self.shapes);
        svg.push_str("</svg>\n");
        svg
    }

    fn write_shapes(svg: &mut String, shapes: &[Shape]) {
        for shape in shapes {
            svg.push_str("<path ");
            if let Some(words) = &shape.words {
                let _ = write!(svg, "aria-label=\"{}\" ", strokes::escape(words));
            }
            svg.push_str("d=\"");
            for segment in &shape.line {
                let _ = match segment {
                    Segment::Move(p) => write!(svg, "M{} {}", mm(p[0]), mm(p[1])),
                    Segment::Line(p) => write!(svg, "L{} {}", mm(p[0]), mm(p[1])),
                    Segment::Curve(a, b, p) => write!(
                        svg,
                        "C{} {} {} {} {} {}",
                        mm(a[0]),
                        mm(a[1]),
                        mm(b[0]),
                        mm(b[1]),
                        mm(p[0]),
                        mm(p[1])
                    ),
                    Segment::Close => write!(svg, "Z"),
                };
            }
            let colour = |colour: Option<Colour>| {
                colour.map_or("none".to_string(), |[r, g, b]| format!("#{r:02x}{g:02x}{b:02x}"))
            };
            let _ = write!(svg, "\" fill=\"{}\" fill-rule=\"evenodd\"", colour(shape.fill));
            if let Some(pen) = shape.pen {
                let _ = write!(
                    svg,
                    r#" stroke="{}" stroke-width="{}" stroke-linecap="round" stroke-linejoin="round""#,
                    colour(Some(pen.colour)),
                    mm(pen.width)
                );
                if pen.dash > 0.0 {
                    let _ = write!(svg, " stroke-dasharray=\"{0} {0}\"", mm(pen.dash));
                }
            }
            svg.push_str("/>\n");
        }
    }
}

/// Rounded to a tenth of a micrometre, finer than any printer.
fn mm(value: f64) -> f64 {
    (value * 1e4).round() / 1e4 + 0.0
}

/// Adds an arc of an axis-aligned ellipse between two angles, as curves of at most 90°.
fn curve(line: &mut Vec<Segment>, centre: [f64; 2], radii: [f64; 2], from: f64, to: f64) {
    let pieces = ((to - from).abs() / (PI / 2.0) - 1e-9).ceil().max(1.0);
    let step = (to - from) / pieces;
    let handle = 4.0 / 3.0 * (step / 4.0).tan();
    let mut angle = from;
    for _ in 0..pieces as u32 {
        let end = angle + step;
        let point = |angle: f64, along: f64| {
            let (sin, cos) = angle.sin_cos();
            [centre[0] + radii[0] * (cos - along * sin), centre[1] + radii[1] * (sin + along * cos)]
        };
        line.push(Segment::Curve(point(angle, handle), point(end, -handle), point(end, 0.0)));
        angle = end;
    }
}

/// Adds an arc from the end of the path to `to`, with SVG's parameters.
fn ellipse(line: &mut Vec<Segment>, radii: [f64; 2], [large, sweep]: [f64; 2], to: [f64; 2]) {
    let from = match line.last() {
        Some(Segment::Move(p) | Segment::Line(p) | Segment::Curve(_, _, p)) => *p,
        _ => to,
    };
    // On the unit circle.
    let (dx, dy) = ((to[0] - from[0]) / radii[0], (to[1] - from[1]) / radii[1]);
    let chord = dx.hypot(dy);
    if chord < 1e-9 {
        return;
    }
    let grow = (chord / 2.0).max(1.0);
    let radii = radii.map(|radius| radius * grow);
    let (dx, dy, chord) = (dx / grow, dy / grow, chord / grow);
    let height = (1.0 - chord * chord / 4.0).max(0.0).sqrt();
    let side = if (large > 0.5) == (sweep > 0.5) { 1.0 } else { -1.0 };
    // The centre, relative to the start of the arc.
    let cx = dx / 2.0 - side * -dy / chord * height;
    let cy = dy / 2.0 - side * dx / chord * height;
    let begin = (-cy).atan2(-cx);
    let end = (dy - cy).atan2(dx - cx);
    let mut turn = end - begin;
    if sweep > 0.5 && turn < 0.0 {
        turn += 2.0 * PI;
    } else if sweep < 0.5 && turn > 0.0 {
        turn -= 2.0 * PI;
    }
    let centre = [from[0] + cx * radii[0], from[1] + cy * radii[1]];
    curve(line, centre, radii, begin, begin + turn);
}

/// As PDF, one page per drawing. It asks the printing program not to scale it.
pub fn pdf(title: &str, pages: &[Drawing]) -> Vec<u8> {
    /// Points in a millimetre.
    const POINT: f64 = 72.0 / 25.4;
    #[allow(clippy::cast_possible_truncation)]
    let single = |value: f64| value as f32;
    let mut pdf = Pdf::new();
    let (catalogue, tree, info) = (Ref::new(1), Ref::new(2), Ref::new(3));
    let reference =
        |index: usize, which: i32| Ref::new(4 + 2 * i32::try_from(index).unwrap_or(i32::MAX / 4) + which);
    let mut root = pdf.catalog(catalogue);
    root.pages(tree);
    root.viewer_preferences().pair(Name(b"PrintScaling"), Name(b"None"));
    root.finish();
    pdf.document_info(info).title(TextStr(title));
    let kids = (0..pages.len()).map(|index| reference(index, 0));
    pdf.pages(tree).kids(kids).count(i32::try_from(pages.len()).unwrap_or(i32::MAX));
    for (index, drawing) in pages.iter().enumerate() {
        let [width, height] = drawing.size.map(|mm| single(mm * POINT));
        let mut page = pdf.page(reference(index, 0));
        page.media_box(Rect::new(0.0, 0.0, width, height)).parent(tree).contents(reference(index, 1));
        page.resources();
        page.finish();
        let mut content = Content::new();
        // From here on in mm, y down.
        content.transform([single(POINT), 0.0, 0.0, single(-POINT), 0.0, height]);
        content.set_line_cap(LineCapStyle::RoundCap).set_line_join(LineJoinStyle::RoundJoin);
        if let Some(Inset { shapes, at, size }) = &drawing.inset {
            let [[x, y], [width, height]] = [at, size].map(|it| it.map(|v| single(mm(v))));
            content.save_state().rect(x, y, width, height).clip_nonzero().end_path();
            shapes.iter().for_each(|shape| write_shape(&mut content, shape, single));
            content.restore_state();
        }
        for shape in &drawing.shapes {
            write_shape(&mut content, shape, single);
        }
        pdf.stream(reference(index, 1), &content.finish());
    }
    pdf.finish()
}

fn write_shape(content: &mut Content, shape: &Shape, single: impl Fn(f64) -> f32 + Copy) {
    let rgb = |colour: Colour| colour.map(|value| f32::from(value) / 255.0);
    if let Some([r, g, b]) = shape.fill.map(rgb) {
        content.set_fill_rgb(r, g, b);
    }
    if let Some(pen) = shape.pen {
        let [r, g, b] = rgb(pen.colour);
        content.set_stroke_rgb(r, g, b).set_line_width(single(mm(pen.width)));
        let dashes = (pen.dash > 0.0).then_some([single(pen.dash); 2]);
        content.set_dash_pattern(dashes.iter().flatten().copied(), 0.0);
    }
    let point = |p: &[f64; 2]| p.map(|v| single(mm(v)));
    for segment in &shape.line {
        match segment {
            Segment::Move(p) => {
                let [x, y] = point(p);
                content.move_to(x, y);
            }
            Segment::Line(p) => {
                let [x, y] = point(p);
                content.line_to(x, y);
            }
            Segment::Curve(a, b, p) => {
                let ([a0, a1], [b0, b1], [x, y]) = (point(a), point(b), point(p));
                content.cubic_to(a0, a1, b0, b1, x, y);
            }
            Segment::Close => {
                content.close_path();
            }
        }
    }
    match (shape.fill.is_some(), shape.pen.is_some()) {
        (true, true) => content.fill_even_odd_and_stroke(),
        (true, false) => content.fill_even_odd(),
        (false, true) => content.stroke(),
        (false, false) => content.end_path(),
    };
}
