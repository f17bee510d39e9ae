//! New goals, as many as asked: random, but always the same for the same seed, and every one of them checked.
//!
//! Up to as many beams as the kit has, a goal is grown from the clamped beam: a beam is put where one of its
//! joints meets one of the others, whatever else meets there is joined too, and what overlaps or cannot be built is
//! thrown away. Larger ones are frames (`frame`), for which the kit is extended.

use crate::assembly::{Assembly, Class, PlacedBeam};
use crate::check::Solids;
use crate::frame;
use crate::pose::Planar;
use crate::read::{read_goal_str, x_ab};
use nalgebra::{Point2, Vector2};
use ramp_kit::strokes::escape;
use ramp_kit::{Beam, Kit};
use rand_core::{Rng, SeedableRng};
use rand_pcg::Pcg64Mcg;
use std::collections::HashSet;
use std::f64::consts::{FRAC_PI_2, PI};
use std::fmt::Write;

/// What is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Request {
    /// How many beams, the clamped one included.
    pub beams: usize,
    /// Which one of the many.
    pub seed: u64,
    /// Of this class only.
    pub class: Option<Class>,
}

/// A goal that nobody has thought of.
#[derive(Clone, Debug)]
pub struct Generated {
    /// Its name, for example `hard-6-beams-17`.
    pub name: String,
    /// The text of its file.
    pub goal: String,
    /// The text of the kit file it is for, where the given kit had too few beams.
    pub kit: Option<String>,
    /// The goal, read back and checked.
    pub assembly: Assembly,
}

/// Why no goal could be made.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error, miette::Diagnostic)]
#[non_exhaustive]
pub enum GenerateError {
    /// A number of beams that makes no goal.
    #[error("a goal has 2 to {} beams, and {found} were asked for", crate::check::MAX_BEAMS)]
    Beams {
        /// How many were asked for.
        found: usize,
    },
    /// No clamped beam to begin with.
    #[error("the kit has no clamped beam (one without a start) to build a goal on")]
    NoBase,
    /// Nothing was found.
    #[error("found no {}goal of {beams} beams with the seed {seed}", class.map_or(String::new(), |class| format!("{} ", class.name())))]
    #[diagnostic(help("try another seed, another number of beams, or another class"))]
    NotFound {
        /// The number of beams.
        beams: usize,
        /// The seed.
        seed: u64,
        /// The class.
        class: Option<Class>,
    },
}

/// How often a goal is begun anew before giving up.
const ATTEMPTS: usize = 4000;
/// How often a place for one more beam is looked for.
const TRIES: usize = 60;
/// The part of the table that the robot builds on, in the assembly frame, m: beams stay within.
const AREA: [[f64; 2]; 2] = [[-0.150, 0.525], [-0.020, 0.335]];
/// Holes that are nearer than this are one, m.
const MEET: f64 = 0.05e-3;
/// Millimetres in a metre.
const MM: f64 = 1e3;
/// A male whose hole is nearer than this to that of a female that it is not joined with is a near miss, m.
const NEAR_MISS: f64 = 45.0e-3;
/// A beam that is neither square nor at least this much out of it looks like a mistake, rad.
const LEAST_ANGLE: f64 = 10.0 * PI / 180.0;
/// Angles nearer than this are equal, rad.
const SAME_ANGLE: f64 = 0.01 * PI / 180.0;

