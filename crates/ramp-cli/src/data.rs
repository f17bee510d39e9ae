//! Where the kit, the goals, the rules and the arm are read from.

use std::ffi::OsString;
use std::io::Write;
use std::path::{Path, PathBuf};

use miette::{IntoDiagnostic, Report, miette};
use ramp_assembly::Assembly;
use ramp_kit::Kit;
use ramp_log::Sources;
use ramp_planner::Domains;
use ramp_robot::arm::ArmModel;

/// The data folder.
pub struct Data {
    folder: PathBuf,
    /// A kit file in place of the folder's.
    kit: Option<PathBuf>,
}

impl Data {
    /// The folder that was named, else that of the checkout the program was built in.
    pub fn find(named: Option<PathBuf>, kit: Option<PathBuf>) -> Result<Data, Report> {
        let folder = named.unwrap_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data"));
        let folder = folder.canonicalize().unwrap_or(folder);
        if !folder.join("kit.xml").is_file() {
            return Err(miette!(
                help = "name the folder that holds it with --data DIR or RAMP_DATA",
                "there is no kit.xml in {}",
                folder.display()
            ));
        }
        Ok(Data { folder, kit })
    }

    /// What makes another process of this program read the same data.
    pub fn arguments(&self) -> Vec<OsString> {
        let mut arguments = vec!["--data".into(), self.folder.clone().into_os_string()];
        if let Some(kit) = &self.kit {
            arguments.extend(["--kit".into(), kit.clone().into_os_string()]);
        }
        arguments
    }

    /// The folder of the goals.
    pub fn goals(&self) -> PathBuf {
        self.folder.join("goals")
    }

    /// The kit.
    pub fn kit(&self) -> Result<Kit, Report> {
        Ok(ramp_kit::read_kit(&self.kit_path())?)
    }

    fn kit_path(&self) -> PathBuf {
        self.kit.clone().unwrap_or_else(|| self.folder.join("kit.xml"))
    }

    fn arm_path(&self) -> PathBuf {
        self.folder.join("arms/panda.json")
    }

    /// The file of the goal of that name, or that file.
    fn goal_path(&self, name: &str) -> Result<PathBuf, Report> {
        let as_file = Path::new(name);
        if name.ends_with(".xml") || as_file.components().count() > 1 {
            Ok(as_file.to_path_buf())
        } else {
            Ok(ramp_assembly::goal_path(&self.goals(), name)?)
        }
    }

    /// The goal of that name, or in that file.
    pub fn goal(&self, name: &str, kit: &Kit) -> Result<Assembly, Report> {
        Ok(ramp_assembly::read_goal(&self.goal_path(name)?, kit)?)
    }

    /// The texts of the files that an episode of this goal is made from, for its log.
    pub fn texts(&self, goal: &str) -> Result<Texts, Report> {
        let read = |path: &Path| {
            std::fs::read_to_string(path)
                .map_err(|error| miette!("{} cannot be read: {error}", path.display()))
        };
        Ok(Texts {
            goal: read(&self.goal_path(goal)?)?,
            kit: read(&self.kit_path())?,
            arm: read(&self.arm_path())?,
        })
    }

    /// The planner's rules.
    pub fn domains(&self) -> Result<Domains, Report> {
        Ok(Domains::read(&self.folder.join("domains"))?)
    }

    /// The arm.
    pub fn arm(&self) -> Result<ArmModel, Report> {
        ArmModel::read(&self.arm_path()).into_diagnostic()
    }
}

/// The files of an episode as texts.
pub struct Texts {
    goal: String,
    kit: String,
    arm: String,
}

impl Texts {
    /// As the log wants them.
    pub fn sources(&self) -> Sources<'_> {
        Sources { goal: &self.goal, kit: &self.kit, arm: &self.arm }
    }
}

/// Prints to standard output; whoever closed it early has seen enough.
pub fn print(text: &str) -> Result<(), Report> {
    match std::io::stdout().write_all(text.as_bytes()) {
        Err(error) if error.kind() == std::io::ErrorKind::BrokenPipe => Ok(()),
        other => other.into_diagnostic(),
    }
}

/// Refuses a path whose folder is not there, before any work is done.
pub fn check_writable(path: &Path) -> Result<(), Report> {
    let folder = match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    if !folder.is_dir() {
        return Err(miette!(
            help = "make the folder first, or name another file",
            "cannot write {}: there is no folder {}",
            path.display(),
            folder.display()
        ));
    }
    if path.is_dir() {
        return Err(miette!("cannot write {}: it is a folder", path.display()));
    }
    Ok(())
}
