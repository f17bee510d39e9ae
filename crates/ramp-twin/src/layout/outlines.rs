//! The outline of the sheet on which each part lies: its own, or where parts trade places that of another
//! part of its shape.

use std::collections::BTreeMap;

use ramp_kit::{Beam, Kit, Pose};
use ramp_robot::random::Stream;

/// The part on whose outline each part lies, by name.
pub struct Outlines<'k> {
    kit: &'k Kit,
    of: BTreeMap<String, String>,
}

impl<'k> Outlines<'k> {
    /// For an episode with this seed. The beam `base` lies on none.
    pub fn new(kit: &'k Kit, base: &str, trade: bool, seed: u64) -> Outlines<'k> {
        let mut of = BTreeMap::new();
        if trade {
            let mut stream = Stream::new(seed, "trade");
            let beams = kit.beams.iter().filter(|beam| beam.name != base && beam.start.is_some());
            let mut shapes: Vec<Vec<&Beam>> = Vec::new();
            for beam in beams {
                match shapes.iter_mut().find(|shape| shape[0].has_shape_of(beam)) {
                    Some(shape) => shape.push(beam),
                    None => shapes.push(vec![beam]),
                }
            }
            for shape in shapes {
                let names: Vec<&str> = shape.iter().map(|beam| beam.name.as_str()).collect();
                of.extend(traded(&names, &mut stream));
            }
            let pegs: Vec<&str> = kit.pegs.iter().map(|peg| peg.name.as_str()).collect();
            of.extend(traded(&pegs, &mut stream));
        }
        Outlines { kit, of }
    }

    fn of<'n>(&'n self, part: &'n str) -> &'n str {
        self.of.get(part).map_or(part, String::as_str)
    }

    /// The pose of a beam on its outline, in the world; `None` for a beam without.
    pub fn beam(&self, beam: &Beam) -> Option<Pose> {
        self.kit.x_wb_start(self.kit.beam(self.of(&beam.name))?)
    }

    /// The pegs that stand in a holder on its outline: name and pose in the world.
    pub fn pegs_in(&self, holder: &str) -> Vec<(String, Pose)> {
        let in_holder = |peg: &ramp_kit::Peg| {
            let outline = self.kit.peg(self.of(&peg.name)).filter(|outline| outline.holder == holder)?;
            Some((peg.name.clone(), self.kit.x_wp_start(outline)?))
        };
        self.kit.pegs.iter().filter_map(in_holder).collect()
    }
}

/// Each name with the one whose outline it gets: a random permutation.
fn traded(names: &[&str], stream: &mut Stream) -> Vec<(String, String)> {
    let mut outlines: Vec<String> = names.iter().map(ToString::to_string).collect();
    // Fisher and Yates.
    for last in (1..outlines.len()).rev() {
        let index = (stream.uniform() * (last + 1) as f64) as usize;
        outlines.swap(last, index.min(last));
    }
    names.iter().map(ToString::to_string).zip(outlines).collect()
}
