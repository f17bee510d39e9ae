//! The data folder, or the files built into the program.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use ramp_assembly::{Assembly, Class};
use ramp_kit::Kit;
use ramp_log::Sources;
use ramp_planner::{Domains, Limits};
use ramp_robot::arm::ArmModel;
use ramp_source::{MAX_FILE, SourceFile, is_name, nearest, read_text, shorten};
use ramp_world::{Start, World};

use crate::built_in::{File, built_in};
use crate::error::DataError;

/// Names of the arms that episodes can have, the default first.
pub const ARMS: [&str; 2] = ["panda", "fr3"];

/// The folder of the goals in a data folder.
const GOALS: &str = "goals";

/// Kit, goals, planning rules, arm and worlds.
///
/// ```
/// let data = ramp_data::Data::built_in();
/// let goal = data.goal("easy-1")?;
/// assert_eq!(goal.kit.beams.len(), data.kit()?.beams.len());
/// assert!(data.goal("easy-9").unwrap_err().to_string().contains("easy-9"));
/// # Ok::<(), ramp_data::DataError>(())
/// ```
#[derive(Clone)]
pub struct Data {
    /// The data folder; `None` for the built-in files.
    folder: Option<PathBuf>,
    /// A kit file that replaces the folder's.
    kit_file: Option<PathBuf>,
    /// The arm, one of [`ARMS`].
    arm: &'static str,
    /// The kit, once it was read.
    kit: OnceLock<Kit>,
}

impl Data {
    /// The files built into the program.
    pub fn built_in() -> Data {
        Data { folder: None, kit_file: None, arm: ARMS[0], kit: OnceLock::new() }
    }

    /// The files of a folder.
    ///
    /// # Errors
    /// [`DataError::NoKit`] if the folder has no `kit.xml`.
    pub fn folder(folder: &Path) -> Result<Data, DataError> {
        let folder = folder.canonicalize().unwrap_or_else(|_| folder.to_path_buf());
        if !folder.join("kit.xml").is_file() {
            return Err(DataError::NoKit { folder: folder.display().to_string() });
        }
        Ok(Data { folder: Some(folder), kit_file: None, arm: ARMS[0], kit: OnceLock::new() })
    }

    /// The same files with another kit file, if one is given.
    pub fn with_kit(self, kit: Option<PathBuf>) -> Data {
        Data { kit_file: kit, kit: OnceLock::new(), ..self }
    }

    /// The same files with the arm of this name, one of [`ARMS`], in place of the Panda.
    ///
    /// # Errors
    /// [`DataError::UnknownArm`].
    pub fn with_arm(&self, name: &str) -> Result<Data, DataError> {
        let arm = ARMS.into_iter().find(|known| *known == name);
        let unknown = || DataError::UnknownArm { name: shorten(name), names: ARMS.join(", ") };
        Ok(Data { arm: arm.ok_or_else(unknown)?, ..self.clone() })
    }

    /// The options with which another process of the command line reads the same data.
    pub fn arguments(&self) -> Vec<OsString> {
        let mut arguments = Vec::new();
        for (option, path) in [("--data", &self.folder), ("--kit", &self.kit_file)] {
            if let Some(path) = path {
                arguments.extend([option.into(), path.clone().into_os_string()]);
            }
        }
        arguments
    }

    /// A file of the folder, or its built-in version.
    fn file(&self, name: &str) -> File {
        match &self.folder {
            Some(folder) => File::Path(folder.join(name)),
            None => File::built_in(name),
        }
    }

    /// The place of the goals, for messages.
    pub fn goals(&self) -> String {
        self.folder.as_ref().map_or_else(
            || "the built-in goals".to_string(),
            |folder| folder.join(GOALS).display().to_string(),
        )
    }

    /// The names of the goals, easy ones first, without those of sets of the open class.
    ///
    /// # Errors
    /// If the folder of the goals cannot be read.
    pub fn goal_names(&self) -> Result<Vec<String>, DataError> {
        if let Some(folder) = &self.folder {
            let folder = folder.join(GOALS);
            return ramp_assembly::goal_names(&folder)
                .map_err(|source| DataError::Folder { folder: folder.display().to_string(), source });
        }
        let names =
            built_in().iter().filter_map(|(name, _)| name.strip_prefix("goals/")?.strip_suffix(".xml"));
        Ok(ramp_assembly::in_order(names.filter(|name| !name.contains('/')).map(str::to_string).collect()))
    }

