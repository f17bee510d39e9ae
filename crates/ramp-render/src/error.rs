//! Errors of loading meshes and textures.

use ramp_kit::solid::SolidError;

/// Cause of the error.
#[derive(Debug, thiserror::Error)]
pub enum LooksError {
    /// A part of the kit.
    #[error(transparent)]
    Solid(#[from] SolidError),
    /// The sheet.
    #[error("the sheet cannot be drawn: {0}")]
    Sheet(String),
    /// A part has a tag that the family does not have.
    #[error("unknown tag {0}")]
    Tag(u32),
}
