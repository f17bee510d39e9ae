//! The text in the bytes of a file, in the encodings that editors, spreadsheets and shells write.

use std::borrow::Cow;

/// The byte order mark of UTF-8.
const MARK: &[u8] = "\u{feff}".as_bytes();
/// The byte order marks of UTF-32, which no program here reads.
const UTF_32: [&[u8]; 2] = [&[0xff, 0xfe, 0, 0], &[0, 0, 0xfe, 0xff]];

/// Why bytes are no text.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("this is not UTF-8 text: found {found}")]
pub struct NoText {
    /// What was found instead.
    pub found: String,
    /// The text before it.
    pub before: String,
}

/// The text in the bytes of a file: UTF-8, with or without a byte order mark, or UTF-16 with one. The mark
/// is no part of the text.
///
/// # Errors
/// When it is in another encoding, or damaged.
///
/// ```
/// use ramp_source::decode;
/// assert_eq!(decode(b"\xef\xbb\xbf{}").unwrap(), "{}");
/// assert_eq!(decode(b"\xff\xfe{\0}\0").unwrap(), "{}");
/// assert!(decode(b"{\0}\0").unwrap_err().to_string().contains("UTF-16 without a byte order mark"));
/// ```
pub fn decode(bytes: &[u8]) -> Result<Cow<'_, str>, NoText> {
    let no_text = |found: &str| NoText { found: found.to_string(), before: String::new() };
    if UTF_32.iter().any(|mark| bytes.starts_with(mark)) {
        return Err(no_text("UTF-32"));
    }
    match bytes {
        [0xff, 0xfe, rest @ ..] => return utf_16(rest, u16::from_le_bytes).map(Cow::Owned),
        [0xfe, 0xff, rest @ ..] => return utf_16(rest, u16::from_be_bytes).map(Cow::Owned),
        // ASCII characters in UTF-16: every second byte is zero.
        [one, other, ..] if (*one == 0) != (*other == 0) => {
            return Err(no_text("zero bytes, as in UTF-16 without a byte order mark"));
        }
        _ => {}
    }
    let bytes = without_mark(bytes);
    match std::str::from_utf8(bytes) {
        Ok(text) => Ok(Cow::Borrowed(text)),
        Err(error) => {
            let (valid, rest) = bytes.split_at(error.valid_up_to());
            Err(NoText {
                found: format!("the byte 0x{:02x}", rest.first().copied().unwrap_or_default()),
                before: String::from_utf8_lossy(valid).into_owned(),
            })
        }
    }
}

/// The bytes without the byte order mark of UTF-8 that they may begin with.
pub fn without_mark(bytes: &[u8]) -> &[u8] {
    bytes.strip_prefix(MARK).unwrap_or(bytes)
}

fn utf_16(bytes: &[u8], unit: fn([u8; 2]) -> u16) -> Result<String, NoText> {
    let (units, rest) = bytes.as_chunks::<2>();
    let mut text = String::with_capacity(units.len());
    for c in char::decode_utf16(units.iter().copied().map(unit)) {
        match c {
            Ok(c) => text.push(c),
            Err(error) => {
                let found = format!("UTF-16 with half a character, 0x{:04x}", error.unpaired_surrogate());
                return Err(NoText { found, before: text });
            }
        }
    }
    match rest {
        [] => Ok(text),
        _ => Err(NoText { found: "UTF-16 with an odd number of bytes".to_string(), before: text }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_encoding_gives_its_text_or_its_name() {
        let text = "größer\r\n𝛼";
        let units = || text.encode_utf16();
        let little: Vec<u8> = [0xff, 0xfe].into_iter().chain(units().flat_map(u16::to_le_bytes)).collect();
        let big: Vec<u8> = [0xfe, 0xff].into_iter().chain(units().flat_map(u16::to_be_bytes)).collect();
        for bytes in [text.as_bytes(), &[MARK, text.as_bytes()].concat(), &little, &big] {
            assert_eq!(decode(bytes).unwrap(), text, "{bytes:?}");
        }
        assert_eq!(decode(b"").unwrap(), "");
        let found = |bytes: &[u8]| decode(bytes).unwrap_err().found;
        assert_eq!(found(b"gr\xf6sser"), "the byte 0xf6");
        assert_eq!(found(&little[2..]), "zero bytes, as in UTF-16 without a byte order mark");
        assert_eq!(found(&big[2..]), "zero bytes, as in UTF-16 without a byte order mark");
        assert_eq!(found(b"\xff\xfea\0b"), "UTF-16 with an odd number of bytes");
        assert_eq!(found(&little[..little.len() - 2]), "UTF-16 with half a character, 0xd835");
        assert_eq!(found(b"\xff\xfe\0\0a\0\0\0"), "UTF-32");
        assert_eq!(decode(b"\xef\xbb\xbfab\xff").unwrap_err().before, "ab");
    }
}
