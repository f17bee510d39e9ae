//! The bill of parts: everything a lab prints, buys and saws.

use crate::beam::Kit;
use crate::dimensions::{EXTRUSION_MASS, PLA_DENSITY};
use crate::joint::JointType;
use crate::solid::{self, Solid, SolidError};
use ramp_source::cell;
use std::fmt::Write;

/// One line of the bill of parts.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// `printed`, `sawn`, `bought` or `paper`.
    pub source: &'static str,
    /// The part.
    pub part: String,
    /// Number of pieces.
    pub count: usize,
    /// Mass of one piece, g, where it is known.
    pub mass: Option<f64>,
    /// Advice for the buyer.
    pub note: String,
}

/// A printed part and its count.
#[derive(Clone)]
pub struct Printed {
    /// Its name, also that of its file.
    pub name: String,
    /// Its solid, mm.
    pub solid: Solid,
    /// Number needed for the kit.
    pub count: usize,
    /// Orientation for printing without supports, degrees about x, y and z.
    pub lay: [f64; 3],
}

/// The joint types of a kit, the benchmark's first, and the count of each.
pub fn joint_counts(kit: &Kit) -> Vec<(JointType, usize)> {
    let mut counts: Vec<(JointType, usize)> = JointType::ALL.into_iter().map(|kind| (kind, 0)).collect();
    for joint in kit.beams.iter().flat_map(|beam| &beam.joints) {
        match counts.iter_mut().find(|(kind, _)| *kind == joint.kind) {
            Some((_, count)) => *count += 1,
            None => counts.push((joint.kind, 1)),
        }
    }
    counts.retain(|(_, count)| *count > 0);
    counts
}

/// The lengths of extrusion of a kit, m, shortest first, and the count of each.
pub fn lengths(kit: &Kit) -> Vec<(f64, usize)> {
    let mut lengths: Vec<f64> =
        kit.beams.iter().flat_map(|beam| &beam.links).map(|link| link.length).collect();
    lengths.sort_by(f64::total_cmp);
    let mut counts: Vec<(f64, usize)> = Vec::new();
    for length in lengths {
        match counts.last_mut() {
            // Lengths within a hundredth of a millimetre are the same cut.
            Some((last, count)) if (length - *last).abs() < 1e-5 => *count += 1,
            _ => counts.push((length, 1)),
        }
    }
    counts
}

/// All printed parts.
///
/// # Errors
/// Dimensions that give no valid part.
pub fn printed(kit: &Kit) -> Result<Vec<Printed>, SolidError> {
    let d = &kit.dimensions;
    let mut parts = Vec::new();
    for (kind, count) in joint_counts(kit) {
        // A male end is printed on the plate that carries its tag.
        let upside_down = kind.is_male() && kind.is_end();
        let lay = [if upside_down { 180.0 } else { 0.0 }, 0.0, 0.0];
        parts.push(Printed { name: kind.name().into(), solid: solid::joint(kind, d)?, count, lay });
    }
    let mut push = |name: &str, solid: Solid, count: usize, lay: [f64; 3]| {
        if count > 0 {
            parts.push(Printed { name: name.into(), solid, count, lay });
        }
    };
    push("peg", solid::peg(d)?, kit.pegs.len(), [180.0, 0.0, 0.0]);
    push("holder", solid::holder(d)?, kit.holders.len(), [0.0; 3]);
    push("fingertip", solid::fingertip()?, 2, [0.0, 90.0, 0.0]);
    push("clamp", solid::clamp(d)?, 1, [0.0; 3]);
    Ok(parts)
}

