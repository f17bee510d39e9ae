//! A finder of parts of one's own: a program that reads the baseline's images.

use std::time::Duration;

use miette::{Report, miette};
use ramp_data::Texts;
use ramp_external_agent::finder_message::names_of;
use ramp_external_agent::{AgentFile, GoalMessage, Patience, Sandbox, start_finder};
use ramp_skills::OwnFinder;
use ramp_twin::Setup;

use crate::command::program::command_of;

/// Starts the finder in a file, for an episode. `limit` is the time, s, that it has for an image.
///
/// # Errors
/// If it does not start.
pub fn finder(
    setup: &Setup,
    texts: &Texts,
    file: &AgentFile,
    limit: f64,
    sandbox: Option<Sandbox>,
) -> Result<OwnFinder, Report> {
    let Setup { assembly, arm, track, start, .. } = *setup;
    let goal = GoalMessage::new(assembly, arm, track, start, texts.sources()).to_finder_json();
    let command = command_of(file, sandbox.as_ref())?;
    let patience = Patience { answer: Duration::from_secs_f64(limit), end: None };
    start_finder(&command, patience, sandbox, &goal, names_of(&assembly.kit))
        .map_err(|error| miette!("{}: {error}", file.path().display()))
}
