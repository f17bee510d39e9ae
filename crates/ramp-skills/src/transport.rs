//! Moving through free space, picking up and putting down.

use std::collections::BTreeMap;

use nalgebra::{Point3, Vector3};
use ramp_assembly::Assembly;
use ramp_kit::Kit;
use ramp_motion::{Checker, Joints, MotionError, PathPlanner, Trajectory};
use ramp_robot::arm::ArmModel;
use ramp_robot::random::Stream;
use ramp_robot::{Cause, Event};

use crate::Pose;
use crate::belief::{Belief, held_boxes};
use crate::diagnosis::Stand;
use crate::fault::{Fault, SkillError};
use crate::grasp::{
    self, BEAM_OPEN, BEAM_RELEASE, BEAM_WIDTH, GRIP_FORCE, PEG_OPEN, PEG_WIDTH, SQUEEZE, beam_grasp,
    hand_down, peg_grasp,
};
use crate::hand::{Hand, Held};

/// Height of the tip while it travels, m: a held beam clears the pegs that stand in the holders.
pub const TRAVEL: f64 = 0.15;
/// Distance that motions through free space keep from everything, m.
const MARGIN: f64 = 0.5e-3;
/// Share of the arm's limits of velocity, acceleration and jerk that motions use.
const SHARE: f64 = 0.6;
/// A part that has moved further than this in the hand has slipped out of it, m.
const STRAYED: f64 = 10.0e-3;
/// The same for a beam along its own axis, m.
const SLIPPED: f64 = 30.0e-3;
/// Force on the table or the holder at which a part counts as put down, N.
const PUT_DOWN_LIMIT: f64 = 8.0;
/// By how much a hand may lean when it lets go of a beam, rad.
const ASLANT: f64 = 0.02;
/// Force of each finger while it turns straight, N.
const LOOSE_GRIP: f64 = 5.0;
/// By how much it may lean when it has turned straight, rad; and how often it turns for that.
const STRAIGHT: f64 = 0.004;
/// See [`STRAIGHT`].
const STRAIGHTENINGS: usize = 5;
/// Force at which it stops turning straight, N: well below that which breaks every motion off.
const STRAIGHTEN_LIMIT: f64 = 25.0;
/// Force at which an open finger has met the beam that the hand has let go of, N; without one it feels less than 7.
const BESIDE_LIMIT: f64 = 10.0;
/// How often a beam is let go of anew when it hangs on a rib.
const LET_GO_AGAIN: usize = 2;
/// How much wider than a beam the fingers are when their ribs move freely in its slots without leaving them, m.
const IN_SLOT: f64 = 3.0e-3;
/// Room of a rib in a slot above and below it, m: 5 mm wide, the rib 3 mm thick.
const SLOT_ROOM: f64 = 1.0e-3;
/// Force at which a rib stands on the lower side of its slot, N; and how far down it is looked for, m.
const SLOT_LIMIT: (f64, f64) = (4.0, 6.0e-3);
/// How well it is known where a beam lies in which the hand has turned straight, on the axes of the world, m and rad.
const STAYED: ([f64; 3], [f64; 3]) = ([1.0e-3; 3], [0.01, 0.01, 0.005]);
/// How often a part that was pushed in the hand is looked at before it is known again.
const LOOKS: usize = 4;
/// When a point so far beside the fingers, m, ...
const BESIDE: f64 = 0.1;
/// ... is no better known in height than this, m, a part that was pushed in the hand cannot be seen there.
const UNSEEN: f64 = 5.0e-3;
/// How often a part that is pushed on the way to where it is put back is looked at.
const TRIES: usize = 3;
/// How well the joints that a beam is to meet must be known before it is fetched, m.
const KNOWN: f64 = 0.25e-3;
/// How far a fresh grasp is lifted before anything else, m.
const LIFT: f64 = 0.02;
/// Distance between what the fingers hold and what they should, m, beyond which the part is not held.
const WIDTH_TOLERANCE: f64 = 2.0e-3;
/// Fingers that stop this far before a part do not hold it, m; and how often they are closed then.
const GRIP_SHORT: f64 = 1.0e-3;
/// See [`GRIP_SHORT`].
const GRIPS: usize = 3;
/// Fingers count as opened when they are so much further apart than where they stopped, m: those that sprang back as far as
/// they open for a peg have not been opened by that.
const OPENED: f64 = 0.5e-3;
/// Distance from the ends of the joints' ranges beyond which more is no better, rad.
const GOOD_MARGIN: f64 = 0.3;
/// What a radian of turning the hand counts against a radian of that distance.
const TURN_COST: f64 = 0.05;

