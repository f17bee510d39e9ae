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
//! A kit may also add joint types of its own and state the four numbers that the printed parts are made from:
//!
//! ```xml
//!   <part name="in-m-end-45" mates="male" place="end" socket="36" turn="45"/>
//!   <dimensions wall="3" clearance="0.3" extrusion="20" hole="8.4"/>
//! ```
//!
//! Joints and links may stand in any order: parents and children say how they follow along the beam. Ours are
//! `opens` (the side an `in-f` or `in-f-end` is open to, `left` unless said), `<start>` (where j1 lies on the
//! sheet, and whether the beam lies flipped), `<peg>`, `<holder>`, `<sheet>` (its size, its top left corner
//! in the world, and the centre and black edge of its own tag) and `<base>` (the j1 hole of the clamped beam in the world). All lengths in the file are mm.

use crate::beam::{Beam, Holder, Joint, Kit, Link, Peg, Sheet, StartPose};
use crate::joint::{Dimensions, JointForm, JointType, MALE_TIP, STEM_RADIUS, Side, WALL};
use ramp_source::{Element, Fault, FormProblem, Problem, SourceFile, Value, nearest, parse_xml, shorten};
use std::collections::{HashMap, HashSet};
use std::ops::{Range, RangeInclusive};
use std::path::Path;

/// What is wrong with a kit, and where.
pub type KitError = Fault<KitProblem>;

/// What can be wrong with a kit.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum KitProblem {
    /// The form of the file.
    #[error(transparent)]
    Form(#[from] FormProblem),
    /// A name that something else has already.
    #[error("the name `{name}` is used twice")]
    DuplicateName {
        /// The name.
        name: String,
    },
    /// A tag that something else carries already.
    #[error("the tag {tag} is used twice")]
    DuplicateTag {
        /// Its id.
        tag: u32,
    },
    /// No such type of joint.
    #[error("there is no joint type `{found}`")]
    UnknownPart {
        /// What the file has.
        found: String,
        /// The most similar type.
        nearest: Option<String>,
    },
    /// A tag that the family does not have.
    #[error("there is no tag {tag}: the family tag25h9 has the ids 0 to 34, and 0 is on the sheet")]
    NoSuchTag {
        /// Its id.
        tag: i64,
    },
    /// A joint type of the kit's own that has the name of another.
    #[error("there is a joint type `{name}` already")]
    DuplicatePart {
        /// The name.
        name: String,
    },
    /// A joint type of the kit's own that cannot be made.
    #[error("the joint type `{part}` cannot be made: {why}")]
    BadPart {
        /// The joint type.
        part: String,
        /// The reason.
        why: String,
    },
    /// An opening on a joint type that has none.
    #[error("a `{part}` has no opening to one side")]
    NoOpening {
        /// The joint type.
        part: &'static str,
    },
    /// A parent or child that the beam does not have.
    #[error("`{from}` names `{found}` as its {role}, expected a {expected} of {beam}")]
    UnknownNeighbour {
        /// Who names it.
        from: String,
        /// `parent` or `child`.
        role: &'static str,
        /// `joint` or `link`.
        expected: &'static str,
        /// What the file has.
        found: String,
        /// The beam.
        beam: String,
        /// A better name: the one whose other side fits, or else the most similar one.
        nearest: Option<String>,
    },
    /// Two neighbours that do not name each other.
    #[error("`{from}` names `{to}` as its {role}, but `{to}` does not name `{from}` in return")]
    OneSided {
        /// Who names the other.
        from: String,
        /// `parent` or `child`.
        role: &'static str,
        /// The other.
        to: String,
    },
    /// A second parent or a second child.
    #[error("`{from}` has two elements <{role}>")]
    Branch {
        /// The joint or link.
        from: String,
        /// `parent` or `child`.
        role: &'static str,
    },
    /// A link with an open end.
    #[error("the link `{link}` has no <{role}>")]
    OpenLink {
        /// The link.
        link: String,
        /// `parent` or `child`.
        role: &'static str,
    },
    /// No joint without a parent.
    #[error("the joints of {beam} form a loop: each has a parent")]
    Loop {
        /// The beam.
        beam: String,
    },
    /// Joints that the walk from j1 does not reach.
    #[error("{beam} falls apart: `{joint}` is not connected with `{first}`")]
    Split {
        /// The beam.
        beam: String,
        /// The joint it starts with.
        first: String,
        /// A joint that is not reached.
        joint: String,
    },
    /// Fewer than two joints, or more than [`MAX_JOINTS`].
    #[error("{beam} has {joints} joint{}, expected 2 to {MAX_JOINTS}", if *joints == 1 { "" } else { "s" })]
    JointCount {
        /// The beam.
        beam: String,
        /// How many it has.
        joints: usize,
    },
    /// An end joint inside the beam or a middle joint at its end.
    #[error("`{joint}` is a `{part}`, which cannot stand {place} of a beam")]
    WrongPlace {
        /// The joint.
        joint: String,
        /// Its type.
        part: &'static str,
        /// `at the end` or `in the middle`.
        place: &'static str,
    },
    /// A link that leaves no room for its joints.
    #[error(
        "the link `{link}` is {length} mm long, expected at least {least:.2} mm between these two joints"
    )]
    ShortLink {
        /// The link.
        link: String,
        /// Its length, mm.
        length: f64,
        /// The length at which its joints touch, mm.
        least: f64,
    },
    /// A peg in a holder that is not there.
    #[error("there is no holder `{found}`")]
    UnknownHolder {
        /// What the file has.
        found: String,
        /// The most similar holder.
        nearest: Option<String>,
    },
    /// Two pegs in one hole.
    #[error("slot {slot} of `{holder}` is used twice")]
    SlotTaken {
        /// The holder.
        holder: String,
        /// The slot.
        slot: i32,
    },
    /// An element that may stand there once.
    #[error("<{element}> stands here twice")]
    Twice {
        /// The element.
        element: &'static str,
    },
    /// Nothing to build with.
    #[error("this kit has no beams")]
    Empty,
}

