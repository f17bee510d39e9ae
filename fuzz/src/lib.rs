//! Common parts of the fuzz targets: seeds, the project's own data, files made of mutated parts, and the
//! invariants of errors.
//!
//! Each target in `src/bin` hands mutated bytes to one public reader. A panic, an assertion that fails, too
//! much memory and too much time are findings. `tools/fuzz` builds and runs all of them.

use std::path::{Path, PathBuf};
use std::sync::LazyLock;

pub use libfuzzer_sys;
use ramp_assembly::Assembly;
use ramp_kit::Kit;
use ramp_kit::source::{Fault, Problem};
use ramp_log::header::{ArmText, GoalText, KitText, StartText, WorldText};
use ramp_log::{CALLS, Header};
use ramp_result::episode::{RULES, Software};
use ramp_source::is_text;

/// The longest text of an error, characters.
const LONGEST_ERROR: usize = 4000;
/// The longest error with the line that it points at, bytes.
const LONGEST_REPORT: usize = 20_000;

/// A target: its seeds, and what is done with an input. The seeds go to the folder that `RAMP_FUZZ_SEEDS`
/// names.
#[macro_export]
macro_rules! target {
    ($seeds:expr, $check:expr) => {
        $crate::libfuzzer_sys::fuzz_target!(init: $crate::write_seeds(&$seeds), |bytes: &[u8]| {
            $check(bytes)
        });
    };
}

/// Writes the seeds of a target to the folder that `RAMP_FUZZ_SEEDS` names, if it names one.
pub fn write_seeds(seeds: &[Vec<u8>]) {
    let Some(folder) = std::env::var_os("RAMP_FUZZ_SEEDS").map(PathBuf::from) else { return };
    for (number, seed) in seeds.iter().enumerate() {
        let path = folder.join(format!("{number:03}"));
        std::fs::write(&path, seed).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    }
}

fn folder(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../data").join(name)
}

/// A file of the project's data.
pub fn data(name: &str) -> Vec<u8> {
    let path = folder(name);
    std::fs::read(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// The same as a text.
pub fn data_text(name: &str) -> String {
    String::from_utf8_lossy(&data(name)).into_owned()
}

/// All files of a folder of the project's data.
pub fn data_of(name: &str, ending: &str) -> Vec<Vec<u8>> {
    let entries = std::fs::read_dir(folder(name)).unwrap_or_else(|error| panic!("{name}: {error}"));
    let mut paths: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).collect();
    paths.retain(|path| path.extension().is_some_and(|it| it == ending));
    paths.sort();
    paths.iter().filter_map(|path| std::fs::read(path).ok()).collect()
}

/// The kit of the benchmark.
pub static KIT: LazyLock<Kit> =
    LazyLock::new(|| ramp_kit::read_kit(&folder("kit.xml")).unwrap_or_else(|error| panic!("{error:#}")));

/// One of its goals.
pub static GOALS: LazyLock<Vec<Assembly>> = LazyLock::new(|| {
    let goal = ramp_assembly::read_goal(&folder("goals/easy-1.xml"), &KIT);
    vec![goal.unwrap_or_else(|error| panic!("{error:#}"))]
});

/// The provenance field of results.
pub fn software() -> Software {
    Software { version: "1".into(), commit: "fuzz".into() }
}

/// The head of a log whose files are those of the project.
pub fn header() -> Header {
    let (kit, arm) = (data_text("kit.xml"), data_text("arms/panda.json"));
    let (world, start) = (data_text("worlds/ideal.toml"), data_text("starts/sheet.toml"));
    Header {
        schema: ramp_log::SCHEMA.into(),
        rules: RULES.into(),
        goal: GoalText { name: "easy-1".into(), xml: data_text("goals/easy-1.xml") },
        kit: KitText { sha256: ramp_result::sha256(kit.as_bytes()), xml: kit },
        arm: ArmText { sha256: ramp_result::sha256(arm.as_bytes()), json: arm },
        world: WorldText { name: "ideal".into(), sha256: ramp_result::sha256(world.as_bytes()), toml: world },
        start: StartText { name: "sheet".into(), sha256: ramp_result::sha256(start.as_bytes()), toml: start },
        track: "state".into(),
        seed: 1,
        secret: None,
        repeat: 1,
        fault: None,
        software: software(),
    }
}

/// An MCAP file of these messages, each with its topic, without checksums: what is mutated gets as far as the
/// readers.
pub fn mcap_file(messages: &[(&str, &[u8])], compression: Option<mcap::Compression>) -> Vec<u8> {
    write_mcap(messages, compression).unwrap_or_else(|error| panic!("{error}"))
}

fn write_mcap(
    messages: &[(&str, &[u8])],
    compression: Option<mcap::Compression>,
) -> Result<Vec<u8>, mcap::McapError> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    let mut file = mcap::WriteOptions::new()
        .compression(compression)
        .compression_threads(0)
        .calculate_chunk_crcs(false)
        .calculate_data_section_crc(false)
        .calculate_summary_section_crc(false)
        .create(&mut bytes)?;
    let mut channels: Vec<(&str, u16)> = Vec::new();
    for (topic, data) in messages {
        let channel_id = match channels.iter().find(|(known, _)| known == topic) {
            Some((_, id)) => *id,
            None => {
                let encoding = if *topic == "/calls" { CALLS } else { "json" };
                let id = file.add_channel(0, topic, encoding, &Default::default())?;
                channels.push((topic, id));
                id
            }
        };
        let header = mcap::records::MessageHeader { channel_id, sequence: 0, log_time: 0, publish_time: 0 };
        file.write_to_known_channel(&header, data)?;
    }
    file.finish()?;
    drop(file);
    Ok(bytes.into_inner())
}

/// The text of an error can be shown: it is not long, and has no character that does not show itself.
pub fn shows(error: impl std::fmt::Display) {
    let text = error.to_string();
    assert!(
        !text.is_empty() && is_text(&text, LONGEST_ERROR),
        "an error of {} characters: {text:?}",
        text.len()
    );
}

/// An error in a file stands inside it, and can be shown.
pub fn points<P: Problem>(fault: &Fault<P>, text: &str) {
    shows(fault);
    let (line, column) = fault.place().line_column();
    assert!(line >= 1 && column >= 1 && line <= text.lines().count() + 1, "{fault:#}");
    let mut out = String::new();
    assert!(miette::NarratableReportHandler::new().render_report(&mut out, fault).is_ok());
    // Non-printing characters are escaped, with up to eight characters in place of one.
    assert!(out.len() < LONGEST_REPORT + 8 * text.len(), "a report of {} bytes", out.len());
    assert!(!out.contains('\u{1b}'), "{out:?}");
}

/// A written value reads back unchanged.
pub fn keeps<T>(value: &T)
where
    T: serde::Serialize + serde::de::DeserializeOwned + PartialEq + std::fmt::Debug,
{
    let text = serde_json::to_string(value).unwrap_or_else(|error| panic!("{error}"));
    let again: T = serde_json::from_str(&text).unwrap_or_else(|error| panic!("{error} in {text}"));
    assert_eq!(again, *value);
}
