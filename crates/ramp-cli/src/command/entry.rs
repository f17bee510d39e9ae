//! `ramp entry`: checks an entry as the board does, and packs it into one file that the board takes.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::{Path, PathBuf};

use miette::{Report as Failure, miette};
use ramp_data::Data;
use ramp_log::ENDING;
use ramp_report::leaderboard::Key;
use ramp_result::file::sha256_of;
use tempfile::NamedTempFile;

use crate::admission::{self, Admission, Admitted, Entry, Options, Verdicts};
use crate::output::{check_place, make_folder_of, print};
use crate::status::{DONE, INCOMPLETE, MachineFault};

#[derive(clap::Args)]
pub struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(clap::Subcommand)]
enum Command {
    /// Check an entry: what `ramp leaderboard` would do with it, and why
    Check(CheckArguments),
    /// Pack the files of an entry that a board reads into one archive
    Pack(PackArguments),
}

#[derive(clap::Args)]
struct CheckArguments {
    /// Folder with the results of one agent and their logs, or an archive of `ramp entry pack`
    #[arg(value_name = "DIR|FILE")]
    entry: PathBuf,
    #[command(flatten)]
    options: Options,
}

#[derive(clap::Args)]
struct PackArguments {
    /// Folder with the results of one agent and their logs
    #[arg(value_name = "DIR")]
    entry: PathBuf,
    /// The archive; its name without `.tar` is the entry's name on the board
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
}

pub fn run(data: &Data, arguments: &Arguments) -> Result<u8, Failure> {
    match &arguments.command {
        Command::Check(arguments) => check(data, arguments),
        Command::Pack(arguments) => pack(arguments),
    }
}

fn check(data: &Data, arguments: &CheckArguments) -> Result<u8, Failure> {
    let path = &arguments.entry;
    check_exists(path)?;
    let mut admission = Admission::new(data, &arguments.options, Verdicts::unstored())?;
    let outcome = match Admission::open(path)? {
        Ok(entry) => admission.admit(&entry)?,
        Err(reason) => Err(reason),
    };
    match outcome {
        Ok(admitted) => {
            let kept = admission.kept_elsewhere(&admitted);
            print(&summary(&admitted, kept))?;
            Ok(DONE)
        }
        Err(reason) => {
            print(&format!("would be refused: {reason}\n"))?;
            Ok(INCOMPLETE)
        }
    }
}

/// The rows of an admitted entry on a board, as text.
fn summary(admitted: &Admitted, kept: Result<BTreeMap<String, [usize; 2]>, String>) -> String {
    let mut text = format!("agent: {}\n", admitted.agent);
    for (entrant, timed_here) in admitted.collection.entrants.iter().zip(&admitted.timed_here) {
        let mut keys: Vec<Key> = Vec::new();
        for file in &entrant.files {
            let key = Key::of(&file.result);
            if !keys.contains(&key) {
                keys.push(key);
            }
        }
        for key in keys {
            let files = entrant.files.iter().filter(|file| Key::of(&file.result) == key);
            let results: Vec<_> = files.map(|file| &file.result).collect();
            let (counted, pegs) =
                results.iter().fold((0, 0), |sum, it| (sum.0 + it.counted(), sum.1 + it.pegs.len()));
            let _ = writeln!(
                text,
                "{}: {} results, {counted} of {pegs} pegs, rules {}",
                key.title(),
                results.len(),
                key.rules
            );
        }
        let lost = entrant.lost.len();
        if lost > 0 {
            let _ = writeln!(
                text,
                "track {}: {lost} lost for a technical reason, each 0 pegs; the same bench runs them again",
                entrant.identity.track
            );
        }
        if *timed_here {
            let _ = writeln!(text, "track {}: run again here, in a sandbox", entrant.identity.track);
        }
    }
    let _ = writeln!(text, "logs: {} run again, equal to the last bit", admitted.logs.len());
    match kept {
        Ok(kept) => {
            for (track, [own, all]) in kept {
                let _ = writeln!(
                    text,
                    "track {track}: played without sight on two other seeds, its calls keep {own} of {all} pegs"
                );
            }
        }
        Err(why) => {
            let _ = writeln!(text, "its calls cannot be played on other seeds: {why}");
        }
    }
    for warning in &admitted.warnings {
        let _ = writeln!(text, "warning: {}", warning.text);
    }
    text.push_str("would be admitted\n");
    text
}

/// Files of an entry that a board reads: results, their logs, signs of lost episodes, the agent.
fn is_read(path: &Path) -> bool {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let ending = path.extension().unwrap_or_default();
    let lost = ending == "log" && !path.with_extension("json").exists();
    let agent = admission::AGENT_NAMES.iter().any(|known| *known == name);
    let hidden = name.starts_with('.');
    path.is_file() && !hidden && (ending == "json" || ending == ENDING || lost || agent)
}

fn pack(arguments: &PackArguments) -> Result<u8, Failure> {
    let PackArguments { entry: folder, output } = arguments;
    check_exists(folder)?;
    if !folder.is_dir() {
        return Err(miette!("{} is no folder", folder.display()));
    }
    if output.extension().is_none_or(|ending| ending != "tar") {
        return Err(miette!(help = "end the file's name in .tar", "{} is no archive", output.display()));
    }
    check_place(output)?;
    let entry = Entry::of_folder(admission::name(output), folder);
    let whole = |why: &Failure| miette!("{}: {}", folder.display(), entry.reason(why));
    entry.check_agent().map_err(|why| whole(&why))?;
    let fail = |error: std::io::Error| miette!("{} cannot be read: {error}", folder.display());
    let mut files = Vec::new();
    for file in std::fs::read_dir(folder).map_err(fail)? {
        files.push(file.map_err(fail)?.path());
    }
    files.retain(|path| is_read(path));
    files.sort();
    make_folder_of(output)?;
    // The archive appears when it is complete.
    let place = output.parent().filter(|it| !it.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let mut file = NamedTempFile::new_in(place).map_err(MachineFault::of)?;
    admission::pack(&files, file.as_file_mut()).map_err(MachineFault::of)?;
    let mode = std::os::unix::fs::PermissionsExt::from_mode(0o644);
    file.as_file().set_permissions(mode).map_err(MachineFault::of)?;
    let hash = sha256_of(file.reopen().map_err(MachineFault::of)?).map_err(MachineFault::of)?;
    let size = file.as_file().metadata().map_err(MachineFault::of)?.len();
    file.persist(output).map_err(MachineFault::of)?;
    print(&format!(
        "{}: {} files, {:.1} MB, sha256 {hash}\n",
        output.display(),
        files.len(),
        size as f64 / 1e6
    ))?;
    Ok(DONE)
}

fn check_exists(path: &Path) -> Result<(), Failure> {
    match std::fs::symlink_metadata(path) {
        Ok(_) => Ok(()),
        Err(error) => Err(miette!("{} cannot be read: {error}", path.display())),
    }
}
