//! The ground program that comes out: literals and rules.

/// An atom of the ground program, counted from 1; negative where it is false.
pub type Literal = i32;

/// A rule of the ground program: `head :- body`, or `{ head } :- body` for a choice; without a head, a constraint.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct GroundRule {
    /// May the head be chosen freely?
    pub choice: bool,
    /// What it concludes.
    pub head: Option<Literal>,
    /// Under which conditions.
    pub body: Vec<Literal>,
}

/// What can be said of a goal at some time.
pub enum Prospect {
    /// It is true.
    Certain,
    /// It cannot be true.
    Never,
    /// It is true if this literal is.
    If(Literal),
}
