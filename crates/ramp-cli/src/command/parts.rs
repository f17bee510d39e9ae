//! Parts of the baseline that the user replaces: skills, parameters, planning rules and plans. Every command
//! that runs the baseline takes the same options, and names what is replaced in its results.

use std::collections::BTreeMap;
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use miette::{Report, miette};
use ramp_assembly::Assembly;
use ramp_data::{Data, Plans, Texts};
use ramp_external_agent::{AgentFile, Sandbox, adopt_orphans, finder_name, planner_name};
use ramp_planner::{Domains, Plan, State};
use ramp_robot::Track;
use ramp_robot::arm::ArmModel;
use ramp_skills::rehearsal::check_for_arm;
use ramp_skills::skill::ActionKind;
use ramp_skills::{Baseline, Parameters, Replaced};
use ramp_twin::Setup;

use crate::command::own_skill::{self, Replacement, SkillHost, Source};
use crate::command::skills;
use crate::command::{own_finder, own_planner};
use crate::rules::domains;

/// Options that replace parts of the baseline.
#[derive(clap::Args)]
pub struct Arguments {
    /// Replace a skill of the baseline by a program in any language, such as fasten=my.py, or by the policy
    /// behind a server, such as fasten=ws://127.0.0.1:8000
    #[arg(long, value_name = "ACTION=FILE|URL", conflicts_with = "agent")]
    skill: Vec<Replacement>,
    /// Let the baseline carry out this plan: the output of `ramp plan GOAL --json`, another planner's plan
    /// for the files of `ramp plan GOAL --pddl DIR`, or a folder with a file for each goal
    #[arg(long, value_name = "FILE|DIR", conflicts_with = "agent")]
    plan: Option<PathBuf>,
    /// Go through the given plan with the arm's model before anything moves, and refuse it if the arm cannot
    /// carry out a step
    #[arg(long, requires = "plan")]
    check_motion: bool,
    /// Replace the rule file of the same kind: a coarse or fine domain (.al), or the order of the beams (.lp)
    #[arg(long, value_name = "FILE", conflicts_with = "agent")]
    domain: Option<PathBuf>,
    /// Let this program plan, at the start and whenever the baseline plans again: an executable, or a Python
    /// file
    #[arg(long, value_name = "FILE", conflicts_with_all = ["agent", "plan", "check_motion"], group = "program")]
    planner: Option<PathBuf>,
    /// Let this program find the parts in the images, on a track that gives images: an executable, or a
    /// Python file
    #[arg(long, value_name = "FILE", conflicts_with = "agent", group = "program")]
    finder: Option<PathBuf>,
    #[command(flatten)]
    parameters: skills::File,
}

impl Arguments {
    /// Returns true if an external program runs.
    pub fn has_program(&self) -> bool {
        self.skill.iter().any(Replacement::is_program) || self.planner.is_some() || self.finder.is_some()
    }

    /// Returns true if a plan or a planner replaces the baseline's.
    pub fn replaces_plans(&self) -> bool {
        self.plan.is_some() || self.planner.is_some()
    }

    /// Reads all files, for episodes on a track.
    ///
    /// # Errors
    /// The first problem in a file; a finder on a track without images.
    pub fn read(&self, data: &Data, track: Track) -> Result<Parts, Report> {
        if self.finder.is_some() && !track.gives_images() {
            let help = "the tracks `tags`, `colour` and `depth` give images";
            return Err(miette!(
                help = help,
                "--finder reads images, and track `{}` gives none",
                track.name()
            ));
        }
        Ok(Parts {
            domains: domains(data, self.domain.as_deref())?,
            parameters: self.parameters.read(data)?,
            skills: self.skill.iter().map(Replacement::read).collect::<Result<_, Report>>()?,
            plans: self.plan.as_deref().map(Plans::read).transpose()?,
            planner: self.planner.as_deref().map(own_skill::file).transpose()?,
            finder: self.finder.as_deref().map(own_skill::file).transpose()?,
            checked_for: if self.check_motion { Some(data.arm()?) } else { None },
        })
    }

    /// The same options for another process; `place` gives the path of each file there.
    pub fn words(&self, place: &mut dyn FnMut(&Path) -> PathBuf) -> Vec<OsString> {
        let mut words = Vec::new();
        for skill in &self.skill {
            words.extend(["--skill".into(), skill.word(place)]);
        }
        let files = [
            ("--plan", &self.plan),
            ("--domain", &self.domain),
            ("--planner", &self.planner),
            ("--finder", &self.finder),
            ("--parameters", &self.parameters.path),
        ];
        for (option, path) in files {
            words.extend(path.iter().flat_map(|path| [option.into(), place(path).into_os_string()]));
        }
        words
    }
}

