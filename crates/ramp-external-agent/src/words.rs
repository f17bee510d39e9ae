//! Passes on what an agent says to a person on its standard error.

use std::io::{BufRead, BufReader, Read, Write};

/// How much is passed on, bytes.
const MOST: u64 = 1 << 20;
/// The longest line that is passed on in one piece, bytes.
const LONGEST: u64 = 1 << 13;

/// Passes on words up to a limit; the rest is taken in and forgotten. No control character reaches the
/// terminal, where it could move the cursor, change a title or hide a line.
pub(crate) fn pass_on(words: impl Read, mut out: impl Write) {
    let mut words = BufReader::new(words);
    let mut left = MOST;
    let mut line = Vec::new();
    while left > 0 {
        line.clear();
        let read = words.by_ref().take(LONGEST.min(left)).read_until(b'\n', &mut line).unwrap_or(0);
        if read == 0 {
            return;
        }
        left -= read as u64;
        // A reader that is gone is no fault of the agent's.
        let _ = out.write_all(visible(&line).as_bytes());
    }
    let _ = out.write_all(b"\n(the agent says more than is shown)\n");
    let _ = std::io::copy(&mut words, &mut std::io::sink());
}

/// The text of a line: each control character but tab and line end is replaced, and so are characters that
/// change the direction of the text.
fn visible(line: &[u8]) -> String {
    let hidden = |it: char| {
        it.is_control() && it != '\n' && it != '\t'
            || matches!(it, '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
    };
    String::from_utf8_lossy(line).chars().map(|it| if hidden(it) { '\u{fffd}' } else { it }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_control_character_of_an_agent_is_passed_on() {
        let said = b"\x1b]0;title\x07a\tb\r\x1b[2J\xc2\x9b2J\xff\xe2\x80\xae\n\x00end";
        let mut out = Vec::new();
        pass_on(&said[..], &mut out);
        let out = String::from_utf8(out).expect("text");
        assert!(!out.contains(|it: char| it.is_control() && it != '\n' && it != '\t'), "{out:?}");
        assert!(out.contains("a\tb") && out.ends_with("end") && out.contains('\n'), "{out:?}");
        assert!(!out.contains('\u{202e}'));
    }

    #[test]
    fn much_is_cut_and_taken_in_to_its_end() {
        let mut said = std::io::Cursor::new(vec![b'x'; 3 << 20]);
        let mut out = Vec::new();
        pass_on(&mut said, &mut out);
        assert_eq!(said.position(), 3 << 20);
        assert!(out.len() < 2 << 20 && out.ends_with(b"more than is shown)\n"));
    }
}
