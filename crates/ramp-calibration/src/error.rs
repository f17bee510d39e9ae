//! Recordings that no calibration can be made from.

use ramp_source::ReadError;
use ramp_vision::SightError;

/// Reasons why there is no estimate.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
#[non_exhaustive]
pub enum CalibrationError {
    /// A file that cannot be read.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Read(#[from] ReadError),
    /// An invalid entry of a table or a calibration file.
    #[error("{file}:{line}: found {found}, expected {expected}")]
    Entry {
        /// The file.
        file: String,
        /// Its line, from 1.
        line: usize,
        /// The text found.
        found: String,
        /// The text expected.
        expected: String,
    },
    /// A file that is no image, or one of another size.
    #[error("{file}: {why}")]
    Image {
        /// The file.
        file: String,
        /// The reason.
        why: String,
    },
    /// An image in which nothing can be seen.
    #[error("{file}: {why}")]
    Sight {
        /// The file.
        file: String,
        /// The reason.
        why: SightError,
    },
    /// Too little data.
    #[error("found {found} {what}, expected at least {least}")]
    #[diagnostic(help("{help}"))]
    TooFew {
        /// The data of which there is too little.
        what: &'static str,
        /// Their number.
        found: usize,
        /// The least number.
        least: usize,
        /// The data to record.
        help: &'static str,
    },
    /// Data that leave a direction open.
    #[error("{why}")]
    #[diagnostic(help("{help}"))]
    Degenerate {
        /// The property that the data have in common.
        why: String,
        /// The data to record.
        help: &'static str,
    },
    /// The calibration file has no lens of this camera.
    #[error("{file} holds no lens of the camera `{camera}`")]
    #[diagnostic(help("calibrate it first: `ramp calibrate lens IMAGES --camera {camera} -o {file}`"))]
    NoLens {
        /// The calibration file.
        file: String,
        /// The camera.
        camera: &'static str,
    },
    /// The tag detector does not start.
    #[error(transparent)]
    Detector(SightError),
}
