//! Inserting a beam: a male of it into the assembly (square), or males of the assembly into it (cap).

use nalgebra::{Point3, Translation3, UnitQuaternion, Vector3};
use ramp_assembly::JointRef;
use ramp_kit::joint::{self, BODY_WIDTH, FEMALE_HEIGHT};
use ramp_motion::MotionError;
use ramp_robot::Cause;

use crate::Pose;
use crate::fault::{Fault, SkillError};
use crate::feel::Feel;
use crate::transport::Workcell;

/// How high over its way a beam is brought to where its insertion begins, m.
const CLEAR: f64 = 4.0e-3;
/// Speed of an insertion, m/s.
const SPEED: f64 = 0.03;
/// Force against the motion at which a square insertion stops, N.
const SQUARE_LIMIT: f64 = 12.0;
/// Force against the motion at which a cap stops, N: one that finds its males takes 5 N, and more on one of them alone turns
/// it in the hand.
const CAP_LIMIT: f64 = 10.0;
/// Force with which a cap is pressed home over what it was felt past, N.
const CAP_PRESS: f64 = 25.0;
/// An end of a cap this far before its place is blocked, m: a male that stands on a face stands 22 mm before it.
const CAP_BLOCKED: f64 = 4.0e-3;
/// Force on the table at which a beam lies on it, N.
const TABLE_LIMIT: f64 = 8.0;
/// How far the spring is pulled past the goal of a cap, m: it seats each end on its stop wall.
const CAP_OVERDRIVE: f64 = 3.0e-3;
/// How far a cap's leading edge leans down while it passes over an end at an angle, rad: as much as a beam may hang turned
/// in the hand unseen, since that end's corner clears the edge of the plate by no more than its own sag.
const CAP_LEAN: f64 = 1.0 / 180.0 * std::f64::consts::PI;
/// So far before its place a cap's lower plate is under such an end, m: its corner reaches 15 mm past the hole, the plate
/// 13.3 mm. Nose down for longer, it would lift the end, which then falls into the hole of the plate.
const CAP_UNDER: f64 = 24.0e-3;
/// An end is at an angle when its axis is so far from the way in, rad.
const ANGLED: f64 = 10.0 / 180.0 * std::f64::consts::PI;
/// Turn to and fro at the end of a cap, rad.
const CAP_SWEEP: f64 = 2.0 / 180.0 * std::f64::consts::PI;
/// Distance from its place at which an insertion counts as home, m.
pub(crate) const HOME: f64 = 0.8e-3;
/// Force against the motion at which a beam stops that goes through a sleeve that little holds, N.
const LOOSE_LIMIT: f64 = 0.6;
/// How far such a sleeve may be moved, m and rad.
const LOOSE_BUMP: (f64, f64) = (3.0e-3, 1.0 / 180.0 * std::f64::consts::PI);
/// How far friction may move a sleeve that pegs hold, m and rad.
const SLEEVE_BUMP: (f64, f64) = (1.0e-3, 0.2 / 180.0 * std::f64::consts::PI);
/// How well the joints that are to meet must be known before an insertion, m.
const KNOWN: f64 = 0.15e-3;
/// How well the height of a beam that stands is known, m.
const LEVEL: f64 = 0.1e-3;
/// How far an insertion may move the beams that it meets, m and rad.
const BUMP: (f64, f64) = (0.3e-3, 0.06 / 180.0 * std::f64::consts::PI);
/// Standing still for so long while it is felt in, a beam has met more than an edge, s.
const STUCK: f64 = 2.5;
/// How often an insertion that jams is tried again.
const TRIES: usize = 4;
/// Horizontal distance between two holes that a peg still pulls together, m.
pub const PEGGABLE: f64 = 1.6e-3;

