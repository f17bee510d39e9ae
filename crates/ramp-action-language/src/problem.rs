//! What can be wrong with a domain.

use ramp_source::{Fault, FormProblem, Problem, shorten};

/// What is wrong with a domain, and where.
pub type LanguageError = Fault<LanguageProblem>;

/// What can be wrong with a domain.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LanguageProblem {
    /// The file cannot be read.
    #[error(transparent)]
    Form(#[from] FormProblem),
    /// A character that no word begins with.
    #[error("found the character `{}`, which means nothing here", shorten(&found.to_string()))]
    Character {
        /// The character.
        found: char,
    },
    /// A quoted name that does not end on its line.
    #[error("this name has no closing quote on its line")]
    Quote,
    /// A number with too many digits.
    #[error("the number {found} is too large")]
    Number {
        /// Its digits.
        found: String,
    },
    /// Another word than the grammar asks for.
    #[error("found {found}, expected {expected}")]
    Word {
        /// What the file has.
        found: String,
        /// What the grammar asks for.
        expected: String,
        /// A keyword that is most like what was found.
        nearest: Option<String>,
    },
    /// Terms within terms within terms.
    #[error("this term is nested too deep")]
    Depth,
    /// A name that is declared nowhere.
    #[error("there is no {kind} `{name}`")]
    Unknown {
        /// `sort`, `static, fluent or action`, …
        kind: &'static str,
        /// The name.
        name: String,
        /// The declared name most like it.
        nearest: Option<String>,
    },
    /// A name that is declared twice.
    #[error("`{name}` is declared twice")]
    Twice {
        /// The name.
        name: String,
    },
    /// A sort that contains itself.
    #[error("the sort `{name}` is a part of itself")]
    Circle {
        /// The sort.
        name: String,
    },
    /// The wrong number of arguments.
    #[error("`{name}` has {found} arguments, but is declared with {expected}")]
    Arguments {
        /// The name.
        name: String,
        /// As written.
        found: usize,
        /// As declared.
        expected: usize,
    },
    /// A term where its sort does not belong.
    #[error("`{term}` is not of the sort `{sort}`")]
    Sort {
        /// The term.
        term: String,
        /// The sort that belongs there.
        sort: String,
        /// The element of the sort most like the term.
        nearest: Option<String>,
    },
    /// A variable in places whose sorts have nothing in common.
    #[error("the variable `{variable}` would have to be of the sorts `{first}` and `{second}` at once")]
    Clash {
        /// The variable.
        variable: String,
        /// One sort.
        first: String,
        /// The other.
        second: String,
    },
    /// A variable that nothing gives a value to.
    #[error("the variable `{variable}` is unsafe: no static, fluent or action gives it a value")]
    Unsafe {
        /// The variable.
        variable: String,
    },
    /// `_` where every value would be meant.
    #[error("`_` cannot stand in {place}")]
    Anonymous {
        /// Where it stands.
        place: &'static str,
    },
    /// A kind of name where another belongs.
    #[error("`{name}` is {found}, but {expected} belongs here")]
    Kind {
        /// The name.
        name: String,
        /// What it is.
        found: &'static str,
        /// What belongs here.
        expected: &'static str,
    },
    /// A negated head that cannot be.
    #[error(
        "`{name}` is {found}; what is not derived of it is false anyway, so a law cannot conclude `-{name}`"
    )]
    NegatedHead {
        /// The name.
        name: String,
        /// What it is.
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