/// How a beam gets to its place: a straight motion.
#[derive(Clone, Debug, PartialEq)]
pub struct Way {
    /// Its direction in the assembly frame.
    pub direction: Vector3<f64>,
    /// Its length, m: from here on nothing is in the way.
    pub distance: f64,
    /// How much further than its place the beam goes at first, m.
    pub depth: f64,
}

/// What every skill works with.
pub struct Workcell<'a, 'r> {
    /// The parts.
    pub kit: &'a Kit,
    /// The goal.
    pub assembly: &'a Assembly,
    /// The arm.
    pub arm: &'a ArmModel,
    /// The motion planner.
    pub planner: &'a PathPlanner,
    /// The hand.
    pub hand: Hand<'r>,
    /// Where the parts are.
    pub belief: Belief,
    /// Beams that stand in the assembly, by index, the base among them.
    pub standing: Vec<usize>,
    /// Those of them that stand deeper than their place, by index, until they are slid forward.
    pub deep: Vec<usize>,
    /// Connections that are pinned, by index, and by which peg.
    pub pinned: Vec<(usize, String)>,
    /// How beams get to their places, by index: as the plan says.
    pub ways: BTreeMap<usize, Way>,
    /// Random numbers for the motion planner.
    pub stream: Stream,
    /// What happened.
    pub events: Vec<Event>,
    /// It has been told that the wrist sensor is off.
    pub force_told: bool,
    /// How the beams of the assembly stood when the hand last left them, by index.
    pub stood: BTreeMap<usize, Stand>,
}

impl Workcell<'_, '_> {
    /// Notes what happened.
    pub fn note(&mut self, kind: &'static str, what: String) {
        self.events.push(Event { time: self.hand.time(), kind, what });
    }

    /// Moves the tip through free space to `x_wt`, keeping clear of everything but the held part.
    ///
    /// # Errors
    /// When no motion is found or the robot stops.
    pub fn travel(&mut self, x_wt: &Pose) -> Result<(), SkillError> {
        for leg in self.legs_to(x_wt)? {
            self.walk(leg)?;
        }
        Ok(())
    }

    /// The legs of a way through free space to `x_wt`, keeping clear of everything but the held part: the hand rests between
    /// them.
    ///
    /// # Errors
    /// When no motion is found or the robot stops.
    pub(crate) fn legs_to(&mut self, x_wt: &Pose) -> Result<Vec<Vec<Joints>>, SkillError> {
        self.belief.update(&mut self.hand)?;
        let checker = self.checker(None);
        let q = self.hand.joints();
        Ok(self.planner.plan(&q, x_wt, TRAVEL, &checker, &mut self.stream)?)
    }

    /// Follows one leg of a way ([`Workcell::legs_to`]).
    ///
    /// # Errors
    /// [`Fault::Overload`], and the robot's.
    pub(crate) fn walk(&mut self, leg: Vec<Joints>) -> Result<(), SkillError> {
        self.hand.follow(&Trajectory::new(self.arm, leg, SHARE))
    }

    /// Moves the open hand from above down to `x_wt`, around `part`.
    fn descend(&mut self, x_wt: &Pose, part: &str) -> Result<(), SkillError> {
        let mut above = *x_wt;
        above.translation.z = above.translation.z.max(TRAVEL);
        self.travel(&above)?;
        let checker = self.checker(Some(part));
        let q = self.hand.joints();
        let leg = self
            .planner
            .straight(&q, x_wt)
            .ok_or(MotionError::Unreachable(x_wt.translation.vector.into()))?;
        if !leg.iter().all(|q| checker.is_free(&self.planner.kinematics.frames(q))) {
            return Err(MotionError::Blocked("end").into());
        }
        self.walk(leg)
    }

    /// What the arm must keep clear of now: everything but what it holds and `without`.
    pub fn checker(&self, without: Option<&str>) -> Checker {
        let mut left_out: Vec<&str> = without.into_iter().collect();
        let mut boxes = Vec::new();
        if let Some(held) = &self.hand.held {
            left_out.push(&held.part);
            boxes = held_boxes(self.kit, &held.part, &held.x_tp);
        }
        let around = self.belief.obstacles(self.kit, &left_out);
        // The fingers may still be opening: check with the wider of what they are and what they will be.
        let width = self.hand.gripper.width.max(self.hand.seen.width);
        Checker::new(self.arm, width, boxes, &around, MARGIN)
    }

