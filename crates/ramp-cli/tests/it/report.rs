//! `ramp score` and `ramp report` as a user has them: from a stopwatch log to a page.

use std::path::Path;
use std::process::Output;

use crate::ramp;
use ramp_testing::program::words;
use tempfile::TempDir;

fn data(name: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data").join(name);
    path.canonicalize().unwrap().display().to_string()
}

fn done(output: &Output) {
    assert_eq!(output.status.code(), Some(0), "{}", words(&output.stderr));
}

fn refused(output: &Output, sentence: &str) {
    let message = words(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{message}");
    assert!(message.contains(sentence), "{message}");
    assert!(output.stdout.is_empty());
}

/// Two agents by stopwatch, one with words that a spreadsheet would run, and the published means, with a
/// title that would be markup.
fn results() -> TempDir {
    let folder = TempDir::new().unwrap();
    let log = std::fs::read_to_string(data("examples/stopwatch.csv")).unwrap();
    std::fs::write(folder.path().join("log.csv"), &log).unwrap();
    let formula = "easy-1,1,end,2:44,,\"=HYPERLINK(\"\"x\"\")\"";
    let other = log.replace("agent,our-system", "agent,theirs").replace("1:51.2", "1:59.9");
    let other = other.replace("easy-1,1,end,2:44", formula);
    std::fs::write(folder.path().join("other.csv"), other).unwrap();
    done(&ramp(&folder, &["score", "log.csv", "-o", "one"]));
    done(&ramp(&folder, &["score", "other.csv", "-o", "two"]));
    let means = std::fs::read_to_string(data("published/ramp-baseline.csv")).unwrap();
    let markup = "agent,RAMP baseline as published [1] <script>alert(1)</script>";
    let means = means.replace("agent,RAMP baseline as published", markup);
    std::fs::write(folder.path().join("means.csv"), means).unwrap();
    done(&ramp(&folder, &["score", "means.csv", "-o", "means"]));
    folder
}

#[test]
fn from_the_stopwatch_to_the_page_to_the_same_bits() {
    let folder = results();
    let report = ["report", "one", "two", "means", "--paper", "table.tex", "--figures", "figures"];
    done(&ramp(&folder, &report));
    let read = |name: &str| std::fs::read_to_string(folder.path().join(name)).unwrap();
    let page = read("report.html");
    assert!(page.contains("RAMP baseline as published") && page.contains("our-system"));
    assert!(!page.contains("<script>alert"), "a name became markup");
    // Nothing is fetched from anywhere.
    for word in ["http:", "https:", "src=", "@import", "url("] {
        let without_names = page.replace("http://www.w3.org/2000/svg", "");
        assert!(!without_names.contains(word), "{word}");
    }
    assert!(read("table.tex").contains("published {[}1{]} \\textless{}script\\textgreater{}"));
    let episodes = read("figures/episodes.csv");
    assert!(episodes.contains(",\"'=HYPERLINK("), "a spreadsheet runs this: {episodes}");
    assert_eq!(read("figures/sums.csv").lines().count(), 5);
    assert!(read("figures/curves-tags-real-robot-easy.svg").starts_with("<svg"));
    done(&ramp(&folder, &report));
    assert_eq!(page, read("report.html"));
}

/// Results that tell what robot time is to be compared with stand beside those that do not, as older ones.
#[test]
fn bound_and_reference_stand_beside_the_time() {
    let folder = results();
    let path = folder.path().join("one/easy-1-tags-1.json");
    let result = std::fs::read_to_string(&path).unwrap();
    let with = |bound: &str| {
        let told = format!("\"robot_time\": {{\"bound\": {bound}, \"reference\": 47.5}}, \"plan\": {{");
        std::fs::write(&path, result.replacen("\"plan\": {", &told, 1)).unwrap();
    };
    with("12.25");
    done(&ramp(&folder, &["report", "one", "two", "--paper", "table.tex", "--figures", "figures"]));
    let read = |name: &str| std::fs::read_to_string(folder.path().join(name)).unwrap();
    let latex = read("table.tex");
    assert!(latex.contains(" & 12.2 & 47.5 \\\\") && latex.contains(" & -- & -- \\\\"), "{latex}");
    assert!(
        read("report.html").contains("data-label=\"reference, s\"><div>47.5</div>"),
        "{}",
        read("report.html")
    );
    for table in ["figures/sums.csv", "figures/episodes.csv"] {
        let text = read(table);
        assert!(text.contains(",bound,reference,") && text.contains(",12.250000,47.500000,"), "{text}");
    }
    with("-1");
    refused(&ramp(&folder, &["report", "one"]), "`robot_time.bound` is -1 s");
}

#[test]
fn many_agents_have_a_front_page_and_a_page_each() {
    let folder = results();
    let log = std::fs::read_to_string(data("examples/stopwatch.csv")).unwrap();
    let mut report: Vec<String> = vec!["report".into(), "-o".into(), "out/all.html".into()];
    for agent in 1..=11 {
        let own = log.replace("agent,our-system", &format!("agent,system-{agent}"));
        std::fs::write(folder.path().join("own.csv"), own).unwrap();
        let name = format!("agent-{agent}");
        done(&ramp(&folder, &["score", "own.csv", "-o", &name]));
        report.push(name);
    }
    let arguments: Vec<&str> = report.iter().map(String::as_str).collect();
    done(&ramp(&folder, &arguments));
    let read = |name: &str| std::fs::read_to_string(folder.path().join("out").join(name)).unwrap();
    let front = read("all.html");
    assert!(front.contains("href=\"all-agents/agent-11.html\"") && !front.contains("SHA-256"));
    let own = read("all-agents/agent-11.html");
    assert!(own.contains("href=\"../all.html\"") && own.contains("SHA-256") && own.contains("system-11"));
    // As few as fit on one page are on one page.
    done(&ramp(&folder, &[&arguments[..3], &arguments[4..]].concat()));
    assert!(read("all.html").contains("SHA-256"));
}

#[test]
fn what_does_not_belong_together_is_refused() {
    let folder = results();
    let path = folder.path().join("one/easy-1-tags-1.json");
    let sound = std::fs::read_to_string(&path).unwrap();
    // Replacements in a result, and the message expected for each.
    let cases = [
        ("ramp-episode-5", "ramp-episode-1", "is of the schema `ramp-episode-1`"),
        ("ramp-rules-9", "ramp-rules-0", "was judged by the rules ramp-rules-0"),
        ("\"completion\": 1.0", "\"completion\": 0.9", "`completion` is 0.9, and 3 of 3 pegs count"),
        ("\"total\": 164.0", "\"total\": 163.0", "`time.total` is 163 s"),
        ("\"t_robot\": 44.6", "\"t_robot\": 444.6", "C1 is pinned since 444.6 s"),
        ("\"peg\": \"p2\"", "\"peg\": \"p1\"", "the peg p1 counts twice"),
        ("\"track\": \"tags\"", "\"track\": \"eyes\"", "there is no track `eyes`"),
        ("\"seed\": 1", "\"seed\": 2", "are two results of one episode"),
        ("\"class\": \"easy\"", "\"class\": \"hard\"", "are of two goals called `easy-1`"),
        ("\"seed\": 1,", "", "easy-1-tags-1.json:"),
    ];
    for (from, to, sentence) in cases {
        assert!(sound.contains(from), "{from}");
        std::fs::write(&path, sound.replacen(from, to, 1)).unwrap();
        refused(&ramp(&folder, &["report", "one", "two"]), sentence);
    }
    std::fs::create_dir(folder.path().join("empty")).unwrap();
    refused(&ramp(&folder, &["report", "empty"]), "there is no result in empty");
    refused(&ramp(&folder, &["report", "nowhere"]), "nowhere cannot be read");
    assert!(!folder.path().join("report.html").exists());
}

/// A stopwatch log of the whole easy class.
fn whole_class() -> String {
    let example = std::fs::read_to_string(data("examples/stopwatch.csv")).unwrap();
    let mut log = example.split("easy-1,1,").next().unwrap().to_string();
    for goal in ["easy-1", "easy-2", "easy-3"] {
        for repeat in 1..=5 {
            for line in ["planning,3", "C1,60", "C2,120", "end,200"] {
                log.push_str(&format!("{goal},{repeat},{line}\n"));
            }
        }
    }
    log
}

#[test]
fn a_leaderboard_takes_whole_classes_only() {
    let folder = TempDir::new().unwrap();
    let log = whole_class();
    std::fs::write(folder.path().join("log.csv"), &log).unwrap();
    done(&ramp(&folder, &["score", "log.csv", "-o", "all/one"]));
    done(&ramp(&folder, &["leaderboard", "all", "-o", "site"]));
    let read = |name: &str| std::fs::read_to_string(folder.path().join(name)).unwrap();
    let page = read("site/board-easy-tags-real-robot-ramp-rules-9.html");
    assert!(page.contains("real robot") && page.contains("agent-1.html") && page.contains("our-system"));
    assert!(folder.path().join("site/agent-1.html").exists());
    std::fs::remove_file(folder.path().join("all/one/easy-3-tags-4.json")).unwrap();
    let output = ramp(&folder, &["leaderboard", "all", "-o", "site2"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(words(&output.stdout).contains("refused one: our-system"));
    assert!(words(&output.stdout).contains("easy-3 was run with seeds 1, 2, 3, 5"));
    assert!(read("site2/index.html").contains("No entry is on a board"));
    // An invalid entry does not keep another one from the board.
    let other = log.replace("our-system", "their-system");
    std::fs::write(folder.path().join("other.csv"), other).unwrap();
    done(&ramp(&folder, &["score", "other.csv", "-o", "all/two"]));
    let output = ramp(&folder, &["leaderboard", "all", "-o", "site3"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(words(&output.stdout).contains("refused one: "));
    let page = read("site3/index.html");
    assert!(page.contains("their-system") && !page.contains("our-system"));
}

#[test]
fn goals_that_are_kept_back_are_promised_and_verified() {
    let folder = TempDir::new().unwrap();
    let goal = data("goals/easy-2.xml");
    done(&ramp(&folder, &["goals", "commit", &goal, "-o", "held"]));
    let verify = ["goals", "verify", "held/commitments.json", "held/reveal.json"];
    done(&ramp(&folder, &verify));
    // The published file reveals nothing of the goal, and two commitments to one goal differ.
    let published = std::fs::read_to_string(folder.path().join("held/commitments.json")).unwrap();
    assert!(!published.contains("beam"));
    done(&ramp(&folder, &["goals", "commit", &goal, "-o", "again"]));
    let again = std::fs::read_to_string(folder.path().join("again/commitments.json")).unwrap();
    assert_ne!(published, again);
    refused(&ramp(&folder, &["goals", "commit", &goal, "-o", "held"]), "is there already");
    // Another goal is not what was promised.
    let path = folder.path().join("held/reveal.json");
    let revealed = std::fs::read_to_string(&path).unwrap();
    std::fs::write(&path, revealed.replacen("b7", "b8", 1)).unwrap();
    let output = ramp(&folder, &verify);
    assert_eq!(output.status.code(), Some(1), "{}", words(&output.stderr));
    assert!(words(&output.stdout).contains("does not match its commitment"));
}

#[test]
fn plans_are_judged_alone_and_told_in_the_report() {
    let folder = TempDir::new().unwrap();
    let plan = ramp(&folder, &["plan", "easy-1", "--json"]);
    done(&plan);
    std::fs::write(folder.path().join("good.json"), &plan.stdout).unwrap();
    let mut wrong: serde_json::Value = serde_json::from_slice(&plan.stdout).unwrap();
    wrong["plan"]["steps"].as_array_mut().unwrap().remove(3);
    std::fs::write(folder.path().join("hasty.json"), wrong.to_string()).unwrap();
    std::fs::create_dir(folder.path().join("plans")).unwrap();
    let judge = |plan: &str, output: &str| ramp(&folder, &["plan", "easy-1", "--from", plan, "-o", output]);
    done(&judge("good.json", "plans/one.json"));
    assert_eq!(judge("hasty.json", "plans/two.json").status.code(), Some(1));
    done(&ramp(&folder, &["report", "plans"]));
    let page = std::fs::read_to_string(folder.path().join("report.html")).unwrap();
    assert!(page.contains("Planning alone") && page.contains("hasty") && page.contains("refused"));
    assert!(page.contains("step 4"), "where it is wrong is told");
}

#[test]
fn a_wrong_log_writes_nothing_and_the_form_is_a_pdf() {
    let folder = results();
    std::fs::write(folder.path().join("bad.csv"), "log,ramp-stopwatch-1\nagent,x\n").unwrap();
    refused(&ramp(&folder, &["score", "bad.csv", "-o", "new"]), "bad.csv:2:");
    assert!(!folder.path().join("new").exists());
    done(&ramp(&folder, &["score", "--form", "hard-3", "-o", "form.pdf"]));
    assert!(std::fs::read(folder.path().join("form.pdf")).unwrap().starts_with(b"%PDF"));
    refused(&ramp(&folder, &["score", "--form", "hard-33", "-o", "form2.pdf"]), "did you mean `hard-3`?");
}
