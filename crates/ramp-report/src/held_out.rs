//! Held-out goals: commitments published before the runs, and the goals revealed after them.
//!
//! A commitment is SHA-256 over the name of its format, 32 random bytes (the salt) and the goal
//! file. Readers cannot find the goal by search, and the organiser cannot exchange it afterwards.

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use ramp_kit::source::{A_NAME, is_name, shorten};
use ramp_result::episode::RULES;

/// Version of the format of both files.
pub const SCHEMA: &str = "ramp-held-out-1";
/// Bytes of a salt.
pub const SALT: usize = 32;
/// Largest number of goals of one promise.
const MOST_GOALS: usize = 1000;

/// The file published before the runs.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Commitments {
    /// [`SCHEMA`].
    pub schema: String,
    /// The rules by which agents will be judged on these goals.
    pub rules: String,
    /// One per goal.
    pub commitments: Vec<Commitment>,
}

/// The promise of a goal.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Commitment {
    /// The goal's name, as in results.
    pub goal: String,
    /// SHA-256, hexadecimal.
    pub commitment: String,
}

/// The file kept secret, and published after the runs.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Reveal {
    /// [`SCHEMA`].
    pub schema: String,
    /// The goals.
    pub goals: Vec<Secret>,
}

/// A held-out goal.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Secret {
    /// The goal's name.
    pub goal: String,
    /// 32 random bytes, hexadecimal.
    pub salt: String,
    /// The goal file, whole.
    pub xml: String,
}

/// Reasons why the revealed goals are not the promised ones.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum VerifyError {
    /// A file of another format.
    #[error("found the format `{0}`, expected {SCHEMA}")]
    Schema(String),
    /// An invalid name.
    #[error("a goal is called `{0}`, expected {A_NAME}")]
    Name(String),
    /// Too many goals.
    #[error("there are {0} goals, expected at most {MOST_GOALS}")]
    TooMany(usize),
    /// A promised goal is not revealed.
    #[error("{0} was promised and is not revealed")]
    Missing(String),
    /// A revealed goal was not promised.
    #[error("{0} is revealed and was not promised")]
    Extra(String),
    /// A name occurs twice.
    #[error("{0} occurs more than once")]
    Twice(String),
    /// An invalid salt.
    #[error("the salt of {0} is not 64 hexadecimal digits")]
    Salt(String),
    /// The goal differs from the promised one.
    #[error("{0} does not match its commitment")]
    Differs(String),
}

/// The commitment of a goal file.
///
/// ```
/// let one = ramp_report::held_out::commit(&[0; 32], "<goal/>");
/// assert_ne!(one, ramp_report::held_out::commit(&[1; 32], "<goal/>"));
/// assert_ne!(one, ramp_report::held_out::commit(&[0; 32], "<goal />"));
/// ```
pub fn commit(salt: &[u8; SALT], xml: &str) -> String {
    let mut hash = Sha256::new();
    hash.update(SCHEMA.as_bytes());
    hash.update([0]);
    hash.update(salt);
    hash.update(xml.as_bytes());
    ramp_result::file::hexadecimal(&hash.finalize())
}

/// Both files, given name, salt and goal file of each goal.
pub fn promise(goals: &[(String, [u8; SALT], String)]) -> (Commitments, Reveal) {
    let commitments = goals
        .iter()
        .map(|(goal, salt, xml)| Commitment { goal: goal.clone(), commitment: commit(salt, xml) })
        .collect();
    let secrets = goals.iter().map(|(goal, salt, xml)| Secret {
        goal: goal.clone(),
        salt: ramp_result::file::hexadecimal(salt),
        xml: xml.clone(),
    });
    (
        Commitments { schema: SCHEMA.to_string(), rules: RULES.to_string(), commitments },
        Reveal { schema: SCHEMA.to_string(), goals: secrets.collect() },
    )
}