impl Problem for KitProblem {
    fn label(&self) -> String {
        match self {
            KitProblem::Form(form) => form.label(),
            KitProblem::DuplicateName { .. } | KitProblem::DuplicateTag { .. } => "used again here".into(),
            KitProblem::UnknownPart { .. } => "unknown joint type".into(),
            KitProblem::NoSuchTag { .. } => "expected 1 to 34".into(),
            KitProblem::DuplicatePart { .. } => "expected a name of its own".into(),
            KitProblem::BadPart { .. } => "cannot be made".into(),
            KitProblem::NoOpening { .. } => "only in-f and in-f-end have one".into(),
            KitProblem::UnknownNeighbour { expected, .. } => format!("expected a {expected}"),
            KitProblem::OneSided { .. } => "one-sided".into(),
            KitProblem::Branch { role, .. } => format!("a second {role}"),
            KitProblem::OpenLink { role, .. } => format!("needs a <{role} joint=\"…\"/>"),
            KitProblem::Loop { .. } => "which joint comes first?".into(),
            KitProblem::Split { .. } => "not reached".into(),
            KitProblem::JointCount { .. } => format!("expected 2 to {MAX_JOINTS} joints"),
            KitProblem::WrongPlace { place, .. } => format!("stands {place}"),
            KitProblem::ShortLink { .. } => "too short".into(),
            KitProblem::UnknownHolder { .. } => "unknown holder".into(),
            KitProblem::SlotTaken { .. } => "taken".into(),
            KitProblem::Twice { .. } => "the second".into(),
            KitProblem::Empty => "expected a <beam>".into(),
        }
    }

    fn help(&self) -> Option<String> {
        match self {
            KitProblem::Form(form) => form.help(),
            KitProblem::UnknownPart { nearest: None, .. } => {
                Some(format!("the types are {}", JointType::ALL.map(JointType::name).join(", ")))
            }
            KitProblem::UnknownPart { nearest: Some(name), .. }
            | KitProblem::UnknownNeighbour { nearest: Some(name), .. }
            | KitProblem::UnknownHolder { nearest: Some(name), .. } => {
                Some(format!("did you mean `{name}`?"))
            }
            _ => None,
        }
    }
}