    /// Raises the hand straight up to travelling height.
    ///
    /// # Errors
    /// The robot's.
    pub fn rise(&mut self) -> Result<(), SkillError> {
        let mut up = self.hand.seen.x_wt;
        if up.translation.z < TRAVEL - 0.001 {
            self.hand.relax();
            up.translation.z = TRAVEL;
            self.hand.go(&up, 0.25)?;
        }
        Ok(())
    }

    /// The grasp of a part where it stands now: pose of the tip, gripper width before and after closing.
    fn grasp_of(&mut self, part: &str, link: Option<&str>) -> Result<(Pose, f64, f64), SkillError> {
        let x_wp = self.belief.pose(part)?;
        let q = self.hand.joints();
        let no_grasp = || Fault::NoGrasp { part: part.to_string() };
        if let Some(beam) = self.kit.beam(part) {
            let link = link
                .and_then(|name| beam.links.iter().find(|link| link.name == name))
                .ok_or_else(no_grasp)?;
            // The hand turns with the beam: what counts is the worse end of its way.
            let goal = self.assembly.beam_index(part).map(|index| self.target(index)).transpose()?;
            let mut nearest = None;
            for s in grasp::points_on(link, beam.span() / 2.0) {
                let senses = [false, true].map(|reverse| {
                    let x_wt = beam_grasp(&x_wp, s, reverse);
                    let margin = self.reach(&x_wt, &q);
                    let at_goal = goal.map_or(margin, |x_wb| self.reach(&beam_grasp(&x_wb, s, reverse), &q));
                    (x_wt, margin.min(at_goal))
                });
                let Some(x_wt) = self.choose(&senses) else { continue };
                if self.has_room(&x_wt, BEAM_OPEN, part) {
                    return Ok((x_wt, BEAM_OPEN, BEAM_WIDTH));
                }
                nearest = nearest.or(Some(x_wt));
            }
            // With no room anywhere the motion says what is in the way.
            let x_wt = nearest.ok_or_else(no_grasp)?;
            return Ok((x_wt, BEAM_OPEN, BEAM_WIDTH));
        }
        // Pegs stand close together along x of their holder: the hand closes across it.
        let senses = [0, 2].map(|quarter| {
            let x_wt = peg_grasp(&x_wp, quarter);
            (x_wt, self.reach(&x_wt, &q))
        });
        let x_wt = self.choose(&senses).ok_or_else(no_grasp)?;
        Ok((x_wt, PEG_OPEN, PEG_WIDTH))
    }

    /// Does the hand, opened to `open` (m), touch nothing but `part` at a pose of the tip that it can reach?
    pub fn has_room(&self, x_wt: &Pose, open: f64, part: &str) -> bool {
        let around = self.belief.obstacles(self.kit, &[part]);
        let checker = Checker::new(self.arm, open, Vec::new(), &around, MARGIN);
        self.planner
            .solve(x_wt, &self.hand.joints())
            .is_ok_and(|q| checker.is_free(&self.planner.kinematics.frames(&q)))
    }

    /// Of several poses of the tip, each with its distance from the joints' ends (rad), the one to use: reachable
    /// with room to spare if any is, and of those the least turn of the hand.
    pub fn choose(&self, candidates: &[(Pose, f64)]) -> Option<Pose> {
        let now = self.hand.seen.x_wt.rotation;
        let score =
            |(x_wt, margin): &(Pose, f64)| margin.min(GOOD_MARGIN) - TURN_COST * now.angle_to(&x_wt.rotation);
        candidates
            .iter()
            .filter(|(_, margin)| *margin > 0.0)
            .max_by(|a, b| score(a).total_cmp(&score(b)))
            .map(|(x_wt, _)| *x_wt)
    }

    /// How far the joints stay from their ends at a pose, rad; negative when it is out of reach.
    pub fn reach(&self, x_wt: &Pose, q: &Joints) -> f64 {
        self.planner.solve(x_wt, q).map_or(-1.0, |q| self.planner.kinematics.range_margin(&q))
    }