impl Workcell<'_, '_> {
    /// Carries the held beam to where its insertion begins, a little higher than its way. One that the hand holds too far
    /// out for that, since there was no room for it elsewhere, is laid down where there is and taken anew.
    ///
    /// # Errors
    /// When there is no way, or the robot stops.
    pub fn approach_beam(&mut self, beam: usize) -> Result<(), SkillError> {
        let name = self.assembly.beams[beam].beam.name.clone();
        self.regrip(&name)?;
        self.level(beam)?;
        let start = self.beside(beam, 1.0, CLEAR)?;
        match self.carry(beam, &start) {
            Err(SkillError::Motion(MotionError::Unreachable(_))) => {
                self.take_anew(beam)?;
                self.carry(beam, &start)?;
            }
            other => other?,
        }
        // A beam that turned in the hand on the way does not go in as it is.
        self.regrip(&name)?;
        if !self.is_aslant() {
            return Ok(());
        }
        self.level(beam)?;
        self.carry(beam, &start)
    }

    /// Carries the held beam through free space to a pose. One that something pushed on the way is looked at before it goes
    /// down: one that turned in the hand would meet the table with an end.
    fn carry(&mut self, beam: usize, x_wb_goal: &Pose) -> Result<(), SkillError> {
        let part = &self.assembly.beams[beam].beam.name;
        for attempt in 1.. {
            let Some(held) = &self.hand.held else { break };
            let x_wt = x_wb_goal * held.x_tp.inverse();
            let mut legs = self.legs_to(&x_wt)?;
            let down = legs.pop();
            for leg in legs {
                self.walk(leg)?;
            }
            if !self.hand.pushed || attempt == TRIES {
                return down.map_or(Ok(()), |down| self.walk(down));
            }
            self.regrip(part)?;
            self.level(beam)?;
        }
        Err(Fault::NotHeld { part: part.clone() }.into())
    }

    /// Inserts the held beam, which is where its insertion begins, and lets go of it.
    ///
    /// # Errors
    /// [`Fault::Jammed`] or [`Fault::Misaligned`] after the last try.
    pub fn assemble(&mut self, beam: usize, cap: bool) -> Result<(), SkillError> {
        let name = self.assembly.beams[beam].beam.name.clone();
        self.hand.relax();
        let mut last = None;
        for attempt in 0..TRIES {
            if attempt > 0 {
                self.note("retry", format!("insert {name}, try {}", attempt + 1));
            }
            match self.insert_once(beam, cap, attempt) {
                Err(SkillError::Fault(fault @ Fault::NotHeld { .. })) => return Err(fault.into()),
                Err(SkillError::Fault(fault)) => last = Some(fault),
                Err(error) => return Err(error),
                Ok(()) => {
                    last = None;
                    break;
                }
            }
            // A sleeve that was carried off is to be put right first.
            if !self.carried_off()?.is_empty() {
                break;
            }
        }
        if let Some(fault) = last {
            return Err(fault.into());
        }
        self.standing.push(beam);
        if self.way(beam)?.depth > 0.0 {
            self.deep.push(beam);
        }
        self.settle(beam)?;
        self.release()?;
        self.reckon_heights(beam);
        Ok(())
    }

    /// How a beam hangs that only one female holds, turned about the joint in it: its other end lies on the table.
    /// `None` for a beam that stands level.
    fn drooping(&self, beam: usize) -> Option<(JointRef, f64)> {
        let placed = &self.assembly.beams[beam].beam;
        if placed.stands_at_assembled_height() {
            return None;
        }
        let sides = self.assembly.connections.iter();
        let sides = sides.filter_map(|connection| self.assembly.sides(connection, beam));
        // A deep beam is short of the joint that it is to be slid into.
        let mut met = sides.filter(|(mine, theirs)| {
            self.standing.contains(&theirs.beam) && !(self.deep.contains(&beam) && self.leads(*mine))
        });
        let (joint, _) = met.next().filter(|_| met.next().is_none())?;
        let pivot = placed.joints[joint.joint].offset;
        // Measured from the table's height to where the axis is at the other end.
        let far = placed.far_end(joint.joint);
        let drop = (FEMALE_HEIGHT - BODY_WIDTH) / 2.0;
        let reach = (far - pivot).abs() + BODY_WIDTH / 2.0;
        Some((joint, (drop / reach).asin() * (far - pivot).signum()))
    }

