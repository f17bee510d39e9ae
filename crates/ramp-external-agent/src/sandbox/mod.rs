//! The sandbox of an agent whose author is a stranger.
//!
//! The run looks for what the agent must read ([`Sandbox::find`]) and gives it a folder of its own. The
//! process that is about to become the agent puts up the walls around itself (`walls`): name spaces of its
//! own (`rooms`), which files it may open (Landlock), which system calls it may make (`filter`, from the
//! list in [`calls`]), and limits of each process. The run then watches the memory, processes and disk space
//! that the agent uses with all that it has started (`watch`).

pub mod calls;
mod filter;
mod python;
mod rooms;
mod sys;
mod walls;
mod watch;

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use tempfile::TempDir;

use crate::file::AgentFile;
use crate::limits::Allowance;
pub use walls::{Inside, WallError, graphics, is_available, open_ends};
pub(crate) use watch::Watch;

/// Folders and files of the system that every program may read and execute, where they exist.
const SYSTEM: [&str; 22] = [
    "/usr",
    "/lib",
    "/lib32",
    "/lib64",
    "/bin",
    "/sbin",
    "/etc/alternatives",
    "/etc/fonts",
    "/etc/ld.so.cache",
    "/etc/ld.so.conf",
    "/etc/ld.so.conf.d",
    "/etc/locale.alias",
    "/etc/localtime",
    "/etc/mime.types",
    "/etc/nsswitch.conf",
    "/etc/OpenCL",
    "/etc/ssl/certs",
    "/proc/cpuinfo",
    "/proc/meminfo",
    "/proc/sys/vm/overcommit_memory",
    "/sys/devices/system/cpu",
    "/sys/devices/system/node",
];

/// Why there is no sandbox.
#[derive(Debug, thiserror::Error)]
pub enum SandboxError {
    /// The kernel cannot.
    #[error("this system has no Landlock, which a sandbox needs (Linux 5.13 or newer, and not switched off)")]
    NoLandlock,
    /// A path that the agent may read contains one that it must not see.
    #[error("{hidden} lies in {folder}, which the agent may read")]
    Exposed {
        /// The path that it must not see.
        hidden: PathBuf,
        /// Paths that it may read.
        folder: PathBuf,
    },
    /// There is no Python.
    #[error("`python3` does not tell where it is: {what}")]
    Python {
        /// Its message.
        what: String,
    },
    /// The agent's own folder cannot be made.
    #[error("the agent's own folder cannot be made: {0}")]
    Folder(std::io::Error),
}

/// The sandbox of one agent.
#[derive(Debug)]
pub struct Sandbox {
    /// The agent's command: program and arguments.
    command: Vec<OsString>,
    /// Paths that it may read.
    readable: Vec<PathBuf>,
    /// The only folder that it may write to. It goes with the sandbox.
    folder: TempDir,
    allowance: Allowance,
    /// Whether the agent gets name spaces of its own.
    rooms: bool,
}

impl Sandbox {
    /// A sandbox with all that an agent needs: its file and the folder of it, the system's programs and
    /// libraries, and for a Python file the Python that `python3` is, with its packages. `hidden` are files
    /// and folders that it must not see, such as that of the results.
    ///
    /// # Errors
    /// When the system has no sandbox, or a hidden path lies where the agent may read.
    pub fn find(agent: &AgentFile, hidden: &[&Path]) -> Result<Sandbox, SandboxError> {
        if !is_available() {
            return Err(SandboxError::NoLandlock);
        }
        let own = agent.path().parent().unwrap_or(Path::new("/")).to_path_buf();
        let mut readable: Vec<PathBuf> = SYSTEM.iter().map(PathBuf::from).collect();
        readable.push(own);
        let mut command = agent.command();
        if agent.is_python() {
            let (program, folders) = python::find().map_err(|what| SandboxError::Python { what })?;
            command[0] = program;
            readable.extend(folders);
        }
        readable.retain(|path| path.exists());
        for hidden in hidden {
            let place = absolute(hidden);
            let within = |folder: &&PathBuf| folder.canonicalize().is_ok_and(|it| place.starts_with(it));
            if let Some(folder) = readable.iter().find(within) {
                return Err(SandboxError::Exposed { hidden: hidden.to_path_buf(), folder: folder.clone() });
            }
        }
        let folder =
            tempfile::Builder::new().prefix("ramp-agent-").tempdir().map_err(SandboxError::Folder)?;
        Ok(Sandbox { command, readable, folder, allowance: Allowance::default(), rooms: false })
    }

    /// The same with another allowance.
    #[must_use]
    pub fn with_allowance(mut self, allowance: Allowance) -> Sandbox {
        self.allowance = allowance;
        self
    }

    /// The same with name spaces of the agent's own. Whether a system allows them shows only when a process
    /// [enters](Inside::enter) them.
    #[must_use]
    pub fn with_rooms(mut self) -> Sandbox {
        self.rooms = true;
        self
    }

    /// The same without them.
    #[must_use]
    pub fn without_rooms(mut self) -> Sandbox {
        self.rooms = false;
        self
    }

    /// Whether the agent gets name spaces of its own.
    pub fn has_rooms(&self) -> bool {
        self.rooms
    }

    /// The only folder that the agent may write to. It is gone when the sandbox is.
    pub fn folder(&self) -> &Path {
        self.folder.path()
    }

    /// The walls, for the process that is about to become the agent.
    pub fn inside(&self) -> Inside {
        Inside {
            readable: self.readable.clone(),
            folder: self.folder.path().to_path_buf(),
            disk: self.allowance.disk,
            tasks: self.allowance.tasks as u64,
            rooms: self.rooms,
        }
    }

    /// The agent's command.
    pub fn command(&self) -> &[OsString] {
        &self.command
    }

    /// Watches all children of this process but those in `before`.
    pub(crate) fn watch(&self, before: Vec<i32>) -> Watch {
        let own = if self.rooms { rooms::OWN_PROCESSES } else { 0 };
        Watch::begin(self.allowance, own, self.folder.path().to_path_buf(), before)
    }
}

/// The place of a path that need not exist: the nearest existing folder, and the rest.
fn absolute(path: &Path) -> PathBuf {
    let path = std::path::absolute(path).unwrap_or_else(|_| path.to_path_buf());
    let existing = path.ancestors().find_map(|part| Some((part, part.canonicalize().ok()?)));
    match existing {
        Some((part, place)) => place.join(path.strip_prefix(part).unwrap_or(Path::new(""))),
        None => path,
    }
}
