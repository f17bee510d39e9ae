//! Errors are reported at their place, and nothing hangs.

use crate::common::{data, domains, goal};
use ramp_kit::source::SourceFile;
use ramp_planner::{Domains, History, PlanError, Record, State, diagnose, plan};

fn rules(file: &str) -> String {
    std::fs::read_to_string(data().join("domains").join(file)).unwrap()
}

/// The shipped rules, with some text of one file replaced.
fn edited(file: &str, old: &str, new: &str) -> Result<Domains, ramp_planner::DomainError> {
    let [order, coarse, fine] = Domains::FILES.map(|name| {
        let text = rules(name);
        assert!(name != file || text.contains(old), "{file} has no {old:?}");
        SourceFile::new(name, &if name == file { text.replacen(old, new, 1) } else { text })
    });
    Domains::new(order, coarse, fine)
}

fn line_of(file: &str, text: &str) -> usize {
    rules(file).lines().position(|line| line.contains(text)).unwrap() + 1
}

fn plan_with(name: &str, domains: &Domains) -> Result<ramp_planner::Plan, PlanError> {
    plan(&goal(name), &State::default(), domains)
}

#[test]
fn a_syntax_error_has_file_line_and_column() {
    for (file, sign, message) in [
        ("order.lp", ":-", "syntax error"),
        ("coarse.al", " if ", "found `if`"),
        ("fine.al", " if ", "found `if`"),
    ] {
        let at = rules(file).lines().position(|line| line.contains(sign)).unwrap() + 1;
        let error = edited(file, sign, &format!("{sign}{sign}")).unwrap_err();
        let text = format!("{error:#}");
        assert!(text.starts_with(&format!("{file}:{at}:")), "{text}");
        assert!(text.contains(message), "{text}");
    }
}

#[test]
fn a_variable_that_nothing_binds_has_file_line_and_column() {
    let old = "full if in_hand(_).";
    let at = line_of("fine.al", old);
    let error = edited("fine.al", old, "full if in_hand(_), N < 3.").unwrap_err();
    assert_eq!(
        format!("{error:#}"),
        format!(
            "fine.al:{at}:21: the variable `N` is unsafe: no static, fluent or action gives it a value (use it as \
             an argument, or compare it with something that is one)"
        )
    );
}

#[test]
fn a_missing_folder_is_named() {
    let error = Domains::read("no/such/folder".as_ref()).unwrap_err();
    assert!(format!("{error:#}").contains("order.lp"), "{error:#}");
}

#[test]
fn a_zero_byte_is_no_rule() {
    let error = edited("coarse.al", "static base(beam).", "static base(\0beam).").unwrap_err();
    assert!(format!("{error:#}").starts_with("coarse.al:"), "{error:#}");
    let error = edited("order.lp", "pending(B)", "pending(\0B)").unwrap_err();
    assert!(format!("{error:#}").starts_with("order.lp:"), "{error:#}");
}

/// Rules that would make clingo read `/etc/passwd`, run a program or exhaust its stack, in every
/// variant that its lexer allows.
#[test]
fn rules_that_reach_outside_or_are_nested_without_end_are_refused_at_their_place() {
    let refused = |rules: &str| {
        let order = SourceFile::new("order.lp", rules);
        let [coarse, fine] = ["coarse.al", "fine.al"].map(|name| SourceFile::new(name, &self::rules(name)));
        Domains::new(order, coarse, fine).err().map(|error| format!("{error:#}"))
    };
    let foreign = |word: &str, place: &str| {
        Some(format!(
            "order.lp:{place}: `{word}` is not allowed in a rule file, not even in a comment or in quotes (put all rules \
             into this one file)"
        ))
    };
    for (rules, word, place) in [
        ("a.\n #include \"/etc/passwd\".", "#include", "2:2"),
        ("#include\n\t<incmode>.", "#include", "1:1"),
        ("%* %\n*%#include \"/etc/passwd\".", "#include", "2:3"),
        ("a(\"\\\\\").#include\"/etc/passwd\".", "#include", "1:9"),
        ("#!%*\n#include \"/etc/passwd\".", "#include", "2:1"),
        ("#script (python)\nimport os\n#end.", "#script", "1:1"),
        ("#script(lua) #end.", "#script", "1:1"),
        ("#theory t { u { - : 1, unary }; &a/0 : u, head }.", "#theory", "1:1"),
        ("asp 1 0 0\n0\n", "asp", "1:1"),
    ] {
        assert_eq!(refused(rules), foreign(word, place), "{rules}");
    }
    // Split directives mean nothing to clingo, so it cannot read a file either.
    for rules in ["# include \"/etc/passwd\".", "#inc\\\nlude \"/etc/passwd\".", "#INCLUDE \"/etc/passwd\"."]
    {
        let message = refused(rules).unwrap();
        assert!(message.contains("lexer error"), "{message}");
    }
    for rules in [
        format!("a. b({}X).", "1+".repeat(100_000)),
        format!("a. b({}1).", "-".repeat(100_000)),
        format!("a. b({}1{}).", "f(".repeat(100_000), ")".repeat(100_000)),
        format!("a. b({}X).", "1%*.*%+\n%.\n".repeat(20_000)),
        format!("a. b({}X).", "\".\"..".repeat(20_000)),
    ] {
        let message = refused(&rules).unwrap();
        let start = "order.lp:1:4: this statement has more than 2048 bytes besides comments";
        assert!(message.starts_with(start), "{message}");
    }
    // The largest allowed statements are accepted.
    for rules in [format!("b({}1).", "-".repeat(2000)), format!("b({}1).", "1+".repeat(1000))] {
        assert_eq!(refused(&rules), None);
    }
}

