//! Runs the agents of entries again on this machine, to measure planning and compute times.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use miette::{IntoDiagnostic, Report as Failure, miette};
use ramp_data::Data;
use ramp_external_agent::AgentFile;
use ramp_log::{ENDING, Log};
use ramp_report::leaderboard::Stream;
use ramp_report::report::repeats;
use ramp_result::collection::{Entrant, collect};
use ramp_result::episode::{EpisodeResult, WorldInfo};

use super::entry::Entry;
use crate::status::{MACHINE, MachineFault};

/// File names of an entry's agent: a Python file or an executable.
pub const AGENT_NAMES: [&str; 2] = ["agent.py", "agent"];

/// Outcome of timing an agent.
pub struct Timing {
    /// True if its results have the times of this machine.
    pub timed: bool,
    /// Note for the reader.
    pub warning: Option<String>,
}

impl Timing {
    fn not(why: impl std::fmt::Display) -> Timing {
        Timing { timed: false, warning: Some(format!("its times are its own: {why}")) }
    }
}

/// Runs an agent again on its goals and seeds, and replaces planning and compute times in its results by
/// those of this machine.
///
/// # Errors
/// If a temporary folder cannot be created.
pub fn time(
    data: &Data,
    entry: &Entry,
    entrant: &mut Entrant,
    streams: &[Stream],
    secret: Option<&Path>,
) -> Result<Timing, Failure> {
    let folder = tempfile::tempdir().map_err(|error| miette!("cannot make a folder: {error}"))?;
    let agent = match agent_file(entry, entrant, folder.path()) {
        Ok(agent) => agent,
        Err(why) => return Ok(Timing::not(why)),
    };
    let world = entrant.files.iter().find_map(|file| file.result.world.as_ref());
    if !world.is_some_and(WorldInfo::is_shipped) {
        return Ok(Timing::not("its world is not one of this program's".to_string()));
    }
    let results = folder.path().join("results");
    let status = Command::new(std::env::current_exe().into_diagnostic()?)
        .args(bench_arguments(data, entrant, agent.as_deref(), &results, secret))
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .status()
        .into_diagnostic()?;
    if status.code() == Some(MACHINE.into()) {
        return Err(MachineFault { what: format!("{} cannot be run again here", entry.name) }.into());
    }
    let collection = match collect(std::slice::from_ref(&results)) {
        Ok(collection) => collection,
        Err(_) => return Ok(Timing::not(format!("it has no result when it is run here ({status})"))),
    };
    let again: Vec<&EpisodeResult> =
        collection.entrants.iter().flat_map(|it| &it.files).map(|file| &file.result).collect();
    Ok(compare(entrant, &again, &results, streams))
}

/// The agent's file, copied to a folder without the rest of its entry; `None` for the baseline.
fn agent_file(entry: &Entry, entrant: &Entrant, folder: &Path) -> Result<Option<PathBuf>, String> {
    let Some(expected) = &entrant.identity.agent_sha256 else { return Ok(None) };
    let name = AGENT_NAMES.iter().find(|name| entry.folder.join(name).is_file());
    let name = name.ok_or_else(|| format!("there is no {} in the entry", AGENT_NAMES.join(" and no ")))?;
    let file = AgentFile::find(&entry.folder.join(name))
        .map_err(|_| format!("{name} is neither a Python file nor an executable, or too large"))?;
    if file.sha256() != expected {
        return Err(format!("{name} is not the file that the results name"));
    }
    let own = folder.join("agent");
    std::fs::create_dir(&own).map_err(|error| format!("{}: {error}", own.display()))?;
    let copy = own.join(name);
    std::fs::copy(file.path(), &copy).map_err(|error| format!("{name}: {error}"))?;
    Ok(Some(copy))
}

/// The bench that runs an agent again. Only this function decides how an untrusted program is started.
fn bench_arguments(
    data: &Data,
    entrant: &Entrant,
    agent: Option<&Path>,
    results: &Path,
    secret: Option<&Path>,
) -> Vec<OsString> {
    let mut arguments = data.arguments();
    arguments.extend(["bench", "--track", &entrant.identity.track].map(OsString::from));
    arguments.extend(entrant.identity.arm.iter().flat_map(|arm| ["--arm", arm]).map(OsString::from));
    let world = entrant.files.iter().find_map(|file| file.result.world.as_ref());
    arguments.extend(world.iter().flat_map(|world| ["--world", &world.name]).map(OsString::from));
    let start = entrant.files.iter().find_map(|file| file.result.start.as_ref());
    arguments.extend(start.iter().flat_map(|start| ["--start", &start.name]).map(OsString::from));
    let repeats = entrant.files.iter().map(|file| repeats(file.result.class.as_deref())).max().unwrap_or(1);
    arguments.extend(["--repeats".into(), repeats.to_string().into(), "-o".into(), results.into()]);
    if let Some(agent) = agent {
        arguments.extend(["--sandbox".into(), "--agent".into(), agent.into()]);
    }
    arguments.extend(secret.iter().flat_map(|path| ["--secret".into(), path.into()]));
    let mut goals: Vec<&String> = entrant.files.iter().map(|file| &file.result.goal).collect();
    goals.dedup();
    arguments.push("--".into());
    arguments.extend(goals.into_iter().map(OsString::from));
    arguments
}

/// Takes over the times of the repeated episodes, if all were repeated. Returns how they differ from the
/// entry's times.
fn compare(entrant: &mut Entrant, again: &[&EpisodeResult], results: &Path, streams: &[Stream]) -> Timing {
    let find = |it: &EpisodeResult| {
        again.iter().find(|other| (&other.goal, other.seed) == (&it.goal, it.seed)).copied()
    };
    let missing = entrant.files.iter().filter(|file| find(&file.result).is_none()).count();
    if missing > 0 {
        return Timing::not(format!("{missing} of its episodes have no result when they are run here"));
    }
    let (mut other_calls, mut other_pegs) = (0, 0);
    let (mut own_completion, mut completion) = (0.0, 0.0);
    for file in &mut entrant.files {
        let result = &mut file.result;
        let Some(here) = find(result) else { continue };
        let stem = format!("{}-{}-{}", result.goal, result.track, result.seed);
        let log = Log::read(&results.join(format!("{stem}.{ENDING}")));
        let calls = streams
            .iter()
            .find(|it| (&it.track, &it.goal, it.seed) == (&result.track, &result.goal, result.seed))
            .map(|it| &it.calls);
        let same = match (&log, calls) {
            (Ok(log), Some(calls)) => log.calls_sha256() == *calls,
            // The robot did not move.
            (_, None) => here.time.robot == 0.0,
            _ => false,
        };
        let pegs = |it: &EpisodeResult| it.pegs.iter().map(Option::is_some).collect::<Vec<_>>();
        other_calls += usize::from(!same);
        other_pegs += usize::from(pegs(here) != pegs(result));
        own_completion += result.completion;
        completion += here.completion;
        result.host = here.host.clone();
        // Robot time comes from the log, whose replay was equal in every bit.
        result.time.planning = here.time.planning;
        result.time.compute = here.time.compute;
        result.time.total = here.time.planning + here.time.compute + result.time.robot;
    }
    let count = entrant.files.len();
    let percent = |sum: f64| 100.0 * sum / count.max(1) as f64;
    let warning = (other_calls > 0).then(|| {
        format!(
            "run again here, {other_calls} of its {count} episodes made other calls, {other_pegs} with other pegs: \
             completion {:.1} % here, {:.1} % in the entry",
            percent(completion),
            percent(own_completion)
        )
    });
    Timing { timed: true, warning }
}
