//! Ground terms: the elements of facts and answers.

use std::fmt::{self, Display, Write};

/// Largest nesting depth of a term that is read; laws have a depth of two.
const MAX_DEPTH: usize = 16;

/// A ground term, such as `move(input)`, `"b4"` or `(1,0)`.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Term {
    /// A whole number.
    Number(i64),
    /// A name, quoted in the rules, so that any name of a problem is valid.
    Text(String),
    /// A function with arguments; a constant if it has none, a tuple if it has no name.
    Function(String, Vec<Term>),
    /// The largest term, `#sup`, and the few other terms without a meaning here.
    Other(String),
}

impl Term {
    /// `name(arguments)`, or the constant `name`.
    pub fn new<const N: usize>(name: &str, arguments: [Term; N]) -> Term {
        Term::Function(name.to_string(), arguments.into())
    }

    /// Reads a term such as `in_hand(beam("b4"))`; `None` on a syntax error.
    pub fn read(text: &str) -> Option<Term> {
        let mut rest = text.trim();
        let term = read(&mut rest, MAX_DEPTH)?;
        rest.is_empty().then_some(term)
    }

    /// The same with constant arguments as texts: `beam(b4)` becomes `beam("b4")`.
    pub fn quoted(&self) -> Term {
        let Term::Function(name, arguments) = self else { return self.clone() };
        let quoted = |argument: &Term| match argument {
            Term::Function(word, none) if none.is_empty() => Term::Text(word.clone()),
            other => other.quoted(),
        };
        Term::Function(name.clone(), arguments.iter().map(quoted).collect())
    }

    /// The name and the arguments of a function, a constant or a tuple.
    pub fn parts(&self) -> Option<(&str, &[Term])> {
        match self {
            Term::Function(name, arguments) => Some((name, arguments)),
            _ => None,
        }
    }

    /// The texts in it, at any depth, from left to right.
    pub fn texts(&self) -> Vec<&str> {
        match self {
            Term::Text(text) => vec![text],
            Term::Function(_, arguments) => arguments.iter().flat_map(Term::texts).collect(),
            _ => Vec::new(),
        }
    }

    /// The same term with its texts replaced.
    pub fn with_texts(&self, change: &mut impl FnMut(&str) -> String) -> Term {
        match self {
            Term::Text(text) => Term::Text(change(text)),
            Term::Function(name, arguments) => {
                let arguments = arguments.iter().map(|argument| argument.with_texts(change)).collect();
                Term::Function(name.clone(), arguments)
            }
            other => other.clone(),
        }
    }

    /// The numbers in it.
    pub fn numbers(&self) -> Vec<i64> {
        match self {
            Term::Number(number) => vec![*number],
            Term::Function(_, arguments) => arguments.iter().flat_map(Term::numbers).collect(),
            Term::Text(_) | Term::Other(_) => Vec::new(),
        }
    }

    /// The same term with its numbers replaced.
    #[must_use]
    pub fn with_numbers(&self, change: &mut impl FnMut(i64) -> i64) -> Term {
        match self {
            Term::Number(number) => Term::Number(change(*number)),
            Term::Function(name, arguments) => {
                let arguments = arguments.iter().map(|argument| argument.with_numbers(change)).collect();
                Term::Function(name.clone(), arguments)
            }
            other => other.clone(),
        }
    }
}

/// Takes a term from the beginning of a text.
fn read(rest: &mut &str, depth: usize) -> Option<Term> {
    if let Some(quoted) = rest.strip_prefix('"') {
        let (text, after) = read_text(quoted)?;
        *rest = after.trim_start();
        return Some(Term::Text(text));
    }
    let end = rest.find(|c: char| !c.is_alphanumeric() && !matches!(c, '_' | '-')).unwrap_or(rest.len());
    let (word, after) = rest.split_at(end);
    if word.is_empty() {
        return None;
    }
    *rest = after.trim_start();
    let Some(inside) = rest.strip_prefix('(') else {
        let number = word.parse().map(Term::Number).ok();
        return Some(number.unwrap_or_else(|| Term::Function(word.to_string(), Vec::new())));
    };
    *rest = inside.trim_start();
    let mut arguments = Vec::new();
    loop {
        arguments.push(read(rest, depth.checked_sub(1)?)?);
        if let Some(after) = rest.strip_prefix(')') {
            *rest = after.trim_start();
            return Some(Term::Function(word.to_string(), arguments));
        }
        *rest = rest.strip_prefix(',')?.trim_start();
    }
}

/// Reads a text after its opening quote, with the escapes of [`Display`]: the text, and the rest
/// after its closing quote.
fn read_text(quoted: &str) -> Option<(String, &str)> {
    let mut text = String::new();
    let mut chars = quoted.chars();
    loop {
        match chars.next()? {
            '"' => return Some((text, chars.as_str())),
            '\\' => text.push(match chars.next()? {
                'n' => '\n',
                escaped @ ('"' | '\\') => escaped,
                _ => return None,
            }),
            other => text.push(other),
        }
    }
}

impl From<&str> for Term {
    fn from(text: &str) -> Term {
        Term::Text(text.to_string())
    }
}

impl From<usize> for Term {
    fn from(number: usize) -> Term {
        // The numbers of a problem are far smaller.
        Term::Number(i64::try_from(number).unwrap_or(i64::MAX))
    }
}

/// In the syntax of the rules.
impl Display for Term {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Term::Number(number) => write!(f, "{number}"),
            Term::Text(text) => {
                f.write_char('"')?;
                for c in text.chars() {
                    match c {
                        '"' => f.write_str("\\\"")?,
                        '\\' => f.write_str("\\\\")?,
                        '\n' => f.write_str("\\n")?,
                        other => f.write_char(other)?,
                    }
                }
                f.write_char('"')
            }
            Term::Function(name, arguments) => {
                f.write_str(name)?;
                for (index, argument) in arguments.iter().enumerate() {
                    write!(f, "{}{argument}", if index == 0 { '(' } else { ',' })?;
                }
                // A tuple of one element has a comma, and only tuples and functions have
                // parentheses.
                match (name.is_empty(), arguments.len()) {
                    (true, 0) => f.write_str("()"),
                    (true, 1) => f.write_str(",)"),
                    (false, 0) => Ok(()),
                    _ => f.write_char(')'),
                }
            }
            Term::Other(text) => f.write_str(text),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_quoted() {
        let term = Term::new("beam", [Term::from("a\"b\\c\nd")]);
        assert_eq!(term.to_string(), r#"beam("a\"b\\c\nd")"#);
    }

    #[test]
    fn what_is_written_is_read() {
        for text in ["a\"b\\c\nd", "\\", "\\n", "\u{1}\r", ""] {
            let term = Term::new("beam", [Term::from(text)]);
            assert_eq!(Term::read(&term.to_string()), Some(term));
        }
        assert_eq!(Term::read(r#"beam("\x")"#), None);
    }

    #[test]
    fn constants_tuples_and_functions() {
        let tuple = Term::new("", [Term::from(1), Term::new("input", [])]);
        assert_eq!(tuple.to_string(), "(1,input)");
        assert_eq!(Term::new("", [Term::from(1)]).to_string(), "(1,)");
        assert_eq!(Term::new("at", [tuple]).to_string(), "at((1,input))");
    }

    #[test]
    fn supremum_is_the_largest() {
        let key = |first| Term::new("", [first, Term::from(0)]);
        assert!(key(Term::from(7)) < key(Term::Other("#sup".to_string())));
    }
}