/// The most joints of one beam; keeps the geometry of whatever is read small.
pub const MAX_JOINTS: usize = 32;
/// Any position on the table, mm.
const POSITION: RangeInclusive<f64> = -5000.0..=5000.0;
/// Any length of extrusion, mm.
const LENGTH: RangeInclusive<f64> = 1.0..=2000.0;
/// The ids of the tag family tag25h9; 0 is on the sheet.
const TAGS: RangeInclusive<i64> = 1..=34;
/// Walls that a printer can lay and that carry, mm.
const WALLS: RangeInclusive<f64> = 1.0..=6.0;
/// Gaps between parts, mm; without one nothing goes into anything.
const CLEARANCES: RangeInclusive<f64> = 0.05..=1.0;
/// Square extrusions, mm.
const EXTRUSIONS: RangeInclusive<f64> = 15.0..=30.0;
/// Peg holes, mm: around the stem, and within the head.
const HOLES: RangeInclusive<f64> = 2e3 * STEM_RADIUS + 0.1..=12.0;
/// The black edge of the sheet's own tag, mm.
const TAG_EDGE: RangeInclusive<f64> = 10.0..=300.0;
/// From a hole to the floor of a socket, or to the end of a cavity, mm.
const REACH: RangeInclusive<f64> = 1.0..=200.0;
/// The angle of a turned male end, degrees.
const TURNS: RangeInclusive<f64> = -60.0..=60.0;
/// The smallest angle by which a male end is turned, degrees.
const LEAST_TURN: f64 = 5.0;
/// Metres in a millimetre.
const MM: f64 = 1e-3;

/// Reads a kit file.
///
/// # Errors
/// Whatever is wrong with the file first, with its line and column.
pub fn read_kit(path: &Path) -> Result<Kit, KitError> {
    read(&SourceFile::read(path)?)
}

/// Reads a kit from text; `name` is what messages call it.
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
/// Whatever is wrong with the text first, with its line and column.
pub fn read_kit_str(name: &str, text: &str) -> Result<Kit, KitError> {
    read(&SourceFile::new(name, text))
}

type Result<T, E = KitError> = std::result::Result<T, E>;
type Node<'a> = Element<'a, KitProblem>;
type Text<'a> = Value<'a, KitProblem>;

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
    // Joint types come first: beams name them, and they may stand behind them in the file.
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
    // Pegs come last: they name holders, which may stand behind them in the file.
    let mut slots = HashMap::new();
    for peg in pegs {
        kit.pegs.push(read_peg(peg, &kit.holders, &mut names, &mut slots)?);
    }
    if kit.beams.is_empty() {
        return Err(root.fault(KitProblem::Empty));
    }
    Ok(kit)
}

/// The attributes `x` and `y`, mm in the file.
fn point(node: Node<'_>) -> Result<[f64; 2]> {
    let number = |attribute| Ok(node.required(attribute)?.number(POSITION, "mm")? * MM);
    Ok([number("x")?, number("y")?])
}

/// The four numbers; those that are not stated are the benchmark's.
fn read_dimensions(node: Node<'_>) -> Result<Dimensions> {
    node.check_attributes(&["wall", "clearance", "extrusion", "hole"])?;
    let number = |attribute, range: RangeInclusive<f64>, nominal: f64| match node.optional(attribute) {
        Some(value) => Ok(value.number(range, "mm")? * MM),
        None => Ok::<f64, KitError>(nominal),
    };
    let nominal = Dimensions::BENCHMARK;
    Ok(Dimensions {
        wall: number("wall", WALLS, nominal.wall)?,
        clearance: number("clearance", CLEARANCES, nominal.clearance)?,
        extrusion: number("extrusion", EXTRUSIONS, nominal.extrusion)?,
        peg_hole: number("hole", HOLES, nominal.peg_hole)?,
    })
}

