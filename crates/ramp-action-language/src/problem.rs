//! Defects of a domain file.

use ramp_source::{Fault, FormProblem, Problem, shorten};

/// A defect of a domain file, with its place.
pub type LanguageError = Fault<LanguageProblem>;

/// Defects of a domain file.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LanguageProblem {
    /// The file cannot be read.
    #[error(transparent)]
    Form(#[from] FormProblem),
    /// An invalid character.
    #[error("unexpected character `{}`", shorten(&found.to_string()))]
    Character {
        /// The character.
        found: char,
    },
    /// A quoted name without its closing quote on the same line.
    #[error("this name has no closing quote on its line")]
    Quote,
    /// A number with too many digits.
    #[error("the number {found} is too large")]
    Number {
        /// Its digits.
        found: String,
    },
    /// An unexpected token.
    #[error("found {found}, expected {expected}")]
    Word {
        /// The token found.
        found: String,
        /// The token expected.
        expected: String,
        /// The most similar keyword.
        nearest: Option<String>,
    },
    /// Terms nested too deeply.
    #[error("this term is nested too deep")]
    Depth,
    /// An undeclared name.
    #[error("there is no {kind} `{name}`")]
    Unknown {
        /// `sort`, `static, fluent or action`, …
        kind: &'static str,
        /// The name.
        name: String,
        /// The most similar declared name.
        nearest: Option<String>,
    },
    /// A name declared twice.
    #[error("`{name}` is declared twice")]
    Twice {
        /// The name.
        name: String,
    },
    /// A sort that contains itself.
    #[error("the sort `{name}` contains itself")]
    Circle {
        /// The sort.
        name: String,
    },
    /// The wrong number of arguments.
    #[error("`{name}` has {found} arguments, but is declared with {expected}")]
    Arguments {
        /// The name.
        name: String,
        /// Their number as written.
        found: usize,
        /// Their number as declared.
        expected: usize,
    },
    /// A term of the wrong sort.
    #[error("`{term}` is not of the sort `{sort}`")]
    Sort {
        /// The term.
        term: String,
        /// The expected sort.
        sort: String,
        /// The most similar element of the sort.
        nearest: Option<String>,
    },
    /// A variable used with two sorts that have nothing in common.
    #[error("the variable `{variable}` would have to be of the sorts `{first}` and `{second}` at once")]
    Clash {
        /// The variable.
        variable: String,
        /// One sort.
        first: String,
        /// The other.
        second: String,
    },
    /// An unbound variable.
    #[error("the variable `{variable}` is unsafe: no static, fluent or action gives it a value")]
    Unsafe {
        /// The variable.
        variable: String,
    },
    /// `_` in a position where it would mean every value.
    #[error("`_` is not allowed in {place}")]
    Anonymous {
        /// The position.
        place: &'static str,
    },
    /// A name of the wrong kind.
    #[error("`{name}` is {found}, expected {expected}")]
    Kind {
        /// The name.
        name: String,
        /// Its kind.
        found: &'static str,
        /// The expected kind.
        expected: &'static str,
    },
    /// A negated head of a defined predicate.
    #[error("`{name}` is {found} and false unless derived, so a law cannot conclude `-{name}`")]
    NegatedHead {
        /// The name.
        name: String,
        /// Its kind.
        found: &'static str,
    },
    /// A defined fluent that depends on its own negation.
    #[error("`{name}` is defined by its own negation")]
    Negation {
        /// The fluent.
        name: String,
    },
}

impl Problem for LanguageProblem {
    fn label(&self) -> String {
        match self {
            LanguageProblem::Form(problem) => problem.label(),
            LanguageProblem::Character { .. } | LanguageProblem::Depth => "here".to_string(),
            LanguageProblem::Quote => "begins here".to_string(),
            LanguageProblem::Number { .. } => "at most 15 digits".to_string(),
            LanguageProblem::Word { expected, .. } => format!("expected {expected}"),
            LanguageProblem::Unknown { .. } => "not declared".to_string(),
            LanguageProblem::Twice { .. } => "declared again".to_string(),
            LanguageProblem::Circle { .. } => "in a circle".to_string(),
            LanguageProblem::Arguments { expected, .. } => format!("expected {expected} arguments"),
            LanguageProblem::Sort { sort, .. } => format!("expected a term of the sort `{sort}`"),
            LanguageProblem::Clash { second, .. } => format!("`{second}` here"),
            LanguageProblem::Unsafe { .. } => "has no value".to_string(),
            LanguageProblem::Anonymous { .. } => "expected a variable or a name".to_string(),
            LanguageProblem::Kind { expected, .. } => format!("expected {expected}"),
            LanguageProblem::NegatedHead { .. } => "cannot be concluded".to_string(),
            LanguageProblem::Negation { .. } => "negated here".to_string(),
        }
    }

    fn help(&self) -> Option<String> {
        match self {
            LanguageProblem::Form(problem) => problem.help(),
            LanguageProblem::Unknown { nearest: Some(name), .. }
            | LanguageProblem::Sort { nearest: Some(name), .. }
            | LanguageProblem::Word { nearest: Some(name), .. } => Some(format!("did you mean `{name}`?")),
            LanguageProblem::Unsafe { .. } => {
                Some("use it as an argument, or compare it with something that is one".to_string())
            }
            LanguageProblem::Anonymous { .. } => {
                Some("`_` means that some value will do, which only a condition can say".to_string())
            }
            _ => None,
        }
    }
}
