//! A small stroke font, so that a drawing looks the same everywhere: neither the SVG nor the PNG
//! made from it needs installed fonts.
//!
//! A glyph is a path in a grid with the baseline at 0, y down, capitals 7 high: `M x y`, `L x y`,
//! `C x1 y1 x2 y2 x y` and `A rx ry large sweep x y` as in SVG, absolute.

use std::fmt::Write;

/// Height of a capital in the grid.
const CAPITAL: f64 = 7.0;
/// Space between two glyphs in the grid.
const SPACING: f64 = 1.9;
/// Width of the strokes in the grid.
const STROKE: f64 = 0.85;

const ROUND: &str = "M3.8 -2.5 A1.9 2.5 0 0 0 -2.5 A1.9 2.5 0 0 3.8 -2.5 ";

/// A glyph: the number of [`ROUND`]s at its start (0 or 1), its width and the rest of its path.
const GLYPHS: &[(char, u8, f64, &str)] = &[
    (' ', 0, 1.6, ""),
    ('a', 1, 3.8, "M3.8 -5 L3.8 0"),
    ('b', 1, 3.8, "M0 -7.2 L0 0"),
    ('c', 0, 3.4, "M3.42 -4 A1.9 2.5 1 0 3.42 -1"),
    ('d', 1, 3.8, "M3.8 -7.2 L3.8 0"),
    ('e', 0, 3.8, "M0 -2.5 L3.8 -2.5 A1.9 2.5 0 0 0 -2.5 A1.9 2.5 0 0 3.42 -1"),
    ('f', 0, 2.4, "M2.6 -7.2 A1.6 1.6 0 0 1 -5.6 L1 0 M0 -5 L2.4 -5"),
    ('g', 1, 3.8, "M3.8 -5 L3.8 0.1 A1.9 1.9 0 1 0.3 1"),
    ('h', 0, 3.6, "M0 -7.2 L0 0 M0 -3 A1.8 2 0 1 3.6 -3 L3.6 0"),
    ('i', 0, 0.4, "M0.2 -5 L0.2 0 M0.2 -6.9 L0.2 -6.8"),
    ('j', 0, 1.2, "M1 -5 L1 0.5 A1.5 1.5 0 1 -0.5 2 M1 -6.9 L1 -6.8"),
    ('k', 0, 3.4, "M0 -7.2 L0 0 M3.2 -5 L0 -1.8 M1.2 -3 L3.4 0"),
    ('l', 0, 0.4, "M0.2 -7.2 L0.2 0"),
    ('m', 0, 6.0, "M0 -5 L0 0 M0 -3.2 A1.5 1.8 0 1 3 -3.2 L3 0 M3 -3.2 A1.5 1.8 0 1 6 -3.2 L6 0"),
    ('n', 0, 3.6, "M0 -5 L0 0 M0 -3 A1.8 2 0 1 3.6 -3 L3.6 0"),
    ('o', 1, 3.8, ""),
    ('p', 1, 3.8, "M0 -5 L0 2"),
    ('q', 1, 3.8, "M3.8 -5 L3.8 2"),
    ('r', 0, 2.1, "M0 -5 L0 0 M0 -2.9 A2.2 2.1 0 1 2.2 -5"),
    (
        's',
        0,
        3.3,
        "M3.1 -4.1 C2.8 -4.7 2.3 -5 1.6 -5 C0.7 -5 0.1 -4.5 0.1 -3.8 C0.1 -2 3.3 -3.1 3.3 -1.3 \
         C3.3 -0.5 2.6 0 1.7 0 C0.8 0 0.2 -0.4 0 -1",
    ),
    ('t', 0, 2.4, "M1 -6.6 L1 -1.4 A1.4 1.4 0 0 2.4 0 M0 -5 L2.4 -5"),
    ('u', 0, 3.6, "M0 -5 L0 -2 A1.8 2 0 0 3.6 -2 M3.6 -5 L3.6 0"),
    ('v', 0, 3.6, "M0 -5 L1.8 0 L3.6 -5"),
    ('w', 0, 5.2, "M0 -5 L1.3 0 L2.6 -5 L3.9 0 L5.2 -5"),
    ('x', 0, 3.4, "M0 -5 L3.4 0 M3.4 -5 L0 0"),
    ('y', 0, 3.8, "M0 -5 L1.9 0 M3.8 -5 L1.2 2"),
    ('z', 0, 3.4, "M0 -5 L3.4 -5 L0 0 L3.4 0"),
    ('A', 0, 4.8, "M0 0 L2.4 -7 L4.8 0 M0.8 -2.3 L4 -2.3"),
    (
        'B',
        0,
        4.3,
        "M0 0 L0 -7 L2.2 -7 C4.3 -7 4.3 -3.7 2.2 -3.7 L0 -3.7 M2.2 -3.7 C4.9 -3.7 4.9 0 2.3 0 L0 0",
    ),
    ('C', 0, 4.4, "M4.32 -5.6 A2.4 3.5 1 0 4.32 -1.4"),
    ('D', 0, 4.6, "M0 0 L0 -7 L1.6 -7 C5.6 -7 5.6 0 1.6 0 L0 0"),
    ('E', 0, 3.8, "M3.8 -7 L0 -7 L0 0 L3.8 0 M0 -3.7 L3.2 -3.7"),
    ('F', 0, 3.8, "M3.8 -7 L0 -7 L0 0 M0 -3.7 L3.2 -3.7"),
    ('G', 0, 4.7, "M4.32 -5.6 A2.4 3.5 1 0 4.7 -2 L4.7 -3.3 L2.8 -3.3"),
    ('H', 0, 4.4, "M0 0 L0 -7 M4.4 0 L4.4 -7 M0 -3.7 L4.4 -3.7"),
    ('I', 0, 0.4, "M0.2 0 L0.2 -7"),
    ('J', 0, 2.8, "M2.8 -7 L2.8 -1.6 A1.4 1.6 0 1 0 -1.4"),
    ('K', 0, 4.2, "M0 0 L0 -7 M4 -7 L0 -2.6 M1.4 -4.1 L4.2 0"),
    ('L', 0, 3.4, "M0 -7 L0 0 L3.4 0"),
    ('M', 0, 5.4, "M0 0 L0 -7 L2.7 -2 L5.4 -7 L5.4 0"),
    ('N', 0, 4.4, "M0 0 L0 -7 L4.4 0 L4.4 -7"),
    ('O', 0, 4.8, "M4.8 -3.5 A2.4 3.5 0 0 0 -3.5 A2.4 3.5 0 0 4.8 -3.5"),
    ('P', 0, 4.2, "M0 0 L0 -7 L2.2 -7 C4.8 -7 4.8 -3.2 2.2 -3.2 L0 -3.2"),
    ('Q', 0, 4.8, "M4.8 -3.5 A2.4 3.5 0 0 0 -3.5 A2.4 3.5 0 0 4.8 -3.5 M3 -1.8 L4.8 0.3"),
    ('R', 0, 4.2, "M0 0 L0 -7 L2.2 -7 C4.8 -7 4.8 -3.4 2.2 -3.4 L0 -3.4 M2.2 -3.4 L4.2 0"),
    (
        'S',
        0,
        4.0,
        "M3.8 -5.8 C3.4 -6.6 2.8 -7 2 -7 C0.9 -7 0.1 -6.3 0.1 -5.3 C0.1 -2.8 4 -4.4 4 -1.9 \
         C4 -0.7 3.1 0 2 0 C1 0 0.3 -0.5 0 -1.3",
    ),
    ('T', 0, 4.4, "M0 -7 L4.4 -7 M2.2 -7 L2.2 0"),
    ('U', 0, 4.4, "M0 -7 L0 -2.4 A2.2 2.4 0 0 4.4 -2.4 L4.4 -7"),
    ('V', 0, 4.6, "M0 -7 L2.3 0 L4.6 -7"),
    ('W', 0, 6.4, "M0 -7 L1.6 0 L3.2 -7 L4.8 0 L6.4 -7"),
    ('X', 0, 4.4, "M0 -7 L4.4 0 M4.4 -7 L0 0"),
    ('Y', 0, 4.4, "M0 -7 L2.2 -3.6 L4.4 -7 M2.2 -3.6 L2.2 0"),
    ('Z', 0, 4.2, "M0 -7 L4.2 -7 L0 0 L4.2 0"),
    ('0', 0, 4.0, "M4 -3.5 A2 3.5 0 0 0 -3.5 A2 3.5 0 0 4 -3.5"),
    ('1', 0, 2.2, "M0.2 -5.6 L1.7 -7 L1.7 0"),
    ('2', 0, 4.0, "M0.1 -5.1 A1.9 1.9 0 1 3.9 -5.1 C3.9 -3.4 1.2 -2.2 0 0 L4 0"),
    (
        '3',
        0,
        4.0,
        "M0.3 -5.9 C0.6 -6.6 1.2 -7 2 -7 C3 -7 3.7 -6.3 3.7 -5.4 C3.7 -4.4 3 -3.8 2 -3.8 L1.5 -3.8 \
         M2 -3.8 C3.1 -3.8 4 -3.1 4 -2 C4 -0.8 3.1 0 2 0 C1 0 0.3 -0.4 0 -1.2",
    ),
    ('4', 0, 4.0, "M2.9 0 L2.9 -7 L0 -2.1 L4 -2.1"),
    (
        '5',
        0,
        4.0,
        "M3.6 -7 L0.7 -7 L0.4 -4 C0.8 -4.4 1.4 -4.6 2 -4.6 C3.2 -4.6 4 -3.6 4 -2.3 \
         C4 -0.9 3.1 0 1.9 0 C1 0 0.3 -0.5 0 -1.2",
    ),
    (
        '6',
        0,
        4.0,
        "M3.5 -6.2 C3.1 -6.8 2.6 -7 2 -7 C0.6 -7 0 -5.2 0 -3 L0 -2.2 M4 -2.2 A2 2.2 0 0 0 -2.2 \
         A2 2.2 0 0 4 -2.2",
    ),
    ('7', 0, 4.0, "M0 -7 L4 -7 L1.4 0"),
    (
        '8',
        0,
        4.0,
        "M3.7 -5.3 A1.7 1.7 0 0 0.3 -5.3 A1.7 1.7 0 0 3.7 -5.3 M4 -1.8 A2 1.8 0 0 0 -1.8 A2 1.8 0 0 4 -1.8",
    ),
    (
        '9',
        0,
        4.0,
        "M0.5 -0.8 C0.9 -0.2 1.4 0 2 0 C3.4 0 4 -1.8 4 -4 L4 -4.8 A2 2.2 0 0 0 -4.8 A2 2.2 0 0 4 -4.8",
    ),
    ('-', 0, 2.4, "M0 -2.7 L2.4 -2.7"),
    ('−', 0, 3.6, "M0 -3 L3.6 -3"),
    ('–', 0, 3.6, "M0 -2.7 L3.6 -2.7"),
    ('_', 0, 3.6, "M0 1 L3.6 1"),
    ('+', 0, 3.6, "M0 -3 L3.6 -3 M1.8 -4.8 L1.8 -1.2"),
    ('=', 0, 3.6, "M0 -3.8 L3.6 -3.8 M0 -2 L3.6 -2"),
    ('.', 0, 0.4, "M0.2 -0.1 L0.2 0"),
    (',', 0, 0.6, "M0.5 -0.2 L0.1 1.2"),
    (';', 0, 0.6, "M0.5 -0.2 L0.1 1.2 M0.4 -4 L0.4 -3.9"),
    ('\'', 0, 0.4, "M0.2 -7 L0.2 -5.4"),
    (
        '%',
        0,
        5.4,
        "M4.6 -7 L0.8 0 M2.2 -5.6 A1.1 1.4 0 0 0 -5.6 A1.1 1.4 0 0 2.2 -5.6 M5.4 -1.4 A1.1 1.4 0 0 3.2 -1.4 \
         A1.1 1.4 0 0 5.4 -1.4",
    ),
    (':', 0, 0.4, "M0.2 -0.1 L0.2 0 M0.2 -4 L0.2 -3.9"),
    ('/', 0, 2.8, "M0 0.6 L2.8 -7.4"),
    ('(', 0, 1.5, "M1.5 -7.6 A6.5 6.5 0 0 1.5 1.4"),
    (')', 0, 1.5, "M0 -7.6 A6.5 6.5 0 1 0 1.4"),
    ('°', 0, 2.0, "M2 -6.2 A1 1 0 0 0 -6.2 A1 1 0 0 2 -6.2"),
];