    /// The sets of the open class: the folders in the folder of the goals that have the name of one.
    ///
    /// # Errors
    /// If the folder of the goals cannot be read.
    pub fn open_sets(&self) -> Result<Vec<Class>, DataError> {
        let mut names: Vec<String> = Vec::new();
        if let Some(folder) = &self.folder {
            let folder = folder.join(GOALS);
            let fail = |source| DataError::Folder { folder: folder.display().to_string(), source };
            for entry in std::fs::read_dir(&folder).map_err(fail)? {
                let entry = entry.map_err(fail)?;
                if entry.path().is_dir() {
                    names.push(entry.file_name().to_string_lossy().into_owned());
                }
            }
        } else {
            let inside =
                built_in().iter().filter_map(|(name, _)| name.strip_prefix(GOALS)?.strip_prefix('/'));
            names.extend(inside.filter_map(|name| Some(name.split_once('/')?.0.to_string())));
        }
        let mut sets: Vec<Class> =
            names.iter().filter_map(|name| Class::of_name(name)).filter(|class| class.is_open()).collect();
        sets.sort_unstable();
        sets.dedup();
        Ok(sets)
    }

    /// The names of the goals of a set of the open class, small ones first.
    ///
    /// # Errors
    /// If the data has no such set, or its folder cannot be read.
    pub fn open_goal_names(&self, set: Class) -> Result<Vec<String>, DataError> {
        let sets = self.open_sets()?;
        if !sets.contains(&set) {
            let there: Vec<String> = sets.into_iter().map(Class::name).collect();
            let help = format!(
                "`ramp goals open` writes a set to a folder, and its goals are named by their files; the sets here are: \
                 {}",
                if there.is_empty() { "none".to_string() } else { there.join(", ") }
            );
            return Err(DataError::UnknownSet { name: set.name(), place: self.goals(), help });
        }
        let place = format!("{GOALS}/{set}");
        if let Some(folder) = &self.folder {
            let folder = folder.join(place);
            return ramp_assembly::goal_names(&folder)
                .map_err(|source| DataError::Folder { folder: folder.display().to_string(), source });
        }
        let inside = built_in().iter().filter_map(|(name, _)| name.strip_prefix(&place)?.strip_prefix('/'));
        Ok(ramp_assembly::in_order(
            inside.filter_map(|name| name.strip_suffix(".xml")).map(str::to_string).collect(),
        ))
    }

    /// The kit; its file is read once.
    ///
    /// # Errors
    /// The first problem in the kit file.
    pub fn kit(&self) -> Result<&Kit, DataError> {
        if let Some(kit) = self.kit.get() {
            return Ok(kit);
        }
        let kit = match self.kit_file() {
            File::Path(path) => ramp_kit::read_kit(&path)?,
            File::BuiltIn(name, text) => ramp_kit::read_kit_str(&name, text)?,
        };
        Ok(self.kit.get_or_init(|| kit))
    }

    /// True if another kit file replaces the one of the data.
    pub fn has_own_kit(&self) -> bool {
        self.kit_file.is_some()
    }

    fn kit_file(&self) -> File {
        self.kit_file.as_ref().map_or_else(|| self.file("kit.xml"), |path| File::Path(path.clone()))
    }

    fn arm_file(&self) -> File {
        self.file(&format!("arms/{}.json", self.arm))
    }

    /// The file of a goal. A name that ends in `.xml` or has a folder in it is a path.
    fn goal_file(&self, name: &str) -> Result<File, DataError> {
        let as_file = Path::new(name);
        if name.ends_with(".xml") || as_file.components().count() > 1 {
            return Ok(File::Path(as_file.to_path_buf()));
        }
        if let Some(set) = Class::of_open_goal(name) {
            let place = format!("the set {set} of {}", self.goals());
            ramp_assembly::check_known(name, &self.open_goal_names(set)?, &place)?;
            return Ok(self.file(&format!("{GOALS}/{set}/{name}.xml")));
        }
        ramp_assembly::check_known(name, &self.goal_names()?, &self.goals())?;
        Ok(self.file(&format!("{GOALS}/{name}.xml")))
    }

    /// The name or path of the file of a goal, for messages.
    ///
    /// # Errors
    /// If there is no goal of this name.
    pub fn goal_file_name(&self, name: &str) -> Result<String, DataError> {
        Ok(self.goal_file(name)?.name())
    }

    /// A goal by its name or its file.
    ///
    /// # Errors
    /// If there is no such goal, or the first problem in its file or in the kit's.
    pub fn goal(&self, name: &str) -> Result<Assembly, DataError> {
        let file = self.goal_file(name)?.goal_source()?;
        Ok(ramp_assembly::read_goal_file(&file, self.kit()?)?)
    }

    /// A goal as [`Data::goal`] gives it, with the texts of the files that an episode of it is made from. The
    /// goal's file is read once, so that both are of the same text.
    ///
    /// # Errors
    /// As [`Data::goal`], and if a file cannot be read.
    pub fn goal_with_texts(&self, name: &str) -> Result<(Assembly, Texts), DataError> {
        let file = self.goal_file(name)?.goal_source()?;
        let goal = ramp_assembly::read_goal_file(&file, self.kit()?)?;
        let (kit, arm) = (self.kit_file().text()?, self.arm_file().text()?);
        Ok((goal, Texts { goal: file.text().to_string(), kit, arm }))
    }

