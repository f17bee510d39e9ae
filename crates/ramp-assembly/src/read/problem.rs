//! Defects of a goal file.

use crate::check::MAX_BEAMS;
use ramp_source::{Element, Fault, FormProblem, Problem};

/// A defect of a goal file, with its place.
pub type GoalError = Fault<GoalProblem>;

/// Defects of a goal file.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum GoalProblem {
    /// The form of the file.
    #[error(transparent)]
    Form(#[from] FormProblem),
    /// The kit has no such beam.
    #[error("the kit has no beam `{found}`")]
    UnknownBeam {
        /// The name found.
        found: String,
        /// The most similar beam.
        nearest: Option<String>,
    },
    /// A connection names a beam that is not a component.
    #[error("`{beam}` is not a component of this goal")]
    NotDeclared {
        /// The beam.
        beam: String,
    },
    /// A component without connections.
    #[error("`{beam}` has no connection")]
    NotConnected {
        /// The beam.
        beam: String,
    },
    /// No chain of connections joins the component with the base.
    #[error("no chain of connections leads from `{beam}` to the base `{base}`")]
    Loose {
        /// The beam.
        beam: String,
        /// The base.
        base: String,
    },
    /// A beam listed twice.
    #[error("`{beam}` is listed twice")]
    DuplicateBeam {
        /// The beam.
        beam: String,
    },
    /// More beams than the search for an order supports.
    #[error("this goal has {found} components, expected at most {MAX_BEAMS}")]
    TooManyBeams {
        /// Number of beams.
        found: usize,
    },
    /// No component is the base.
    #[error("no component is the base")]
    NoBase,
    /// Two components are the base.
    #[error("`{first}` and `{second}` are both the base")]
    TwoBases {
        /// The first.
        first: String,
        /// The second.
        second: String,
    },
    /// The base is a beam that starts on the sheet.
    #[error("`{found}` is the base, but in the kit it lies on the sheet")]
    BaseNotClamped {
        /// The base.
        found: String,
        /// The beam that is clamped to the table.
        clamped: Option<String>,
    },
    /// A yaw on the base.
    #[error("the base has a yaw, but yaws are measured from the base")]
    BaseYaw,
    /// No connections.
    #[error("this goal has no connections")]
    NoConnections,
    /// Two connections share a name.
    #[error("the connection `{name}` is defined twice")]
    DuplicateConnection {
        /// The name.
        name: String,
    },
    /// A connection without exactly two elements.
    #[error("the connection `{connection}` has {found} elements, expected 2")]
    Elements {
        /// The connection.
        connection: String,
        /// Number of elements.
        found: usize,
    },
    /// The beam has no such joint.
    #[error("`{beam}` has no joint `{found}`")]
    UnknownJoint {
        /// The name found.
        found: String,
        /// The beam.
        beam: String,
        /// The beam that has a joint of that name.
        owner: Option<String>,
        /// The most similar joint of the beam.
        nearest: Option<String>,
    },
    /// A beam connected with itself.
    #[error("the connection `{connection}` joins `{beam}` with itself")]
    SameBeam {
        /// The connection.
        connection: String,
        /// The beam.
        beam: String,
    },
    /// Two females or two males.
    #[error("the connection `{connection}` joins two {kind} joints, {first} and {second}")]
    SameKind {
        /// The connection.
        connection: String,
        /// `male` or `female`.
        kind: &'static str,
        /// The first joint, with its type.
        first: String,
        /// The other joint.
        second: String,
    },
    /// A joint in two connections.
    #[error("`{joint}` is used in `{first}` already")]
    JointTwice {
        /// The joint.
        joint: String,
        /// The connection that has it.
        first: String,
    },
    /// More connections than pegs.
    #[error("this goal needs {needed} pegs, and the kit has {there}")]
    TooFewPegs {
        /// The number of connections.
        needed: usize,
        /// The number of pegs.
        there: usize,
    },
    /// The holes do not meet.
    #[error(
        "the holes of `{female}` and `{male}` are {distance:.2} mm apart where the other connections put them"
    )]
    HolesApart {
        /// The female joint.
        female: String,
        /// The male joint.
        male: String,
        /// In mm.
        distance: f64,
    },
    /// A male enters a female at an invalid angle.
    #[error("`{male}` would enter `{female}` at {angle:.1}° from straight, expected at most {limit:.1}°")]
    Angle {
        /// The female joint.
        female: String,
        /// The male joint.
        male: String,
        /// In degrees.
        angle: f64,
        /// In degrees.
        limit: f64,
    },
    /// The search for poses reached its limit.
    #[error("the beams of this goal can be placed in too many ways")]
    TooHard,
    /// Beams overlap.
    #[error("`{first}` and `{second}` overlap by {depth:.2} mm")]
    Overlap {
        /// The first beam.
        first: String,
        /// The other beam.
        second: String,
        /// In mm.
        depth: f64,
        /// The open side of a one-sided joint, when that may be the reason.
        opening: Option<String>,
    },
    /// No order of insertions builds the goal.
    #[error("no order of straight insertions builds this goal: {}", stuck_words(beams))]
    Stuck {
        /// The beams that block each other.
        beams: Vec<String>,
    },
}

