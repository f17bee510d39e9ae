//! The believed poses of the parts and their uncertainty: the only information that skills have about parts.
//!
//! For each part there is one estimate. Sight corrects it, time and contact blur it. A part between the
//! fingers is known in the frame of the tip and moves with it; one that stands or lies is known in the world.
//! The same code runs on every track: where readings are exact, covariances are next to nothing.

use std::collections::BTreeMap;
use std::sync::Arc;

use nalgebra::{Point3, Vector3, Vector6};
use ramp_assembly::Assembly;
use ramp_kit::{Holder, Kit};
use ramp_robot::arm::ArmModel;
use ramp_robot::{Camera, RobotError};
use ramp_world::Start;

use super::estimate::{Estimate, covariance};
use super::eye::Sighting;
use super::eyes::Eyes;
use super::outlines;
use super::part::{Frame, Part};
use super::surroundings::{Expected, Surroundings};
use crate::Pose;
use crate::hand::Hand;
use crate::parameters::Parameters;
use crate::parameters::belief::BeliefParameters;

/// Part poses with their covariances, by name, and the eyes that correct them.
pub struct Belief {
    pub(super) parameters: BeliefParameters,
    /// The pose estimator.
    pub eyes: Eyes,
    pub(super) parts: BTreeMap<String, Part>,
    pub(super) kit: Arc<Kit>,
    time: f64,
    /// Robot time after the last look, s.
    looked: Option<f64>,
    pub(super) x_wt: Pose,
    astray: Vec<(String, f64)>,
    /// The camera on the hand, at its nominal place, does not see the parts where they are: whether that is
    /// yet to be told.
    misplaced_camera: Option<bool>,
    /// Parts lie anywhere on the table at the start.
    pub(super) anywhere: bool,
    /// Places of the parts in the frame, in the world, by name.
    pub(super) places: BTreeMap<String, Vec<Pose>>,
}

impl Belief {
    /// The prior belief, before any detection.
    pub fn new(assembly: &Assembly, arm: &ArmModel, parameters: &Parameters, start: &Start) -> Belief {
        let kit = &assembly.kit;
        let own = &parameters.belief;
        let on_sheet = |lever: f64| {
            let [shift, turn] = outlines::spread(start, lever);
            let ([x, y, z], [roll, pitch, yaw]) = (own.on_sheet, own.on_sheet_turn);
            ([x.max(shift), y.max(shift), z], [roll, pitch, yaw.max(turn)])
        };
        let clamped = ([own.clamped; 3], [own.clamped_turn; 3]);
        let base = &assembly.beams[assembly.base];
        let mut parts = BTreeMap::new();
        let anywhere = start.scatter.is_some();
        let mut insert =
            |name: &str, mut outlines: Vec<Pose>, (position, rotation): ([f64; 3], [f64; 3]), frame| {
                let Some(&x) = outlines.first() else { return };
                if anywhere {
                    outlines.clear();
                }
                let estimate = Estimate { x, covariance: covariance(position, rotation) };
                parts.insert(
                    name.to_string(),
                    Part {
                        prior: estimate.clone(),
                        estimate,
                        frame,
                        seen: frame == Frame::Clamped,
                        odd: None,
                        doubts: 0,
                        outlines,
                        found: None,
                        drift: Vector6::zeros(),
                    },
                );
            };
        for beam in &kit.beams {
            if beam.name == base.beam.name {
                insert(&beam.name, vec![kit.x_wa() * base.x_ab], clamped, Frame::Clamped);
            } else {
                let on_sheet = on_sheet(beam.span() / 2.0);
                insert(&beam.name, outlines::of_beam(kit, beam, start), on_sheet, Frame::World);
            }
        }
        for peg in &kit.pegs {
            let on_sheet = on_sheet(Holder::PITCH);
            insert(&peg.name, outlines::of_peg(kit, &peg.name, start), on_sheet, Frame::World);
        }
        let eyes = Eyes::new(kit, arm, &base.beam.name, kit.x_wa() * base.x_ab, &parameters.eyes);
        Belief {
            parameters: own.clone(),
            kit: kit.clone(),
            eyes,
            parts,
            time: 0.0,
            looked: None,
            x_wt: Pose::identity(),
            astray: Vec::new(),
            misplaced_camera: None,
            anywhere,
            places: outlines::in_frame(assembly),
        }
    }

