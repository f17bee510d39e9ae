//! Names of parts that look alike: which of them is seen, and where those are that were not seen.

use nalgebra::Point3;
use ramp_kit::{Beam, Holder};
use ramp_robot::RobotError;
use ramp_vision::untagged::is_one_place;

use super::eye::Sighting;
use super::part::{Frame, Part};
use super::parts::Belief;
use crate::Pose;
use crate::hand::Hand;

impl Belief {
    /// Of each part that was never seen and may stand in the frame, its middle at each of its places there,
    /// m, in the world.
    pub fn unseen_places(&self) -> impl Iterator<Item = (&str, Vec<Point3<f64>>)> {
        let unseen = self.parts.iter().filter(|(_, part)| !part.seen && !self.anywhere);
        unseen.filter_map(|(name, _)| {
            let middle = self.kit.beam(name).map_or(0.0, |beam| beam.span() / 2.0);
            let places = self.places.get(name)?.iter().map(|x| x * Point3::new(middle, 0.0, 0.0));
            Some((name.as_str(), places.collect()))
        })
    }

    /// The beams that may stand in one another's places were told apart: each is looked for in its own place
    /// of the frame alone.
    pub fn are_told_apart(&mut self) {
        for beam in &self.kit.beams {
            self.places.entry(beam.name.clone()).and_modify(|places| places.truncate(1));
        }
    }

    /// Without tags, one of two parts that are seen in one place was taken for the other: the one that is
    /// nearer to its own place on the sheet is there. Gives whether a part that is seen for the first time is
    /// not; another one that is not is forgotten.
    pub(super) fn is_of_another(&mut self, sighting: &Sighting) -> bool {
        let new = self.parts.get(&sighting.part).filter(|part| !part.seen);
        let Some(part) = new.filter(|_| !self.eyes.tags() && self.eyes.images() && !self.anywhere) else {
            return false;
        };
        let (ends, x) = (|name: &str, x: &Pose| self.ends(name, x), &sighting.estimate.x);
        let off = |x: &Pose, from: &Pose| (x.translation.vector - from.translation.vector).norm();
        // The slot of a holder tells the name of its peg.
        let is_owner = |(name, other): (&String, &Part)| {
            let own = off(x, &other.prior.x);
            self.kit.peg(name).is_some() && own < Holder::PITCH / 2.0 && own < off(x, &part.prior.x)
        };
        if self.kit.peg(&sighting.part).is_some() && self.parts.iter().any(is_owner) {
            return true;
        }
        let is_there = |(name, other): &(&String, &Part)| {
            let seen = other.seen && other.frame == Frame::World;
            seen && is_one_place(ends(name, &other.estimate.x), ends(&sighting.part, x))
        };
        let Some((other, there)) = self.parts.iter().find(is_there) else { return false };
        if off(x, &part.prior.x) > off(&there.estimate.x, &there.prior.x) {
            return true;
        }
        let other = other.clone();
        self.parts.entry(other).and_modify(|part| (part.seen, part.estimate) = (false, part.prior.clone()));
        false
    }

    /// The ends of a part's axis, m, in the world; of a peg both are its middle.
    fn ends(&self, part: &str, x_wp: &Pose) -> [Point3<f64>; 2] {
        let span = self.kit.beam(part).map_or(0.0, Beam::span);
        [0.0, span].map(|along| x_wp * Point3::new(along, 0.0, 0.0))
    }

    /// Looks once with the camera on the hand, see [`Eyes::compare`](super::eyes::Eyes::compare).
    ///
    /// # Errors
    /// The robot's.
    pub fn compare(&mut self, hand: &mut Hand, names: [&str; 2]) -> Result<Option<[f64; 2]>, RobotError> {
        self.follow(hand);
        let surroundings = self.surroundings(hand);
        let off = self.eyes.compare(hand, &surroundings, names)?;
        self.follow(hand);
        Ok(off)
    }

