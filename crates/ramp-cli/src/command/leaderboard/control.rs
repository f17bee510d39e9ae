//! The organiser's rows of a board, run by this program on the board's class, track, world and start: the
//! control, which is the baseline, and the floor, which is the blind tape of the control's logs. Their
//! results stay in the site, so that they are made once for each board, version and rules.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::Stdio;

use miette::Report as Failure;
use ramp_data::Data;
use ramp_report::leaderboard::Key;
use ramp_report::report::repeats;
use ramp_result::collection::collect;
use ramp_result::sha256;
use ramp_world::World;

use crate::ending::end_of;
use crate::seal;
use crate::software::software;
use crate::status::{DONE, INCOMPLETE, MACHINE, MachineFault};

/// A row of the organiser.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Row {
    /// The baseline.
    Control,
    /// The commands of the control's logs, each played without sight on another seed than its own.
    Floor,
}

impl Row {
    /// Both, in order: the floor needs the logs of the control.
    pub const ALL: [Row; 2] = [Row::Control, Row::Floor];

    /// Its name on the board.
    pub fn label(self) -> &'static str {
        match self {
            Row::Control => "control",
            Row::Floor => "floor",
        }
    }

    /// The folder of its results in the site.
    pub fn folder(self, site: &Path, key: &Key) -> PathBuf {
        site.join(self.label()).join(key.slug())
    }
}

/// Runs a row for a board, unless the folder has its results from this program. The bench shows its
/// progress on standard error. Returns the reason if this board has no such row.
///
/// # Errors
/// If this machine fails.
pub fn make(
    data: &Data,
    key: &Key,
    row: Row,
    site: &Path,
    secret: Option<&Path>,
) -> Result<Result<(), String>, Failure> {
    let Some(class) = &key.class else { return Ok(Err("its goals have no class".to_string())) };
    let shipped = |name: &str| World::shipped(name).map(|world| sha256(world.text.as_bytes()));
    let Some(world) = key.world.as_ref().filter(|it| shipped(&it.name).as_ref() == Some(&it.sha256)) else {
        return Ok(Err("its world is not one of this program's".to_string()));
    };
    // Starts of boards are the program's.
    let start = key.start.as_ref().map_or("moved", |it| it.name.as_str());
    // Results of another program are replaced.
    let folder = row.folder(site, key);
    if folder.exists() && !is_of_this_program(&folder) {
        std::fs::remove_dir_all(&folder).map_err(MachineFault::of)?;
    }
    let mut words = data.arguments();
    words.extend(
        ["bench", "--track", &key.track, "--world", &world.name, "--start", start].map(OsString::from),
    );
    words.extend(key.arm.iter().flat_map(|arm| ["--arm", arm]).map(OsString::from));
    let repeats = repeats(Some(class));
    words.extend(["--repeats".into(), repeats.to_string().into(), "-o".into(), folder.into()]);
    if row == Row::Floor {
        words.extend(["--tape".into(), Row::Control.folder(site, key).into()]);
        // A tape is played on another seed than its own, and the control has one seed only.
        words.extend(
            (repeats == 1).then_some(["--first-seed", "2"]).into_iter().flatten().map(OsString::from),
        );
    }
    words.extend(secret.iter().flat_map(|secret| ["--secret".into(), OsString::from(secret)]));
    words.extend(["--", class].map(OsString::from));
    // The bench ends with this program.
    let mut bench = seal::child(&words, |command| {
        command.stdout(Stdio::null());
    })
    .map_err(MachineFault::of)?;
    // Waiting closes the child's standard input, and a child whose input is closed ends.
    let _leash = bench.stdin.take();
    let status = bench.wait().map_err(MachineFault::of)?;
    match status.code().and_then(|code| u8::try_from(code).ok()) {
        Some(DONE | INCOMPLETE) => Ok(Ok(())),
        Some(MACHINE) => {
            Err(MachineFault { what: format!("the row `{}` cannot be run", row.label()) }.into())
        }
        _ => Ok(Err(format!("its bench {}", end_of(status)))),
    }
}

/// Whether the results in a folder were made by this version and commit.
fn is_of_this_program(folder: &Path) -> bool {
    let ours = software();
    collect(&[folder.to_path_buf()]).is_ok_and(|it| {
        it.entrants.iter().all(|entrant| {
            let identity = &entrant.identity;
            (&identity.version, &identity.commit) == (&ours.version, &ours.commit)
        })
    })
}
