//! The check of a state in which an episode is to begin.

use ramp_referee::DEEPEST;
use ramp_twin::{Setup, Twin, TwinError};

/// Reasons for which an episode cannot begin in its state.
#[derive(Debug, thiserror::Error)]
pub enum GivenError {
    /// The twin cannot be made.
    #[error(transparent)]
    Twin(#[from] TwinError),
    /// Parts are too deep in each other.
    #[error(
        "the state cannot be: {} and {} are {:.2} mm in each other, expected at most {:.2} mm",
        parts[0], parts[1], depth * 1e3, DEEPEST * 1e3
    )]
    Penetration {
        /// Names of both.
        parts: [String; 2],
        /// Depth, m.
        depth: f64,
    },
}

/// Checks that no part begins deeper in another thing than the referee accepts. Without a state, there is
/// nothing to check.
///
/// # Errors
/// The deepest contact, if it is deeper than [`DEEPEST`].
pub fn check_given(setup: &Setup) -> Result<(), GivenError> {
    if setup.state.is_none() {
        return Ok(());
    }
    match Twin::new(setup)?.deepest_contact() {
        Some((parts, depth)) if depth > DEEPEST => Err(GivenError::Penetration { parts, depth }),
        _ => Ok(()),
    }
}
