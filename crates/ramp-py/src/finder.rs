//! Finders of parts in Python, in place of the baseline's.

use std::sync::{Arc, Mutex};

use pyo3::prelude::*;
use pyo3::types::PyBytes;
use ramp_external_agent::finder_message::{names_of, question_text, read_answer};
use ramp_skills::Baseline;
use ramp_skills::belief::own_finder::{OwnAnswer, Question};
use ramp_twin::Setup;

use crate::errors::{Raised, input};

/// The baseline with a finder in Python and its name, if there is one. The finder gets the question as
/// JSON, the pixels and the depths as bytes, and returns its answer as JSON.
///
/// # Errors
/// A track without images.
pub fn finding<'a>(
    baseline: Baseline<'a>,
    setup: &Setup,
    finder: Option<(Py<PyAny>, String)>,
    raised: &Raised,
) -> PyResult<Baseline<'a>> {
    let Some((object, name)) = finder else { return Ok(baseline) };
    if !setup.track.gives_images() {
        return Err(input(format!("a finder reads images, and track `{}` gives none", setup.track.name())));
    }
    let (names, raised) = (names_of(&setup.assembly.kit), raised.clone());
    let ask = move |question: &Question| -> Result<OwnAnswer, String> {
        let text = question_text(question).to_string();
        let answer = Python::attach(|py| {
            let pixels = PyBytes::new(py, &question.image.pixels);
            let depth =
                question.image.depth.as_ref().map(|_| PyBytes::new(py, &question.image.depth_bytes()));
            object.bind(py).call1((text, pixels, depth)).and_then(|text| text.extract::<String>())
        });
        let text = answer.map_err(|error| {
            let why = error.to_string();
            raised.keep(error);
            why
        })?;
        read_answer(text.as_bytes(), &names).map_err(|why| format!("the finder {why}"))
    };
    Ok(baseline.with_finder(Arc::new(Mutex::new(ask)), &name))
}
