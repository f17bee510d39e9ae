//! The resulting ground program: literals and rules.

/// An atom of the ground program, from 1; negative for its negation.
pub type Literal = i32;

/// A rule of the ground program: `head :- body`, or `{ head } :- body` for a choice; without a
/// head, a constraint.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct GroundRule {
    /// Whether the head may be chosen freely.
    pub choice: bool,
    /// Its conclusion.
    pub head: Option<Literal>,
    /// Its conditions.
    pub body: Vec<Literal>,
}

/// Truth of a goal at some time.
pub enum Prospect {
    /// It is true.
    Certain,
    /// It cannot be true.
    Never,
    /// It is true if this literal is true.
    If(Literal),
}
