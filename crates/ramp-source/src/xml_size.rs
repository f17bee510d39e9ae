//! Size limits of XML elements, checked before parsing.
//!
//! A parser compares each attribute of an element with all others, so an element that fills a file
//! with attributes takes minutes. One pass over the tags finds such files at once. It knows only as
//! much XML as it needs; the parser reports all other errors.

use crate::form::FormProblem;
use std::ops::Range;

/// Largest number of attributes of one element.
const MAX_ATTRIBUTES: usize = 64;
/// Largest nesting depth of elements.
const MAX_DEPTH: usize = 32;
/// Longest attribute, name and value together, and longest element name, bytes.
const MAX_LENGTH: usize = 4096;
/// Constructs that begin with `<` and do not end with `>` alone.
const OTHERS: [(&str, &str); 3] = [("<!--", "-->"), ("<![CDATA[", "]]>"), ("<?", "?>")];

/// Walks over all tags.
///
/// # Errors
/// The size that exceeds its limit, and its place.
pub(crate) fn check_size(text: &str) -> Result<(), (FormProblem, Range<usize>)> {
    let mut depth = 0_usize;
    let mut at = 0;
    while let Some(begin) = text[at..].find('<').map(|found| at + found) {
        let rest = &text[begin..];
        if let Some((open, close)) = OTHERS.iter().find(|(open, _)| rest.starts_with(open)) {
            let Some(end) = rest[open.len()..].find(close) else { return Ok(()) };
            at = begin + open.len() + end + close.len();
            continue;
        }
        let end = tag(text, begin)?;
        let inside = &text[begin..end];
        if inside.starts_with("</") {
            depth = depth.saturating_sub(1);
        } else if !inside.ends_with("/>") {
            depth += 1;
        }
        if depth > MAX_DEPTH {
            let what = "more elements around one another than are read";
            return Err((FormProblem::TooMuch { what, most: MAX_DEPTH }, begin..end));
        }
        at = end;
    }
    Ok(())
}

/// End of the tag that begins at `begin`.
fn tag(text: &str, begin: usize) -> Result<usize, (FormProblem, Range<usize>)> {
    let mut quote = None;
    let mut attributes = 0;
    // End of the element's name, or of the last attribute.
    let mut last = begin;
    for (offset, byte) in text[begin..].bytes().enumerate() {
        let at = begin + offset;
        match (quote, byte) {
            (Some(open), _) if byte == open => {
                quote = None;
                last = at;
            }
            (Some(_), _) => {}
            (None, b'"' | b'\'') => quote = Some(byte),
            (None, b'>') => return Ok(at + 1),
            (None, b'=') => {
                attributes += 1;
                if attributes > MAX_ATTRIBUTES {
                    let what = "an element with more attributes than are read";
                    return Err((FormProblem::TooMuch { what, most: MAX_ATTRIBUTES }, at..at + 1));
                }
            }
            (None, b' ' | b'\n' | b'\t' | b'\r') if attributes == 0 => last = at,
            (None, _) => {}
        }
        if at - last > MAX_LENGTH {
            let what = "a longer name or value than is read";
            return Err((FormProblem::TooMuch { what, most: MAX_LENGTH }, last..last + 1));
        }
    }
    Ok(text.len())
}
