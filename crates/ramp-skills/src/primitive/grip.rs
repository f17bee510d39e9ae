//! Grips a part where it stands, and checks that it is still in the hand.

use nalgebra::{Point3, Vector3};
use ramp_robot::{Cause, GripperCommand, Retry};

use crate::Pose;
use crate::cell::Workcell;
use crate::fault::{Fault, SkillError};
use crate::grasp::{
    self, BEAM_WIDTH, BLOCKS_BESIDE, BeamGrasp, Grasp, PEG_WIDTH, RIBS_BESIDE, beam_grasp, beam_grasps,
    peg_grasps, senses,
};
use crate::hand::Held;
use crate::parameters::Parameters;
use crate::rehearsal::outline::{InHand, Motion, Outline, Stage};
use crate::rehearsal::scene::Scene;

impl Workcell<'_, '_> {
    /// The grasp of a part where it stands now, a beam by a link.
    ///
    /// # Errors
    /// [`Fault::NoGrasp`] when no grasp is reachable; [`Fault::Unseen`].
    pub fn choose_grasp(&mut self, part: &str, link: Option<&str>) -> Result<Grasp, SkillError> {
        let x_wp = self.belief.parts.pose(part)?;
        let no_grasp = || Fault::NoGrasp { part: part.to_string() };
        let grip = &self.parameters.grip;
        let Some(beam) = self.kit.beam(part) else {
            let grasps = peg_grasps(&x_wp, grip).map(|grasp| (grasp, self.way(&[grasp.x_wt])));
            return Ok(self.choose(&grasps).ok_or_else(no_grasp)?);
        };
        let link =
            link.and_then(|name| beam.links.iter().find(|link| link.name == name)).ok_or_else(no_grasp)?;
        // The hand turns with the beam: the worse of start and goal counts.
        let index = self.assembly.beam_index(part);
        let goal = match index.filter(|index| self.belief.standing.contains(index)) {
            Some(_) => self.sheet_place(part),
            None => index.map(|index| self.belief.target(index)).transpose()?,
        };
        let has_room = |grasp: &Grasp| self.has_room(&grasp.x_wt, grasp.open, part);
        if let Some(known) = self.grasps.get(part) {
            let grasp = Grasp::of_beam(&x_wp, *known, grip);
            let [from, to] = grasp::span(link, grip);
            let on_link = (from..=to).contains(&known.s);
            if on_link && self.reach(&grasp.x_wt, &self.hand.joints()) > 0.0 && has_room(&grasp) {
                return Ok(grasp);
            }
        }
        let way = |stops: &[Pose]| self.way(stops);
        let mut nearest = None;
        for senses in beam_grasps(beam, link, &x_wp, goal.as_ref(), grip, &self.parameters.travel, way) {
            let Some(grasp) = self.choose(&senses) else { continue };
            if has_room(&grasp) {
                return Ok(grasp);
            }
            nearest = nearest.or(Some(grasp));
        }
        // With no room anywhere the motion planner names the obstacle.
        Ok(nearest.ok_or_else(no_grasp)?)
    }

    /// Grips a part where it stands: the hand comes from above, closes and checks that it holds something of
    /// the right width.
    ///
    /// # Errors
    /// [`Fault::NotHeld`], or the fault that stopped the motion.
    pub fn grasp(&mut self, part: &str, grasp: &Grasp) -> Result<(), SkillError> {
        let Grasp { mut x_wt, open, width, .. } = *grasp;
        let is_beam = self.kit.beam(part).is_some();
        x_wt.translation.z += self.height_off.filter(|_| is_beam).unwrap_or_default();
        if let Some(grasp) = grasp.beam {
            self.gripped.insert(part.to_string(), grasp);
        }
        self.hand.gripper.width = open;
        let closing = self.closing(width);
        self.descend(&x_wt, part, closing)?;
        if self.hand.gripper != closing {
            self.hand.wait_for_gripper()?;
        }
        self.hand.relax();
        self.close_on(part, &Grasp { x_wt, ..*grasp })
    }

