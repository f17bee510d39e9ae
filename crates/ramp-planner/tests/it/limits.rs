//! Rules that never terminate are ended within their limits, in every phase.

use crate::common::{data, goal};
use ramp_kit::source::SourceFile;
use ramp_planner::{Domains, Exceeded, Limits, State, plan};
use std::os::unix::process::CommandExt;
use std::process::Command;
use std::time::Duration;

/// The name of the rules, for the test that another process of this program runs.
const CASE: &str = "RULES_THAT_NEVER_END";
const MEMORY: &str = "more than 64 MiB of memory";
const TIME: &str = "more than 1 s";

/// Rules that never terminate: the file, the insertion point, the text, and the exceeded limit.
const CASES: [(&str, &str, &str, &str); 5] = [
    ("grounds and grows", "order.lp", "many(0). many(X+1) :- many(X).", MEMORY),
    ("grounds and does not grow", "order.lp", "n(1..9999). :- n(X), n(Y), n(Z), X+Y+Z < 0.", TIME),
    ("solves", "order.lp", "{ in(P,H) : H = 1..60 } = 1 :- P = 1..61. :- in(P,H), in(Q,H), P < Q.", TIME),
    (
        "unrolls",
        "coarse.al",
        "action many(beam, beam, beam, beam, beam, beam, beam, beam, beam, beam, beam, beam, beam).",
        MEMORY,
    ),
    ("derives", "coarse.al", "static all(number). all(1). all(N + 1) if all(N).", TIME),
];

fn end(exceeded: &Exceeded) {
    eprintln!("{exceeded}");
    // Replaces this process, so nothing of it continues.
    panic!("{}", Command::new("false").exec());
}

#[test]
fn rules_without_an_end_are_ended() {
    for (case, file, _, limit) in CASES {
        let mut child = Command::new(std::env::current_exe().unwrap());
        child.args(["--exact", "--ignored", "--nocapture", "limits::plans"]).env(CASE, case);
        let output = child.output().unwrap();
        let told = String::from_utf8_lossy(&output.stderr);
        assert!(told.contains(&format!("the rules took {limit}: ")), "{case}: {told}");
        assert!(told.contains(file), "{case}: {told}");
        assert_eq!(output.status.code(), Some(1), "{case}: {told}");
    }
}

#[test]
#[ignore = "for the test above, which runs it in a process of its own"]
fn plans() {
    let Ok(case) = std::env::var(CASE) else { return };
    let (_, at, more, limit) = CASES.into_iter().find(|(name, ..)| *name == case).unwrap();
    let [order, coarse, fine] = Domains::FILES.map(|name| {
        let text = std::fs::read_to_string(data().join("domains").join(name)).unwrap();
        SourceFile::new(name, &if name == at { format!("{text}\n{more}\n") } else { text })
    });
    // The other limit is never reached.
    let (memory, time) = if limit == MEMORY { (64 << 20, 600) } else { (64 << 30, 1) };
    let limits = Limits { memory, time: Duration::from_secs(time), ..Limits::new(end) };
    let domains = Domains::new(order, coarse, fine).unwrap().within(limits);
    let _ = plan(&goal("hard-1"), &State::default(), &domains);
}

#[test]
fn honest_rules_are_far_from_the_limits() {
    let limits = Limits::new(end);
    let tenth = Limits { memory: limits.memory / 10, ..limits };
    let domains = Domains::read(&data().join("domains")).unwrap().within(tenth);
    for name in crate::common::EASY.into_iter().chain(crate::common::HARDER) {
        plan(&goal(name), &State::default(), &domains).unwrap();
    }
}