    /// Moves the open hand over a part, at travelling height.
    ///
    /// # Errors
    /// When the part is unseen or out of reach, or the robot stops.
    pub fn hover(&mut self, part: &str, link: Option<&str>) -> Result<(), SkillError> {
        // Where a beam is to go is easier to see before it is in the hand.
        if let Some(beam) = self.assembly.beam_index(part) {
            let mut meeting = self.meeting(beam);
            meeting.retain(|(other, _)| other != part);
            if !meeting.is_empty() {
                self.see(&meeting, KNOWN)?;
            }
        }
        self.see_to_grip(part)?;
        self.diagnose_standing();
        if self.kit.beam(part).is_none() {
            if self.belief.pose(part).is_err() {
                self.diagnose(Cause::PartMissing, format!("{part} is not in its holder"));
            }
            self.diagnose_holder(part);
        }
        let (mut x_wt, open, _) = self.grasp_of(part, link)?;
        self.hand.gripper.width = open;
        x_wt.translation.z = TRAVEL;
        self.travel(&x_wt)?;
        self.diagnose_force()?;
        Ok(())
    }

    /// Grips a part where it stands: the hand comes from above, closes and checks that it holds something of the
    /// right width.
    ///
    /// # Errors
    /// [`Fault::NotHeld`], or what stopped the motion.
    pub fn seize(&mut self, part: &str, x_wt: &Pose, open: f64, width: f64) -> Result<(), SkillError> {
        self.hand.gripper.width = open;
        self.descend(x_wt, part)?;
        self.hand.relax();
        for attempt in 0..GRIPS {
            self.hand.grip(width - SQUEEZE, GRIP_FORCE)?;
            let short = self.hand.seen.width - width;
            if short < GRIP_SHORT {
                break;
            }
            self.diagnose(Cause::GripWeak, format!("the fingers stop {:.1} mm before {part}", short * 1e3));
            if attempt + 1 < GRIPS {
                self.hand.grip(open.max(self.hand.seen.width + OPENED), 20.0)?;
            }
        }
        if (self.hand.seen.width - width).abs() > WIDTH_TOLERANCE {
            if self.hand.seen.width < width {
                self.diagnose(Cause::PartLost, format!("{part} is not between the fingers"));
            }
            return Err(Fault::NotHeld { part: part.to_string() }.into());
        }
        self.belief.follow(&self.hand);
        self.belief.gripped(part, self.kit.beam(part).is_none());
        self.belief.update(&mut self.hand)?;
        let x_wp = self.belief.pose(part)?;
        let (mass, p_centre) = match self.kit.beam(part) {
            Some(beam) => (beam.mass(), grasp::beam_centre(beam)),
            None => (grasp::PEG_MASS, grasp::peg_centre()),
        };
        let x_tp = self.hand.seen.x_wt.inverse() * x_wp;
        self.hand.pushed = false;
        self.hand.held = Some(Held { part: part.to_string(), x_tp, x_wp_origin: x_wp, mass, p_centre });
        Ok(())
    }

    /// Picks up a part and lifts it a little.
    ///
    /// # Errors
    /// As [`Workcell::seize`].
    pub fn pick_up(&mut self, part: &str, link: Option<&str>) -> Result<(), SkillError> {
        self.see_to_grip(part)?;
        let (x_wt, open, width) = self.grasp_of(part, link)?;
        self.seize(part, &x_wt, open, width)?;
        let mut up = self.hand.setpoint;
        // A peg must leave its holder altogether, a beam only the table.
        up.translation.z += if self.kit.beam(part).is_some() { LIFT } else { 0.045 };
        self.hand.go(&up, 0.15)?;
        self.regrip(part)
    }

