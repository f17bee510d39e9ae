//! `ramp leaderboard`: a static site of many entries. Each entry's logs are replayed before it is listed.

mod control;

use std::path::{Path, PathBuf};
use std::time::Duration;

use miette::{Report as Failure, miette};
use ramp_data::Data;
use ramp_report::leaderboard::{Boards, Control, Key, Refusal, Standing, pages, standings};
use ramp_report::{Report, page};

use self::control::Row;
use crate::admission::{self, Admission, Admitted, Entry, Options, Verdicts};
use crate::lock::{FolderLock, LockError};
use crate::output::{print, tell};
use crate::site::Site;
use crate::status::{DONE, INCOMPLETE, MachineFault};

/// Interval at which a board looks whether another has left the site.
const WAIT: Duration = Duration::from_millis(500);

#[derive(clap::Args)]
pub struct Arguments {
    /// Folder of entries: each folder or archive in it holds the results of one agent, with their logs
    entries: PathBuf,
    /// Folder for the site and the verdicts on the logs
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    #[command(flatten)]
    options: Options,
    /// Run the baseline and the blind tape for each board that lacks these rows. This takes as long as two
    /// benches of that class
    #[arg(long)]
    control: bool,
}

/// Boards and site of one leaderboard.
struct Board {
    boards: Boards,
    refused: Vec<Refusal>,
    site: Site,
    /// Agent pages written so far.
    agents: usize,
}

pub fn run(data: &Data, arguments: &Arguments) -> Result<u8, Failure> {
    let paths = admission::entries(&arguments.entries)?;
    check_apart(&arguments.entries, &arguments.output)?;
    // Bad terms are an error before anything is written.
    Admission::new(data, &arguments.options, Verdicts::unstored())?;
    let site = Site::open(&arguments.output)?;
    let _lock = lock(&arguments.output)?;
    let mut admission = Admission::new(data, &arguments.options, Verdicts::open(&arguments.output)?)?;
    let mut board = Board { boards: Boards::default(), refused: Vec::new(), site, agents: 0 };
    let mut admitted = 0;
    for (index, path) in paths.iter().enumerate() {
        let name = admission::name(path);
        tell(&format!("entry {} of {}: {name}", index + 1, paths.len()));
        // An invalid entry is left out; the others are still listed.
        let outcome = match Admission::open(path)? {
            Ok(entry) => admission.admit(&entry)?,
            Err(reason) => Err(reason),
        };
        match outcome {
            Ok(entry) => {
                admitted += 1;
                print(&format!("admitted {name}: {}\n", entry.agent))?;
                for warning in &entry.warnings {
                    print(&format!("warning {name}: {}\n", warning.text))?;
                }
                for (key, standing) in board.list(&name, entry)? {
                    board.boards.add(key, standing);
                }
            }
            Err(reason) => {
                print(&format!("refused {name}: {reason}\n"))?;
                board.refused.push(Refusal { entry: name, reason });
            }
        }
    }
    board.add_controls(data, &mut admission, arguments)?;
    // Write the front page last, so that all its links exist.
    let compared = |key: &Key| admission.terms().compared(key.class.as_deref(), key.arm.as_deref());
    for (name, text) in pages::pages(&board.boards, &board.refused, &compared) {
        board.site.write(&name, &text)?;
    }
    board.site.remove_others(&["agent-", "board-", "refused"])?;
    let [run, remembered] = admission.verdicts().counts();
    print(&format!(
        "{admitted} of {} entries admitted; {run} logs run again, {remembered} known from before\nsite: {}\n",
        paths.len(),
        arguments.output.join(pages::INDEX).display()
    ))?;
    Ok(if board.refused.is_empty() { DONE } else { INCOMPLETE })
}

/// Waits until no other board writes to the site, and keeps it for this one.
fn lock(site: &Path) -> Result<FolderLock, Failure> {
    let mut told = false;
    loop {
        match FolderLock::take(site) {
            Ok(lock) => return Ok(lock),
            Err(LockError::Busy { who }) => {
                if !told {
                    let (site, who) = (site.display(), who.unwrap_or_default());
                    tell(&format!("another board writes to {site}{who}: waiting for it"));
                    told = true;
                }
                std::thread::sleep(WAIT);
            }
            Err(LockError::Failed(error)) => {
                return Err(MachineFault::of(format!("{} cannot be locked: {error}", site.display())).into());
            }
        }
    }
}

impl Board {
    /// Writes the pages of an entry's agents, and returns its rows.
    ///
    /// # Errors
    /// If the site cannot be written.
    fn list(&mut self, name: &str, entry: Admitted) -> Result<Vec<(Key, Standing)>, Failure> {
        let before = self.agents;
        let agent_page = |index: usize| page::agent_page(before + index);
        let Admitted { agent, collection, timed, timed_here, warnings, .. } = entry;
        let mut rows = standings(name, &agent, &timed, agent_page, |index| timed_here[index]);
        for (key, standing) in &mut rows {
            let here = |track: &Option<String>| track.as_ref().is_none_or(|track| *track == key.track);
            standing.warnings =
                warnings.iter().filter(|it| here(&it.track)).map(|it| it.text.clone()).collect();
        }
        let report = Report::new(collection);
        for index in 0..report.collection.entrants.len() {
            let text = page::of_agent(&report.of_agent(index), (pages::INDEX, pages::TITLE));
            self.site.write(&agent_page(index), &text)?;
            self.agents += 1;
        }
        Ok(rows)
    }

    /// Adds the organiser's rows to the boards that have an entry.
    fn add_controls(
        &mut self,
        data: &Data,
        admission: &mut Admission,
        arguments: &Arguments,
    ) -> Result<(), Failure> {
        let keys: Vec<Key> = self.boards.boards().iter().map(|board| board.key.clone()).collect();
        let secret = arguments.options.secret.as_deref();
        for (key, row) in
            keys.iter().filter(|key| key.robot.is_none()).flat_map(|key| Row::ALL.map(|row| (key, row)))
        {
            let folder = row.folder(&arguments.output, key);
            if arguments.control
                && let Err(why) = control::make(data, key, row, &arguments.output, secret)?
            {
                print(&format!("no {} row on {}: {why}\n", row.label(), key.title()))?;
                continue;
            }
            if !folder.is_dir() {
                continue;
            }
            let entry = Entry::of_folder(format!("{} {}", row.label(), key.slug()), &folder);
            let admitted = match row {
                Row::Control => admission.admit_control(&entry)?,
                Row::Floor => admission.admit_floor(&folder)?,
            };
            match admitted {
                Ok(entry) => {
                    let rows = self.list(row.label(), entry)?;
                    for (found, standing) in rows.into_iter().filter(|(found, _)| found == key) {
                        let label = row.label().to_string();
                        self.boards.add_control(&found, Control { label, standing });
                    }
                }
                Err(why) => print(&format!("no {} row on {}: {why}\n", row.label(), key.title()))?,
            }
        }
        Ok(())
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
