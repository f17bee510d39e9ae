//! The benchmark's files, with each goal planned once.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};

use ramp_assembly::Assembly;
use ramp_data::{Data, DataError};
use ramp_kit::Kit;
use ramp_planner::Domains;
use ramp_robot::arm::ArmModel;
use ramp_twin::{Start, World};

use crate::tasks::{PlannedGoal, TaskError};

/// A problem of the benchmark's files, or a goal without a plan.
#[derive(Debug, thiserror::Error)]
pub enum BenchmarkError {
    /// A file that cannot be read, or a name that is not known.
    #[error(transparent)]
    Data(#[from] DataError),
    /// A goal without a plan.
    #[error("{goal}: {error}")]
    Plan {
        /// The goal.
        goal: String,
        /// The planner's reason.
        error: Box<TaskError>,
    },
}

/// The kit, the goals, the rules and the arm.
pub struct Benchmark {
    /// The files.
    pub data: Data,
    /// The kit.
    pub kit: Kit,
    /// The arm.
    pub arm: ArmModel,
    /// The planning rules.
    pub domains: Domains,
    /// Planned goals, by name or file.
    planned: Mutex<BTreeMap<String, Arc<PlannedGoal>>>,
}

impl Benchmark {
    /// Reads kit, arm and rules of a data folder, such as `data` of this repository.
    ///
    /// # Errors
    /// The first problem in them, with file, line and column.
    pub fn read(folder: &Path) -> Result<Benchmark, BenchmarkError> {
        let data = Data::folder(folder)?;
        let (kit, arm, domains) = (data.kit()?.clone(), data.arm()?, data.domains(None, None)?);
        Ok(Benchmark { data, kit, arm, domains, planned: Mutex::default() })
    }

    /// The names of the goals, easy ones first.
    ///
    /// # Errors
    /// If the folder of the goals cannot be read.
    pub fn goal_names(&self) -> Result<Vec<String>, BenchmarkError> {
        Ok(self.data.goal_names()?)
    }

    /// A goal by its name or its file.
    ///
    /// # Errors
    /// If there is no such goal, or the first problem in its file.
    pub fn goal(&self, name: &str) -> Result<Assembly, BenchmarkError> {
        Ok(self.data.goal(name)?)
    }

    /// A goal by its name or its file, with the contact steps of its plan. It is planned once.
    ///
    /// # Errors
    /// If it cannot be read or planned.
    pub fn planned(&self, name: &str) -> Result<Arc<PlannedGoal>, BenchmarkError> {
        let lock = || self.planned.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(goal) = lock().get(name) {
            return Ok(Arc::clone(goal));
        }
        let goal = PlannedGoal::new(self.goal(name)?, &self.domains)
            .map_err(|error| BenchmarkError::Plan { goal: name.to_string(), error: Box::new(error) })?;
        Ok(Arc::clone(lock().entry(name.to_string()).or_insert(Arc::new(goal))))
    }

    /// A start by its name or its file.
    ///
    /// # Errors
    /// If there is no such start, or the first problem in its file.
    pub fn start(&self, name: &str) -> Result<Start, BenchmarkError> {
        Ok(self.data.start(name)?)
    }

    /// A world by its name or its file.
    ///
    /// # Errors
    /// If there is no such world, or the first problem in its file.
    pub fn world(&self, name: &str) -> Result<World, BenchmarkError> {
        Ok(self.data.world(name)?)
    }
}
