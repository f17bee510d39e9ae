//! Bringing a beam that already stands in the assembly to its nominal place.
//!
//! A beam that a single peg holds swings by 4° to 5°: its free end must be put where the next beam expects it,
//! since a cap that meets a tip beside its opening jams whatever is done to it afterwards.

use nalgebra::{Point3, Translation3, UnitQuaternion, Vector3};
use ramp_assembly::JointRef;

use crate::Pose;
use crate::fault::{Fault, SkillError};
use crate::grasp::{self, BEAM_OPEN, BEAM_WIDTH, beam_grasp};
use crate::insert::PEGGABLE;
use crate::transport::Workcell;

/// A beam this near to its place is left alone, m.
const GOOD: f64 = 0.3e-3;
/// How well its ends must be known to tell, m.
const KNOWN: f64 = 0.2e-3;
/// Speed, m/s.
const SPEED: f64 = 0.03;
/// Force at which a push stops, N.
const LIMIT: f64 = 20.0;
/// A hole this near to a peg tells nothing of how its beam is turned, m.
const SHORT: f64 = 0.05;
/// A beam that lies loose may be this far off its place, m: another one goes through it all the same.
const CARRIED_OFF: f64 = 4.0e-3;
/// A beam that stands this far short of its place is inserted further, m.
const SHORT_OF: f64 = 3.0e-3;
/// How far a push may move the beams that are joined with the one that is pushed, m and rad.
const DRAGGED: (f64, f64) = (1.0e-3, 0.3 / 180.0 * std::f64::consts::PI);
/// Tries.
const TRIES: usize = 3;
/// Motions of one push at most: friction on the table stops each of them a little short.
const MOTIONS: usize = 6;

impl Workcell<'_, '_> {
    /// Puts a standing beam right, holding it by `link`, and lets go.
    ///
    /// # Errors
    /// [`Fault::Misaligned`] when it will not stay, or what stopped the motion.
    pub fn push(&mut self, beam: usize, link: &str) -> Result<(), SkillError> {
        let placed = &self.assembly.beams[beam];
        let name = placed.beam.name.clone();
        let Some(link) = placed.beam.links.iter().find(|candidate| candidate.name == link) else {
            return Err(Fault::NoGrasp { part: name }.into());
        };
        let far = self.far_end(beam);
        for attempt in 0..TRIES {
            self.see_ends(beam)?;
            if attempt == 0 {
                self.diagnose_standing();
            }
            let (goal, off) = self.straightened(beam)?;
            let near_off = self.near_off(beam, &self.belief.pose(&name)?, &goal);
            if off < GOOD && near_off < PEGGABLE {
                return Ok(());
            }
            if attempt > 0 {
                let off = if off < GOOD { near_off } else { off };
                self.note("retry", format!("push {name}, {:.2} mm off", off * 1e3));
            }
            let s = grasp::point_on(link, far);
            if self.anchor(beam).is_none() && self.short(beam)? > SHORT_OF {
                self.reinsert(beam, s)?;
                continue;
            }
            self.seize_standing(beam, s)?;
            // It stands on the table and in its joint: the hand does not carry it.
            if let Some(held) = &mut self.hand.held {
                held.mass = 0.0;
            }
            self.hand.zero()?;
            for motion in 0..MOTIONS {
                self.glance()?;
                let x_wb = self.belief.pose(&name)?;
                let there = self.off(beam, &x_wb, &goal) < 0.5 * GOOD;
                if motion > 1 && there && self.near_off(beam, &x_wb, &goal) < PEGGABLE {
                    break;
                }
                let target = self.hand.corrected(&x_wb, &goal);
                self.hand.drive(&target, SPEED, |hand| hand.force().norm() > LIMIT)?;
                self.hand.wait(0.1)?;
            }
            self.settle(beam)?;
            self.release()?;
            self.drag(beam);
        }
        self.see_ends(beam)?;
        let (_, off) = self.straightened(beam)?;
        // What comes next, a peg or the chamfers of a cap, takes this much.
        if off < PEGGABLE {
            return Ok(());
        }
        Err(Fault::Misaligned { connection: name, offset_mm: off * 1e3 }.into())
    }