/// A joint type of the kit's own.
fn read_part(node: Node<'_>) -> Result<JointType> {
    node.check_attributes(&["name", "mates", "place", "socket", "cavity", "open", "feet", "turn"])?;
    let value = node.required("name")?;
    let name = value.name()?;
    let choice = |attribute, yes: &str, no: &str, expected| {
        let value = node.required(attribute)?;
        if value.text() == yes || value.text() == no {
            return Ok(value.text() == yes);
        }
        Err(value.bad_choice(expected))
    };
    let bad = |at: &Text<'_>, why: &str| {
        Err(at.fault(KitProblem::BadPart { part: name.to_string(), why: why.to_string() }))
    };
    let male = choice("mates", "male", "female", "male or female")?;
    let end = choice("place", "end", "middle", "end or middle")?;
    for (attribute, allowed, why) in [
        ("cavity", !male, "only a female has a cavity"),
        ("open", !male, "only a female has an opening"),
        ("feet", male && end, "only a male end has feet"),
        ("turn", male && end, "only a male end can be turned"),
    ] {
        if let Some(value) = node.optional(attribute).filter(|_| !allowed) {
            return bad(&value, why);
        }
    }
    let one_sided = !male && choice("open", "one", "both", "one or both")?;
    let cavity = if male { 0.0 } else { node.required("cavity")?.number(REACH, "mm")? * MM };
    let feet = node.optional("feet").map_or(Ok(false), |value| value.flag())?;
    let turn = match node.optional("turn") {
        None => 0.0,
        Some(value) => {
            let degrees = value.number(TURNS, "degrees")?;
            if degrees.abs() < LEAST_TURN {
                return bad(&value, "a male end that is turned is turned by at least 5°");
            }
            degrees.to_radians()
        }
    };
    let value = node.required("socket")?;
    let socket_offset = value.number(REACH, "mm")? * MM;
    let form = JointForm { name: "", male, end, one_sided, socket_offset, cavity, feet, turn };
    let body = Dimensions::BENCHMARK.body();
    if !male && form.entry_angle(body) <= 0.0 {
        return bad(&node.required("cavity")?, "a male of 26.6 mm does not go into its cavity");
    }
    let least = if male { form.least_socket_offset().max(MALE_TIP - WALL) } else { cavity + WALL };
    if socket_offset < least - 1e-9 {
        let why = format!("its socket needs to be {:.2} mm or more from the hole", least / MM);
        return bad(&value, &why);
    }
    Ok(JointType::added(name, form))
}

/// Names and tags, each of which may be given once in a kit, and the joint types of its own.
#[derive(Default)]
struct Names {
    parts: Vec<JointType>,
    names: HashMap<String, Range<usize>>,
    tags: HashMap<u32, Range<usize>>,
}

impl Names {
    fn take(&mut self, value: &Text<'_>) -> Result<String> {
        let name = value.name()?.to_string();
        match self.names.insert(name.clone(), value.span()) {
            None => Ok(name),
            Some(first) => {
                Err(value.fault(KitProblem::DuplicateName { name }).also(first, "first used here"))
            }
        }
    }

    fn part(&self, name: &str) -> Option<JointType> {
        JointType::from_name(name).or_else(|| self.parts.iter().copied().find(|kind| kind.name() == name))
    }

    fn part_names(&self) -> Vec<&'static str> {
        JointType::ALL.iter().chain(&self.parts).map(|kind| kind.name()).collect()
    }

    fn take_tag(&mut self, value: &Text<'_>) -> Result<u32> {
        let id = value.integer(i64::MIN..=i64::MAX)?;
        if !TAGS.contains(&id) {
            return Err(value.fault(KitProblem::NoSuchTag { tag: id }));
        }
        // TAGS is within u32.
        let tag = u32::try_from(id).unwrap_or_default();
        match self.tags.insert(tag, value.span()) {
            None => Ok(tag),
            Some(first) => Err(value.fault(KitProblem::DuplicateTag { tag }).also(first, "first used here")),
        }
    }
}

fn read_peg(
    node: Node<'_>,
    holders: &[Holder],
    names: &mut Names,
    slots: &mut HashMap<(String, i32), Range<usize>>,
) -> Result<Peg> {
    node.check_attributes(&["name", "marker", "holder", "slot"])?;
    let name = names.take(&node.required("name")?)?;
    let tag = names.take_tag(&node.required("marker")?)?;
    let holder = node.required("holder")?;
    if !holders.iter().any(|known| known.name == holder.text()) {
        let near = nearest(holder.text(), holders.iter().map(|known| known.name.as_str()));
        let found = shorten(holder.text());
        return Err(holder.fault(KitProblem::UnknownHolder { found, nearest: near.map(str::to_string) }));
    }
    let value = node.required("slot")?;
    let slot = i32::try_from(value.integer(-1..=1)?).unwrap_or_default();
    if let Some(first) = slots.insert((holder.text().to_string(), slot), value.span()) {
        let problem = KitProblem::SlotTaken { holder: holder.text().to_string(), slot };
        return Err(value.fault(problem).also(first, "by this one"));
    }
    Ok(Peg { name, tag, holder: holder.text().to_string(), slot })
}

/// A joint or link as it stands in the file, before the beam is put in order.
struct Raw<'a> {
    node: Node<'a>,
    name: String,
    parent: Option<Text<'a>>,
    child: Option<Text<'a>>,
}

