//! The character between the cells of a CSV file: a comma, or a semicolon or a tab as spreadsheets write
//! them where the comma is the decimal sign.

/// The characters that separate cells.
const SEPARATORS: [u8; 3] = [b',', b';', b'\t'];

/// The number of bytes at the beginning of a file that tell its separator.
const BEGINNING: usize = 4096;

/// How the cells of a file are separated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Separator {
    /// The character.
    pub byte: u8,
    /// Where the first row begins, bytes: after a line `sep=;`, with which some spreadsheets begin.
    pub begin: usize,
}

impl Separator {
    /// The separator of a text: the one that it names, or the first in its first row.
    pub fn of(text: &str) -> Separator {
        let text = &text[..text.floor_char_boundary(BEGINNING)];
        let first = text.lines().next().unwrap_or_default();
        let named = first.trim_end().trim_matches('"').strip_prefix("sep=").map(str::as_bytes);
        // A tab at the end of the line is trimmed.
        if let Some(byte) = named.map(|name| name.first().copied().unwrap_or(b'\t'))
            && SEPARATORS.contains(&byte)
        {
            let begin = text.find('\n').map_or(text.len(), |end| end + 1);
            return Separator { byte, begin };
        }
        let rows = text.lines().filter(|line| !line.trim().is_empty() && !line.starts_with('#'));
        let mut quoted = false;
        let bytes = rows.take(1).flat_map(str::bytes);
        let found = bytes.into_iter().find(|byte| {
            quoted ^= *byte == b'"';
            !quoted && SEPARATORS.contains(byte)
        });
        Separator { byte: found.unwrap_or(b','), begin: 0 }
    }
}