    /// Takes one reading of the parts, and another at once if one of them is too odd to be believed.
    ///
    /// # Errors
    /// The robot's.
    pub fn update(&mut self, hand: &mut Hand) -> Result<(), RobotError> {
        self.follow(hand);
        let sightings = self.sight(hand)?;
        self.follow(hand);
        let odd = sightings.iter().filter(|sighting| self.take(sighting)).count();
        if odd > 0 {
            let sightings = self.sight(hand)?;
            self.follow(hand);
            for sighting in &sightings {
                self.take(sighting);
            }
        }
        Ok(())
    }

    fn sight(&mut self, hand: &mut Hand) -> Result<Vec<Sighting>, RobotError> {
        let surroundings = self.surroundings(hand);
        let sightings = self.eyes.look(hand, &surroundings)?;
        self.looked = Some(hand.time());
        for name in self.eyes.upset() {
            self.doubt(&name);
        }
        Ok(sightings)
    }

    /// Everything that may be in the next image.
    pub(super) fn surroundings(&self, hand: &Hand) -> Surroundings {
        let lying = self.lying();
        let expected = |(name, part): (&String, &Part)| Expected {
            part: name.clone(),
            estimate: part.estimate.clone(),
            held: part.frame == Frame::Tip,
            lying: lying.iter().find(|it| it.part == *name).cloned(),
            anywhere: self.anywhere && !part.seen,
            places: self
                .places
                .get(name)
                .filter(|_| !part.seen && !self.anywhere)
                .cloned()
                .unwrap_or_default(),
            glimpsed: part.odd.as_ref().filter(|_| !part.seen).map(|odd| odd.x),
        };
        let parts = self.parts.iter().map(expected).collect();
        Surroundings { parts, holders: self.holders(&self.kit), width: hand.seen.width }
    }

    /// Has no time passed since the last look, so that another one would show nothing else?
    pub fn is_fresh(&self, hand: &Hand) -> bool {
        self.looked == Some(hand.time())
    }

    /// A part was seen, but not lying as it is believed to: after some times it may lie anyhow.
    fn doubt(&mut self, name: &str) {
        let Some(part) = self.parts.get_mut(name).filter(|part| part.frame != Frame::Clamped) else { return };
        part.doubts += 1;
        if part.doubts >= self.parameters.doubts {
            part.doubts = 0;
            let own = &self.parameters;
            let colour_alone = !self.eyes.tags() && !self.eyes.depth();
            if colour_alone && part.frame == Frame::World && self.kit.beam(name).is_some() {
                // It is only found again if it is looked for nearby.
                return self.bumped(name, (own.strayed, own.strayed_turn));
            }
            // In the hand it may have tilted, but not gone far.
            let (distance, turn) = match part.frame {
                Frame::Tip => (own.doubted_held, own.doubted_held_turn),
                Frame::World | Frame::Clamped => (own.doubted, own.doubted_turn),
            };
            part.estimate.spread([distance; 3], [turn; 3]);
        }
    }

    /// Advances the belief to the robot's clock: the held part moves with the tip, and all uncertainties
    /// grow.
    pub fn follow(&mut self, hand: &Hand) {
        let share = (hand.time() - self.time).max(0.0).sqrt();
        let way = hand.seen.x_wt.translation.vector - self.x_wt.translation.vector;
        self.time = hand.time();
        self.x_wt = hand.seen.x_wt;
        let own = &self.parameters;
        for part in self.parts.values_mut().filter(|part| part.frame != Frame::Clamped) {
            part.estimate.spread([own.resting * share; 3], [own.resting_turn * share; 3]);
            if part.frame == Frame::Tip {
                let share = way.norm().sqrt();
                part.estimate.spread(own.carried.map(|sigma| sigma * share), [own.carried_turn * share; 3]);
            }
        }
    }