impl<'a> Raw<'a> {
    /// `other` is what the neighbours of this one are: `link` for a joint, `joint` for a link.
    fn read(node: Node<'a>, name: String, other: &'static str) -> Result<Raw<'a>> {
        let mut raw = Raw { node, name, parent: None, child: None };
        for neighbour in node.children(&["parent", "child"])? {
            neighbour.check_attributes(&[other])?;
            let value = neighbour.required(other)?;
            let (slot, role) = match neighbour.tag() {
                "parent" => (&mut raw.parent, "parent"),
                _ => (&mut raw.child, "child"),
            };
            if let Some(first) = slot {
                let first = first.span();
                let problem = KitProblem::Branch { from: raw.name.clone(), role };
                return Err(neighbour.fault(problem).also(first, "the first"));
            }
            *slot = Some(value);
        }
        Ok(raw)
    }

    fn neighbour(&self, role: &str) -> Option<&Text<'a>> {
        if role == "parent" { self.parent.as_ref() } else { self.child.as_ref() }
    }
}

fn read_beam(node: Node<'_>, names: &mut Names) -> Result<Beam> {
    node.check_attributes(&["name"])?;
    let name = names.take(&node.required("name")?)?;
    let mut start = None;
    let (mut joints, mut links) = (Vec::new(), Vec::new());
    for child in node.children(&["joint", "link", "start"])? {
        match child.tag() {
            "joint" => {
                child.check_attributes(&["name", "part", "marker", "opens"])?;
                let name = names.take(&child.required("name")?)?;
                joints.push(Raw::read(child, name, "link")?);
            }
            "link" => {
                child.check_attributes(&["name", "length"])?;
                let name = names.take(&child.required("name")?)?;
                links.push(Raw::read(child, name, "joint")?);
            }
            _ => {
                if start.is_some() {
                    return Err(child.fault(KitProblem::Twice { element: "start" }));
                }
                child.check_attributes(&["x", "y", "flipped"])?;
                let flipped = child.optional("flipped").map_or(Ok(false), |value| value.flag())?;
                start = Some(StartPose { at: point(child)?, flipped });
            }
        }
    }
    if !(2..=MAX_JOINTS).contains(&joints.len()) {
        return Err(node.fault(KitProblem::JointCount { beam: name, joints: joints.len() }));
    }
    let chain = Chain { beam: &name, joints: &joints, links: &links };
    chain.check()?;
    let order = chain.order(node)?;
    build_beam(&chain, &order, start, names)
}

/// The joints and links of one beam, as the file gives them.
struct Chain<'c, 'a> {
    beam: &'c str,
    joints: &'c [Raw<'a>],
    links: &'c [Raw<'a>],
}

impl Chain<'_, '_> {
    /// Does every joint and link name neighbours that exist and name it in return?
    fn check(&self) -> Result<()> {
        for link in self.links {
            for role in ["parent", "child"] {
                if link.neighbour(role).is_none() {
                    return Err(link.node.fault(KitProblem::OpenLink { link: link.name.clone(), role }));
                }
            }
        }
        self.check_side(self.joints, self.links, "link")?;
        self.check_side(self.links, self.joints, "joint")
    }

    fn check_side(&self, own: &[Raw<'_>], others: &[Raw<'_>], expected: &'static str) -> Result<()> {
        let by_name: HashMap<&str, &Raw<'_>> = others.iter().map(|raw| (raw.name.as_str(), raw)).collect();
        for raw in own {
            for (role, back) in [("parent", "child"), ("child", "parent")] {
                let Some(value) = raw.neighbour(role) else { continue };
                let names_us = |other: &Raw<'_>| other.neighbour(back).is_some_and(|b| b.text() == raw.name);
                match by_name.get(value.text()) {
                    Some(other) if names_us(other) => {}
                    Some(other) => {
                        let (from, to) = (raw.name.clone(), other.name.clone());
                        return Err(value.fault(KitProblem::OneSided { from, role, to }));
                    }
                    None => {
                        // The neighbour that names us in return is a better guess than any similar name.
                        let in_return = others.iter().find(|other| names_us(other)).map(|o| o.name.as_str());
                        let similar =
                            || nearest(value.text(), others.iter().map(|other| other.name.as_str()));
                        return Err(value.fault(KitProblem::UnknownNeighbour {
                            from: raw.name.clone(),
                            role,
                            expected,
                            found: shorten(value.text()),
                            beam: self.beam.to_string(),
                            nearest: in_return.or_else(similar).map(str::to_string),
                        }));
                    }
                }
            }
        }
        Ok(())
    }

