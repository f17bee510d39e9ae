//! The world as it would be before a step of a plan, a little different with every seed.
//!
//! Beams that stand are put at their places and pegs into their holes, which is free of contact to within the
//! parts' play. Physics then lets them hang as they do, and each beam is knocked, with a velocity that would
//! carry it about as far as beams are off in real builds; what the joints allow is what comes of it. All this
//! is before the episode's time begins, and after it nothing is moved by hand. A start that does not hold is
//! drawn again.

use std::f64::consts::FRAC_PI_6;

use nalgebra::{Point3, Translation3, UnitQuaternion, Vector3};
use ramp_kit::Pose;
use ramp_kit::joint::{CLEARANCE, FEMALE_HEIGHT};
use ramp_robot::RobotError;
use ramp_robot::random::Stream;
use ramp_twin::{Layout, SceneOptions, Setup, Twin, TwinError};
use ramp_world::groups::Parts;

use ramp_result::manipulation::Draw;

use super::task::{Aim, Task};
use super::world::{NamedTruth, far_end, pegs_in};

/// Largest turn of a peg that pins a connection, beside the steps of the hand, rad. Chosen: 1°.
const PEG_TURN: f64 = 0.017_453_292_519_943_295;
/// So many starts are drawn before a trial is given up.
const DRAWS: usize = 50;
/// Periods before the beams are knocked, and from then to the start.
const PERIODS: [u32; 2] = [400, 600];
/// How far the knock of a beam that stands as it should would carry it, m.
const ALIGNED: f64 = 1.0e-3;
/// How far it would turn one that the planner holds to be out of line, rad.
const MISALIGNED: f64 = 1.0 / 180.0 * std::f64::consts::PI;
/// How far it would turn the one that is to be pushed straight, rad.
const PUSHED: f64 = 3.0 / 180.0 * std::f64::consts::PI;
/// Deceleration of parts that slide on the table, m/s².
const FRICTION: f64 = 5.0;
/// Further deviation of a start, m: hanging and play.
const PLAY: f64 = 2.0e-3;
/// How far the ends of a beam may be above or below its place, m: one that only one female holds hangs by 3.3
/// mm. Printed faces add to the play in the female, and the beam hangs lower in proportion.
const HANG: f64 = 4.0e-3;
/// How far a part that nobody touched may have moved, m.
const UNTOUCHED: f64 = 0.5e-3;
/// Deepest penetration of a start, m.
const PENETRATION: f64 = 0.3e-3;
/// How far anything may move in the last tenth of a second, m.
const STILL: f64 = 0.05e-3;

