//! Constants that all film formats share.

/// Size of a film, pixels.
pub const SIZE: [usize; 2] = [800, 500];
/// Display time of the last frame, s.
pub const LAST: f64 = 3.0;
