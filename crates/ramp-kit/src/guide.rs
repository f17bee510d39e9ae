//! The assembly guide: one page per beam, with an exploded view, its parts in order and their
//! orientation.

use crate::beam::{Beam, Joint, Kit};
use crate::bill::length_words;
use crate::drawing::{A4, BLACK, Drawing, GREY, PALE, Pen, RED, WHITE};
use crate::joint::Side;
use crate::sheet::draw_tag;
use crate::solid::{self, Mesh, SolidError};
use crate::strokes::{self, Align};
use crate::tags;
use crate::view::View;
use nalgebra::Vector2;

/// Millimetres in a metre.
const MM: f64 = 1e3;
const LEFT: f64 = 18.0;
/// Gap between parts in the exploded view, mm of the beam.
const APART: f64 = 32.0;

/// The pages of the guide, one for each beam.
///
/// # Errors
/// A beam whose solid cannot be made.
pub fn guide(kit: &Kit) -> Result<Vec<Drawing>, SolidError> {
    kit.beams.iter().map(|beam| page(kit, beam)).collect()
}

fn page(kit: &Kit, beam: &Beam) -> Result<Drawing, SolidError> {
    let size = [A4[1], A4[0]];
    let mut drawing = Drawing::new(&format!("RAMP assembly guide, {}", beam.name), size);
    let height = strokes::fit(&beam.name, 7.0, 60.0);
    drawing.text([LEFT, 22.0], Align::Left, height, BLACK, &beam.name);
    let words = format!(
        "{} joints, {} of extrusion, {} screws; {} mm from the first hole to the last, {:.0} g",
        beam.joints.len(),
        if beam.links.len() == 1 { "1 length".to_string() } else { format!("{} lengths", beam.links.len()) },
        2 * beam.links.len(),
        length_words(beam.span()),
        beam.mass() * MM,
    );
    let x = LEFT + strokes::width(&beam.name, height) + 8.0;
    drawing.text([x, 22.0], Align::Left, 2.6, GREY, &words);
    exploded(&mut drawing, kit, beam)?;
    from_above(&mut drawing, kit, beam)?;
    table(&mut drawing, beam);
    steps(&mut drawing, beam);
    drawing.ruler([LEFT, size[1] - 9.0]);
    Ok(drawing)
}

/// The exploded view along the beam, from the left front, each part with its number.
fn exploded(drawing: &mut Drawing, kit: &Kit, beam: &Beam) -> Result<(), SolidError> {
    let pieces = solid::beam(beam, &kit.dimensions, APART)?;
    let meshes: Vec<Mesh> = pieces.iter().map(|piece| piece.solid.mesh()).collect();
    let room = Vector2::new(drawing.size[0] - 2.0 * LEFT, 62.0);
    let [low, high] = View::oblique(1.0).bounds(&meshes);
    let scale = (room.x / (high.x - low.x)).min(room.y / (high.y - low.y));
    let view = View::oblique(scale);
    let [low, high] = view.bounds(&meshes);
    let shift = Vector2::new(LEFT, 34.0) - low + (room - (high - low)) / 2.0;
    for [a, b] in view.lines(&meshes) {
        let (a, b) = (a + shift, b + shift);
        drawing.line(&[[a.x, a.y], [b.x, b.y]], Pen::new(BLACK, 0.18));
    }
    // The assembly line between the parts.
    for pair in meshes.windows(2) {
        let (before, after) = (pair[0].bounds()[1][0], pair[1].bounds()[0][0]);
        let at = |x: f64| view.at(&nalgebra::Vector3::new(x, 0.0, 0.0)) + shift;
        let (a, b) = (at(before + 2.0), at(after - 2.0));
        if after > before + 4.0 {
            drawing.line(&[[a.x, a.y], [b.x, b.y]], Pen::dashed(GREY, 0.15, 1.2));
        }
    }
    let mut number = 0;
    for (piece, mesh) in pieces.iter().zip(&meshes) {
        let [low, high] = view.bounds(std::slice::from_ref(mesh));
        let middle = (low + high) / 2.0 + shift;
        if piece.link {
            let length = beam.links.iter().find(|link| link.name == piece.name).map(|link| link.length);
            let words = length.map(length_words).unwrap_or_default();
            drawing.text([middle.x, low.y + shift.y - 2.0], Align::Middle, 2.3, GREY, &words);
        } else {
            number += 1;
            numbered(drawing, [middle.x, low.y + shift.y - 5.0], number);
        }
    }
    Ok(())
}

