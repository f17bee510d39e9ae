//! Whatever somebody does to a result, a stopwatch log or a reveal, reading it ends: with something that is
//! sound, or with one error. For hours of it:
//! `RAMP_FUZZ_SECONDS=3600 cargo test --release -p ramp-report --test it fuzz -- --ignored`.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use ramp_assembly::Assembly;
use ramp_kit::Kit;
use ramp_kit::source::SourceFile;
use ramp_real_run::stopwatch::{Log, Reader};
use ramp_report::held_out::{Commitments, Reveal, promise, verify};
use ramp_report::{Report, page, paper, table};
use ramp_result::collection::{Collection, Entrant, Parsed, ResultFile, parse};
use ramp_result::episode::Software;
use ramp_robot::random::Stream;

fn data(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data").join(name)
}

/// The mutated texts, and the data against which they are read.
struct Corpus {
    kit: Kit,
    goals: Vec<Assembly>,
    stopwatch: Vec<String>,
    results: Vec<String>,
    held_out: [String; 2],
}

impl Corpus {
    fn new() -> Corpus {
        let kit = ramp_kit::read_kit(&data("kit.xml")).unwrap();
        let goals = vec![ramp_assembly::read_goal(&data("goals/easy-1.xml"), &kit).unwrap()];
        let stopwatch = ["examples/stopwatch.csv", "published/ramp-baseline.csv"]
            .map(|name| std::fs::read_to_string(data(name)).unwrap())
            .to_vec();
        let (promised, revealed) = promise(&[("held-1".into(), [7; 32], "<a/>".into())]);
        let held_out = [serde_json::to_string(&promised).unwrap(), serde_json::to_string(&revealed).unwrap()];
        let mut corpus = Corpus { kit, goals, stopwatch, results: Vec::new(), held_out };
        for text in corpus.stopwatch.clone() {
            match corpus.log(&text).unwrap() {
                Log::Episodes(results) => {
                    for mut result in results {
                        corpus.results.push(result.to_json());
                        // As if it came from the twin.
                        result.real = None;
                        let physics = serde_json::json!({
                            "deepest_penetration": 0.0, "largest_force": 1.0, "state": "0123456789abcdef"
                        });
                        result.physics = serde_json::from_value(physics).unwrap();
                        corpus.results.push(result.to_json());
                    }
                }
                Log::Means(means) => corpus.results.push(serde_json::to_string_pretty(&means[0]).unwrap()),
            }
        }
        assert_eq!(corpus.results.len(), 5);
        corpus
    }

    fn log(&self, text: &str) -> Option<Log> {
        let software = Software { version: "test".into(), commit: "test".into() };
        let file = SourceFile::new("log.csv", text);
        match (Reader { file: &file, kit: &self.kit, goals: &self.goals, software: &software }).read() {
            Ok(log) => Some(log),
            Err(fault) => {
                let (line, column) = fault.place().line_column();
                assert!(line >= 1 && column >= 1 && line <= text.lines().count() + 1, "{fault:#}");
                let mut out = String::new();
                let _ = miette::NarratableReportHandler::new().render_report(&mut out, &fault);
                assert!(out.len() < 20_000, "{}", out.len());
                None
            }
        }
    }
}

fn below(stream: &mut Stream, count: usize) -> usize {
    ((stream.uniform() * count as f64) as usize).min(count.saturating_sub(1))
}

/// Texts that are likely to confuse a parser.
const MORSELS: [&str; 24] = [
    "\"",
    ",",
    "\n",
    "{",
    "}",
    "[",
    "]",
    ":",
    "-",
    "1e999",
    "-1",
    "NaN",
    "null",
    "\u{0}",
    "é",
    "\u{feff}",
    "9999999999999999999999",
    "1e308",
    "0",
    "0.5",
    "true",
    "\\u0000",
    "\r",
    "#",
];