    /// Closes the fingers on a part, around which they are ([`Workcell::grasp`]).
    ///
    /// # Errors
    /// As [`Workcell::grasp`].
    pub fn close_on(&mut self, part: &str, grasp: &Grasp) -> Result<(), SkillError> {
        let Grasp { x_wt, open, width, .. } = *grasp;
        let is_beam = self.kit.beam(part).is_some();
        let closing = self.closing(width);
        let mut searched = false;
        for attempt in 0..self.parameters.grip.closings {
            self.hand.grip(closing.width, closing.force)?;
            let short = self.hand.seen.width - width;
            if short < self.parameters.grip.short {
                break;
            }
            // Fingers that close on the same again: they are too high or too low for the slots.
            let on = |width: &f64| (self.hand.seen.width - width).abs() < self.parameters.feel.beside;
            let beside = [RIBS_BESIDE, BLOCKS_BESIDE].iter().any(on);
            let feel = &self.parameters.feel;
            let raise = if on(&BLOCKS_BESIDE) { feel.raise_blocks } else { feel.raise };
            if attempt > 0 && is_beam && beside && self.find_slots(open, raise)? {
                searched = true;
                continue;
            }
            let wider = self.hand.seen.width > RIBS_BESIDE + self.parameters.grip.width_tolerance
                && (attempt > 0 || !beside);
            if let Some(nearer) = self.nearer_to_the_middle(part, grasp).filter(|_| wider) {
                let because = format!("the fingers stop {:.1} mm before {part}, on a joint", short * 1e3);
                self.record(Retry::new("grasp", part).because(because));
                self.let_go_wide(open)?;
                self.retreat()?;
                return self.grasp(part, &nearer);
            }
            let evidence = format!("the fingers stop {:.1} mm before {part}", short * 1e3);
            self.diagnose(Cause::GripWeak, part, evidence);
            if attempt + 1 < self.parameters.grip.closings {
                self.let_go_wide(open)?;
            }
        }
        if (self.hand.seen.width - width).abs() > self.parameters.grip.width_tolerance {
            if self.hand.seen.width < width {
                self.diagnose(Cause::PartLost, part, format!("{part} is not between the fingers"));
            }
            return Err(Fault::NotHeld { part: part.to_string() }.into());
        }
        if is_beam {
            let known = self.height_off.unwrap_or_default();
            // Within the room of the ribs in the slots, nothing is learned about the height.
            let more = self.hand.seen.x_wt.translation.z - x_wt.translation.z;
            let is_arms = (known + more).abs() < self.parameters.feel.learned;
            self.height_off = Some(if searched && is_arms { known + more } else { known });
        }
        self.belief.parts.follow(&self.hand);
        self.belief.parts.gripped(part, !is_beam);
        self.belief.parts.update(&mut self.hand)?;
        let x_wp = self.belief.parts.pose(part)?;
        let (mass, p_centre) = match self.kit.beam(part) {
            Some(beam) => (beam.mass(), grasp::beam_centre(beam)),
            None => (grasp::PEG_MASS, grasp::peg_centre()),
        };
        let x_tp = self.hand.seen.x_wt.inverse() * x_wp;
        (self.hand.pushed, self.hand.slipped) = (false, false);
        self.hand.held = Some(Held {
            part: part.to_string(),
            x_tp,
            x_wp_back: x_wp,
            returns_to_sheet: false,
            mass,
            p_centre,
        });
        Ok(())
    }

    /// The command that closes the fingers on a part of this width, m.
    fn closing(&self, width: f64) -> GripperCommand {
        GripperCommand { width: width - self.parameters.grip.squeeze, force: self.parameters.grip.force }
    }

    /// The grasp a step nearer to the middle of its link; `None` where it is there already.
    fn nearer_to_the_middle(&self, part: &str, grasp: &Grasp) -> Option<Grasp> {
        let (known, step) = (grasp.beam?, self.parameters.grip.step);
        let links = &self.kit.beam(part)?.links;
        let middles = links.iter().map(|link| (link.grasp[0] + link.grasp[1]) / 2.0);
        let off = middles.map(|middle| middle - known.s).min_by(|a, b| a.abs().total_cmp(&b.abs()))?;
        let s = known.s + off.clamp(-step, step);
        let x_wp = self.belief.parts.pose(part).ok()?;
        let nearer = Grasp::of_beam(&x_wp, BeamGrasp { s, ..known }, &self.parameters.grip);
        (off.abs() > 0.1 * step).then_some(nearer)
    }

