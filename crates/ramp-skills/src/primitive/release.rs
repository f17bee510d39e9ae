//! Releases the held part without moving it.

use nalgebra::{Point3, Translation3, Vector3};
use ramp_robot::{GRAVITY, Retry};

use crate::Pose;
use crate::cell::Workcell;
use crate::fault::{Fault, SkillError};
use crate::grasp::{self, BEAM_WIDTH, hand_down};
use crate::hand::Held;
use crate::parameters::Parameters;

impl Workcell<'_, '_> {
    /// Releases the held part and retreats straight up.
    ///
    /// # Errors
    /// [`Fault::Overload`], and the robot's.
    pub fn release(&mut self) -> Result<(), SkillError> {
        self.hand.relax();
        if self.hand.held.as_ref().is_some_and(|held| self.kit.beam(&held.part).is_some()) {
            self.straighten()?;
        }
        let mut held = self.hand.held.take();
        self.glance()?;
        if let Some(held) = &held {
            self.belief.parts.released(&held.part);
        }
        let beam = held.as_mut().filter(|held| self.kit.beam(&held.part).is_some());
        let fast = (self.parameters.release.lift_off, self.parameters.release.lift_off_speed);
        let Some(held) = beam else {
            self.hand.grip(self.parameters.grip.peg_open, self.parameters.grip.opening_force)?;
            self.glance()?;
            return self.lift_off(&[fast], f64::INFINITY, None).map(|_| ());
        };
        let free = !self.stands(&held.part);
        let room = self.make_room(held, free)?;
        let held = &*held;
        for attempt in 0..=self.parameters.release.again {
            let release = &self.parameters.release;
            let width = if attempt == 0 { room } else { release.less_open };
            let last = attempt == release.again;
            self.open(width, free)?;
            // A finger that meets a neighbour pushes the hand aside, and the rib of the other one stays in
            // its slot.
            let has_room = last || self.hand.force().norm() < self.parameters.release.beside_limit;
            self.belief.parts.update(&mut self.hand)?;
            // Nothing holds a free beam back: one that has come along with a finger hangs on its rib.
            let followed = !has_room || free && !last && self.is_at_a_finger(held)?;
            // The beam may have followed one finger: go back to its middle, so that neither rib hangs on it.
            // Fingers that have closed on it once more are in its middle, wherever it is believed to be.
            let middle = self.belief.parts.pose(&held.part)? * held.x_tp.inverse();
            let here = self.hand.setpoint;
            let mut over = here;
            if attempt == 0 {
                over.translation.x = middle.translation.x;
                over.translation.y = middle.translation.y;
            }
            // A finger that meets the beam shows that it is not where it is believed: its rib would lift it.
            if self.hand.drive(&over, self.parameters.release.centre_speed, |hand| {
                hand.force().norm() > self.parameters.release.beside_limit
            })? {
                self.hand.go(&here, self.parameters.release.centre_speed)?;
            }
            let low = self.hand.setpoint;
            let limit = if last { f64::INFINITY } else { self.parameters.release.beside_limit };
            // A beam that hangs on a finger comes along, and meets the upper edge of its joint: slowly at
            // first.
            let slow = (self.parameters.release.leaving, self.parameters.release.leaving_speed);
            // One that comes along altogether tells by its weight.
            let hanging = (!last).then_some(held);
            let follows = followed || !last && self.follows_a_finger(held)?;
            if !follows && self.lift_off(&[slow, fast], limit, hanging)? {
                self.belief.parts.update(&mut self.hand)?;
                break;
            }
            let retry = Retry::new("let_go_of", &held.part).attempt(attempt + 2);
            let because = if has_room { "it hangs on a finger" } else { "a finger has no room to open" };
            self.record(retry.because(because));
            self.hand.relax();
            // A rib that has left its slot meets the beam on the way back: then the hand is free to retreat.
            let mut back = |low: &Pose| {
                self.hand.drive(low, self.parameters.release.back_speed, |hand| {
                    -hand.force().z > self.parameters.release.beside_limit
                })
            };
            // A hand that hangs may meet more than it yields to as it begins to go back.
            let met = match back(&low) {
                Err(SkillError::Fault(Fault::Overload { .. })) => yielded(back(&low))?,
                met => met?,
            };
            if met {
                self.hand.relax();
                if !last && self.lift_off(&[slow, fast], limit, hanging)? {
                    self.belief.parts.update(&mut self.hand)?;
                    break;
                }
                self.hand.relax();
            } else {
                self.hand.go(&here, self.parameters.release.back_speed)?;
                self.centre_ribs(free, self.kit.beam(&held.part).map_or(0.0, |beam| beam.mass()))?;
            }
        }
        Ok(())
    }

