//! The track of perception alone: the verdict on a detector as a result file.

use serde::{Deserialize, Serialize};

use crate::episode::Software;
use crate::words;

/// The version of the schema of these files.
pub const SCHEMA: &str = "ramp-perception-1";
/// Position error above which a pose is false, m.
pub const FALSE: f64 = 5.0e-3;
/// Largest number of cells in a table.
const MOST_CELLS: usize = 1000;
/// Largest number of false poses: more than fit into a result file.
const MOST_FALSE: usize = 1_000_000;

/// The verdict on one detector for one set of images.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PerceptionVerdict {
    /// [`SCHEMA`].
    pub schema: String,
    /// Name of the detector.
    pub detector: String,
    /// SHA-256 of the labels, in hex: only verdicts on the same images are compared.
    pub labels: String,
    /// Number of images.
    pub views: usize,
    /// The program that judged it.
    pub software: Software,
    /// By camera, distance and angle.
    pub cells: Vec<ViewRange>,
    /// Number of poses reported.
    pub poses: usize,
    /// The false ones among them.
    pub false_poses: Vec<FalsePose>,
}

/// Parts seen by one camera from about the same distance and angle.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ViewRange {
    /// `wrist` or `birds-eye`.
    pub camera: String,
    /// Range of distances of the tags, m; the last range may be open.
    pub distance: [Option<f64>; 2],
    /// Range of angles of the tags, degrees; the last range may be open.
    pub angle: [Option<f64>; 2],
    /// Parts with a tag wholly in view.
    pub parts: usize,
    /// Number of them that were found.
    pub found: usize,
    /// Position error at the middle of the part's nearest tag, median and 95 %, m; null when none was found.
    pub position: Option<[f64; 2]>,
    /// Rotation error, median and 95 %, rad; null when none was found.
    pub turn: Option<[f64; 2]>,
}

/// A pose with a large error, or of a part that shows no tag.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FalsePose {
    /// The image.
    pub file: String,
    /// The part.
    pub part: String,
    /// Position error, m; null for a part that shows no tag.
    pub error: Option<f64>,
}

impl PerceptionVerdict {
    /// Number of parts to be found, and number found.
    pub fn found(&self) -> [usize; 2] {
        self.cells.iter().fold([0, 0], |[parts, found], cell| [parts + cell.parts, found + cell.found])
    }

    /// Checks that the verdict is consistent.
    ///
    /// # Errors
    /// The contradiction, in words.
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
                return Err("a cell has errors exactly where a part was found".to_string());
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
