//! JSON messages of logs: the first line is the message on `/episode`, the second the one on `/result`.
#![no_main]

use std::path::Path;

use ramp_fuzz::{header, keeps, mcap_file, shows, target};
use ramp_log::{Limits, Log};
use ramp_result::testing::episode;

fn check(bytes: &[u8]) {
    let messages: Vec<(&str, &[u8])> =
        ["/episode", "/result"].into_iter().zip(bytes.split(|byte| *byte == b'\n')).collect();
    match Log::from_bytes(Path::new("x.mcap"), &mcap_file(&messages, None), &Limits::default()) {
        Ok(log) => {
            keeps(&log.header);
            keeps(&log.result);
        }
        Err(error) => shows(error),
    }
}

/// A head with files that are short, and a result.
fn seed() -> Vec<u8> {
    let mut head = header();
    (head.kit.xml, head.arm.json, head.goal.xml) = Default::default();
    (head.kit.sha256, head.arm.sha256) = (ramp_result::sha256(b""), ramp_result::sha256(b""));
    let result = serde_json::json!(episode("easy-1", 1, &[3.0], 2));
    format!("{}\n{result}", serde_json::json!(head)).into_bytes()
}

target!([seed()], check);
