//! Plans of other planners, translated into the terms of the domain.

use super::error::PddlError;
use super::files::Pddl;
use crate::domain::{Domain, Kind, Leaf};
use crate::term::Term;
use ramp_source::shorten;

/// Lines above a plan, without a colon at their end.
const HEADINGS: [&str; 2] = ["sequentialplan", "plan"];

impl Pddl {
    /// The actions of a plan, one `(action object …)` or `action(object, …)` per line, in the terms of
    /// the rules.
    ///
    /// # Errors
    /// At the first line that is not an action of the domain with objects of the problem.
    pub fn read_plan(&self, domain: &Domain, text: &str) -> Result<Vec<Term>, PddlError> {
        let mut actions = Vec::new();
        for (line, words) in words_of_plan(text)? {
            let bad = |why: String| PddlError::Plan { line, found: shorten(&words.join(" ")), why };
            let mut words = words.iter().map(String::as_str);
            let name = words.next().unwrap_or_default();
            let sorts = domain
                .predicates
                .get(name)
                .filter(|predicate| matches!(predicate.kind, Kind::Action { .. }))
                .map(|predicate| &predicate.sorts)
                .ok_or_else(|| bad(format!("the domain has no action `{name}`")))?;
            let mut arguments = Vec::new();
            for (sort, word) in sorts.iter().zip(words.by_ref()) {
                let term = self.term_of(domain, sort, word);
                arguments.push(term.ok_or_else(|| bad(format!("`{word}` is not of the sort `{sort}`")))?);
            }
            if arguments.len() != sorts.len() || words.next().is_some() {
                return Err(bad(format!("`{name}` has {} arguments", sorts.len())));
            }
            actions.push(Term::Function(name.to_string(), arguments));
        }
        Ok(actions)
    }

    /// An object in the terms of the rules, for an argument of the given sort.
    fn term_of(&self, domain: &Domain, sort: &str, word: &str) -> Option<Term> {
        domain.sorts.get(sort)?.leaves.iter().find_map(|leaf| match leaf {
            Leaf::Number => None,
            Leaf::Constant(constant) => (constant == word).then(|| Term::new(constant, [])),
            Leaf::Open(open) => {
                let is_it = |((sort, _), pddl): &(&(String, String), &String)| sort == open && *pddl == word;
                self.objects.iter().find(is_it).map(|((_, name), _)| Term::from(name.as_str()))
            }
            Leaf::Function(function) => {
                let [inner] = &domain.functions.get(function)?[..] else { return None };
                Some(Term::new(function, [self.term_of(domain, inner, word)?]))
            }
        })
    }
}

/// The lines of a plan: their numbers, from 1, and their words.
///
/// # Errors
/// At the first line that is no action.
pub(crate) fn words_of_plan(text: &str) -> Result<Vec<(usize, Vec<String>)>, PddlError> {
    let mut lines = Vec::new();
    for (index, line) in text.lines().enumerate() {
        let line = line.split(';').next().unwrap_or_default().trim().to_lowercase();
        if line.is_empty() || HEADINGS.contains(&line.trim_end_matches(':')) {
            continue;
        }
        let words = words(&line).ok_or_else(|| PddlError::Plan {
            line: index + 1,
            found: shorten(&line),
            why: "expected `(action object …)` or `action(object, …)`".to_string(),
        })?;
        lines.push((index + 1, words.into_iter().map(str::to_string).collect()));
    }
    Ok(lines)
}

/// The words of a line: an action and its objects, as `(action object …)` or `action(object, …)`.
/// Some planners write a number or a time before it and a duration after it.
fn words(line: &str) -> Option<Vec<&str>> {
    let (before, rest) = match line.split_once('(') {
        Some(parts) => parts,
        None if line.contains(char::is_whitespace) => return None,
        None => (line, ")"),
    };
    let (inside, _) = rest.split_once(')')?;
    // A time ends in a colon, a number of the step in a colon or a point.
    let name = before.rsplit([':', ' ']).find(|word| !word.is_empty()).filter(|word| !is_number(word));
    let inside = inside.split(|c: char| c == ',' || c.is_whitespace()).filter(|word| !word.is_empty());
    let words: Vec<&str> = name.into_iter().chain(inside).collect();
    (!words.is_empty()).then_some(words)
}

fn is_number(word: &str) -> bool {
    word.chars().all(|c| c.is_ascii_digit() || ".:,".contains(c))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_action_is_written_in_several_forms() {
        let forms = [
            "(move b4 assembly)",
            "0.000: (move b4 assembly) [1.000]",
            "move(b4, assembly)",
            "3: move(b4,assembly)",
        ];
        for form in forms.into_iter().chain([
            "    move(b4, assembly)",
            "1. (move b4 assembly)",
            "( move b4  assembly )",
        ]) {
            assert_eq!(words(form.trim()).unwrap(), ["move", "b4", "assembly"], "{form}");
        }
        assert_eq!(words("wait()").unwrap(), ["wait"]);
        assert_eq!(words("wait").unwrap(), ["wait"]);
        assert_eq!(words("(wait"), None);
        assert_eq!(words("12:"), None);
    }
}
