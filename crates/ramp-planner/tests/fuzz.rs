//! Whatever a plan or an observation from outside says, it is taken or refused: nothing panics, nothing hangs.

// A helper may panic as its test may.
#![allow(clippy::unwrap_used)]

mod common;

use common::{domains, goal, kit};
use ramp_planner::{History, Record, State, diagnose, pddl_plan};

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

#[test]
fn plans_and_observations_are_read_or_refused() {
    let mut dice = Dice(2);
    let assembly = goal("easy-1");
    let plan = "(pick_up b4)\n(move intermediate)\n(move assembly)\n(assemble b4)\n";
    let observation = "-in_hand(beam(\"b4\"))";
    for _ in 0..60 {
        assert!(
            pddl_plan(&assembly, kit(), &State::default(), domains(), &mangled(plan, &mut dice)).is_err()
        );
        let records = vec![Record::Saw(mangled(observation, &mut dice))];
        let _ = diagnose(&assembly, kit(), domains(), &History { records, ..History::default() });
    }
}
