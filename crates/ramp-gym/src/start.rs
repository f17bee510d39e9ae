//! The start of an episode, and a pool of starts that many environments share.
//!
//! A start is a twin that is never stepped: an episode gets a copy of its state, which takes microseconds.
//! Every seed has a scene of its own, since holders stand a little elsewhere, so a start keeps its own model.

use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use ramp_abilities::manipulation::{Aim, StartError, draw, missing};
use ramp_kit::Pose;
use ramp_robot::GripperCommand;
use ramp_robot::random::Stream;
use ramp_twin::{Layout, Setup, Twin, TwinError};

use crate::cast::{cut, standing, whole};
use crate::known::Known;
use crate::ready::bring;
use crate::scenario::{Begin, Frame, Mission, Scenario};

/// So many starts are tried before an episode is given up: the baseline does not always get to where a skill
/// begins.
const TRIES: u64 = 20;
/// So many starts are kept at most.
pub(crate) const KEPT: usize = 1024;

/// Why there is no start.
#[derive(Debug, Clone, thiserror::Error)]
pub enum BeginError {
    /// The twin cannot be made, or no start of the task holds.
    #[error("{0}")]
    Start(String),
    /// The baseline never got to where the skill begins.
    #[error(
        "{skill}, seed {seed}: none of {TRIES} starts got to where the skill begins; the last one: {why}"
    )]
    Ready {
        /// The skill.
        skill: String,
        /// The seed.
        seed: u64,
        /// Reason of the last failure.
        why: String,
    },
}

impl From<TwinError> for BeginError {
    fn from(error: TwinError) -> BeginError {
        BeginError::Start(error.to_string())
    }
}

impl From<StartError> for BeginError {
    fn from(error: StartError) -> BeginError {
        BeginError::Start(error.to_string())
    }
}

/// The start of an episode.
pub struct Prepared {
    /// Never stepped.
    pub twin: Twin,
    /// The seed of its scene.
    pub seed: u64,
    /// Indices of the goal and of the step in the scenario; the step is 0 for a whole goal.
    pub task: (usize, usize),
    /// Poses of all parts at the start, in the form that the judge of the task needs.
    pub places: Vec<(String, Pose)>,
    /// The agent's knowledge; `None` for a whole goal.
    pub known: Option<Known>,
}

/// Makes the start with this seed.
pub(crate) fn prepare(scenario: &Scenario, seed: u64) -> Result<Prepared, BeginError> {
    let benchmark = &scenario.benchmark;
    let Mission::Skill { steps, name } = &scenario.mission else {
        let setup = scenario.setup(0, seed);
        let layout = Layout::on_track(setup.assembly, setup.start, setup.track, seed);
        let twin = Twin::with_options(&setup, layout, &whole().options)?;
        let places = twin.part_names().map(str::to_string).zip(twin.truth().x_wp).collect();
        return Ok(Prepared { twin, seed, task: (0, 0), places, known: None });
    };
    let mut again = Stream::new(seed, "another start");
    let mut own = seed;
    let mut why = String::new();
    for _ in 0..TRIES {
        let task = crate::tasks::draw(steps, own).unwrap_or_default();
        let setup = scenario.setup(task.0, own);
        let step = &scenario.goals[task.0].steps[task.1];
        let cast = if scenario.whole_scene { whole() } else { cut(setup.assembly, step) };
        let start = match draw(&setup, &step.task, &cast) {
            Err(StartError::None { why: last, .. }) if scenario.begin == Begin::Ready => {
                why = last;
                own = next(&mut again);
                continue;
            }
            start => start?,
        };
        let (mut twin, places) = (start.twin, start.places);
        if scenario.frame == Frame::Rigid {
            twin = twin.with_rigid(&setup, standing(setup.assembly, step), &cast.options)?;
        }
        if scenario.begin == Begin::Home {
            let known = nominal(&setup, &step.task.aim, &twin);
            return Ok(Prepared { twin, seed: own, task, places, known: Some(known) });
        }
        match bring(benchmark, &setup, step, &mut twin) {
            // A start at which the task is already done teaches nothing.
            Ok(_) if missing(&setup, &step.task, &places, &twin).is_none() => {
                why = "it is done before it begins".to_string();
            }
            Ok(known) => {
                twin.begin();
                return Ok(Prepared { twin, seed: own, task, places, known: Some(known) });
            }
            Err(error) => why = error,
        }
        own = next(&mut again);
    }
    Err(BeginError::Ready { skill: name.clone(), seed, why })
}

