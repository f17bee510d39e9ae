//! Why there are no looks.

use ramp_kit::solid::SolidError;

/// What could not be drawn.
#[derive(Debug, thiserror::Error)]
pub enum LooksError {
    /// A part of the kit.
    #[error(transparent)]
    Solid(#[from] SolidError),
    /// The sheet.
    #[error("the sheet cannot be drawn: {0}")]
    Sheet(String),
    /// A part has a tag that the family does not have.
    #[error("there is no tag {0}")]
    Tag(u32),
}
