//! Version of this program, as written to results.

use ramp_result::episode::Software;

/// The version and commit of this program.
pub fn software() -> Software {
    Software { version: env!("CARGO_PKG_VERSION").to_string(), commit: env!("RAMP_COMMIT").to_string() }
}