    /// Where a beam at `x_wb` comes to lie when it droops about the joint that holds it; `None` when it stands level.
    pub(crate) fn drooped(&self, beam: usize, x_wb: &Pose) -> Option<Pose> {
        let (joint, angle) = self.drooping(beam)?;
        let pivot = Translation3::from((x_wb * self.assembly.beams[beam].beam.p_b_hole(joint.joint)).coords);
        let along = x_wb.rotation * Vector3::x();
        let level = UnitQuaternion::rotation_between(&along, &Vector3::new(along.x, along.y, 0.0))?;
        let turn = UnitQuaternion::from_scaled_axis(Vector3::z().cross(&along).normalize() * angle);
        Some(pivot * turn * level * pivot.inverse() * x_wb)
    }

    /// Lets the free end of a held beam down on the table before the fingers open: one that fell would hang on them,
    /// and follow them.
    pub(crate) fn settle(&mut self, beam: usize) -> Result<(), SkillError> {
        let name = self.assembly.beams[beam].beam.name.clone();
        let x_wb = self.belief.pose(&name)?;
        let Some(drooped) = self.drooped(beam, &x_wb) else { return Ok(()) };
        let down = self.hand.corrected(&x_wb, &drooped);
        self.hand.zero()?;
        self.hand.drive(&down, 0.02, |hand| -hand.force().z > TABLE_LIMIT)?;
        self.hand.wait(0.1)?;
        Ok(())
    }

    /// Does a joint lead the way out of a beam that stands too deep?
    fn leads(&self, joint: JointRef) -> bool {
        let beam = &self.assembly.beams[joint.beam].beam;
        (beam.joints[joint.joint].offset - self.free_end(joint.beam)).abs() < beam.span() / 2.0
    }

    /// Lays the held beam, which is over its place, on the table, and lets go of it.
    ///
    /// # Errors
    /// [`Fault::NotHeld`], or what stopped the motion.
    pub fn lay_down(&mut self, beam: usize) -> Result<(), SkillError> {
        let name = self.assembly.beams[beam].beam.name.clone();
        self.hand.relax();
        self.regrip(&name)?;
        let goal = self.target(beam)?;
        self.place(&name, &(Translation3::new(0.0, 0.0, CLEAR) * goal))?;
        self.hand.zero()?;
        let down = self.hand.corrected(&self.belief.pose(&name)?, &goal);
        self.hand.drive(&down, SPEED, |hand| -hand.force().z > TABLE_LIMIT)?;
        self.standing.push(beam);
        self.release()?;
        self.reckon_heights(beam);
        Ok(())
    }

    /// What is known of the heights of a beam that has been let go of in the assembly: on females or feet it stands level
    /// on the table; otherwise its males hang in their females, as low as the clearance lets them, and what only one
    /// female holds lies on the table with its other end.
    pub fn reckon_heights(&mut self, beam: usize) {
        let placed = &self.assembly.beams[beam];
        let nominal = self.kit.x_wa() * placed.x_ab;
        let stands = placed.beam.stands_at_assembled_height();
        let joints: Vec<usize> = if stands {
            vec![0, placed.beam.joints.len() - 1]
        } else {
            let sides = self.assembly.connections.iter();
            let sides = sides.filter_map(|connection| self.assembly.sides(connection, beam));
            let short = |mine: JointRef| self.deep.contains(&beam) && self.leads(mine);
            let met = sides.filter(|(mine, theirs)| self.standing.contains(&theirs.beam) && !short(*mine));
            met.map(|(mine, _)| mine.joint).collect()
        };
        let hang = if stands { 0.0 } else { joint::CLEARANCE };
        // A deep beam lies in its female with what is as far behind its hole.
        let depth = self.ways.get(&beam).filter(|_| self.deep.contains(&beam)).map_or(0.0, |way| way.depth);
        let behind = if self.free_end(beam) > 0.0 { depth } else { -depth };
        for joint in joints {
            let p = placed.beam.p_b_hole(joint);
            let p = Point3::new(p.x + behind, p.y, p.z);
            self.belief.stands_at(&placed.beam.name, &p, (nominal * p).z - hang, LEVEL);
        }
        if let (Some((held, _)), Some(drooped)) = (self.drooping(beam), self.drooped(beam, &nominal)) {
            let p = Point3::new(placed.beam.far_end(held.joint), 0.0, 0.0);
            self.belief.stands_at(&placed.beam.name, &p, (drooped * p).z, LEVEL);
        }
    }

