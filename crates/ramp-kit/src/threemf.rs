//! 3MF: parts with their names and their positions on a printer's plate, in one file.

use crate::solid::Mesh;
use std::fmt::Write as _;
use std::io::{Cursor, Write as _};
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipWriter};

/// A part, and the positions of its copies: translations from its own frame, mm.
pub struct Item<'a> {
    /// Its name.
    pub name: &'a str,
    /// Its surface.
    pub mesh: &'a Mesh,
    /// One position per copy.
    pub places: Vec<[f64; 3]>,
}

const TYPES: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types"><Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/><Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/></Types>
"#;
const RELATIONSHIPS: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships"><Relationship Target="/3D/3dmodel.model" Id="rel0" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>
"#;

/// A 3MF file. It holds no date, so the same parts give the same bytes.
///
/// # Errors
/// The packer's error.
pub fn write(title: &str, items: &[Item<'_>]) -> Result<Vec<u8>, zip::result::ZipError> {
    let mut zip = ZipWriter::new(Cursor::new(Vec::new()));
    let options = SimpleFileOptions::default()
        .compression_method(CompressionMethod::Deflated)
        .last_modified_time(DateTime::default());
    let model = model(title, items);
    for (path, text) in
        [("[Content_Types].xml", TYPES), ("_rels/.rels", RELATIONSHIPS), ("3D/3dmodel.model", model.as_str())]
    {
        zip.start_file(path, options)?;
        zip.write_all(text.as_bytes())?;
    }
    Ok(zip.finish()?.into_inner())
}

fn model(title: &str, items: &[Item<'_>]) -> String {
    let mut xml = String::from(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<model unit=\"millimeter\" xml:lang=\"en-US\" \
         xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\">\n",
    );
    // Writing to a string does not fail.
    let _ =
        writeln!(xml, "<metadata name=\"Title\">{}</metadata>\n<resources>", crate::strokes::escape(title));
    for (index, item) in items.iter().enumerate() {
        let name = crate::strokes::escape(item.name);
        let _ = writeln!(xml, "<object id=\"{}\" type=\"model\" name=\"{name}\"><mesh><vertices>", index + 1);
        for [x, y, z] in item.mesh.points.iter().map(|point| point.map(micrometres)) {
            let _ = write!(xml, "<vertex x=\"{x}\" y=\"{y}\" z=\"{z}\"/>");
        }
        xml.push_str("</vertices><triangles>");
        for [a, b, c] in &item.mesh.triangles {
            let _ = write!(xml, "<triangle v1=\"{a}\" v2=\"{b}\" v3=\"{c}\"/>");
        }
        xml.push_str("</triangles></mesh></object>\n");
    }
    xml.push_str("</resources>\n<build>\n");
    for (index, item) in items.iter().enumerate() {
        for place in &item.places {
            let [x, y, z] = place.map(micrometres);
            let _ = writeln!(
                xml,
                "<item objectid=\"{}\" transform=\"1 0 0 0 1 0 0 0 1 {x} {y} {z}\"/>",
                index + 1
            );
        }
    }
    xml.push_str("</build>\n</model>\n");
    xml
}

/// Rounded to a thousandth of a micrometre: precise enough to keep corners distinct, and short in
/// the file.
fn micrometres(value: f64) -> f64 {
    (value * 1e6).round() / 1e6 + 0.0
}