    /// A beam was pushed: what it is joined with may have come along.
    fn drag(&mut self, beam: usize) {
        let sides = self.assembly.connections.iter();
        let joined = sides.filter_map(|connection| Some(self.assembly.sides(connection, beam)?.1.beam));
        let joined: Vec<usize> = joined.filter(|other| self.standing.contains(other)).collect();
        for other in joined {
            self.belief.bumped(&self.assembly.beams[other].beam.name, DRAGGED);
        }
    }

    /// Grips a beam that stands, where it stands, at `s` metres from its j1 hole.
    ///
    /// # Errors
    /// As [`Workcell::seize`].
    pub fn seize_standing(&mut self, beam: usize, s: f64) -> Result<(), SkillError> {
        let name = self.assembly.beams[beam].beam.name.clone();
        let x_wb = self.belief.pose(&name)?;
        let q = self.hand.joints();
        let senses = [false, true].map(|reverse| {
            let x_wt = beam_grasp(&x_wb, s, reverse);
            (x_wt, self.reach(&x_wt, &q))
        });
        let x_wt = self.choose(&senses).ok_or_else(|| Fault::NoGrasp { part: name.clone() })?;
        self.seize(&name, &x_wt, BEAM_OPEN, BEAM_WIDTH)
    }

    /// How far a standing beam is short of its place on its way in, m.
    fn short(&self, beam: usize) -> Result<f64, SkillError> {
        if !self.ways.contains_key(&beam) {
            return Ok(0.0);
        }
        let goal = self.target(beam)?;
        let x_wb = self.belief.pose(&self.assembly.beams[beam].beam.name)?;
        Ok((goal.translation.vector - x_wb.translation.vector).dot(&self.way_in(beam, &goal)?))
    }

    /// As [`Workcell::push`], by the reachable link that is nearest to the beam's free end.
    ///
    /// # Errors
    /// As [`Workcell::push`].
    pub fn push_by_nearest_link(&mut self, beam: usize) -> Result<(), SkillError> {
        let placed = &self.assembly.beams[beam].beam;
        let (far, name) = (self.far_end(beam), placed.name.clone());
        let x_wb = self.belief.pose(&name)?;
        let q = self.hand.joints();
        let mut links: Vec<_> = placed.links.iter().collect();
        let distance = |link: &ramp_kit::Link| (grasp::point_on(link, far) - far).abs();
        links.sort_by(|a, b| distance(a).total_cmp(&distance(b)));
        let link = links
            .into_iter()
            .find(|link| {
                let s = grasp::point_on(link, far);
                [false, true].into_iter().any(|reverse| self.reach(&beam_grasp(&x_wb, s, reverse), &q) > 0.0)
            })
            .map(|link| link.name.clone())
            .ok_or(Fault::NoGrasp { part: name })?;
        self.push(beam, &link)
    }

    /// The beams that one peg holds and that have swung from their place, by index.
    ///
    /// # Errors
    /// [`Fault::Unseen`].
    pub fn swung(&self) -> Result<Vec<usize>, SkillError> {
        let mut swung = Vec::new();
        for beam in self.standing.iter().copied().filter(|beam| *beam != self.assembly.base) {
            if self.anchor(beam).is_some() && self.straightened(beam)?.1 > 3.0 * GOOD {
                swung.push(beam);
            }
        }
        Ok(swung)
    }

    /// The beams that lie in the assembly, held by no peg, and are off their place, by index.
    ///
    /// # Errors
    /// [`Fault::Unseen`].
    pub fn carried_off(&self) -> Result<Vec<usize>, SkillError> {
        let mut off = Vec::new();
        for beam in self.standing.iter().copied().filter(|beam| *beam != self.assembly.base) {
            if self.lies(beam) && self.anchor(beam).is_none() && self.straightened(beam)?.1 > CARRIED_OFF {
                off.push(beam);
            }
        }
        Ok(off)
    }

    /// Looks until it is known where the pinned joint and the far end of a beam are.
    fn see_ends(&mut self, beam: usize) -> Result<(), SkillError> {
        let placed = &self.assembly.beams[beam].beam;
        let far = Point3::new(self.far_end(beam), 0.0, 0.0);
        let mut points = vec![(placed.name.clone(), far)];
        points.extend(self.anchor(beam).map(|joint| self.hole(joint)));
        self.see(&points, KNOWN)
    }

