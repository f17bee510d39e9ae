//! Result files of every schema.
#![no_main]

use ramp_fuzz::{GOALS, KIT, data_text, keeps, shows, software, target};
use ramp_kit::source::SourceFile;
use ramp_real_run::stopwatch::{Log, Reader};
use ramp_result::collection::{Parsed, parse};
use ramp_result::testing::episode;

fn check(bytes: &[u8]) {
    match parse("it.json", bytes) {
        Ok(Some(Parsed::Episode(it))) => keeps(&*it),
        Ok(Some(Parsed::Published(it))) => keeps(&it),
        Ok(Some(Parsed::Plan(it))) => keeps(&it),
        Ok(Some(Parsed::Perception(it))) => keeps(&it),
        Ok(Some(Parsed::Trial(it))) => keeps(&*it),
        Ok(None) => {}
        Err(error) => shows(error),
    }
}

/// One of each schema that can be made here.
fn seeds() -> Vec<Vec<u8>> {
    let mut seeds = vec![episode("easy-1", 1, &[3.0, 4.0], 2).to_json().into_bytes()];
    for name in ["examples/stopwatch.csv", "published/ramp-baseline.csv"] {
        let file = SourceFile::new("log.csv", &data_text(name));
        match (Reader { file: &file, kit: &KIT, goals: &GOALS, software: &software() }).read() {
            Ok(Log::Episodes(episodes)) => seeds.extend(episodes.iter().map(|it| it.to_json().into_bytes())),
            Ok(Log::Means(means)) => seeds.extend(means.iter().flat_map(serde_json::to_vec)),
            Err(error) => panic!("{error:#}"),
        }
    }
    let texts = [
        r#"{"schema": "ramp-plan-1", "goal": "easy-1", "class": "easy", "planner": "p", "software": {"version": "1", "commit": "c"}, "accepted": true, "refused": null, "coarse": 3, "seconds": 0.5}"#,
        r#"{"schema": "ramp-perception-1", "detector": "d"}"#,
        r#"{"schema": "ramp-trial-1", "skill": "s"}"#,
    ];
    seeds.extend(texts.map(|text| text.as_bytes().to_vec()));
    seeds
}

target!(seeds(), check);
