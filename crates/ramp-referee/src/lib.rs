//! The referee: reads the truth and reports the seated pegs with their times.
//!
//! A peg counts when its axis passes through both holes of a required connection ([`pins()`]), its head rests
//! within 0.5 mm of the female's top plate, and it stays so to the end of the episode. Its time is when that
//! began. It counts for one connection only. Where the referee judges a simulation, it is given the parts
//! that are in each other as well ([`Referee::penetrated`]), and the poses once more while the parts rest
//! without the arm ([`Referee::rested`]).
//!
//! Where the task is to take a frame apart ([`Referee::for_task`]), every part of the frame that is not
//! clamped counts, once it is back in its place on the sheet (`places`) and stays there. Then all that is
//! said of pegs below holds for these parts, and all that is said of connections for their places.

mod penetrations;
mod pins;
mod places;

use nalgebra::Point3;
use ramp_assembly::{Assembly, JointRef, Penetration, Task, Truth};

use penetrations::Penetrations;
pub use penetrations::{APART, DEEPEST};
pub use pins::{SEATED, pins};
use places::Places;
pub use places::{BESIDE, PEG_BESIDE, PEG_RAISED, RAISED, TURNED};

/// Time for which parts rest without the arm at the end, s. Chosen: a peg falls out of a hole in a tenth of
/// it.
pub const REST: f64 = 2.0;

/// A peg that counts.
#[derive(Clone, Debug, PartialEq)]
pub struct Seated {
    /// The name of the peg, or of the part.
    pub peg: String,
    /// Robot time since which it has been seated, or back in its place, s.
    pub since: f64,
    /// The agent's own clock at that moment: planning and compute so far, s.
    pub thought: f64,
}

/// A peg that is in its place and does not count.
#[derive(Clone, Debug, PartialEq)]
pub struct Rejected {
    /// The peg's name.
    pub peg: String,
    /// The reason.
    pub reason: Reason,
}

/// Reasons why a peg in its place does not count.
#[derive(Clone, Debug, PartialEq)]
pub enum Reason {
    /// Two parts of its connection were deeper in each other than [`DEEPEST`], and have not been apart since.
    Penetration {
        /// The names of the two parts.
        parts: [String; 2],
        /// The largest depth, m.
        depth: f64,
    },
    /// It did not stay in its place when the arm was gone.
    Fell,
}

/// Watches one episode.
#[derive(Clone, Debug)]
pub struct Referee {
    /// Names of all parts, in the order of the truths.
    names: Vec<String>,
    /// Index into the truth of each beam of the assembly.
    beams: Vec<usize>,
    /// Index into the truth of every peg.
    pegs: Vec<usize>,
    required: Vec<Required>,
    penetrations: Penetrations,
    seated: Vec<Option<Seated>>,
    rejected: Vec<Option<Rejected>>,
}

/// A condition that counts once it holds.
#[derive(Clone, Debug)]
enum Required {
    /// A peg pins a connection.
    Pinned {
        female: JointRef,
        male: JointRef,
        /// Holes in their beams' frames.
        p_b_female: Point3<f64>,
        p_b_male: Point3<f64>,
    },
    /// A part, by its index into the truth, is in one of its places.
    Back { part: usize, places: Places },
}

