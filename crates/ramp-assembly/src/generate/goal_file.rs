//! The text of a generated goal.

use super::request::Request;
use crate::assembly::Class;
use ramp_kit::strokes::escape;
use std::fmt::Write;

/// The name of a generated goal.
pub(crate) fn goal_name(class: Class, request: Request) -> String {
    format!("{class}-{}-beams-{}", request.beams, request.seed)
}

/// The text of a goal file. Components are (beam, flipped, yaw in rad), the base first. Connections
/// are the male and the female, each with its beam.
pub(crate) fn goal_xml(
    name: &str,
    class: Class,
    components: &[(&str, bool, Option<f64>)],
    pairs: &[[(&str, &str); 2]],
) -> String {
    let mut xml = String::from("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n");
    // Writing to a string does not fail.
    let command = if class.is_open() { "open" } else { "generate" };
    let _ = writeln!(xml, "<!-- Made by `ramp goals {command}`. -->");
    let _ = writeln!(xml, "<assembly name=\"{name}\" class=\"{class}\">");
    for (index, (beam, flipped, yaw)) in components.iter().enumerate() {
        let base = if index == 0 { " base=\"True\"" } else { "" };
        let flipped = if *flipped { " flipped=\"True\"" } else { "" };
        let yaw = yaw.map_or(String::new(), |yaw| {
            format!(" yaw=\"{}\"", (yaw.to_degrees() * 1e6).round() / 1e6 + 0.0)
        });
        let _ = writeln!(xml, "  <component beam=\"{}\"{base}{flipped}{yaw}/>", escape(beam));
    }
    for (index, pair) in pairs.iter().enumerate() {
        let _ = writeln!(xml, "  <connection name=\"C{}\">", index + 1);
        for (beam, joint) in pair {
            let (beam, joint) = (escape(beam), escape(joint));
            let _ = writeln!(xml, "    <element component=\"{beam}\" joint=\"{joint}\"/>");
        }
        xml.push_str("  </connection>\n");
    }
    xml.push_str("</assembly>\n");
    xml
}