/// A new goal.
///
/// ```
/// # let data = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data");
/// use ramp_assembly::{Request, generate};
/// let kit = ramp_kit::read_kit(&data.join("kit.xml"))?;
/// let request = Request { beams: 5, seed: 7, class: None };
/// let made = generate(&kit, request)?;
/// assert_eq!(made.goal, generate(&kit, request)?.goal);
/// let goal = ramp_assembly::read_goal_str("new.xml", &made.goal, &kit)?;
/// assert_eq!(goal.beams.len(), 5);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// A request that makes no sense, or for which nothing was found.
pub fn generate(kit: &Kit, request: Request) -> Result<Generated, GenerateError> {
    let Request { beams, seed, class } = request;
    if !(2..=crate::check::MAX_BEAMS).contains(&beams) {
        return Err(GenerateError::Beams { found: beams });
    }
    let base = kit.beams.iter().position(|beam| beam.start.is_none()).ok_or(GenerateError::NoBase)?;
    let mut dice = Dice::new(seed);
    if beams > kit.beams.len() {
        return frame::frame(kit, base, request, &mut dice);
    }
    for _ in 0..ATTEMPTS {
        let Some(draft) = Draft::grow(kit, base, beams, class, &mut dice) else { continue };
        let specials = draft.specials();
        let could_be = match class {
            None => true,
            Some(Class::Easy) => specials == 0 && draft.pairs.len() <= 4,
            Some(Class::Medium) => specials == 1 || (specials == 0 && draft.pairs.len() > 4),
            Some(Class::Hard) => specials > 1,
        };
        if !could_be || (!kit.pegs.is_empty() && draft.pairs.len() > kit.pegs.len()) {
            continue;
        }
        if let Some(made) = draft.finish(kit, request) {
            return Ok(made);
        }
    }
    Err(GenerateError::NotFound { beams, seed, class })
}

/// Many goals: those of the seeds from `first.seed` on, each different from all before it, until there are `count`.
///
/// # Errors
/// As [`generate`]; and where the kit has no more goals than were found.
pub fn generate_many(kit: &Kit, first: Request, count: usize) -> Result<Vec<Generated>, GenerateError> {
    let mut seen = HashSet::new();
    let mut goals = Vec::new();
    let mut request = first;
    let mut repeats = 0;
    while goals.len() < count {
        let made = generate(kit, request)?;
        if seen.insert(essence(&made.assembly)) {
            goals.push(made);
            repeats = 0;
        } else {
            repeats += 1;
        }
        if repeats > 100 {
            let Request { beams, seed, class } = request;
            return Err(GenerateError::NotFound { beams, seed, class });
        }
        request.seed = request.seed.wrapping_add(1);
    }
    Ok(goals)
}

/// What makes a goal this one: what is joined with what, and how the beams lie; not names and orders in its file.
fn essence(assembly: &Assembly) -> Vec<String> {
    let joined = assembly
        .connections
        .iter()
        .map(|c| format!("{} {}", assembly.joint_name(c.male), assembly.joint_name(c.female)));
    let lie = assembly.beams.iter().map(|placed| {
        let at = placed.x_ab.translation.vector.map(|v| (v * MM).round() as i64);
        let along = placed.x_ab.rotation * nalgebra::Vector3::x();
        let degrees = along.y.atan2(along.x).to_degrees().round() as i64;
        format!("{} {} {} {degrees}", placed.beam.name, at.x, at.y)
    });
    let mut essence: Vec<String> = joined.chain(lie).collect();
    essence.sort_unstable();
    essence
}

/// Random choices, all from the seed.
pub(crate) struct Dice(Pcg64Mcg);

impl Dice {
    fn new(seed: u64) -> Dice {
        // Neighbouring seeds shall not give similar streams: the generator's own seeding spreads the bits.
        Dice(Pcg64Mcg::seed_from_u64(seed ^ 0x7261_6d70_2067_6f61))
    }

    /// A whole number from 0 to `count` − 1; 0 where there is nothing to choose.
    pub fn below(&mut self, count: usize) -> usize {
        if count == 0 { 0 } else { (self.0.next_u64() % count as u64) as usize }
    }

    /// True once in `in_all` times.
    pub fn once_in(&mut self, in_all: usize) -> bool {
        self.below(in_all) == 0
    }

    /// One of these.
    pub fn choose<'a, T>(&mut self, from: &'a [T]) -> Option<&'a T> {
        from.get(self.below(from.len()))
    }
}