/// The glyph for unknown characters.
const UNKNOWN: (u8, f64, &str) = (0, 3.4, "M0 0 L0 -7 L3.4 -7 L3.4 0 L0 0");

/// Meaning of a text's x coordinate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Align {
    /// Its left end.
    Left,
    /// Its middle.
    Middle,
    /// Its right end.
    Right,
}

fn glyph(character: char) -> (u8, f64, &'static str) {
    let found = GLYPHS.iter().find(|(known, ..)| *known == character);
    found.map_or(UNKNOWN, |&(_, round, width, path)| (round, width, path))
}

/// The width of a text whose capitals are `height` high.
pub fn width(text: &str, height: f64) -> f64 {
    let glyphs: f64 = text.chars().map(|character| glyph(character).1 + SPACING).sum();
    (glyphs - SPACING).max(0.0) * height / CAPITAL
}

/// The height of the capitals, at most `height`, so that a text is at most `room` wide.
pub fn fit(text: &str, height: f64, room: f64) -> f64 {
    height * (room / width(text, height).max(1e-9)).min(1.0)
}

/// Adds a text to an SVG: one path, with the text itself as its label. Its baseline is at `y`, its
/// capitals are `height` high.
pub fn text(svg: &mut String, at: [f64; 2], align: Align, height: f64, colour: &str, text: &str) {
    let mut path = String::new();
    let width = draw(at, align, height, text, &mut |command, numbers| {
        path.push(command);
        for (position, number) in numbers.iter().enumerate() {
            // Writing to a string does not fail. An arc's angle, which ours do not have, comes
            // before its flags.
            let _ = match (command, position) {
                ('A', 2) => write!(path, "0 {number} "),
                ('A', 3) => write!(path, "{number} "),
                _ => write!(path, "{number:.2} "),
            };
        }
    });
    let _ = writeln!(
        svg,
        r#"<path aria-label="{}" d="{}" fill="none" stroke="{colour}" stroke-width="{width:.2}" stroke-linecap="round" stroke-linejoin="round"/>"#,
        escape(text),
        path.trim_end(),
    );
}