/// Why there is no start.
#[derive(Debug, thiserror::Error)]
pub enum StartError {
    /// The twin cannot be made.
    #[error(transparent)]
    Twin(#[from] TwinError),
    /// None of those that were drawn holds.
    #[error("{goal}, step {step}: no start of {DRAWS} holds; the last one: {why}")]
    None {
        /// The goal.
        goal: String,
        /// The step.
        step: usize,
        /// Reason why the last one was refused.
        why: String,
    },
}

/// Which parts are in the scene of a trial.
#[derive(Clone, Debug, Default)]
pub struct Cast {
    /// The names of the beams and pegs that are there beside the clamped beam, with the holders of the pegs
    /// that do not pin; all of the kit without a list.
    pub only: Option<Vec<String>>,
    /// Parts that may be left out as well.
    pub options: SceneOptions,
}

impl Cast {
    /// Takes away what has no part in it.
    fn cut(&self, setup: &Setup, task: &Task, layout: &mut Layout) {
        let Some(only) = &self.only else { return };
        let base = &setup.assembly.beams[setup.assembly.base].beam.name;
        let there = |name: &String| name == base || only.contains(name);
        layout.beams.retain(|(name, _)| there(name));
        let pins = |peg: &String| task.build.pinned.iter().any(|(_, pinned)| pinned == peg);
        let in_holder = layout.in_holder.iter().filter(|(peg, _)| there(peg) && !pins(peg));
        let used: Vec<&String> = in_holder.map(|(_, holder)| holder).collect();
        layout.holders.retain(|(name, _)| used.contains(&name));
        layout.pegs.retain(|(name, _)| there(name));
    }
}

/// A start that holds.
pub struct Start {
    /// The world at its beginning.
    pub twin: Twin,
    /// Poses of all parts then.
    pub places: Vec<(String, Pose)>,
    /// How it came about.
    pub info: Draw,
}

/// Draws starts from the stream `start` of the setup's seed until one holds.
///
/// # Errors
/// When the twin cannot be made, or no start that is drawn holds.
pub fn draw(setup: &Setup, task: &Task, cast: &Cast) -> Result<Start, StartError> {
    let mut stream = Stream::new(setup.seed, "start");
    let mut why = String::new();
    for drawn in 1..=DRAWS {
        let mut layout = layout(setup, task, &mut stream);
        cast.cut(setup, task, &mut layout);
        let mut twin = Twin::with_options(setup, layout.clone(), &cast.options)?;
        // As the twin puts them.
        let physics = setup.world.draw(setup.seed);
        layout.tilt(&physics.table);
        let knocks = knocks(setup, task, &mut stream);
        let settled = settle(&mut twin, &knocks, &physics.parts);
        why = match settled {
            Err(why) => why,
            Ok(last) => match fit(setup, task, &layout, &twin, &last, &physics.parts) {
                Err(why) => why,
                Ok(displaced) => {
                    twin.begin();
                    let places = twin.part_names().map(str::to_string).zip(twin.truth().x_wp).collect();
                    return Ok(Start { twin, places, info: Draw { draws: drawn, displaced } });
                }
            },
        };
    }
    Err(StartError::None { goal: setup.assembly.name.clone(), step: task.step, why })
}

/// The sheet's layout, with what stands at its place.
fn layout(setup: &Setup, task: &Task, stream: &mut Stream) -> Layout {
    let assembly = setup.assembly;
    let x_wa = assembly.kit.x_wa();
    let mut layout = Layout::on_track(setup.assembly, setup.start, setup.track, setup.seed);
    for (name, x_wb) in &mut layout.beams {
        let Some(beam) = assembly.beam_index(name).filter(|beam| task.build.standing.contains(beam)) else {
            continue;
        };
        *x_wb = x_wa * assembly.beams[beam].x_ab;
        if let Some((_, shift)) = task.build.deep.iter().find(|(deep, _)| *deep == beam) {
            *x_wb = Translation3::from(x_wa.rotation * shift) * *x_wb;
        }
    }
    for (connection, peg) in &task.build.pinned {
        let hole = x_wa * assembly.p_a_hole(assembly.connections[*connection].female);
        // The hand turns in steps of 30°, and a square head looks the same after three of them.
        let turn = (3.0 * stream.uniform()).floor() * FRAC_PI_6 + stream.symmetric(PEG_TURN);
        if let Some((_, x_wp)) = layout.pegs.iter_mut().find(|(name, _)| name == peg) {
            let rotation = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), turn);
            let p = Translation3::new(hole.x, hole.y, hole.z + FEMALE_HEIGHT / 2.0);
            *x_wp = Pose::from_parts(p, rotation);
        }
    }
    layout
}

/// How far a beam that stands may be knocked, as a turn, rad.
fn range(setup: &Setup, task: &Task, beam: usize) -> f64 {
    if task.aim == (Aim::Straight { beam }) {
        PUSHED
    } else if task.build.misaligned.contains(&beam) {
        MISALIGNED
    } else {
        ALIGNED / setup.assembly.beams[beam].beam.span().max(ALIGNED)
    }
}

/// A knock: the velocity of a beam's origin, m/s, and its turn, rad/s, axes of the world.
type Knock = (String, Vector3<f64>, Vector3<f64>);

/// Displacement of each standing beam: it turns about the joint that a peg pins, or else is shifted
/// as well.
fn knocks(setup: &Setup, task: &Task, stream: &mut Stream) -> Vec<Knock> {
    let assembly = setup.assembly;
    let speed = |distance: f64| distance.signum() * (2.0 * FRICTION * distance.abs()).sqrt();
    let knock = |beam: &usize| {
        let placed = &assembly.beams[*beam];
        let range = range(setup, task, *beam);
        let (turn, shift) = (stream.symmetric(range), [stream.symmetric(ALIGNED), stream.symmetric(ALIGNED)]);
        let anchor = task.build.anchor(assembly, *beam);
        let about = anchor.map_or(placed.beam.span() / 2.0, |joint| placed.beam.joints[joint.joint].offset);
        let lever = about.max(placed.beam.span() - about);
        let angular = Vector3::z() * (speed(turn * lever) / lever);
        let x_wb = setup.assembly.kit.x_wa() * placed.x_ab;
        let arm = x_wb.rotation * Vector3::x() * -about;
        let mut linear = angular.cross(&arm);
        if anchor.is_none() {
            linear += Vector3::new(speed(shift[0]), speed(shift[1]), 0.0);
        }
        (placed.beam.name.clone(), linear, angular)
    };
    task.build.standing.iter().map(knock).collect()
}

