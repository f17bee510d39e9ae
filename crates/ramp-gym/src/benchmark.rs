//! The benchmark's files, read from a folder: kit, goals, rules, arm, worlds.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

use ramp_assembly::Assembly;
use ramp_kit::Kit;
use ramp_kit::source::{is_name, nearest, shorten};
use ramp_planner::Domains;
use ramp_robot::arm::ArmModel;
use ramp_twin::World;

use crate::tasks::{Goal, TaskError};

/// What is wrong with the files, or with a name.
#[derive(Debug, thiserror::Error)]
pub enum DataError {
    /// The kit or a goal.
    #[error("{0}")]
    Kit(String),
    /// The rules of the planner.
    #[error("{0}")]
    Domains(String),
    /// The arm.
    #[error("{0}")]
    Arm(String),
    /// A world file.
    #[error("{0}")]
    World(String),
    /// A goal has no plan.
    #[error("{goal}: {error}")]
    Plan {
        /// The goal.
        goal: String,
        /// Why.
        error: Box<TaskError>,
    },
    /// A folder that cannot be read.
    #[error("the folder {folder} cannot be read: {error}")]
    Folder {
        /// Its path.
        folder: String,
        /// What the system says.
        error: std::io::Error,
    },
    /// There is no such name.
    #[error("there is no {what} `{name}`; {help}")]
    Unknown {
        /// What was looked for.
        what: &'static str,
        /// Its name.
        name: String,
        /// What is near it, or all that there are.
        help: String,
    },
}

/// The kit, the goals, the rules and the arm.
pub struct Benchmark {
    /// The folder that they were read from.
    pub folder: PathBuf,
    /// The parts.
    pub kit: Kit,
    /// The arm.
    pub arm: ArmModel,
    /// The planner's rules.
    pub domains: Domains,
    /// Goals that were planned, by name or file.
    planned: Mutex<BTreeMap<String, Arc<Goal>>>,
}

impl Benchmark {
    /// Reads kit, arm and rules of a data folder, such as `data` of this repository.
    ///
    /// # Errors
    /// The first thing that is wrong in them, with file, line and column.
    pub fn read(folder: &Path) -> Result<Benchmark, DataError> {
        let kit =
            ramp_kit::read_kit(&folder.join("kit.xml")).map_err(|it| DataError::Kit(format!("{it:#}")))?;
        let arm = ArmModel::read(&folder.join("arms/panda.json"));
        Ok(Benchmark {
            folder: folder.to_path_buf(),
            kit,
            arm: arm.map_err(|it| DataError::Arm(it.to_string()))?,
            planned: Mutex::default(),
            domains: Domains::read(&folder.join("domains"))
                .map_err(|it| DataError::Domains(format!("{it:#}")))?,
        })
    }

    /// The names of the goals, easy ones first.
    ///
    /// # Errors
    /// When the folder of the goals cannot be read.
    pub fn goal_names(&self) -> Result<Vec<String>, DataError> {
        let folder = self.folder.join("goals");
        ramp_assembly::goal_names(&folder)
            .map_err(|error| DataError::Folder { folder: folder.display().to_string(), error })
    }

    /// The file of the goal of that name; a name that ends in `.xml` or has a folder in it is a file itself.
    ///
    /// # Errors
    /// When there is no goal of that name.
    pub fn goal_file(&self, name: &str) -> Result<PathBuf, DataError> {
        let as_file = Path::new(name);
        if name.ends_with(".xml") || as_file.components().count() > 1 {
            return Ok(as_file.to_path_buf());
        }
        let names = self.goal_names()?;
        if names.iter().all(|known| known != name) {
            return Err(unknown("goal", name, names.iter().map(String::as_str)));
        }
        Ok(self.folder.join(format!("goals/{name}.xml")))
    }

    /// The goal of that name, or in that file.
    ///
    /// # Errors
    /// When there is none, or something is wrong in its file.
    pub fn goal(&self, name: &str) -> Result<Assembly, DataError> {
        let file = self.goal_file(name)?;
        ramp_assembly::read_goal(&file, &self.kit).map_err(|it| DataError::Kit(format!("{it:#}")))
    }

    /// The goal of that name, or in that file, with the contact steps of its plan. It is planned once.
    ///
    /// # Errors
    /// When it cannot be read or planned.
    pub fn planned(&self, name: &str) -> Result<Arc<Goal>, DataError> {
        let lock = || self.planned.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(goal) = lock().get(name) {
            return Ok(Arc::clone(goal));
        }
        let goal = Goal::new(self.goal(name)?, &self.domains)
            .map_err(|error| DataError::Plan { goal: name.to_string(), error: Box::new(error) })?;
        Ok(Arc::clone(lock().entry(name.to_string()).or_insert(Arc::new(goal))))
    }

    /// The world of that name, or in that file.
    ///
    /// # Errors
    /// When there is none, or something is wrong in its file.
    pub fn world(&self, name: &str) -> Result<World, DataError> {
        let as_file = Path::new(name);
        let read = |path: &Path| World::read(path).map_err(|it| DataError::World(format!("{it:#}")));
        if name.ends_with(".toml") || as_file.components().count() > 1 {
            return read(as_file);
        }
        let path = self.folder.join(format!("worlds/{name}.toml"));
        if is_name(name) && path.is_file() {
            return read(&path);
        }
        World::shipped(name).cloned().ok_or_else(|| unknown("world", name, World::names()))
    }
}

/// The error that there is no such name.
pub(crate) fn unknown<'n>(what: &'static str, name: &str, known: impl Iterator<Item = &'n str>) -> DataError {
    let known: Vec<&str> = known.collect();
    let help = match nearest(name, known.iter().copied()) {
        Some(near) => format!("did you mean `{near}`?"),
        None => format!("there are {}", known.join(", ")),
    };
    DataError::Unknown { what, name: shorten(name), help }
}