    /// The joints from the first to the last with the links between them, as indices.
    fn order(&self, node: Node<'_>) -> Result<(Vec<usize>, Vec<usize>)> {
        let beam = self.beam.to_string();
        let Some(first) = self.joints.iter().position(|joint| joint.parent.is_none()) else {
            return Err(node.fault(KitProblem::Loop { beam }));
        };
        let index = |raws: &[Raw<'_>]| -> HashMap<String, usize> {
            raws.iter().enumerate().map(|(index, raw)| (raw.name.clone(), index)).collect()
        };
        let (joint_at, link_at) = (index(self.joints), index(self.links));
        let (mut joints, mut links) = (vec![first], Vec::new());
        let mut reached = HashSet::from([first]);
        let mut at = first;
        while let Some(&link) = self.joints[at].child.as_ref().and_then(|child| link_at.get(child.text())) {
            let Some(&next) = self.links[link].child.as_ref().and_then(|child| joint_at.get(child.text()))
            else {
                break;
            };
            // Neighbours name each other and the first has no parent, so this walk meets no joint twice; should
            // it ever, it ends.
            if !reached.insert(next) {
                return Err(node.fault(KitProblem::Loop { beam }));
            }
            links.push(link);
            joints.push(next);
            at = next;
        }
        match (0..self.joints.len()).find(|index| !reached.contains(index)) {
            None => Ok((joints, links)),
            Some(lost) => {
                let (first, joint) = (self.joints[first].name.clone(), self.joints[lost].name.clone());
                Err(self.joints[lost].node.fault(KitProblem::Split { beam, first, joint }))
            }
        }
    }
}

fn build_beam(
    chain: &Chain<'_, '_>,
    (joint_order, link_order): &(Vec<usize>, Vec<usize>),
    start: Option<StartPose>,
    names: &mut Names,
) -> Result<Beam> {
    let mut joints: Vec<Joint> = Vec::new();
    let mut links: Vec<Link> = Vec::new();
    for (position, &index) in joint_order.iter().enumerate() {
        let raw = &chain.joints[index];
        let part = raw.node.required("part")?;
        let kind = names.part(part.text()).ok_or_else(|| {
            let near = nearest(part.text(), names.part_names()).map(str::to_string);
            part.fault(KitProblem::UnknownPart { found: shorten(part.text()), nearest: near })
        })?;
        let at_end = position == 0 || position + 1 == joint_order.len();
        if kind.is_end() != at_end {
            let place = if at_end { "at the end" } else { "in the middle" };
            return Err(part.fault(KitProblem::WrongPlace {
                joint: raw.name.clone(),
                part: kind.name(),
                place,
            }));
        }
        let opens = match raw.node.optional("opens") {
            None => kind.has_opening().then_some(Side::Left),
            Some(value) if !kind.has_opening() => {
                return Err(value.fault(KitProblem::NoOpening { part: kind.name() }));
            }
            Some(value) => Some(match value.text() {
                "left" => Side::Left,
                "right" => Side::Right,
                _ => return Err(value.bad_choice("left or right")),
            }),
        };
        // An empty marker is no marker.
        let marker = raw.node.optional("marker").filter(|value| !value.text().is_empty());
        let tag = marker.map(|value| names.take_tag(&value)).transpose()?;
        let mut offset = 0.0;
        if let Some(before) = joints.last() {
            let raw_link = &chain.links[link_order[position - 1]];
            let value = raw_link.node.required("length")?;
            let length = value.number(LENGTH, "mm")? * MM;
            // What each joint covers of the extrusion, from the floor of its socket on.
            let least: f64 =
                [before.kind, kind].iter().map(|kind| kind.top_cover() - kind.socket_offset()).sum();
            if length < least - 1e-9 {
                return Err(value.fault(KitProblem::ShortLink {
                    link: raw_link.name.clone(),
                    length: length / MM,
                    least: least / MM,
                }));
            }
            offset = before.offset + before.kind.socket_offset() + length + kind.socket_offset();
            let grasp = [before.offset + before.kind.top_cover(), offset - kind.top_cover()];
            links.push(Link { name: raw_link.name.clone(), length, grasp });
        }
        joints.push(Joint { name: raw.name.clone(), kind, offset, opens, tag });
    }
    Ok(Beam { name: chain.beam.to_string(), joints, links, start })
}
