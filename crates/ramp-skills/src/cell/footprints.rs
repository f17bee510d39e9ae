//! The room on the table: the rectangles that parts take there.

use ramp_kit::shape::{Shape, beam_shapes};
use ramp_kit::{Beam, Footprint, Holder};

use super::workcell::Workcell;
use crate::Pose;

impl Workcell<'_, '_> {
    /// The footprints of all beams and holders but this beam.
    pub fn around(&self, but: &Beam) -> Vec<Footprint> {
        let parts = &self.belief.parts;
        let mut around = Vec::new();
        for beam in self.kit.beams.iter().filter(|beam| beam.name != but.name) {
            around.extend(parts.pose(&beam.name).map(|x_wb| footprints(beam, &x_wb)).unwrap_or_default());
        }
        for (_, x_wh) in parts.holders(self.kit) {
            around.extend(Holder::blocks().iter().map(|block| Footprint::new(&x_wh, block)));
        }
        around
    }
}

/// A beam as rectangles on the table.
pub fn footprints(beam: &Beam, x_wb: &Pose) -> Vec<Footprint> {
    let bounds = beam_shapes(beam).iter().map(Shape::bounds).collect::<Vec<_>>();
    bounds.iter().map(|bounds| Footprint::new(x_wb, bounds)).collect()
}

/// Whether a beam at this pose is clear of some footprints by a distance along the table, m.
pub fn is_clear(beam: &Beam, x_wb: &Pose, others: &[Footprint], distance: f64) -> bool {
    footprints(beam, x_wb).iter().all(|own| others.iter().all(|other| own.is_clear(other, distance)))
}