/// Some changes at random positions: bytes changed, cut out, doubled, exchanged, morsels inserted,
/// numbers changed.
fn mutate(text: &str, stream: &mut Stream) -> Vec<u8> {
    let mut bytes = text.as_bytes().to_vec();
    for _ in 0..=below(stream, 4) {
        if bytes.is_empty() {
            break;
        }
        let at = below(stream, bytes.len());
        let end = (at + 1 + below(stream, 40)).min(bytes.len());
        match below(stream, 7) {
            0 => bytes[at] = below(stream, 256) as u8,
            1 => drop(bytes.drain(at..end)),
            2 => {
                let piece = bytes[at..end].to_vec();
                let to = below(stream, bytes.len());
                bytes.splice(to..to, piece);
            }
            3 => {
                let morsel = MORSELS[below(stream, MORSELS.len())];
                bytes.splice(at..at, morsel.bytes());
            }
            4 => {
                // A digit is replaced: most of these files stay valid.
                let digits: Vec<usize> =
                    (0..bytes.len()).filter(|index| bytes[*index].is_ascii_digit()).collect();
                if !digits.is_empty() {
                    bytes[digits[below(stream, digits.len())]] = b'0' + below(stream, 10) as u8;
                }
            }
            5 => {
                // A whole line is moved.
                let text = String::from_utf8_lossy(&bytes).into_owned();
                let mut lines: Vec<&str> = text.lines().collect();
                let (from, to) = (below(stream, lines.len()), below(stream, lines.len()));
                lines.swap(from, to);
                bytes = lines.join("\n").into_bytes();
            }
            _ => bytes.truncate(at),
        }
    }
    bytes
}

/// Reads one mutation of each kind; returns how many were still valid.
fn once(corpus: &Corpus, stream: &mut Stream) -> usize {
    let mut sound = 0;
    let text = &corpus.stopwatch[below(stream, corpus.stopwatch.len())];
    let bytes = mutate(text, stream);
    if let Some(Log::Episodes(results)) = corpus.log(&String::from_utf8_lossy(&bytes)) {
        sound += 1;
        for result in results {
            // The report accepts the result of a log.
            assert!(parse("it", result.to_json().as_bytes()).unwrap().is_some());
        }
    }
    let text = &corpus.results[below(stream, corpus.results.len())];
    match parse("it.json", &mutate(text, stream)) {
        Ok(Some(Parsed::Episode(result))) => {
            sound += 1;
            show(*result);
        }
        Ok(_) => {}
        Err(error) => assert!(error.to_string().len() < 2000, "{error}"),
    }
    let [promised, revealed] = &corpus.held_out;
    let reveal: Result<Reveal, _> = serde_json::from_slice(&mutate(revealed, stream));
    let promise: Commitments = serde_json::from_str(promised).unwrap();
    if let Ok(reveal) = reveal
        && verify(&promise, &reveal).is_ok()
    {
        sound += 1;
        assert_eq!(reveal.goals[0].xml, "<a/>");
    }
    sound
}

/// A valid result can be reported completely.
fn show(result: ramp_result::EpisodeResult) {
    let json = result.to_json();
    let file = tempfile::NamedTempFile::with_suffix(".json").unwrap();
    std::fs::write(file.path(), json).unwrap();
    let folder = tempfile::tempdir().unwrap();
    std::fs::copy(file.path(), folder.path().join("it.json")).unwrap();
    let collection = ramp_result::collection::collect(&[folder.path().to_path_buf()]).unwrap();
    let _: (&Vec<Entrant>, &[ResultFile]) = (&collection.entrants, &collection.entrants[0].files);
    let report = Report::new(Collection { notes: Vec::new(), ..collection });
    assert!(page::html(&report).ends_with("</html>"));
    assert!(paper::latex(&report).ends_with("\\end{tabular}\n"));
    assert!(table::tables(&report).iter().all(|table| !table.text.is_empty()));
    for figure in report.figures() {
        roxmltree::Document::parse(&figure.text).unwrap();
    }
}

#[test]
fn three_thousand_changed_files_are_read_or_refused() {
    let corpus = Corpus::new();
    let mut stream = Stream::new(1, "mutations of results");
    let sound: usize = (0..3000).map(|_| once(&corpus, &mut stream)).sum();
    // If every mutation were invalid, code after reading would not be tested.
    assert!(sound > 100, "{sound}");
}

#[test]
#[ignore = "runs as long as RAMP_FUZZ_SECONDS says, 60 without it"]
fn for_as_long_as_is_wanted() {
    let seconds = std::env::var("RAMP_FUZZ_SECONDS").ok().and_then(|text| text.parse().ok()).unwrap_or(60);
    let seed = std::env::var("RAMP_FUZZ_SEED").ok().and_then(|text| text.parse().ok()).unwrap_or(2);
    let corpus = Corpus::new();
    let mut stream = Stream::new(seed, "mutations of results");
    let (begin, mut rounds, mut sound) = (Instant::now(), 0_u64, 0);
    while begin.elapsed() < Duration::from_secs(seconds) {
        sound += once(&corpus, &mut stream);
        rounds += 1;
    }
    println!("{rounds} rounds of three files in {seconds} s, {sound} files were sound");
}
