//! Pinning two joints with a peg: touch, search in a spiral, press with a small circle, check, try again.

use std::f64::consts::TAU;

use nalgebra::{Point3, Translation3, UnitQuaternion, Vector3, Vector6};
use ramp_kit::joint::{FEMALE_HEIGHT, HEAD_HEIGHT, STEM_LENGTH, STEM_RADIUS};
use ramp_robot::Cause;

use crate::Pose;
use crate::fault::{Fault, SkillError};
use crate::grasp::{PEG_HEIGHT, PEG_OPEN, PEG_WIDTH, hand_down, peg_grasp};
use crate::hand::PERIOD;
use crate::transport::{TRAVEL, Workcell};

/// Height of a peg's tip over the female's top plate when it is brought over the hole, m.
const OVER: f64 = 6.0e-3;
/// Depth of the tip below the top plate at which the hole counts as found, m.
const FOUND: f64 = 2.2e-3;
/// Force at which the peg has touched the plate, N.
const TOUCH: f64 = 5.0;
/// Force down during the search, N.
const SEARCH_FORCE: f64 = 9.0;
/// Distance between turns of the spiral, m.
const PITCH: f64 = 0.7e-3;
/// Speed along the spiral, m/s.
const SEARCH_SPEED: f64 = 8.0e-3;
/// How long a hole is searched near where it was seen, s: up to 3 mm.
const NEAR_TIME: f64 = 5.0;
/// A peg whose tip is this far beside the hand stands aslant, m: up to 16°.
const ASLANT: [f64; 2] = [2.5e-3, 13.0e-3];
/// What presses this far beside the hand is not the tip of an upright peg, m: its edge is a radius away.
const BESIDE: f64 = STEM_RADIUS + ASLANT[0];
/// How far such a peg is lifted off the plate to take zero anew, m.
const LIFT_OFF: f64 = 3.0e-3;
/// How far around the place where its tip should meet the hole it is searched for (m), how fast (m/s), and with what
/// swing (m).
const ASLANT_AROUND: f64 = 4.0e-3;
/// See [`ASLANT_AROUND`].
const ASLANT_SPEED: f64 = 4.0e-3;
/// See [`ASLANT_AROUND`].
const ASLANT_SWAY: f64 = 0.7e-3;
/// How long the tip is felt, control periods.
const FEEL_PERIODS: usize = 600;
/// Longest search, s.
const SEARCH_TIME: f64 = 20.0;
/// Largest force of pressing, N.
const PRESS: f64 = 25.0;
/// Growth of the pressing force, N/s.
const PRESS_RATE: f64 = 40.0;
/// Radius (m) and frequency (Hz) of the circle that keeps a peg from jamming.
const WIGGLE: (f64, f64) = (0.5e-3, 2.0);
/// A peg that takes so long, s, is held up by something.
const PRESS_LONG: f64 = 3.0;
/// Longest pressing, s.
const PRESS_TIME: f64 = 6.0;
/// For so long at the end of it, s, it is felt where the peg presses.
const PRESS_FELT: f64 = 1.5;
/// A peg that stands on the mouth of its hole and presses this far beside the hand turned between the fingers, m: one that
/// is held up by something else presses up to 6.3 mm beside it.
const PRESSED_BESIDE: f64 = 8.5e-3;
/// A head this near to the plate is home, m. The referee asks for 0.5 mm.
const SEATED: f64 = 0.25e-3;
/// How well peg and hole must be known before the peg is let down, m: a hole that is missed by little is felt.
const KNOWN: [f64; 2] = [0.2e-3, 0.4e-3];
/// A peg upright and this near to a hole, m along the table, stands in it.
const FALLEN: f64 = 3.0e-3;
/// How well their heights must be known to tell whether a peg is home, m.
const KNOWN_HEIGHT: f64 = 0.1e-3;
/// How far pressing a peg home may move the two beams, m and rad.
const BUMP: (f64, f64) = (0.2e-3, 0.06 / 180.0 * std::f64::consts::PI);
/// Tries.
const TRIES: usize = 3;

