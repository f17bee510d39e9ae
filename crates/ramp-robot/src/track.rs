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
    /// The same, with the measured distance in each pixel.
    Depth,
}

impl Track {
    /// All of them.
    pub const ALL: [Track; 5] = [Track::State, Track::Noisy, Track::Tags, Track::Colour, Track::Depth];

    /// The name on the command line and in results.
    pub fn name(self) -> &'static str {
        match self {
            Track::State => "state",
            Track::Noisy => "noisy",
            Track::Tags => "tags",
            Track::Colour => "colour",
            Track::Depth => "depth",
        }
    }

    /// Whether the agent has images instead of poses of the parts.
    pub fn gives_images(self) -> bool {
        matches!(self, Track::Tags | Track::Colour | Track::Depth)
    }

    /// Whether tags stick on the parts and are printed on the sheet. Without them, parts of one shape cannot
    /// be told apart: each is called by the outline on which it lies at the start.
    pub fn has_tags(self) -> bool {
        !matches!(self, Track::Colour | Track::Depth)
    }

    /// Whether images come with depth.
    pub fn has_depth(self) -> bool {
        self == Track::Depth
    }
}
