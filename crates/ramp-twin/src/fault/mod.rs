//! Faults: what goes wrong in an episode on purpose, inside the physics, so that it can be measured which agent
//! notices and repairs it.
//!
//! A [`Fault`] strikes once. `occasion` watches the truth for the moments at which a kind may strike and counts them;
//! `act` is what then happens: a force on a part, a grip that is weak, an image that repeats, a bias of the wrist
//! sensor. No part is ever put anywhere, and the agent is told nothing. Sizes, times and, where it is not given, the
//! occasion come from the stream `fault-KIND` of the episode's seed.

mod act;
mod injector;
mod occasion;

use std::fmt;
use std::str::FromStr;

use ramp_kit::source::{nearest, shorten};
use ramp_kit::{Kit, tags};
use ramp_robot::random::Stream;

use crate::twin::Setup;

pub(crate) use injector::Injector;

/// What may go wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum FaultKind {
    /// The fingers lose their force for 0.3 to 0.6 s, 0.3 to 2.5 s after a peg was lifted: it falls.
    PegDropped,
    /// A lifted peg is turned in a weakened grip by 6 to 15° about the axis on which the fingers close.
    PegTilted,
    /// A lifted beam is pushed along its axis in a weakened grip, by 4 to 12 mm.
    BeamSlipped,
    /// A lifted beam is turned in a weakened grip by 4 to 10° about the axis on which the fingers close.
    BeamTurned,
    /// A beam that stands in the assembly is pushed sideways by 3 to 15 mm while the hand is away.
    BeamBumped,
    /// The holder from which a peg was lifted is pushed by 3 to 8 mm; when it is empty, another with pegs in it.
    HolderShifted,
    /// What is inserted meets something that gives way only at 25 to 35 N, for 4 to 8 s.
    Jam,
    /// A peg of the kit is not there.
    PegMissing,
    /// A tag of a beam of the goal is covered with white for the whole episode.
    TagCovered,
    /// Both cameras repeat their last image for 5 s.
    CameraFrozen,
    /// The fingers spring back by 2 to 4 mm when they touch what they close on, and stay there until they are opened.
    GripperWeak,
    /// The wrist sensor's force is off by a bias that grows by 0.05 to 0.2 N/s up to 5 to 8 N.
    ForceDrift,
}

impl FaultKind {
    /// All of them.
    pub const ALL: [FaultKind; 12] = [
        FaultKind::PegDropped,
        FaultKind::PegTilted,
        FaultKind::BeamSlipped,
        FaultKind::BeamTurned,
        FaultKind::BeamBumped,
        FaultKind::HolderShifted,
        FaultKind::Jam,
        FaultKind::PegMissing,
        FaultKind::TagCovered,
        FaultKind::CameraFrozen,
        FaultKind::GripperWeak,
        FaultKind::ForceDrift,
    ];

    /// The name on the command line and in results.
    pub fn name(self) -> &'static str {
        match self {
            FaultKind::PegDropped => "peg-dropped",
            FaultKind::PegTilted => "peg-tilted",
            FaultKind::BeamSlipped => "beam-slipped",
            FaultKind::BeamTurned => "beam-turned",
            FaultKind::BeamBumped => "beam-bumped",
            FaultKind::HolderShifted => "holder-shifted",
            FaultKind::Jam => "jam",
            FaultKind::PegMissing => "peg-missing",
            FaultKind::TagCovered => "tag-covered",
            FaultKind::CameraFrozen => "camera-frozen",
            FaultKind::GripperWeak => "gripper-weak",
            FaultKind::ForceDrift => "force-drift",
        }
    }

    /// What its occasions are, of which one is number N.
    pub fn occasions(self) -> &'static str {
        match self {
            FaultKind::PegDropped | FaultKind::PegTilted | FaultKind::HolderShifted => "the lifts of a peg",
            FaultKind::BeamSlipped | FaultKind::BeamTurned => "the lifts of a beam",
            FaultKind::BeamBumped => {
                "the times the hand leaves the assembly while a beam stands in it that is not clamped"
            }
            FaultKind::Jam => "the insertions: what is held touches a beam that stands in the assembly",
            FaultKind::PegMissing => "the kit's pegs in their order",
            FaultKind::TagCovered => "the tags of the goal's beams in their order",
            FaultKind::GripperWeak => "the times the fingers close on a part",
            FaultKind::CameraFrozen | FaultKind::ForceDrift => "the grasps of a part",
        }
    }

    /// Among how many of the first occasions one is drawn: those that every episode of a goal of `connections` pegs and
    /// `beams` beams beside the clamped one has, three at most where it is the work that makes them.
    fn drawn_among(self, kit: &Kit, setup: &Setup) -> usize {
        let connections = setup.assembly.connections.len();
        let beams = setup.assembly.beams.len().saturating_sub(1);
        match self {
            FaultKind::PegDropped | FaultKind::PegTilted => connections.min(3),
            // So that a peg is wanted afterwards.
            FaultKind::HolderShifted => connections.saturating_sub(1).min(3),
            FaultKind::BeamSlipped | FaultKind::BeamTurned | FaultKind::BeamBumped => beams.min(3),
            FaultKind::Jam | FaultKind::CameraFrozen | FaultKind::GripperWeak | FaultKind::ForceDrift => {
                (connections + beams).min(3)
            }
            FaultKind::PegMissing => connections.min(kit.pegs.len()),
            FaultKind::TagCovered => coverable_tags(setup).len(),
        }
    }
}

/// One fault of an episode.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fault {
    /// What goes wrong.
    pub kind: FaultKind,
    /// At which of its occasions ([`FaultKind::occasions`]), from 1; `None` has it drawn from the seed.
    pub occasion: Option<u32>,
}

