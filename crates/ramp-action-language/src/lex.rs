//! The lexer: the text of a domain as names, variables, numbers and signs.

use crate::ast::Span;
use crate::problem::{LanguageError, LanguageProblem};
use ramp_source::{Fault, SourceFile, is_text};

/// A token with its place.
#[derive(Clone, Debug)]
pub(crate) struct Word {
    pub what: Token,
    pub span: Span,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Token {
    /// `move`; also the keywords.
    Name(String),
    /// `B`, `_`.
    Variable(String),
    Number(i64),
    /// `"b4"`.
    Quoted(String),
    /// One of `( ) { } , . + - = != < <= > >=`.
    Sign(&'static str),
    End,
}

const SIGNS: [&str; 14] = ["!=", "<=", ">=", "(", ")", "{", "}", ",", ".", "+", "-", "=", "<", ">"];
/// Largest number of digits; sums of such numbers do not overflow.
const DIGITS: usize = 15;

impl Token {
    /// The token as described in messages.
    pub fn describe(&self) -> String {
        match self {
            Token::Name(text) | Token::Variable(text) => format!("`{text}`"),
            Token::Number(number) => format!("`{number}`"),
            Token::Quoted(text) => format!("\"{text}\""),
            Token::Sign(sign) => format!("`{sign}`"),
            Token::End => "the end of the file".to_string(),
        }
    }
}

/// Splits a file into tokens; the last one is [`Token::End`].
pub(crate) fn words(file: &SourceFile) -> Result<Vec<Word>, LanguageError> {
    let text = file.text();
    let mut words = Vec::new();
    let mut at = 0;
    while let Some(first) = text[at..].chars().next() {
        let rest = &text[at..];
        let while_name = || rest.find(|c: char| !c.is_ascii_alphanumeric() && c != '_').unwrap_or(rest.len());
        let fault = |problem, length: usize| Err(Fault::new(problem, file.place(at..at + length)));
        let (what, length) = if first.is_whitespace() {
            at += first.len_utf8();
            continue;
        } else if first == '%' {
            at += rest.find('\n').unwrap_or(rest.len());
            continue;
        } else if first.is_ascii_lowercase() {
            let length = while_name();
            (Token::Name(rest[..length].to_string()), length)
        } else if first.is_ascii_uppercase() || first == '_' {
            let length = while_name();
            (Token::Variable(rest[..length].to_string()), length)
        } else if first.is_ascii_digit() {
            let length = rest.find(|c: char| !c.is_ascii_digit()).unwrap_or(rest.len());
            match rest[..length].parse() {
                Ok(number) if length <= DIGITS => (Token::Number(number), length),
                _ => {
                    return fault(
                        LanguageProblem::Number { found: rest[..length.min(40)].to_string() },
                        length,
                    );
                }
            }
        } else if first == '"' {
            match rest[1..].find(['"', '\n']) {
                Some(end) if rest[1 + end..].starts_with('"') => {
                    let hidden = |c: &char| !is_text(c.encode_utf8(&mut [0; 4]), 1);
                    if let Some((before, found)) = rest[1..=end].char_indices().find(|(_, c)| hidden(c)) {
                        let place = at + 1 + before;
                        let span = file.place(place..place + found.len_utf8());
                        return Err(Fault::new(LanguageProblem::Character { found }, span));
                    }
                    (Token::Quoted(rest[1..1 + end].to_string()), end + 2)
                }
                _ => return fault(LanguageProblem::Quote, 1),
            }
        } else if let Some(sign) = SIGNS.into_iter().find(|sign| rest.starts_with(sign)) {
            (Token::Sign(sign), sign.len())
        } else {
            return fault(LanguageProblem::Character { found: first }, first.len_utf8());
        };
        words.push(Word { what, span: at..at + length });
        at += length;
    }
    words.push(Word { what: Token::End, span: text.len()..text.len() });
    Ok(words)
}
