//! Rejects dangerous rule files before clingo sees them.
//!
//! Directives that make clingo read a file or run a program are refused everywhere, also in
//! comments and in quotes. clingo's lexer knows each of them only as one piece, without spaces and
//! escapes, so no reading of the file can find one that this search does not. The length of
//! statements is counted as clingo's lexer sees them.

use super::problem::{MAX_STATEMENT, OrderProblem};
use std::ops::Range;

/// `#include` reads files, `#script` runs programs, `#theory` changes the signs of statements.
const FOREIGN: [&str; 3] = ["#include", "#script", "#theory"];
/// Head of a numeric ground program, which clingo would read instead of rules.
const GROUND: &str = "asp ";

/// Scans a rule file.
///
/// # Errors
/// The first forbidden directive, and its place.
pub(super) fn scan(text: &str) -> Result<(), (OrderProblem, Range<usize>)> {
    let places = FOREIGN.into_iter().filter_map(|word| Some((text.find(word)?, word)));
    if let Some((at, word)) = places.min() {
        return Err((OrderProblem::Foreign { word }, at..at + word.len()));
    }
    if text.starts_with(GROUND) {
        return Err((OrderProblem::Foreign { word: GROUND.trim_end() }, 0..GROUND.len() - 1));
    }
    let mut at = 0;
    // Start of the current statement, and its length so far.
    let mut begin = 0;
    let mut length = 0;
    while let Some(byte) = text.as_bytes().get(at) {
        let rest = &text.as_bytes()[at..];
        let step = match byte {
            _ if rest.starts_with(b"%*") => {
                at += block(rest);
                continue;
            }
            b'%' => {
                at += line(rest);
                continue;
            }
            b'#' if rest.starts_with(b"#!") => {
                at += line(rest);
                continue;
            }
            b' ' | b'\t' | b'\r' | b'\n' => {
                at += 1;
                continue;
            }
            b'"' => quoted(rest),
            b'.' if rest.starts_with(b"..") => 2,
            _ => 1,
        };
        if length == 0 {
            begin = at;
        }
        length += step;
        if length > MAX_STATEMENT {
            return Err((OrderProblem::Long, begin..begin + 1));
        }
        if step == 1 && *byte == b'.' {
            length = 0;
        }
        at += step;
    }
    Ok(())
}

/// The length of a comment to the end of its line.
fn line(text: &[u8]) -> usize {
    text.iter().position(|&byte| byte == b'\n').unwrap_or(text.len())
}

/// The length of a comment between `%*` and `*%`; comments of both kinds may be nested.
fn block(text: &[u8]) -> usize {
    let mut open = 0;
    let mut at = 0;
    while at < text.len() {
        let rest = &text[at..];
        if rest.starts_with(b"*%") {
            open -= 1;
            at += 2;
            if open == 0 {
                return at;
            }
        } else if rest.starts_with(b"%*") {
            open += 1;
            at += 2;
        } else if rest.starts_with(b"%") {
            at += line(rest);
        } else {
            at += 1;
        }
    }
    at
}

/// The length of a string; 1 for an unterminated one, which clingo refuses.
fn quoted(text: &[u8]) -> usize {
    let mut at = 1;
    while let Some(byte) = text.get(at) {
        match (byte, text.get(at + 1)) {
            (b'"', _) => return at + 1,
            (b'\\', Some(b'\\' | b'"' | b'n')) => at += 2,
            (b'\\' | b'\n', _) => return 1,
            _ => at += 1,
        }
    }
    1
}
