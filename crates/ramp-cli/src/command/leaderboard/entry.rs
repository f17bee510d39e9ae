//! One entry: an untrusted folder. Everything in it is checked before use. No link is followed and no pipe
//! opened.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use miette::{IntoDiagnostic, Report as Failure, miette};
use ramp_kit::source::plain;
use ramp_log::{ENDING, Log};
use ramp_report::leaderboard::{BoardTerms, Stream, agent, check_log, check_whole, one_agent};
use ramp_result::collection::{Collection, Identity, ResultFile, collect};

use super::judge::LogFile;

/// Largest number of files in an entry: ten times those of every goal on every track.
const MOST_FILES: usize = 5_000;
/// Largest total size of an entry's results, bytes: ten times that of every goal on every track.
const LARGEST_RESULTS: u64 = 64 << 20;
/// Longest shown name of an entry or agent, characters.
const LONGEST_NAME: usize = 80;
/// Longest reason, characters.
const LONGEST_REASON: usize = 300;

/// An entry.
pub struct Entry {
    /// Name on the board.
    pub name: String,
    /// Path of its folder.
    pub folder: PathBuf,
}

/// An entry whose files are complete and valid. Its logs are not replayed yet.
pub struct Checked {
    /// Its results.
    pub collection: Collection,
    /// Its agent's name and version.
    pub agent: String,
    /// The logs to replay.
    pub logs: Vec<LogFile>,
    /// The calls of its episodes, except those without any motion.
    pub streams: Vec<Stream>,
}

/// The episodes on the boards: each goal and seed of an agent counts once.
#[derive(Default)]
pub struct Known(HashMap<String, String>);

impl Known {
    /// Key that identifies an episode.
    fn keys(collection: &Collection) -> impl Iterator<Item = String> {
        collection.entrants.iter().flat_map(|entrant| {
            let files = entrant.files.iter().map(|file| (&file.result.goal, file.result.seed));
            let lost = entrant.lost.iter().map(|lost| (&lost.goal, lost.seed));
            files.chain(lost).map(|(goal, seed)| key(&entrant.identity, goal, seed))
        })
    }

    /// Adds the episodes of an entry.
    pub fn add(&mut self, entry: &str, collection: &Collection) {
        for key in Known::keys(collection) {
            self.0.insert(key, entry.to_string());
        }
    }

    /// The earlier entry that already has one of these episodes.
    fn find(&self, collection: &Collection) -> Option<&String> {
        Known::keys(collection).find_map(|key| self.0.get(&key))
    }
}

fn key(identity: &Identity, goal: &str, seed: u64) -> String {
    serde_json::json!([identity, goal, seed]).to_string()
}

/// The subfolders of a folder of entries, sorted by name. Files and names that start with a dot are ignored.
///
/// # Errors
/// If it cannot be read, or contains no folder.
pub fn folders(entries: &Path) -> Result<Vec<PathBuf>, Failure> {
    let fail = |error| miette!("{} cannot be read: {error}", entries.display());
    let mut folders = Vec::new();
    for entry in std::fs::read_dir(entries).map_err(fail)? {
        let entry = entry.map_err(fail)?;
        let hidden = entry.file_name().as_encoded_bytes().starts_with(b".");
        if !hidden && !entry.file_type().map_err(fail)?.is_file() {
            folders.push(entry.path());
        }
    }
    folders.sort();
    if folders.is_empty() {
        return Err(miette!(
            help = "put each entry into a folder of its own in it",
            "there is no entry in {}",
            entries.display()
        ));
    }
    Ok(folders)
}

/// The board's name for the entry in a folder.
pub fn name(folder: &Path) -> String {
    plain(&folder.file_name().unwrap_or_default().to_string_lossy(), LONGEST_NAME)
}

impl Entry {
    /// Reads an entry, and checks that a board can accept it.
    ///
    /// # Errors
    /// The first reason for rejecting it.
    pub fn read(&self, terms: &BoardTerms, known: &Known) -> Result<Checked, Failure> {
        self.check_files()?;
        let collection = collect(std::slice::from_ref(&self.folder))?;
        let agent = plain(&agent(one_agent(&collection).into_diagnostic()?), LONGEST_NAME);
        check_whole(&collection, terms).into_diagnostic()?;
        if let Some(other) = known.find(&collection) {
            return Err(miette!(
                "entry {other} has these episodes of {agent} already: each goal and seed of an agent counts once"
            ));
        }
        let (mut logs, mut streams) = (Vec::new(), Vec::new());
        let files = collection.entrants.iter().flat_map(|entrant| &entrant.files);
        for file in files.filter(|file| file.result.real.is_none()) {
            let (path, log) = log_of(file)?;
            check_log(file, &log, terms).into_diagnostic()?;
            // Agents that do nothing have equal calls, so skip episodes without motion.
            if file.result.time.robot > 0.0 {
                let (track, goal) = (file.result.track.clone(), file.result.goal.clone());
                streams.push(Stream { track, goal, seed: file.result.seed, calls: log.calls_sha256() });
            }
            logs.push(LogFile { path, sha256: log.sha256 });
        }
        Ok(Checked { collection, agent, logs, streams })
    }

    /// Checks that an entry is a folder of regular files, within the limits on number and size. Links are not
    /// followed, since they may lead anywhere. Pipes and devices are not opened, since reading them may never
    /// end.
    fn check_files(&self) -> Result<(), Failure> {
        let fail = |error: std::io::Error| miette!("it cannot be read: {error}");
        if !std::fs::symlink_metadata(&self.folder).map_err(fail)?.is_dir() {
            return Err(miette!("it is no folder; links are not followed"));
        }
        let (mut files, mut results) = (0, 0_u64);
        for entry in std::fs::read_dir(&self.folder).map_err(fail)? {
            let entry = entry.map_err(fail)?;
            let name = entry.file_name();
            let meta = entry.metadata().map_err(fail)?;
            let name = name.to_string_lossy();
            if meta.is_symlink() {
                return Err(miette!("{name} is a link; an entry holds files only"));
            }
            if !meta.is_file() && !meta.is_dir() {
                return Err(miette!("{name} is no ordinary file"));
            }
            files += 1;
            if files > MOST_FILES {
                return Err(miette!("it has more than {MOST_FILES} files"));
            }
            if name.ends_with(".json") {
                results = results.saturating_add(meta.len());
            }
        }
        if results > LARGEST_RESULTS {
            return Err(miette!("its results have {results} bytes, and {LARGEST_RESULTS} are the most"));
        }
        Ok(())
    }

    /// The reason for rejection, in one line. Files of the entry are given by name.
    pub fn reason(&self, why: &Failure) -> String {
        let whole = why.chain().map(ToString::to_string).collect::<Vec<_>>().join(": ");
        let folder = format!("{}{}", self.folder.display(), std::path::MAIN_SEPARATOR);
        let shown = plain(&folder, usize::MAX);
        plain(&whole.replace(&folder, "").replace(&shown, ""), LONGEST_REASON)
    }
}

/// The log file beside a result.
fn log_of(file: &ResultFile) -> Result<(PathBuf, Log), Failure> {
    let path = file.path.with_extension(ENDING);
    if !path.exists() {
        return Err(miette!(
            "{} has no log {}, and only what can be run again goes on the board",
            file.path.display(),
            path.display()
        ));
    }
    let log = Log::read(&path).into_diagnostic()?;
    Ok((path, log))
}
