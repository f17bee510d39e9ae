//! The causes of disturbances that an agent can name in a diagnosis.

use std::fmt;

use serde::{Deserialize, Serialize};

/// The cause of a disturbance, as an agent diagnoses it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Cause {
    /// A part left the grasp, or is not where it was put.
    PartLost,
    /// A part has moved in the grasp.
    GripMoved,
    /// A beam of the assembly is not where it stood.
    BeamMoved,
    /// A holder is not where it stood.
    HolderMoved,
    /// Something blocks an insertion.
    Jam,
    /// A part was never there.
    PartMissing,
    /// The images cannot be relied on, or a part cannot be seen.
    Sight,
    /// The gripper does not close as commanded.
    GripWeak,
    /// The wrist measures a force where there is none.
    ForceBias,
}

impl Cause {
    /// All of them.
    pub const ALL: [Cause; 9] = [
        Cause::PartLost,
        Cause::GripMoved,
        Cause::BeamMoved,
        Cause::HolderMoved,
        Cause::Jam,
        Cause::PartMissing,
        Cause::Sight,
        Cause::GripWeak,
        Cause::ForceBias,
    ];

    /// Its name in events.
    pub fn name(self) -> &'static str {
        match self {
            Cause::PartLost => "part-lost",
            Cause::GripMoved => "grip-moved",
            Cause::BeamMoved => "beam-moved",
            Cause::HolderMoved => "holder-moved",
            Cause::Jam => "jam",
            Cause::PartMissing => "part-missing",
            Cause::Sight => "sight",
            Cause::GripWeak => "grip-weak",
            Cause::ForceBias => "force-bias",
        }
    }

    /// The cause of this name.
    pub fn named(name: &str) -> Option<Cause> {
        Cause::ALL.into_iter().find(|cause| cause.name() == name)
    }
}

impl fmt::Display for Cause {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(self.name())
    }
}
