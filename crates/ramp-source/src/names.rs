//! Names: how long they may be, which one was meant, and how they stand in a message.

/// The longest name, in bytes; also keeps the search for the nearest name fast.
pub const MAX_NAME: usize = 64;

/// The name among `names` that is most like `wanted`, when one is like enough to be worth suggesting.
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

/// How many characters must be added, dropped, changed or swapped with their neighbour to turn `a` into `b`, not
/// counting case; `None` when one of them is too long to be a name.
fn edits(a: &str, b: &str) -> Option<usize> {
    if a.len() > MAX_NAME || b.len() > MAX_NAME {
        return None;
    }
    let fold = |text: &str| text.chars().flat_map(char::to_lowercase).collect::<Vec<char>>();
    let (a, b) = (fold(a), fold(b));
    let width = b.len() + 1;
    // Row i holds the distances from the first i characters of a to every beginning of b.
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

/// Text from a file as it may stand in a message: at most [`MAX_NAME`] characters, none of them a control
/// character.
pub fn shorten(text: &str) -> String {
    let mut short: String =
        text.chars().take(MAX_NAME).map(|c| if c.is_control() { ' ' } else { c }).collect();
    if text.chars().count() > MAX_NAME {
        short.push('…');
    }
    short
}
