//! What can be wrong with the form of any file, before its meaning is looked at.

use crate::fault::Problem;
use crate::file::MAX_FILE;
use crate::names::A_NAME;

/// What can be wrong with the form of a file: unreadable, not UTF-8, not XML, or not the elements and attributes
/// that were expected.
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
    /// The file is not UTF-8.
    #[error("this file is not UTF-8 text: found the byte 0x{byte:02x}")]
    NotUtf8 {
        /// The first byte that does not fit.
        byte: u8,
    },
    /// The file is not XML.
    #[error("this is not valid XML: {why}")]
    Xml {
        /// The parser's reason.
        why: String,
    },
    /// XML that is larger in some way than any honest file.
    #[error("this has {what}, expected at most {most}")]
    TooMuch {
        /// Of what there is too much, such as `an element with more attributes than are read`.
        what: &'static str,
        /// How much there may be.
        most: usize,
    },
    /// The outermost element is another one.
    #[error("found the outermost element <{found}>, expected <{expected}>")]
    Root {
        /// What the file has.
        found: String,
        /// What it must have.
        expected: &'static str,
    },
    /// An element that does not belong here.
    #[error("found <{found}> inside <{parent}>, expected {expected}")]
    Element {
        /// What the file has.
        found: String,
        /// The element around it.
        parent: String,
        /// The elements that may stand here.
        expected: String,
        /// The most similar of them.
        nearest: Option<String>,
    },
    /// An attribute that looks like a misspelt one.
    #[error("<{element}> has no attribute `{found}`")]
    Attribute {
        /// What the file has.
        found: String,
        /// The element it stands in.
        element: String,
        /// The most similar attribute.
        nearest: String,
    },
    /// An attribute that must be there is not.
    #[error("<{element}> has no attribute `{attribute}`, which it needs")]
    Missing {
        /// The element.
        element: String,
        /// The attribute.
        attribute: &'static str,
    },
    /// Not a number, or one out of range.
    #[error("found {attribute}=\"{found}\", expected {expected}")]
    Number {
        /// The attribute.
        attribute: &'static str,
        /// Its value.
        found: String,
        /// What it may be.
        expected: String,
    },
    /// Neither `True` nor `False`, or the like.
    #[error("found {attribute}=\"{found}\", expected {expected}")]
    Choice {
        /// The attribute.
        attribute: &'static str,
        /// Its value.
        found: String,
        /// What it may be.
        expected: &'static str,
    },
    /// A name that is none.
    #[error("found the name \"{found}\", expected {A_NAME}")]
    Name {
        /// The name, shortened.
        found: String,
    },
    /// A file that says no name, and is itself called what is none.
    #[error("no name stands here, and that of the file, \"{found}\", is none: expected {A_NAME}")]
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