fn numbered(drawing: &mut Drawing, at: [f64; 2], number: usize) {
    drawing.circle(at, 3.0, Some(WHITE), Some(Pen::new(BLACK, 0.3)));
    drawing.text([at[0], at[1] + 1.4], Align::Middle, 2.8, BLACK, &number.to_string());
}

/// The assembled beam from above, with its tags and the positions of its holes.
fn from_above(drawing: &mut Drawing, kit: &Kit, beam: &Beam) -> Result<(), SolidError> {
    let pieces = solid::beam(beam, &kit.dimensions, 0.0)?;
    let room = drawing.size[0] - 2.0 * LEFT;
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    for piece in &pieces {
        let [from, to] = piece.solid.mesh().bounds();
        (low, high) = (low.min(from[0]), high.max(to[0]));
    }
    let scale = (room / (high - low)).min(0.6);
    let (left, middle) = (LEFT + (room - (high - low) * scale) / 2.0, 122.0);
    // As it lies on the sheet: a beam that starts flipped has its tags on what was its underside.
    let flipped = beam.start.is_some_and(|start| start.flipped);
    let up = if flipped { -1.0 } else { 1.0 };
    let at = |[x, y]: [f64; 2]| [left + (x - low) * scale, middle - up * y * scale];
    let on_paper = |lines: Vec<Vec<[f64; 2]>>| -> Vec<Vec<[f64; 2]>> {
        lines.into_iter().map(|line| line.into_iter().map(at).collect()).collect()
    };
    for links in [true, false] {
        let fill = if links { WHITE } else { PALE };
        for piece in pieces.iter().filter(|piece| piece.link == links) {
            let pen = Pen::new(BLACK, 0.2);
            drawing.polygons(&on_paper(piece.solid.outline()), Some(fill), Some(pen));
        }
    }
    for (index, joint) in beam.joints.iter().enumerate() {
        let hole = at([joint.offset * MM, 0.0]);
        numbered(drawing, [hole[0], middle - 15.5], index + 1);
        let words = length_words(joint.offset);
        drawing.text([hole[0], middle + 16.0], Align::Middle, 2.2, GREY, &words);
        if let Some(opens) = joint.opens {
            let y = |depth: f64| middle - up * opens.sign() * depth * scale;
            let pen = Pen::new(RED, 0.35);
            let x = hole[0];
            drawing.line(&[[x, y(6.0)], [x, y(19.0)]], pen);
            drawing.line(&[[x - 1.2, y(16.0)], [x, y(19.0)], [x + 1.2, y(16.0)]], pen);
        }
        let Some((tag, inwards)) = joint.tag.zip(joint.kind.tag_offset()) else { continue };
        let (inwards, turn) = if index == 0 { (inwards, 1) } else { (-inwards, 3) };
        let centre = at([joint.offset * MM + inwards * MM, 0.0]);
        let half = tags::STICKER * MM / 2.0 * scale;
        let corner = [centre[0] - half, centre[1] - half];
        drawing.rectangle(corner, [2.0 * half; 2], Some(WHITE), Some(Pen::new(GREY, 0.15)));
        draw_tag(drawing, tag, centre, tags::BLACK_EDGE * MM * scale, turn);
        drawing.text([centre[0], middle + 16.0], Align::Middle, 2.2, BLACK, &format!("tag {tag}"));
    }
    let lies = if flipped { ", as it lies on the sheet: flipped" } else { "" };
    let words = format!("from above{lies}; numbers below the holes: mm from the first hole");
    drawing.text([LEFT, middle - 22.0], Align::Left, 2.2, GREY, &words);
    Ok(())
}

