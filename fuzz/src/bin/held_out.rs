//! Commitments and revealed goals, and promises and secrets of seeds: two lines, one file each.
#![no_main]

use ramp_fuzz::{keeps, shows, target};
use ramp_report::held_out::{self, Commitments, Reveal};
use ramp_result::secret::{self, Kept, Promise, Secret};

fn check(bytes: &[u8]) {
    let (first, second) = match bytes.iter().position(|byte| *byte == b'\n') {
        Some(at) => (&bytes[..at], &bytes[at + 1..]),
        None => (bytes, bytes),
    };
    if let (Ok(promised), Ok(revealed)) =
        (serde_json::from_slice::<Commitments>(first), serde_json::from_slice::<Reveal>(second))
    {
        keeps(&promised);
        keeps(&revealed);
        if let Err(error) = held_out::verify(&promised, &revealed) {
            shows(error);
        }
    }
    if let (Ok(promised), Ok(revealed)) =
        (serde_json::from_slice::<Promise>(first), serde_json::from_slice::<Kept>(second))
    {
        match Secret::from_kept(&revealed) {
            Ok(secret) => assert_eq!(secret.kept().secret, revealed.secret.to_ascii_lowercase()),
            Err(error) => shows(error),
        }
        if let Err(error) = secret::verify(&promised, &revealed) {
            shows(error);
        }
    }
}

fn seeds() -> Vec<Vec<u8>> {
    let lines = |first, second| format!("{first}\n{second}").into_bytes();
    let (promised, revealed) = held_out::promise(&[("held-1".into(), [7; 32], "<a/>".into())]);
    let secret = Secret::new([7; 32]);
    vec![
        lines(serde_json::json!(promised), serde_json::json!(revealed)),
        lines(serde_json::json!(secret.promise()), serde_json::json!(secret.kept())),
    ]
}

target!(seeds(), check);