/// Passes the strokes of a text, placed as in [`text`], to `to`: a command and its numbers, as in
/// the glyphs. Returns the width of the strokes.
pub fn draw(at: [f64; 2], align: Align, height: f64, text: &str, to: &mut dyn FnMut(char, &[f64])) -> f64 {
    let scale = height / CAPITAL;
    let mut left = match align {
        Align::Left => at[0],
        Align::Middle => at[0] - width(text, height) / 2.0,
        Align::Right => at[0] - width(text, height),
    };
    for character in text.chars() {
        let (round, advance, strokes) = glyph(character);
        if round > 0 {
            place(ROUND, [left, at[1]], scale, to);
        }
        place(strokes, [left, at[1]], scale, to);
        left += (advance + SPACING) * scale;
    }
    STROKE * scale
}

/// Passes a glyph's path, scaled and moved, to `to`.
fn place(strokes: &str, at: [f64; 2], scale: f64, to: &mut dyn FnMut(char, &[f64])) {
    let mut command = ' ';
    let mut numbers: Vec<f64> = Vec::new();
    for word in strokes.split_whitespace() {
        let number = match word.strip_prefix(|c: char| c.is_ascii_uppercase()) {
            Some(rest) => {
                if !numbers.is_empty() {
                    to(command, &numbers);
                }
                numbers.clear();
                command = word.chars().next().unwrap_or(' ');
                rest
            }
            None => word,
        };
        let value: f64 = number.parse().unwrap_or_default();
        // An arc has two radii and two flags before its end point; everything else is points.
        numbers.push(match (command, numbers.len()) {
            ('A', 0 | 1) => value * scale,
            ('A', 2 | 3) => value,
            (_, position) => value * scale + at[position % 2],
        });
    }
    if !numbers.is_empty() {
        to(command, &numbers);
    }
}

/// Text escaped for an attribute.
pub fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_glyph_is_well_formed() {
        let takes = |command: char| match command {
            'M' | 'L' => 2,
            'C' => 6,
            'A' => 6,
            other => panic!("{other}"),
        };
        for (character, _, _, path) in GLYPHS {
            let mut expected = 0;
            for word in path.split_whitespace() {
                let mut number = word;
                if word.starts_with(|c: char| c.is_ascii_uppercase()) {
                    assert_eq!(expected, 0, "{character}: {path}");
                    expected = takes(word.chars().next().unwrap());
                    number = &word[1..];
                }
                number.parse::<f64>().unwrap_or_else(|_| panic!("{character}: {number}"));
                assert!(expected > 0, "{character}: {path}");
                expected -= 1;
            }
            assert_eq!(expected, 0, "{character}: {path}");
        }
    }

    #[test]
    fn covers_plain_text() {
        for character in ('a'..='z').chain('A'..='Z').chain('0'..='9') {
            assert!(GLYPHS.iter().any(|(known, ..)| *known == character), "{character}");
        }
    }
}
