//! Stopwatch logs of a real robot's run, converted into results of the same form as the twin's.
//!
//! A log is a CSV file: lines of a key and its value, then a table with one row per event.
//! `docs/src/reference/real-runs.md` describes the format. Impossible events are refused with their
//! line.

mod cells;
mod run;
mod separator;

use std::ops::Range;

use ramp_assembly::Assembly;
use ramp_kit::Kit;
use ramp_kit::source::{Fault, FormProblem, Problem, SourceFile, nearest, shorten};

use ramp_result::episode::{AgentInfo, EpisodeResult, Host, RULES, RealRun, RobotKind, Software};
use ramp_result::published::{self, Published};
use ramp_robot::MOST_EVENTS;
use run::Run;

/// First value of a log of episodes.
pub const EPISODES: &str = "ramp-stopwatch-1";
/// First value of a log of published means.
pub const MEANS: &str = published::SCHEMA;
/// Time limit of an episode by the rules, s of robot time.
const LIMIT: f64 = 1800.0;
/// Largest value of a stopwatch, s.
const LONGEST: f64 = 1e6;
/// Shortest time of a run that is taken for one in milliseconds, s.
const SHORTEST: f64 = 5.0;
/// Columns of the table of episodes.
const COLUMNS: [&str; 6] = ["goal", "repeat", "what", "time", "peg", "note"];
/// Columns of the table of means.
const MEAN_COLUMNS: [&str; 7] =
    ["class", "goals", "repeats", "completion", "total", "planning from", "planning to"];

/// Defects of a log.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum LogProblem {
    /// The file itself.
    #[error(transparent)]
    Form(#[from] FormProblem),
    /// An invalid entry.
    #[error("{found}")]
    Entry {
        /// The text found.
        found: String,
        /// The text expected.
        expected: String,
        /// Advice on how to fix it.
        help: Option<String>,
    },
}

impl Problem for LogProblem {
    fn label(&self) -> String {
        match self {
            LogProblem::Form(problem) => problem.label(),
            LogProblem::Entry { expected, .. } => expected.clone(),
        }
    }

    fn help(&self) -> Option<String> {
        match self {
            LogProblem::Form(problem) => problem.help(),
            LogProblem::Entry { help, .. } => help.clone(),
        }
    }
}

/// A log that was read.
#[derive(Clone, Debug, PartialEq)]
pub enum Log {
    /// Episodes, in order of their first line.
    Episodes(Vec<EpisodeResult>),
    /// Published means of classes.
    Means(Vec<Published>),
}

type Read<T> = Result<T, Fault<LogProblem>>;

/// Text of a cell with its place.
#[derive(Clone, Debug)]
struct CsvCell {
    text: String,
    span: Range<usize>,
}

/// Reference data for reading a log.
pub struct Reader<'a> {
    /// The log.
    pub file: &'a SourceFile,
    /// The kit, for the pegs' names.
    pub kit: &'a Kit,
    /// The goals it may name.
    pub goals: &'a [Assembly],
    /// The program that made the results.
    pub software: &'a Software,
}

/// The lines above the table.
#[derive(Default)]
struct Head {
    entries: Vec<(CsvCell, CsvCell)>,
    end: usize,
}

