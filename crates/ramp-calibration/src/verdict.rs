//! Whether an estimate is good enough.

use std::fmt;

/// A quantity that is judged against a limit.
#[derive(Clone, Debug, PartialEq)]
pub struct Measure {
    /// Its name.
    pub name: &'static str,
    /// Its value, in `unit`.
    pub value: f64,
    /// The largest value that is good enough.
    pub limit: f64,
    /// Its unit.
    pub unit: &'static str,
}

impl Measure {
    /// Is it within its limit?
    pub fn is_good(&self) -> bool {
        self.value <= self.limit
    }
}

impl fmt::Display for Measure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Measure { name, value, limit, unit } = self;
        let word = if self.is_good() { "good" } else { "too large" };
        write!(f, "{name}: {value:.3} {unit}, {word} (at most {limit} {unit})")
    }
}

/// All quantities that an estimate is judged by. It is good enough if each of them is.
#[derive(Clone, Debug, PartialEq)]
pub struct Verdict {
    /// The quantities.
    pub measures: Vec<Measure>,
}

impl Verdict {
    /// Is the estimate good enough?
    pub fn is_good(&self) -> bool {
        self.measures.iter().all(Measure::is_good)
    }
}
