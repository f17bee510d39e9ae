//! The arguments of `ramp plan`, and the planning problem that they name.

use std::path::{Path, PathBuf};

use miette::{Report, miette};
use ramp_assembly::Assembly;
use ramp_data::Data;
use ramp_kit::source::{MAX_SENTENCE, plain, read_text};
use ramp_planner::{Domains, State};

use crate::rules::domains;

/// The arguments of `ramp plan`.
#[derive(clap::Args)]
pub struct Arguments {
    /// Name of a goal, or a goal file
    pub(super) goal: String,
    /// Print JSON
    #[arg(long)]
    pub(super) json: bool,
    /// Prove that no plan has fewer coarse actions; takes much longer
    #[arg(long)]
    pub(super) optimal: bool,
    /// Plan coarse actions only
    #[arg(long)]
    pub(super) coarse: bool,
    /// Explain why a coarse action cannot come earlier in the plan
    #[arg(long, value_name = "ACTION", conflicts_with_all = ["emit_asp", "from"])]
    pub(super) why: Option<String>,
    /// Replace the rule file of the same kind: a coarse or fine domain (.al), or the order of the beams (.lp)
    #[arg(long, value_name = "FILE")]
    pub(super) domain: Option<PathBuf>,
    /// Check the plan in this file instead of making one: the output of --json, or another planner's plan for
    /// the files of --pddl, which also gets its fine actions
    #[arg(long, value_name = "FILE", conflicts_with = "emit_asp")]
    pub(super) from: Option<PathBuf>,
    /// With --from: write the verdict as a result file, for `ramp report`
    #[arg(short, long, value_name = "FILE", requires = "from")]
    pub(super) output: Option<PathBuf>,
    /// Print the domain and this goal as an answer set program for clingo's incremental mode
    #[arg(long, value_name = "LEVEL", num_args = 0..=1, default_missing_value = "coarse")]
    pub(super) emit_asp: Option<Level>,
    /// Write the coarse domain and this goal to a folder, for other planners: as domain.pddl and
    /// problem.pddl, and in STRIPS as strips-domain.pddl and strips-problem.pddl
    #[arg(long, value_name = "DIR", conflicts_with_all = ["emit_asp", "from", "why", "history", "disassemble"])]
    pub(super) pddl: Option<PathBuf>,
    /// Plan from the state in this file (JSON) instead of from the empty table
    #[arg(long, value_name = "FILE", conflicts_with = "emit_asp")]
    pub(super) state: Option<PathBuf>,
    /// Explain the actions and observations in this file (JSON), and plan from the most likely state
    #[arg(long, value_name = "FILE", conflicts_with_all = ["emit_asp", "from", "why", "state"])]
    pub(super) history: Option<PathBuf>,
    /// Rehearse the plan with the arm's model, and plan around motions that the arm cannot do; with --from,
    /// refuse a plan that the arm cannot carry out
    #[arg(long, conflicts_with_all = ["emit_asp", "pddl", "disassemble"])]
    pub(super) check_motion: bool,
    /// Quantity to minimise. With `time`, pegs and fastenings are exchanged as long as that shortens the
    /// arm's motions
    #[arg(long, value_name = "WHAT", value_enum, default_value_t = Least::Actions,
        conflicts_with_all = ["emit_asp", "from", "pddl", "why", "coarse", "disassemble"])]
    pub(super) least: Least,
    /// Also print a lower bound of the robot time that no arm can beat, and a reference time
    #[arg(long, conflicts_with_all = ["emit_asp", "from", "pddl", "why", "disassemble"])]
    pub(super) bound: bool,
    /// Plan how to take the finished goal apart
    #[arg(long, conflicts_with_all = ["emit_asp", "from", "why", "state", "history", "optimal"])]
    pub(super) disassemble: bool,
}

/// The largest plan, state or history file, bytes.
pub(super) const LARGEST: usize = 16 << 20;

/// Resolution of the actions.
#[derive(Clone, Copy, clap::ValueEnum)]
pub(super) enum Level {
    Coarse,
    Fine,
}

/// Quantity that a plan minimises.
#[derive(Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(super) enum Least {
    Actions,
    Time,
}

/// A planning problem.
pub(super) struct Problem {
    pub(super) goal: Assembly,
    pub(super) domains: Domains,
    /// The state that the plan starts from.
    pub(super) state: State,
}

impl Problem {
    pub(super) fn read(data: &Data, arguments: &Arguments) -> Result<Problem, Report> {
        let state = match &arguments.state {
            Some(file) => read_json(
                file,
                "expected a state, such as {\"in_assembly\": [\"b4\"], \"fastened\": [[\"C1\", \"p1\"]]}",
            )?,
            None => State::default(),
        };
        let goal = data.goal(&arguments.goal)?;
        Ok(Problem { goal, domains: domains(data, arguments.domain.as_deref())?, state })
    }
}

/// Reads a JSON file; `expected` is the help of the error.
pub(super) fn read_json<T: serde::de::DeserializeOwned>(
    path: &Path,
    expected: &'static str,
) -> Result<T, Report> {
    let name = path.display();
    let text = read_text(path, LARGEST)?;
    serde_json::from_str(&text).map_err(|error| {
        let place = format!("{name}:{}:{}", error.line(), error.column());
        miette!(help = expected, "{place}: {}", plain(&error.to_string(), MAX_SENTENCE))
    })
}