impl Workcell<'_, '_> {
    /// The pose of the top of a connection's hole in the world: on the female's top plate, z up.
    fn mouth(&self, connection: usize) -> Result<Vector3<f64>, SkillError> {
        let hole = self.belief.hole(self.assembly, self.assembly.connections[connection].female)?;
        Ok(Vector3::new(hole.x, hole.y, hole.z + FEMALE_HEIGHT / 2.0))
    }

    /// Carries the held peg over the hole of a connection.
    ///
    /// # Errors
    /// When there is no way, or the robot stops.
    pub fn approach_hole(&mut self, connection: usize) -> Result<(), SkillError> {
        self.see(&[self.hole(self.assembly.connections[connection].female)], KNOWN[1])?;
        self.diagnose_standing();
        let mouth = self.mouth(connection)?;
        let Some(part) = self.hand.held.as_ref().map(|held| held.part.clone()) else {
            return Err(Fault::NotHeld { part: "the peg".into() }.into());
        };
        self.regrip(&part)?;
        let height = mouth.z + OVER + 0.004 + STEM_LENGTH + PEG_HEIGHT;
        let q = self.hand.joints();
        let x = self.hand.seen.x_wt.rotation * Vector3::x();
        let yaw = x.y.atan2(x.x);
        // Any turn of the square head will do. What counts is how far the joints stay from their ends while the peg
        // goes in, in the posture in which the arm arrives there.
        let checker = self.checker(None);
        let candidates = [0.0, 1.0, -1.0, 2.0, -2.0, 3.0, -3.0, 4.0, -4.0, 5.0, -5.0, 6.0].map(|step| {
            let rotation = hand_down(yaw + step * TAU / 12.0);
            let over = Pose::from_parts(Translation3::new(mouth.x, mouth.y, height), rotation);
            let seated =
                Pose::from_parts(Translation3::new(mouth.x, mouth.y, mouth.z + PEG_HEIGHT), rotation);
            let arrival = self.planner.level(&q, &over, TRAVEL, &checker);
            let arrival = arrival.as_ref().and_then(|legs| legs.last()?.last());
            (over, arrival.map_or(-1.0, |arrival| self.planner.straight_margin(arrival, &seated)))
        });
        let x_wt = self.choose(&candidates).ok_or(Fault::NoGrasp { part })?;
        self.travel(&x_wt)
    }

    /// Pins a connection with the held peg, which is over its hole, and lets go of it.
    ///
    /// # Errors
    /// [`Fault::HoleNotFound`] or [`Fault::NotSeated`] after the last try.
    pub fn fasten(&mut self, connection: usize) -> Result<(), SkillError> {
        let Some(peg) = self.hand.held.as_ref().map(|held| held.part.clone()) else {
            return Err(Fault::NotHeld { part: "the peg".into() }.into());
        };
        self.hand.relax();
        let mut last = None;
        for attempt in 0..TRIES {
            match self.fasten_once(connection, &peg) {
                Err(SkillError::Fault(fault @ Fault::NotHeld { .. })) => return Err(fault.into()),
                Err(SkillError::Fault(fault)) => {
                    self.note("fault", fault.to_string());
                    // The hole is where it was seen, so the tip cannot be where it is believed to be.
                    let lost = matches!(fault, Fault::HoleNotFound { .. });
                    self.diagnose(if lost { Cause::GripMoved } else { Cause::Jam }, &fault);
                    last = Some(fault);
                }
                Err(error) => return Err(error),
                Ok(()) => {
                    last = None;
                    break;
                }
            }
            if attempt + 1 < TRIES {
                // Up and out of the hole, look again, and once more.
                let mut up = self.hand.setpoint;
                up.translation.z = self.mouth(connection)?.z + OVER + STEM_LENGTH + PEG_HEIGHT;
                self.hand.go(&up, 0.05)?;
                self.note(
                    "retry",
                    format!("fasten {} with {peg}", self.assembly.connections[connection].name),
                );
            }
        }
        if let Some(fault) = last {
            return Err(fault.into());
        }
        self.release()?;
        // Letting go may draw a peg up a little.
        self.press_home(connection, &peg)
    }

