//! Reasons why an action is impossible.

/// Reasons why there is no next state.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Refusal {
    /// The action does not exist.
    Unknown(String),
    /// A law forbids it.
    Impossible(Reason),
    /// The laws contradict each other about this fluent.
    Contradiction(String),
}

/// A law that forbids an action, with its conditions as they matched.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Reason {
    /// As written in the domain.
    pub law: String,
    /// Its line in the file.
    pub line: usize,
    /// Its conditions, with the values of the variables.
    pub conditions: Vec<String>,
    /// The objects in them.
    pub objects: Vec<String>,
}
