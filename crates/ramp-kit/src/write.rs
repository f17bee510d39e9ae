//! Writes a kit as a file that [`crate::read_kit`] reads back.

use crate::beam::Kit;
use crate::dimensions::Dimensions;
use crate::joint::{JointType, Side};
use crate::strokes::escape;
use std::fmt::Write;

/// The text of a kit file. `about` becomes the comment at its head.
///
/// ```
/// # let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/kit.xml");
/// let kit = ramp_kit::read_kit(&path)?;
/// let again = ramp_kit::read_kit_str("again.xml", &ramp_kit::kit_xml(&kit, "A copy."))?;
/// assert_eq!(again.beams, kit.beams);
/// # Ok::<(), ramp_kit::KitError>(())
/// ```
pub fn kit_xml(kit: &Kit, about: &str) -> String {
    let mut xml = String::from("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n");
    // Writing to a string does not fail. Two hyphens would end the comment.
    let _ = writeln!(xml, "<!-- {} -->\n<data>", about.replace("--", "–"));
    let mut parts: Vec<JointType> = Vec::new();
    for joint in kit.beams.iter().flat_map(|beam| &beam.joints) {
        if matches!(joint.kind, JointType::Added(_)) && !parts.contains(&joint.kind) {
            parts.push(joint.kind);
        }
    }
    for kind in parts {
        part(&mut xml, kind);
    }
    for beam in &kit.beams {
        let _ = writeln!(xml, "  <beam name=\"{}\">", escape(&beam.name));
        for (index, joint) in beam.joints.iter().enumerate() {
            let _ = write!(xml, "    <joint name=\"{}\" part=\"{}\"", escape(&joint.name), joint.kind.name());
            if let Some(tag) = joint.tag {
                let _ = write!(xml, " marker=\"{tag}\"");
            }
            if let Some(side) = joint.opens {
                let _ = write!(xml, " opens=\"{}\"", if side == Side::Left { "left" } else { "right" });
            }
            xml.push('>');
            if let Some(link) = index.checked_sub(1).and_then(|before| beam.links.get(before)) {
                let _ = write!(xml, "<parent link=\"{}\"/>", escape(&link.name));
            }
            if let Some(link) = beam.links.get(index) {
                let _ = write!(xml, "<child link=\"{}\"/>", escape(&link.name));
            }
            xml.push_str("</joint>\n");
        }
        for (link, pair) in beam.links.iter().zip(beam.joints.windows(2)) {
            let _ = writeln!(
                xml,
                "    <link name=\"{}\" length=\"{}\"><parent joint=\"{}\"/><child joint=\"{}\"/></link>",
                escape(&link.name),
                mm(link.length),
                escape(&pair[0].name),
                escape(&pair[1].name),
            );
        }
        if let Some(start) = beam.start {
            let flipped = if start.flipped { " flipped=\"True\"" } else { "" };
            let _ =
                writeln!(xml, "    <start x=\"{}\" y=\"{}\"{flipped}/>", mm(start.at[0]), mm(start.at[1]));
        }
        xml.push_str("  </beam>\n");
    }
    for holder in &kit.holders {
        let [x, y] = holder.centre.map(mm);
        let _ = writeln!(xml, "  <holder name=\"{}\" x=\"{x}\" y=\"{y}\"/>", escape(&holder.name));
    }
    for peg in &kit.pegs {
        let _ = writeln!(
            xml,
            "  <peg name=\"{}\" marker=\"{}\" holder=\"{}\" slot=\"{}\"/>",
            escape(&peg.name),
            peg.tag,
            escape(&peg.holder),
            peg.slot
        );
    }
    rest(&mut xml, kit);
    xml.push_str("</data>\n");
    xml
}

fn part(xml: &mut String, kind: JointType) {
    let form = kind.form();
    let (mates, place) = (if form.male { "male" } else { "female" }, if form.end { "end" } else { "middle" });
    let _ = write!(
        xml,
        "  <part name=\"{}\" mates=\"{mates}\" place=\"{place}\" socket=\"{}\"",
        escape(form.name),
        mm(form.socket_offset)
    );
    if !form.male {
        let open = if form.one_sided { "one" } else { "both" };
        let _ = write!(xml, " cavity=\"{}\" open=\"{open}\"", mm(form.cavity));
    }
    if form.feet {
        xml.push_str(" feet=\"True\"");
    }
    if form.turn != 0.0 {
        let _ = write!(xml, " turn=\"{}\"", (form.turn.to_degrees() * 1e6).round() / 1e6);
    }
    xml.push_str("/>\n");
}

/// The sheet, the dimensions and the base.
fn rest(xml: &mut String, kit: &Kit) {
    let sheet = &kit.sheet;
    let ([width, height], [x, y], [tag_x, tag_y]) =
        (sheet.size.map(mm), sheet.corner.map(mm), sheet.tag.map(mm));
    let _ = writeln!(
        xml,
        "  <sheet width=\"{width}\" height=\"{height}\" x=\"{x}\" y=\"{y}\"><tag x=\"{tag_x}\" y=\"{tag_y}\" size=\"{}\"/></sheet>",
        mm(sheet.tag_edge)
    );
    let Dimensions { wall, clearance, extrusion, peg_hole } = kit.dimensions;
    let [wall, clearance, extrusion, hole] = [wall, clearance, extrusion, peg_hole].map(mm);
    let _ = writeln!(
        xml,
        "  <dimensions wall=\"{wall}\" clearance=\"{clearance}\" extrusion=\"{extrusion}\" hole=\"{hole}\"/>"
    );
    let [x, y] = kit.base_xy.map(mm);
    let _ = writeln!(xml, "  <base x=\"{x}\" y=\"{y}\"/>");
}

/// Millimetres to a tenth of a micrometre.
fn mm(metres: f64) -> f64 {
    (metres * 1e7).round() / 1e4
}