    /// The connection, if any, in whose hole a peg stands that nobody put there: one that fell.
    ///
    /// # Errors
    /// [`Fault::Unseen`].
    pub fn fallen_into(&self, peg: &str) -> Result<Option<usize>, SkillError> {
        let x_wp = self.belief.pose(peg)?;
        if (x_wp.rotation * Vector3::z()).z < 0.99 {
            return Ok(None);
        }
        for (index, connection) in self.assembly.connections.iter().enumerate() {
            let stands =
                [connection.female, connection.male].iter().all(|it| self.standing.contains(&it.beam));
            if !stands || self.pinned.iter().any(|(pinned, _)| *pinned == index) {
                continue;
            }
            let off = x_wp.translation.vector - self.mouth(index)?;
            if off.xy().norm() < FALLEN && off.z < STEM_LENGTH / 2.0 {
                return Ok(Some(index));
            }
        }
        Ok(None)
    }

    /// Presses a peg that stands in its hole home by its head, as often as it takes.
    ///
    /// # Errors
    /// [`Fault::NotSeated`] after the last try.
    pub fn press_home(&mut self, connection: usize, peg: &str) -> Result<(), SkillError> {
        for attempt in 0.. {
            self.see_gap(connection, peg)?;
            let gap = self.gap(connection, peg)?;
            if gap <= 2.0 * SEATED {
                break;
            }
            let name = self.assembly.connections[connection].name.clone();
            let proud = Fault::NotSeated { peg: peg.to_string(), connection: name, gap_mm: gap * 1e3 };
            if attempt == TRIES {
                return Err(proud.into());
            }
            self.note("retry", proud.to_string());
            let x_wt = peg_grasp(&self.belief.pose(peg)?, 0);
            self.seize(peg, &x_wt, PEG_OPEN, PEG_WIDTH)?;
            self.hand.zero()?;
            self.press(connection, peg)?;
            self.release()?;
        }
        self.pinned.push((connection, peg.to_string()));
        Ok(())
    }

    /// Looks until it is known how high the peg's head is over the female's top plate.
    fn see_gap(&mut self, connection: usize, peg: &str) -> Result<(), SkillError> {
        let hole = self.hole(self.assembly.connections[connection].female);
        self.see_height(&[self.middle(peg), hole], KNOWN_HEIGHT)
    }

    /// Standard deviation of [`Workcell::gap`], m.
    fn gap_deviation(&self, connection: usize, peg: &str) -> f64 {
        let (beam, p) = self.hole(self.assembly.connections[connection].female);
        let (part, underside) = self.middle(peg);
        self.belief.deviation(&part, &underside)[1].hypot(self.belief.deviation(&beam, &p)[1])
    }

    /// Height of the peg's head over the female's top plate, m.
    fn gap(&self, connection: usize, peg: &str) -> Result<f64, SkillError> {
        Ok(self.belief.pose(peg)?.translation.z - self.mouth(connection)?.z)
    }