/// The bill of parts of a kit, given its printed parts.
pub fn bill(kit: &Kit, printed: &[Printed]) -> Vec<Row> {
    let mut rows = Vec::new();
    for part in printed {
        let mass = part.solid.volume() * 1e-9 * PLA_DENSITY * 1e3;
        let note = "PLA, solid".to_string();
        rows.push(Row {
            source: "printed",
            part: part.name.clone(),
            count: part.count,
            mass: Some(mass),
            note,
        });
    }
    for (length, count) in lengths(kit) {
        rows.push(Row {
            source: "sawn",
            part: format!("extrusion {}", length_words(length)),
            count,
            mass: Some(length * EXTRUSION_MASS * 1e3),
            note: "20 x 20 aluminium, slot 5, both ends square".into(),
        });
    }
    let sockets: usize = kit.beams.iter().map(|beam| 2 * beam.links.len()).sum();
    let mut bought = |part: &str, count: usize, note: &str| {
        rows.push(Row { source: "bought", part: part.into(), count, mass: None, note: note.into() });
    };
    bought("screw M5 x 8, countersunk", sockets, "ISO 10642; one for each socket");
    bought("T-slot nut M5", sockets, "for slot 5; one for each socket");
    bought("screw M5 x 16", 2, "clamp: through its sides into the slots of the clamped beam");
    bought("T-slot nut M5, clamp", 2, "for slot 5; in the sides of the clamped beam");
    bought("screw M5 for the table", 4, "clamp: down into the table, length as the table asks");
    bought("screw M4 x 16", 2, "fingertips to the fingers");
    bought("nut M4", 2, "in the fingertips");
    let tags = kit.beams.iter().flat_map(|beam| &beam.joints).filter(|joint| joint.tag.is_some()).count();
    let mut paper = |part: &str, count: usize, note: &str| {
        rows.push(Row { source: "paper", part: part.into(), count, mass: None, note: note.into() });
    };
    paper("tag sticker", tags + kit.pegs.len(), "tags.pdf; 25 mm, tag25h9, one for each id");
    paper("start sheet", 1, "sheet.pdf; carries the tag 0");
    rows
}

/// A length as text: in mm, with as few digits as needed.
pub(crate) fn length_words(length: f64) -> String {
    let rounded = (length * 1e5).round() / 1e2;
    format!("{rounded}")
}

/// Text as one field of a CSV line.
fn field(text: &str) -> String {
    let text = cell(text);
    if text.contains([',', '"', '\n']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.into_owned()
    }
}

/// The bill as CSV, with a line of headings.
pub fn csv(rows: &[Row]) -> String {
    let mut text = String::from("source,part,count,mass_each_g,mass_all_g,note\n");
    for row in rows {
        let mass = |factor: f64| row.mass.map_or(String::new(), |mass| format!("{:.1}", mass * factor));
        // Writing to a string does not fail.
        let _ = writeln!(
            text,
            "{},{},{},{},{},{}",
            row.source,
            field(&row.part),
            row.count,
            mass(1.0),
            mass(row.count as f64),
            field(&row.note)
        );
    }
    text
}

/// The bill as a Markdown table.
pub fn table(kit: &Kit, rows: &[Row]) -> String {
    let joints: usize = kit.beams.iter().map(|beam| beam.joints.len()).sum();
    let links: usize = kit.beams.iter().map(|beam| beam.links.len()).sum();
    let mut text = format!(
        "# Bill of parts\n\n{} beams of {joints} joints and {links} lengths of extrusion; {} pegs in {} holders.\n\n\
         | from | part | count | mass each, g | mass of all, g | note |\n|---|---|--:|--:|--:|---|\n",
        kit.beams.len(),
        kit.pegs.len(),
        kit.holders.len(),
    );
    for row in rows {
        let mass = |factor: f64| row.mass.map_or(String::new(), |mass| format!("{:.1}", mass * factor));
        let (each, all) = (mass(1.0), mass(row.count as f64));
        let _ = writeln!(
            text,
            "| {} | {} | {} | {each} | {all} | {} |",
            row.source, row.part, row.count, row.note
        );
    }
    let plastic: f64 = rows
        .iter()
        .filter(|row| row.source == "printed")
        .map(|row| row.mass.unwrap_or_default() * row.count as f64)
        .sum();
    let metal: f64 = lengths(kit).iter().map(|(length, count)| length * *count as f64).sum();
    let _ = writeln!(text, "\n{plastic:.0} g of filament, {metal:.2} m of extrusion.");
    text
}

/// The cutting list: one line per length, with the links that need it.
pub fn cutting_list(kit: &Kit) -> String {
    let mut text = String::from("length_mm,count,links\n");
    for (length, count) in lengths(kit) {
        let names: Vec<&str> = kit
            .beams
            .iter()
            .flat_map(|beam| &beam.links)
            .filter(|link| (link.length - length).abs() < 1e-5)
            .map(|link| link.name.as_str())
            .collect();
        let _ = writeln!(text, "{},{count},{}", length_words(length), field(&names.join(" ")));
    }
    text
}