/// The table of parts by position along the beam.
fn table(drawing: &mut Drawing, beam: &Beam) {
    const COLUMNS: [f64; 5] = [0.0, 10.0, 34.0, 68.0, 108.0];
    let top = 147.0;
    let row_height = (44.0 / (beam.joints.len() as f64 + beam.links.len() as f64)).min(4.6);
    let size = (row_height * 0.52).min(2.4);
    for (x, words) in COLUMNS.iter().zip(["", "name", "part", "which way", "tag"]) {
        drawing.text([LEFT + x, top], Align::Left, 2.4, GREY, words);
    }
    let end = LEFT + 140.0;
    drawing.line(&[[LEFT, top + 1.6], [end, top + 1.6]], Pen::new(GREY, 0.15));
    let mut y = top + 1.6;
    for (index, joint) in beam.joints.iter().enumerate() {
        y += row_height;
        let mut put = |column: usize, words: &str| {
            let room = COLUMNS.get(column + 1).unwrap_or(&140.0) - COLUMNS[column] - 2.0;
            let at = [LEFT + COLUMNS[column], y];
            drawing.text(at, Align::Left, strokes::fit(words, size, room), BLACK, words);
        };
        put(0, &(index + 1).to_string());
        put(1, &joint.name);
        put(2, joint.kind.name());
        put(3, &way(joint));
        put(4, &joint.tag.map_or("–".to_string(), |tag| format!("{tag}, top outwards")));
        let Some(link) = beam.links.get(index) else { continue };
        y += row_height;
        let words = format!("extrusion {} mm, screwed at both ends", length_words(link.length));
        drawing.text([LEFT + COLUMNS[1], y], Align::Left, size, GREY, &link.name);
        drawing.text([LEFT + COLUMNS[2], y], Align::Left, size, GREY, &words);
    }
}

/// The orientation of a joint.
fn way(joint: &Joint) -> String {
    let form = joint.kind.form();
    match joint.opens {
        Some(Side::Left) => "open to the left",
        Some(Side::Right) => "open to the right",
        None if form.feet => "plate up, feet down",
        None if form.male && form.end => "plate for the tag up",
        None => "either way",
    }
    .to_string()
}

fn steps(drawing: &mut Drawing, beam: &Beam) {
    let (x, mut y) = (176.0, 147.0);
    drawing.text([x, y], Align::Left, 2.4, GREY, "in this order");
    drawing.line(&[[x, y + 1.6], [drawing.size[0] - LEFT, y + 1.6]], Pen::new(GREY, 0.15));
    let (first, last) = (beam.joints.first(), beam.joints.last());
    let name = |joint: Option<&Joint>| joint.map_or(String::new(), |joint| joint.name.clone());
    let mut lines = vec![
        format!("1  Lay {} to your left and {} to your right.", name(first), name(last)),
        "2  Put a T-slot nut into the slot on each screw's side.".to_string(),
        "3  Push every extrusion home to the socket's floor.".to_string(),
        "4  Check the ways of the joints against the table:".to_string(),
        "    left and right as seen from the first joint.".to_string(),
        "5  Tighten one M5 x 8 screw in each socket on a flat".to_string(),
        "    table, so that the beam does not twist.".to_string(),
        "6  Stick on the tags, their tops towards the ends.".to_string(),
    ];
    if beam.start.is_none() {
        lines.push("7  Clamp it to the table; it is not on the sheet.".to_string());
    } else if beam.start.is_some_and(|start| start.flipped) {
        lines.push("7  It starts flipped: turn it over before step 6, so".to_string());
        lines.push("    that the tags are up as it lies on the sheet.".to_string());
    }
    y += 1.6;
    for line in lines {
        y += 4.6;
        drawing.text([x, y], Align::Left, 2.3, BLACK, &line);
    }
}