    /// Opens the fingers to `open`, m, and off whatever they have closed on: a joint is wider than the
    /// fingers open for a beam.
    fn let_go_wide(&mut self, open: f64) -> Result<(), SkillError> {
        let off = self.hand.seen.width + self.parameters.grip.off;
        self.hand.grip(open.max(off), self.parameters.grip.opening_force)
    }

    /// Fingers that have closed beside the slots of a beam, because the arm is higher or lower than it knows,
    /// with their ribs or the blocks over them, come down along its sides from `raise` (m) above, loosely
    /// closed, until their ribs fall into the slots. Returns true if they did.
    fn find_slots(&mut self, open: f64, raise: f64) -> Result<bool, SkillError> {
        let feel = self.parameters.feel.clone();
        self.let_go_wide(open)?;
        let mut up = self.hand.setpoint;
        up.translation.z += raise;
        self.hand.go(&up, feel.speed)?;
        self.hand.grip(BEAM_WIDTH - self.parameters.grip.squeeze, feel.force)?;
        self.hand.zero()?;
        let inside = BEAM_WIDTH + self.parameters.release.in_slot;
        let mut down = self.hand.setpoint;
        down.translation.z -= feel.depth;
        self.hand
            .drive(&down, feel.speed, |hand| hand.seen.width < inside || -hand.force().z > feel.stands)?;
        self.hand.relax();
        let found = self.hand.seen.width < inside;
        if found {
            let mut middle = self.hand.setpoint;
            middle.translation.z -= self.parameters.release.slot_room;
            self.hand.go(&middle, feel.speed)?;
        }
        Ok(found)
    }

    /// Grips a beam that stands, where it stands, at `s` metres from its j1 hole.
    ///
    /// # Errors
    /// As [`Workcell::grasp`].
    pub fn grasp_standing(&mut self, beam: usize, s: f64) -> Result<(), SkillError> {
        let name = self.assembly.beams[beam].beam.name.clone();
        let x_wb = self.belief.parts.pose(&name)?;
        let Parameters { grip, travel, .. } = &*self.parameters;
        let senses = senses(s, &x_wb, None, grip, travel, |stops: &[Pose]| self.way(stops));
        let grasp = self.choose(&senses).ok_or_else(|| Fault::NoGrasp { part: name.clone() })?;
        self.grasp(&name, &grasp)
    }

    /// Looks whether the part is still in the hand, and where in it.
    ///
    /// # Errors
    /// [`Fault::NotHeld`] when the fingers have closed on nothing, or the part is not where it was in the
    /// hand; the hand then counts as empty.
    pub fn check_grip(&mut self, part: &str) -> Result<(), SkillError> {
        let pushed = std::mem::take(&mut self.hand.pushed);
        if pushed {
            // The pose at the grasp is no longer valid.
            self.belief.parts.pushed(part);
            self.look_again(self.parameters.grip.looks)?;
        }
        if !self.belief.parts.is_fresh(&self.hand) {
            self.belief.parts.update(&mut self.hand)?;
        }
        let x_wp = self.belief.parts.pose(part)?;
        let x_tp = self.hand.seen.x_wt.inverse() * x_wp;
        let mut slip = None;
        let here = self.hand.held.as_mut().filter(|held| held.part == part).is_some_and(|held| {
            let moved = x_tp.translation.vector - held.x_tp.translation.vector;
            let turned = x_tp.rotation.angle_to(&held.x_tp.rotation);
            slip = Some((moved.norm(), turned));
            // The point between the fingers: far from it, a part that has rotated in them deviates by more.
            let gripped = held.x_tp.inverse() * Point3::origin();
            let moved = (x_tp * gripped).coords;
            held.x_tp = x_tp;
            // A beam may slip along the fingers and still be held.
            let along = if self.kit.beam(part).is_some() {
                self.parameters.grip.slipped
            } else {
                self.parameters.grip.strayed
            };
            moved.x.abs() < along && moved.yz().norm() < self.parameters.grip.strayed
        });
        self.check_width(part)?;
        if !here {
            return Err(self.lose(part).into());
        }
        let beside = x_tp.inverse() * Point3::new(self.parameters.grip.beside, 0.0, 0.0);
        if pushed && self.belief.parts.deviation(part, &beside)[1] > self.parameters.grip.unseen {
            let evidence = format!("{part} was pushed, and cannot be seen in the hand");
            self.diagnose(Cause::GripMoved, part, evidence);
        } else if let Some((moved, turned)) = slip {
            self.diagnose_grip(part, moved, turned);
        }
        Ok(())
    }