    /// Slides a hand whose fingers a neighbour leaves no room along the beam between them, to the nearest
    /// place where they can open. Gives the width (m) to which they can.
    fn make_room(&mut self, held: &mut Held, free: bool) -> Result<f64, SkillError> {
        let parameters = self.parameters.clone();
        let Parameters { grip, release, .. } = &*parameters;
        let (x_wt, x_wp) = (self.hand.setpoint, self.belief.parts.pose(&held.part)?);
        let widths = [grip.beam_release, release.less_open];
        if let Some(width) = widths.into_iter().find(|width| self.has_room(&x_wt, *width, &held.part)) {
            return Ok(width);
        }
        let s = (held.x_tp.inverse() * Point3::origin()).x;
        let links = self.kit.beam(&held.part).map_or(&[][..], |beam| &beam.links);
        let spans = links.iter().map(|link| grasp::span(link, grip));
        let Some([from, to]) = spans.min_by(|a, b| beside(*a, s).total_cmp(&beside(*b, s))) else {
            return Ok(release.less_open);
        };
        let along = x_wp.rotation * Vector3::x();
        let shifted = |by: f64| Translation3::from(along * by) * x_wt;
        let count = ((to - from) / release.room_step).ceil() as i32;
        let mut shifts: Vec<f64> = (-count..=count).map(|step| f64::from(step) * release.room_step).collect();
        shifts.retain(|by| (from..=to).contains(&(s + by)));
        shifts.sort_by(|a, b| a.abs().total_cmp(&b.abs()));
        let fits = |width: f64| {
            let by = shifts.iter().find(|by| self.has_room(&shifted(**by), width, &held.part));
            by.map(|by| (*by, width))
        };
        let Some((by, width)) = widths.into_iter().find_map(fits) else { return Ok(release.less_open) };
        let because = format!("{:.0} mm along the beam, where the fingers have room", by * 1e3);
        self.record(Retry::new("let_go_of", &held.part).because(because));
        self.open(BEAM_WIDTH + release.in_slot, free)?;
        self.hand.zero()?;
        self.hand
            .drive(&shifted(by), release.centre_speed, |hand| hand.force().norm() > release.beside_limit)?;
        self.hand.relax();
        held.x_tp = self.hand.seen.x_wt.inverse() * x_wp;
        Ok(width)
    }

    /// Whether a beam stands in the assembly, as is believed.
    fn stands(&self, beam: &str) -> bool {
        self.assembly.beam_index(beam).is_some_and(|beam| self.belief.standing.contains(&beam))
    }

    /// True if the beam still touches one finger of the open hand after the hand has moved to its middle: the
    /// beam follows a rib. With cameras a look would cost time; there the force during the rise shows it.
    fn follows_a_finger(&mut self, held: &Held) -> Result<bool, SkillError> {
        if self.belief.parts.eyes.images() {
            return Ok(false);
        }
        self.belief.parts.update(&mut self.hand)?;
        self.is_at_a_finger(held)
    }

    /// Whether the beam is at one finger of the open hand, as is believed now.
    fn is_at_a_finger(&self, held: &Held) -> Result<bool, SkillError> {
        let x_tp = self.hand.seen.x_wt.inverse() * self.belief.parts.pose(&held.part)?;
        let gripped = held.x_tp.inverse() * Point3::origin();
        let off = (x_tp * gripped).y.abs();
        let at_a_finger = (self.hand.seen.width - BEAM_WIDTH) / 2.0;
        Ok(off > self.parameters.release.followed * at_a_finger)
    }

