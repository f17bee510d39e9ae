//! The sheets that are printed on paper: the start sheet for the parts, the tags to stick on them,
//! and the calibration sheet for the cameras.
//!
//! The start sheet is drawn from above: its left edge is next to the robot's base, its upper edge
//! to the robot's left. Beams are drawn with their true outlines, so a part laid into its outline
//! has its pose in the kit file.

use crate::beam::{Beam, Holder, Kit, Link, StartPose};
use crate::board;
use crate::dimensions::HOLE_RADIUS;
use crate::drawing::{BLACK, Drawing, GREY, Pen, RED, WHITE};
use crate::solid::{self, Solid, SolidError};
use crate::strokes::{self, Align};
use crate::tags;

/// Millimetres in a metre.
const MM: f64 = 1e3;
const OUTLINE: Pen = Pen::new(BLACK, 0.3);
const INNER: Pen = Pen::new(GREY, 0.15);

/// The start sheet of a kit.
///
/// # Errors
/// A beam whose solid cannot be made.
pub fn start_sheet(kit: &Kit) -> Result<Drawing, SolidError> {
    let mut drawing = start_sheet_without_tag(kit)?;
    let sheet = &kit.sheet;
    let [x, y] = sheet.tag.map(|v| v * MM);
    draw_tag(&mut drawing, 0, [x, y], sheet.tag_edge * MM, 0);
    let label = y + sheet.tag_edge * MM * tags::CELLS as f64 / tags::BLACK_CELLS as f64 / 2.0 + 1.5;
    let words = format!("tag 0 of the sheet, black edge {} mm", sheet.tag_edge * MM);
    drawing.text([x, label], Align::Middle, 2.4, GREY, &words);
    Ok(drawing)
}

/// The same without its own tag.
///
/// # Errors
/// As [`start_sheet`].
pub fn start_sheet_without_tag(kit: &Kit) -> Result<Drawing, SolidError> {
    let sheet = &kit.sheet;
    let mut drawing = Drawing::new("RAMP start sheet", sheet.size.map(|edge| edge * MM));
    for beam in &kit.beams {
        if let Some(start) = beam.start {
            draw_beam(&mut drawing, kit, beam, start)?;
        }
    }
    for holder in &kit.holders {
        draw_holder(&mut drawing, kit, holder);
    }
    draw_legend(&mut drawing, kit);
    Ok(drawing)
}

fn draw_beam(drawing: &mut Drawing, kit: &Kit, beam: &Beam, start: StartPose) -> Result<(), SolidError> {
    let [x0, y0] = start.at.map(|v| v * MM);
    // Sheet y points down, so a beam that is not flipped has its +y upwards.
    let side = if start.flipped { 1.0 } else { -1.0 };
    let on_sheet = |[x, y]: [f64; 2]| [x0 + x, y0 + side * y];
    let moved = |lines: Vec<Vec<[f64; 2]>>| -> Vec<Vec<[f64; 2]>> {
        lines.into_iter().map(|line| line.into_iter().map(on_sheet).collect()).collect()
    };
    let pieces = solid::beam(beam, &kit.dimensions, 0.0)?;
    for piece in pieces.iter().filter(|piece| !piece.link) {
        drawing.polygons(&moved(piece.solid.outline()), None, Some(INNER));
    }
    let solids: Vec<Solid> = pieces.into_iter().map(|piece| piece.solid).collect();
    drawing.polygons(&moved(Solid::union(&solids).outline()), None, Some(OUTLINE));
    for (index, joint) in beam.joints.iter().enumerate() {
        let at = on_sheet([joint.offset * MM, 0.0]);
        if index == 0 {
            drawing.circle(at, HOLE_RADIUS * MM - 0.8, Some(RED), None);
        }
        if let Some(opens) = joint.opens {
            // An arrow out of the open side.
            let y = |depth: f64| at[1] + side * opens.sign() * depth;
            let x = at[0];
            let pen = Pen::new(GREY, 0.35);
            drawing.line(&[[x - 2.0, y(8.2)], [x, y(10.6)], [x + 2.0, y(8.2)]], pen);
        }
        let Some((tag, inwards)) = joint.tag.zip(joint.kind.tag_offset()) else { continue };
        let inwards = if index == 0 { inwards } else { -inwards } * MM;
        let centre = on_sheet([joint.offset * MM + inwards, 0.0]);
        let half = tags::STICKER * MM / 2.0;
        let corner = [centre[0] - half, centre[1] - half];
        drawing.rectangle(corner, [2.0 * half; 2], None, Some(Pen::dashed(GREY, 0.15, 1.0)));
        drawing.text([centre[0], centre[1] + 1.2], Align::Middle, 2.4, GREY, &format!("tag {tag}"));
    }
    let first = on_sheet([0.0, 0.0]);
    // The name of the first end beside its dot; the beam's own on its longest bare section.
    if let Some(joint) = beam.joints.first() {
        // Under the tag of a male end, in the neck of a female: away from the part's hole.
        drawing.text(
            [first[0] + 7.0, first[1] + 1.6],
            Align::Left,
            3.2,
            RED,
            &short(&joint.name, &beam.name),
        );
    }
    let room = |link: &Link| link.grasp[1] - link.grasp[0];
    if let Some(link) = beam.links.iter().max_by(|a, b| room(a).total_cmp(&room(b))) {
        let at = on_sheet([(link.grasp[0] + link.grasp[1]) / 2.0 * MM, 0.0]);
        let height = strokes::fit(&beam.name, 7.0, room(link) * MM - 4.0);
        drawing.text([at[0], at[1] + height / 2.0], Align::Middle, height, BLACK, &beam.name);
    }
    if start.flipped {
        // Beside the hole in the middle of the beam.
        let middle = beam.joints.get(beam.joints.len() / 2).map_or(0.0, |joint| joint.offset * MM);
        let at = on_sheet([middle + 7.0, 0.0]);
        drawing.text([at[0], at[1] + 1.6], Align::Left, 3.2, RED, "flipped");
    }
    Ok(())
}

