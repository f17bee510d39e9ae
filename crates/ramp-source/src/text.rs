//! Untrusted text for a person: allowed characters, and safe display in a message.

use crate::names::MAX_NAME;
use std::borrow::Cow;

/// Length limit of a title, such as the name of a robot or of a publication, characters.
pub const MAX_TITLE: usize = 256;
/// Length limit of a sentence, such as an event or the reason of an episode's end, characters.
pub const MAX_SENTENCE: usize = 1000;

/// Whether this is a text of at most `most` visible characters.
///
/// ```
/// # use ramp_source::{MAX_TITLE, is_text};
/// assert!(is_text("Franka Research 3, größer", MAX_TITLE));
/// assert!(!is_text("two\nlines", MAX_TITLE) && !is_text("\u{1b}[2J", MAX_TITLE));
/// ```
pub fn is_text(text: &str, most: usize) -> bool {
    text.chars().count() <= most && !text.contains(hides)
}

/// Text made safe for a message: invisible characters are escaped, and text longer than `most`
/// characters is cut and ends in an ellipsis.
///
/// ```
/// # use ramp_source::plain;
/// assert_eq!(plain("a\n\u{1b}[2J", 80), "a\\n\\u{1b}[2J");
/// assert_eq!(plain("abc", 2), "ab…");
/// ```
pub fn plain(text: &str, most: usize) -> String {
    let (mut short, mut length) = (String::new(), 0);
    for c in text.chars() {
        let written = if hides(c) { c.escape_default().to_string() } else { c.to_string() };
        length += written.chars().count();
        if length > most {
            short.push('…');
            break;
        }
        short.push_str(&written);
    }
    short
}

/// Text made safe for a message, cut to the length of a name.
pub fn shorten(text: &str) -> String {
    plain(text, MAX_NAME)
}

/// The text with invisible characters replaced by others of the same length, so that every byte
/// offset remains valid. Line breaks and tabs stay.
pub(crate) fn visible(text: &str) -> Cow<'_, str> {
    let bad = |c: char| hides(c) && !matches!(c, '\n' | '\r' | '\t');
    if !text.contains(bad) {
        return Cow::Borrowed(text);
    }
    let instead = |c: char| match c.len_utf8() {
        1 => '?',
        2 => '·',
        _ => '\u{fffd}',
    };
    Cow::Owned(text.chars().map(|c| if bad(c) { instead(c) } else { c }).collect())
}

/// Whether a character is invisible or changes the display of others: control characters, line and
/// paragraph separators, and direction marks.
fn hides(c: char) -> bool {
    let turns =
        matches!(c, '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    c.is_control() || turns || matches!(c, '\u{2028}' | '\u{2029}' | '\u{feff}' | '\u{fffe}' | '\u{ffff}')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_shown_in_place_of_a_hidden_character_is_as_long() {
        let text = "a\u{1b}b\u{9b}c\u{202e}d\ne";
        let shown = visible(text);
        assert_eq!(shown.len(), text.len());
        assert_eq!(shown, "a?b·c\u{fffd}d\ne");
    }
}
