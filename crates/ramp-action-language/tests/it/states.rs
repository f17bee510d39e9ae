//! A small domain: effects, consequences, inertia, and impossible actions.

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
    // The goal covers only rooms near the hall.
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
    // An action forbidden by a certain condition is not a choice.
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

/// A state after an action is computed incrementally. The same state must follow from its inertial
/// fluents alone, through negation, recursion, sums and laws between fluents.
#[test]
fn states_from_actions_are_those_from_nothing() {
    let laws = "
        sort room.
        static door(room, room).
        static floor(room, number).
        inertial fluent open(room, room).
        inertial fluent at(room).
        inertial fluent full(room).
        inertial fluent known(room).
        defined fluent way(room, room).
        defined fluent reached(room).
        defined fluent shut_in(room).
        defined fluent above(room).
        defined fluent pair(room, room).
        action go(room).
        action toggle(room, room).
        action fill(room).
        go(R) causes at(R), known(R).
        toggle(R, S) causes open(R, S) if -open(R, S).
        toggle(R, S) causes -open(R, S) if open(R, S).
        impossible toggle(R, S) if -door(R, S).
        fill(R) causes full(R).
        fill(R) causes -full(S) if at(S).
        impossible fill(R) if at(R).
        -at(R) if at(S), R != S.
        -known(R) if full(R).
        -full(R) if known(R).
        way(R, S) if open(R, S), -full(S).
        way(R, S) if open(S, R), -full(S).
        reached(R) if at(R).
        reached(S) if reached(R), way(R, S).
        shut_in(R) if at(R), -way(R, \"b\"), -way(R, \"d\").
        above(R) if floor(R, N + 1), floor(S, N), reached(S), -full(R).
        pair(R, S) if full(R), full(S), -shut_in(R), R < S.
    ";
    let domain = Domain::new(&SourceFile::new("rooms.al", laws), None).unwrap();
    let names = ["a", "b", "c", "d", "e"];
    let mut facts: Vec<Term> = names.iter().map(|name| Term::new("room", [room(name)])).collect();
    let mut actions: Vec<Term> =
        names.iter().flat_map(|name| [about("go", name), about("fill", name)]).collect();
    for (index, name) in names.iter().enumerate() {
        facts.push(Term::new("floor", [room(name), (index / 2).into()]));
        for other in names.iter().skip(index + 1) {
            facts.push(Term::new("door", [room(name), room(other)]));
            actions.push(Term::new("toggle", [room(name), room(other)]));
        }
    }
    let model = Model::new(&domain, &facts);
    let mut state = model.initial(&[about("at", "a")], &[]).unwrap();
    let (mut draw, mut seen) = (1usize, std::collections::BTreeSet::new());
    for _ in 0..2000 {
        // Knuth's constants of a linear congruential generator (MMIX).
        draw = draw.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        let action = &actions[(draw >> 33) % actions.len()];
        match model.after(&state, action) {
            Ok(after) => state = after,
            Err(Refusal::Impossible(_)) => continue,
            Err(refusal) => panic!("{action}: {refusal:?}"),
        }
        assert_eq!(state, model.resumed(&model.inertial(&state)).unwrap(), "after {action}");
        for fluent in ["reached", "shut_in", "above", "pair"] {
            seen.insert((fluent, model.true_of(&state, fluent).len().min(1)));
        }
    }
    // Each was true at times and false at others; the room of the hand is always reached.
    assert_eq!(seen.len(), 7, "{seen:?}");
}
