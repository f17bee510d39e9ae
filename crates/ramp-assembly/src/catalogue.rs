//! The goals in a folder, by name.

use crate::assembly::{Class, Size};
use ramp_source::{is_debris, nearest, shorten};
use std::path::Path;

/// The names of the goals in a folder: its `.xml` files without their extension, easy ones first,
/// each class in order.
///
/// # Errors
/// The system's error for the folder.
pub fn goal_names(folder: &Path) -> std::io::Result<Vec<String>> {
    let mut names = Vec::new();
    for entry in std::fs::read_dir(folder)? {
        let path = entry?.path();
        if is_debris(&path) {
            continue;
        }
        if path.extension().is_some_and(|ending| ending == "xml") && path.is_file() {
            names.extend(path.file_stem().map(|stem| stem.to_string_lossy().into_owned()));
        }
    }
    Ok(in_order(names))
}

/// Names of goals in order: easy ones first, each class by its numbers, sets of the open class by size.
pub fn in_order(mut names: Vec<String>) -> Vec<String> {
    names.sort_by_cached_key(|name| sort_key(name));
    names
}

/// Class and size first, then the name with its final number compared as a number: easy-2 comes before
/// easy-10.
fn sort_key(name: &str) -> (usize, Option<Size>, String, u64, String) {
    let class = Class::ALL.iter().position(|class| name.starts_with(&class.name()));
    let digits = name.len() - name.bytes().rev().take_while(u8::is_ascii_digit).count();
    let (word, number) = name.split_at(digits);
    let number = number.parse().unwrap_or(0);
    (class.unwrap_or(Class::ALL.len()), Size::of_goal_name(name), word.to_string(), number, name.to_string())
}

/// The goal does not exist.
#[derive(Clone, Debug, PartialEq, thiserror::Error, miette::Diagnostic)]
#[error("there is no goal `{name}` in {place}")]
pub struct UnknownGoal {
    /// The requested name.
    pub name: String,
    /// The place that was searched.
    pub place: String,
    /// A suggestion.
    #[help]
    pub help: Option<String>,
}

/// Checks that a goal of this name is among `names`. `place` is their place in messages.
///
/// # Errors
/// [`UnknownGoal`], with the most similar name or the list of names.
pub fn check_known(name: &str, names: &[String], place: &str) -> Result<(), UnknownGoal> {
    if names.iter().any(|known| known == name) {
        return Ok(());
    }
    let near = nearest(name, names.iter().map(String::as_str)).map(|near| format!("did you mean `{near}`?"));
    let list = (!names.is_empty()).then(|| format!("the goals are {}", names.join(", ")));
    Err(UnknownGoal { name: shorten(name), place: place.to_string(), help: near.or(list) })
}
