//! `ramp leaderboard`: a static site of many entries. Each entry's logs are replayed before it is listed.

mod entry;
mod judge;
mod rerun;
mod verdicts;

use std::path::{Path, PathBuf};

use miette::{Report as Failure, miette};
use ramp_data::Data;
use ramp_report::leaderboard::{BoardGoal, BoardTerms, Boards, Refusal, Streams, pages, standings};
use ramp_report::{Report, page};
use ramp_result::secret::Secret;
use ramp_world::Start;

use self::entry::{Entry, Known};
use self::verdicts::Verdicts;
use super::seeds;
use crate::output::print;
use crate::site::Site;
use crate::status::{DONE, INCOMPLETE};

pub use self::judge::{Arguments as JudgeArguments, judge};

#[derive(clap::Args)]
pub struct Arguments {
    /// Folder of entries: each folder in it holds the results of one agent, with their logs
    entries: PathBuf,
    /// Folder for the site and the verdicts on the logs
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    /// Secret that was mixed into the seeds of all entries, from `ramp seeds commit`
    #[arg(long, value_name = "FILE")]
    secret: Option<PathBuf>,
    /// Run the agents again for their planning and compute times, in a sandbox: each entry's `agent.py` or
    /// `agent`, or the baseline
    #[arg(long)]
    rerun_agents: bool,
}

/// Inputs and state of one leaderboard.
struct Board {
    boards: Boards,
    refused: Vec<Refusal>,
    known: Known,
    streams: Streams,
    verdicts: Verdicts,
    site: Site,
    /// Agent pages written so far.
    agents: usize,
}

pub fn run(data: &Data, arguments: &Arguments) -> Result<u8, Failure> {
    let folders = entry::folders(&arguments.entries)?;
    check_apart(&arguments.entries, &arguments.output)?;
    let secret = arguments.secret.as_deref();
    let terms = terms(data, secret.map(seeds::read).transpose()?)?;
    let site = Site::open(&arguments.output)?;
    let mut board = Board {
        boards: Boards::default(),
        refused: Vec::new(),
        known: Known::default(),
        streams: Streams::default(),
        verdicts: Verdicts::open(&arguments.output)?,
        site,
        agents: 0,
    };
    let mut admitted = 0;
    for folder in &folders {
        let entry = Entry { name: entry::name(folder), folder: folder.clone() };
        // An invalid entry is left out; the others are still listed.
        match board.admit(data, &entry, &terms, arguments.rerun_agents, secret)? {
            Ok(()) => admitted += 1,
            Err(reason) => {
                print(&format!("refused {}: {reason}\n", entry.name))?;
                board.refused.push(Refusal { entry: entry.name, reason });
            }
        }
    }
    // Write the front page last, so that all its links exist.
    for (name, text) in pages::pages(&board.boards, &board.refused) {
        board.site.write(&name, &text)?;
    }
    board.site.remove_others(&["agent-", "board-", "refused"])?;
    let [run, remembered] = board.verdicts.counts();
    print(&format!(
        "{admitted} of {} entries admitted; {run} logs run again, {remembered} known from before\nsite: {}\n",
        folders.len(),
        arguments.output.join(pages::INDEX).display()
    ))?;
    Ok(if board.refused.is_empty() { DONE } else { INCOMPLETE })
}