    /// Two beams were taken for one another: each is where the other was believed to be. One that was not
    /// seen then lies on its own outline, as far as is known.
    pub fn exchange(&mut self, [one, other]: [&str; 2]) {
        let (Some(a), Some(b)) = (self.parts.get(one).cloned(), self.parts.get(other).cloned()) else {
            return;
        };
        for (name, from, own) in [(one, &b, &a), (other, &a, &b)] {
            let mut part = Part { outlines: own.outlines.clone(), prior: own.prior.clone(), ..from.clone() };
            if !part.seen {
                part.estimate = part.prior.clone();
            }
            self.parts.insert(name.to_string(), part);
        }
    }
}

#[cfg(test)]
mod tests {
    // A failed unwrap here is a failed test.
    #![allow(clippy::unwrap_used)]

    use std::path::Path;

    use ramp_robot::Track;
    use ramp_world::Start;

    use super::super::estimate::{Estimate, covariance};
    use super::*;
    use crate::parameters::Parameters;

    fn belief() -> Belief {
        let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data");
        let kit = ramp_kit::read_kit(&data.join("kit.xml")).unwrap();
        let assembly = ramp_assembly::read_goal(&data.join("goals/easy-3.xml"), &kit).unwrap();
        let arm = ramp_robot::arm::ArmModel::read(&data.join("arms/panda.json")).unwrap();
        let mut belief = Belief::new(&assembly, &arm, &Parameters::baseline(), Start::moved());
        belief.eyes.on_track(Track::Colour);
        belief
    }

    fn sighting(part: &str, x: Pose) -> Sighting {
        let estimate = Estimate { x, covariance: covariance([1.0e-4; 3], [1.0e-3; 3]) };
        Sighting { part: part.to_string(), estimate, nominal: None, x_wt: Pose::identity() }
    }

    fn see(belief: &mut Belief, part: &str, x: Pose) {
        belief.expect(part, x, ([1.0e-4; 3], [1.0e-3; 3]));
    }

    /// With the slot of p10 empty, its neighbour may be seen under its name: the slot tells that it is not
    /// p10.
    #[test]
    fn two_parts_are_not_seen_in_one_place() {
        let mut belief = belief();
        let slot = belief.parts["p11"].prior.x;
        assert!(belief.is_of_another(&sighting("p10", slot)));
        assert!(!belief.is_of_another(&sighting("p11", slot)));
        // In a hole of the frame the first one to be seen stays.
        let hole = belief.unseen_places().find(|(part, _)| *part == "p10").unwrap().1[0];
        let hole = Pose::translation(hole.x, hole.y, hole.z);
        assert!(!belief.is_of_another(&sighting("p10", hole)));
        see(&mut belief, "p10", hole);
        assert!(belief.is_of_another(&sighting("p1", hole)));
        // A beam stands on its own joint of another one, in a place of its own.
        let x_b7 = belief.pose("b7").unwrap();
        assert!(!belief.is_of_another(&sighting("b4", x_b7)));
        // Along another beam it is that one, which is found out where the wrong one was seen first.
        let x_b9 = belief.parts["b9"].prior.x;
        see(&mut belief, "b8", x_b9);
        assert!(!belief.is_of_another(&sighting("b9", x_b9)));
        assert!(belief.pose("b8").is_err());
        see(&mut belief, "b9", x_b9);
        assert!(belief.is_of_another(&sighting("b8", x_b9)));
        // Tags tell.
        belief.eyes.on_track(Track::Tags);
        assert!(!belief.is_of_another(&sighting("b8", x_b9)));
    }

    /// Beams that exchange their names are each where the other was; an unseen one goes back to its outline.
    #[test]
    fn beams_exchange_their_names() {
        let mut belief = belief();
        let there = Pose::translation(0.3, -0.4, 0.0166);
        see(&mut belief, "b4", there);
        belief.exchange(["b4", "b5"]);
        assert_eq!(belief.pose("b5").unwrap(), there);
        assert!(belief.pose("b4").is_err());
        assert_eq!(belief.parts["b4"].estimate.x, belief.parts["b4"].prior.x);
        let missing: Vec<&str> = belief.unseen_places().map(|(part, _)| part).collect();
        assert!(missing.contains(&"b4") && !missing.contains(&"b5"), "{missing:?}");
    }
}