/// Checks that these are exactly the promised goals.
///
/// # Errors
/// The first difference.
pub fn verify(promised: &Commitments, revealed: &Reveal) -> Result<(), VerifyError> {
    for schema in [&promised.schema, &revealed.schema] {
        if schema != SCHEMA {
            return Err(VerifyError::Schema(shorten(schema)));
        }
    }
    for count in [promised.commitments.len(), revealed.goals.len()] {
        if count > MOST_GOALS {
            return Err(VerifyError::TooMany(count));
        }
    }
    let names =
        promised.commitments.iter().map(|it| &it.goal).chain(revealed.goals.iter().map(|it| &it.goal));
    if let Some(name) = names.into_iter().find(|name| !is_name(name)) {
        return Err(VerifyError::Name(shorten(name)));
    }
    for (index, it) in promised.commitments.iter().enumerate() {
        if promised.commitments[..index].iter().any(|other| other.goal == it.goal) {
            return Err(VerifyError::Twice(it.goal.clone()));
        }
        if !revealed.goals.iter().any(|secret| secret.goal == it.goal) {
            return Err(VerifyError::Missing(it.goal.clone()));
        }
    }
    for (index, secret) in revealed.goals.iter().enumerate() {
        let name = || secret.goal.clone();
        if revealed.goals[..index].iter().any(|other| other.goal == secret.goal) {
            return Err(VerifyError::Twice(name()));
        }
        let Some(it) = promised.commitments.iter().find(|it| it.goal == secret.goal) else {
            return Err(VerifyError::Extra(name()));
        };
        let salt = unhex(&secret.salt).ok_or_else(|| VerifyError::Salt(name()))?;
        if commit(&salt, &secret.xml) != it.commitment.to_ascii_lowercase() {
            return Err(VerifyError::Differs(name()));
        }
    }
    Ok(())
}

fn unhex(text: &str) -> Option<[u8; SALT]> {
    let mut salt = [0; SALT];
    if text.len() != 2 * SALT || !text.bytes().all(|byte| byte.is_ascii_hexdigit()) {
        return None;
    }
    for (index, byte) in salt.iter_mut().enumerate() {
        *byte = u8::from_str_radix(&text[2 * index..2 * index + 2], 16).ok()?;
    }
    Some(salt)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_promised_is_verified_and_nothing_else() {
        let goals = [
            ("held-1".to_string(), [7; SALT], "<a/>".to_string()),
            ("held-2".into(), [8; SALT], "<b/>".into()),
        ];
        let (promised, revealed) = promise(&goals);
        assert_eq!(verify(&promised, &revealed), Ok(()));
        // The organiser exchanges a goal,
        let mut other = revealed.clone();
        other.goals[1].xml = "<easier/>".into();
        assert_eq!(verify(&promised, &other), Err(VerifyError::Differs("held-2".into())));
        // omits one, or adds one.
        let mut fewer = revealed.clone();
        fewer.goals.pop();
        assert_eq!(verify(&promised, &fewer), Err(VerifyError::Missing("held-2".into())));
        let mut fewer = promised.clone();
        fewer.commitments.pop();
        assert_eq!(verify(&fewer, &revealed), Err(VerifyError::Extra("held-2".into())));
        // Salts of one length only: a longer one could take bytes of the goal.
        let mut longer = revealed.clone();
        longer.goals[0].salt.push_str("00");
        assert_eq!(verify(&promised, &longer), Err(VerifyError::Salt("held-1".into())));
        // A name outside its folder, and too many goals.
        let mut named = revealed.clone();
        named.goals[0].goal = "../held-1".into();
        assert_eq!(verify(&promised, &named), Err(VerifyError::Name("../held-1".into())));
        let mut many = promised.clone();
        many.commitments = vec![promised.commitments[0].clone(); 1001];
        assert_eq!(verify(&many, &revealed), Err(VerifyError::TooMany(1001)));
    }
}