/// A joint of a beam of the draft: index of the beam there, index of the joint.
type Spot = (usize, usize);

struct Draft<'a> {
    beams: Vec<&'a Beam>,
    poses: Vec<Planar>,
    placed: Vec<PlacedBeam>,
    /// Female and male.
    pairs: Vec<(Spot, Spot)>,
}

impl<'a> Draft<'a> {
    fn grow(
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
        self.placed.push(PlacedBeam { beam: beam.clone(), flipped, x_ab: x_ab(&pose, flipped) });
        self.beams.push(beam);
        self.poses.push(pose);
    }

    /// Puts a beam there if it is within reach, overlaps nothing, and whatever meets there fits.
    fn try_push(&mut self, beam: &'a Beam, pose: Planar) -> bool {
        for offset in [-10.0e-3, beam.span() + 10.0e-3] {
            let end = pose.hole(offset);
            let inside = |value: f64, [low, high]: [f64; 2]| (low..=high).contains(&value);
            if !inside(end.x, AREA[0]) || !inside(end.y, AREA[1]) {
                return false;
            }
        }
        let out = crate::pose::off_square(pose.yaw).min(crate::pose::off_square(pose.yaw + FRAC_PI_2));
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

    /// The joints of the beam `index` that meet joints of others; `None` when two meet that cannot be joined, or
    /// all but meet.
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

    /// Does the male lie within the angle that the female accepts?
    fn enters(&self, female: Spot, male: Spot) -> bool {
        let around = &self.beams[female.0].joints[female.1];
        let inside = &self.beams[male.0].joints[male.1];
        let yaw = self.poses[male.0].yaw + crate::pose::turn(inside.kind, self.placed[male.0].flipped);
        crate::pose::off_square(yaw - self.poses[female.0].yaw) <= crate::pose::entry_limit(around.kind)
    }

    /// Every free joint of the beams that stand that could mate with a joint of `kind`.
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

    /// Places at a right angle to a beam that stands: one joint, chosen by chance, on each free one.
    fn square_places(&self, beam: &Beam, dice: &mut Dice) -> Vec<Planar> {
        let own = dice.below(beam.joints.len());
        let joint = &beam.joints[own];
        let mut places = Vec::new();
        for spot in self.free(joint.kind.is_male()) {
            let other = &self.beams[spot.0].joints[spot.1];
            let flipped = beam.start.is_some_and(|start| start.flipped);
            let turned = crate::pose::turn(joint.kind, flipped)
                - crate::pose::turn(other.kind, self.placed[spot.0].flipped);
            for quarter in [FRAC_PI_2, -FRAC_PI_2] {
                let yaw = self.poses[spot.0].yaw + quarter - turned;
                places.push(Planar::with_hole(self.point(spot), joint.offset, yaw));
            }
        }
        places
    }

    /// Places at an angle: two joints on two free ones that are as far apart.
    fn angled_places(&self, beam: &Beam) -> Vec<Planar> {
        let mut places = Vec::new();
        for (first, a) in beam.joints.iter().enumerate() {
            for b in &beam.joints[first + 1..] {
                let span = b.offset - a.offset;
                for p in self.free(a.kind.is_male()).map(|spot| self.point(spot)) {
                    for q in self.free(b.kind.is_male()).map(|spot| self.point(spot)) {
                        let way: Vector2<f64> = q - p;
                        let yaw = way.y.atan2(way.x);
                        let square =
                            crate::pose::off_square(yaw).min(crate::pose::off_square(yaw + FRAC_PI_2));
                        if (way.norm() - span).abs() < MEET && square > SAME_ANGLE {
                            places.push(Planar::with_hole(p, a.offset, yaw));
                        }
                    }
                }
            }
        }
        places
    }

    /// Two beams that are joined with each other, and each with one that stands: where they close a triangle.
    fn try_triangle(&mut self, a: &'a Beam, b: &'a Beam, dice: &mut Dice) -> bool {
        // Whether the corner of the triangle is one that both can have is a matter of luck.
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
            for corner in crate::pose::circles(p, a_arm.abs(), q, b_arm.abs()) {
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

    /// As [`Assembly::specials`].
    fn specials(&self) -> usize {
        let passes = |(_, male): &&(Spot, Spot)| !self.beams[male.0].joints[male.1].kind.is_end();
        let angled = |pose: &&Planar| {
            let square = crate::pose::off_square(pose.yaw).min(crate::pose::off_square(pose.yaw + FRAC_PI_2));
            square > 1e-3
        };
        self.pairs.iter().filter(passes).count() + self.poses.iter().filter(angled).count()
    }

    /// Writes the goal and reads it back; `None` when the whole check finds something.
    fn finish(&self, kit: &Kit, request: Request) -> Option<Generated> {
        let class = request.class.unwrap_or(match self.specials() {
            0 if self.pairs.len() <= 4 => Class::Easy,
            0 | 1 => Class::Medium,
            _ => Class::Hard,
        });
        let name = goal_name(class, request);
        // A yaw is only written where the connections leave it open and the usual one is not meant.
        let mut yaws = vec![false; self.beams.len()];
        loop {
            let text = self.text(&name, class, &yaws);
            let read = read_goal_str(&format!("{name}.xml"), &text, kit);
            let wrong = match &read {
                Ok(assembly) => self.placed.iter().zip(&assembly.beams).position(|(meant, found)| {
                    let apart = (meant.x_ab.translation.vector - found.x_ab.translation.vector).norm();
                    apart > 0.1e-3 || meant.x_ab.rotation.angle_to(&found.x_ab.rotation) > 1e-3
                }),
                Err(_) => None,
            };
            match (read, wrong) {
                (Ok(assembly), None) => return Some(Generated { name, goal: text, kit: None, assembly }),
                (Ok(_), Some(beam)) if !yaws[beam] => yaws[beam] = true,
                // Holes that meet only so that the usual directions do not fit: say all of them.
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

/// The name of a goal that was made.
pub(crate) fn goal_name(class: Class, request: Request) -> String {
    format!("{}-{}-beams-{}", class.name(), request.beams, request.seed)
}

/// The text of a goal file: components as (beam, flipped, yaw in rad), the base first; connections as the male and
/// the female with their beams.
pub(crate) fn goal_xml(
    name: &str,
    class: Class,
    components: &[(&str, bool, Option<f64>)],
    pairs: &[[(&str, &str); 2]],
) -> String {
    let mut xml = String::from("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n");
    // Writing to a string does not fail.
    let _ = writeln!(xml, "<!-- Made by `ramp goals generate`. -->");
    let _ = writeln!(xml, "<assembly name=\"{name}\" class=\"{}\">", class.name());
    for (index, (beam, flipped, yaw)) in components.iter().enumerate() {
        let base = if index == 0 { " base=\"True\"" } else { "" };
        let flipped = if *flipped { " flipped=\"True\"" } else { "" };
        let yaw = yaw.map_or(String::new(), |yaw| {
            format!(" yaw=\"{}\"", (yaw.to_degrees() * 1e6).round() / 1e6 + 0.0)
        });
        let _ = writeln!(xml, "  <component beam=\"{}\"{base}{flipped}{yaw}/>", escape(beam));
    }
    for (index, pair) in pairs.iter().enumerate() {
        let _ = writeln!(xml, "  <connection name=\"C{}\">", index + 1);
        for (beam, joint) in pair {
            let (beam, joint) = (escape(beam), escape(joint));
            let _ = writeln!(xml, "    <element component=\"{beam}\" joint=\"{joint}\"/>");
        }
        xml.push_str("  </connection>\n");
    }
    xml.push_str("</assembly>\n");
    xml
}
