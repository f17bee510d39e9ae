//! The places from which the parts came, at which they lie and to which they belong, and everything that
//! stands around the hand.

use nalgebra::Vector3;
use ramp_kit::{Holder, Kit};
use ramp_motion::Obstacle;
use ramp_vision::Lying;

use super::obstacles::{beam_boxes, holder_boxes, peg_boxes};
use super::outlines;
use super::part::{Frame, Part};
use super::parts::Belief;
use crate::Pose;

impl Belief {
    /// The place on the sheet from which a part came: where it was found, or the outline that is nearest to
    /// where it is believed. `None` for the clamped beam and after the part was built in or lost without
    /// having been found.
    pub fn place(&self, part: &str) -> Option<Pose> {
        let part = self.parts.get(part).filter(|part| part.frame != Frame::Clamped)?;
        let off = |x: &&Pose| (x.translation.vector - part.estimate.x.translation.vector).norm();
        let nearest = || part.outlines.iter().min_by(|a, b| off(a).total_cmp(&off(b))).copied();
        part.found.or_else(|| nearest().filter(|_| part.frame == Frame::World))
    }

    /// The outlines on which a part that was never seen may lie: those on which no seen part was found.
    pub fn free_outlines(&self, part: &str) -> Vec<Pose> {
        let outlines = self.parts.get(part).map_or(&[][..], |part| &part.outlines);
        let taken = |x: &Pose| {
            self.parts.iter().any(|(other, it)| {
                let place = self.place(other).filter(|_| it.seen && other != part);
                place.is_some_and(|place| {
                    (place.translation.vector - x.translation.vector).norm() < Holder::PITCH / 2.0
                })
            })
        };
        outlines.iter().filter(|x| !taken(x)).copied().collect()
    }

    /// Poses of the holders, by the pegs that were found in them.
    pub fn holders(&self, kit: &Kit) -> Vec<(String, Pose)> {
        if self.anywhere {
            return outlines::holders_anywhere(kit, |peg| self.parts.get(peg)?.found);
        }
        outlines::holders(kit, kit.pegs.iter().filter_map(|peg| self.parts.get(&peg.name)?.found))
    }

    /// Constraints on resting parts: which are level, and their heights.
    pub(super) fn lying(&self) -> Vec<Lying> {
        let lying = |(name, part): (&String, &Part)| {
            let x_wp = self.find(name).unwrap_or(part.estimate.x);
            let up = (x_wp.rotation * Vector3::z()).z;
            let tilt = (part.estimate.covariance[(3, 3)] + part.estimate.covariance[(4, 4)]).sqrt();
            if up.abs() < self.parameters.level || tilt > self.parameters.tilted {
                return None;
            }
            let height = part.estimate.covariance[(2, 2)].sqrt();
            let sigma = [height.max(Lying::SIGMA[0]), tilt.max(Lying::SIGMA[1])];
            Some(Lying { part: name.clone(), height: x_wp.translation.z, flipped: up < 0.0, sigma })
        };
        self.parts.iter().filter_map(lying).collect()
    }

    /// Whether a part may be anywhere, and so stands in no way.
    pub fn is_lost(&self, part: &str) -> bool {
        let anywhere = self.parameters.anywhere.powi(2);
        self.parts.get(part).is_some_and(|part| part.estimate.covariance[(0, 0)] > anywhere)
    }

    /// Everything that stands around, as boxes in the world, without the parts named in `without`.
    pub fn obstacles(&self, kit: &Kit, without: &[&str]) -> Vec<Obstacle> {
        let mut obstacles = Vec::new();
        let left_out = |name: &str| without.contains(&name) || self.is_lost(name);
        for beam in kit.beams.iter().filter(|beam| !left_out(&beam.name)) {
            if let Some(x_wb) = self.find(&beam.name) {
                obstacles.extend(beam_boxes(beam, &x_wb));
            }
        }
        for peg in kit.pegs.iter().filter(|peg| !left_out(&peg.name)) {
            if let Some(x_wp) = self.find(&peg.name) {
                obstacles.extend(peg_boxes(&peg.name, &x_wp));
            }
        }
        obstacles.extend(holder_boxes(&self.holders(kit)));
        obstacles
    }
}