#[test]
fn rules_without_a_plan_come_to_an_end() {
    // The order of these rules works, but nothing can be pushed.
    let domains = edited("coarse.al", "impossible push(B) if deep(B).", "impossible push(B).").unwrap();
    let error = plan_with("easy-3", &domains).unwrap_err();
    assert!(matches!(&error, PlanError::NoPlan { file, .. } if file == "coarse.al"), "{error}");
    assert!(error.to_string().contains("in_assembly(\"b8\")"), "{error}");

    let domains = edited("fine.al", "impossible push(B, _) if deep(B).", "impossible push(B, _).").unwrap();
    let error = plan_with("easy-3", &domains).unwrap_err();
    assert!(error.to_string().contains("b4 has no link that the hand can push it by"), "{error}");
}

#[test]
fn an_answer_without_a_meaning_is_shown() {
    let domains = edited("order.lp", "#show before/2.", "before(1,2). #show before/2.").unwrap();
    let error = plan_with("easy-1", &domains).unwrap_err();
    assert!(matches!(&error, PlanError::Answer { answer, .. } if answer == "1"), "{error}");

    let domains = edited(
        "fine.al",
        "action fasten(connection).",
        "action glue(connection). glue(C) causes pinned(C).\naction fasten(connection).",
    )
    .unwrap();
    let error = plan_with("easy-1", &domains).unwrap_err();
    assert_eq!(error.to_string(), "fine.al gave the unexpected answer `glue(\"C1\")`");
}

#[test]
fn terms_nested_without_end_exhaust_no_stack() {
    let nested = "at(x,0). at(f(X),N+1) :- at(X,N), N < 10000. before(1,X) :- at(X,10000). #show before/2.";
    let domains = edited("order.lp", "#show before/2.", nested).unwrap();
    let error = plan_with("easy-1", &domains).unwrap_err();
    assert!(matches!(error, PlanError::Answer { .. }), "{error}");
    let saw = format!("in_hand({}b4{})", "beam(".repeat(100_000), ")".repeat(100_000));
    let history = History { records: vec![Record::Saw(saw)], ..History::default() };
    let error = diagnose(&goal("easy-1"), crate::common::domains(), &history).unwrap_err();
    assert!(error.to_string().contains("is not a fluent"));
}

#[test]
fn a_beam_between_two_that_stand_cannot_be_placed() {
    let state = State { in_assembly: ["b4", "b5", "b8"].map(str::to_string).to_vec(), ..State::default() };
    let error = plan(&goal("medium-3"), &state, domains()).unwrap_err();
    let PlanError::Illegal { beams, .. } = &error else { panic!("{error}") };
    assert_eq!(beams, &["b1", "b7"]);
    assert!(error.to_string().contains("b1 has no insertion path past b7"), "{error}");
    // A beam at the frame's edge is inserted from the side.
    let state = State { in_assembly: ["b5", "b8"].map(str::to_string).to_vec(), ..State::default() };
    let plan = plan(&goal("easy-3"), &state, domains()).unwrap();
    assert_eq!(plan.entries[0].direction, [1.0, 0.0, 0.0]);
}

#[test]
fn a_beam_out_of_reach_is_named() {
    let mut assembly = goal("easy-1");
    let b5 = assembly.beam_index("b5").unwrap();
    assembly.beams[b5].beam.start.as_mut().unwrap().at = [1.5, 0.2];
    let error = plan(&assembly, &State::default(), domains()).unwrap_err();
    assert!(matches!(error, PlanError::Illegal { .. }), "{error}");
    assert!(error.to_string().contains("b5 has no link that the hand can grasp"), "{error}");
}

#[test]
fn a_state_that_cannot_be_is_refused() {
    let text = |text: &str| text.to_string();
    let pair = |c: &str, p: &str| (text(c), text(p));
    let b4 = vec![text("b4")];
    let cases = [
        (State { in_assembly: vec![text("b44")], ..State::default() }, "did you mean `b4`?"),
        (
            State { in_assembly: vec![text("b9")], ..State::default() },
            "beam `b9`, which easy-3 does not have",
        ),
        (State { misaligned: b4.clone(), ..State::default() }, "is not in the assembly"),
        (State { misaligned: vec![text("b7")], ..State::default() }, "clamped"),
        (State { fastened: vec![pair("C1", "p1")], ..State::default() }, "`b4` is not in the assembly"),
        (State { fastened: vec![pair("C9", "p1")], ..State::default() }, "the connection `C9`"),
        (
            State { in_assembly: b4.clone(), fastened: vec![pair("C1", "p16")], ..State::default() },
            "peg `p16`",
        ),
        (
            State {
                in_assembly: b4.clone(),
                fastened: vec![pair("C1", "p1"), pair("C1", "p2")],
                ..State::default()
            },
            "`C1` is fastened twice",
        ),
        (
            State {
                in_assembly: vec![text("b4"), text("b5")],
                fastened: vec![pair("C1", "p1"), pair("C2", "p1")],
                ..State::default()
            },
            "`p1` is used twice",
        ),
        (State { lost_pegs: vec![text("b4")], ..State::default() }, "the peg `b4`, which the kit"),
    ];
    for (state, words) in cases {
        let error = plan(&goal("easy-3"), &state, domains()).unwrap_err();
        assert!(error.to_string().contains(words), "{error} does not say {words}");
    }
}

#[test]
fn too_few_pegs_are_counted() {
    let lost_pegs: Vec<String> = (1..=12).map(|number| format!("p{number}")).collect();
    let state = State { lost_pegs, ..State::default() };
    let error = plan(&goal("easy-3"), &state, domains()).unwrap_err();
    assert!(matches!(error, PlanError::Pegs { needed: 4, left: 3, .. }), "{error}");
}