    fn insert_once(&mut self, beam: usize, cap: bool, attempt: usize) -> Result<(), SkillError> {
        let name = self.assembly.beams[beam].beam.name.clone();
        self.see(&self.meeting(beam), KNOWN)?;
        if attempt == 0 {
            self.diagnose_standing();
        }
        self.regrip(&name)?;
        let place = self.target(beam)?;
        let direction = self.way_in(beam, &place)?;
        let mut goal = Translation3::from(direction * self.way(beam)?.depth) * place;
        // A beam that stands on the table is pressed on it a little when it caps, and slides over it otherwise.
        let stands = self.assembly.beams[beam].beam.stands_at_assembled_height();
        let height: f64 = if cap {
            -2.0e-3
        } else if stands {
            0.1e-3
        } else {
            0.0
        };
        self.place(&name, &self.beside(beam, 1.0, if attempt == 0 { CLEAR } else { 0.0 })?)?;
        self.place(&name, &self.beside(beam, 1.0, height.max(0.1e-3))?)?;
        self.hand.zero()?;
        // A loose beam turns about a single peg, too.
        let loose = self.loose_sleeves(beam, 1);
        let limit = if cap {
            CAP_LIMIT
        } else if loose.is_empty() {
            SQUARE_LIMIT
        } else {
            LOOSE_LIMIT
        };
        let overdrive = if cap { CAP_OVERDRIVE } else { 0.0 };
        self.glance()?;
        let mut target = self.hand.corrected(&self.belief.pose(&name)?, &goal);
        target.translation.vector += direction * overdrive;
        target.translation.z += height;
        if cap && self.meets_angled(beam, &direction) {
            self.pass_under(beam, &goal, height)?;
        }
        let stopped = self.hand.drive(&target, SPEED, |hand| hand.force().dot(&direction) > limit)?;
        let force = self.hand.force().dot(&direction);
        self.hand.wait(0.15)?;
        // What meets an edge carries the sleeve along: it may turn about two pegs that are near each other.
        let sleeves = self.sleeves(beam).map(|sleeve| self.assembly.beams[sleeve.beam].beam.name.clone());
        let sleeves: Vec<String> = sleeves.collect();
        for (met, _) in self.meeting(beam) {
            let carried = loose.contains(&met) || (stopped && sleeves.contains(&met));
            let bump = match sleeves.contains(&met) {
                _ if carried => LOOSE_BUMP,
                true => SLEEVE_BUMP,
                false => BUMP,
            };
            self.belief.bumped(&met, bump);
        }
        self.glance()?;
        if cap {
            return self.finish_cap(beam, &(Translation3::new(0.0, 0.0, height) * goal), force);
        }
        if stopped {
            let mut remaining = self.remaining(&name, &goal, &direction)?;
            let met = format!("{name} meets {force:.0} N {:.1} mm before its place", remaining * 1e3);
            let mut stuck = remaining > HOME;
            if remaining > HOME {
                let sleeve = self.sleeves(beam).next();
                if let Some(sleeve) = sleeve {
                    goal.translation.z += self.touch_floor(&name, sleeve, &direction)?;
                }
                let stood = self.feel_in(&name, &goal, &direction, Feel::into(!loose.is_empty()))?;
                remaining = self.remaining(&name, &goal, &direction)?;
                // Edges are met, and felt past; what holds a beam for longer is in its way.
                stuck = stood > STUCK || remaining > HOME;
            }
            if stuck {
                self.diagnose(Cause::Jam, met);
            }
            if remaining > HOME {
                return self.back_out(beam, &direction, remaining, force);
            }
        }
        self.seat(beam, &goal, height, limit, !loose.is_empty())
    }

