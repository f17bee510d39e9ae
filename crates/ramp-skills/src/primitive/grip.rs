//! Grips a part where it stands, and checks that it is still in the hand.

use nalgebra::{Point3, Vector3};
use ramp_robot::{Cause, GripperCommand};

use crate::Pose;
use crate::cell::Workcell;
use crate::fault::{Fault, SkillError};
use crate::grasp::{self, BEAM_WIDTH, PEG_WIDTH, beam_grasp, peg_grasp};
use crate::hand::Held;

impl Workcell<'_, '_> {
    /// The grasp of a part where it stands now: pose of the tip, gripper width before and after closing.
    pub fn choose_grasp(&mut self, part: &str, link: Option<&str>) -> Result<(Pose, f64, f64), SkillError> {
        let x_wp = self.belief.pose(part)?;
        let q = self.hand.joints();
        let no_grasp = || Fault::NoGrasp { part: part.to_string() };
        if let Some(beam) = self.kit.beam(part) {
            let link = link
                .and_then(|name| beam.links.iter().find(|link| link.name == name))
                .ok_or_else(no_grasp)?;
            // The hand turns with the beam: what counts is the worse of its start and its goal.
            let goal = self.assembly.beam_index(part).map(|index| self.target(index)).transpose()?;
            if let Some(known) = self.grasps.get(part) {
                let x_wt = beam_grasp(&x_wp, known.s, known.reverse);
                let [from, to] = grasp::span(link, &self.parameters.grip);
                let on_link = (from..=to).contains(&known.s);
                if on_link
                    && self.reach(&x_wt, &q) > 0.0
                    && self.has_room(&x_wt, self.parameters.grip.beam_open, part)
                {
                    return Ok((x_wt, self.parameters.grip.beam_open, BEAM_WIDTH));
                }
            }
            let mut nearest = None;
            for s in grasp::points_on(link, beam.span() / 2.0, &self.parameters.grip) {
                let senses = [false, true].map(|reverse| {
                    let stops = [Some(x_wp), goal].into_iter().flatten();
                    let stops: Vec<Pose> = stops.map(|x_wb| beam_grasp(&x_wb, s, reverse)).collect();
                    (stops[0], self.way(&stops))
                });
                let Some(x_wt) = self.choose(&senses) else { continue };
                if self.has_room(&x_wt, self.parameters.grip.beam_open, part) {
                    return Ok((x_wt, self.parameters.grip.beam_open, BEAM_WIDTH));
                }
                nearest = nearest.or(Some(x_wt));
            }
            // With no room anywhere the motion planner names the obstacle.
            let x_wt = nearest.ok_or_else(no_grasp)?;
            return Ok((x_wt, self.parameters.grip.beam_open, BEAM_WIDTH));
        }
        // Pegs stand close together along x of their holder: the hand closes across it.
        let senses = [0, 2].map(|quarter| {
            let x_wt = peg_grasp(&x_wp, quarter);
            (x_wt, self.way(&[x_wt]))
        });
        let x_wt = self.choose(&senses).ok_or_else(no_grasp)?;
        Ok((x_wt, self.parameters.grip.peg_open, PEG_WIDTH))
    }

