//! Why an action cannot be carried out.

/// Why there is no next state.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Refusal {
    /// There is no such action.
    Unknown(String),
    /// A law forbids it.
    Impossible(Reason),
    /// The laws contradict each other about this fluent.
    Contradiction(String),
}

/// A law that forbids an action, and the conditions of it that were true.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Reason {
    /// As the domain has it.
    pub law: String,
    /// Its line in the file.
    pub line: usize,
    /// Its conditions, with what stood for the variables.
    pub conditions: Vec<String>,
    /// The objects in them.
    pub objects: Vec<String>,
}
