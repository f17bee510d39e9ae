//! What all films share.

/// Pixels of a film.
pub const SIZE: [usize; 2] = [800, 500];
/// How long the last frame stands, s.
pub const LAST: f64 = 3.0;