    /// Does a beam take in ends that come at an angle to its way in?
    fn meets_angled(&self, beam: usize, direction: &Vector3<f64>) -> bool {
        self.assembly.connections.iter().filter_map(|connection| self.assembly.sides(connection, beam)).any(
            |(_, theirs)| {
                let other = &self.assembly.beams[theirs.beam];
                let along = self.kit.x_wa().rotation * other.x_ab.rotation * Vector3::x();
                let angle = along.dot(direction).abs().min(1.0).acos();
                self.meets(theirs, beam) && other.beam.joints[theirs.joint].kind.is_end() && angle > ANGLED
            },
        )
    }

    /// Brings a cap, from where its insertion begins, with its lower plate under the ends that come at an angle: pressed on
    /// the table first, and with its nose down until they are past the plate's edge. Stops where it is blocked.
    fn pass_under(&mut self, beam: usize, goal: &Pose, height: f64) -> Result<(), SkillError> {
        let name = self.assembly.beams[beam].beam.name.clone();
        let direction = self.way_in(beam, goal)?;
        let lean = UnitQuaternion::from_scaled_axis(Vector3::z().cross(&direction) * CAP_LEAN);
        let leaning = Pose::from_parts(goal.translation, lean * goal.rotation);
        let x_wp = self.belief.pose(&name)?;
        let way = [self.remaining(&name, goal, &direction)?, CAP_UNDER].map(|before| {
            let mut target = self.hand.corrected(&x_wp, &leaning);
            target.translation.vector += Vector3::z() * height - direction * before;
            target
        });
        for target in way {
            if self.hand.drive(&target, SPEED, |hand| hand.force().dot(&direction) > CAP_LIMIT)? {
                break;
            }
        }
        Ok(())
    }

    /// Ends a cap that has been pushed as far as it went, to `goal` if all is well: an end that is blocked is felt in, and
    /// then both ends are swept home.
    fn finish_cap(&mut self, beam: usize, goal: &Pose, force: f64) -> Result<(), SkillError> {
        let name = self.assembly.beams[beam].beam.name.clone();
        let direction = self.way_in(beam, goal)?;
        let mut remaining = self.remaining(&name, goal, &direction)?;
        if remaining > CAP_BLOCKED {
            let met = format!("{name} meets {force:.0} N {:.1} mm before its place", remaining * 1e3);
            let stood = self.feel_in(&name, goal, &direction, &Feel::CAP)?;
            let mut home = self.hand.corrected(&self.belief.pose(&name)?, goal);
            home.translation.vector += direction * CAP_OVERDRIVE;
            self.hand.drive(&home, SPEED, |hand| hand.force().dot(&direction) > CAP_PRESS)?;
            self.hand.wait(0.15)?;
            self.glance()?;
            remaining = self.remaining(&name, goal, &direction)?;
            if stood > STUCK || remaining > CAP_BLOCKED {
                self.diagnose(Cause::Jam, met);
            }
            if remaining > CAP_BLOCKED {
                return self.back_out(beam, &direction, remaining, force);
            }
        }
        self.sweep()?;
        self.belief.update(&mut self.hand)?;
        Ok(())
    }

    /// Backs a beam that jams out to where its insertion began, free of the joint. Always an error, the jam.
    fn back_out(
        &mut self,
        beam: usize,
        direction: &Vector3<f64>,
        remaining: f64,
        force: f64,
    ) -> Result<(), SkillError> {
        let part = self.assembly.beams[beam].beam.name.clone();
        let jam = Fault::Jammed { part, remaining_mm: remaining * 1e3, force };
        self.note("fault", jam.to_string());
        let mut back = self.hand.setpoint;
        back.translation = self.hand.seen.x_wt.translation;
        let way = self.way(beam)?;
        back.translation.vector -= direction * (way.distance + way.depth - remaining).max(0.0);
        self.hand.go(&back, 0.05)?;
        Err(jam.into())
    }

