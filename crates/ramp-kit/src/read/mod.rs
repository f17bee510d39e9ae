//! Reads a kit from XML: the form of the published beam sets, with a few optional additions.
//!
//! ```xml
//! <data>
//!   <beam name="b4">
//!     <joint name="b4j1" part="in-m-end-feet" marker="7"> <child link="b4l1"/> </joint>
//!     <joint name="b4j2" part="in-f" opens="right"> <parent link="b4l1"/> <child link="b4l2"/> </joint>
//!     …
//!     <link name="b4l1" length="120"> <parent joint="b4j1"/> <child joint="b4j2"/> </link>
//!     <start x="21.27" y="346.18"/>
//!   </beam>
//!   <holder name="h1" x="424.58" y="192.48"/>
//!   <peg name="p1" marker="19" holder="h1" slot="-1"/>
//!   <sheet width="594" height="420" x="53" y="600"> <tag x="524.58" y="320.45" size="75.5"/> </sheet>
//!   <base x="310" y="26.8"/>
//! </data>
//! ```
//!
//! A kit may also add joint types and state the four dimensions of the printed parts:
//!
//! ```xml
//!   <part name="in-m-end-45" mates="male" place="end" socket="36" turn="45"/>
//!   <dimensions wall="3" clearance="0.3" extrusion="20" hole="8.4"/>
//! ```
//!
//! Joints and links may come in any order: parents and children define the order along the beam.
//! Extensions of the published form are `opens` (the open side of an `in-f` or `in-f-end`, default
//! `left`), `<start>` (the position of j1 on the sheet, and whether the beam is flipped), `<peg>`,
//! `<holder>`, `<sheet>` (its size, its top left corner in the world, and the centre and black edge
//! of its own tag) and `<base>` (the j1 hole of the clamped beam in the world). All lengths in the
//! file are mm.
//!
//! `chain` puts the joints of a beam in order, `beam`, `part` and `peg` read one element each, and
//! `names` rejects duplicates.

mod beam;
mod chain;
mod measure;
mod names;
mod part;
mod peg;
mod problem;

pub use problem::{KitError, KitProblem, MAX_JOINTS};

use self::beam::read_beam;
use self::measure::{LENGTH, MM, point};
use self::names::Names;
use self::part::{read_dimensions, read_part};
use self::peg::read_peg;
use self::problem::{Node, Result};
use crate::beam::{Holder, Kit, Sheet};
use crate::dimensions::Dimensions;
use ramp_source::{SourceFile, parse_xml};
use std::collections::HashMap;
use std::ops::RangeInclusive;
use std::path::Path;

/// The black edge of the sheet's own tag, mm.
const TAG_EDGE: RangeInclusive<f64> = 10.0..=300.0;

/// Reads a kit file.
///
/// # Errors
/// The first defect of the file, with line and column.
pub fn read_kit(path: &Path) -> Result<Kit, KitError> {
    read(&SourceFile::read(path)?)
}

/// Reads a kit from text; `name` is its name in messages.
///
/// ```
/// let text = r#"<data>
///   <beam name="a">
///     <joint name="a1" part="in-m-end"><child link="l"/></joint>
///     <joint name="a2" part="in-f-end" opens="right"><parent link="l"/></joint>
///     <link name="l" length="100"><parent joint="a1"/><child joint="a2"/></link>
///   </beam>
/// </data>"#;
/// let kit = ramp_kit::read_kit_str("small.xml", text).unwrap();
/// assert!((kit.beams[0].span() - 0.1318).abs() < 1e-9);
///
/// let error = ramp_kit::read_kit_str("small.xml", &text.replace("in-m-end", "in-m-emd")).unwrap_err();
/// assert_eq!(error.location(), "small.xml:3:28");
/// assert_eq!(error.to_string(), "there is no joint type `in-m-emd`");
/// ```
///
/// # Errors
/// The first defect of the text, with line and column.
pub fn read_kit_str(name: &str, text: &str) -> Result<Kit, KitError> {
    read(&SourceFile::new(name, text))
}

fn read(file: &SourceFile) -> Result<Kit> {
    let document = parse_xml(file)?;
    let root = Node::root(&document, file, "data")?;
    let mut names = Names::default();
    let mut kit = Kit {
        beams: Vec::new(),
        pegs: Vec::new(),
        holders: Vec::new(),
        sheet: Sheet::default(),
        base_xy: [0.310, 0.0268],
        dimensions: Dimensions::BENCHMARK,
    };
    let mut pegs = Vec::new();
    let mut seen = HashMap::new();
    let children = root.children(&["beam", "peg", "holder", "sheet", "base", "part", "dimensions"])?;
    // Joint types are read first: beams name them, and they may come later in the file.
    for part in children.iter().filter(|child| child.tag() == "part") {
        let kind = read_part(*part)?;
        if names.part(kind.name()).is_some() {
            let problem = KitProblem::DuplicatePart { name: kind.name().to_string() };
            return Err(part.required("name")?.fault(problem));
        }
        names.parts.push(kind);
    }
    for child in children {
        match child.tag() {
            "beam" => kit.beams.push(read_beam(child, &mut names)?),
            "peg" => pegs.push(child),
            "part" => {}
            "holder" => {
                child.check_attributes(&["name", "x", "y"])?;
                let name = names.take(&child.required("name")?)?;
                kit.holders.push(Holder { name, centre: point(child)? });
            }
            tag => {
                let element = match tag {
                    "sheet" => "sheet",
                    "base" => "base",
                    _ => "dimensions",
                };
                if let Some(first) = seen.insert(element, child.span()) {
                    return Err(child.fault(KitProblem::Twice { element }).also(first, "the first"));
                }
                if element == "base" {
                    child.check_attributes(&["x", "y"])?;
                    kit.base_xy = point(child)?;
                } else if element == "dimensions" {
                    kit.dimensions = read_dimensions(child)?;
                } else {
                    child.check_attributes(&["width", "height", "x", "y"])?;
                    let size = |attribute| Ok(child.required(attribute)?.number(LENGTH, "mm")? * MM);
                    let (size, corner) = ([size("width")?, size("height")?], point(child)?);
                    kit.sheet = Sheet { size, corner, ..Sheet::default() };
                    let mut first = None;
                    for tag in child.children(&["tag"])? {
                        if let Some(first) = first.replace(tag.span()) {
                            let problem = KitProblem::Twice { element: "tag" };
                            return Err(tag.fault(problem).also(first, "the first"));
                        }
                        tag.check_attributes(&["x", "y", "size"])?;
                        kit.sheet.tag = point(tag)?;
                        kit.sheet.tag_edge = tag.required("size")?.number(TAG_EDGE, "mm")? * MM;
                    }
                }
            }
        }
    }
    // Pegs are read last: they name holders, which may come later in the file.
    let mut slots = HashMap::new();
    for peg in pegs {
        kit.pegs.push(read_peg(peg, &kit.holders, &mut names, &mut slots)?);
    }
    if kit.beams.is_empty() {
        return Err(root.fault(KitProblem::Empty));
    }
    Ok(kit)
}
