//! The compiled module of the Python package `ramp`: only conversion. What it does is in the other crates,
//! what its users see is above it, in `python/ramp`.

mod convert;
mod driver;
mod episode;
mod errors;
mod files;
mod finder;
mod given;
mod gym;
mod integers;
mod planner;
mod playback;
mod robot;
mod twin;

use pyo3::prelude::*;

/// The compiled part of the package `ramp`.
#[pymodule]
fn _ramp(module: &Bound<'_, PyModule>) -> PyResult<()> {
    let py = module.py();
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add("InputError", py.get_type::<errors::InputError>())?;
    module.add("PlanningError", py.get_type::<errors::PlanningError>())?;
    module.add("Recovered", py.get_type::<errors::Recovered>())?;
    module.add("RobotStopped", py.get_type::<errors::RobotStopped>())?;
    module.add("Refused", py.get_type::<errors::Refused>())?;
    module.add_class::<files::Benchmark>()?;
    module.add_class::<convert::Command>()?;
    module.add_class::<convert::Observation>()?;
    module.add_class::<convert::CameraImage>()?;
    module.add_class::<robot::Robot>()?;
    module.add_class::<twin::Twin>()?;
    module.add_class::<twin::Snapshot>()?;
    module.add_class::<driver::Driver>()?;
    module.add_class::<gym::Env>()?;
    module.add_class::<gym::Batch>()?;
    module.add_class::<gym::EpisodePictures>()?;
    module.add_function(wrap_pyfunction!(episode::run, module)?)?;
    module.add_function(wrap_pyfunction!(episode::curve_svg, module)?)?;
    module.add_function(wrap_pyfunction!(episode::current_result, module)?)?;
    module.add_function(wrap_pyfunction!(episode::check_event, module)?)?;
    module.add_function(wrap_pyfunction!(episode::describe_event, module)?)?;
    module.add_function(wrap_pyfunction!(playback::log_facts, module)?)?;
    module.add_function(wrap_pyfunction!(playback::play_log, module)?)?;
    module.add_function(wrap_pyfunction!(playback::view_lens, module)?)?;
    Ok(())
}
