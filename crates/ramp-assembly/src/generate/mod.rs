//! New goals in any number: random, reproducible from the seed, and each of them checked.
//!
//! If the kit has enough beams, a goal is grown from the clamped beam. A beam is placed where one
//! of its joints meets a joint of a placed beam; all other joints that meet there are connected
//! too. Candidates that overlap or cannot be built are discarded. Larger goals are frames
//! (`frame`), for which the kit is extended.
//!
//! `draft` grows a goal and `frame` constructs one, each with the `dice` of the seed. `goal_file`
//! writes the goal, and it is read back like any other. [`open`] draws whole sets of goals.

mod dice;
mod draft;
mod frame;
mod goal_file;
pub mod open;
mod request;

pub use request::{GenerateError, Generated, Request};

use self::dice::Dice;
use self::draft::Draft;
use self::goal_file::goal_name;
use crate::assembly::{Assembly, Class};
use ramp_kit::Kit;
use std::collections::HashSet;

/// Number of attempts per goal.
const ATTEMPTS: usize = 4000;
/// Millimetres in a metre.
const MM: f64 = 1e3;

/// Generates a goal.
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
/// An invalid request, or no goal found.
pub fn generate(kit: &Kit, request: Request) -> Result<Generated, GenerateError> {
    let Request { beams, seed, class } = request;
    if !(2..=crate::check::MAX_BEAMS).contains(&beams) {
        return Err(GenerateError::Beams { found: beams });
    }
    if class.is_some_and(Class::is_open) {
        return Err(GenerateError::Open);
    }
    let base = clamped(kit)?;
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
            Some(Class::Open(_)) => false,
        };
        if !could_be || (!kit.pegs.is_empty() && draft.pairs.len() > kit.pegs.len()) {
            continue;
        }
        let class = class.unwrap_or_else(|| draft.likely_class());
        if let Some(made) = draft.finish(kit, &goal_name(class, request), class) {
            return Ok(made);
        }
    }
    Err(GenerateError::NotFound { beams, seed, class })
}

/// The beam on which a goal grows, by index.
fn clamped(kit: &Kit) -> Result<usize, GenerateError> {
    kit.beams.iter().position(|beam| beam.start.is_none()).ok_or(GenerateError::NoBase)
}

/// Generates `count` different goals from the seeds `first.seed`, `first.seed + 1`, ….
///
/// # Errors
/// As [`generate`]; and when the kit has fewer different goals.
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

/// The identity of a goal: its connections and the poses of its beams, without names and order in
/// the file.
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
