//! The twin's cameras: when they expose.

/// How long the shutter is open, in control periods of a millisecond.
pub const EXPOSURE_STEPS: u32 = 8;
/// From the end of the exposure until the agent has the image, in control periods: reading it out and sending it.
pub const LATENCY_STEPS: u32 = 34;
