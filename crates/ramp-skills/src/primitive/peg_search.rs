//! Searches with the tip of a held peg for the hole below it: a spiral, and a line for a peg that is tilted
//! in the hand.

use std::f64::consts::TAU;

use nalgebra::{Point3, Translation3, UnitQuaternion, Vector3, Vector6};
use ramp_kit::joint::{HEAD_HEIGHT, STEM_LENGTH, STEM_RADIUS};
use ramp_robot::Cause;

use super::wrench::{across, moment_below};
use crate::Pose;
use crate::cell::Workcell;
use crate::fault::SkillError;
use crate::grasp::PEG_HEIGHT;
use crate::hand::trim::Trim;
use crate::parameters::contact::PegSearchParameters;
use ramp_robot::PERIOD;

impl PegSearchParameters {
    /// Distance of the spiral from its centre (m) after it has turned by an angle: outward, inward, and
    /// outward again.
    fn radius(&self, angle: f64) -> f64 {
        let path = self.pitch * angle / TAU % (2.0 * self.widest);
        path.min(2.0 * self.widest - path)
    }
}

impl Workcell<'_, '_> {
    /// True if the tip of the held peg is far enough below the plate (m, in the world) to be in the hole.
    pub fn is_in(&self, plate: f64) -> bool {
        self.is_deeper(plate, self.parameters.peg_search.found)
    }

    /// Is the tip of the held peg that far (m) below the plate (m, in the world)?
    pub fn is_deeper(&self, plate: f64, depth: f64) -> bool {
        let tip = self.hand.x_wp_held().map(|x| (x * Point3::new(0.0, 0.0, -STEM_LENGTH)).z - plate);
        tip.is_some_and(|tip| tip < -depth)
    }

    /// Lets the held peg down by `height` (m) and a little further, until it touches the plate (m, in the
    /// world) or is in. Returns the error of the moment at its tip during the free descent, N·m. It limits
    /// the accuracy of the measured contact point. A sensor has little noise; an arm's estimate is off by the
    /// friction in its joints.
    pub fn lower(&mut self, plate: f64, height: f64) -> Result<f64, SkillError> {
        let mut down = self.hand.setpoint;
        down.translation.z -= height + 2.0 * self.parameters.peg_search.found;
        let tip = |x_wp: &Pose| (x_wp * Point3::new(0.0, 0.0, -STEM_LENGTH)).z - plate;
        let (touch, length) = (self.parameters.peg_search.touch, self.arm.hand.tip);
        let mut off = 0.0_f64;
        self.hand.drive(&down, self.parameters.peg_search.lower_speed, |hand| {
            let pressed = -hand.force().z;
            if pressed < 0.5 * touch {
                off = off.max(moment_below(hand, length, &hand.wrench(), plate).dot(&across(hand)).abs());
            }
            pressed > touch || hand.x_wp_held().is_some_and(|x| tip(&x) < -self.parameters.peg_search.found)
        })?;
        Ok(off)
    }

    /// Apparent distance beside the hand (m) of the contact point of an upright peg that presses with this
    /// force (N), for a given error of the moment (N·m).
    fn seems_beside(&self, off: f64, force: f64) -> f64 {
        let search = &self.parameters.peg_search;
        search.tilted_least + search.moment_spread * off / force
    }

    /// Place of the hand with the tip of the held peg, as is believed, over `mouth` (m, both in the world).
    pub fn over_mouth(&self, mouth: &Vector3<f64>) -> Vector3<f64> {
        let hand = self.hand.seen.x_wt.translation.vector;
        let tip = self.hand.x_wp_held().map(|x| (x * Point3::new(0.0, 0.0, -STEM_LENGTH)).coords);
        tip.map_or(*mouth, |tip| mouth + hand - tip)
    }

