//! A small domain carried out: effects, what follows, what stays, and what is forbidden.

// A helper may panic as its test may.
#![allow(clippy::unwrap_used)]

use ramp_action_language::{Domain, Model, Prospect, Refusal, SourceFile, State, Term, Unrolled};

const ROOMS: &str = "
    sort room.
    static door(room, room).
    static near(room, room).
    inertial fluent at(room).
    inertial fluent lit(room).
    defined fluent dark(room).
    action go(room).
    action switch(room).
    exogenous action blackout.
    near(R, S) if door(R, S).
    near(R, S) if near(S, R).
    go(R) causes at(R).
    -at(R) if at(S), R != S.
    switch(R) causes lit(R) if -lit(R).
    switch(R) causes -lit(R) if lit(R).
    blackout causes -lit(R).
    dark(R) if at(R), -lit(R).
    impossible go(R) if at(S), -near(R, S).
    impossible switch(R) if -at(R).
    initially lit(\"hall\").
    goal lit(R) if near(R, \"hall\").
";

fn domain() -> Domain {
    Domain::new(&SourceFile::new("rooms.al", ROOMS), None).unwrap()
}

fn room(name: &str) -> Term {
    Term::from(name)
}

fn facts() -> Vec<Term> {
    let mut facts: Vec<Term> =
        ["hall", "kitchen", "attic"].map(|name| Term::new("room", [room(name)])).into();
    facts.push(Term::new("door", [room("hall"), room("kitchen")]));
    facts
}

fn about(fluent: &str, name: &str) -> Term {
    Term::new(fluent, [room(name)])
}

fn truths(model: &Model, state: &State) -> Vec<String> {
    model.inertial(state).iter().map(Term::to_string).collect()
}

#[test]
fn effects_follow_and_the_rest_stays() {
    let domain = domain();
    let model = Model::new(&domain, &facts());
    let start = model.initial(&[about("at", "hall")], &[]).unwrap();
    assert_eq!(truths(&model, &start), ["at(\"hall\")", "lit(\"hall\")"]);
    let after = model.after(&start, &about("go", "kitchen")).unwrap();
    assert_eq!(truths(&model, &after), ["at(\"kitchen\")", "lit(\"hall\")"]);
    assert!(model.holds(&after, &about("dark", "kitchen")));
    assert_eq!(model.gained(&start, &after), [about("at", "kitchen")]);
    // The goal is about rooms near the hall alone.
    assert_eq!(model.missing(&after), [(about("lit", "kitchen"), true)]);
    let lit = model.after(&after, &about("switch", "kitchen")).unwrap();
    assert!(model.missing(&lit).is_empty());
}

#[test]
fn what_is_forbidden_has_its_law_and_line() {
    let domain = domain();
    let model = Model::new(&domain, &facts());
    let start = model.initial(&[about("at", "hall")], &[]).unwrap();
    let refused = model.after(&start, &about("go", "attic")).unwrap_err();
    let Refusal::Impossible(reason) = refused else { panic!("{refused:?}") };
    assert_eq!((reason.line, reason.law.as_str()), (19, "impossible go(R) if at(S), -near(R, S)"));
    assert_eq!(reason.conditions, ["at(\"hall\")", "-near(\"attic\",\"hall\")"]);
    assert_eq!(
        model.after(&start, &about("fly", "attic")),
        Err(Refusal::Unknown("fly(\"attic\")".to_string()))
    );
}

#[test]
fn unrolled_a_goal_is_out_of_reach_until_actions_can_reach_it() {
    let domain = domain();
    let model = Model::new(&domain, &facts());
    let start = model.initial(&[about("at", "hall")], &[]).unwrap();
    let mut unrolled = Unrolled::new(&model, start);
    let goal = about("lit", "kitchen");
    for time in 0..=2 {
        let prospect = unrolled.prospect(&goal, true);
        assert_eq!(matches!(prospect, Prospect::If(_)), time == 2, "at time {time}");
        assert!(unrolled.advance());
    }
    // What a certain condition forbids is no choice.
    let first: Vec<String> = unrolled.choices()[0].iter().map(|(action, _)| action.to_string()).collect();
    assert_eq!(first, ["go(\"kitchen\")", "switch(\"hall\")"]);
}

#[test]
fn the_program_says_the_same_to_clingo() {
    let program = domain().to_asp();
    for line in [
        "near(R,S) :- near(S,R).",
        "holds(at(R),t) :- occurs(go(R),t).",
        "-holds(at(R),t) :- holds(at(S),t), R != S, room(R).",
        "impossible(go(R),t) :- holds(at(S),t-1), not near(R,S), room(R).",
        "event(blackout).",
    ] {
        assert!(program.contains(line), "{line} is not in\n{program}");
    }
}