fn stuck_words(beams: &[String]) -> String {
    match beams {
        [] => String::new(),
        [one] => format!("`{one}` cannot be moved to its place"),
        [most @ .., last] => {
            let most: Vec<String> = most.iter().map(|name| format!("`{name}`")).collect();
            format!("{} and `{last}` block each other", most.join(", "))
        }
    }
}

impl Problem for GoalProblem {
    fn label(&self) -> String {
        match self {
            GoalProblem::Form(form) => form.label(),
            GoalProblem::UnknownBeam { .. } => "unknown beam".into(),
            GoalProblem::NotDeclared { .. } => "not declared".into(),
            GoalProblem::NotConnected { .. } | GoalProblem::Loose { .. } => "not connected".into(),
            GoalProblem::DuplicateBeam { .. } | GoalProblem::DuplicateConnection { .. } => {
                "again here".into()
            }
            GoalProblem::TooManyBeams { .. } => "too many".into(),
            GoalProblem::NoBase => "expected one base=\"True\" in here".into(),
            GoalProblem::TwoBases { .. } => "the second base".into(),
            GoalProblem::BaseNotClamped { .. } => "not the clamped beam".into(),
            GoalProblem::BaseYaw => "expected no yaw".into(),
            GoalProblem::NoConnections => "expected a <connection>".into(),
            GoalProblem::Elements { .. } => "expected 2 elements".into(),
            GoalProblem::UnknownJoint { .. } => "unknown joint".into(),
            GoalProblem::SameBeam { .. } => "the same beam".into(),
            GoalProblem::SameKind { .. } => "expected one male and one female".into(),
            GoalProblem::JointTwice { .. } => "again here".into(),
            GoalProblem::TooFewPegs { .. } => "no peg is left for this one".into(),
            GoalProblem::HolesApart { .. } => "these do not meet".into(),
            GoalProblem::Angle { .. } => "these do not fit".into(),
            GoalProblem::TooHard => "expected fewer open beams".into(),
            GoalProblem::Overlap { .. } => "overlaps".into(),
            GoalProblem::Stuck { .. } => "cannot be built".into(),
        }
    }

    fn help(&self) -> Option<String> {
        match self {
            GoalProblem::Form(form) => form.help(),
            GoalProblem::UnknownBeam { nearest: Some(name), .. } => Some(format!("did you mean `{name}`?")),
            GoalProblem::UnknownJoint { owner: Some(owner), found, .. } => {
                Some(format!("`{found}` is a joint of `{owner}`"))
            }
            GoalProblem::UnknownJoint { nearest: Some(name), .. } => Some(format!("did you mean `{name}`?")),
            GoalProblem::NotDeclared { beam } => Some(format!("add <component beam=\"{beam}\"/>")),
            GoalProblem::Overlap { opening, .. } => opening.clone(),
            GoalProblem::BaseNotClamped { clamped: Some(beam), .. } => {
                Some(format!("the clamped beam is `{beam}`"))
            }
            _ => None,
        }
    }
}

/// The value read, or the first defect of the file.
pub(super) type Result<T, E = GoalError> = std::result::Result<T, E>;
/// An element of a goal file.
pub(super) type Node<'a> = Element<'a, GoalProblem>;
