//! The random numbers of a fault, drawn from the seed before anything moves, and its changes to the start.

use super::kind::FaultKind;
use super::spec::Fault;
use crate::setup::Setup;
use ramp_kit::{Kit, tags};
use ramp_robot::random::Stream;

/// The numbers of a fault, drawn at the start and all at once, so that none depends on what the agent does:
/// each uniform in 0 ≤ x < 1, except the occasion.
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
    /// The numbers of a fault in an episode.
    pub fn new(fault: Fault, setup: &Setup) -> Draws {
        let mut stream = Stream::new(setup.seed, &format!("fault-{}", fault.kind.name()));
        let among = drawn_among(fault.kind, &setup.assembly.kit, setup).max(1);
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

/// Number of first occasions among which one is drawn: only those that every episode of the goal has. At most
/// three if they depend on the progress of the work.
fn drawn_among(kind: FaultKind, kit: &Kit, setup: &Setup) -> usize {
    let connections = setup.assembly.connections.len();
    let beams = setup.assembly.beams.len().saturating_sub(1);
    match kind {
        FaultKind::PegDropped | FaultKind::PegTilted => connections.min(3),
        // So that a peg is needed afterwards.
        FaultKind::HolderShifted => connections.saturating_sub(1).min(3),
        FaultKind::BeamSlipped | FaultKind::BeamTurned | FaultKind::BeamBumped => beams.min(3),
        FaultKind::Jam | FaultKind::CameraFrozen | FaultKind::GripperWeak | FaultKind::ForceDrift => {
            (connections + beams).min(3)
        }
        FaultKind::PegMissing => connections.min(kit.pegs.len()),
        FaultKind::TagCovered => coverable_tags(setup).len(),
    }
}

/// Changes that a fault makes to the start.
#[derive(Clone, Debug, Default)]
pub(crate) struct Start {
    /// The missing peg.
    pub missing: Option<String>,
    /// The tag that is covered, and the beam it is on.
    pub covered: Option<(u32, String)>,
    /// Whether the holders can slide on the table.
    pub loose_holders: bool,
}

impl Start {
    /// The start of an episode.
    pub fn new(setup: &Setup) -> Start {
        let Some(fault) = setup.fault else { return Start::default() };
        let index = Draws::new(fault, setup).occasion as usize - 1;
        match fault.kind {
            FaultKind::PegMissing => Start {
                missing: setup.assembly.kit.pegs.get(index).map(|peg| peg.name.clone()),
                ..Start::default()
            },
            FaultKind::TagCovered => {
                Start { covered: coverable_tags(setup).into_iter().nth(index), ..Start::default() }
            }
            FaultKind::HolderShifted => Start { loose_holders: true, ..Start::default() },
            _ => Start::default(),
        }
    }
}

/// The tags of the goal's beams that can be covered: those of beams with another tag, by which the beam can
/// still be found. The clamped beam is left out.
fn coverable_tags(setup: &Setup) -> Vec<(u32, String)> {
    let places = tags::places(&setup.assembly.kit);
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
