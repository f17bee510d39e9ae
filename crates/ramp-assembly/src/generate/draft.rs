//! A goal grown from the clamped beam: beams are added one by one where their joints meet those of
//! placed ones.

use super::dice::Dice;
use super::goal_file::goal_xml;
use super::request::Generated;
use crate::assembly::{Class, PlacedBeam};
use crate::check::Solids;
use crate::pose::{self, Planar};
use crate::read::read_goal_str;
use nalgebra::{Point2, Vector2};
use ramp_kit::{Beam, Kit};
use std::f64::consts::{FRAC_PI_2, PI};

/// Number of attempts to place one more beam.
const TRIES: usize = 60;
/// The building area on the table, in the assembly frame, m: beams stay within.
const AREA: [[f64; 2]; 2] = [[-0.150, 0.525], [-0.020, 0.335]];
/// Holes nearer than this coincide, m.
const MEET: f64 = 0.05e-3;
/// Minimum distance between a male's hole and that of an unconnected female, m; less is a near
/// miss.
const NEAR_MISS: f64 = 45.0e-3;
/// Smallest angle of an oblique beam, rad; less would look like a mistake.
const LEAST_ANGLE: f64 = 10.0 * PI / 180.0;
/// Angles nearer than this are equal, rad.
const SAME_ANGLE: f64 = 0.01 * PI / 180.0;

/// A joint of a beam of the draft: index of the beam, index of the joint.
type Spot = (usize, usize);

/// A growing goal.
pub(super) struct Draft<'a> {
    beams: Vec<&'a Beam>,
    poses: Vec<Planar>,
    placed: Vec<PlacedBeam>,
    /// Female and male.
    pub(super) pairs: Vec<(Spot, Spot)>,
}

