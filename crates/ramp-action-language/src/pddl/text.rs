//! Elements of PDDL: valid names, variables, atoms, quantifiers.

/// A valid PDDL name: PDDL ignores case.
pub(crate) fn plain(name: &str) -> String {
    let mut text = String::new();
    for c in name.chars() {
        match c {
            '+' => text.push_str("plus_"),
            '-' if text.is_empty() => text.push_str("minus_"),
            c if c.is_ascii_alphanumeric() => text.push(c.to_ascii_lowercase()),
            _ => text.push('_'),
        }
    }
    if !text.starts_with(|c: char| c.is_ascii_alphabetic()) {
        text.insert(0, 'o');
    }
    text
}

/// A variable of a law.
pub(crate) fn variable(name: &str) -> String {
    match name.strip_prefix('_') {
        Some(number) => format!("?any{number}"),
        None => format!("?{}", name.to_lowercase()),
    }
}

/// The conjunction of conditions or effects.
pub(crate) fn all_of(mut parts: Vec<String>) -> String {
    match parts.len() {
        1 => parts.remove(0),
        _ => format!("(and {})", parts.join(" ")),
    }
}

/// `(exists (variables) body)`, or only the body without variables.
pub(crate) fn quantified(word: &str, variables: &[String], body: String) -> String {
    if variables.is_empty() { body } else { format!("({word} ({}) {body})", variables.join(" ")) }
}

/// `(name a b)`.
pub(crate) fn spaced(name: &str, terms: &[String]) -> String {
    let mut text = format!("({name}");
    for term in terms {
        text.push(' ');
        text.push_str(term);
    }
    text + ")"
}

/// The text with a suffix on each variable, so that variables of different laws differ.
pub(crate) fn marked(text: &str, mark: &str) -> String {
    if mark.is_empty() {
        return text.to_string();
    }
    let mut marked = String::new();
    let mut in_variable = false;
    for c in text.chars() {
        let belongs = c.is_ascii_alphanumeric() || c == '_';
        if in_variable && !belongs {
            marked.push_str(mark);
        }
        in_variable = c == '?' || in_variable && belongs;
        marked.push(c);
    }
    if in_variable {
        marked.push_str(mark);
    }
    marked
}

/// The parameters `?x1`, … with their types.
pub(crate) fn parameters(sorts: &[String]) -> String {
    sorts.iter().enumerate().map(|(index, sort)| format!(" ?x{} - {sort}", index + 1)).collect()
}
