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

use super::calls::{self, FilterError};

/// The newest version of Landlock whose walls are all put up; an older kernel puts up fewer.
const NEWEST: ABI = ABI::V6;
/// Open files of one process.
const MOST_OPEN_FILES: u64 = 1024;
/// Devices that every program may use, and those of graphics cards.
const DEVICES: [&str; 5] = ["/dev/null", "/dev/zero", "/dev/full", "/dev/random", "/dev/urandom"];
const GRAPHICS: [&str; 3] = ["nvidia", "dri", "kfd"];

/// The restrictions that a process puts on itself.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Inside {
    /// Paths that it may read and execute.
    pub readable: Vec<PathBuf>,
    /// Paths that it may also write; its home and its folder for temporary files.
    pub folder: PathBuf,
    /// Largest file that it may write, bytes.
    pub largest_file: u64,
}

/// Why a wall does not stand.
#[derive(Debug, thiserror::Error)]
pub enum WallError {
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
    ///
    /// # Errors
    /// The first wall that does not stand; then the process must end.
    pub fn enter(&self) -> Result<(), WallError> {
        let limit = |value| Rlimit { current: Some(value), maximum: Some(value) };
        setrlimit(Resource::Core, limit(0))?;
        setrlimit(Resource::Fsize, limit(self.largest_file))?;
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
            .add_rules(path_beneath_rules(["/proc/self"], read))?
            .add_rules(path_beneath_rules(devices(), AccessFs::from_read(NEWEST) | write))?
            .add_rules(path_beneath_rules([&self.folder], everything()))?
            .restrict_self()?;
        calls::refuse()?;
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

/// Gaps of the sandbox on this system, in words; `None` without any sandbox.
pub fn open_ends() -> Option<Vec<&'static str>> {
    let version = [ABI::V6, ABI::V5, ABI::V4, ABI::V3, ABI::V2, ABI::V1]
        .into_iter()
        .find(|version| stands(*version))?;
    let mut ends = Vec::new();
    if version < ABI::V6 {
        ends.push("signals to other processes of yours (needs Linux 6.12)");
    }
    if version < ABI::V5 {
        ends.push("control calls on the devices that it may use (needs Linux 6.10)");
    }
    if devices().iter().any(|path| !DEVICES.iter().any(|known| path == Path::new(known))) {
        ends.push("the graphics card");
    }
    ends.push("names, sizes and dates of files whose paths it guesses");
    ends.push("how busy the machine is");
    Some(ends)
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