    /// Brings a held beam that is in its joints all the way to `goal`, as sight says: what remains is mostly a fraction
    /// of a millimetre, and otherwise felt in.
    fn seat(
        &mut self,
        beam: usize,
        goal: &Pose,
        height: f64,
        limit: f64,
        loose: bool,
    ) -> Result<(), SkillError> {
        let name = self.assembly.beams[beam].beam.name.clone();
        let direction = self.way_in(beam, goal)?;
        for _ in 0..TRIES {
            let x_wp = self.belief.pose(&name)?;
            let fine = self.hand.corrected(&x_wp, &(Translation3::new(0.0, 0.0, height) * goal));
            self.hand.drive(&fine, 0.01, |hand| hand.force().norm() > limit)?;
            self.hand.wait(0.15)?;
            self.see(&[self.middle(&name)], KNOWN)?;
            let remaining = self.remaining(&name, goal, &direction)?;
            if remaining < HOME {
                return Ok(());
            }
            self.note("retry", format!("insert {name}, {:.1} mm short", remaining * 1e3));
            self.feel_in(&name, goal, &direction, Feel::into(loose))?;
        }
        let (remaining, force) =
            (self.remaining(&name, goal, &direction)?, self.hand.force().dot(&direction));
        if remaining < 2.0 * HOME {
            return Ok(());
        }
        Err(Fault::Jammed { part: name, remaining_mm: remaining * 1e3, force }.into())
    }

    /// Grips a beam that stands short of its place on its way in, and takes it there.
    ///
    /// # Errors
    /// [`Fault::Jammed`], or what stopped the motion.
    pub fn reinsert(&mut self, beam: usize, s: f64) -> Result<(), SkillError> {
        let name = self.assembly.beams[beam].beam.name.clone();
        self.seize_standing(beam, s)?;
        let goal = self.target(beam)?;
        let direction = self.way_in(beam, &goal)?;
        let loose = !self.loose_sleeves(beam, 1).is_empty();
        self.hand.zero()?;
        self.feel_in(&name, &goal, &direction, Feel::into(loose))?;
        let limit = if loose { LOOSE_LIMIT } else { SQUARE_LIMIT };
        let seated = self.seat(beam, &goal, 0.0, limit, loose);
        self.settle(beam)?;
        self.release()?;
        self.reckon_heights(beam);
        seated
    }

    /// How far a beam still is from its place along `direction`, m: that of its joints which is furthest from it.
    pub(crate) fn remaining(
        &self,
        part: &str,
        goal: &Pose,
        direction: &Vector3<f64>,
    ) -> Result<f64, SkillError> {
        let x_wp = self.belief.pose(part)?;
        let short = |p: Point3<f64>| (goal * p - x_wp * p).dot(direction);
        let joints = self.kit.beam(part).map_or(&[][..], |beam| &beam.joints);
        let joints = joints.iter().map(|joint| Point3::new(joint.offset, 0.0, 0.0));
        Ok(joints.map(short).fold(short(Point3::origin()), f64::max))
    }

    /// Brings the held part to a pose in free space, looking again on the way.
    fn place(&mut self, part: &str, x_wp_goal: &Pose) -> Result<(), SkillError> {
        for _ in 0..3 {
            self.glance()?;
            let x_wp = self.belief.pose(part)?;
            let shift = (x_wp.translation.vector - x_wp_goal.translation.vector).norm();
            if shift < 0.1e-3 && x_wp.rotation.angle_to(&x_wp_goal.rotation) < 0.001 {
                break;
            }
            self.hand.correct(&x_wp, x_wp_goal, 0.05)?;
            self.hand.wait(0.1)?;
        }
        Ok(())
    }

    /// Turns a capped beam to and fro about its grasp while it is pressed on, so that both ends find their walls.
    fn sweep(&mut self) -> Result<(), SkillError> {
        let centre = self.hand.setpoint;
        for angle in [CAP_SWEEP, -CAP_SWEEP, 0.0] {
            let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), angle);
            let target = Pose::from_parts(centre.translation, turn * centre.rotation);
            self.hand.drive(&target, 0.03, |hand| hand.force().norm() > 1.5 * CAP_PRESS)?;
            self.hand.wait(0.1)?;
        }
        Ok(())
    }
}