/// The next seed that is tried.
fn next(again: &mut Stream) -> u64 {
    (again.uniform() * (1u64 << 53) as f64) as u64
}

/// Knowledge with the arm at home and before any look: the parts are at their poses of sheet and goal.
fn nominal(setup: &Setup, aim: &Aim, twin: &Twin) -> Known {
    let assembly = setup.assembly;
    let kit = &assembly.kit;
    let beam = |index: usize| {
        let placed = &assembly.beams[index];
        let start = kit.x_wb_start(&placed.beam).unwrap_or_default();
        (placed.beam.name.clone(), start, kit.x_wa() * placed.x_ab)
    };
    let (part, x_wp, x_goal) = match aim {
        Aim::Held { peg } => {
            let place = kit.pegs.iter().find(|it| it.name == *peg).and_then(|it| kit.x_wp_start(it));
            (peg.clone(), place.unwrap_or_default(), place.unwrap_or_default())
        }
        Aim::Pinned { connection } => {
            let hole = kit.x_wa() * assembly.p_a_hole(assembly.connections[*connection].female);
            let up = ramp_kit::joint::FEMALE_HEIGHT / 2.0;
            let goal = Pose::translation(hole.x, hole.y, hole.z + up);
            (assembly.connections[*connection].name.clone(), goal, goal)
        }
        Aim::Placed { connections } => {
            let first = connections.first().map_or(assembly.base, |it| assembly.connections[*it].male.beam);
            beam(first)
        }
        Aim::Deep { beam: index, .. } | Aim::Laid { beam: index } | Aim::Straight { beam: index } => {
            beam(*index)
        }
    };
    let seen = ramp_robot::Robot::observe(twin);
    let gripper = GripperCommand { width: seen.width, force: 20.0 };
    Known { held: None, part, x_wp, x_goal, gripper, posture: seen.positions }
}

/// A start, or why there is none, once it is known.
type Slot = Arc<OnceLock<Result<Arc<Prepared>, BeginError>>>;

/// Starts that were made so far, by the seed that was asked for.
#[derive(Default)]
pub(crate) struct Pool {
    starts: Mutex<BTreeMap<u64, Slot>>,
}

impl Pool {
    /// The start with this seed: made, if it is not there. A thread that asks for one that another makes
    /// waits for it.
    pub fn get(&self, scenario: &Scenario, seed: u64) -> Result<Arc<Prepared>, BeginError> {
        let slot = {
            let mut starts = self.starts.lock().unwrap_or_else(PoisonError::into_inner);
            let full = starts.len() >= KEPT;
            match starts.get(&seed) {
                Some(slot) => Arc::clone(slot),
                None if full => Slot::default(),
                None => Arc::clone(starts.entry(seed).or_default()),
            }
        };
        slot.get_or_init(|| prepare(scenario, seed).map(Arc::new)).clone()
    }

    /// Makes the starts with these seeds, on so many threads.
    ///
    /// # Errors
    /// The first seed without a start, once all are made.
    pub fn fill(&self, scenario: &Scenario, seeds: Range<u64>, threads: usize) -> Result<(), BeginError> {
        let next = AtomicU64::new(seeds.start);
        std::thread::scope(|scope| {
            for _ in 0..threads.max(1) {
                scope.spawn(|| {
                    loop {
                        let seed = next.fetch_add(1, Ordering::Relaxed);
                        if !seeds.contains(&seed) {
                            return;
                        }
                        // An error is kept with its seed.
                        let _ = self.get(scenario, seed);
                    }
                });
            }
        });
        let starts = self.starts.lock().unwrap_or_else(PoisonError::into_inner);
        let failed = |slot: &Slot| slot.get().and_then(|made| made.as_ref().err()).cloned();
        starts.range(seeds).find_map(|(_, slot)| failed(slot)).map_or(Ok(()), Err)
    }
}
