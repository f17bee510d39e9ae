//! Logs of episodes, as files.
#![no_main]

use std::path::Path;

use ramp_fuzz::{header, mcap_file, shows, target};
use ramp_log::calls::Encoder;
use ramp_log::{Limits, Log};
use ramp_result::testing::episode;

fn check(bytes: &[u8]) {
    match Log::from_bytes(Path::new("x.mcap"), bytes, &Limits::default()) {
        Ok(log) => log.calls().filter_map(Result::err).for_each(shows),
        Err(error) => shows(error),
    }
}

/// A log in two forms, and one of nothing but its head, which is short.
fn seeds() -> Vec<Vec<u8>> {
    let mut calls = Encoder::default();
    calls.read_parts();
    calls.answered(1);
    calls.state(2);
    let head = serde_json::json!(header()).to_string();
    let result = episode("easy-1", 1, &[3.0], 2).to_json();
    let messages: [(&str, &[u8]); 3] =
        [("/episode", head.as_bytes()), ("/calls", &calls.take()), ("/result", result.as_bytes())];
    vec![
        mcap_file(&messages, None),
        mcap_file(&messages, Some(mcap::Compression::Zstd)),
        mcap_file(&[("/episode", br#"{"schema": "ramp-log-2"}"#)], None),
    ]
}

target!(seeds(), check);