    fn fasten_once(&mut self, connection: usize, peg: &str) -> Result<(), SkillError> {
        let name = self.assembly.connections[connection].name.clone();
        self.regrip(peg)?;
        // Upright over the hole, as exactly as the eyes allow.
        self.see(&[self.hole(self.assembly.connections[connection].female)], KNOWN[1])?;
        self.see(&[self.middle(peg)], KNOWN[0])?;
        self.diagnose_standing();
        for _ in 0..3 {
            self.glance()?;
            let x_wp = self.belief.pose(peg)?;
            let mouth = self.mouth(connection)?;
            let x = x_wp.rotation * Vector3::x();
            let yaw = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), x.y.atan2(x.x));
            let goal =
                Pose::from_parts(Translation3::new(mouth.x, mouth.y, mouth.z + OVER + STEM_LENGTH), yaw);
            let off = (goal.translation.vector - x_wp.translation.vector).norm();
            if off < 0.1e-3 && goal.rotation.angle_to(&x_wp.rotation) < 0.002 {
                break;
            }
            self.hand.correct(&x_wp, &goal, 0.05)?;
            self.hand.wait(0.1)?;
        }
        self.hand.zero()?;
        let plate = self.mouth(connection)?.z;
        self.regrip(peg)?;
        self.let_down(plate, OVER)?;
        if !self.is_in(plate) {
            let (begin, mut upright) = (self.hand.time(), false);
            self.spiral(plate, NEAR_TIME, true)?;
            if !self.is_in(plate) {
                upright = self.search_aslant(connection, peg, plate)?;
            }
            if !self.is_in(plate) {
                self.spiral(plate, SEARCH_TIME, false)?;
            }
            let seconds = self.hand.time() - begin;
            self.note("search", format!("spiral at {name}, {seconds:.1} s"));
            if seconds > NEAR_TIME && self.is_deeper(plate, 0.5 * FOUND) && !upright {
                let words = format!("{peg} went into {name} only after {seconds:.0} s");
                self.diagnose(Cause::GripMoved, words);
            }
        }
        if !self.is_deeper(plate, 0.5 * FOUND) {
            return Err(Fault::HoleNotFound { peg: peg.to_string(), connection: name }.into());
        }
        self.press(connection, peg)?;
        for joint in
            [self.assembly.connections[connection].female, self.assembly.connections[connection].male]
        {
            let (beam, _) = self.hole(joint);
            self.belief.bumped(&beam, BUMP);
        }
        self.see_gap(connection, peg)?;
        let gap = self.gap(connection, peg)?;
        // Only what is sure: there is a better look when the hand is off.
        if gap > SEATED + 2.0 * self.gap_deviation(connection, peg) {
            return Err(Fault::NotSeated { peg: peg.to_string(), connection: name, gap_mm: gap * 1e3 }.into());
        }
        Ok(())
    }

    /// Is the tip of the held peg so far below the plate (m, in the world) that it must be in the hole?
    fn is_in(&self, plate: f64) -> bool {
        self.is_deeper(plate, FOUND)
    }

    /// Is the tip of the held peg that far (m) below the plate (m, in the world)?
    fn is_deeper(&self, plate: f64, depth: f64) -> bool {
        let tip = self.hand.x_wp_held().map(|x| (x * Point3::new(0.0, 0.0, -STEM_LENGTH)).z - plate);
        tip.is_some_and(|tip| tip < -depth)
    }

    /// Lets the held peg down by `height` (m) and a little further, until it touches the plate (m, in the world) or is in.
    fn let_down(&mut self, plate: f64, height: f64) -> Result<(), SkillError> {
        let mut down = self.hand.setpoint;
        down.translation.z -= height + 2.0 * FOUND;
        let tip = |x_wp: &Pose| (x_wp * Point3::new(0.0, 0.0, -STEM_LENGTH)).z - plate;
        self.hand.drive(&down, 0.02, |hand| {
            -hand.force().z > TOUCH || hand.x_wp_held().is_some_and(|x| tip(&x) < -FOUND)
        })?;
        Ok(())
    }

    /// Searches for the hole along an Archimedean spiral with constant force down, until the tip drops in, for so many
    /// seconds at most. A `wary` search soon ends when what is felt cannot be the tip of an upright peg, which would come
    /// off the plate before it came to the hole.
    fn spiral(&mut self, plate: f64, longest: f64, wary: bool) -> Result<(), SkillError> {
        let centre = self.hand.seen.x_wt.translation.vector;
        let begin = self.hand.time();
        let (mut angle, mut felt, mut period) = (0.0_f64, Vector6::zeros(), 0);
        while self.hand.time() - begin < longest {
            let radius = PITCH * angle / TAU;
            angle += SEARCH_SPEED * PERIOD / radius.max(0.5e-3);
            self.slide_to(centre.x + radius * angle.cos(), centre.y + radius * angle.sin())?;
            if self.is_in(plate) {
                break;
            }
            if (FEEL_PERIODS / 3..FEEL_PERIODS).contains(&period) {
                felt += self.hand.felt();
            }
            let beside = || self.tip_beside(&felt, plate).dot(&self.across()).abs();
            if wary && period == FEEL_PERIODS && beside() > BESIDE {
                break;
            }
            period += 1;
        }
        Ok(())
    }

    /// The direction in which the tip of a peg that turned between the fingers is beside the hand: across the axis on which
    /// they close, along the table. Axes of the world.
    fn across(&self) -> Vector3<f64> {
        let x = self.hand.seen.x_wt.rotation * Vector3::x();
        Vector3::new(x.x, x.y, 0.0).normalize()
    }

    /// One control period of sliding over the plate with constant force down, m in the world.
    fn slide_to(&mut self, x: f64, y: f64) -> Result<(), SkillError> {
        let z = self.hand.seen.x_wt.translation.z - SEARCH_FORCE / self.hand.stiffness.z;
        let setpoint = &mut self.hand.setpoint.translation;
        setpoint.x = x;
        setpoint.y = y;
        setpoint.z = setpoint.z.min(z);
        self.hand.tick()?;
        Ok(())
    }

    /// A hole that is not where it was seen: the peg may have turned between the fingers, about the axis on which they
    /// close, where no camera sees it. Its tip is then beside the hand, along the fingers' other axis, and presses on the
    /// plate there, which the wrist feels: takes the tip to the hole, and turns the hand until the peg stands upright.
    /// Returns whether it did.
    fn search_aslant(&mut self, connection: usize, peg: &str, plate: f64) -> Result<bool, SkillError> {
        let mouth = self.mouth(connection)?;
        // What turned the peg may have pressed on it while zero was taken.
        let mut up = self.hand.setpoint;
        up.translation.z = self.hand.seen.x_wt.translation.z + LIFT_OFF;
        self.hand.go(&up, 0.02)?;
        self.hand.zero()?;
        self.let_down(plate, LIFT_OFF)?;
        let axis = self.across();
        let aside = Vector3::z().cross(&axis);
        // A tip on the edge of the hole does not press straight down: then felt beside it.
        let mut beside = self.feel_tip(plate)?.dot(&axis);
        if beside.abs() > ASLANT[1] {
            let p = mouth + aside * ASLANT_AROUND;
            for _ in 0..FEEL_PERIODS {
                self.slide_to(p.x, p.y)?;
            }
            beside = self.feel_tip(plate)?.dot(&axis);
        }
        if !(ASLANT[0]..ASLANT[1]).contains(&beside.abs()) {
            return Ok(false);
        }
        let lean = beside.abs().atan2(STEM_LENGTH + HEAD_HEIGHT / 2.0).to_degrees();
        self.diagnose(Cause::GripMoved, format!("{peg} stands aslant in the hand by {lean:.0}°"));
        let start = self.hand.seen.x_wt.translation.vector;
        let over = mouth - axis * beside;
        let way = |from: Vector3<f64>, to: Vector3<f64>| {
            let periods = ((to - from).xy().norm() / ASLANT_SPEED / PERIOD).ceil().max(1.0);
            (0..periods as usize).map(move |period| from.lerp(&to, period as f64 / periods))
        };
        let ends = [start, over, over + axis * ASLANT_AROUND, over - axis * ASLANT_AROUND];
        for p in ends.windows(2).flat_map(|ends| way(ends[0], ends[1])) {
            let sway = ASLANT_SWAY * (TAU * (p - over).dot(&axis) / PITCH).sin();
            let p = p + aside * sway;
            self.slide_to(p.x, p.y)?;
            if self.is_in(plate) {
                self.set_upright(peg, &mouth)?;
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// Where the tip of the held peg, which is pressed on the plate at a height (m), is beside the hand: along the table,
    /// m in the world. From force and moment at the wrist, taken over some time.
    fn feel_tip(&mut self, plate: f64) -> Result<Vector3<f64>, SkillError> {
        let here = self.hand.setpoint.translation.vector;
        let mut felt = Vector6::zeros();
        for period in 0..FEEL_PERIODS {
            self.slide_to(here.x, here.y)?;
            if period >= FEEL_PERIODS / 3 {
                felt += self.hand.felt();
            }
        }
        Ok(self.tip_beside(&felt, plate))
    }

    /// Where something presses on the plate at a height (m) beside the hand, by a wrench at the wrist, or the sum of many:
    /// along the table, m in the world.
    fn tip_beside(&self, felt: &Vector6<f64>, plate: f64) -> Vector3<f64> {
        let x_wt = self.hand.seen.x_wt;
        let wrist = x_wt * Point3::new(0.0, 0.0, -self.arm.hand.tip);
        let (force, moment) = (felt.fixed_rows::<3>(0), felt.fixed_rows::<3>(3));
        // The moment about the wrist is r × F, and the height of r is known.
        let height = plate - wrist.z;
        let x = (height * force.x - moment.y) / force.z;
        let y = (moment.x + height * force.y) / force.z;
        Vector3::new(wrist.x + x - x_wt.translation.x, wrist.y + y - x_wt.translation.y, 0.0)
    }

    /// The tip of a peg is in the hole at `mouth` (m, in the world) while the hand is beside it: turns the hand about the
    /// hole until the peg is upright.
    fn set_upright(&mut self, peg: &str, mouth: &Vector3<f64>) -> Result<(), SkillError> {
        let off = self.hand.seen.x_wt.translation.vector - mouth;
        let lean = Vector3::new(off.x, off.y, STEM_LENGTH + HEAD_HEIGHT / 2.0);
        let Some(turn) = UnitQuaternion::rotation_between(&lean, &Vector3::z()) else { return Ok(()) };
        self.hand.relax();
        let about = Translation3::from(Vector3::new(mouth.x, mouth.y, mouth.z - FOUND));
        let upright = about * turn * about.inverse() * self.hand.seen.x_wt;
        self.hand.go(&upright, 0.03)?;
        let head = self.hand.seen.x_wt * Point3::new(0.0, 0.0, PEG_HEIGHT - HEAD_HEIGHT / 2.0);
        let x_wp = Pose::translation(mouth.x, mouth.y, head.z - HEAD_HEIGHT / 2.0);
        self.belief.follow(&self.hand);
        self.belief.reckoned(peg, &x_wp);
        if let Some(held) = &mut self.hand.held {
            held.x_tp = self.hand.seen.x_wt.inverse() * x_wp;
        }
        Ok(())
    }

    /// Presses the peg down with growing force and a small circle, until its head is home.
    fn press(&mut self, connection: usize, peg: &str) -> Result<(), SkillError> {
        let begin = self.hand.time();
        let plate = self.mouth(connection)?.z;
        let mut centre = self.hand.seen.x_wt.translation.vector;
        let mut force: f64 = 0.0;
        let (mut ticks, mut felt) = (0u32, Vector6::zeros());
        self.hand.setpoint.translation = self.hand.seen.x_wt.translation;
        while self.hand.time() - begin < PRESS_TIME {
            let elapsed = self.hand.time() - begin;
            force = (force + PRESS_RATE * PERIOD).min(PRESS);
            // Gently while it falls freely; the circle starts when it has not simply dropped home.
            let radius = if elapsed < 1.0 { 0.0 } else { WIGGLE.0 };
            let phase = TAU * WIGGLE.1 * elapsed;
            let here = self.hand.seen.x_wt.translation.vector;
            // The centre drifts to where the hole draws the peg.
            centre.x += (here.x - centre.x) * 0.003;
            centre.y += (here.y - centre.y) * 0.003;
            let lead = force / self.hand.stiffness.z;
            // Never faster than 40 mm/s.
            let lowest = self.hand.setpoint.translation.z - 0.04 * PERIOD;
            let setpoint = &mut self.hand.setpoint.translation;
            setpoint.x = centre.x + radius * phase.cos();
            setpoint.y = centre.y + radius * phase.sin();
            setpoint.z = (here.z - lead).max(lowest);
            self.hand.tick()?;
            if elapsed > PRESS_TIME - PRESS_FELT {
                felt += self.hand.felt();
            }
            ticks += 1;
            if ticks.is_multiple_of(20) {
                self.glance()?;
                if self.belief.pose(peg)?.translation.z - plate < 0.3 * SEATED {
                    break;
                }
            }
        }
        let seconds = self.hand.time() - begin;
        if seconds > PRESS_LONG {
            let proud = self.belief.pose(peg)?.translation.z - plate;
            let beside = self.tip_beside(&felt, plate).dot(&self.across()).abs();
            if proud > STEM_LENGTH / 2.0 && beside > PRESSED_BESIDE {
                self.diagnose(
                    Cause::GripMoved,
                    format!("{peg} presses {:.0} mm beside the hand", beside * 1e3),
                );
            } else {
                self.diagnose(Cause::Jam, format!("{peg} was pressed for {seconds:.1} s"));
            }
        }
        Ok(())
    }
}