/// A joint's name without its beam's: `j1` of `b4j1`.
fn short(name: &str, beam: &str) -> String {
    name.strip_prefix(beam).filter(|rest| !rest.is_empty()).unwrap_or(name).to_string()
}

fn draw_holder(drawing: &mut Drawing, kit: &Kit, holder: &Holder) {
    let [x, y] = holder.centre.map(|v| v * MM);
    let [width, depth] = Holder::BASE.map(|v| v * MM);
    drawing.rectangle([x - width / 2.0, y - depth / 2.0], [width, depth], None, Some(OUTLINE));
    drawing.text([x, y + depth / 2.0 - 2.5], Align::Middle, 3.6, BLACK, &holder.name);
    for peg in kit.pegs.iter().filter(|peg| peg.holder == holder.name) {
        let at = [x + f64::from(peg.slot) * Holder::PITCH * MM, y];
        drawing.circle(at, HOLE_RADIUS * MM, None, Some(INNER));
        let words = format!("{}, tag {}", peg.name, peg.tag);
        drawing.text([at[0], y - 7.5], Align::Middle, 2.4, GREY, &words);
    }
}

/// Instructions, in the largest free corner of the benchmark's layout, the lower left one.
fn draw_legend(drawing: &mut Drawing, kit: &Kit) {
    let [_, height] = drawing.size;
    let (x, y) = (14.0, height - 44.0);
    drawing.text([x, y], Align::Left, 4.2, BLACK, "RAMP start sheet");
    let [left, top] = kit.sheet.corner.map(|v| v * MM);
    let lines = [
        "Lay every beam into its outline, the end j1 on the red dot; arrows show open sides.".to_string(),
        "A beam that is marked flipped lies turned by 180° about its own length.".to_string(),
        format!(
            "The lower left corner lies {left:.0} mm in front (x) and {:.0} mm to the left (y) of the robot's base;",
            top - height
        ),
        "the lower edge points straight away from the robot (x), the left edge to its left (y).".to_string(),
    ];
    for (index, line) in lines.iter().enumerate() {
        drawing.text([x, y + 6.0 + 4.4 * index as f64], Align::Left, 2.5, BLACK, line);
    }
    drawing.ruler([x, height - 10.0]);
    // The corner itself, with the two directions.
    let pen = Pen::new(RED, 0.4);
    let corner = [4.0, height - 4.0];
    for (end, barbs, name, at) in [
        ([16.0, corner[1]], [[14.0, corner[1] - 1.2], [14.0, corner[1] + 1.2]], "x", [18.0, corner[1] + 1.2]),
        (
            [corner[0], height - 16.0],
            [[corner[0] - 1.2, height - 14.0], [corner[0] + 1.2, height - 14.0]],
            "y",
            [corner[0] - 1.0, height - 18.5],
        ),
    ] {
        drawing.line(&[corner, end], pen);
        drawing.line(&[barbs[0], end, barbs[1]], pen);
        drawing.text(at, Align::Left, 3.0, RED, name);
    }
}

/// A tag centred at `at`; `edge` is its black edge, mm, `turn` its rotation in quarters
/// anticlockwise.
pub(crate) fn draw_tag(drawing: &mut Drawing, id: u32, at: [f64; 2], edge: f64, turn: u32) {
    let Some(cells) = tags::cells(id) else { return };
    let cell = edge / tags::BLACK_CELLS as f64;
    let half = edge / 2.0;
    drawing.rectangle([at[0] - half, at[1] - half], [edge; 2], Some(BLACK), None);
    let turned = |row: usize, column: usize| {
        let last = tags::CELLS - 1;
        (0..turn).fold((row, column), |(row, column), _| (last - column, row))
    };
    // White cells on the black square. They are drawn exactly: enlarging one towards white
    // neighbours would cover black ones.
    let black = 1..=tags::BLACK_CELLS;
    for (row, line) in cells.iter().enumerate().filter(|(row, _)| black.contains(row)) {
        for (column, _) in line.iter().enumerate().filter(|(column, cell)| black.contains(column) && !**cell)
        {
            let (r, c) = turned(row, column);
            let corner = |index: usize, at: f64| at - half + (index as f64 - 1.0) * cell;
            drawing.rectangle([corner(c, at[0]), corner(r, at[1])], [cell; 2], Some(WHITE), None);
        }
    }
}

