//! One entry: an untrusted folder, or an archive of one. Everything in it is checked before use. No link is
//! followed and no pipe opened.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use miette::{IntoDiagnostic, Report as Failure, miette};
use ramp_kit::source::{describe_debris, is_debris, plain};
use ramp_log::{ENDING, Facts, Limits};
use ramp_report::leaderboard::{BoardTerms, Stream, agent, check_log, check_whole, one_agent};
use ramp_result::collection::{Collection, Identity, ResultFile, collect};
use ramp_result::file::sha256_of;
use tempfile::TempDir;

use super::archive::{self, ArchiveError};
use super::judge::{Allowance, LogFile};
use super::limits::LIMITS;
use super::verdicts::Verdicts;
use crate::output::tell;

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
    /// The folder of an archive's files, which ends with the entry.
    _unpacked: Option<TempDir>,
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

/// The entries in a folder, sorted by name: its subfolders and its archives (`.tar`). Other files, names that
/// start with a dot, and what a file manager left there are ignored.
///
/// # Errors
/// If it cannot be read, or contains no entry.
pub fn entries(folder: &Path) -> Result<Vec<PathBuf>, Failure> {
    let fail = |error| miette!("{} cannot be read: {error}", folder.display());
    let (mut entries, mut debris) = (Vec::new(), 0);
    for entry in std::fs::read_dir(folder).map_err(fail)? {
        let entry = entry.map_err(fail)?;
        if is_debris(&entry.path()) {
            debris += 1;
            continue;
        }
        let hidden = entry.file_name().as_encoded_bytes().starts_with(b".");
        let is_file = entry.file_type().map_err(fail)?.is_file();
        if !hidden && (!is_file || archive::is_archive(&entry.path())) {
            entries.push(entry.path());
        }
    }
    entries.sort();
    if let Some(note) = describe_debris(debris, &folder.display().to_string()) {
        tell(&note);
    }
    if entries.is_empty() {
        return Err(miette!(
            help = "put each entry into it as a folder of its own, or as a file of `ramp entry pack`",
            "there is no entry in {}",
            folder.display()
        ));
    }
    Ok(entries)
}

/// The board's name for the entry in a folder or an archive.
pub fn name(path: &Path) -> String {
    let name = if archive::is_archive(path) { path.file_stem() } else { path.file_name() };
    plain(&name.unwrap_or_default().to_string_lossy(), LONGEST_NAME)
}

impl Entry {
    /// Opens the entry in a folder or an archive. Files of an archive are unpacked to a temporary folder.
    ///
    /// # Errors
    /// If an archive is no entry, or cannot be unpacked.
    pub fn open(path: &Path) -> Result<Entry, ArchiveError> {
        let name = name(path);
        // A folder of that name is an entry like any other.
        if !archive::is_archive(path) || std::fs::symlink_metadata(path).is_ok_and(|meta| meta.is_dir()) {
            return Ok(Entry::of_folder(name, path));
        }
        let folder = archive::unpack(path, &LIMITS)?;
        Ok(Entry { name, folder: folder.path().to_path_buf(), _unpacked: Some(folder) })
    }

    /// The entry in a folder, under this name.
    pub fn of_folder(name: String, folder: &Path) -> Entry {
        Entry { name, folder: folder.to_path_buf(), _unpacked: None }
    }

