//! Damaged texts, the same ones in each run.

/// A small generator of pseudo-random numbers.
pub struct Dice(pub u64);

impl Dice {
    /// A number from 0 to `limit` − 1.
    pub fn below(&mut self, limit: usize) -> usize {
        // The linear congruential generator of Knuth's MMIX.
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        usize::try_from(self.0 >> 33).unwrap() % limit.max(1)
    }
}

/// A copy of the text with some of its pieces dropped, doubled, swapped or replaced.
pub fn mangled(text: &str, dice: &mut Dice) -> String {
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
