//! Format of numbers in the tables of a page.

use maud::{Markup, html};
use ramp_result::statistics::Interval;

/// Placeholder for a missing value.
pub(crate) const NONE: &str = "–";

/// A count with its noun.
pub(crate) fn counted(count: usize, one: &str, many: &str) -> String {
    format!("{count} {}", if count == 1 { one } else { many })
}

/// A share as per cent, without the sign.
pub(crate) fn share(share: f64) -> String {
    format!("{:.1}", 100.0 * share)
}

/// A share as per cent, with the sign.
pub(crate) fn percent(share: f64) -> String {
    format!("{:.1} %", 100.0 * share)
}

/// Seconds without the unit.
pub(crate) fn time(time: f64) -> String {
    format!("{time:.1}")
}

/// Seconds with the unit.
pub(crate) fn seconds(time: f64) -> String {
    if time >= 1.0 || time == 0.0 { format!("{time:.1} s") } else { format!("{time:.3} s") }
}

/// An interval in small print.
pub(crate) fn small(interval: Option<Interval>, say: fn(f64) -> String) -> Markup {
    html! {
        @if let Some(interval) = interval {
            small { (say(interval.low)) " to " (say(interval.high)) }
        }
    }
}