    /// Looks whether the part is still in the hand, and where in it.
    ///
    /// # Errors
    /// [`Fault::NotHeld`] when the fingers have closed on nothing, or the part is not where it was in the hand; the
    /// hand then counts as empty.
    pub fn regrip(&mut self, part: &str) -> Result<(), SkillError> {
        let pushed = std::mem::take(&mut self.hand.pushed);
        if pushed {
            // How the fingers took it says nothing any more.
            self.belief.pushed(part);
            for _ in 0..LOOKS {
                self.look_once()?;
            }
        }
        self.belief.update(&mut self.hand)?;
        let x_wp = self.belief.pose(part)?;
        let x_tp = self.hand.seen.x_wt.inverse() * x_wp;
        let width = if self.kit.beam(part).is_some() { BEAM_WIDTH } else { PEG_WIDTH };
        let closed = (self.hand.seen.width - width).abs() > WIDTH_TOLERANCE;
        let mut slip = None;
        let here = self.hand.held.as_mut().filter(|held| held.part == part).is_some_and(|held| {
            let moved = x_tp.translation.vector - held.x_tp.translation.vector;
            let turned = x_tp.rotation.angle_to(&held.x_tp.rotation);
            slip = Some((moved.norm(), turned));
            // What was between the fingers: far from there, a part that has turned in them is off by more.
            let gripped = held.x_tp.inverse() * Point3::origin();
            let moved = (x_tp * gripped).coords;
            held.x_tp = x_tp;
            // A beam may slip along the fingers and still be held.
            let along = if self.kit.beam(part).is_some() { SLIPPED } else { STRAYED };
            moved.x.abs() < along && moved.yz().norm() < STRAYED
        });
        if closed || !here {
            self.diagnose(Cause::PartLost, format!("{part} has left the hand"));
            self.hand.held = None;
            self.belief.lost(part);
            return Err(Fault::NotHeld { part: part.to_string() }.into());
        }
        let beside = x_tp.inverse() * Point3::new(BESIDE, 0.0, 0.0);
        if pushed && self.belief.deviation(part, &beside)[1] > UNSEEN {
            self.diagnose(Cause::GripMoved, format!("{part} was pushed, and cannot be seen in the hand"));
        } else if let Some((moved, turned)) = slip {
            self.diagnose_grip(part, moved, turned);
        }
        Ok(())
    }

    /// Puts the held part back where it was picked up, and lets go of it.
    ///
    /// # Errors
    /// [`Fault::NotHeld`] when there is nothing in the hand any more, or what stopped the motion.
    pub fn put_back(&mut self) -> Result<(), SkillError> {
        let Some(part) = self.hand.held.as_ref().map(|held| held.part.clone()) else { return Ok(()) };
        self.rise()?;
        self.regrip(&part)?;
        let Some(held) = self.hand.held.clone() else { return Ok(()) };
        // A peg's stem is above its holder, a beam above the table.
        let down = self.bring_above(held.x_wp_origin * held.x_tp.inverse(), |down| down + 0.045)?;
        self.hand.relax();
        self.hand.zero()?;
        self.hand.drive(&down, 0.05, |hand| -hand.force().z > PUT_DOWN_LIMIT)?;
        self.release()
    }

    /// Carries the held part above a place, where the tip is at `down` (world), with the tip at a height that follows from
    /// that at the place, m. Gives the pose of the tip at the place, which is another one when the part moved in the hand.
    ///
    /// # Errors
    /// [`Fault::NotHeld`] when it left the hand on the way; when there is no way, or the robot stops.
    pub(crate) fn bring_above(
        &mut self,
        mut down: Pose,
        height: impl Fn(f64) -> f64,
    ) -> Result<Pose, SkillError> {
        for attempt in 1.. {
            let mut above = down;
            above.translation.z = height(down.translation.z);
            self.travel(&above)?;
            // What sits aslant between the ribs of the fingers may turn back by its own weight.
            self.hand.pushed |= attempt == 1 && self.is_aslant();
            if !self.hand.pushed || attempt == TRIES {
                break;
            }
            let Some(before) = self.hand.held.clone() else { break };
            self.regrip(&before.part)?;
            let Some(held) = &self.hand.held else { break };
            let moved = before.x_tp * held.x_tp.inverse();
            down *= moved;
            if moved.rotation.angle() < ASLANT {
                break;
            }
        }
        Ok(down)
    }

    /// Turns a hand that leans straight down again: it leans when the beam in it has turned and was made level, and then its
    /// ribs stand aslant in the beam's slots, which follow a finger that opens. What resists stops it: the fingers open anyway.
    fn straighten(&mut self) -> Result<(), SkillError> {
        let lean = |x_wt: &Pose| (x_wt.rotation * Vector3::z()).angle(&-Vector3::z());
        if lean(&self.hand.setpoint) < ASLANT {
            return Ok(());
        }
        let Some(mut held) = self.hand.held.clone() else { return Ok(()) };
        let x_wp = self.belief.pose(&held.part)?;
        // A beam that is held firmly turns along with the hand.
        self.hand.grip(BEAM_WIDTH - SQUEEZE, LOOSE_GRIP)?;
        // What is left holds against it: turned further until the hand is straight, not only where it is told to be.
        for _ in 0..STRAIGHTENINGS {
            let seen = self.hand.seen.x_wt;
            if lean(&seen) < STRAIGHT {
                break;
            }
            let across = seen.rotation * Vector3::x();
            let straight = Pose::from_parts(seen.translation, hand_down(across.y.atan2(across.x)));
            let target = self.hand.corrected(&seen, &straight);
            if self.hand.drive(&target, 0.02, |hand| hand.force().norm() > STRAIGHTEN_LIMIT)? {
                break;
            }
            self.hand.wait(0.1)?;
        }
        self.hand.relax();
        // The hand has turned, and the beam has stayed.
        self.belief.expect(&held.part, x_wp, STAYED);
        held.x_tp = self.hand.seen.x_wt.inverse() * x_wp;
        self.hand.held = Some(held);
        Ok(())
    }