    /// Searches for the hole along an Archimedean spiral of the hand about `centre` (m, in the world), with
    /// constant light force down, until the tip drops in or the time limit (s) is reached. Friction drags
    /// the tip behind, and the setpoint leads it by as much. A tip that sinks a little is let in. At its
    /// widest radius the spiral turns back inward. A `wary` search gets the error of the moment (N·m), begins
    /// slowly, and ends when the measured contact point cannot be the tip of an upright peg, which would come
    /// off the plate before it came to the hole.
    pub fn spiral(
        &mut self,
        plate: f64,
        centre: &Vector3<f64>,
        longest: f64,
        wary: Option<f64>,
    ) -> Result<(), SkillError> {
        let mut trim = Trim::at_named_poses(self.hand.trim_bounds(), Vector3::z());
        let begin = self.hand.time();
        let (mut angle, mut measured, mut period) = (0.0_f64, Vector6::zeros(), 0);
        let mut contact = None;
        let force = self.parameters.peg_search.force;
        while self.hand.time() - begin < longest {
            let radius = self.parameters.peg_search.radius(angle);
            // The tip of a tilted peg is near the edge of the plate: slowly, until it is known where it
            // presses.
            let slow = wary.is_some() && period < self.parameters.peg_search.periods;
            let search = &self.parameters.peg_search;
            let speed = if slow { search.tilted_speed } else { search.speed };
            angle += speed * PERIOD / radius.max(0.5e-3);
            let mut wanted = self.hand.setpoint;
            wanted.translation.x = centre.x + radius * angle.cos();
            wanted.translation.y = centre.y + radius * angle.sin();
            let kept = trim.trimmed(&wanted, &self.hand.seen.x_wt).translation;
            self.slide_to(kept.x, kept.y, force)?;
            if self.is_in(plate) {
                break;
            }
            let height = self.hand.seen.x_wt.translation.z;
            if height < *contact.get_or_insert(height) - self.parameters.peg_search.caught {
                if self.sink(plate)? {
                    break;
                }
                contact = None;
            }
            if (self.parameters.peg_search.periods / 3..self.parameters.peg_search.periods).contains(&period)
            {
                measured += self.hand.wrench();
            }
            let beside = || self.tip_beside(&measured, plate).dot(&self.across()).abs();
            if let Some(off) = wary
                && period == self.parameters.peg_search.periods
                && beside() > STEM_RADIUS + self.seems_beside(off, force)
            {
                break;
            }
            period += 1;
        }
        Ok(())
    }

    /// Presses with a tip that has sunk a little, while the hand goes along with it: its cone leads it into
    /// the hole, unless the hand holds it aside. Returns whether it went in.
    fn sink(&mut self, plate: f64) -> Result<bool, SkillError> {
        let PegSearchParameters { sink_force, sink_time, .. } = self.parameters.peg_search;
        let begin = self.hand.time();
        while self.hand.time() - begin < sink_time && !self.is_in(plate) {
            let here = self.hand.seen.x_wt.translation;
            self.slide_to(here.x, here.y, sink_force)?;
        }
        Ok(self.is_in(plate))
    }

    /// One control period of sliding over the plate, to a place (m in the world), with constant force down
    /// (N). A tip that falls into the hole goes down with the speed of lowering, and does not gain speed
    /// until its head meets the plate.
    fn slide_to(&mut self, x: f64, y: f64, force: f64) -> Result<(), SkillError> {
        let z = self.hand.seen.x_wt.translation.z - force / self.hand.stiffness.z;
        let fall = self.parameters.peg_search.lower_speed * PERIOD;
        let setpoint = &mut self.hand.setpoint.translation;
        setpoint.x = x;
        setpoint.y = y;
        setpoint.z = setpoint.z.min(z.max(setpoint.z - fall));
        self.hand.tick()?;
        Ok(())
    }

    /// A hole that is not where it was seen: the peg may have turned between the fingers, about the axis on
    /// which they close, where no camera sees it. Its tip is then beside the hand, along the fingers' other
    /// axis, and presses on the plate there, which the wrist measures: takes the tip to the hole, and turns
    /// the hand until the peg stands upright. If the peg is `sure` to be tilted, it is taken along the whole
    /// line on which its tip may be, wherever the wrist has it. Returns whether it is upright in the hole.
    pub fn search_tilted(
        &mut self,
        connection: usize,
        peg: &str,
        plate: f64,
        sure: bool,
    ) -> Result<bool, SkillError> {
        let mouth = self.belief.mouth(connection)?;
        // The cause of the peg's rotation may have pressed on it while the sensor was zeroed.
        let mut up = self.hand.setpoint;
        up.translation.z = self.hand.seen.x_wt.translation.z + self.parameters.peg_search.lift_off;
        self.hand.go(&up, self.parameters.peg_search.lower_speed)?;
        self.hand.zero()?;
        let off = self.lower(plate, self.parameters.peg_search.lift_off)?;
        let PegSearchParameters { tilted_force: force, tilted_most: most, tilted_around: around, .. } =
            self.parameters.peg_search;
        let axis = self.across();
        let aside = Vector3::z().cross(&axis);
        // A tip on the edge of the hole does not press straight down: then it is measured beside the hole.
        let mut beside = self.measure_tip(plate)?.dot(&axis);
        if beside.abs() > most {
            let p = mouth + aside * around;
            for _ in 0..self.parameters.peg_search.periods {
                self.slide_to(p.x, p.y, force)?;
            }
            beside = self.measure_tip(plate)?.dot(&axis);
        }
        let measured = (self.seems_beside(off, force)..most).contains(&beside.abs());
        if measured {
            let stops = [-beside, around - beside, -around - beside];
            let speed = self.parameters.peg_search.tilted_speed;
            if self.slide_along(&mouth, &stops, speed)? {
                return self.set_upright_if_beside(peg, &mouth, true);
            }
        }
        if !sure {
            return Ok(false);
        }
        let side = -beside.signum();
        let stops = self.parameters.peg_search.tilted_stops.map(|stop| side * stop);
        let speed = self.parameters.peg_search.line_speed;
        if self.slide_along(&mouth, &stops, speed)? {
            return self.set_upright_if_beside(peg, &mouth, self.hand.slipped);
        }
        Ok(false)
    }