/// A sticker: its tag, its part, and its position on the page.
struct Sticker {
    id: u32,
    name: String,
    place: String,
}

/// The stickers of a kit, on as many pages of this size (mm) as needed.
pub fn tag_sheets(kit: &Kit, paper: [f64; 2]) -> Vec<Drawing> {
    const COLUMNS: usize = 5;
    const PITCH: [f64; 2] = [36.0, 40.0];
    const FIRST: [f64; 2] = [33.0, 50.0];
    /// Room for the last row's words and the ruler, mm.
    const BELOW: f64 = 36.5;
    let rows = 1 + ((paper[1] - FIRST[1] - BELOW) / PITCH[1]) as usize;
    let on_page = COLUMNS * rows;
    let mut stickers = Vec::new();
    for beam in &kit.beams {
        for joint in &beam.joints {
            if let Some(id) = joint.tag {
                let place = format!("on {}", joint.kind.name());
                stickers.push(Sticker { id, name: joint.name.clone(), place });
            }
        }
    }
    for peg in &kit.pegs {
        stickers.push(Sticker { id: peg.tag, name: peg.name.clone(), place: "on the head".into() });
    }
    let count = stickers.len().div_ceil(on_page);
    let page = |(number, stickers): (usize, &[Sticker])| {
        let title = format!("RAMP tags, page {} of {count}", number + 1);
        let mut drawing = Drawing::new(&title, paper);
        drawing.text([20.0, 20.0], Align::Left, 4.2, BLACK, &title);
        let words = "AprilTags tag25h9, black edge 19 mm, on stickers of 25 mm: cut along the marks.";
        drawing.text([20.0, 26.0], Align::Left, 2.5, BLACK, words);
        let words = "On a beam, the small triangle points out of the beam, towards its end.";
        drawing.text([20.0, 30.4], Align::Left, 2.5, BLACK, words);
        for (index, sticker) in stickers.iter().enumerate() {
            let (column, row) = ((index % COLUMNS) as f64, (index / COLUMNS) as f64);
            draw_sticker(&mut drawing, sticker, [FIRST[0] + PITCH[0] * column, FIRST[1] + PITCH[1] * row]);
        }
        drawing.ruler([20.0, paper[1] - 12.0]);
        drawing
    };
    stickers.chunks(on_page).enumerate().map(page).collect()
}

fn draw_sticker(drawing: &mut Drawing, sticker: &Sticker, at: [f64; 2]) {
    const MARK: f64 = 2.5;
    draw_tag(drawing, sticker.id, at, tags::BLACK_EDGE * MM, 0);
    let half = tags::STICKER * MM / 2.0;
    let pen = Pen::new(BLACK, 0.1);
    for x in [-1.0, 1.0] {
        for y in [-1.0, 1.0] {
            // Outside the sticker, so that no ink of the marks is on it.
            let corner = [at[0] + x * half, at[1] + y * half];
            drawing.line(&[[corner[0] + x * 0.4, corner[1]], [corner[0] + x * MARK, corner[1]]], pen);
            drawing.line(&[[corner[0], corner[1] + y * 0.4], [corner[0], corner[1] + y * MARK]], pen);
        }
    }
    let top = at[1] - half - 0.8;
    let triangle = vec![[at[0] - 1.3, top], [at[0] + 1.3, top], [at[0], top - 2.0]];
    drawing.polygons(&[triangle], Some(GREY), None);
    let below = at[1] + half;
    let words = format!("{} · {}", sticker.name, sticker.id).replace('·', "–");
    drawing.text([at[0], below + 4.6], Align::Middle, strokes::fit(&words, 2.6, 24.0), BLACK, &words);
    let size = strokes::fit(&sticker.place, 2.0, 28.0);
    drawing.text([at[0], below + 8.0], Align::Middle, size, GREY, &sticker.place);
}

/// The calibration sheet, in the middle of a page of this size (mm).
pub fn calibration_sheet(paper: [f64; 2]) -> Drawing {
    let mut drawing = Drawing::new("RAMP calibration sheet", paper);
    let middle = paper.map(|edge| edge / 2.0);
    for place in board::places() {
        let at = place.x_pg.translation.vector * MM;
        draw_tag(&mut drawing, place.id, [middle[0] + at.x, middle[1] - at.y], place.edge * MM, 0);
    }
    let left = middle[0] - board::COLUMNS as f64 / 2.0 * board::PITCH * MM;
    let words = format!(
        "RAMP calibration sheet: AprilTags tag25h9, black edge {} mm, {} mm apart. Glue it flat on a stiff board.",
        board::EDGE * MM,
        board::PITCH * MM
    );
    drawing.text([left, 10.0], Align::Left, 2.8, BLACK, &words);
    drawing.ruler([left, paper[1] - 8.0]);
    drawing
}
