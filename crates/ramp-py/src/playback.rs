//! Episodes again from their logs, sample by sample, for data sets; and the cameras of small images.

use std::path::PathBuf;

use numpy::{IntoPyArray, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use ramp_episode::Progress;
use ramp_episode::replay::{LoggedSetup, replay_watched};
use ramp_gym::{Pictures, Sample, Sampler, View};
use ramp_log::Log;
use ramp_robot::camera::Mount;
use ramp_robot::{Camera, EventKind};
use ramp_twin::Twin;
use serde_json::{Value, json};

use crate::convert::{camera as camera_of, picture, seven};
use crate::errors::{Raised, detached, input};
use crate::files::Benchmark;
use crate::integers;

/// The facts in a log about its episode, as JSON.
fn facts(log: &Log, setup: &LoggedSetup) -> Value {
    let (header, result) = (&log.header, &log.result);
    let begun = result.events.iter().filter_map(|event| match &event.kind {
        EventKind::ActionBegun(action) => Some(json!({ "t": event.time, "action": action.to_string() })),
        _ => None,
    });
    json!({
        "sha256": log.sha256,
        "goal": header.goal.name,
        "arm": result.arm,
        "world": header.world.name,
        "touch": setup.world.has_touch(),
        "start": header.start.name,
        "track": header.track,
        "seed": header.seed,
        "fault": header.fault,
        "agent": format!("{} {}", result.agent.name, result.agent.version),
        "version": header.software.version,
        "completion": result.completion,
        "pegs": result.pegs.iter().map(|peg| peg.as_ref().map(|peg| peg.t_robot)).collect::<Vec<_>>(),
        "robot_time": result.time.robot,
        "state": result.physics.as_ref().map(|it| it.state.clone()),
        "actions": begun.collect::<Vec<_>>(),
    })
}

/// The facts of a log as JSON. Its episode does not run again.
#[pyfunction]
pub fn log_facts(py: Python<'_>, log: PathBuf) -> PyResult<String> {
    detached(py, || {
        let log = Log::read(&log).map_err(input)?;
        let setup = LoggedSetup::of(&log).map_err(input)?;
        Ok(facts(&log, &setup).to_string())
    })
}

/// Runs the episode of a log again, and compares each bit. `see` gets each sample, with images of `size`
/// pixels a side and with their `depth`. Returns the facts of the log as JSON, with `equal`, and in
/// `differences` what differs.
#[pyfunction]
#[pyo3(signature = (log, see=None, *, periods=50, size=None, depth=false))]
pub fn play_log(
    py: Python<'_>,
    log: PathBuf,
    see: Option<Py<PyAny>>,
    #[pyo3(from_py_with = integers::periods)] periods: u32,
    size: Option<usize>,
    depth: bool,
) -> PyResult<String> {
    if periods == 0 {
        return Err(input("periods: found 0, expected a positive number"));
    }
    let pictures = size.map(|size| Pictures { size, depth });
    let raised = Raised::default();
    let played = detached(py, || {
        let log = Log::read(&log).map_err(input)?;
        let world = LoggedSetup::of(&log).map_err(input)?;
        let mut sampler = match &see {
            Some(_) => Some(Sampler::new(&world.assembly, &world.arm, periods, pictures).map_err(input)?),
            None => None,
        };
        let mut watcher = |_: &Progress, twin: &Twin| {
            let (Some(sampler), Some(see)) = (&mut sampler, &see) else { return };
            if raised.is_there() {
                return;
            }
            let due = match sampler.due(twin) {
                Ok(due) => due,
                Err(error) => return raised.keep(input(error)),
            };
            for sample in due {
                if let Err(error) = Python::attach(|py| show(py, see, sample, size)) {
                    raised.keep(error);
                }
            }
        };
        let replayed = replay_watched(&log, &world, &mut watcher).map_err(input)?;
        let mut told = facts(&log, &world);
        told["equal"] = replayed.is_equal().into();
        let differences = replayed.differences.iter().map(|it| {
            format!("{:.3} s: {}: {} in the log, {} in the replay", it.time, it.what, it.logged, it.replayed)
        });
        told["differences"] = differences.collect::<Vec<_>>().into();
        Ok(told.to_string())
    });
    match raised.take() {
        Some(error) => Err(error),
        None => played,
    }
}

/// Calls a function of Python with a sample.
fn show(py: Python<'_>, see: &Py<PyAny>, sample: Sample, size: Option<usize>) -> PyResult<()> {
    let seen = sample.seen;
    let dict = PyDict::new(py);
    dict.set_item("time", seen.time)?;
    dict.set_item("positions", seen.positions.to_vec().into_pyarray(py))?;
    dict.set_item("velocities", seen.velocities.to_vec().into_pyarray(py))?;
    dict.set_item("torques", seen.torques.to_vec().into_pyarray(py))?;
    dict.set_item("tip", seven(&seen.x_wt).into_pyarray(py))?;
    dict.set_item("width", vec![seen.width].into_pyarray(py))?;
    dict.set_item("wrench", seen.wrench.as_slice().to_vec().into_pyarray(py))?;
    if let Some(touch) = &seen.touch {
        let force: Vec<f64> = touch.fingers.iter().flat_map(|finger| finger.force.iter().copied()).collect();
        let centre = touch.fingers.iter().flat_map(|finger| finger.centre.unwrap_or_default());
        dict.set_item("touch_force", force.into_pyarray(py))?;
        dict.set_item("touch_centre", centre.collect::<Vec<f64>>().into_pyarray(py))?;
    }
    let mut target = sample.joints.to_vec();
    target.push(sample.gripper.width);
    dict.set_item("target", target.into_pyarray(py))?;
    let size = size.unwrap_or_default();
    for (camera, units) in Camera::ALL.into_iter().zip(sample.depths) {
        let distances = units.into_pyarray(py).reshape([size, size, 1])?;
        dict.set_item(format!("{}-depth", camera.name()), distances)?;
    }
    for (camera, pixels) in Camera::ALL.into_iter().zip(sample.images) {
        dict.set_item(camera.name(), picture(py, pixels, [size, size])?)?;
    }
    see.call1(py, (dict,)).map(drop)
}

/// The lens and the mounting of a camera's square images of `size` pixels a side, as JSON.
#[pyfunction]
pub fn view_lens(
    benchmark: &Bound<'_, Benchmark>,
    camera: &str,
    #[pyo3(from_py_with = integers::size)] size: usize,
) -> PyResult<String> {
    let camera = camera_of(camera)?;
    let lens = View { camera, size, depth: false }.lens(benchmark.get().inner.arm.hand.tip);
    let (frame, pose) = match lens.mount {
        Mount::Tip(x_tc) => ("tip", x_tc),
        Mount::World(x_wc) => ("world", x_wc),
    };
    let told = json!({
        "width": lens.width,
        "height": lens.height,
        "focal": lens.focal,
        "centre": lens.centre,
        "distortion": lens.distortion,
        "frame": frame,
        "pose": seven(&pose),
    });
    Ok(told.to_string())
}