impl fmt::Display for Fault {
    /// As it is written on the command line.
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self.occasion {
            Some(occasion) => write!(f, "{}@{occasion}", self.kind.name()),
            None => f.write_str(self.kind.name()),
        }
    }
}

/// What is written where a fault should be.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum FaultError {
    /// There is no such kind.
    #[error("there is no fault `{found}`; {help}")]
    Kind {
        /// What was found.
        found: String,
        /// What is near it, or all that there are.
        help: String,
    },
    /// After the `@` is no number of an occasion.
    #[error("`{found}` is no occasion of the fault `{kind}`: expected a number from 1 after the @")]
    Occasion {
        /// The kind.
        kind: &'static str,
        /// What was found.
        found: String,
    },
}

impl FromStr for Fault {
    type Err = FaultError;

    /// Reads `KIND` or `KIND@N`.
    ///
    /// ```
    /// use ramp_twin::{Fault, FaultKind};
    /// let fault: Fault = "peg-dropped@2".parse().unwrap();
    /// assert_eq!(fault, Fault { kind: FaultKind::PegDropped, occasion: Some(2) });
    /// assert_eq!("jam".parse(), Ok(Fault { kind: FaultKind::Jam, occasion: None }));
    /// assert!("peg-droped".parse::<Fault>().unwrap_err().to_string().contains("`peg-dropped`"));
    /// assert!("jam@0".parse::<Fault>().is_err());
    /// ```
    fn from_str(text: &str) -> Result<Fault, FaultError> {
        let (word, number) = match text.split_once('@') {
            Some((word, number)) => (word, Some(number)),
            None => (text, None),
        };
        let Some(kind) = FaultKind::ALL.into_iter().find(|kind| kind.name() == word) else {
            let names = FaultKind::ALL.map(FaultKind::name);
            let help = nearest(word, names).map_or_else(
                || format!("there are {}", names.join(", ")),
                |near| format!("did you mean `{near}`?"),
            );
            return Err(FaultError::Kind { found: shorten(word), help });
        };
        let occasion = match number {
            None => None,
            Some(number) => match number.parse().ok().filter(|it| *it > 0) {
                Some(number) => Some(number),
                None => return Err(FaultError::Occasion { kind: kind.name(), found: shorten(number) }),
            },
        };
        Ok(Fault { kind, occasion })
    }
}

/// What became of a fault: for the result alone.
#[derive(Clone, Debug, PartialEq)]
pub struct FaultReport {
    /// What went wrong.
    pub kind: FaultKind,
    /// At which of its occasions, from 1.
    pub occasion: u32,
    /// Robot time at which it struck, s; `None` when the occasion has not come.
    pub at: Option<f64>,
    /// The part that it struck, where it struck one.
    pub part: Option<String>,
    /// How large it was, in the unit that the text names: m, rad, N, N/s or s; `None` where it has no size.
    pub size: Option<f64>,
    /// What happened, for a person.
    pub text: String,
}

/// The numbers of a fault, drawn at the start and all at once, so that none depends on what the agent does: each
/// uniform in 0 ≤ x < 1, but for the occasion.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Draws {
    pub occasion: u32,
    pub size: f64,
    pub side: f64,
    pub delay: f64,
    pub angle: f64,
    pub second: f64,
}

impl Draws {
    fn new(fault: Fault, setup: &Setup) -> Draws {
        let mut stream = Stream::new(setup.seed, &format!("fault-{}", fault.kind.name()));
        let among = fault.kind.drawn_among(setup.kit, setup).max(1);
        let drawn = (stream.uniform() * among as f64) as u32 + 1;
        let mut next = || stream.uniform();
        Draws {
            occasion: fault.occasion.unwrap_or(drawn),
            size: next(),
            side: next(),
            delay: next(),
            angle: next(),
            second: next(),
        }
    }
}

/// What a fault changes of the start.
#[derive(Clone, Debug, Default)]
pub(crate) struct Start {
    /// The peg that is not there.
    pub missing: Option<String>,
    /// The tag that is covered, and the beam it is on.
    pub covered: Option<(u32, String)>,
    /// Whether the holders can be pushed over the table.
    pub loose_holders: bool,
}

impl Start {
    pub fn new(setup: &Setup) -> Start {
        let Some(fault) = setup.fault else { return Start::default() };
        let index = Draws::new(fault, setup).occasion as usize - 1;
        match fault.kind {
            FaultKind::PegMissing => {
                Start { missing: setup.kit.pegs.get(index).map(|peg| peg.name.clone()), ..Start::default() }
            }
            FaultKind::TagCovered => {
                Start { covered: coverable_tags(setup).into_iter().nth(index), ..Start::default() }
            }
            FaultKind::HolderShifted => Start { loose_holders: true, ..Start::default() },
            _ => Start::default(),
        }
    }
}

/// The tags of beams of the goal that have another one, by which the beam can still be found; the clamped beam is left
/// out.
fn coverable_tags(setup: &Setup) -> Vec<(u32, String)> {
    let places = tags::places(setup.kit);
    let assembly = setup.assembly;
    let beams = assembly.beams.iter().enumerate().filter(|(index, _)| *index != assembly.base);
    let mut found = Vec::new();
    for (_, placed) in beams {
        let on: Vec<u32> =
            places.iter().filter(|place| place.part == placed.beam.name).map(|place| place.id).collect();
        if on.len() > 1 {
            found.extend(on.into_iter().map(|id| (id, placed.beam.name.clone())));
        }
    }
    found
}
