//! Names, tags and joint types: each must be unique in a kit.

use super::problem::{KitProblem, Result, Text};
use crate::joint::JointType;
use std::collections::HashMap;
use std::ops::{Range, RangeInclusive};

/// The ids of the tag family tag25h9; 0 is on the sheet.
const TAGS: RangeInclusive<i64> = 1..=34;

/// Names and tags, each unique in a kit, and the kit's own joint types.
#[derive(Default)]
pub(super) struct Names {
    pub(super) parts: Vec<JointType>,
    names: HashMap<String, Range<usize>>,
    tags: HashMap<u32, Range<usize>>,
}

impl Names {
    /// A unique name.
    pub(super) fn take(&mut self, value: &Text<'_>) -> Result<String> {
        let name = value.name()?.to_string();
        match self.names.insert(name.clone(), value.span()) {
            None => Ok(name),
            Some(first) => {
                Err(value.fault(KitProblem::DuplicateName { name }).also(first, "first used here"))
            }
        }
    }

    /// The joint type of that name.
    pub(super) fn part(&self, name: &str) -> Option<JointType> {
        JointType::from_name(name).or_else(|| self.parts.iter().copied().find(|kind| kind.name() == name))
    }

    /// The names of all joint types.
    pub(super) fn part_names(&self) -> Vec<&'static str> {
        JointType::ALL.iter().chain(&self.parts).map(|kind| kind.name()).collect()
    }

    /// A unique tag id.
    pub(super) fn take_tag(&mut self, value: &Text<'_>) -> Result<u32> {
        let id = value.integer(i64::MIN..=i64::MAX)?;
        if !TAGS.contains(&id) {
            return Err(value.fault(KitProblem::NoSuchTag { tag: id }));
        }
        // TAGS is within u32.
        let tag = u32::try_from(id).unwrap_or_default();
        match self.tags.insert(tag, value.span()) {
            None => Ok(tag),
            Some(first) => Err(value.fault(KitProblem::DuplicateTag { tag }).also(first, "first used here")),
        }
    }
}
