//! Defects of a kit file.

use crate::joint::JointType;
use ramp_source::{Element, Fault, FormProblem, Problem, Value};

/// A defect of a kit file, with its place.
pub type KitError = Fault<KitProblem>;

/// Defects of a kit file.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum KitProblem {
    /// The form of the file.
    #[error(transparent)]
    Form(#[from] FormProblem),
    /// A name that is already taken.
    #[error("the name `{name}` is used twice")]
    DuplicateName {
        /// The name.
        name: String,
    },
    /// A tag that is already taken.
    #[error("the tag {tag} is used twice")]
    DuplicateTag {
        /// Its id.
        tag: u32,
    },
    /// No such type of joint.
    #[error("there is no joint type `{found}`")]
    UnknownPart {
        /// The name found.
        found: String,
        /// The most similar type.
        nearest: Option<String>,
    },
    /// The tag family has no such id.
    #[error("there is no tag {tag}: the family tag25h9 has the ids 0 to 34, and 0 is on the sheet")]
    NoSuchTag {
        /// Its id.
        tag: i64,
    },
    /// An added joint type with the name of another.
    #[error("the joint type `{name}` exists already")]
    DuplicatePart {
        /// The name.
        name: String,
    },
    /// An added joint type that cannot be made.
    #[error("the joint type `{part}` cannot be made: {why}")]
    BadPart {
        /// The joint type.
        part: String,
        /// The reason.
        why: String,
    },
    /// `opens` on a joint type without a single open side.
    #[error("a `{part}` has no opening to one side")]
    NoOpening {
        /// The joint type.
        part: &'static str,
    },
    /// The beam has no such parent or child.
    #[error("`{from}` names `{found}` as its {role}, expected a {expected} of {beam}")]
    UnknownNeighbour {
        /// The joint or link that names it.
        from: String,
        /// `parent` or `child`.
        role: &'static str,
        /// `joint` or `link`.
        expected: &'static str,
        /// The name found.
        found: String,
        /// The beam.
        beam: String,
        /// A better name: the neighbour that names this one in return, or else the most similar
        /// one.
        nearest: Option<String>,
    },
    /// Two neighbours that do not name each other.
    #[error("`{from}` names `{to}` as its {role}, but `{to}` does not name `{from}` in return")]
    OneSided {
        /// The joint or link that names the other.
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
    /// Joints that are not reached from j1.
    #[error("{beam} falls apart: `{joint}` is not connected with `{first}`")]
    Split {
        /// The beam.
        beam: String,
        /// The first joint.
        first: String,
        /// A joint that is not reached.
        joint: String,
    },
    /// Fewer than two joints, or more than [`MAX_JOINTS`].
    #[error("{beam} has {joints} joint{}, expected 2 to {MAX_JOINTS}", if *joints == 1 { "" } else { "s" })]
    JointCount {
        /// The beam.
        beam: String,
        /// Number of joints.
        joints: usize,
    },
    /// An end joint inside the beam or a middle joint at its end.
    #[error("`{joint}` is a `{part}`, which cannot be {place} of a beam")]
    WrongPlace {
        /// The joint.
        joint: String,
        /// Its type.
        part: &'static str,
        /// `at the end` or `in the middle`.
        place: &'static str,
    },
    /// A link that is too short for its joints.
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
    /// A peg in a missing holder.
    #[error("there is no holder `{found}`")]
    UnknownHolder {
        /// The name found.
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
    /// An element that may occur only once.
    #[error("<{element}> occurs twice")]
    Twice {
        /// The element.
        element: &'static str,
    },
    /// A kit without beams.
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
            KitProblem::WrongPlace { place, .. } => format!("is {place}"),
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

/// Largest number of joints of one beam; it bounds the size of all geometry.
pub const MAX_JOINTS: usize = 32;

/// The value read, or the first defect of the file.
pub(super) type Result<T, E = KitError> = std::result::Result<T, E>;
/// An element of a kit file.
pub(super) type Node<'a> = Element<'a, KitProblem>;
/// The value of an attribute of a kit file.
pub(super) type Text<'a> = Value<'a, KitProblem>;
