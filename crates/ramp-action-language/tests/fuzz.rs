//! Whatever a file holds, it is read or refused: nothing panics, nothing hangs.

// A helper may panic as its test may.
#![allow(clippy::unwrap_used)]

use ramp_action_language::{Domain, SourceFile};

/// A small generator of numbers; the same ones every time.
struct Dice(u64);

impl Dice {
    fn below(&mut self, limit: usize) -> usize {
        // The linear congruential generator of Knuth's MMIX.
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        usize::try_from(self.0 >> 33).unwrap() % limit.max(1)
    }
}

/// The text with some of its pieces dropped, doubled, swapped or replaced.
fn mangled(text: &str, dice: &mut Dice) -> String {
    let scraps = [
        "(",
        ")",
        ",",
        ".",
        "if",
        "-",
        "_",
        "\"",
        "%",
        "=",
        "{",
        "}",
        "+",
        "sort ",
        "X",
        "é",
        "99999999999999999999",
    ];
    let mut letters: Vec<String> = text.chars().map(String::from).collect();
    for _ in 0..=dice.below(4) {
        let at = dice.below(letters.len());
        match dice.below(4) {
            0 => {
                let end = (at + 1 + dice.below(30)).min(letters.len());
                letters.drain(at..end);
            }
            1 => letters.insert(at, scraps[dice.below(scraps.len())].to_string()),
            2 => letters[at] = scraps[dice.below(scraps.len())].to_string(),
            _ => {
                let piece = letters[at..(at + dice.below(60)).min(letters.len())].to_vec();
                let to = dice.below(letters.len());
                letters.splice(to..to, piece);
            }
        }
        if letters.is_empty() {
            break;
        }
    }
    letters.concat()
}

/// A domain of the project, as a text to spoil.
fn text(name: &str) -> String {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/domains");
    std::fs::read_to_string(folder.join(name)).unwrap()
}

#[test]
fn domains_are_read_or_refused() {
    let mut dice = Dice(1);
    let (coarse, fine) = (text("coarse.al"), text("fine.al"));
    let whole = Domain::new(&SourceFile::new("coarse.al", &coarse), None).unwrap();
    let mut outcomes = [0, 0];
    for _ in 0..1000 {
        let text = mangled(&coarse, &mut dice);
        match Domain::new(&SourceFile::new("coarse.al", &text), None) {
            Ok(domain) => {
                // What is accepted can also be written.
                assert!(domain.to_asp().contains("#program step(t)."));
                outcomes[0] += 1;
            }
            Err(error) => {
                assert!(format!("{error:#}").starts_with("coarse.al:"), "{error:#}");
                outcomes[1] += 1;
            }
        }
        let _ = Domain::new(&SourceFile::new("fine.al", &mangled(&fine, &mut dice)), Some(&whole));
    }
    assert!(outcomes.iter().all(|count| *count > 50), "{outcomes:?}");
}
