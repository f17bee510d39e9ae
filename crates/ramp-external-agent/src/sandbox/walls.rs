//! The walls that a process puts up around itself before it becomes an agent. None of them can be taken down
//! again.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::Command;

use landlock::{
    ABI, Access, AccessFs, AccessNet, BitFlags, CompatLevel, Compatible, Ruleset, RulesetAttr,
    RulesetCreatedAttr, RulesetError, Scope, path_beneath_rules,
};
use rustix::process::{Resource, Rlimit, setrlimit};

use super::filter::{self, FilterError};
use super::rooms::{self, RoomError, View};
use crate::powers::give_up_all;

/// The newest version of Landlock whose walls are all put up; an older kernel puts up fewer.
const NEWEST: ABI = ABI::V6;
/// Open files of one process.
const MOST_OPEN_FILES: u64 = 1024;
/// Devices that every program may use, and those of graphics cards.
///
/// `/dev/zero` is none of them: memory shared through it is counted by nothing.
const DEVICES: [&str; 4] = ["/dev/null", "/dev/full", "/dev/random", "/dev/urandom"];
const GRAPHICS: [&str; 3] = ["nvidia", "dri", "kfd"];

/// Facts about itself that an agent may read in `/proc/self`; what the kernel knows of the network is none.
const OWN_FACTS: [&str; 12] = [
    "auxv", "cgroup", "cmdline", "comm", "environ", "fd", "limits", "maps", "smaps", "stat", "statm",
    "status",
];

/// The restrictions that a process puts on itself.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Inside {
    /// Paths that it may read and execute.
    pub readable: Vec<PathBuf>,
    /// Paths that it may also write; its home and its folder for temporary files.
    pub folder: PathBuf,
    /// Space for its files, bytes.
    pub disk: u64,
    /// Processes and threads that it may have.
    pub tasks: u64,
    /// Whether it gets name spaces of its own.
    pub rooms: bool,
}

