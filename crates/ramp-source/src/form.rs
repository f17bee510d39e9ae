//! Problems of the form of any file, checked before its meaning.

use crate::fault::Problem;
use crate::file::MAX_FILE;
use crate::names::A_NAME;

/// Problems of the form of a file: unreadable, not UTF-8, not XML, or unexpected elements and
/// attributes.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FormProblem {
    /// The system cannot read the file.
    #[error("cannot read {file}: {why}")]
    Unreadable {
        /// The file.
        file: String,
        /// The system's reason.
        why: String,
    },
    /// The file is larger than [`MAX_FILE`].
    #[error("this file is larger than {} kB", MAX_FILE / 1024)]
    TooLarge,
    /// The file is no text that [`decode`](crate::decode) reads.
    #[error("this file is not UTF-8 text: found {found}")]
    NotUtf8 {
        /// What was found instead.
        found: String,
    },
    /// The file is not XML.
    #[error("this is not valid XML: {why}")]
    Xml {
        /// The parser's reason.
        why: String,
    },
    /// A size in the XML exceeds its limit.
    #[error("this has {what}, expected at most {most}")]
    TooMuch {
        /// The size, such as `an element with more attributes than are read`.
        what: &'static str,
        /// Its limit.
        most: usize,
    },
    /// The outermost element has the wrong name.
    #[error("found the outermost element <{found}>, expected <{expected}>")]
    Root {
        /// The name found.
        found: String,
        /// The name expected.
        expected: &'static str,
    },
    /// An unexpected element.
    #[error("found <{found}> inside <{parent}>, expected {expected}")]
    Element {
        /// The name found.
        found: String,
        /// The element around it.
        parent: String,
        /// The elements that may stand here.
        expected: String,
        /// The most similar of them.
        nearest: Option<String>,
    },
    /// An attribute that looks like a misspelling.
    #[error("<{element}> has no attribute `{found}`")]
    Attribute {
        /// The name found.
        found: String,
        /// Its element.
        element: String,
        /// The most similar attribute.
        nearest: String,
    },
    /// A required attribute is missing.
    #[error("<{element}> has no attribute `{attribute}`, which it needs")]
    Missing {
        /// The element.
        element: String,
        /// The attribute.
        attribute: &'static str,
    },
    /// Not a number, or out of range.
    #[error("found {attribute}=\"{found}\", expected {expected}")]
    Number {
        /// The attribute.
        attribute: &'static str,
        /// Its value.
        found: String,
        /// The allowed values.
        expected: String,
    },
    /// A value outside a list of choices, such as neither `True` nor `False`.
    #[error("found {attribute}=\"{found}\", expected {expected}")]
    Choice {
        /// The attribute.
        attribute: &'static str,
        /// Its value.
        found: String,
        /// The allowed values.
        expected: &'static str,
    },
    /// An invalid name.
    #[error("found the name \"{found}\", expected {A_NAME}")]
    Name {
        /// The name, shortened.
        found: String,
    },
    /// A file without a name in it, whose own name is invalid.
    #[error("the file states no name, and its own, \"{found}\", is not valid: expected {A_NAME}")]
    FileName {
        /// The name of the file without its ending, shortened.
        found: String,
    },
}

impl Problem for FormProblem {
    fn label(&self) -> String {
        match self {
            FormProblem::Unreadable { .. } | FormProblem::TooLarge => String::new(),
            FormProblem::NotUtf8 { .. } => "from here on".to_string(),
            FormProblem::Xml { .. } => "here".to_string(),
            FormProblem::TooMuch { most, .. } => format!("expected at most {most}"),
            FormProblem::Root { expected, .. } => format!("expected <{expected}>"),
            FormProblem::Element { expected, .. } => format!("expected {expected}"),
            FormProblem::Attribute { .. } => "unknown attribute".to_string(),
            FormProblem::Missing { attribute, .. } => format!("needs {attribute}=\"…\""),
            FormProblem::Number { expected, .. } => format!("expected {expected}"),
            FormProblem::Choice { expected, .. } => format!("expected {expected}"),
            FormProblem::Name { .. } => "not a name".to_string(),
            FormProblem::FileName { .. } => "needs name=\"…\"".to_string(),
        }
    }

    fn help(&self) -> Option<String> {
        match self {
            FormProblem::Element { nearest: Some(nearest), .. } => Some(format!("did you mean <{nearest}>?")),
            FormProblem::Attribute { nearest, .. } => Some(format!("did you mean `{nearest}`?")),
            _ => None,
        }
    }
}
