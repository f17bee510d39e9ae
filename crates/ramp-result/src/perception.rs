//! The track of perception alone: the verdict on a detector as a result file.

use serde::{Deserialize, Serialize};

use crate::episode::Software;
use crate::words;

/// The version of the schema of these files.
pub const SCHEMA: &str = "ramp-perception-1";
/// A pose that is further off than this is false, m.
pub const FALSE: f64 = 5.0e-3;
/// The most cells of a table.
const MOST_CELLS: usize = 1000;
/// The most false poses: more than fit a result file.
const MOST_FALSE: usize = 1_000_000;

/// What came of judging one detector on one set of images.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PerceptionVerdict {
    /// [`SCHEMA`].
    pub schema: String,
    /// What it is called.
    pub detector: String,
    /// SHA-256 of the labels, in hex: verdicts on different images are not compared.
    pub labels: String,
    /// How many images.
    pub views: usize,
    /// With what it was judged.
    pub software: Software,
    /// By camera, distance and angle.
    pub cells: Vec<ViewRange>,
    /// Poses given.
    pub poses: usize,
    /// Those that are wrong.
    pub false_poses: Vec<FalsePose>,
}

/// Parts that one camera sees from about one distance and angle.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ViewRange {
    /// `wrist` or `birds-eye`.
    pub camera: String,
    /// Distances of tags, m; the last one may have no end.
    pub distance: [Option<f64>; 2],
    /// Angles of tags, degrees; the last one may have no end.
    pub angle: [Option<f64>; 2],
    /// Parts with a tag wholly in view.
    pub parts: usize,
    /// How many of them were found.
    pub found: usize,
    /// Position error at the middle of the part's nearest tag, median and 95 %, m; null when none was found.
    pub position: Option<[f64; 2]>,
    /// Turn between found and true, median and 95 %, rad; null when none was found.
    pub turn: Option<[f64; 2]>,
}

/// A pose that is far off, or of a part that shows no tag.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FalsePose {
    /// The image.
    pub file: String,
    /// The part.
    pub part: String,
    /// How far off it is, m; null for a part that shows no tag.
    pub error: Option<f64>,
}

impl PerceptionVerdict {
    /// Parts that are to be found, and those that were.
    pub fn found(&self) -> [usize; 2] {
        self.cells.iter().fold([0, 0], |[parts, found], cell| [parts + cell.parts, found + cell.found])
    }

    /// Can this be?
    ///
    /// # Errors
    /// What contradicts what, in words.
    pub fn check(&self) -> Result<(), String> {
        words::name("the detector", &self.detector)?;
        words::hash("the hash of the labels", &self.labels, 64)?;
        words::software(&self.software)?;
        words::few("cells", &self.cells, MOST_CELLS)?;
        words::few("false poses", &self.false_poses, MOST_FALSE)?;
        for it in &self.false_poses {
            words::name("an image", &it.file)?;
            words::name("a part", &it.part)?;
        }
        for cell in &self.cells {
            words::name("a camera", &cell.camera)?;
            if cell.found > cell.parts {
                return Err(format!("{} of {} parts were found", cell.found, cell.parts));
            }
            if cell.position.is_some() != (cell.found > 0) || cell.turn.is_some() != (cell.found > 0) {
                return Err("errors are told where a part was found, and nowhere else".to_string());
            }
            let mut errors = cell.position.iter().chain(&cell.turn).flatten();
            if let Some(wrong) = errors.find(|error| !(0.0..=1e3).contains(*error)) {
                return Err(format!("an error is {wrong}"));
            }
        }
        if self.false_poses.len() > self.poses {
            return Err(format!("{} of {} poses are false", self.false_poses.len(), self.poses));
        }
        Ok(())
    }
}