/// Lets the world come to rest. Returns where all parts were a tenth of a second before, or why the start
/// does not hold.
fn settle(twin: &mut Twin, knocks: &[Knock], parts: &Parts) -> Result<Vec<Pose>, String> {
    let failed = |error: RobotError| error.to_string();
    twin.settle(PERIODS[0]).map_err(failed)?;
    // Two parts at their nominal places can be in each other by the errors of both, and part.
    let printed = 2.0 * (parts.face.max(parts.radius) + parts.length);
    check_penetration(twin, PENETRATION + printed)?;
    twin.begin();
    for (beam, linear, angular) in knocks {
        twin.knock(beam, linear, angular);
    }
    twin.settle(PERIODS[1] - 100).map_err(failed)?;
    let before = twin.truth().x_wp;
    twin.settle(100).map_err(failed)?;
    Ok(before)
}

/// Whether no two parts were deeper in each other than `most` (m) so far.
fn check_penetration(twin: &Twin, most: f64) -> Result<(), String> {
    let deepest = twin.deepest_penetration();
    if deepest > most { Err(format!("parts are {:.2} mm in each other", deepest * 1e3)) } else { Ok(()) }
}

/// How far an end of a beam that stands is from its place at most, m, or why a start does not hold; `last` is
/// where all parts were a tenth of a second before, `printed` the errors of the parts.
fn fit(
    setup: &Setup,
    task: &Task,
    layout: &Layout,
    twin: &Twin,
    last: &[Pose],
    printed: &Parts,
) -> Result<f64, String> {
    let (build, assembly) = (&task.build, setup.assembly);
    check_penetration(twin, PENETRATION)?;
    let moved = |a: &Pose, b: &Pose| (a.translation.vector - b.translation.vector).norm();
    let world = NamedTruth::of(setup, twin);
    let parts = || twin.part_names().zip(twin.truth().x_wp);
    for ((name, x_wp), before) in parts().zip(last) {
        if moved(&x_wp, before) > STILL {
            return Err(format!("{name} does not come to rest"));
        }
    }
    let seated = pegs_in(setup, twin);
    for (connection, peg) in &build.pinned {
        if seated[*connection].as_deref() != Some(peg) {
            return Err(format!("{peg} does not pin {}", assembly.connections[*connection].name));
        }
    }
    // Two faces of either part.
    let hang = HANG * (1.0 + 4.0 * printed.face / (2.0 * CLEARANCE));
    let mut displaced: f64 = 0.0;
    for &beam in &build.standing {
        let placed = &assembly.beams[beam].beam;
        let deep = build.deep.iter().find(|(deep, _)| *deep == beam);
        let shift = deep.map_or(Vector3::zeros(), |(_, shift)| world.x_wa.rotation * shift);
        let x_wb = world.part(&placed.name);
        let most = range(setup, task, beam) * placed.span() + PLAY;
        for x in [0.0, placed.span(), far_end(task, assembly, beam)] {
            let p = Point3::new(x, 0.0, 0.0);
            let off = x_wb * p - (world.nominal(beam, &p) + shift);
            displaced = displaced.max(off.xy().norm());
            if off.xy().norm() > most || off.z.abs() > hang {
                return Err(format!("{} is {:.1} mm from its place", placed.name, off.norm() * 1e3));
            }
        }
    }
    let used = |name: &str| {
        let stands = assembly.beam_index(name).is_some_and(|beam| build.standing.contains(&beam));
        stands || build.pinned.iter().any(|(_, peg)| peg == name)
    };
    let placed = layout.beams.iter().chain(&layout.pegs).filter(|(name, _)| !used(name));
    for (name, x_wp) in placed {
        if moved(&world.part(name), x_wp) > UNTOUCHED {
            return Err(format!("{name} has left its place on the sheet"));
        }
    }
    Ok(displaced)
}
