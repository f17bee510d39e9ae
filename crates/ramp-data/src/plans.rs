//! Plans of another planner that the baseline executes in place of its own: a file with the plan of one goal,
//! or a folder with a file for each goal.

use std::path::{Path, PathBuf};

use ramp_assembly::Assembly;
use ramp_planner::{Domains, Plan, PlanFileError, read_plan};
use ramp_source::{ReadError, plain, read_text, shorten};
use sha2::{Digest, Sha256};

/// Largest size of a plan file, bytes.
pub const LARGEST_PLAN: usize = 16 << 20;
/// Largest number of files in a folder of plans.
pub const MOST_PLANS: usize = 1000;

/// Why plans are not accepted.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
#[non_exhaustive]
pub enum PlansError {
    /// A file that is no readable text.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Read(#[from] ReadError),
    /// A folder that cannot be read.
    #[error("the folder of plans {folder} cannot be read: {why}")]
    Folder {
        /// The folder.
        folder: String,
        /// The reason.
        why: String,
    },
    /// A goal without a plan.
    #[error("the folder {folder} has no plan for the goal {goal}")]
    #[diagnostic(help(
        "name each file after its goal, such as {goal}.json or {goal}.plan; `ramp plan {goal} --json` writes one"
    ))]
    None {
        /// The folder.
        folder: String,
        /// The goal's name.
        goal: String,
    },
    /// Two plans for one goal.
    #[error("{first} and {second} are two plans for one goal")]
    #[diagnostic(help("keep one of the files"))]
    Two {
        /// One file.
        first: String,
        /// The other file.
        second: String,
    },
    /// One file for many goals.
    #[error("{file} is the plan of one goal, and there are {goals} goals")]
    #[diagnostic(help("name a folder with a file for each goal, such as easy-1.json"))]
    OneFile {
        /// The file.
        file: String,
        /// Number of goals.
        goals: usize,
    },
    /// A plan that the rules, or its form, do not allow.
    #[error("{file}{}{source}", separator(source))]
    Plan {
        /// The file.
        file: String,
        /// The reason.
        source: PlanFileError,
    },
}

/// The text between a file's name and the reason: errors of form begin with line and column.
fn separator(error: &PlanFileError) -> &'static str {
    if matches!(error, PlanFileError::Form { .. }) { ":" } else { ": " }
}

/// One plan: its file and text.
struct PlanText {
    path: PathBuf,
    text: String,
}

/// The plans in a file or folder, with a hash of them all.
pub struct Plans {
    path: PathBuf,
    folder: bool,
    plans: Vec<PlanText>,
    sha256: String,
}

impl Plans {
    /// The plans in a file or folder. Files of a folder whose names begin with a dot are left out.
    ///
    /// # Errors
    /// If a file cannot be read, or a folder has two plans for one goal.
    pub fn read(path: &Path) -> Result<Plans, PlansError> {
        if !path.is_dir() {
            let text = read_text(path, LARGEST_PLAN)?;
            return Ok(Plans::of_text(path, text));
        }
        let fail = |why: String| PlansError::Folder { folder: shown(path), why };
        let mut paths = Vec::new();
        for entry in std::fs::read_dir(path).map_err(|error| fail(error.to_string()))? {
            let file = entry.map_err(|error| fail(error.to_string()))?.path();
            let hidden = file.file_name().is_some_and(|name| name.to_string_lossy().starts_with('.'));
            if file.is_file() && !hidden {
                paths.push(file);
            }
            if paths.len() > MOST_PLANS {
                return Err(fail(format!("it has more than {MOST_PLANS} files")));
            }
        }
        paths.sort();
        for pair in paths.windows(2) {
            if pair[0].file_stem() == pair[1].file_stem() {
                return Err(PlansError::Two { first: shown(&pair[0]), second: shown(&pair[1]) });
            }
        }
        let mut hash = Sha256::new();
        let mut plans = Vec::new();
        for path in paths {
            let text = read_text(&path, LARGEST_PLAN)?;
            let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
            hash.update(format!("{name} {}\n{text}", text.len()));
            plans.push(PlanText { path, text });
        }
        Ok(Plans { path: path.to_path_buf(), folder: true, plans, sha256: hex(&hash.finalize()) })
    }

    /// One plan that is already in memory; `path` is its name in messages.
    pub fn of_text(path: &Path, text: String) -> Plans {
        let sha256 = hex(&Sha256::digest(&text));
        let plans = vec![PlanText { path: path.to_path_buf(), text }];
        Plans { path: path.to_path_buf(), folder: false, plans, sha256 }
    }

    /// SHA-256, in hex, of the file, or of the names and texts of all files of the folder.
    pub fn sha256(&self) -> &str {
        &self.sha256
    }

    /// Whether there is a plan for this goal. A file alone is the plan of the goal whose name it bears.
    pub fn names(&self, goal: &str) -> bool {
        self.plans.iter().any(|plan| plan.path.file_stem().is_some_and(|stem| stem == goal))
    }

    /// Checks that each of these goals has a plan. A file alone is the plan of a single goal of any name.
    ///
    /// # Errors
    /// The first goal without a plan.
    pub fn check<'g>(&self, goals: impl ExactSizeIterator<Item = &'g str>) -> Result<(), PlansError> {
        if !self.folder && goals.len() > 1 {
            return Err(PlansError::OneFile { file: shown(&self.path), goals: goals.len() });
        }
        for goal in goals {
            self.of(goal)?;
        }
        Ok(())
    }

    fn of(&self, goal: &str) -> Result<&PlanText, PlansError> {
        let named = |plan: &&PlanText| plan.path.file_stem().is_some_and(|stem| stem == goal);
        let plan = if self.folder { self.plans.iter().find(named) } else { self.plans.first() };
        plan.ok_or_else(|| PlansError::None { folder: shown(&self.path), goal: shorten(goal) })
    }

    /// The plan for a goal, checked by the rules.
    ///
    /// # Errors
    /// If there is none, or it is not a possible plan ([`read_plan`]).
    pub fn plan(&self, assembly: &Assembly, domains: &Domains) -> Result<Plan, PlansError> {
        let PlanText { path, text } = self.of(&assembly.name)?;
        read_plan(text, assembly, domains).map_err(|source| PlansError::Plan { file: shown(path), source })
    }
}

fn shown(path: &Path) -> String {
    plain(&path.display().to_string(), usize::MAX)
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}
