//! Names: their syntax, and suggestions for misspelt ones.
//!
//! Names of goals and agents appear in file names, tables, pages and logic rules. So the syntax is
//! the same everywhere, and a name can never be a path, a formula, an option or several lines.

/// Length limit of a name, characters; it also keeps the search for the nearest name fast.
pub const MAX_NAME: usize = 64;

/// The syntax of a name, for a message.
pub const A_NAME: &str =
    "1 to 64 letters (a to z, A to Z), digits and `-_.+`, of which the first is a letter or a digit";

/// Whether this is a name ([`A_NAME`]).
///
/// ```
/// # use ramp_source::is_name;
/// assert!(is_name("hard-2_b.v1+c") && is_name("7"));
/// assert!(!is_name("") && !is_name("..") && !is_name("../x") && !is_name("-x") && !is_name("é"));
/// assert!(!is_name(&"x".repeat(65)));
/// ```
pub fn is_name(text: &str) -> bool {
    text.len() <= MAX_NAME
        && text.starts_with(|first: char| first.is_ascii_alphanumeric())
        && text.chars().all(may_stand)
}

/// A text, such as a file name, reduced to a name; `unnamed` if no character remains.
///
/// ```
/// # use ramp_source::to_name;
/// assert_eq!(to_name("my agent.py"), "myagent.py");
/// assert_eq!(to_name("../=x"), "x");
/// assert_eq!(to_name("–"), "unnamed");
/// ```
pub fn to_name(text: &str) -> String {
    let name: String = text
        .chars()
        .filter(|c| may_stand(*c))
        .skip_while(|c| !c.is_ascii_alphanumeric())
        .take(MAX_NAME)
        .collect();
    if name.is_empty() { "unnamed".to_string() } else { name }
}

/// Whether this character may be part of a name.
fn may_stand(c: char) -> bool {
    c.is_ascii_alphanumeric() || "-_.+".contains(c)
}

/// The most similar name among `names`, if it is similar enough to suggest.
///
/// ```
/// # use ramp_source::nearest;
/// assert_eq!(nearest("easy-33", ["easy-3", "hard-3"]), Some("easy-3"));
/// assert_eq!(nearest("table", ["easy-3", "hard-3"]), None);
/// ```
pub fn nearest<'a>(wanted: &str, names: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let allowed = 1 + wanted.chars().count().min(MAX_NAME) / 4;
    names
        .into_iter()
        .filter_map(|name| Some((edits(wanted, name)?, name)))
        .min_by_key(|(distance, _)| *distance)
        .filter(|(distance, name)| *distance <= allowed && *distance < name.chars().count())
        .map(|(_, name)| name)
}

/// Edit distance between `a` and `b` with insertions, deletions, substitutions and swaps of
/// neighbours, ignoring case; `None` when one of them is too long for a name.
fn edits(a: &str, b: &str) -> Option<usize> {
    if a.len() > MAX_NAME || b.len() > MAX_NAME {
        return None;
    }
    let fold = |text: &str| text.chars().flat_map(char::to_lowercase).collect::<Vec<char>>();
    let (a, b) = (fold(a), fold(b));
    let width = b.len() + 1;
    // Row i holds the distances from the first i characters of a to every prefix of b.
    let mut table = vec![0; (a.len() + 1) * width];
    for i in 0..=a.len() {
        for j in 0..=b.len() {
            table[i * width + j] = if i == 0 || j == 0 {
                i + j
            } else {
                let change = table[(i - 1) * width + j - 1] + usize::from(a[i - 1] != b[j - 1]);
                let drop = table[(i - 1) * width + j] + 1;
                let add = table[i * width + j - 1] + 1;
                let swapped = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
                let swap = if swapped { table[(i - 2) * width + j - 2] + 1 } else { usize::MAX };
                change.min(drop).min(add).min(swap)
            };
        }
    }
    table.last().copied()
}