    /// A world by its name or its file. A folder may have worlds of its own.
    ///
    /// # Errors
    /// If there is no such world, or the first problem in its file.
    pub fn world(&self, name: &str) -> Result<World, DataError> {
        let as_file = Path::new(name);
        if name.ends_with(".toml") || as_file.components().count() > 1 {
            return Ok(World::read(as_file)?);
        }
        if let Some(folder) = &self.folder {
            let path = folder.join(format!("worlds/{name}.toml"));
            if is_name(name) && path.is_file() {
                return Ok(World::read(&path)?);
            }
        }
        World::shipped(name).cloned().ok_or_else(|| {
            let help = match nearest(name, World::names()) {
                Some(near) => format!("did you mean `{near}`?"),
                None => format!("the worlds are {}", World::names().collect::<Vec<_>>().join(", ")),
            };
            DataError::UnknownWorld { name: shorten(name), help }
        })
    }

    /// A start by its name or its file. A folder may have starts of its own.
    ///
    /// # Errors
    /// If there is no such start, or the first problem in its file.
    pub fn start(&self, name: &str) -> Result<Start, DataError> {
        let as_file = Path::new(name);
        if name.ends_with(".toml") || as_file.components().count() > 1 {
            return Ok(Start::read(as_file)?);
        }
        if let Some(folder) = &self.folder {
            let path = folder.join(format!("starts/{name}.toml"));
            if is_name(name) && path.is_file() {
                return Ok(Start::read(&path)?);
            }
        }
        Start::shipped(name).cloned().ok_or_else(|| {
            let help = match nearest(name, Start::names()) {
                Some(near) => format!("did you mean `{near}`?"),
                None => format!("the starts are {}", Start::names().collect::<Vec<_>>().join(", ")),
            };
            DataError::UnknownStart { name: shorten(name), help }
        })
    }

    /// The planning rules; `other` is a file that replaces the one of its kind. Rules other than the built-in
    /// ones are read, and work, within `limits` where some are given.
    ///
    /// # Errors
    /// The first problem in the rules.
    pub fn domains(&self, other: Option<&Path>, limits: Option<Limits>) -> Result<Domains, DataError> {
        let names = Domains::FILES.map(|name| format!("domains/{name}"));
        let mut files: Vec<String> = names.iter().map(|name| self.file(name).name()).collect();
        files.extend(other.map(|path| path.display().to_string()));
        let foreign = self.folder.is_some() || other.is_some();
        let _watch = limits.as_ref().filter(|_| foreign).map(|limits| limits.watch(files));
        let mut domains = match &self.folder {
            Some(folder) => Domains::read(&folder.join("domains"))?,
            None => {
                let [order, coarse, fine] = names.each_ref().map(|name| {
                    let file = self.file(name);
                    file.text().map(|text| SourceFile::new(&file.name(), &text))
                });
                Domains::new(order?, coarse?, fine?)?
            }
        };
        if let Some(path) = other {
            domains = domains.with(path)?;
        }
        let texts = [domains.order(), domains.coarse().file(), domains.fine().file()].map(SourceFile::text);
        let known = |(name, text): (&String, &str)| matches!(File::built_in(name), File::BuiltIn(_, own) if own == text);
        let all_known = names.iter().zip(texts).all(known);
        Ok(match limits.filter(|_| !all_known) {
            Some(limits) => domains.within(limits),
            None => domains,
        })
    }

    /// The folder's file of the skills' numbers, if it differs from the built-in one.
    pub fn own_skills(&self) -> Option<PathBuf> {
        const NAME: &str = "skills/baseline.toml";
        let path = self.folder.as_ref()?.join(NAME);
        let own = read_text(&path, MAX_FILE).ok()?;
        let same = matches!(File::built_in(NAME), File::BuiltIn(_, text) if text == own);
        (!same).then_some(path)
    }

    /// The arm: the Panda, or that of [`Data::with_arm`].
    ///
    /// # Errors
    /// The first problem in the arm's file.
    pub fn arm(&self) -> Result<ArmModel, DataError> {
        read_arm(&self.arm_file())
    }

    /// The text of the arm's file.
    ///
    /// # Errors
    /// If it cannot be read.
    pub fn arm_text(&self) -> Result<String, DataError> {
        Ok(self.arm_file().text()?)
    }
}

fn read_arm(file: &File) -> Result<ArmModel, DataError> {
    Ok(ArmModel::from_json(Path::new(&file.name()), &file.text()?)?)
}

/// The texts of the files that an episode is made from, for its log.
#[derive(Clone, Debug)]
pub struct Texts {
    goal: String,
    kit: String,
    arm: String,
}

impl Texts {
    /// The texts as the log takes them.
    pub fn sources(&self) -> Sources<'_> {
        Sources { goal: &self.goal, kit: &self.kit, arm: &self.arm }
    }
}