    /// Slides the tip of the held peg over the plate, the hand from stop to stop on the line through the
    /// mouth (m, in the world) on which it is when a tilted peg's tip is at the hole. Stops are distances
    /// from the mouth, m. Returns whether the tip went in.
    fn slide_along(&mut self, mouth: &Vector3<f64>, stops: &[f64], speed: f64) -> Result<bool, SkillError> {
        let axis = self.across();
        let aside = Vector3::z().cross(&axis);
        let PegSearchParameters { tilted_force, tilted_sway, pitch, .. } = self.parameters.peg_search;
        let mut from = self.hand.seen.x_wt.translation.vector;
        for stop in stops {
            let to = mouth + axis * *stop;
            let periods = ((to - from).xy().norm() / speed / PERIOD).ceil();
            for period in 0..periods as usize {
                let p = from.lerp(&to, period as f64 / periods);
                let turns = (p - mouth).dot(&axis) / pitch;
                let p = p + aside * tilted_sway * (TAU * turns).sin();
                self.slide_to(p.x, p.y, tilted_force)?;
                if self.is_in(mouth.z) {
                    return Ok(true);
                }
            }
            from = to;
        }
        Ok(false)
    }

    /// The tip of the held peg is in the hole at `mouth` (m, in the world). Sets a peg upright that is
    /// `tilted`, or must be, since the hand is farther beside the hole than a beam is from where it was
    /// seen. Returns whether it did.
    pub fn set_upright_if_beside(
        &mut self,
        peg: &str,
        mouth: &Vector3<f64>,
        tilted: bool,
    ) -> Result<bool, SkillError> {
        let off = self.hand.seen.x_wt.translation.vector - mouth;
        let (along, across) = (off.dot(&self.across()), off.dot(&Vector3::z().cross(&self.across())));
        let search = &self.parameters.peg_search;
        if !tilted && (along.abs() < search.tilted_surely || across.abs() > search.tilted_least) {
            return Ok(false);
        }
        let lean = along.abs().atan2(STEM_LENGTH + HEAD_HEIGHT / 2.0).to_degrees();
        self.diagnose(Cause::GripMoved, peg, format!("{peg} is tilted in the hand by {lean:.0}°"));
        self.set_upright(peg, mouth)?;
        Ok(true)
    }

    /// Horizontal offset from the hand of the tip of the held peg, pressed on the plate at a height (m); m in
    /// the world. Computed from force and moment at the wrist over some time.
    fn measure_tip(&mut self, plate: f64) -> Result<Vector3<f64>, SkillError> {
        let here = self.hand.setpoint.translation.vector;
        let mut measured = Vector6::zeros();
        for period in 0..self.parameters.peg_search.periods {
            self.slide_to(here.x, here.y, self.parameters.peg_search.tilted_force)?;
            if period >= self.parameters.peg_search.periods / 3 {
                measured += self.hand.wrench();
            }
        }
        Ok(self.tip_beside(&measured, plate))
    }

    /// The tip of a peg is in the hole at `mouth` (m, in the world) while the hand is beside it: turns the
    /// hand about the hole until the peg is upright.
    fn set_upright(&mut self, peg: &str, mouth: &Vector3<f64>) -> Result<(), SkillError> {
        let off = self.hand.seen.x_wt.translation.vector - mouth;
        let lean = Vector3::new(off.x, off.y, STEM_LENGTH + HEAD_HEIGHT / 2.0);
        let Some(turn) = UnitQuaternion::rotation_between(&lean, &Vector3::z()) else { return Ok(()) };
        self.hand.relax();
        let about =
            Translation3::from(Vector3::new(mouth.x, mouth.y, mouth.z - self.parameters.peg_search.found));
        let upright = about * turn * about.inverse() * self.hand.seen.x_wt;
        self.hand.go(&upright, self.parameters.peg_search.upright_speed)?;
        let head = self.hand.seen.x_wt * Point3::new(0.0, 0.0, PEG_HEIGHT - HEAD_HEIGHT / 2.0);
        let x_wp = Pose::translation(mouth.x, mouth.y, head.z - HEAD_HEIGHT / 2.0);
        self.hand.slipped = false;
        self.belief.parts.follow(&self.hand);
        self.belief.parts.reckoned(peg, &x_wp);
        if let Some(held) = &mut self.hand.held {
            held.x_tp = self.hand.seen.x_wt.inverse() * x_wp;
        }
        Ok(())
    }
}