    /// Fuses a detection of one part. Returns true if the reading was rejected as an outlier.
    fn take(&mut self, sighting: &Sighting) -> bool {
        if self.is_of_another(sighting) {
            return false;
        }
        let Some(part) = self.parts.get_mut(&sighting.part) else { return false };
        part.doubts = 0;
        let seen = match part.frame {
            Frame::Tip => sighting.estimate.seen_from(&sighting.x_wt.inverse()),
            Frame::World | Frame::Clamped => sighting.estimate.clone(),
        };
        if !part.seen {
            part.suppose_outline(&seen);
        }
        let surprise = part.estimate.surprise(&seen);
        if sighting.nominal == Some(Camera::Wrist) && part.seen && surprise > self.parameters.misplaced {
            self.misplaced_camera.get_or_insert(true);
        }
        let untagged = self.eyes.images() && !self.eyes.tags() && !self.anywhere;
        if surprise < self.parameters.gate {
            // A single look may be of an empty slot.
            if untagged && !part.seen && part.odd.is_none() {
                part.odd = Some(seen);
                return false;
            }
            part.watch(&seen, &self.parameters);
            part.estimate.fuse(&seen);
            part.odd = None;
            part.seen = true;
            part.find(&self.parameters);
            return false;
        }
        let off = part.estimate.error(&seen.x).fixed_rows::<3>(0).norm();
        if part.frame == Frame::Clamped && off > self.parameters.clamped_most {
            return true;
        }
        match part.odd.take() {
            // Two readings agree: the part is not where it was believed.
            Some(mut before) if before.surprise(&seen) < self.parameters.gate => {
                before.fuse(&seen);
                let off = before.error(&part.estimate.x).fixed_rows::<3>(0).norm();
                if off > self.parameters.astray && part.seen {
                    self.astray.push((sighting.part.clone(), off));
                }
                part.estimate = before;
                part.drift = Vector6::zeros();
                part.seen = true;
                false
            }
            _ => {
                part.odd = Some(seen);
                true
            }
        }
    }

    /// Whether the camera on the hand turned out not to be at its nominal place: told once.
    pub fn camera_misplaced(&mut self) -> bool {
        self.misplaced_camera.as_mut().is_some_and(std::mem::take)
    }

    /// The parts that were found far from where they were believed since this was last asked, and how far, m.
    pub fn astray(&mut self) -> Vec<(String, f64)> {
        std::mem::take(&mut self.astray)
    }

    /// The fingers have closed on a part: it moves with the tip from now on. They centre it, and turn it
    /// square to themselves: its x axis lies along or against the tip's, that of a peg (`square`) along the
    /// nearest of the tip's axes.
    pub fn gripped(&mut self, part: &str, square: bool) {
        let own = &self.parameters;
        let x_wt = self.x_wt;
        let Some(part) = self.parts.get_mut(part) else { return };
        let mut estimate = part.estimate.seen_from(&x_wt.inverse());
        estimate.spread(own.gripped, own.gripped_turn);
        let (offset, angle) = (own.centred, own.centred_turn);
        let x = estimate.x.rotation * Vector3::x();
        let yaw = x.y.atan2(x.x);
        let step = if square { std::f64::consts::FRAC_PI_2 } else { std::f64::consts::PI };
        let turned = (yaw / step).round() * step - yaw;
        estimate.constrain(&Vector6::new(0.0, 0.0, 0.0, 0.0, 0.0, 1.0), turned, angle);
        // The point of its axis under the tip (a peg's is its own origin) lies between the fingers.
        let x = estimate.x.rotation * Vector3::x();
        let along = if square || x.x.abs() < 0.5 { 0.0 } else { -estimate.x.translation.x / x.x };
        let lever = x * along;
        let middle = estimate.x.translation.vector + lever;
        let row = Vector6::new(0.0, 1.0, 0.0, -lever.z, 0.0, lever.x);
        estimate.constrain(&row, -middle.y, offset);
        part.rebase(Frame::Tip, estimate);
    }

    /// Another agent has put a part at `x_wp` in the world, with the given uncertainty (m, rad). Detections
    /// will correct it.
    pub fn expect(&mut self, part: &str, x_wp: Pose, (position, rotation): ([f64; 3], [f64; 3])) {
        if let Some(part) = self.parts.get_mut(part).filter(|part| part.frame != Frame::Clamped) {
            part.rebase(Frame::World, Estimate { x: x_wp, covariance: covariance(position, rotation) });
            // Known well enough to be looked at from near.
            part.seen = true;
        }
    }

    /// A part between the fingers must be at `x_wp` (world), to about a millimetre and a few degrees.
    pub fn reckoned(&mut self, part: &str, x_wp: &Pose) {
        let own = &self.parameters;
        let x_wt = self.x_wt;
        let Some(part) = self.parts.get_mut(part).filter(|part| part.frame == Frame::Tip) else { return };
        let covariance = covariance([own.reckoned; 3], [own.reckoned_turn; 3]);
        part.rebase(Frame::Tip, Estimate { x: x_wt.inverse() * x_wp, covariance });
    }

    /// Something has pushed a held part. Detections will correct its pose between the fingers.
    pub fn pushed(&mut self, part: &str) {
        let own = &self.parameters;
        if let Some(part) = self.parts.get_mut(part).filter(|part| part.frame == Frame::Tip) {
            part.estimate.spread(own.pushed, own.pushed_turn);
            part.estimate.spread_turn(&Vector3::y(), own.pushed_roll);
        }
    }

