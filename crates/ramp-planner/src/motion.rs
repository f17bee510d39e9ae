//! Motion facts: limits of the arm and the hand, each with its reason.
//!
//! A client that knows the arm finds them before anything moves, or when a skill fails, and adds
//! them to [`State::motion`](crate::State). Here their names are resolved. The planner's geometry
//! asks [`Motion`] for possible grasps and open insertion paths; `facts` passes them to the rules.

use crate::error::PlanError;
use ramp_assembly::Assembly;
use ramp_source::nearest;
use serde::{Deserialize, Serialize};
use std::fmt::{self, Display};

/// Something that the arm or the hand cannot do, with the reason.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MotionFact {
    /// The impossible action.
    pub cannot: Impossible,
    /// The beam in the way; without one it is impossible in any state.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub past: Option<InTheWay>,
    /// The reason in a few words, such as `the fingers would touch b3`.
    pub because: String,
}

/// An impossible action.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Impossible {
    /// Grasping a beam at a link.
    Grasp {
        /// The beam.
        beam: String,
        /// Its link.
        link: String,
        /// The pose.
        at: End,
    },
    /// Inserting a beam along a path.
    Insert {
        /// The beam.
        beam: String,
        /// The name of the path, as in [`Entry::path`](crate::Entry).
        path: String,
    },
    /// Pinning a connection.
    Fasten {
        /// Its name in the goal.
        connection: String,
    },
}

/// A beam in the way, by name.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum InTheWay {
    /// In the assembly.
    Stands(String),
    /// At its start pose.
    OnSheet(String),
}

impl InTheWay {
    fn beam(&self) -> &str {
        match self {
            InTheWay::Stands(beam) | InTheWay::OnSheet(beam) => beam,
        }
    }
}

/// Start or goal pose of a beam.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum End {
    /// The start pose.
    Start,
    /// The goal pose.
    Place,
}

impl Display for MotionFact {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.cannot {
            Impossible::Grasp { beam, link, at } => {
                let place = match at {
                    End::Start => "in its start pose",
                    End::Place => "in its goal pose",
                };
                write!(f, "{beam} cannot be grasped at {link} {place}")?;
            }
            Impossible::Insert { beam, path } => {
                write!(f, "{beam} cannot be inserted along the path {path}")?
            }
            Impossible::Fasten { connection } => write!(f, "{connection} cannot be fastened")?,
        }
        if let Some(past) = &self.past {
            match past {
                InTheWay::Stands(beam) => write!(f, " once {beam} is placed")?,
                InTheWay::OnSheet(beam) => write!(f, " while {beam} is at its start pose")?,
            }
        }
        write!(f, ": {}", self.because)
    }
}

impl MotionFact {
    /// The same limit for an assembly that may lack some of the beams. A beam that it lacks stays where it
    /// lies: it is always in the way on the sheet, and never in the assembly. `None` where the limit says
    /// nothing then.
    pub fn of(&self, assembly: &Assembly) -> Option<MotionFact> {
        let has = |beam: &str| assembly.beam_index(beam).is_some();
        let about = match &self.cannot {
            Impossible::Grasp { beam, .. } | Impossible::Insert { beam, .. } => has(beam),
            Impossible::Fasten { connection } => assembly.connection_index(connection).is_some(),
        };
        let past = match &self.past {
            Some(InTheWay::OnSheet(beam)) if !has(beam) => None,
            Some(InTheWay::Stands(beam)) if !has(beam) => return None,
            past => past.clone(),
        };
        about.then(|| MotionFact { past, ..self.clone() })
    }

    /// What a planner can do about it, in one sentence.
    pub fn remedy(&self) -> String {
        let first = match &self.past {
            Some(InTheWay::Stands(beam)) => format!(", or do it before {beam} is placed"),
            Some(InTheWay::OnSheet(beam)) => format!(", or place {beam} first"),
            None => String::new(),
        };
        match &self.cannot {
            Impossible::Grasp { beam, .. } => format!("grasp {beam} at another link{first}"),
            Impossible::Insert { beam, .. } => format!("insert {beam} from another direction{first}"),
            Impossible::Fasten { connection } => match &self.past {
                Some(_) => format!("fasten {connection} at another moment{first}"),
                None => format!("no plan fastens {connection}: change the goal"),
            },
        }
    }
}

/// A beam in the way, by index: in the assembly, or at its start pose.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Obstructing {
    pub(crate) beam: usize,
    pub(crate) stands: bool,
}

/// Whether it is in the way of the placed beams. An unconditional limit always is.
fn obstructs(past: Option<Obstructing>, stands: &[bool]) -> bool {
    past.is_none_or(|past| stands[past.beam] == past.stands)
}

/// Motion facts with their names resolved.
#[derive(Clone, Default)]
pub(crate) struct Motion {
    /// The facts as received.
    pub(crate) facts: Vec<MotionFact>,
    /// The beam, its link, the pose, and the beam in the way.
    grasps: Vec<(usize, String, End, Option<Obstructing>)>,
    /// The beam, its path and the beam in the way.
    paths: Vec<(usize, usize, Option<Obstructing>)>,
    /// The connection and the beam in the way.
    pub(crate) fastenings: Vec<(usize, Option<Obstructing>)>,
}

