//! Technical failures stand apart from those of an agent.

use ramp_report::leaderboard::{Boards, pages, standings};
use ramp_report::{page, sums};
use ramp_result::collection::collect;
use ramp_result::episode::EndKind;
use ramp_result::testing::episode;

#[test]
fn an_agent_is_not_blamed_for_the_machine() {
    let folder = tempfile::TempDir::new().unwrap();
    // Two episodes end for one reason in words: once the agent's, once not. One is lost.
    for (seed, kind) in [(1, EndKind::Agent), (2, EndKind::Wall), (3, EndKind::Done)] {
        let mut result = episode("easy-1", seed, if seed == 3 { &[20.0] } else { &[] }, 1);
        result.ended.kind = Some(kind);
        if seed < 3 {
            result.ended.reason = "not done in time".into();
        }
        std::fs::write(folder.path().join(format!("{seed}.json")), result.to_json()).unwrap();
    }
    std::fs::write(folder.path().join("easy-1-state-4.log"), "killed").unwrap();
    let collection = collect(&[folder.path().to_path_buf()]).unwrap();
    let failures = sums::failures(&collection.entrants[0]);
    let found: Vec<(bool, u64)> = failures.iter().map(|it| (it.technical, it.episodes[0].1)).collect();
    assert_eq!(found, [(false, 1), (true, 4), (true, 2)]);
    let mut boards = Boards::default();
    for (key, standing) in standings("entry", "agent", &collection, page::agent_page, |_| false) {
        let sum = &standing.line.summary;
        assert_eq!((sum.episodes, sum.finished, sum.technical), (4, 3, 2));
        boards.add(key, standing);
    }
    let pages = pages::pages(&boards, &[], &|_| Vec::new());
    for cell in [
        "data-label=\"complete, episodes\"><div>1/4</div>",
        "data-label=\"technical, failures\"><div>2</div>",
    ] {
        assert!(pages[0].1.contains(cell), "{cell}: {}", pages[0].1);
    }
}
