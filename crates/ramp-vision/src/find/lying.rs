//! Prior of a part that nothing has touched: it lies on the sheet.

use ramp_kit::{Holder, Kit};

/// Prior of the pose of a part, valid as long as nothing has touched it.
#[derive(Clone, Debug, PartialEq)]
pub struct Lying {
    /// The part.
    pub part: String,
    /// Height of its origin in the world, m.
    pub height: f64,
    /// Does its z axis point down?
    pub flipped: bool,
    /// Uncertainty of the height (m) and the tilt (rad), 1 σ. It includes that of the camera's calibration.
    pub sigma: [f64; 2],
}

impl Lying {
    /// Uncertainty of height and tilt with uncalibrated cameras: 1.5 mm and 0.4°.
    pub const SIGMA: [f64; 2] = [1.5e-3, 0.007];

    /// All parts as the sheet has them.
    pub fn at_start(kit: &Kit) -> Vec<Lying> {
        let beams = kit.beams.iter().map(|beam| Lying {
            part: beam.name.clone(),
            height: beam.axis_height_on_table(),
            flipped: beam.start.is_some_and(|start| start.flipped),
            sigma: Lying::SIGMA,
        });
        let pegs = kit.pegs.iter().map(|peg| Lying {
            part: peg.name.clone(),
            height: Holder::HEIGHT,
            flipped: false,
            sigma: Lying::SIGMA,
        });
        beams.chain(pegs).collect()
    }
}
