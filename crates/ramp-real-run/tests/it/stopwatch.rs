//! Stopwatch logs: valid notes become a result; impossible ones are refused with their place.

use std::path::{Path, PathBuf};

use ramp_assembly::Assembly;
use ramp_kit::Kit;
use ramp_kit::source::SourceFile;
use ramp_real_run::stopwatch::{Log, Reader};
use ramp_result::EpisodeResult;
use ramp_result::collection::{Parsed, parse};
use ramp_result::episode::Software;
use ramp_result::published::Published;

fn data(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data").join(name)
}

fn read(text: &str) -> Result<Log, String> {
    let kit: Kit = ramp_kit::read_kit(&data("kit.xml")).unwrap();
    let goals: Vec<Assembly> = ["easy-1", "easy-2"]
        .map(|name| ramp_assembly::read_goal(&data(&format!("goals/{name}.xml")), &kit).unwrap())
        .to_vec();
    let software = Software { version: "test".into(), commit: "test".into() };
    let file = SourceFile::new("log.csv", text);
    Reader { file: &file, kit: &kit, goals: &goals, software: &software }
        .read()
        .map_err(|fault| format!("{fault:#}"))
}

fn example() -> String {
    std::fs::read_to_string(data("examples/stopwatch.csv")).unwrap()
}

fn episodes(text: &str) -> Vec<EpisodeResult> {
    match read(text).unwrap() {
        Log::Episodes(results) => results,
        Log::Means(_) => panic!("means"),
    }
}

#[test]
fn what_a_person_writes_becomes_results_of_the_schema() {
    let results = episodes(&example());
    assert_eq!(results.len(), 2);
    let [one, two] = results.as_slice() else { panic!() };
    assert_eq!((one.completion, one.time.planning, one.time.total), (1.0, 3.4, 164.0));
    let peg = one.pegs[1].as_ref().unwrap();
    assert_eq!((peg.t_total, peg.peg.as_str()), (111.2, "p2"));
    assert!((peg.t_robot - 107.8).abs() < 1e-9);
    assert_eq!(one.real.as_ref().unwrap().scorer, "A. Person");
    // A peg that came out does not count, and a touch ends the episode.
    assert_eq!(two.counted(), 1);
    assert!(two.ended.reason.contains("emergency stop"), "{}", two.ended.reason);
    assert_eq!(two.events[0].kind.to_string(), "p2 dropped beside the sheet");
    let schema = std::fs::read_to_string(data("schema/episode.schema.json")).unwrap();
    let schema = jsonschema::validator_for(&serde_json::from_str(&schema).unwrap()).unwrap();
    for result in &results {
        let json = result.to_json();
        assert!(schema.is_valid(&serde_json::from_str(&json).unwrap()), "{json}");
        // The report accepts the output of `ramp score`.
        assert_eq!(parse("it", json.as_bytes()).unwrap(), Some(Parsed::Episode(Box::new(result.clone()))));
    }
}

#[test]
fn the_papers_figures_load() {
    let text = std::fs::read_to_string(data("published/ramp-baseline.csv")).unwrap();
    let Log::Means(means) = read(&text).unwrap() else { panic!("episodes") };
    let Published { completion, total, planning, .. } = means[0];
    assert_eq!((completion, total, planning), (0.84, 580.0, [180.0, 200.0]));
}

