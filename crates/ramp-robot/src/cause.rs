//! What an agent can tell of what goes wrong, in words that whoever judges it understands.

use std::fmt;

/// What an agent may say was the cause.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cause {
    /// A part left the grip, or is not where it was put.
    PartLost,
    /// A part sits in the grip otherwise than it should.
    GripMoved,
    /// A beam of the assembly is not where it stood.
    BeamMoved,
    /// A holder is not where it stood.
    HolderMoved,
    /// Something blocks an insertion.
    Jam,
    /// A part was never there.
    PartMissing,
    /// What is seen cannot be relied on, or something is not to be seen.
    Sight,
    /// The gripper does not close as it is told.
    GripWeak,
    /// The wrist feels a force where there is none.
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

    /// The word in an event.
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

    /// The cause that the text of a diagnosis names; `None` when it is no such text.
    ///
    /// ```
    /// use ramp_robot::Cause;
    /// assert_eq!(Cause::told("jam: b4 stands still at 25 N"), Some(Cause::Jam));
    /// assert_eq!(Cause::told("I do not know"), None);
    /// ```
    pub fn told(text: &str) -> Option<Cause> {
        let (word, _) = text.split_once(':')?;
        Cause::ALL.into_iter().find(|cause| cause.name() == word.trim())
    }
}

impl fmt::Display for Cause {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(self.name())
    }
}