    /// Turns a hand that leans straight down again: it leans when the beam in it has turned and was made
    /// level, and then its ribs are tilted in the beam's slots, which follow a finger that opens. A
    /// resistance stops the turn: the fingers open anyway.
    fn straighten(&mut self) -> Result<(), SkillError> {
        if lean(&self.hand.setpoint) < self.parameters.carry.tilted {
            return Ok(());
        }
        let Some(mut held) = self.hand.held.clone() else { return Ok(()) };
        let x_wp = self.belief.parts.pose(&held.part)?;
        // A beam that is held firmly turns along with the hand.
        self.hand.grip(BEAM_WIDTH - self.parameters.grip.squeeze, self.parameters.release.loose_grip)?;
        // The released part resists the rotation: it continues until the hand itself is upright, not only its
        // setpoint.
        for _ in 0..self.parameters.release.straightenings {
            let seen = self.hand.seen.x_wt;
            if lean(&seen) < self.parameters.release.straight {
                break;
            }
            let across = seen.rotation * Vector3::x();
            let straight = Pose::from_parts(seen.translation, hand_down(across.y.atan2(across.x)));
            let target = self.hand.corrected(&seen, &straight);
            if self.hand.drive(&target, self.parameters.release.straighten_speed, |hand| {
                hand.force().norm() > self.parameters.release.straighten_limit
            })? {
                break;
            }
            self.hand.wait(self.parameters.hand.rest)?;
        }
        self.hand.relax();
        // The hand has turned, and the beam has stayed.
        self.belief.parts.expect(
            &held.part,
            x_wp,
            (self.parameters.release.stayed_position, self.parameters.release.stayed_rotation),
        );
        held.x_tp = self.hand.seen.x_wt.inverse() * x_wp;
        self.hand.held = Some(held);
        Ok(())
    }

    /// Lifts the hand off the released part, while the force is at most `limit` (N), and as long as `hanging`
    /// does not come along. Returns true if the hand is off. `stages` are heights (m) and the speeds up to
    /// them (m/s).
    fn lift_off(
        &mut self,
        stages: &[(f64, f64)],
        limit: f64,
        hanging: Option<&Held>,
    ) -> Result<bool, SkillError> {
        let from = self.hand.setpoint;
        let before = self.hand.force();
        let low = hanging.map(|held| self.height_of_grip(held)).transpose()?;
        for &(height, speed) in stages {
            let up = Translation3::new(0.0, 0.0, height) * from;
            let stopped = match self.hand.drive(&up, speed, |hand| (hand.force() - before).norm() > limit) {
                // An estimated wrench shows the limit only when the real force exceeds it.
                stopped if limit.is_finite() => yielded(stopped)?,
                stopped => stopped?,
            };
            if stopped {
                return Ok(false);
            }
            let Some((held, low)) = hanging.zip(low) else { continue };
            let weight = self.parameters.release.hanging * held.mass * GRAVITY;
            if (self.hand.force() - before).z > weight {
                // The arm's own friction may feel like a beam: an image decides.
                self.look_again(self.parameters.grip.looks)?;
                if self.height_of_grip(held)? - low > height / 2.0 || self.is_at_a_finger(held)? {
                    return Ok(false);
                }
            }
        }
        Ok(true)
    }

    /// Height of the place by which a part was held, as is believed now, m.
    fn height_of_grip(&self, held: &Held) -> Result<f64, SkillError> {
        let gripped = held.x_tp.inverse() * Point3::origin();
        Ok((self.belief.parts.pose(&held.part)? * gripped).z)
    }

