//! Text as a cell of a table that spreadsheets read.

use std::borrow::Cow;

/// Text as a CSV cell that no spreadsheet takes for a formula: if it begins like a formula and is
/// not a number, an apostrophe is put in front.
///
/// ```
/// # use ramp_source::cell;
/// assert_eq!(cell("=HYPERLINK(\"x\")"), "'=HYPERLINK(\"x\")");
/// assert_eq!(cell("-0.25"), "-0.25");
/// assert_eq!(cell("hard-2"), "hard-2");
/// ```
pub fn cell(text: &str) -> Cow<'_, str> {
    let blank = text.starts_with(['\t', '\r', '\n']);
    let formula = text.trim_start().starts_with(['=', '+', '-', '@']);
    let number = text.parse::<f64>().is_ok_and(f64::is_finite);
    if (blank || formula) && !number { Cow::Owned(format!("'{text}")) } else { Cow::Borrowed(text) }
}