impl<'a> Draft<'a> {
    /// Adds beams until there are `count`; `None` when no place for another was found.
    pub(super) fn grow(
        kit: &'a Kit,
        base: usize,
        count: usize,
        class: Option<Class>,
        dice: &mut Dice,
    ) -> Option<Draft<'a>> {
        let mut draft = Draft { beams: Vec::new(), poses: Vec::new(), placed: Vec::new(), pairs: Vec::new() };
        draft.push(&kit.beams[base], Planar { at: Point2::origin(), yaw: 0.0 });
        let mut left: Vec<&Beam> =
            kit.beams.iter().enumerate().filter(|(index, _)| *index != base).map(|(_, beam)| beam).collect();
        let mut tries = 0;
        while draft.beams.len() < count {
            tries += 1;
            if tries > TRIES {
                return None;
            }
            if class != Some(Class::Easy) && count - draft.beams.len() >= 2 && dice.once_in(4) {
                let first = dice.below(left.len());
                let second = dice.below(left.len());
                if first != second && draft.try_triangle(left[first], left[second], dice) {
                    left.remove(first.max(second));
                    left.remove(first.min(second));
                    tries = 0;
                }
                continue;
            }
            let index = dice.below(left.len());
            let places = if class != Some(Class::Easy) && dice.once_in(3) {
                draft.angled_places(left[index])
            } else {
                draft.square_places(left[index], dice)
            };
            let Some(pose) = dice.choose(&places).copied() else { continue };
            if draft.try_push(left[index], pose) {
                left.remove(index);
                tries = 0;
            }
        }
        Some(draft)
    }

    fn push(&mut self, beam: &'a Beam, pose: Planar) {
        let flipped = beam.start.is_some_and(|start| start.flipped);
        self.placed.push(PlacedBeam { beam: beam.clone(), flipped, x_ab: pose::x_ab(&pose, flipped) });
        self.beams.push(beam);
        self.poses.push(pose);
    }

    /// Adds a beam at this pose if it is within reach, free of overlaps, and all meeting joints
    /// fit.
    fn try_push(&mut self, beam: &'a Beam, pose: Planar) -> bool {
        for offset in [-10.0e-3, beam.span() + 10.0e-3] {
            let end = pose.hole(offset);
            let inside = |value: f64, [low, high]: [f64; 2]| (low..=high).contains(&value);
            if !inside(end.x, AREA[0]) || !inside(end.y, AREA[1]) {
                return false;
            }
        }
        let out = pose::off_square(pose.yaw).min(pose::off_square(pose.yaw + FRAC_PI_2));
        let turned = beam.joints.iter().any(|joint| joint.kind.form().turn != 0.0);
        if out > SAME_ANGLE && out < LEAST_ANGLE && !turned {
            return false;
        }
        let index = self.beams.len();
        self.push(beam, pose);
        let before = self.pairs.len();
        let meeting = self.meeting(index);
        self.pairs.extend(meeting.iter().flatten());
        if meeting.is_none() || Solids::new(&self.placed).overlaps_any(index) {
            self.beams.pop();
            self.poses.pop();
            self.placed.pop();
            self.pairs.truncate(before);
            return false;
        }
        true
    }

    fn taken(&self, spot: Spot) -> bool {
        self.pairs.iter().any(|(female, male)| *female == spot || *male == spot)
    }

    /// The joints of the beam `index` that meet joints of others; `None` on a pair that cannot be
    /// joined, or a near miss.
    fn meeting(&self, index: usize) -> Option<Vec<(Spot, Spot)>> {
        let mut found = Vec::new();
        for (own, joint) in self.beams[index].joints.iter().enumerate() {
            let hole = self.poses[index].hole(joint.offset);
            for other in 0..index {
                for (theirs, around) in self.beams[other].joints.iter().enumerate() {
                    let apart = (self.poses[other].hole(around.offset) - hole).norm();
                    if apart > MEET {
                        if apart < NEAR_MISS {
                            return None;
                        }
                        continue;
                    }
                    let (mine, yours) = ((index, own), (other, theirs));
                    if joint.kind.is_male() == around.kind.is_male() || self.taken(yours) {
                        return None;
                    }
                    let (female, male) = if joint.kind.is_male() { (yours, mine) } else { (mine, yours) };
                    if !self.enters(female, male) {
                        return None;
                    }
                    found.push((female, male));
                }
            }
        }
        Some(found)
    }

    /// Whether the male is within the entry angle of the female.
    fn enters(&self, female: Spot, male: Spot) -> bool {
        let around = &self.beams[female.0].joints[female.1];
        let inside = &self.beams[male.0].joints[male.1];
        let yaw = self.poses[male.0].yaw + pose::turn(inside.kind, self.placed[male.0].flipped);
        pose::off_square(yaw - self.poses[female.0].yaw) <= pose::entry_limit(around.kind)
    }

    /// Every free joint of the placed beams of the given gender.
    fn free(&self, male: bool) -> impl Iterator<Item = Spot> + '_ {
        let spots = self.beams.iter().enumerate();
        let spots = spots.flat_map(|(beam, b)| (0..b.joints.len()).map(move |joint| (beam, joint)));
        spots.filter(move |&(beam, joint)| {
            self.beams[beam].joints[joint].kind.is_male() != male && !self.taken((beam, joint))
        })
    }

    fn point(&self, (beam, joint): Spot) -> Point2<f64> {
        self.poses[beam].hole(self.beams[beam].joints[joint].offset)
    }

    /// Poses at a right angle to a placed beam: one randomly chosen joint, on each free one.
    fn square_places(&self, beam: &Beam, dice: &mut Dice) -> Vec<Planar> {
        let own = dice.below(beam.joints.len());
        let joint = &beam.joints[own];
        let mut places = Vec::new();
        for spot in self.free(joint.kind.is_male()) {
            let other = &self.beams[spot.0].joints[spot.1];
            let flipped = beam.start.is_some_and(|start| start.flipped);
            let turned =
                pose::turn(joint.kind, flipped) - pose::turn(other.kind, self.placed[spot.0].flipped);
            for quarter in [FRAC_PI_2, -FRAC_PI_2] {
                let yaw = self.poses[spot.0].yaw + quarter - turned;
                places.push(Planar::with_hole(self.point(spot), joint.offset, yaw));
            }
        }
        places
    }

    /// Oblique poses: two joints on two free ones at the same distance.
    fn angled_places(&self, beam: &Beam) -> Vec<Planar> {
        let mut places = Vec::new();
        for (first, a) in beam.joints.iter().enumerate() {
            for b in &beam.joints[first + 1..] {
                let span = b.offset - a.offset;
                for p in self.free(a.kind.is_male()).map(|spot| self.point(spot)) {
                    for q in self.free(b.kind.is_male()).map(|spot| self.point(spot)) {
                        let way: Vector2<f64> = q - p;
                        let yaw = way.y.atan2(way.x);
                        let square = pose::off_square(yaw).min(pose::off_square(yaw + FRAC_PI_2));
                        if (way.norm() - span).abs() < MEET && square > SAME_ANGLE {
                            places.push(Planar::with_hole(p, a.offset, yaw));
                        }
                    }
                }
            }
        }
        places
    }

    /// Two beams connected with each other, and each with a placed one, so that they close a
    /// triangle.
    fn try_triangle(&mut self, a: &'a Beam, b: &'a Beam, dice: &mut Dice) -> bool {
        // Whether two random joints can share the triangle's corner is a matter of luck.
        for _ in 0..TRIES {
            let joint = |beam: &Beam, dice: &mut Dice| {
                let [first, second] = [dice.below(beam.joints.len()), dice.below(beam.joints.len())];
                (beam.joints[first].clone(), beam.joints[second].clone())
            };
            let ((a_foot, a_top), (b_foot, b_top)) = (joint(a, dice), joint(b, dice));
            let spots = |draft: &Self, male: bool| draft.free(male).collect::<Vec<Spot>>();
            let feet = (spots(self, a_foot.kind.is_male()), spots(self, b_foot.kind.is_male()));
            let (Some(&p), Some(&q)) = (dice.choose(&feet.0), dice.choose(&feet.1)) else { continue };
            if p == q || a_top.kind.is_male() == b_top.kind.is_male() {
                continue;
            }
            let (p, q) = (self.point(p), self.point(q));
            let (a_arm, b_arm) = (a_top.offset - a_foot.offset, b_top.offset - b_foot.offset);
            if a_arm.abs() < MEET || b_arm.abs() < MEET {
                continue;
            }
            for corner in pose::circles(p, a_arm.abs(), q, b_arm.abs()) {
                let aim = |from: Point2<f64>, arm: f64, offset: f64| {
                    let way: Vector2<f64> = (corner - from) * arm.signum();
                    Planar::with_hole(from, offset, way.y.atan2(way.x))
                };
                let before = self.pairs.len();
                if !self.try_push(a, aim(p, a_arm, a_foot.offset)) {
                    continue;
                }
                if self.try_push(b, aim(q, b_arm, b_foot.offset)) {
                    return true;
                }
                self.beams.pop();
                self.poses.pop();
                self.placed.pop();
                self.pairs.truncate(before);
            }
        }
        false
    }

    /// The class by its features, as [`Assembly::likely_class`].
    pub(super) fn likely_class(&self) -> Class {
        match self.specials() {
            0 if self.pairs.len() <= 4 => Class::Easy,
            0 | 1 => Class::Medium,
            _ => Class::Hard,
        }
    }

    /// As [`Assembly::specials`].
    pub(super) fn specials(&self) -> usize {
        let passes = |(_, male): &&(Spot, Spot)| !self.beams[male.0].joints[male.1].kind.is_end();
        let angled = |pose: &&Planar| {
            let square = pose::off_square(pose.yaw).min(pose::off_square(pose.yaw + FRAC_PI_2));
            square > 1e-3
        };
        self.pairs.iter().filter(passes).count() + self.poses.iter().filter(angled).count()
    }

    /// Writes the goal and reads it back; `None` when the full check finds an error.
    pub(super) fn finish(&self, kit: &Kit, name: &str, class: Class) -> Option<Generated> {
        // A yaw is written only where the connections leave it open and the default is wrong.
        let mut yaws = vec![false; self.beams.len()];
        loop {
            let text = self.text(name, class, &yaws);
            let read = read_goal_str(&format!("{name}.xml"), &text, kit);
            let wrong = match &read {
                Ok(assembly) => self.placed.iter().zip(&assembly.beams).position(|(meant, found)| {
                    let apart = (meant.x_ab.translation.vector - found.x_ab.translation.vector).norm();
                    apart > 0.1e-3 || meant.x_ab.rotation.angle_to(&found.x_ab.rotation) > 1e-3
                }),
                Err(_) => None,
            };
            match (read, wrong) {
                (Ok(assembly), None) => {
                    return Some(Generated { name: name.to_string(), goal: text, kit: None, assembly });
                }
                (Ok(_), Some(beam)) if !yaws[beam] => yaws[beam] = true,
                // The default directions can make holes meet that do not fit: then all yaws are
                // written.
                (Err(_), _) if yaws[1..].iter().any(|said| !said) => yaws[1..].fill(true),
                _ => return None,
            }
        }
    }

    fn text(&self, name: &str, class: Class, yaws: &[bool]) -> String {
        let mut components = Vec::new();
        for (index, beam) in self.beams.iter().enumerate() {
            let yaw = (index > 0 && yaws[index]).then_some(self.poses[index].yaw);
            components.push((beam.name.as_str(), self.placed[index].flipped, yaw));
        }
        let joint = |(beam, joint): Spot| {
            (self.beams[beam].name.as_str(), self.beams[beam].joints[joint].name.as_str())
        };
        let pairs: Vec<_> = self.pairs.iter().map(|&(female, male)| [joint(male), joint(female)]).collect();
        goal_xml(name, class, &components, &pairs)
    }
}