impl Board {
    /// Lists a valid entry on the boards, or returns the reason for rejecting it. All checks are made here.
    ///
    /// # Errors
    /// If the site cannot be written.
    fn admit(
        &mut self,
        data: &Data,
        entry: &Entry,
        terms: &BoardTerms,
        rerun_agents: bool,
        secret: Option<&Path>,
    ) -> Result<Result<(), String>, Failure> {
        let checked = match entry.read(terms, &self.known) {
            Ok(checked) => checked,
            Err(why) => return Ok(Err(entry.reason(&why))),
        };
        if let Err(reason) = self.verdicts.replay(&checked.logs)? {
            return Ok(Err(entry.reason(&miette!("{reason}"))));
        }
        self.known.add(&entry.name, &checked.collection);
        let mut warnings: Vec<(Option<String>, String)> = Vec::new();
        for copy in self.streams.add(&entry.name, &checked.agent, &checked.streams) {
            let all = checked.streams.len();
            warnings.push((
                None,
                format!(
                    "{} of its {all} episodes make the same calls, to the last bit, as entry {} ({})",
                    copy.episodes, copy.entry, copy.agent
                ),
            ));
        }
        let mut timed = checked.collection.clone();
        let mut timed_here = vec![false; timed.entrants.len()];
        if rerun_agents {
            for (entrant, timed_here) in timed.entrants.iter_mut().zip(&mut timed_here) {
                if entrant.identity.real.is_some() {
                    continue;
                }
                let timing = rerun::time(data, entry, entrant, &checked.streams, secret)?;
                *timed_here = timing.timed;
                let track = entrant.identity.track.clone();
                warnings.extend(timing.warning.map(|warning| (Some(track), warning)));
            }
        }
        print(&format!("admitted {}: {}\n", entry.name, checked.agent))?;
        for (_, warning) in &warnings {
            print(&format!("warning {}: {warning}\n", entry.name))?;
        }
        let before = self.agents;
        let agent_page = |index: usize| page::agent_page(before + index);
        for (key, mut standing) in
            standings(&entry.name, &checked.agent, &timed, agent_page, |index| timed_here[index])
        {
            let here = |track: &Option<String>| track.as_ref().is_none_or(|track| *track == key.track);
            standing.warnings =
                warnings.iter().filter(|(track, _)| here(track)).map(|(_, text)| text.clone()).collect();
            self.boards.add(key, standing);
        }
        let report = Report::new(checked.collection);
        for index in 0..report.collection.entrants.len() {
            let text = page::of_agent(&report.of_agent(index), (pages::INDEX, pages::TITLE));
            self.site.write(&agent_page(index), &text)?;
            self.agents += 1;
        }
        Ok(Ok(()))
    }
}

/// Checks that the entries and the site are separate folders: entrants must not write into the site, and the
/// site is not an entry.
fn check_apart(entries: &Path, site: &Path) -> Result<(), Failure> {
    if site.exists() && !site.is_dir() {
        return Err(miette!("cannot write to {}: it is not a folder", site.display()));
    }
    // Resolve links in the nearest existing ancestor; a path that does not exist yet contains none.
    let whole = |path: &Path| {
        let path = std::path::absolute(path).ok()?;
        let there = path.ancestors().find(|it| it.exists())?;
        Some(there.canonicalize().ok()?.join(path.strip_prefix(there).ok()?))
    };
    match (whole(entries), whole(site)) {
        (Some(entries), Some(site)) if entries.starts_with(&site) || site.starts_with(&entries) => {
            Err(miette!(
                help = "name a folder with -o that entrants cannot write to",
                "the site and the entries lie in one another: {} and {}",
                site.display(),
                entries.display()
            ))
        }
        _ => Ok(()),
    }
}

fn terms(data: &Data, secret: Option<Secret>) -> Result<BoardTerms, Failure> {
    let mut goals = Vec::new();
    let mut files = None;
    for name in data.goal_names()? {
        let (goal, texts) = data.goal_with_texts(&name)?;
        let sources = texts.sources();
        files = Some((sources.kit.to_string(), sources.arm.to_string()));
        let class = goal.class.map(|class| class.name().to_string());
        let pegs = goal.connections.len();
        goals.push(BoardGoal { name: goal.name, class, pegs, xml: sources.goal.to_string() });
    }
    let Some((kit, arm)) = files else {
        return Err(miette!("there is no goal in {}", data.goals()));
    };
    let starts = Start::names().filter_map(Start::shipped).map(|start| start.text.clone()).collect();
    Ok(BoardTerms { goals, kit, arm, starts, secret })
}