impl Reader<'_> {
    /// Reads the log.
    ///
    /// # Errors
    /// The first invalid entry, with its place.
    pub fn read(&self) -> Read<Log> {
        let rows = self.rows()?;
        let is_table = |row: &Vec<CsvCell>| {
            [COLUMNS[0], MEAN_COLUMNS[0]]
                .iter()
                .any(|name| row.first().is_some_and(|cell| cell.text == *name))
        };
        let table = rows.iter().position(is_table).unwrap_or(rows.len());
        let mut head = Head::default();
        for row in &rows[..table] {
            let [name, value] = row.as_slice() else {
                let last = row.last().map_or(0..0, |cell| cell.span.clone());
                let words = format!("found {} cells above the table", row.len());
                return Err(self.fault(last, words, "expected a word and its value", None));
            };
            if let Some((_, _)) = head.entries.iter().find(|(known, _)| known.text == name.text) {
                let words = format!("`{}` is given twice", shorten(&name.text));
                return Err(self.fault(name.span.clone(), words, "expected it once", None));
            }
            head.end = value.span.end;
            head.entries.push((name.clone(), value.clone()));
        }
        let kind = self.entry(&head, "log")?;
        match kind.text.as_str() {
            EPISODES => self.episodes(&head, &rows[table..]).map(Log::Episodes),
            MEANS => self.means(&head, &rows[table..]).map(Log::Means),
            other => Err(self.fault(
                kind.span.clone(),
                format!("found a log of the form `{}`", shorten(other)),
                &format!("expected {EPISODES}, or {MEANS}"),
                None,
            )),
        }
    }

    fn means(&self, head: &Head, table: &[Vec<CsvCell>]) -> Read<Vec<Published>> {
        let (name, track) = (self.text(head, "agent")?, self.track(head)?);
        let (robot, source) = (self.text(head, "robot")?, self.text(head, "source")?);
        let mut means = Vec::new();
        for row in self.check_columns(table, &MEAN_COLUMNS)? {
            let cell = |column: usize| self.cell(row, column);
            let number = |column: usize, high| self.number(&cell(column), MEAN_COLUMNS[column], 0.0, high);
            let published = Published {
                schema: published::SCHEMA.to_string(),
                name: name.clone(),
                robot: robot.clone(),
                source: source.clone(),
                track: track.clone(),
                class: cell(0).text,
                goals: self.count(&cell(1), MEAN_COLUMNS[1], 1000)? as usize,
                repeats: self.count(&cell(2), MEAN_COLUMNS[2], 100_000)? as usize,
                completion: number(3, 1.0)?,
                total: number(4, LONGEST)?,
                planning: [number(5, LONGEST)?, number(6, LONGEST)?],
            };
            published.check().map_err(|why| self.fault(cell(0).span, why, "in this line", None))?;
            means.push(published);
        }
        Ok(means)
    }

    fn episodes(&self, head: &Head, table: &[Vec<CsvCell>]) -> Read<Vec<EpisodeResult>> {
        let agent = AgentInfo {
            name: self.name(head, "agent")?,
            version: self.name(head, "version")?,
            sha256: None,
            asynchronous: false,
        };
        let track = self.track(head)?;
        let real = RealRun {
            kind: RobotKind::Arm,
            robot: self.text(head, "robot")?,
            scorer: self.text(head, "scorer")?,
            source: self.text(head, "source")?,
        };
        let cores = self.count(self.entry(head, "cores")?, "cores", 100_000)? as usize;
        let host = Host { cpu: self.text(head, "computer")?, cores };
        let rules = self.entry(head, "rules")?;
        if rules.text != RULES {
            let words = format!("the rules are of version `{}`", shorten(&rules.text));
            return Err(self.fault(rules.span.clone(), words, &format!("expected {RULES}"), None));
        }
        let mut runs: Vec<Run> = Vec::new();
        for row in self.check_columns(table, &COLUMNS)? {
            self.happened(row, &mut runs)?;
        }
        if let Some(run) = runs.iter().find(|run| run.ended.is_none()) {
            return Err(self.fault(
                run.last.clone(),
                format!("the log of {}, repeat {}, stops here", run.goal.name, run.repeat),
                "expected a line `end` after it",
                Some("an episode without an end has no time".to_string()),
            ));
        }
        Ok(runs.into_iter().map(|run| run.result(&agent, &track, &real, &host, self.software)).collect())
    }

    /// Adds one line of the table to its episode.
    fn happened<'a>(&'a self, row: &[CsvCell], runs: &mut Vec<Run<'a>>) -> Read<()> {
        let [goal, repeat, what, time, peg, note] = std::array::from_fn(|column| self.cell(row, column));
        let Some(assembly) = self.goals.iter().find(|it| it.name == goal.text) else {
            let names: Vec<&str> = self.goals.iter().map(|it| it.name.as_str()).collect();
            let near = nearest(&goal.text, names.iter().copied());
            return Err(self.fault(
                goal.span,
                format!("there is no goal `{}`", shorten(&goal.text)),
                "expected the name of a goal",
                Some(near.map_or_else(
                    || format!("the goals are {}", names.join(", ")),
                    |near| format!("did you mean `{near}`?"),
                )),
            ));
        };
        let repeat = self.count(&repeat, "repeat", 100_000)?;
        let seconds = self.seconds(&time)?;
        let known = runs.iter().position(|run| run.goal.name == assembly.name && run.repeat == repeat);
        let index = known.unwrap_or_else(|| {
            runs.push(Run::new(assembly, repeat));
            runs.len() - 1
        });
        let run = &mut runs[index];
        if run.ended.is_some() {
            let words = format!("{}, repeat {repeat}, has ended before this line", assembly.name);
            return Err(self
                .fault(what.span, words, "expected nothing after its end", None)
                .also(run.last.clone(), "it ends here"));
        }
        if seconds < run.now {
            let words = format!("time runs backwards: {seconds} s, after {} s", run.now);
            let fault = self.fault(time.span, words, "expected a later time", None);
            return Err(fault.also(run.last.clone(), "the line before of this episode"));
        }
        let first = run.planning.is_none();
        if first != (what.text == "planning") {
            let words = match first {
                true => format!("{}, repeat {repeat}, begins with `{}`", assembly.name, shorten(&what.text)),
                false => format!("{}, repeat {repeat}, has two lines `planning`", assembly.name),
            };
            let help =
                "the first line of an episode is `planning`: when the robot was free to move".to_string();
            return Err(self.fault(what.span, words, "expected one line `planning`, the first", Some(help)));
        }
        let robot = seconds - run.planning.unwrap_or(seconds);
        if robot > LIMIT {
            let words = format!("this is after {robot} s of robot time");
            let mut help =
                format!("the rules end an episode after {LIMIT} s; what comes later does not count");
            if robot / 1e3 <= LIMIT && robot / 1e3 >= SHORTEST {
                help += "; are the times in milliseconds (expected seconds)?";
            }
            return Err(self.fault(time.span, words, &format!("expected up to {LIMIT} s"), Some(help)));
        }
        self.enter(run, &what, seconds, &peg, &note)?;
        run.now = seconds;
        run.last = what.span.start..time.span.end.max(what.span.end);
        Ok(())
    }

    fn enter(&self, run: &mut Run, what: &CsvCell, seconds: f64, peg: &CsvCell, note: &CsvCell) -> Read<()> {
        let seats_none =
            |word: &str| ["planning", "end", "touch", "fault"].contains(&word) || word.starts_with("out ");
        if seats_none(&what.text) && !peg.text.is_empty() {
            return Err(self.fault(
                peg.span.clone(),
                format!("a peg is named in a line `{}`", shorten(&what.text)),
                "expected an empty cell",
                Some("words for a person go into the next column, `note`".to_string()),
            ));
        }
        match what.text.as_str() {
            "planning" => run.planning = Some(seconds),
            "end" => {
                run.ended = Some(if note.text.is_empty() { "done".to_string() } else { note.text.clone() });
            }
            "touch" => {
                let note = if note.text.is_empty() { "" } else { &format!(": {}", note.text) };
                run.ended = Some(format!("a person touched the robot or a part{note}"));
            }
            "fault" if run.faults.len() >= MOST_EVENTS => {
                let words = format!("this is more than {MOST_EVENTS} faults of an episode");
                return Err(self.fault(what.span.clone(), words, "expected fewer", None));
            }
            "fault" => run.faults.push((seconds, note.text.clone())),
            text => {
                let (out, name) = match text.strip_prefix("out ") {
                    Some(name) => (true, name.trim()),
                    None => (false, text),
                };
                let index = self.connection(run.goal, name, what)?;
                if out {
                    if run.pegs[index].take().is_none() {
                        let words = format!("no peg is in {} yet", run.goal.connections[index].name);
                        return Err(self.fault(what.span.clone(), words, "expected it seated before", None));
                    }
                    return Ok(());
                }
                if let Some((_, _, before)) = &run.pegs[index] {
                    let words = format!("{} has a peg already", run.goal.connections[index].name);
                    let help = "write `out` and the connection where its peg comes out again".to_string();
                    return Err(self
                        .fault(what.span.clone(), words, "expected another connection", Some(help))
                        .also(before.clone(), "seated here"));
                }
                self.check_peg(run, peg)?;
                run.pegs[index] = Some((seconds, peg.text.clone(), what.span.clone()));
            }
        }
        Ok(())
    }

    /// Finds a connection by its name, or by its two joints in either order.
    fn connection(&self, goal: &Assembly, name: &str, what: &CsvCell) -> Read<usize> {
        let joints = |index: usize| {
            let connection = &goal.connections[index];
            [connection.female, connection.male].map(|joint| goal.joint_name(joint))
        };
        let is_it = |index: &usize| {
            let [female, male] = joints(*index);
            goal.connections[*index].name == name
                || name.split_once('-').is_some_and(|(a, b)| {
                    let pair = [a.trim(), b.trim()];
                    pair == [female, male] || pair == [male, female]
                })
        };
        if let Some(index) = (0..goal.connections.len()).find(is_it) {
            return Ok(index);
        }
        let list: Vec<String> = (0..goal.connections.len())
            .map(|index| format!("{} ({})", goal.connections[index].name, joints(index).join("-")))
            .collect();
        Err(self.fault(
            what.span.clone(),
            format!("{} has no connection `{}`", goal.name, shorten(name)),
            "expected a connection, planning, fault, touch or end",
            Some(format!("its connections are {}", list.join(", "))),
        ))
    }

    fn check_peg(&self, run: &Run, peg: &CsvCell) -> Read<()> {
        if peg.text.is_empty() {
            return Ok(());
        }
        if self.kit.pegs.iter().all(|known| known.name != peg.text) {
            let near = nearest(&peg.text, self.kit.pegs.iter().map(|known| known.name.as_str()));
            let words = format!("the kit has no peg `{}`", shorten(&peg.text));
            let help = near.map(|near| format!("did you mean `{near}`?"));
            return Err(self.fault(peg.span.clone(), words, "expected a peg, or nothing", help));
        }
        match run.pegs.iter().flatten().find(|(_, name, _)| *name == peg.text) {
            Some((_, _, before)) => Err(self
                .fault(
                    peg.span.clone(),
                    format!("the peg {} is in two connections", peg.text),
                    "expected another peg",
                    None,
                )
                .also(before.clone(), "it is here")),
            None => Ok(()),
        }
    }
}

/// Reads a log from a file.
///
/// # Errors
/// The first invalid entry, with its place.
pub fn read_log(path: &std::path::Path, kit: &Kit, goals: &[Assembly], software: &Software) -> Read<Log> {
    let file = SourceFile::read::<LogProblem>(path)?;
    Reader { file: &file, kit, goals, software }.read()
}