    /// Reads an entry, and checks that a board can accept it.
    ///
    /// # Errors
    /// The first reason for rejecting it.
    pub fn read(
        &self,
        terms: &BoardTerms,
        known: &Known,
        verdicts: &Verdicts,
        allowance: &Allowance,
    ) -> Result<Checked, Failure> {
        if let Some(note) = describe_debris(self.check_files()?, &self.name) {
            tell(&note);
        }
        let collection = collect(std::slice::from_ref(&self.folder))?;
        let agent = plain(&agent(one_agent(&collection).into_diagnostic()?), LONGEST_NAME);
        check_whole(&collection, terms).into_diagnostic()?;
        if let Some(other) = known.find(&collection) {
            return Err(miette!(
                "entry {other} has these episodes of {agent} already: each goal and seed of an agent counts once"
            ));
        }
        let files = collection.entrants.iter().flat_map(|entrant| &entrant.files);
        let files: Vec<&ResultFile> = files.filter(|file| file.result.real.is_none()).collect();
        let logs = files.iter().map(|file| log_of(file)).collect::<Result<Vec<LogFile>, Failure>>()?;
        let facts = verdicts.facts(&logs, allowance).map_err(|why| miette!("{why}"))?;
        for (file, facts) in files.iter().zip(&facts) {
            check_log(file, facts, terms).into_diagnostic()?;
        }
        // Agents that do nothing have equal calls, so skip episodes without motion.
        let moved = files.iter().zip(&facts).filter(|(file, _)| file.result.time.robot > 0.0);
        let streams = moved.map(|(_, facts)| stream(facts)).collect();
        Ok(Checked { agent, logs, streams, collection })
    }

    /// Checks that the files of an entry are ordinary ones, and its results those of one agent.
    ///
    /// # Errors
    /// The first reason for rejecting it.
    pub fn check_agent(&self) -> Result<(), Failure> {
        self.check_files()?;
        let collection = collect(std::slice::from_ref(&self.folder))?;
        one_agent(&collection).into_diagnostic()?;
        Ok(())
    }

    /// Checks that an entry is a folder of regular files, within the limits on number and size. Links are not
    /// followed, since they may lead anywhere. Pipes and devices are not opened, since reading them may never
    /// end.
    /// Returns the number of files that a file manager left in it.
    fn check_files(&self) -> Result<usize, Failure> {
        let fail = |error: std::io::Error| miette!("it cannot be read: {error}");
        if !std::fs::symlink_metadata(&self.folder).map_err(fail)?.is_dir() {
            return Err(miette!("it is no folder; links are not followed"));
        }
        let (mut files, mut debris, mut results, mut total) = (0, 0, 0_u64, 0_u64);
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
            if is_debris(Path::new(&*name)) {
                debris += 1;
            }
            files += 1;
            if files > LIMITS.files {
                return Err(miette!("it has more than {} files", LIMITS.files));
            }
            total = total.saturating_add(meta.len());
            if name.ends_with(".json") {
                results = results.saturating_add(meta.len());
            }
        }
        if results > LIMITS.results {
            return Err(miette!("its results are larger than {} MiB", LIMITS.results >> 20));
        }
        if total > LIMITS.total {
            return Err(miette!("it is larger than {} MiB", LIMITS.total >> 20));
        }
        Ok(debris)
    }

    /// The reason for rejection, in one line. Files of the entry are given by name.
    pub fn reason(&self, why: &Failure) -> String {
        let whole = why.chain().map(ToString::to_string).collect::<Vec<_>>().join(": ");
        let folder = format!("{}{}", self.folder.display(), std::path::MAIN_SEPARATOR);
        let shown = plain(&folder, usize::MAX);
        plain(&whole.replace(&folder, "").replace(&shown, ""), LONGEST_REASON)
    }
}

/// The calls of an episode.
fn stream(facts: &Facts) -> Stream {
    let (track, goal) = (facts.track.clone(), facts.goal.name.clone());
    Stream { track, goal, seed: facts.seed, calls: facts.calls.clone() }
}

/// The log file beside a result, with its hash.
fn log_of(file: &ResultFile) -> Result<LogFile, Failure> {
    let path = file.path.with_extension(ENDING);
    if !path.exists() {
        return Err(miette!(
            "{} has no log {}, and only what can be run again goes on the board",
            file.path.display(),
            path.display()
        ));
    }
    let fail = |error: std::io::Error| miette!("{} cannot be read: {error}", path.display());
    let largest = Limits::default().file;
    let log = std::fs::File::open(&path).map_err(fail)?;
    if log.metadata().map_err(fail)?.len() > largest {
        return Err(miette!("{} is larger than {} MiB", path.display(), largest >> 20));
    }
    let sha256 = sha256_of(log).map_err(fail)?;
    Ok(LogFile { path, sha256 })
}