    /// The joint of a beam that a peg already pins, if any.
    fn anchor(&self, beam: usize) -> Option<JointRef> {
        self.pinned.iter().find_map(|(index, _)| {
            self.assembly.sides(&self.assembly.connections[*index], beam).map(|(mine, _)| mine)
        })
    }

    /// The joint of a pinned beam that is furthest from its peg among those that meet a standing beam and have no peg
    /// yet, and what it meets.
    fn open_joint(&self, beam: usize, anchor: JointRef) -> Option<(JointRef, JointRef)> {
        let offset = |joint: JointRef| self.assembly.beams[beam].beam.joints[joint.joint].offset;
        let lever = |joint: JointRef| (offset(joint) - offset(anchor)).abs();
        // One that nothing holds would only be dragged along.
        let held = |theirs: JointRef| theirs.beam == self.assembly.base || self.anchor(theirs.beam).is_some();
        let open = self.assembly.connections.iter().enumerate().filter_map(|(index, connection)| {
            let (mine, theirs) = self.assembly.sides(connection, beam)?;
            let pinned = self.pinned.iter().any(|(other, _)| *other == index);
            (!pinned && held(theirs) && self.meets(theirs, beam) && lever(mine) > SHORT)
                .then_some((mine, theirs))
        });
        open.max_by(|(a, _), (b, _)| lever(*a).total_cmp(&lever(*b)))
    }

    /// How far along the table the far end of a beam at `x_wb` is from where it is at `goal`, m.
    fn off(&self, beam: usize, x_wb: &Pose, goal: &Pose) -> f64 {
        distance_at(self.far_end(beam), x_wb, goal)
    }

    /// The same for its other end: a beam that no peg holds can be right at one end, and where a peg would not go in at the
    /// other.
    fn near_off(&self, beam: usize, x_wb: &Pose, goal: &Pose) -> f64 {
        distance_at(self.assembly.beams[beam].beam.span() - self.far_end(beam), x_wb, goal)
    }

    /// Distance from j1, m, of the end of a beam that is further from its pinned joint.
    fn far_end(&self, beam: usize) -> f64 {
        let placed = &self.assembly.beams[beam].beam;
        placed.far_end(self.anchor(beam).map_or(0, |joint| joint.joint))
    }

    /// Where a standing beam should be, in the world, and how far its far end is from there now, m. A pinned beam
    /// is turned about its peg so that the hole of its next peg comes to the other beam's, or else its far end to its
    /// nominal place; any other goes to its target.
    fn straightened(&self, beam: usize) -> Result<(Pose, f64), SkillError> {
        let placed = &self.assembly.beams[beam];
        let x_wb = self.belief.pose(&placed.beam.name)?;
        let far = Point3::new(self.far_end(beam), 0.0, 0.0);
        let Some(anchor) = self.anchor(beam) else {
            let mut goal = self.target(beam)?;
            goal.translation.z = x_wb.translation.z;
            return Ok((goal, self.off(beam, &x_wb, &goal)));
        };
        let pivot = x_wb * placed.beam.p_b_hole(anchor.joint);
        // Where it is to be pinned next to a beam that stands, that hole is what counts; else its far end.
        let open = self.open_joint(beam, anchor);
        let (now, wanted) = match open {
            Some((mine, theirs)) => {
                (x_wb * placed.beam.p_b_hole(mine.joint), self.belief.hole(self.assembly, theirs)?)
            }
            None => (x_wb * far, self.kit.x_wa() * placed.x_ab * far),
        };
        let (now, wanted) = (now.xy() - pivot.xy(), wanted.xy() - pivot.xy());
        let angle = now.perp(&wanted).atan2(now.dot(&wanted));
        let about = Translation3::from(pivot.coords);
        let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), angle);
        let goal = about * turn * about.inverse() * x_wb;
        Ok((goal, angle.abs() * now.norm()))
    }
}

/// Distance along the table between where a point on a beam's axis, `x` metres from its j1 hole, is with the beam at one
/// pose and at the other, m.
fn distance_at(x: f64, x_wb: &Pose, other: &Pose) -> f64 {
    let p = Point3::new(x, 0.0, 0.0);
    ((x_wb * p).xy() - (other * p).xy()).norm()
}