/// Why a wall does not stand.
#[derive(Debug, thiserror::Error)]
pub enum WallError {
    /// The name spaces.
    #[error("no name spaces: {0}")]
    Rooms(#[from] RoomError),
    /// The wall around the files.
    #[error("no rules for its files: {0}")]
    Files(#[from] RulesetError),
    /// The filter of system calls.
    #[error("no filter for its system calls: {0}")]
    Calls(#[from] FilterError),
    /// A limit.
    #[error("no limits: {0}")]
    Limit(#[from] rustix::io::Errno),
}

impl Inside {
    /// Puts up the walls around this process. Everything but memory that it holds is shut out from then on.
    /// With name spaces it returns in another process than the one that called.
    ///
    /// # Errors
    /// The first wall that does not stand; then the process must end.
    pub fn enter(&self) -> Result<(), WallError> {
        let devices = devices();
        let limit = |value| Rlimit { current: Some(value), maximum: Some(value) };
        setrlimit(Resource::Core, limit(0))?;
        if self.rooms {
            rooms::enter(&View {
                readable: &self.readable,
                devices: &devices,
                folder: &self.folder,
                size: self.disk,
            })?;
            // The run counts them as well. This one holds between two of its looks.
            setrlimit(Resource::Nproc, limit(2 * self.tasks))?;
        }
        give_up_all();
        setrlimit(Resource::Fsize, limit(self.disk))?;
        setrlimit(Resource::Nofile, limit(MOST_OPEN_FILES))?;
        let read = AccessFs::from_read(NEWEST);
        let write = AccessFs::WriteFile | AccessFs::IoctlDev;
        Ruleset::default()
            .set_compatibility(CompatLevel::BestEffort)
            .handle_access(AccessFs::from_all(NEWEST))?
            .handle_access(AccessNet::from_all(NEWEST))?
            .scope(Scope::from_all(NEWEST))?
            .create()?
            .add_rules(path_beneath_rules(&self.readable, read))?
            .add_rules(path_beneath_rules(OWN_FACTS.map(|fact| format!("/proc/self/{fact}")), read))?
            .add_rules(path_beneath_rules(&devices, read | write))?
            .add_rules(path_beneath_rules([&self.folder], everything()))?
            .restrict_self()?;
        filter::apply(has_graphics(&devices))?;
        Ok(())
    }

    /// The agent's program with an environment that tells nothing of the user.
    pub fn command(&self, program: &OsString, arguments: &[OsString]) -> Command {
        let mut command = Command::new(program);
        command
            .args(arguments)
            .current_dir(&self.folder)
            .env_clear()
            .env("PATH", "/usr/local/bin:/usr/bin:/bin")
            .env("LANG", "C.UTF-8")
            .env("HOME", &self.folder)
            .env("TMPDIR", &self.folder)
            .env("PYTHONDONTWRITEBYTECODE", "1");
        command
    }
}

/// All that can be done with files of one's own, but for making devices.
fn everything() -> BitFlags<AccessFs> {
    AccessFs::from_all(NEWEST) & !(AccessFs::MakeChar | AccessFs::MakeBlock)
}

/// The devices that are here.
fn devices() -> Vec<PathBuf> {
    let mut devices: Vec<PathBuf> = DEVICES.iter().map(PathBuf::from).collect();
    for entry in std::fs::read_dir("/dev").into_iter().flatten().flatten() {
        let name = entry.file_name();
        if GRAPHICS.iter().any(|known| name.to_string_lossy().starts_with(known)) {
            devices.push(entry.path());
        }
    }
    devices.retain(|path| path.exists());
    devices
}

/// Whether a graphics card is among the devices.
fn has_graphics(devices: &[PathBuf]) -> bool {
    devices.iter().any(|path| !DEVICES.iter().any(|known| path == Path::new(known)))
}

/// Whether a graphics card is here, whose driver needs calls that are refused elsewhere.
pub fn graphics() -> bool {
    has_graphics(&devices())
}

/// Whether this kernel has what a sandbox needs: Landlock.
pub fn is_available() -> bool {
    stands(ABI::V1)
}

/// Gaps of the sandbox on this system, in words; `rooms` says whether the agent gets name spaces of its own.
pub fn open_ends(rooms: bool) -> Vec<&'static str> {
    let newest = [ABI::V6, ABI::V5, ABI::V4, ABI::V3, ABI::V2, ABI::V1].into_iter().find(|it| stands(*it));
    let version = newest.unwrap_or(ABI::Unsupported);
    let mut ends = Vec::new();
    if !rooms {
        ends.push("the numbers of other processes (no name spaces of its own here)");
        ends.push("names, sizes and dates of files whose paths it guesses");
        ends.push("marks that reading leaves on its own files");
        ends.push("space of unlinked files that it holds only in memory");
        if version < ABI::V6 {
            ends.push("signals to other processes of yours (needs Linux 6.12)");
        }
    }
    if graphics() {
        ends.push("the graphics card, and memory that it shares with it");
        if version < ABI::V5 {
            ends.push("control calls on the devices that it may use (needs Linux 6.10)");
        }
    }
    ends.push("how busy the machine is, and locks on files that several agents may read");
    ends
}

/// Whether this kernel has all that a version of Landlock has.
fn stands(version: ABI) -> bool {
    let ruleset = Ruleset::default().set_compatibility(CompatLevel::HardRequirement);
    let ruleset = ruleset.handle_access(AccessFs::from_all(version));
    let ruleset = match version >= ABI::V4 {
        true => ruleset.and_then(|it| it.handle_access(AccessNet::from_all(version))),
        false => ruleset,
    };
    let ruleset = match version >= ABI::V6 {
        true => ruleset.and_then(|it| it.scope(Scope::from_all(version))),
        false => ruleset,
    };
    ruleset.and_then(Ruleset::create).is_ok()
}
