//! Domains of the action language.
#![no_main]

use ramp_action_language::{Domain, SourceFile};
use ramp_fuzz::{data_of, points, target};

fn check(bytes: &[u8]) {
    let text = String::from_utf8_lossy(bytes);
    match Domain::new(&SourceFile::new("it.al", &text), None) {
        Ok(domain) => assert!(domain.to_asp().contains("#program step(t).")),
        Err(error) => points(&error, &text),
    }
}

target!(data_of("domains", "al"), check);