    /// The fingers have let go of a part where it is now.
    pub fn released(&mut self, part: &str) {
        let own = &self.parameters;
        self.freed(part, ([own.released; 3], own.released_turn));
    }

    /// A part has slipped out of the fingers: it may be anywhere below.
    pub fn lost(&mut self, part: &str) {
        let own = &self.parameters;
        self.freed(part, ([own.lost; 3], [own.lost_turn; 3]));
    }

    fn freed(&mut self, part: &str, (position, rotation): ([f64; 3], [f64; 3])) {
        let x_wt = self.x_wt;
        let Some(part) = self.parts.get_mut(part).filter(|part| part.frame == Frame::Tip) else { return };
        let mut estimate = part.estimate.seen_from(&x_wt);
        estimate.spread(position, rotation);
        part.rebase(Frame::World, estimate);
    }

    /// A point of a part (m, in its frame) is at a height (m) that is known to a standard deviation of
    /// `sigma`, m.
    pub fn stands_at(&mut self, part: &str, p: &Point3<f64>, height: f64, sigma: f64) {
        let x_wt = self.x_wt;
        let Some(part) = self.parts.get_mut(part).filter(|part| part.frame != Frame::Clamped) else { return };
        let held = part.frame == Frame::Tip;
        let mut estimate = if held { part.estimate.seen_from(&x_wt) } else { part.estimate.clone() };
        let lever = estimate.x.rotation * p.coords;
        let value = height - estimate.x.translation.z - lever.z;
        // (δθ × r)·z
        let row = Vector6::new(0.0, 0.0, 1.0, lever.y, -lever.x, 0.0);
        estimate.constrain(&row, value, sigma);
        part.estimate = if held { estimate.seen_from(&x_wt.inverse()) } else { estimate };
    }

    /// A part may have been pushed by up to the given amounts (m, rad) in an unknown direction, mostly along
    /// the table.
    pub fn bumped(&mut self, part: &str, (position, rotation): (f64, f64)) {
        if let Some(part) = self.parts.get_mut(part).filter(|part| part.frame != Frame::Clamped) {
            let (height, tilt) = (position / 4.0, rotation / 4.0);
            part.estimate.spread([position, position, height], [tilt, tilt, rotation]);
        }
    }
}

#[cfg(test)]
mod tests {
    // A failed unwrap here is a failed test.
    #![allow(clippy::unwrap_used)]

    use std::path::Path;

    use nalgebra::{Translation3, UnitQuaternion};
    use ramp_robot::random::Stream;

    use super::*;

    const MM: f64 = 1.0e-3;
    const DEGREE: f64 = std::f64::consts::PI / 180.0;

    fn belief() -> Belief {
        let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data");
        let kit = ramp_kit::read_kit(&data.join("kit.xml")).unwrap();
        let assembly = ramp_assembly::read_goal(&data.join("goals/easy-3.xml"), &kit).unwrap();
        let arm = ramp_robot::arm::ArmModel::read(&data.join("arms/panda.json")).unwrap();
        Belief::new(&assembly, &arm, &Parameters::baseline(), Start::sheet())
    }

    /// A reading with the noise of track `noisy`.
    fn reading(stream: &mut Stream, part: &str, x_wp: &Pose) -> Sighting {
        let shift = Vector3::from_fn(|_, _| stream.normal(1.0 * MM));
        let turn = UnitQuaternion::from_scaled_axis(Vector3::from_fn(|_, _| stream.normal(DEGREE)));
        let x = Pose::from_parts(Translation3::from(x_wp.translation.vector + shift), turn * x_wp.rotation);
        let estimate = Estimate { x, covariance: covariance([1.0 * MM; 3], [DEGREE; 3]) };
        Sighting { part: part.to_string(), estimate, nominal: None, x_wt: Pose::identity() }
    }

    fn off(belief: &Belief, part: &str, x_wp: &Pose) -> f64 {
        (belief.pose(part).unwrap().translation.vector - x_wp.translation.vector).norm()
    }

    #[test]
    fn a_part_is_unseen_until_it_is_seen_and_the_clamped_beam_is_known() {
        let mut belief = belief();
        assert!(belief.pose("b7").is_ok());
        assert!(belief.pose("b4").is_err());
        assert!(belief.deviation("b4", &Point3::origin())[0].is_infinite());
        let there = belief.parts["b4"].estimate.x;
        belief.take(&reading(&mut Stream::new(1, "test"), "b4", &there));
        assert!(belief.pose("b4").is_ok());
    }