    /// Grips a part where it stands: the hand comes from above, closes and checks that it holds something of the
    /// right width.
    ///
    /// # Errors
    /// [`Fault::NotHeld`], or what stopped the motion.
    pub fn grasp(&mut self, part: &str, x_wt: &Pose, open: f64, width: f64) -> Result<(), SkillError> {
        self.hand.gripper.width = open;
        let closing =
            GripperCommand { width: width - self.parameters.grip.squeeze, force: self.parameters.grip.force };
        self.descend(x_wt, part, closing)?;
        if self.hand.gripper != closing {
            self.hand.wait_for_gripper()?;
        }
        self.hand.relax();
        for attempt in 0..self.parameters.grip.closings {
            self.hand.grip(closing.width, closing.force)?;
            let short = self.hand.seen.width - width;
            if short < self.parameters.grip.short {
                break;
            }
            let evidence = format!("the fingers stop {:.1} mm before {part}", short * 1e3);
            self.diagnose(Cause::GripWeak, part, evidence);
            if attempt + 1 < self.parameters.grip.closings {
                self.hand.grip(
                    open.max(self.hand.seen.width + self.parameters.grip.opened),
                    self.parameters.grip.opening_force,
                )?;
            }
        }
        if (self.hand.seen.width - width).abs() > self.parameters.grip.width_tolerance {
            if self.hand.seen.width < width {
                self.diagnose(Cause::PartLost, part, format!("{part} is not between the fingers"));
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

    /// Grips a beam that stands, where it stands, at `s` metres from its j1 hole.
    ///
    /// # Errors
    /// As [`Workcell::grasp`].
    pub fn grasp_standing(&mut self, beam: usize, s: f64) -> Result<(), SkillError> {
        let name = self.assembly.beams[beam].beam.name.clone();
        let x_wb = self.belief.pose(&name)?;
        let senses = [false, true].map(|reverse| {
            let x_wt = beam_grasp(&x_wb, s, reverse);
            (x_wt, self.way(&[x_wt]))
        });
        let x_wt = self.choose(&senses).ok_or_else(|| Fault::NoGrasp { part: name.clone() })?;
        self.grasp(&name, &x_wt, self.parameters.grip.beam_open, BEAM_WIDTH)
    }

    /// Looks whether the part is still in the hand, and where in it.
    ///
    /// # Errors
    /// [`Fault::NotHeld`] when the fingers have closed on nothing, or the part is not where it was in the hand; the
    /// hand then counts as empty.
    pub fn check_grip(&mut self, part: &str) -> Result<(), SkillError> {
        let pushed = std::mem::take(&mut self.hand.pushed);
        if pushed {
            // How the fingers took it says nothing any more.
            self.belief.pushed(part);
            self.look_again(self.parameters.grip.looks)?;
        }
        self.belief.update(&mut self.hand)?;
        let x_wp = self.belief.pose(part)?;
        let x_tp = self.hand.seen.x_wt.inverse() * x_wp;
        let width = if self.kit.beam(part).is_some() { BEAM_WIDTH } else { PEG_WIDTH };
        let closed = (self.hand.seen.width - width).abs() > self.parameters.grip.width_tolerance;
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
            let along = if self.kit.beam(part).is_some() {
                self.parameters.grip.slipped
            } else {
                self.parameters.grip.strayed
            };
            moved.x.abs() < along && moved.yz().norm() < self.parameters.grip.strayed
        });
        if closed || !here {
            self.diagnose(Cause::PartLost, part, format!("{part} has left the hand"));
            self.hand.held = None;
            self.belief.lost(part);
            return Err(Fault::NotHeld { part: part.to_string() }.into());
        }
        let beside = x_tp.inverse() * Point3::new(self.parameters.grip.beside, 0.0, 0.0);
        if pushed && self.belief.deviation(part, &beside)[1] > self.parameters.grip.unseen {
            let evidence = format!("{part} was pushed, and cannot be seen in the hand");
            self.diagnose(Cause::GripMoved, part, evidence);
        } else if let Some((moved, turned)) = slip {
            self.diagnose_grip(part, moved, turned);
        }
        Ok(())
    }

    /// Is the held beam tilted in the hand?
    pub fn is_tilted(&self) -> bool {
        self.hand
            .held
            .as_ref()
            .is_some_and(|held| (held.x_tp.rotation * Vector3::x()).z.abs() > self.parameters.grip.tilted)
    }

    /// The reachable link of a standing beam that is nearest to the beam's free end.
    ///
    /// # Errors
    /// [`Fault::NoGrasp`] or [`Fault::Unseen`].
    pub fn nearest_link(&self, beam: usize) -> Result<String, SkillError> {
        let placed = &self.assembly.beams[beam].beam;
        let (far, name) = (self.far_end(beam), placed.name.clone());
        let x_wb = self.belief.pose(&name)?;
        let q = self.hand.joints();
        let mut links: Vec<_> = placed.links.iter().collect();
        let distance =
            |link: &ramp_kit::Link| (grasp::point_on(link, far, &self.parameters.grip) - far).abs();
        links.sort_by(|a, b| distance(a).total_cmp(&distance(b)));
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
