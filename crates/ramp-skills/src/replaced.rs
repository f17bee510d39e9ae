//! The name of the baseline in results, when parts of it are replaced: each part stands in the name, with the
//! first digits of the hash of its file. Results of different planners, plans, skills or parameters are thus
//! never added up.

use ramp_kit::source::is_name;
use ramp_robot::BASELINE;
use sha2::{Digest, Sha256};

/// Number of hexadecimal digits of each hash in the name.
const DIGITS: usize = 8;
/// Number of hexadecimal digits of the hash that stands for a list of parts that is too long for a name.
const DIGITS_OF_ALL: usize = 16;

/// The parts of the baseline that are replaced.
///
/// ```
/// use ramp_skills::Replaced;
///
/// assert_eq!(Replaced::default().name(), "baseline");
/// let rules = Replaced { domain: Some("5ad0be2f81c9".to_string()), ..Replaced::default() };
/// assert_eq!(rules.name(), "baseline+domain.5ad0be2f");
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Replaced {
    /// Names of skills that replace the baseline's. The name of a skill from a file has the file's hash in
    /// it.
    pub skills: Vec<String>,
    /// SHA-256 of the file of parameters, in hex.
    pub parameters: Option<String>,
    /// SHA-256 of the planning rules, in hex ([`Domains::replaced`](ramp_planner::Domains::replaced)).
    pub domain: Option<String>,
    /// SHA-256 of the given plan, or of the folder of plans, in hex.
    pub plan: Option<String>,
    /// The name of the planner, with its file's hash in it.
    pub planner: Option<String>,
    /// The name of the finder of parts, likewise.
    pub finder: Option<String>,
}

impl Replaced {
    /// The name in results: at most [`MAX_NAME`](ramp_kit::source::MAX_NAME) characters, without spaces.
    pub fn name(&self) -> String {
        let short = |what: &str, hash: &Option<String>| {
            hash.as_ref().map(|hash| format!("{what}.{}", &hash[..hash.len().min(DIGITS)]))
        };
        let files =
            [short("parameters", &self.parameters), short("domain", &self.domain), short("plan", &self.plan)];
        let parts: Vec<String> = self
            .skills
            .iter()
            .chain(&self.planner)
            .chain(&self.finder)
            .cloned()
            .chain(files.into_iter().flatten())
            .collect();
        if parts.is_empty() {
            return BASELINE.to_string();
        }
        let name = format!("{}+{}", BASELINE, parts.join("+"));
        if is_name(&name) {
            return name;
        }
        let hash: String = Sha256::digest(&name).iter().map(|byte| format!("{byte:02x}")).collect();
        format!("{}+{}-parts.{}", BASELINE, parts.len(), &hash[..DIGITS_OF_ALL])
    }
}

#[cfg(test)]
mod tests {
    use ramp_kit::source::MAX_NAME;

    use super::*;

    #[test]
    fn each_part_is_in_the_name_and_no_name_is_too_long() {
        let hash = |digit: &str| Some(digit.repeat(64));
        let mut all = Replaced {
            skills: vec!["fasten-by-my.0123abcd".to_string()],
            parameters: hash("a"),
            domain: None,
            plan: hash("c"),
            planner: None,
            finder: None,
        };
        assert_eq!(all.name(), "baseline+fasten-by-my.0123abcd+parameters.aaaaaaaa+plan.cccccccc");
        all.domain = hash("b");
        let long = all.name();
        assert!(long.len() <= MAX_NAME && long.starts_with("baseline+4-parts."), "{long}");
        all.domain = hash("d");
        assert_ne!(all.name(), long, "the hash stands for every part");
    }
}