    /// A single outlier changes nothing. A part that has really moved is accepted at the second reading and
    /// reported.
    #[test]
    fn a_wild_reading_needs_another_that_confirms_it() {
        let mut belief = belief();
        let mut stream = Stream::new(3, "test");
        let there = belief.parts["b4"].estimate.x;
        for _ in 0..50 {
            assert!(!belief.take(&reading(&mut stream, "b4", &there)));
        }
        let away = Translation3::new(0.02, 0.0, 0.0) * there;
        assert!(belief.take(&reading(&mut stream, "b4", &away)));
        assert!(off(&belief, "b4", &there) < 0.6 * MM);
        assert!(!belief.take(&reading(&mut stream, "b4", &there)));
        assert!(belief.astray().is_empty());
        // Wild, but each time elsewhere: no confirmation.
        for side in [0.02, -0.02, 0.04, -0.04] {
            assert!(belief.take(&reading(&mut stream, "b4", &(Translation3::new(side, 0.0, 0.0) * there))));
        }
        assert!(off(&belief, "b4", &there) < 0.6 * MM);
        assert!(belief.take(&reading(&mut stream, "b4", &away)));
        assert!(!belief.take(&reading(&mut stream, "b4", &away)));
        assert!(off(&belief, "b4", &away) < 3.0 * MM);
        assert_eq!(belief.astray().len(), 1);
    }

    /// The camera on the hand is 2.5 mm and 0.6° from its nominal place. Its first sighting of a part that
    /// the camera over the table has seen shows that; one with the error that a mounting usually has does
    /// not, and a part that was never seen may lie anywhere.
    #[test]
    fn a_camera_far_from_its_nominal_place_is_noticed() {
        let noticed = |seen_before: bool, factor: f64| {
            let mut belief = belief();
            let there = belief.parts["b4"].estimate.x;
            let exact = |camera, x, covariance| Sighting {
                part: "b4".to_string(),
                estimate: Estimate { x, covariance },
                nominal: Some(camera),
                x_wt: Pose::identity(),
            };
            if seen_before {
                belief.take(&exact(Camera::BirdsEye, there, covariance([0.1 * MM; 3], [0.05 * DEGREE; 3])));
            }
            let shift = Translation3::new(0.6 * MM * factor, 0.5 * MM * factor, 0.6 * MM * factor);
            let turn = UnitQuaternion::from_euler_angles(0.0, 0.0, 0.15 * DEGREE * factor);
            let x = Pose::from_parts(shift * there.translation, turn * there.rotation);
            belief.take(&exact(Camera::Wrist, x, covariance([0.6 * MM; 3], [0.25 * DEGREE; 3])));
            let noticed = belief.camera_misplaced();
            assert!(!belief.camera_misplaced());
            noticed
        };
        assert!(noticed(true, 4.0));
        assert!(!noticed(true, 1.0));
        assert!(!noticed(false, 4.0));
    }

    /// The clamped beam cannot be far from its place, however often it is seen there; but its table may be
    /// high.
    #[test]
    fn a_clamped_beam_is_not_far_away() {
        let mut belief = belief();
        let there = belief.parts["b7"].estimate.x;
        let exact = |x: Pose| Sighting {
            part: "b7".to_string(),
            estimate: Estimate { x, covariance: covariance([1e-9; 3], [1e-9; 3]) },
            nominal: None,
            x_wt: Pose::identity(),
        };
        for _ in 0..3 {
            belief.take(&exact(Translation3::new(12.0 * MM, 0.0, 0.0) * there));
        }
        assert!(off(&belief, "b7", &there) < 0.1 * MM);
        let high = Translation3::new(0.0, 0.0, 0.5 * MM) * there;
        for _ in 0..2 {
            belief.take(&exact(high));
        }
        assert!(off(&belief, "b7", &high) < 0.01 * MM);
    }

    /// A push too small for one reading to stand out is noticed over some.
    #[test]
    fn a_small_push_is_noticed() {
        let mut belief = belief();
        let mut stream = Stream::new(4, "test");
        let there = belief.parts["b5"].estimate.x;
        for _ in 0..400 {
            belief.take(&reading(&mut stream, "b5", &there));
        }
        assert!(off(&belief, "b5", &there) < 0.3 * MM);
        let pushed = Translation3::new(1.5 * MM, 0.0, 0.0) * there;
        for _ in 0..60 {
            belief.take(&reading(&mut stream, "b5", &pushed));
        }
        assert!(off(&belief, "b5", &pushed) < 0.6 * MM, "{:.2} mm", off(&belief, "b5", &pushed) / MM);
    }

