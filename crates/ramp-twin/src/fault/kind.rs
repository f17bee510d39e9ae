//! The kinds of faults.

/// A kind of fault.
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
    /// The holder from which a peg was lifted is pushed by 3 to 8 mm; if it is empty, another one with pegs
    /// in it.
    HolderShifted,
    /// An inserted part meets an obstacle that gives way only at 25 to 35 N, for 4 to 8 s.
    Jam,
    /// A peg of the kit is missing.
    PegMissing,
    /// A tag of a beam of the goal is covered with white for the whole episode.
    TagCovered,
    /// Both cameras repeat their last image for 5 s.
    CameraFrozen,
    /// The fingers spring back by 2 to 4 mm when they touch a part, and stay there until they are opened.
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

    /// Description of its occasions, which are numbered from 1.
    pub fn occasions(self) -> &'static str {
        match self {
            FaultKind::PegDropped | FaultKind::PegTilted | FaultKind::HolderShifted => "the lifts of a peg",
            FaultKind::BeamSlipped | FaultKind::BeamTurned => "the lifts of a beam",
            FaultKind::BeamBumped => {
                "the times the hand leaves the assembly while a beam stands in it that is not clamped"
            }
            FaultKind::Jam => {
                "the insertions: a held part moves within 0.5 mm of a beam that stands in the assembly"
            }
            FaultKind::PegMissing => "the kit's pegs in their order",
            FaultKind::TagCovered => "the tags of the goal's beams in their order",
            FaultKind::GripperWeak => "the times the fingers close on a part",
            FaultKind::CameraFrozen | FaultKind::ForceDrift => "the grasps of a part",
        }
    }
}
