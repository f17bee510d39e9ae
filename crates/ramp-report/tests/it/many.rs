//! Reports and boards of many agents: a front page grows with the agents a little, and not with their
//! episodes or pairs.

use std::time::Instant;

use ramp_report::leaderboard::{Boards, Refusal, pages, standings};
use ramp_report::{Report, page, table};
use ramp_result::collection::{Collection, collect};
use ramp_result::episode::RobotTime;
use ramp_result::testing::episode;
use ramp_robot::{Action, Event, EventKind};

/// Results of agents of different quality on two goals, with many events.
fn results(agents: usize, seeds: u64) -> Collection {
    let folder = tempfile::TempDir::new().unwrap();
    for agent in 0..agents {
        for goal in ["easy-1", "easy-2"] {
            for seed in 1..=seeds {
                let since: Vec<f64> = (0..(agent + seed as usize) % 4)
                    .map(|peg| 20.0 * (peg + 1) as f64 + (agent % 17) as f64)
                    .collect();
                let mut result = episode(goal, seed, &since, 4);
                result.agent.name = format!("agent-{agent}");
                result.robot_time = Some(RobotTime { bound: 11.25, reference: 33.75 });
                result.events = (0..40)
                    .map(|index| {
                        let action = Action::new("move").with("to", &format!("beam {index}"));
                        let kind = match index % 2 {
                            0 => EventKind::ActionBegun(action),
                            _ => EventKind::ActionEnded(action),
                        };
                        Event::new(f64::from(index) / 10.0, kind)
                    })
                    .collect();
                let path = folder.path().join(format!("{agent}-{goal}-{seed}.json"));
                std::fs::write(path, result.to_json()).unwrap();
            }
        }
    }
    collect(&[folder.path().to_path_buf()]).unwrap()
}

#[test]
fn the_front_page_of_many_has_sums_and_links_and_the_tables_have_all() {
    let few = Report::new(results(10, 2));
    assert!(!few.is_large());
    let whole = page::html(&few);
    assert!(whole.contains("Every episode over time") && whole.contains("Where this comes from"));
    let report = Report::new(results(24, 2));
    assert!(report.is_large());
    let front = page::front(&report, "report-agents");
    for entrant in 0..24 {
        assert!(front.contains(&format!("href=\"report-agents/{}\"", page::agent_page(entrant))));
    }
    assert!(front.len() < whole.len(), "{} and {}", front.len(), whole.len());
    assert!(!front.contains("Every episode over time"));
    // The best are compared, and the tables contain every pair.
    let pairs = front.matches("data-label=\"measure\"><div>completion</div>").count();
    assert_eq!(pairs, 10 * 9 / 2);
    let comparisons = table::tables(&report).into_iter().find(|it| it.name == "comparisons").unwrap();
    let rows = comparisons.text.lines().filter(|line| line.contains(",completion,")).count();
    assert_eq!(rows, 24 * 23 / 2);
    // Details omitted from the front page are on the agent's own.
    let seven = report.collection.entrants.iter().position(|it| it.label == "agent-7").unwrap();
    let own = page::of_agent(&report.of_agent(seven), ("../report.html", "RAMP report"));
    assert!(own.contains("href=\"../report.html\"") && own.contains("Every episode over time"));
    assert!(own.contains(">7-easy-2-2.json") && !own.contains(">8-easy-2-2.json"));
    assert!(own.contains("was run with seeds 1, 2"), "its notes are on its page");
}

#[test]
fn a_board_has_fifty_on_a_page_and_the_front_page_the_best_of_each() {
    let mut collection = results(60, 2);
    // Some of them on another track.
    for entrant in collection.entrants.iter_mut().skip(55) {
        for file in &mut entrant.files {
            file.result.track = "tags".into();
        }
        entrant.identity.track = "tags".into();
    }
    let mut boards = Boards::default();
    for (key, mut standing) in standings("<i>entry", "<b>one", &collection, page::agent_page, |_| false) {
        standing.warnings.push("as <b>another".into());
        boards.add(key, standing);
    }
    let refused = vec![Refusal { entry: "<u>bad".into(), reason: "no <s>log".into() }; 51];
    let pages = pages::pages(&boards, &refused, &|_| vec![("kit".into(), "<u>hash".into())]);
    let names: Vec<&str> = pages.iter().map(|(name, _)| name.as_str()).collect();
    let state = "board-easy-state-ramp-rules-9";
    let expected = [
        format!("{state}.html"),
        format!("{state}-2.html"),
        "board-easy-tags-ramp-rules-9.html".into(),
        "refused.html".into(),
        "refused-2.html".into(),
        "index.html".into(),
    ];
    assert_eq!(names, expected);
    let rows = |text: &str| text.matches("data-label=\"place\"><div>").count();
    assert_eq!(pages.iter().map(|(_, text)| rows(text)).collect::<Vec<_>>(), [50, 5, 5, 0, 0, 6]);
    assert!(
        pages[1].1.contains("data-label=\"place\"><div>51</div>")
            && pages[1].1.contains(&format!("href=\"{state}.html\""))
    );
    assert!(
        pages[0].1.contains("data-label=\"bound, s\"><div>11.2</div>")
            && pages[0].1.contains("data-label=\"reference, s\"><div>33.8</div>"),
        "bound and reference are beside the robot's time"
    );
    assert!(pages[0].1.contains("kit") && pages[0].1.contains("&lt;u&gt;hash"), "a board names hashes");
    for (name, text) in &pages {
        for markup in ["<i>", "<b>", "<u>", "<s>"] {
            assert!(!text.contains(markup), "{name}: a name became markup");
        }
    }
    // The best comes first: most pegs, then least time.
    let best = &boards.boards()[0].standings;
    let of = |index: usize| &best[index].line.summary;
    assert!(
        best.windows(2)
            .all(|two| { two[0].line.summary.completion.mean >= two[1].line.summary.completion.mean })
    );
    assert!(of(0).completion.mean > of(54).completion.mean);
}

#[test]
#[ignore = "takes a minute: 600 agents"]
fn the_front_page_of_six_hundred_is_small() {
    let begin = Instant::now();
    let report = Report::new(results(600, 5));
    let summed = begin.elapsed();
    let front = page::front(&report, "report-agents");
    let own = page::of_agent(&report.of_agent(599), ("../report.html", "RAMP report"));
    println!(
        "{} bytes, {} for an agent, sums took {summed:?}, all {:?}",
        front.len(),
        own.len(),
        begin.elapsed()
    );
    assert!(front.len() < 1_000_000, "{}", front.len());
}
