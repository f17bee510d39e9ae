//! The JSON messages of a log of poses.

use ramp_result::episode::RobotKind;
use serde::Deserialize;

/// Identity of the run.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Head {
    /// Checked before all other fields.
    #[serde(rename = "schema")]
    pub _schema: String,
    pub rules: String,
    pub goal: String,
    pub repeat: u32,
    pub track: String,
    pub agent: String,
    pub version: String,
    pub robot: String,
    pub computer: String,
    pub cores: usize,
    pub scorer: String,
    pub source: String,
    pub begin: Stamp,
    pub planning: f64,
    pub end: Stamp,
    pub ended: String,
    /// Until when what stands was measured after the end.
    #[serde(default)]
    pub surveyed: Option<Stamp>,
    #[serde(default)]
    pub kind: RobotKind,
    /// The name of the arm.
    #[serde(default)]
    pub arm: Option<String>,
}

/// A time by the clock of the poses.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Stamp {
    pub sec: u64,
    pub nsec: u32,
}

impl Stamp {
    /// Seconds since `begin`, with the resolution of a nanosecond for any epoch.
    pub fn since(self, begin: Stamp) -> f64 {
        let whole = i128::from(self.sec) - i128::from(begin.sec);
        let nanoseconds = whole * 1_000_000_000 + i128::from(self.nsec) - i128::from(begin.nsec);
        nanoseconds as f64 / 1e9
    }
}

/// Measured poses of parts.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Sight {
    pub transforms: Vec<Transform>,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Transform {
    pub timestamp: Stamp,
    pub parent_frame_id: String,
    pub child_frame_id: String,
    pub translation: Vector,
    pub rotation: Rotation,
}

#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Vector {
    pub x: f64,
    pub y: f64,
    pub z: f64,
}

#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Rotation {
    pub x: f64,
    pub y: f64,
    pub z: f64,
    pub w: f64,
}
