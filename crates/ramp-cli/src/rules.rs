//! Reads the planning rules within limits.

use std::path::Path;

use miette::Report;
use ramp_data::Data;
use ramp_planner::{Domains, Limits};

use crate::ending::end_planning;

/// The planning rules of the data, with `other` replacing the file of its kind. Rules that exceed their
/// limits end the program.
///
/// # Errors
/// The first problem in the rules.
pub fn domains(data: &Data, other: Option<&Path>) -> Result<Domains, Report> {
    Ok(data.domains(other, Some(Limits::new(end_planning)))?)
}
