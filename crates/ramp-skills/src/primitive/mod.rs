//! Primitives that all skills share: motions, looks, grips, searches.

pub mod carry;
pub mod grip;
pub mod look;
pub mod peg_search;
pub mod press;
pub mod probe;
pub mod release;
pub mod search;
pub mod touch;
pub mod travel;
pub mod wrench;
