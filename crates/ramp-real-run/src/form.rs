//! The printed form for the scorer with a stopwatch: the goal's picture and a row for each of its
//! connections.

use nalgebra::Point3;
use ramp_assembly::Assembly;
use ramp_kit::drawing::{A4, BLACK, Drawing, GREY, PALE, Pen, WHITE};
use ramp_kit::solid::{self, SolidError};
use ramp_kit::strokes::{self, Align};

use ramp_result::episode::RULES;

/// Millimetres in a metre.
const MM: f64 = 1e3;
const LEFT: f64 = 16.0;
/// Columns for repeats.
const REPEATS: usize = 5;
/// Width of the column of names, mm.
const NAMES: f64 = 48.0;
const ROW: f64 = 7.4;

/// Closed lines, mm.
type Outlines = Vec<Vec<[f64; 2]>>;

/// One page, A4 portrait. With more connections than fit below the picture, the rows get lower.
///
/// # Errors
/// A beam whose solid cannot be made.
pub fn form(goal: &Assembly) -> Result<Drawing, SolidError> {
    let mut page = Drawing::new(&format!("RAMP stopwatch form, {}", goal.name), A4);
    let right = A4[0] - LEFT;
    let title = format!("{}: times of a real robot", goal.name);
    page.text([LEFT, 22.0], Align::Left, strokes::fit(&title, 6.0, right - LEFT), BLACK, &title);
    let about = format!(
        "class {}, {} beams, {} pegs; {RULES}",
        goal.class.map_or("none".to_string(), |class| class.name()),
        goal.beams.len(),
        goal.connections.len()
    );
    page.text([LEFT, 28.5], Align::Left, 2.6, GREY, &about);
    blanks(&mut page);
    picture(&mut page, goal)?;
    let bottom = table(&mut page, goal);
    rules(&mut page, bottom + 7.0);
    Ok(page)
}

/// Lines to write on.
fn blanks(page: &mut Drawing) {
    let half = (A4[0] - 2.0 * LEFT - 8.0) / 2.0;
    let fields = [
        ["agent and version", "robot and gripper"],
        ["computer and threads", "track"],
        ["scored by", "date and place"],
    ];
    for (row, names) in fields.iter().enumerate() {
        let y = 38.5 + 8.5 * row as f64;
        for (column, name) in names.iter().enumerate() {
            let x = LEFT + (half + 8.0) * column as f64;
            page.text([x, y], Align::Left, 2.3, GREY, name);
            let from = x + 37.0;
            page.line(&[[from, y + 0.8], [x + half, y + 0.8]], Pen::new(GREY, 0.15));
        }
    }
}

/// The goal from above: the robot's base is at the bottom, the clamped beam grey.
fn picture(page: &mut Drawing, goal: &Assembly) -> Result<(), SolidError> {
    // Clamped or not, height, outlines.
    let mut shapes: Vec<(bool, f64, Outlines)> = Vec::new();
    for (index, placed) in goal.beams.iter().enumerate() {
        for piece in solid::beam(&placed.beam, &goal.kit.dimensions, 0.0)? {
            let in_a = |[x, y]: [f64; 2]| {
                let p = placed.x_ab * Point3::new(x / MM, y / MM, 0.0);
                [p.x * MM, p.y * MM]
            };
            let outline = piece.solid.outline();
            let lines = outline.into_iter().map(|line| line.into_iter().map(in_a).collect()).collect();
            // Joints are drawn over links, because the scorer looks for joints.
            let height = placed.x_ab.translation.z + if piece.link { 0.0 } else { 1.0 };
            shapes.push((index == goal.base, height, lines));
        }
    }
    shapes.sort_by(|a, b| a.1.total_cmp(&b.1));
    let points = || shapes.iter().flat_map(|(_, _, lines)| lines.iter().flatten());
    let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    for point in points() {
        for axis in 0..2 {
            low[axis] = low[axis].min(point[axis]);
            high[axis] = high[axis].max(point[axis]);
        }
    }
    let room = [A4[0] - 2.0 * LEFT, 84.0];
    let top = 66.0;
    let scale = (room[0] / (high[0] - low[0]).max(1.0)).min(room[1] / (high[1] - low[1]).max(1.0)).min(0.6);
    let middle = [(low[0] + high[0]) / 2.0, (low[1] + high[1]) / 2.0];
    let at = |[x, y]: [f64; 2]| {
        [A4[0] / 2.0 + (x - middle[0]) * scale, top + room[1] / 2.0 - (y - middle[1]) * scale]
    };
    for (base, _, lines) in &shapes {
        let on_paper: Vec<Vec<[f64; 2]>> =
            lines.iter().map(|line| line.iter().map(|p| at(*p)).collect()).collect();
        page.polygons(&on_paper, Some(if *base { PALE } else { WHITE }), Some(Pen::new(BLACK, 0.2)));
    }
    for placed in &goal.beams {
        let [.., one, two] = placed.beam.joints.as_slice() else { continue };
        // On the last link, where no joint is in the way.
        let p = placed.x_ab * Point3::new((one.offset + two.offset) / 2.0, 0.0, 0.0);
        let [x, y] = at([p.x * MM, p.y * MM]);
        page.text([x, y + 1.0], Align::Middle, 2.2, BLACK, &placed.beam.name);
    }
    for (index, connection) in goal.connections.iter().enumerate() {
        let p = goal.p_a_hole(connection.female);
        let [x, y] = at([p.x * MM, p.y * MM]);
        page.circle([x, y], 2.9, Some(WHITE), Some(Pen::new(BLACK, 0.35)));
        page.text([x, y + 1.1], Align::Middle, 2.2, BLACK, &(index + 1).to_string());
    }
    page.text(
        [A4[0] / 2.0, top + room[1] + 5.0],
        Align::Middle,
        2.2,
        GREY,
        "from above, away from the robot upwards; grey is clamped; the numbers are those of the lines below",
    );
    Ok(())
}