    /// A part that images show to be tilted loses its constraint to lie flat in the pose estimator.
    #[test]
    fn a_part_that_is_seen_upset_is_doubted() {
        let mut belief = belief();
        let there = belief.parts["p1"].estimate.x;
        belief.take(&reading(&mut Stream::new(7, "test"), "p1", &there));
        let flat = |belief: &Belief| belief.lying().iter().any(|lying| lying.part == "p1");
        for _ in 1..belief.parameters.doubts {
            belief.doubt("p1");
            assert!(flat(&belief));
        }
        belief.doubt("p1");
        assert!(!flat(&belief));
    }

    /// Nothing but noise is not taken for a push, however long one looks.
    #[test]
    fn noise_is_no_push() {
        let mut belief = belief();
        let mut stream = Stream::new(5, "test");
        let there = belief.parts["b6"].estimate.x;
        for _ in 0..5000 {
            assert!(!belief.take(&reading(&mut stream, "b6", &there)));
        }
        let [across, height] = belief.deviation("b6", &Point3::origin());
        assert!(across < 0.02 * MM && height < 0.02 * MM);
        assert!(off(&belief, "b6", &there) < 0.06 * MM);
    }

    /// Fingers that close on a part know where it is across them, and how it is turned.
    #[test]
    fn a_grasp_tells_what_sight_does_not() {
        let mut belief = belief();
        let mut stream = Stream::new(6, "test");
        let there = belief.parts["b4"].estimate.x;
        for _ in 0..10 {
            belief.take(&reading(&mut stream, "b4", &there));
        }
        // The hand grips the beam 80 mm from its origin where it really is; the belief is a little off.
        let yaw = crate::grasp::yaw_of(&there);
        let p = there * Point3::new(0.08, 0.0, 0.0);
        belief.x_wt = Pose::from_parts(p.coords.into(), crate::grasp::hand_down(yaw));
        let before = belief.deviation("b4", &Point3::new(0.29, 0.0, 0.0))[0];
        belief.gripped("b4", false);
        let x_wb = belief.pose("b4").unwrap();
        let across = there.rotation * Vector3::y();
        let error = (x_wb.translation.vector - there.translation.vector).dot(&across);
        assert!(error.abs() < 0.2 * MM, "{:.3} mm across the fingers", error / MM);
        assert!((crate::grasp::yaw_of(&x_wb) - yaw).abs() < 0.1 * DEGREE);
        assert!(before > 1.0 * MM);
        // It moves with the hand, and stays where the hand leaves it.
        belief.x_wt = Translation3::new(0.0, 0.1, 0.2) * belief.x_wt;
        let carried = belief.pose("b4").unwrap();
        assert!(
            (carried.translation.vector - x_wb.translation.vector)
                .metric_distance(&Vector3::new(0.0, 0.1, 0.2))
                < 1e-12
        );
        belief.released("b4");
        belief.x_wt = Pose::identity();
        assert!(off(&belief, "b4", &carried) < 1e-12);
    }

    /// A held beam that lies flat on the table is known in height and tilt in the hand, and stays so as the
    /// hand moves.
    #[test]
    fn a_touch_of_the_table_tells_the_height_in_the_hand() {
        let mut belief = belief();
        let there = belief.parts["b4"].estimate.x;
        belief.take(&reading(&mut Stream::new(8, "test"), "b4", &there));
        belief.x_wt = Pose::from_parts(
            (there * Point3::new(0.08, 0.0, 0.0)).coords.into(),
            crate::grasp::hand_down(crate::grasp::yaw_of(&there)),
        );
        belief.gripped("b4", false);
        let height = there.translation.z + 1.2 * MM;
        let ends = [0.0, 0.2924].map(|x| Point3::new(x, 0.0, 0.0));
        for end in &ends {
            belief.stands_at("b4", end, height, 0.02 * MM);
        }
        belief.x_wt = Translation3::new(0.1, 0.0, 0.05) * belief.x_wt;
        let x_wb = belief.pose("b4").unwrap();
        for end in &ends {
            assert!(((x_wb * end).z - height - 0.05).abs() < 0.1 * MM, "{}", (x_wb * end).z - height);
            assert!(belief.deviation("b4", end)[1] < 0.1 * MM);
        }
    }
}