    /// Lets go of what is held and retreats straight up.
    ///
    /// # Errors
    /// [`Fault::Overload`], and the robot's.
    pub fn release(&mut self) -> Result<(), SkillError> {
        self.hand.relax();
        if self.hand.held.as_ref().is_some_and(|held| self.kit.beam(&held.part).is_some()) {
            self.straighten()?;
        }
        let held = self.hand.held.take();
        self.belief.update(&mut self.hand)?;
        if let Some(held) = &held {
            self.belief.released(&held.part);
        }
        let beam = held.as_ref().filter(|held| self.kit.beam(&held.part).is_some());
        let Some(held) = beam else {
            self.hand.grip(PEG_OPEN, 20.0)?;
            self.belief.update(&mut self.hand)?;
            return self.retreat(f64::INFINITY).map(|_| ());
        };
        for attempt in 0..=LET_GO_AGAIN {
            self.hand.grip(BEAM_RELEASE, 20.0)?;
            self.belief.update(&mut self.hand)?;
            // The beam may have followed one finger: go back to its middle, so that neither rib hangs on it.
            let middle = self.belief.pose(&held.part)? * held.x_tp.inverse();
            let here = self.hand.setpoint;
            let mut over = here;
            over.translation.x = middle.translation.x;
            over.translation.y = middle.translation.y;
            // A finger that meets the beam shows that it is not where it is believed: its rib would lift it.
            if self.hand.drive(&over, 0.02, |hand| hand.force().norm() > BESIDE_LIMIT)? {
                self.hand.go(&here, 0.02)?;
            }
            let low = self.hand.setpoint;
            let limit = if attempt < LET_GO_AGAIN { BESIDE_LIMIT } else { f64::INFINITY };
            if self.retreat(limit)? {
                break;
            }
            self.note("retry", format!("let go of {}, which hangs on a finger", held.part));
            self.hand.relax();
            // A rib that has come out of its slot meets the beam on the way back: then it is free to rise.
            if !self.hand.drive(&low, 0.05, |hand| -hand.force().z > BESIDE_LIMIT)? {
                self.hand.go(&here, 0.05)?;
                self.centre_ribs()?;
            }
        }
        Ok(())
    }

    /// Rises from what was let go of, as long as it does not meet more than `limit`, N; tells whether it has risen.
    fn retreat(&mut self, limit: f64) -> Result<bool, SkillError> {
        let mut up = self.hand.setpoint;
        up.translation.z += 0.05;
        let before = self.hand.force();
        if self.hand.drive(&up, 0.2, |hand| (hand.force() - before).norm() > limit)? {
            return Ok(false);
        }
        self.belief.update(&mut self.hand)?;
        Ok(true)
    }

    /// Closes on the beam between the fingers, loosely, and brings their ribs to the middle of its slots: on one that presses
    /// against the upper edge of its slot the beam hangs by friction, and follows that finger however far it opens.
    fn centre_ribs(&mut self) -> Result<(), SkillError> {
        self.hand.grip(BEAM_WIDTH - SQUEEZE, LOOSE_GRIP)?;
        let mut down = self.hand.setpoint;
        down.translation.z -= SLOT_LIMIT.1;
        // Ribs that stand on the edges of the slots come in on the way down.
        self.hand.drive(&down, 0.01, |hand| hand.seen.width < BEAM_WIDTH + IN_SLOT / 2.0)?;
        self.hand.relax();
        self.hand.grip(BEAM_WIDTH + IN_SLOT, 20.0)?;
        self.hand.zero()?;
        down.translation.z = self.hand.setpoint.translation.z - SLOT_LIMIT.1;
        self.hand.drive(&down, 0.01, |hand| -hand.force().z > SLOT_LIMIT.0)?;
        self.hand.relax();
        let mut middle = self.hand.setpoint;
        middle.translation.z += SLOT_ROOM;
        self.hand.go(&middle, 0.01)
    }
}
