//! `ramp skills`: the skills of the baseline, and their parameters.

use std::fmt::Write;
use std::path::PathBuf;
use std::sync::Arc;

use miette::{Diagnostic, IntoDiagnostic, Report};
use ramp_data::Data;
use ramp_kit::source::{nearest, shorten};
use ramp_skills::parameters::Group;
use ramp_skills::parameters::group::Form;
use ramp_skills::skill::Skill;
use ramp_skills::{Parameters, table};
use serde_json::{Value, json};

use crate::output::print;
use crate::status::DONE;

#[derive(clap::Args)]
pub struct Arguments {
    /// Name of a skill, or of a table of parameters [default: all]
    #[arg(value_name = "NAME")]
    name: Option<String>,
    #[command(flatten)]
    file: File,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

/// Option for the file of skill parameters.
#[derive(clap::Args)]
pub struct File {
    /// Replace parameters of the baseline's skills by those in this TOML file; `ramp skills` prints all of
    /// them
    #[arg(long = "parameters", value_name = "FILE")]
    pub path: Option<PathBuf>,
}

impl File {
    /// The baseline's parameters, overridden by those of the file or of a custom data folder.
    pub fn read(&self, data: &Data) -> Result<Arc<Parameters>, Report> {
        match self.path.clone().or_else(|| data.own_skills()) {
            Some(path) => Ok(Parameters::read(&path)?),
            None => Ok(Parameters::baseline()),
        }
    }
}

/// Errors of `ramp skills`.
#[derive(Debug, thiserror::Error, Diagnostic)]
#[error("there is no skill and no table of parameters `{name}`")]
struct Unknown {
    name: String,
    #[help]
    help: String,
}

pub fn run(data: &Data, arguments: &Arguments) -> Result<u8, Report> {
    let parameters = arguments.file.read(data)?;
    let table = table::baseline(&parameters);
    let groups = parameters.groups();
    let wanted = |name: &str| arguments.name.as_deref().is_none_or(|wanted| wanted == name);
    let skills: Vec<&dyn Skill> = table.skills().filter(|skill| wanted(skill.name())).collect();
    // The tables that skills share, or the requested one.
    let own = |group: &&Group| table.skills().any(|skill| skill.name() == group.table);
    let shared: Vec<&Group> = groups.iter().filter(|group| !own(group) && wanted(group.table)).collect();
    if let Some(name) = arguments.name.as_deref().filter(|_| skills.is_empty() && shared.is_empty()) {
        let known = || table.skills().map(Skill::name).chain(groups.iter().map(|group| group.table));
        let help = match nearest(name, known()) {
            Some(near) => format!("did you mean `{near}`?"),
            None => {
                format!("the skills are {}", table.skills().map(Skill::name).collect::<Vec<_>>().join(", "))
            }
        };
        return Err(Unknown { name: shorten(name), help }.into());
    }
    let text = if arguments.json {
        let skills: Vec<Value> = skills.iter().map(|skill| skill_json(*skill, &groups)).collect();
        let shared: Vec<Value> = shared.iter().map(|group| group_json(group)).collect();
        let all = json!({"sha256": parameters.sha256, "skills": skills, "shared": shared});
        serde_json::to_string_pretty(&all).into_diagnostic()? + "\n"
    } else {
        let mut text = String::new();
        for skill in &skills {
            skill_text(&mut text, *skill, &groups);
        }
        for group in &shared {
            let _ = writeln!(text, "[{}]  {}", group.table, group.about.trim());
            group_text(&mut text, group);
        }
        text
    };
    print(&text)?;
    Ok(DONE)
}

/// The parameter table of one skill.
fn own_group<'g>(skill: &dyn Skill, groups: &'g [Group]) -> Option<&'g Group> {
    groups.iter().find(|group| group.table == skill.name())
}

/// The tables that several skills share.
fn shared_tables(skill: &dyn Skill) -> Vec<&'static str> {
    skill.parameters().iter().copied().filter(|table| *table != skill.name()).collect()
}

fn skill_text(text: &mut String, skill: &dyn Skill, groups: &[Group]) {
    let list = |words: Vec<String>| if words.is_empty() { "nothing".to_string() } else { words.join("; ") };
    let _ = writeln!(text, "{}", skill.name());
    if let Some(group) = own_group(skill, groups) {
        let _ = writeln!(text, "  {}", group.about.trim());
    }
    let serves: Vec<&str> = skill.serves().iter().map(|kind| kind.name()).collect();
    let _ = writeln!(text, "  serves   {}", serves.join(", "));
    let _ = writeln!(text, "  needs    {}", list(skill.needs().iter().map(ToString::to_string).collect()));
    let _ = writeln!(text, "  expects  {}", list(skill.expects().iter().map(ToString::to_string).collect()));
    let shared = shared_tables(skill);
    if !shared.is_empty() {
        let _ = writeln!(text, "  shares   [{}]", shared.join("], ["));
    }
    match own_group(skill, groups) {
        Some(group) => group_text(text, group),
        None => text.push('\n'),
    }
}

fn group_text(text: &mut String, group: &Group) {
    let values: Vec<String> = group
        .fields
        .iter()
        .zip(&group.values)
        .map(|(field, values)| {
            let numbers: Vec<String> = values.iter().map(ToString::to_string).collect();
            let numbers = match field.form {
                Form::List(_) => format!("[{}]", numbers.join(", ")),
                Form::Number | Form::Count => numbers.concat(),
            };
            format!("{numbers} {}", field.unit).trim().to_string()
        })
        .collect();
    let name = group.fields.iter().map(|field| field.name.len()).max().unwrap_or(0);
    let width = values.iter().map(|value| value.chars().count()).max().unwrap_or(0);
    for (field, value) in group.fields.iter().zip(&values) {
        let _ = writeln!(text, "    {:<name$}  {value:<width$}  {}", field.name, field.meaning.trim());
    }
    text.push('\n');
}

fn group_json(group: &Group) -> Value {
    let parameters: Vec<Value> = group
        .fields
        .iter()
        .zip(&group.values)
        .map(|(field, values)| {
            let value = match (field.form, values.first()) {
                (Form::Count, Some(value)) => json!(*value as u64),
                (Form::Number, Some(value)) => json!(value),
                _ => json!(values),
            };
            json!({
                "name": field.name,
                "value": value,
                "unit": field.unit,
                "least": field.least,
                "most": field.most,
                "meaning": field.meaning.trim(),
            })
        })
        .collect();
    json!({"table": group.table, "about": group.about.trim(), "parameters": parameters})
}

fn skill_json(skill: &dyn Skill, groups: &[Group]) -> Value {
    let words = |words: Vec<String>| json!(words);
    json!({
        "name": skill.name(),
        "serves": skill.serves().iter().map(|kind| kind.name()).collect::<Vec<_>>(),
        "needs": words(skill.needs().iter().map(ToString::to_string).collect()),
        "expects": words(skill.expects().iter().map(ToString::to_string).collect()),
        "shares": shared_tables(skill),
        "parameters": own_group(skill, groups).map(group_json),
    })
}
