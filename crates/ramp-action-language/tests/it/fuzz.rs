//! Any file is read or refused, without a panic and without a hang.

use ramp_action_language::{Domain, SourceFile};
use ramp_testing::mangle::{Dice, mangled};

/// A domain of the project, as a text to corrupt.
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
                // An accepted domain can also be written.
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
