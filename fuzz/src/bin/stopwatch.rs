//! Stopwatch logs of real robots.
#![no_main]

use ramp_fuzz::{GOALS, KIT, data, points, software, target};
use ramp_kit::source::SourceFile;
use ramp_real_run::stopwatch::{Log, Reader};
use ramp_result::collection::parse;

fn check(bytes: &[u8]) {
    let text = String::from_utf8_lossy(bytes);
    let file = SourceFile::new("log.csv", &text);
    match (Reader { file: &file, kit: &KIT, goals: &GOALS, software: &software() }).read() {
        // A report accepts every value from a log.
        Ok(Log::Episodes(results)) => {
            for result in results {
                let parsed = parse("it", result.to_json().as_bytes());
                assert!(matches!(parsed, Ok(Some(_))), "{parsed:?}");
            }
        }
        Ok(Log::Means(_)) => {}
        Err(error) => points(&error, &text),
    }
}

target!([data("examples/stopwatch.csv"), data("published/ramp-baseline.csv")], check);
