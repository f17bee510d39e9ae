//! What is wrong is said, with its place, and nothing hangs.

// A helper may panic as its test may.
#![allow(clippy::unwrap_used)]

mod common;

use common::{data, domains, goal, kit};
use ramp_kit::source::SourceFile;
use ramp_planner::{Domains, PlanError, State, plan};

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
    plan(&goal(name), kit(), &State::default(), domains)
}

#[test]
fn a_syntax_error_has_file_line_and_column() {
    for file in Domains::FILES {
        let at = rules(file).lines().position(|line| line.contains(":-")).unwrap() + 1;
        let error = edited(file, ":-", ":-:-").unwrap_err();
        assert_eq!(error.place().line_column().0, at);
        let text = format!("{error:#}");
        assert!(text.starts_with(&format!("{file}:{at}:")), "{text}");
        assert!(text.contains("syntax error"), "{text}");
    }
}

#[test]
fn a_variable_that_nothing_binds_has_file_line_and_column() {
    let at = line_of("fine.lp", "carried(B) :- coarse(assemble(B)).");
    let error =
        edited("fine.lp", "carried(B) :- coarse(assemble(B)).", "carried(Beam) :- coarse(assemble(B)).");
    let text = format!("{:#}", error.unwrap_err());
    assert!(text.starts_with(&format!("fine.lp:{at}:1: unsafe variables")), "{text}");
    assert!(text.contains("'Beam' is unsafe") && !text.contains("<block>"), "{text}");
}

#[test]
fn a_missing_folder_is_named() {
    let error = Domains::read("no/such/folder".as_ref()).unwrap_err();
    assert!(format!("{error:#}").contains("order.lp"), "{error:#}");
}

#[test]
fn a_zero_byte_is_no_rule() {
    let error = edited("coarse.lp", "area(input).", "area(\0input).").unwrap_err();
    assert!(format!("{error:#}").starts_with("coarse.lp:"), "{error:#}");
}

#[test]
fn rules_without_a_plan_come_to_an_end() {
    // The order of these rules is fine, but nothing can be pushed.
    let domains =
        edited("coarse.lp", "not holds(in_assembly(B),t-1).\n:- do(push(_)", "do(push(B),t).\n:- do(push(_)");
    let error = plan_with("easy-3", &domains.unwrap()).unwrap_err();
    assert!(matches!(&error, PlanError::NoPlan { file, .. } if file == "coarse.lp"), "{error}");
    assert!(error.to_string().contains("in_assembly(\"b8\")"), "{error}");

    let domains = edited("fine.lp", ":- do(push(_,_),t), full(t-1).", ":- do(push(_,_),t).").unwrap();
    let error = plan_with("easy-3", &domains).unwrap_err();
    assert!(matches!(&error, PlanError::NoPlan { file, .. } if file == "fine.lp"), "{error}");
    assert!(error.to_string().contains("push(\"b4\")"), "{error}");
}

#[test]
fn an_answer_without_a_meaning_is_shown() {
    let domains = edited("order.lp", "#show before/2.", "before(1,2). #show before/2.").unwrap();
    let error = plan_with("easy-1", &domains).unwrap_err();
    assert!(matches!(&error, PlanError::Answer { answer, .. } if answer == "1"), "{error}");

    let domains = edited("fine.lp", "action(fasten(C))", "action(glue(C))").unwrap();
    let error = plan_with("easy-1", &domains).unwrap_err();
    assert_eq!(error.to_string(), "fine.lp gave the answer `glue(\"C1\")`, which has no meaning here");
}

#[test]
fn what_is_not_modelled_yet_is_said() {
    let cases = [
        ("medium-2", "b8 would be put over b6 while an end of that droops"),
        ("medium-3", "b8 would be put over b1 while an end of that droops"),
        ("hard-3", "b8 would lie on the table"),
    ];
    for (name, words) in cases {
        let error = plan_with(name, domains()).unwrap_err();
        assert!(matches!(error, PlanError::NotModelled { .. }), "{error}");
        assert!(error.to_string().starts_with(name) && error.to_string().contains(words), "{error}");
    }
}

#[test]
fn a_beam_between_two_that_stand_cannot_be_placed() {
    let state = State { in_assembly: ["b5", "b8"].map(str::to_string).to_vec(), ..State::default() };
    let error = plan(&goal("easy-3"), kit(), &state, domains()).unwrap_err();
    assert!(matches!(error, PlanError::Illegal { .. }), "{error}");
    assert!(error.to_string().contains("b4 cannot enter both b7 and b8"), "{error}");
}

#[test]
fn a_beam_out_of_reach_is_named() {
    let mut assembly = goal("easy-1");
    let b5 = assembly.beam_index("b5").unwrap();
    assembly.beams[b5].beam.start.as_mut().unwrap().at = [1.5, 0.2];
    let error = plan(&assembly, kit(), &State::default(), domains()).unwrap_err();
    assert!(matches!(error, PlanError::Illegal { .. }), "{error}");
    assert!(error.to_string().contains("b5 has no link that the hand can hold"), "{error}");
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
        let error = plan(&goal("easy-3"), kit(), &state, domains()).unwrap_err();
        assert!(error.to_string().contains(words), "{error} does not say {words}");
    }
}

#[test]
fn too_few_pegs_are_counted() {
    let lost_pegs: Vec<String> = (1..=12).map(|number| format!("p{number}")).collect();
    let state = State { lost_pegs, ..State::default() };
    let error = plan(&goal("easy-3"), kit(), &state, domains()).unwrap_err();
    assert!(matches!(error, PlanError::Pegs { needed: 4, left: 3, .. }), "{error}");
}
