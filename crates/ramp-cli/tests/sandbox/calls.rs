//! System calls from inside a sandbox: each number is tried, and the result is compared with the list. The
//! documentation shows the same list.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::Path;

use ramp_external_agent::sandbox::calls::{
    ALLOWED, DENIED_AS_UNKNOWN, LIMITED, Processor, Treatment, UNFILTERED, WITH_GRAPHICS, treatment,
};
use ramp_external_agent::sandbox::graphics;
use ramp_testing::trials::{Trial, check, check_unless};
use tempfile::TempDir;

use crate::missing;
use crate::seal::{agents, ramp, result};
use ramp_testing::program::text;

/// Calls from this number on are newer than the oldest kernel with Landlock.
const NEWEST_CALLS: i32 = 447;
const PAGE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/src/reference/sandbox-calls.md");

/// The letters of both tries of each number, as `tests/agents/sweep.py` explains them.
fn sweep() -> BTreeMap<i32, [char; 2]> {
    let (agents, results) = (agents(), TempDir::new().unwrap());
    let arguments = ["run", "easy-1", "--track", "state", "-o", "out.json", "--sandbox"];
    let output = ramp(&results, &arguments, &agents.path().join("sweep.py")).output().unwrap();
    let result = result(&results, "out.json");
    assert_eq!(result["ended"]["reason"], "done", "{}", text(&output.stderr));
    let events = result["events"].as_array().unwrap();
    let words: String = events.iter().map(|it| it["text"].as_str().unwrap().to_string() + " ").collect();
    let mut found = BTreeMap::new();
    for word in words.split_whitespace() {
        let (number, letters) = word.split_at(word.len() - 2);
        found.insert(number.parse().unwrap(), [letters.as_bytes()[0].into(), letters.as_bytes()[1].into()]);
    }
    found
}

/// Each call that the list allows can be made, and no other.
fn every_system_call_is_treated_as_the_list_says() {
    let found = sweep();
    let known: BTreeMap<i32, &str> = Processor::X86.calls().into_iter().collect();
    let mut wrong = String::new();
    let mut counts: BTreeMap<String, usize> = BTreeMap::new();
    for (number, letters) in &found {
        let name = known.get(number).copied().unwrap_or("(no name)");
        let expected = known.get(number).map_or(Treatment::Unknown, |name| treatment(name, graphics()));
        let refused = |letter: &char| matches!(letter, 'p' | 's');
        let right = match expected {
            _ if UNFILTERED.contains(&name) => true,
            // An older kernel lacks the newest calls.
            Treatment::Allowed if *number >= NEWEST_CALLS => *letters != ['p', 'p'],
            // Some arguments alone make the kernel itself refuse an allowed call.
            Treatment::Allowed => !letters.iter().all(refused),
            // -1 is in no condition.
            Treatment::Limited => letters[1] == 'p',
            Treatment::Refused => *letters == ['p', 'p'],
            Treatment::Unknown => *letters == ['s', 's'],
        };
        *counts.entry(format!("{expected:?}")).or_default() += 1;
        if !right {
            let _ = writeln!(wrong, "{number} {name}: expected {expected:?}, found {letters:?}");
        }
    }
    assert!(wrong.is_empty(), "{wrong}");
    assert!(found.len() > 500 && counts.len() == 4, "{counts:?}");
    println!("{} numbers tried: {counts:?}", found.len());
}

/// The page of the documentation.
fn page() -> String {
    let mut page = String::from(
        "# System calls in a sandbox\n\n\
         An agent in a [sandbox](../howto/run-a-strangers-agent.md) can make the calls of this page and no others. \
         The list holds for\nx86-64, aarch64 and riscv64; a processor that lacks a call ignores it. A test tries \
         every number on x86-64 and compares\nthe results with the list.\n\n\
         | treatment | result |\n|---|---|\n\
         | allowed | the kernel decides |\n\
         | allowed with some arguments | `EPERM` with others |\n\
         | refused | `EPERM` |\n\
         | unknown: the calls named below, and every number that this program does not know | `ENOSYS` |\n\n\
         A call of the 32-bit form of x86 ends the process. The x32 form is unknown. The kernel shows `uprobe` and \
         `uretprobe` to\nno filter; outside of a traced program they fail or end the process.\n\n## Allowed\n\n\
         | reason | calls |\n|---|---|\n",
    );
    for group in ALLOWED {
        let calls: Vec<String> = group.calls.iter().map(|call| format!("`{call}`")).collect();
        let _ = writeln!(page, "| {} | {} |", group.reason, calls.join(", "));
    }
    let _ = write!(
        page,
        "\n## Allowed with some arguments\n\n| call | allowed | why not the others |\n|---|---|---|\n"
    );
    for it in LIMITED {
        let _ = writeln!(page, "| `{}` | {} | {} |", it.call, it.allowed, it.reason);
    }
    let _ = write!(
        page,
        "\nOnly where a graphics card is present, these are allowed as well:\n\n| call | allowed | reason |\n|---|---|---|\n"
    );
    for it in WITH_GRAPHICS {
        let _ = writeln!(page, "| `{}` | {} | {} |", it.call, it.allowed, it.reason);
    }
    let _ = write!(page, "\n## Unknown\n\n| call | reason |\n|---|---|\n");
    for (call, reason) in DENIED_AS_UNKNOWN {
        let _ = writeln!(page, "| `{call}` | {reason} |");
    }
    let _ = write!(page, "\n## Refused\n\n");
    for processor in Processor::ALL {
        let refused: Vec<String> = processor
            .calls()
            .iter()
            .filter(|(_, name)| treatment(name, false) == Treatment::Refused)
            .map(|(_, name)| format!("`{name}`"))
            .collect();
        let _ = writeln!(page, "**{}** ({}): {}.\n", processor.name(), refused.len(), refused.join(", "));
    }
    page.truncate(page.trim_end().len());
    page.push('\n');
    page
}

fn the_page_shows_the_list() {
    let page = page();
    if std::env::var_os("RAMP_WRITE").is_some() {
        std::fs::write(PAGE, &page).unwrap();
    }
    let found = std::fs::read_to_string(Path::new(PAGE)).unwrap_or_default();
    assert!(found == page, "{PAGE} is out of date: write it anew with RAMP_WRITE=1");
}

fn missing_here() -> Option<String> {
    let other = std::env::consts::ARCH != "x86_64";
    missing().or(other.then(|| "the numbers of the sweep are those of x86-64".to_string()))
}

/// The checks of this file.
pub fn checks() -> Vec<Trial> {
    vec![
        check_unless(
            "every_system_call_is_treated_as_the_list_says",
            missing_here,
            every_system_call_is_treated_as_the_list_says,
        ),
        check("the_page_shows_the_list", the_page_shows_the_list),
    ]
}
