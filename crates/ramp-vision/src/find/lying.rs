//! What is known of a part that nothing has touched: it lies on the sheet.

use ramp_kit::{Holder, Kit};

/// What is known of how a part lies, for as long as nothing has touched it.
#[derive(Clone, Debug, PartialEq)]
pub struct Lying {
    /// The part.
    pub part: String,
    /// Height of its origin in the world, m.
    pub height: f64,
    /// Does its z axis point down?
    pub flipped: bool,
    /// How sure the height (m) and the level (rad) are, 1 σ. What the camera's calibration leaves open counts too.
    pub sigma: [f64; 2],
}

impl Lying {
    /// How sure heights and levels are with the cameras as they come: 1.5 mm and 0.4°.
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
