//! Integers of Python. One that is out of range is bad input, like every other bad number.

use std::fmt::Display;

use pyo3::exceptions::PyOverflowError;
use pyo3::prelude::*;

use crate::errors::input;

/// The integer `value` of the argument `name`, from `least` to `most`.
///
/// # Errors
/// `InputError` if it is out of range, `TypeError` if it is no integer.
fn integer<T>(value: &Bound<'_, PyAny>, name: &str, least: T, most: T) -> PyResult<T>
where
    T: for<'a, 'py> FromPyObject<'a, 'py, Error = PyErr> + PartialOrd + Display,
{
    match value.extract::<T>() {
        Ok(number) if least <= number && number <= most => Ok(number),
        Err(error) if !error.is_instance_of::<PyOverflowError>(value.py()) => Err(error),
        _ => Err(input(format!("{name}: found {value}, expected an integer from {least} to {most}"))),
    }
}

/// A seed.
pub fn seed(value: &Bound<'_, PyAny>) -> PyResult<u64> {
    integer(value, "seed", 0, u64::MAX)
}

/// A seed, or none.
pub fn maybe_seed(value: &Bound<'_, PyAny>) -> PyResult<Option<u64>> {
    if value.is_none() { Ok(None) } else { seed(value).map(Some) }
}

/// The number of an episode among several.
pub fn repeat(value: &Bound<'_, PyAny>) -> PyResult<u32> {
    integer(value, "repeat", 1, u32::MAX)
}

/// Control periods of 1 ms, at most those of an episode.
pub fn periods(value: &Bound<'_, PyAny>) -> PyResult<u32> {
    integer(value, "periods", 0, 1_800_000)
}

/// Pixels along each side of an image.
pub fn size(value: &Bound<'_, PyAny>) -> PyResult<usize> {
    let [least, most] = ramp_gym::pictures::SIZES;
    integer(value, "size", least, most)
}

/// The number of a view.
pub fn view(value: &Bound<'_, PyAny>) -> PyResult<usize> {
    integer(value, "view", 0, usize::MAX)
}

/// Number of environments.
pub fn environments(value: &Bound<'_, PyAny>) -> PyResult<usize> {
    integer(value, "num_envs", 1, 4096)
}

/// Number of threads.
pub fn threads(value: &Bound<'_, PyAny>) -> PyResult<usize> {
    integer(value, "threads", 1, 1024)
}