impl Motion {
    /// Resolves the names of some facts.
    pub(crate) fn look_up(assembly: &Assembly, facts: &[MotionFact]) -> Result<Motion, PlanError> {
        let mut motion = Motion { facts: facts.to_vec(), ..Motion::default() };
        let unknown =
            |kind: &'static str, name: &str, place: &str, nearest: Option<&str>| PlanError::UnknownName {
                kind,
                name: name.to_string(),
                place: place.to_string(),
                nearest: nearest.map(str::to_string),
            };
        let beam = |name: &str| {
            let names = assembly.beams.iter().map(|placed| placed.beam.name.as_str());
            assembly
                .beam_index(name)
                .ok_or_else(|| unknown("beam", name, &assembly.name, nearest(name, names)))
        };
        for fact in facts {
            let past = fact.past.as_ref().map(|past| {
                Ok::<_, PlanError>(Obstructing {
                    beam: beam(past.beam())?,
                    stands: matches!(past, InTheWay::Stands(_)),
                })
            });
            let past = past.transpose()?;
            match &fact.cannot {
                Impossible::Grasp { beam: name, link, at } => {
                    let index = beam(name)?;
                    let links = || assembly.beams[index].beam.links.iter().map(|link| link.name.as_str());
                    if !links().any(|other| other == link) {
                        return Err(unknown("link", link, name, nearest(link, links())));
                    }
                    motion.grasps.push((index, link.clone(), *at, past));
                }
                Impossible::Insert { beam: name, path } => {
                    let index = beam(name)?;
                    let paths = || assembly.paths.ways(index).iter().map(|way| way.name);
                    let number = paths().position(|other| other == path);
                    let number = number.ok_or_else(|| unknown("path", path, name, nearest(path, paths())))?;
                    motion.paths.push((index, number, past));
                }
                Impossible::Fasten { connection } => {
                    let names = assembly.connections.iter().map(|connection| connection.name.as_str());
                    let index = assembly.connection_index(connection).ok_or_else(|| {
                        unknown("connection", connection, &assembly.name, nearest(connection, names))
                    })?;
                    motion.fastenings.push((index, past));
                }
            }
        }
        Ok(motion)
    }

    /// The placed beams that prevent some grasp of a beam at its goal pose.
    pub(crate) fn grasps_barred_by(&self, beam: usize) -> impl Iterator<Item = usize> + '_ {
        let barred =
            self.grasps.iter().filter(move |(other, _, end, _)| *other == beam && *end == End::Place);
        barred.filter_map(|(_, _, _, past)| past.filter(|past| past.stands).map(|past| past.beam))
    }

    /// Whether a hand can grasp a beam at a link in its start or goal pose, with other beams
    /// placed.
    pub(crate) fn allows_grasp(&self, beam: usize, link: &str, at: End, stands: &[bool]) -> bool {
        !self.grasps.iter().any(|(other, name, end, past)| {
            *other == beam && name == link && *end == at && obstructs(*past, stands)
        })
    }

    /// Whether a beam can be inserted along a path, with other beams placed.
    pub(crate) fn allows_path(&self, beam: usize, path: usize, stands: &[bool]) -> bool {
        !self
            .paths
            .iter()
            .any(|(other, number, past)| *other == beam && *number == path && obstructs(*past, stands))
    }

    /// The beams that block a path of a beam; `None` when it is always blocked.
    pub(crate) fn closed_by(
        &self,
        beam: usize,
        path: usize,
    ) -> impl Iterator<Item = Option<Obstructing>> + '_ {
        let closed = self.paths.iter().filter(move |(other, number, _)| *other == beam && *number == path);
        closed.map(|(_, _, past)| *past)
    }

    /// The reasons, as text, for an error.
    pub(crate) fn reasons(&self) -> String {
        self.facts.iter().map(MotionFact::to_string).collect::<Vec<_>>().join("; ")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// For the rest of a frame, a beam that is left on the sheet is always in the way there.
    #[test]
    fn a_limit_is_told_for_the_rest_of_an_assembly() -> Result<(), Box<dyn std::error::Error>> {
        let kit = ramp_kit::read_kit("../../data/kit.xml".as_ref())?;
        let whole = ramp_assembly::read_goal("../../data/goals/easy-1.xml".as_ref(), &kit)?;
        let left = whole.beam_index("b4").ok_or("no b4")?;
        let rest = whole.of_beams(|beam| beam != left).ok_or("no rest")?;
        let fact = |beam: &str, past: Option<InTheWay>| {
            let [beam, link] = [beam, "b5l2"].map(str::to_string);
            let cannot = Impossible::Grasp { beam, link, at: End::Start };
            MotionFact { cannot, past, because: "the fingers would touch b4".to_string() }
        };
        let [stands, lies] = [InTheWay::Stands("b4".into()), InTheWay::OnSheet("b4".into())];
        assert_eq!(fact("b5", Some(lies.clone())).of(&rest), Some(fact("b5", None)));
        assert_eq!(fact("b5", Some(stands)).of(&rest), None);
        assert_eq!(fact("b4", None).of(&rest), None);
        let fasten =
            MotionFact { cannot: Impossible::Fasten { connection: "C1".into() }, ..fact("b5", None) };
        assert_eq!(fasten.of(&rest), None);
        let kept = fact("b5", Some(lies));
        assert_eq!(kept.of(&whole), Some(kept));
        Ok(())
    }
}