#[test]
fn what_cannot_have_happened_is_refused_where_it_stands() {
    // The replaced text, its replacement, the line of the error, and words of the message.
    let cases = [
        ("easy-1,1,C3,2:40.9,p3", "easy-1,1,C3,1:40.9,p3", 17, "time runs backwards"),
        ("easy-1,1,C3,2:40.9,p3", "easy-1,1,C3,-3,p3", 17, "no time is negative"),
        ("easy-1,1,C3,2:40.9,p3", "easy-1,1,C3,1:75,p3", 17, "60 seconds"),
        ("easy-1,1,C3,2:40.9,p3", "easy-1,1,C3,NaN,p3", 17, "the time is `NaN`"),
        ("easy-1,1,C3,2:40.9,p3", "easy-1,1,C3,,p3", 17, "the time is ``"),
        ("easy-1,1,C3,2:40.9,p3", "easy-1,1,C4,2:40.9,p3", 17, "easy-1 has no connection `C4`"),
        ("easy-1,1,C3,2:40.9,p3", "easy-1,1,C1,2:40.9,p3", 17, "C1 has a peg already"),
        ("easy-1,1,C3,2:40.9,p3", "easy-1,1,b4j1-b7j1,2:40.9,p3", 17, "C1 has a peg already"),
        ("easy-1,1,C3,2:40.9,p3", "easy-1,1,C3,2:40.9,p1", 17, "the peg p1 is in two connections"),
        ("easy-1,1,C3,2:40.9,p3", "easy-1,1,C3,2:40.9,p99", 17, "the kit has no peg `p99`"),
        ("easy-1,1,C3,2:40.9,p3", "easy-11,1,C3,2:40.9,p3", 17, "did you mean `easy-1`?"),
        ("easy-1,1,C3,2:40.9,p3", "easy-1,0,C3,2:40.9,p3", 17, "`repeat` is `0`"),
        ("easy-1,1,C3,2:40.9,p3", "easy-1,1,C3,40:00,p3", 17, "the rules end an episode after 1800 s"),
        ("easy-1,1,C3,2:40.9,p3", "easy-1,1,C3,2:40.9,p3,,x", 17, "this line has 7 cells"),
        ("easy-1,1,end,2:44", "easy-1,1,end,2:44\neasy-1,1,fault,3:00", 19, "has ended before this line"),
        ("easy-1,1,end,2:44\n", "", 17, "stops here"),
        ("easy-1,1,planning,3.4\n", "", 14, "begins with `C1`"),
        ("1:30,,p2 dropped", "1:30,p2 dropped", 21, "a peg is named in a line `fault`"),
        ("easy-1,2,out C2", "easy-1,2,out C3", 23, "no peg is in C3 yet"),
        ("track,tags", "track,eyes", 6, "there is no track `eyes`"),
        ("rules,ramp-rules-9", "rules,7", 3, "the rules are of version `7`"),
        ("scorer,A. Person\n", "", 10, "nothing above the table says `scorer`"),
        ("scorer,A. Person", "agent,again", 10, "`agent` is given twice"),
        ("log,ramp-stopwatch-1", "log,ramp-stopwatch-9", 2, "`ramp-stopwatch-9`"),
        ("goal,repeat,what", "goal,what,repeat", 13, "column 2 of the table is not `repeat`"),
    ];
    for (from, to, line, words) in cases {
        let text = example();
        assert!(text.contains(from), "{from}");
        let message = read(&text.replacen(from, to, 1)).unwrap_err();
        assert!(message.starts_with(&format!("log.csv:{line}:")), "{to}: {message}");
        assert!(message.contains(words), "{to}: {message}");
    }
}

/// Spreadsheets separate cells by semicolons or tabs where the comma is the decimal sign.
#[test]
fn a_spreadsheet_of_a_country_with_decimal_commas_is_read() {
    let points = example();
    let sound = episodes(&points);
    let commas = |separator: &str| {
        let rows = points.lines().map(|line| match line {
            line if line.starts_with("source,") => format!("source{separator}an example, made up"),
            line if line.starts_with("easy-") => {
                // Only times have points.
                line.replace(',', separator).replace('.', ",")
            }
            line => line.replace(',', separator),
        });
        rows.collect::<Vec<String>>().join("\r\n")
    };
    for text in [
        commas(";"),
        commas("\t"),
        format!("sep=;\r\n{}", commas(";")),
        format!("sep=,\n{points}"),
        points.replace("48.0", "\"48,0\"").replace("3.4", "\"3,4\""),
        // Empty cells at the ends of rows.
        commas(";").replace("\r\n", ";;;\r\n"),
    ] {
        let read = episodes(&text);
        let times = |results: &[EpisodeResult]| -> Vec<(f64, usize)> {
            results.iter().map(|it| (it.time.total, it.counted())).collect()
        };
        assert_eq!(times(&read), times(&sound), "{text}");
        assert_eq!(read[0].pegs, sound[0].pegs, "{text}");
        assert_eq!(read[0].real, sound[0].real);
    }
    let thousands = points.replace("48.0", "\"1,480\"");
    let why = read(&thousands).unwrap_err();
    assert!(why.contains("the comma in `1,480` may be a decimal comma or separate thousands"), "{why}");
    // Milliseconds.
    let late = points.replace("easy-1,1,end,2:44", "easy-1,1,end,164000");
    assert!(read(&late).unwrap_err().contains("of robot time"));
}