    /// Whether the fingers are as far apart as the part between them is wide.
    ///
    /// # Errors
    /// [`Fault::NotHeld`] when they are not; the hand then counts as empty.
    pub fn check_width(&mut self, part: &str) -> Result<(), SkillError> {
        let width = if self.kit.beam(part).is_some() { BEAM_WIDTH } else { PEG_WIDTH };
        if (self.hand.seen.width - width).abs() > self.parameters.grip.width_tolerance {
            return Err(self.lose(part).into());
        }
        Ok(())
    }

    /// The part has left the hand: it may be anywhere below.
    fn lose(&mut self, part: &str) -> Fault {
        self.diagnose(Cause::PartLost, part, format!("{part} has left the hand"));
        self.hand.held = None;
        self.belief.parts.lost(part);
        Fault::NotHeld { part: part.to_string() }
    }

    /// Is the held beam tilted in the hand?
    pub fn is_tilted(&self) -> bool {
        self.hand.held.as_ref().is_some_and(|held| {
            (held.x_tp.rotation * Vector3::x()).z.abs() > self.parameters.grip.tilted.sin()
        })
    }

    /// The reachable link of a standing beam that is nearest to the beam's free end.
    ///
    /// # Errors
    /// [`Fault::NoGrasp`] or [`Fault::Unseen`].
    pub fn nearest_link(&self, beam: usize) -> Result<String, SkillError> {
        let placed = &self.assembly.beams[beam].beam;
        let (far, name) = (self.belief.far_end(beam), placed.name.clone());
        let x_wb = self.belief.parts.pose(&name)?;
        let q = self.hand.joints();
        let mut links: Vec<_> = placed.links.iter().collect();
        let distance =
            |link: &ramp_kit::Link| (grasp::point_on(link, far, &self.parameters.grip) - far).abs();
        links.sort_by(|a, b| distance(a).total_cmp(&distance(b)));
        // One by which a push has failed is the last choice.
        let failed = self.pushed_by.get(&beam).map_or(&[][..], Vec::as_slice);
        links.sort_by_key(|link| failed.contains(&link.name));
        let link = links
            .into_iter()
            .find(|link| {
                let s = grasp::point_on(link, far, &self.parameters.grip);
                [false, true].into_iter().any(|reverse| self.reach(&beam_grasp(&x_wb, s, reverse), &q) > 0.0)
            })
            .map(|link| link.name.clone())
            .ok_or(Fault::NoGrasp { part: name })?;
        Ok(link)
    }
}

/// The motions of each of some grasps of a part: over it, straight down around it, the fingers close, and
/// straight up.
pub fn rehearse_grasps(scene: &Scene, part: &str, grasps: Vec<Grasp>) -> Outline {
    let Some(x_wp) = scene.x_wp(part) else { return Outline::nothing() };
    let motions = |grasp: Grasp| {
        let Grasp { x_wt, open, width, .. } = grasp;
        let above = scene.raised(&x_wt);
        let straight = |x_wt: Pose, would_touch: &'static str| {
            let around = Some(part.to_string());
            Motion::Straight { x_wt, open, around, stage: Stage::Grasp, would_touch }
        };
        vec![
            Motion::Travel { x_wt: above, open, stage: Stage::Grasp },
            straight(x_wt, "the fingers would touch"),
            Motion::Fingers(open - width),
            straight(above, "the hand would touch"),
            Motion::Hold(InHand::by(part, &x_wp, &grasp)),
        ]
    };
    Outline::Alternatives(grasps.into_iter().map(motions).collect())
}
