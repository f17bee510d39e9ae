//! Tracks: how an agent observes the parts.

/// How an agent observes the parts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Track {
    /// Exact poses from the simulator.
    State,
    /// Poses from the simulator with noise on each reading; some readings are missing.
    Noisy,
    /// Camera images alone, with the parts' tags in them.
    Tags,
    /// Camera images alone, with no tag on any part and none on the sheet.
    Colour,
}

impl Track {
    /// All of them.
    pub const ALL: [Track; 4] = [Track::State, Track::Noisy, Track::Tags, Track::Colour];

    /// The name on the command line and in results.
    pub fn name(self) -> &'static str {
        match self {
            Track::State => "state",
            Track::Noisy => "noisy",
            Track::Tags => "tags",
            Track::Colour => "colour",
        }
    }

    /// Whether the agent has images instead of poses of the parts.
    pub fn gives_images(self) -> bool {
        matches!(self, Track::Tags | Track::Colour)
    }

    /// Whether tags stick on the parts and are printed on the sheet. Without them, parts of one shape cannot
    /// be told apart: each is called by the outline on which it lies at the start.
    pub fn has_tags(self) -> bool {
        self != Track::Colour
    }
}
