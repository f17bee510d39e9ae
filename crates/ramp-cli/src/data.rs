//! Where the kit, the goals, the rules and the arm are read from: a folder that was named, or what is built in.

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use miette::{IntoDiagnostic, Report, miette};
use ramp_assembly::Assembly;
use ramp_kit::Kit;
use ramp_kit::source::{MAX_FILE, SourceFile, is_name, nearest, read_text, shorten};
use ramp_log::Sources;
use ramp_planner::{Domains, Limits};
use ramp_robot::arm::ArmModel;
use ramp_world::World;

use crate::ending::end_planning;

include!(concat!(env!("OUT_DIR"), "/built_in.rs"));

/// The kit, the goals, the rules and the arm.
pub struct Data {
    /// The folder that was named; without one, what is built in.
    folder: Option<PathBuf>,
    /// A kit file in place of theirs.
    kit: Option<PathBuf>,
}

impl Data {
    /// The folder that was named, else what is built in.
    pub fn find(folder: Option<PathBuf>, kit: Option<PathBuf>) -> Result<Data, Report> {
        let folder = folder.map(|folder| folder.canonicalize().unwrap_or(folder));
        if let Some(folder) = folder.as_ref().filter(|folder| !folder.join("kit.xml").is_file()) {
            return Err(miette!(
                help = "`ramp data export DIR` writes the built-in kit, goals, domains and arms to a folder",
                "there is no kit.xml in {}",
                folder.display()
            ));
        }
        Ok(Data { folder, kit })
    }

    /// What makes another process of this program read the same data.
    pub fn arguments(&self) -> Vec<OsString> {
        let mut arguments = Vec::new();
        for (option, path) in [("--data", &self.folder), ("--kit", &self.kit)] {
            if let Some(path) = path {
                arguments.extend([option.into(), path.clone().into_os_string()]);
            }
        }
        arguments
    }

    /// A file of the data: of the folder, or built in.
    fn file(&self, name: &str) -> File {
        match &self.folder {
            Some(folder) => File::Path(folder.join(name)),
            None => File::built_in(name),
        }
    }

    /// What messages call the place of the goals.
    pub fn goals(&self) -> String {
        self.folder.as_ref().map_or_else(
            || "the built-in goals".to_string(),
            |folder| folder.join("goals").display().to_string(),
        )
    }

    /// The names of the goals, easy ones first.
    pub fn goal_names(&self) -> Result<Vec<String>, Report> {
        if let Some(folder) = &self.folder {
            let folder = folder.join("goals");
            return ramp_assembly::goal_names(&folder)
                .map_err(|error| miette!("the folder {} cannot be read: {error}", folder.display()));
        }
        let names = BUILT_IN.iter().filter_map(|(name, _)| name.strip_prefix("goals/")?.strip_suffix(".xml"));
        Ok(ramp_assembly::in_order(names.filter(|name| !name.contains('/')).map(str::to_string).collect()))
    }

    /// The kit.
    pub fn kit(&self) -> Result<Kit, Report> {
        Ok(match self.kit_file() {
            File::Path(path) => ramp_kit::read_kit(&path)?,
            File::BuiltIn(name, text) => ramp_kit::read_kit_str(&name, text)?,
        })
    }

    fn kit_file(&self) -> File {
        self.kit.as_ref().map_or_else(|| self.file("kit.xml"), |path| File::Path(path.clone()))
    }

    fn arm_file(&self) -> File {
        self.file("arms/panda.json")
    }

    /// The file of the goal of that name, or that file.
    fn goal_file(&self, name: &str) -> Result<File, Report> {
        let as_file = Path::new(name);
        if name.ends_with(".xml") || as_file.components().count() > 1 {
            return Ok(File::Path(as_file.to_path_buf()));
        }
        ramp_assembly::check_known(name, &self.goal_names()?, &self.goals())?;
        Ok(self.file(&format!("goals/{name}.xml")))
    }

    /// The goal of that name, or in that file.
    pub fn goal(&self, name: &str, kit: &Kit) -> Result<Assembly, Report> {
        Ok(match self.goal_file(name)? {
            File::Path(path) => ramp_assembly::read_goal(&path, kit)?,
            File::BuiltIn(name, text) => ramp_assembly::read_goal_str(&name, text, kit)?,
        })
    }

    /// The world of that name, or in that file.
    pub fn world(&self, name: &str) -> Result<World, Report> {
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
            miette!(help = help, "there is no world `{}`", shorten(name))
        })
    }

    /// The texts of the files that an episode of this goal is made from, for its log.
    pub fn texts(&self, goal: &str) -> Result<Texts, Report> {
        Ok(Texts {
            goal: self.goal_file(goal)?.text()?,
            kit: self.kit_file().text()?,
            arm: self.arm_file().text()?,
        })
    }

    /// The planner's rules, with another file in place of the one of its kind where one is named. Rules that are not the
    /// built-in ones are read, and work, within limits.
    pub fn domains(&self, other: Option<&Path>) -> Result<Domains, Report> {
        let limits = Limits::new(end_planning);
        let names = Domains::FILES.map(|name| format!("domains/{name}"));
        let mut files: Vec<String> = names.iter().map(|name| self.file(name).name()).collect();
        files.extend(other.map(|path| path.display().to_string()));
        let watched = self.folder.is_some() || other.is_some();
        let _watch = watched.then(|| limits.watch(files));
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
        Ok(if names.iter().zip(texts).all(known) { domains } else { domains.within(limits) })
    }

    /// The file of the skills' numbers in the folder that was named, where it is another than the built-in one.
    pub fn own_skills(&self) -> Option<PathBuf> {
        const NAME: &str = "skills/baseline.toml";
        let path = self.folder.as_ref()?.join(NAME);
        let own = read_text(&path, MAX_FILE).ok()?;
        let same = matches!(File::built_in(NAME), File::BuiltIn(_, text) if text == own);
        (!same).then_some(path)
    }

    /// The arm.
    pub fn arm(&self) -> Result<ArmModel, Report> {
        let file = self.arm_file();
        ArmModel::from_json(Path::new(&file.name()), &file.text()?).into_diagnostic()
    }
}

/// A file of the data.
enum File {
    /// On the disk.
    Path(PathBuf),
    /// What messages call it, and its text.
    BuiltIn(String, &'static str),
}

impl File {
    /// Built in; empty where there is none of that name.
    fn built_in(name: &str) -> File {
        let text = built_in().iter().find(|(known, _)| *known == name).map_or("", |(_, text)| *text);
        File::BuiltIn(format!("built-in {name}"), text)
    }

    /// What messages call it.
    fn name(&self) -> String {
        match self {
            File::Path(path) => path.display().to_string(),
            File::BuiltIn(name, _) => name.clone(),
        }
    }

    fn text(&self) -> Result<String, Report> {
        match self {
            File::Path(path) => Ok(read_text(path, MAX_FILE)?),
            File::BuiltIn(_, text) => Ok((*text).to_string()),
        }
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

/// The built-in files: their paths in a data folder, and their texts.
pub fn built_in() -> &'static [(&'static str, &'static str)] {
    BUILT_IN
}
