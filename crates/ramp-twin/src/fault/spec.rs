//! One fault of an episode, as it is written and as it is reported.

use super::kind::FaultKind;
use ramp_kit::source::{nearest, shorten};
use std::fmt;
use std::str::FromStr;

/// One fault of an episode.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fault {
    /// Kind of the fault.
    pub kind: FaultKind,
    /// Number of the occasion ([`FaultKind::occasions`]) at which it strikes, from 1; `None`: drawn from the
    /// seed.
    pub occasion: Option<u32>,
}

impl fmt::Display for Fault {
    /// As it is written on the command line.
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self.occasion {
            Some(occasion) => write!(f, "{}@{occasion}", self.kind.name()),
            None => f.write_str(self.kind.name()),
        }
    }
}

/// Error in the text of a fault.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum FaultError {
    /// The kind is unknown.
    #[error("unknown fault `{found}`; {help}")]
    Kind {
        /// The text found.
        found: String,
        /// The most similar kind, or all kinds.
        help: String,
    },
    /// The text after the `@` is not the number of an occasion.
    #[error("invalid occasion `{found}` of the fault `{kind}`: expected a number from 1 after the @")]
    Occasion {
        /// The kind.
        kind: &'static str,
        /// The text found.
        found: String,
    },
}

impl FromStr for Fault {
    type Err = FaultError;

    /// Reads `KIND` or `KIND@N`.
    ///
    /// ```
    /// use ramp_twin::{Fault, FaultKind};
    /// let fault: Fault = "peg-dropped@2".parse().unwrap();
    /// assert_eq!(fault, Fault { kind: FaultKind::PegDropped, occasion: Some(2) });
    /// assert_eq!("jam".parse(), Ok(Fault { kind: FaultKind::Jam, occasion: None }));
    /// assert!("peg-droped".parse::<Fault>().unwrap_err().to_string().contains("`peg-dropped`"));
    /// assert!("jam@0".parse::<Fault>().is_err());
    /// ```
    fn from_str(text: &str) -> Result<Fault, FaultError> {
        let (word, number) = match text.split_once('@') {
            Some((word, number)) => (word, Some(number)),
            None => (text, None),
        };
        let Some(kind) = FaultKind::ALL.into_iter().find(|kind| kind.name() == word) else {
            let names = FaultKind::ALL.map(FaultKind::name);
            let help = nearest(word, names).map_or_else(
                || format!("expected one of {}", names.join(", ")),
                |near| format!("did you mean `{near}`?"),
            );
            return Err(FaultError::Kind { found: shorten(word), help });
        };
        let occasion = match number {
            None => None,
            Some(number) => match number.parse().ok().filter(|it| *it > 0) {
                Some(number) => Some(number),
                None => return Err(FaultError::Occasion { kind: kind.name(), found: shorten(number) }),
            },
        };
        Ok(Fault { kind, occasion })
    }
}

/// Report of a fault, for the result only. The agent does not see it.
#[derive(Clone, Debug, PartialEq)]
pub struct FaultReport {
    /// Kind of the fault.
    pub kind: FaultKind,
    /// Number of the occasion at which it strikes, from 1.
    pub occasion: u32,
    /// Robot time at which it struck, s; `None` when the occasion has not come.
    pub at: Option<f64>,
    /// The part that it struck; `None` if it strikes no part.
    pub part: Option<String>,
    /// Size of the fault, in the unit that the text names: m, rad, N, N/s or s; `None` where it has no size.
    pub size: Option<f64>,
    /// Description of the event in English.
    pub text: String,
}
