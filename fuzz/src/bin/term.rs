//! Terms of the rules, as histories have them.
#![no_main]

use ramp_action_language::Term;
use ramp_fuzz::target;

fn check(bytes: &[u8]) {
    if let Some(term) = Term::read(&String::from_utf8_lossy(bytes)) {
        assert_eq!(Term::read(&term.to_string()).as_ref(), Some(&term), "{term}");
        let _ = (term.quoted(), term.texts().len());
    }
}

target!(
    ["in_hand(beam(\"b4\"))", "-at(1,(2,-3),c)", "#sup", "move(input)"].map(|text| text.as_bytes().to_vec()),
    check
);