impl Referee {
    /// A referee for `assembly`. `part_names` are the parts in the order of the truths it will see.
    ///
    /// Beams of the goal that are not among the parts make their connections uncountable.
    pub fn new<'n>(assembly: &Assembly, part_names: impl Iterator<Item = &'n str>) -> Referee {
        let names: Vec<String> = part_names.map(str::to_string).collect();
        let hole = |joint: JointRef| assembly.beams[joint.beam].beam.p_b_hole(joint.joint);
        let connections = assembly
            .connections
            .iter()
            .map(|connection| Required::Pinned {
                female: connection.female,
                male: connection.male,
                p_b_female: hole(connection.female),
                p_b_male: hole(connection.male),
            })
            .collect();
        Referee::watching(assembly, names, connections)
    }

    /// A referee for a task with `assembly`; `part_names` as in [`Referee::new`].
    pub fn for_task<'n>(
        assembly: &Assembly,
        task: Task,
        part_names: impl Iterator<Item = &'n str>,
    ) -> Referee {
        if task == Task::Build {
            return Referee::new(assembly, part_names);
        }
        let names: Vec<String> = part_names.map(str::to_string).collect();
        let required = assembly.movable_parts().into_iter().map(|name| Required::Back {
            part: names.iter().position(|other| other == name).unwrap_or(usize::MAX),
            places: match assembly.kit.beam(name) {
                Some(beam) => Places::of_beam(&assembly.kit, beam),
                None => Places::of_peg(&assembly.kit),
            },
        });
        let required = required.collect();
        Referee::watching(assembly, names, required)
    }

    fn watching(assembly: &Assembly, names: Vec<String>, required: Vec<Required>) -> Referee {
        let index = |name: &str| names.iter().position(|other| *other == name);
        let beams = assembly.beams.iter().map(|placed| index(&placed.beam.name).unwrap_or(usize::MAX));
        Referee {
            beams: beams.collect(),
            pegs: assembly.kit.pegs.iter().filter_map(|peg| index(&peg.name)).collect(),
            names,
            penetrations: Penetrations::default(),
            seated: vec![None; required.len()],
            rejected: vec![None; required.len()],
            required,
        }
    }

    /// Reads the true poses once. `thought` is the agent's own clock, s.
    pub fn watch(&mut self, truth: &Truth, thought: f64) {
        self.penetrations.part(truth);
        let found = self.found(truth);
        for (index, peg) in found.into_iter().enumerate() {
            let before = self.seated[index].take();
            let Some(peg) = peg else {
                self.rejected[index] = None;
                continue;
            };
            let name = self.names[peg].clone();
            self.rejected[index] =
                self.penetration_in(index, peg).map(|reason| Rejected { peg: name.clone(), reason });
            if self.rejected[index].is_none() {
                let before = before.filter(|before| before.peg == name);
                let now = Seated { peg: name, since: truth.time, thought };
                self.seated[index] = Some(before.unwrap_or(now));
            }
        }
    }

    /// Reads which parts were in each other since the last call; `truth` has the poses now. Those that were
    /// too deep reject the pegs of their connections until they have been apart. Before [`Referee::watch`]
    /// with the same truth.
    pub fn penetrated(&mut self, truth: &Truth, penetrations: &[Penetration]) {
        self.penetrations.add(truth, penetrations);
    }

    /// Reads the true poses, and the parts that are in each other, while the parts rest without the arm at
    /// the end: a peg that is not in its place then does not count.
    pub fn rested(&mut self, truth: &Truth, penetrations: &[Penetration]) {
        self.penetrations.add(truth, penetrations);
        let found = self.found(truth);
        for (index, peg) in found.into_iter().enumerate() {
            let Some(seated) = &self.seated[index] else { continue };
            let reason = match peg.filter(|peg| self.names[*peg] == seated.peg) {
                Some(peg) => self.penetration_in(index, peg),
                None => Some(Reason::Fell),
            };
            if let Some(reason) = reason {
                self.rejected[index] = Some(Rejected { peg: seated.peg.clone(), reason });
                self.seated[index] = None;
            }
        }
    }

    /// The verdict if the episode ended now, by connection.
    pub fn verdict(&self) -> &[Option<Seated>] {
        &self.seated
    }

    /// The pegs that are or were in their place at the last look, and do not count, by connection.
    pub fn rejected(&self) -> &[Option<Rejected>] {
        &self.rejected
    }

    /// The peg that pins each connection in this truth, as an index into the truth. A peg pins one connection
    /// at most: that for which it counted before, else the first.
    fn found(&self, truth: &Truth) -> Vec<Option<usize>> {
        let mut found = vec![None; self.required.len()];
        let mut used = Vec::new();
        for counted in [true, false] {
            for (index, place) in found.iter_mut().enumerate() {
                let before = self.seated[index].as_ref().map(|before| before.peg.as_str());
                if place.is_some() || counted && before.is_none() {
                    continue;
                }
                if let Required::Back { part, places } = &self.required[index] {
                    *place = truth.x_wp.get(*part).filter(|x_wp| places.holds(x_wp)).map(|_| *part);
                    continue;
                }
                let fits = |peg: &usize| {
                    (!counted || before == Some(&self.names[*peg]))
                        && !used.contains(peg)
                        && self.is_pinned(truth, index, *peg)
                };
                *place = self.pegs.iter().copied().find(fits);
                used.extend(*place);
            }
        }
        found
    }

    /// Whether this peg pins a connection in this truth.
    fn is_pinned(&self, truth: &Truth, connection: usize, peg: usize) -> bool {
        let Required::Pinned { female, male, p_b_female, p_b_male } = &self.required[connection] else {
            return false;
        };
        let beam = |joint: &JointRef| truth.x_wp.get(*self.beams.get(joint.beam)?);
        let (Some(x_female), Some(x_male), Some(x_peg)) = (beam(female), beam(male), truth.x_wp.get(peg))
        else {
            return false;
        };
        pins(x_peg, x_female, p_b_female, x_male, p_b_male)
    }

    /// The penetration for which this peg does not count in a connection: of its peg with anything, or of its
    /// two beams.
    fn penetration_in(&self, connection: usize, peg: usize) -> Option<Reason> {
        let Required::Pinned { female, male, .. } = &self.required[connection] else { return None };
        let beams = [female, male].map(|joint| self.beams[joint.beam]);
        let found = self
            .penetrations
            .deepest(|parts| parts.contains(&peg) || parts == beams || parts == [beams[1], beams[0]])?;
        let parts = found.parts.map(|part| self.names.get(part).cloned().unwrap_or_default());
        Some(Reason::Penetration { parts, depth: found.depth })
    }
}