/// The table; returns the y coordinate of its end.
fn table(page: &mut Drawing, goal: &Assembly) -> f64 {
    let right = A4[0] - LEFT;
    let top = 161.0;
    let rows = goal.connections.len() + 4;
    let row = ROW.min((A4[1] - 36.0 - top) / rows as f64);
    let size = (row * 0.36).min(2.5);
    let width = (right - LEFT - NAMES) / REPEATS as f64;
    let mut names = vec!["planning over".to_string()];
    for (index, connection) in goal.connections.iter().enumerate() {
        let joints = [connection.female, connection.male].map(|joint| goal.joint_name(joint));
        names.push(format!("{}  {}  {}", index + 1, connection.name, joints.join("-")));
    }
    names.extend(["end".to_string(), "why it ended".to_string()]);
    page.text([LEFT, top + row - 2.0], Align::Left, size, GREY, "time since the goal was given");
    for repeat in 0..REPEATS {
        let x = LEFT + NAMES + width * (repeat as f64 + 0.5);
        page.text([x, top + row - 2.0], Align::Middle, size, GREY, &format!("repeat {}", repeat + 1));
    }
    let pen = Pen::new(BLACK, 0.18);
    for (index, name) in names.iter().enumerate() {
        let y = top + row * (index + 1) as f64;
        page.line(&[[LEFT, y], [right, y]], pen);
        let height = strokes::fit(name, size, NAMES - 3.0);
        page.text([LEFT + 1.0, y + row * 0.62], Align::Left, height, BLACK, name);
    }
    let bottom = top + row * (names.len() + 1) as f64;
    page.line(&[[LEFT, bottom], [right, bottom]], pen);
    for repeat in 0..=REPEATS {
        let x = LEFT + NAMES + width * repeat as f64;
        page.line(&[[x, top + row], [x, bottom]], pen);
    }
    bottom
}

/// The rules for the scorer.
fn rules(page: &mut Drawing, top: f64) {
    let lines = [
        "The watch starts when the goal is handed over and never stops. Write when each peg is home: head on the female's",
        "plate, within 0.5 mm, through both joints. Strike out a peg that does not stay so to the end.",
        "A hand on the robot or a part ends the repeat. So does 30 minutes after planning.",
    ];
    for (index, line) in lines.iter().enumerate() {
        page.text([LEFT, top + 4.2 * index as f64], Align::Left, 2.2, BLACK, line);
    }
    let mut y = top + 4.2 * lines.len() as f64 + 6.0;
    if y + 2.0 * ROW < A4[1] - 14.0 {
        page.text([LEFT, y], Align::Left, 2.3, GREY, "faults, pegs that came out: repeat, time, what it was");
        while y + ROW < A4[1] - 14.0 {
            y += ROW;
            page.line(&[[LEFT, y], [A4[0] - LEFT, y]], Pen::new(GREY, 0.15));
        }
    }
}