/// The sandboxes of an episode's programs, each of its own.
#[derive(Default)]
pub struct Sandboxes {
    /// That of the agent.
    pub agent: Option<Sandbox>,
    /// That of the planner.
    pub planner: Option<Sandbox>,
    /// That of the finder.
    pub finder: Option<Sandbox>,
}

/// The parts of the baseline, read from their files.
pub struct Parts {
    /// The planning rules.
    pub domains: Domains,
    /// The parameters of the skills.
    pub parameters: Arc<Parameters>,
    /// Programs that replace skills; the last one for an action counts.
    skills: BTreeMap<ActionKind, Source>,
    /// Plans that the baseline executes in place of its own.
    pub plans: Option<Plans>,
    /// The program that plans.
    pub planner: Option<AgentFile>,
    /// The program that finds parts in images.
    pub finder: Option<AgentFile>,
    /// The arm that must be able to carry them out, if that is to be checked.
    checked_for: Option<ArmModel>,
}

impl Parts {
    /// The name and version in results.
    pub fn name(&self) -> (String, String) {
        let skills = self.skills.iter().map(|(kind, source)| own_skill::name(*kind, source)).collect();
        let replaced = Replaced {
            skills,
            parameters: self.parameters.sha256.clone(),
            domain: self.domains.replaced(),
            plan: self.plans.as_ref().map(|plans| plans.sha256().to_string()),
            planner: self.planner.as_ref().map(planner_name),
            finder: self.finder.as_ref().map(finder_name),
        };
        (replaced.name(), Baseline::VERSION.to_string())
    }

    /// Replaces the skill for these actions.
    pub fn replace(&mut self, kinds: impl IntoIterator<Item = ActionKind>, source: &Source) {
        self.skills.extend(kinds.into_iter().map(|kind| (kind, source.clone())));
    }

    /// The given plan for a goal, if plans are given.
    ///
    /// # Errors
    /// If the goal has none, or it is not possible.
    pub fn plan(&self, assembly: &Assembly) -> Result<Option<Plan>, Report> {
        let Some(plans) = &self.plans else { return Ok(None) };
        let plan = plans.plan(assembly, &self.domains)?;
        if let Some(arm) = &self.checked_for {
            check_for_arm(assembly, arm, &State::default(), &plan).map_err(|stuck| {
                miette!(
                    help = stuck.remedy(),
                    "the arm cannot carry out the plan of {}: {stuck}",
                    assembly.name
                )
            })?;
        }
        Ok(Some(plan))
    }

    /// The agent for an episode. `limit` is the time, s, that a program has for a message; `plan` is the
    /// given plan, and `sandboxes` are those of planner and finder.
    ///
    /// # Errors
    /// If a skill cannot be replaced.
    pub fn agent<'a>(
        &'a self,
        setup: &Setup<'a>,
        texts: &Texts,
        limit: f64,
        plan: Option<Plan>,
        sandboxes: Sandboxes,
    ) -> Result<Baseline<'a>, Report> {
        let mut baseline = Baseline::new(setup.assembly, setup.arm, &self.domains, setup.seed)
            .on_track(setup.track)
            .from_start(setup.start)
            .with_task(setup.task)
            .with_parameters(self.parameters.clone());
        if !self.skills.is_empty() {
            if self.skills.values().any(Source::is_program) {
                adopt_orphans();
            }
            let host = SkillHost::new(setup, texts, limit);
            let mut table = ramp_skills::table::baseline(&self.parameters);
            for (kind, source) in &self.skills {
                table.replace(own_skill::skill(*kind, source, &host)?);
            }
            baseline = baseline.with_skills(table);
        }
        if let Some(file) = &self.planner {
            adopt_orphans();
            let sandbox = sandboxes.planner;
            let planner = own_planner::planner(setup, texts, file, &self.domains, limit, sandbox)?;
            baseline = baseline.with_planner(planner, &planner_name(file));
        }
        if let Some(file) = &self.finder {
            adopt_orphans();
            let finder = own_finder::finder(setup, texts, file, limit, sandboxes.finder)?;
            baseline = baseline.with_finder(finder, &finder_name(file));
        }
        if let (Some(plans), Some(plan)) = (&self.plans, plan) {
            baseline = baseline.with_plan(plan, plans.sha256());
        }
        Ok(baseline)
    }
}