    /// Opens the fingers to `width` (m). Around a beam that is `free`, that no joint would hold back, they
    /// open with more force if ribs that were closed on the edges of the slots are wedged in them.
    fn open(&mut self, width: f64, free: bool) -> Result<(), SkillError> {
        self.hand.grip(width, self.parameters.grip.opening_force)?;
        if free && width - self.hand.seen.width > self.parameters.hand.opened {
            self.hand.grip(width, self.parameters.release.wedged_force)?;
        }
        Ok(())
    }

    /// Closes on the beam between the fingers, loosely, and brings their ribs to the middle of its slots: on
    /// one that presses against the upper edge of its slot the beam hangs by friction, and follows that
    /// finger however far it opens. `carried` (kg) is the mass of a beam that may hang on the ribs now: on
    /// the way down what it lies on takes over its weight.
    pub fn centre_ribs(&mut self, free: bool, carried: f64) -> Result<(), SkillError> {
        self.hand.grip(BEAM_WIDTH - self.parameters.grip.squeeze, self.parameters.release.loose_grip)?;
        let mut down = self.hand.setpoint;
        down.translation.z -= self.parameters.release.slot_depth;
        // Ribs that stand on the edges of the slots come in on the way down.
        self.hand.drive(&down, self.parameters.release.slot_speed, |hand| {
            hand.seen.width < BEAM_WIDTH + self.parameters.release.in_slot / 2.0
        })?;
        self.hand.relax();
        self.open(BEAM_WIDTH + self.parameters.release.in_slot, free)?;
        self.hand.zero()?;
        down.translation.z = self.hand.setpoint.translation.z - self.parameters.release.slot_depth;
        let limit = self.parameters.release.slot_limit + carried * GRAVITY;
        self.hand.drive(&down, self.parameters.release.slot_speed, |hand| -hand.force().z > limit)?;
        self.hand.relax();
        let mut middle = self.hand.setpoint;
        middle.translation.z += self.parameters.release.slot_room;
        self.hand.go(&middle, self.parameters.release.slot_speed)
    }

    /// Lets the free end of a held beam down on the table before the fingers open: one that fell would hang
    /// on them, and follow them. Fingers with a dead time are commanded to open at once; the motion ends
    /// before they do.
    pub fn settle(&mut self, beam: usize) -> Result<(), SkillError> {
        let name = self.assembly.beams[beam].beam.name.clone();
        let x_wb = self.belief.parts.pose(&name)?;
        let Some(drooped) = self.belief.drooped(beam, &x_wb) else { return Ok(()) };
        let down = self.hand.corrected(&x_wb, &drooped);
        self.hand.zero()?;
        let Parameters { release, grip, .. } = &*self.parameters;
        let rest = self.parameters.hand.rest;
        let way = (down.translation.vector - self.hand.setpoint.translation.vector).norm();
        let within = way / release.table_speed + release.table_time;
        // A hand that leans grips the beam loosely first, and one without room goes along the beam.
        let upright = lean(&self.hand.setpoint) < self.parameters.carry.tilted;
        let opens_at = (upright && self.has_room(&down, grip.beam_release, &name))
            .then(|| self.hand.open_ahead(grip.beam_release, grip.opening_force, within + rest))
            .flatten();
        let limit = release.table_limit;
        self.hand.drive(&down, release.table_speed, |hand| {
            -hand.force().z > limit || opens_at.is_some_and(|at| hand.time() + rest > at)
        })?;
        self.hand.wait(rest)?;
        Ok(())
    }
}

/// Whether a motion ended before its end, or the hand yielded.
fn yielded(stopped: Result<bool, SkillError>) -> Result<bool, SkillError> {
    match stopped {
        Err(SkillError::Fault(Fault::Overload { .. })) => Ok(true),
        stopped => stopped,
    }
}

/// Distance of a place on a beam from a stretch of it, m.
fn beside([from, to]: [f64; 2], s: f64) -> f64 {
    (from - s).max(s - to).max(0.0)
}

/// How far a hand leans, rad.
fn lean(x_wt: &Pose) -> f64 {
    (x_wt.rotation * Vector3::z()).angle(&-Vector3::z())
}
