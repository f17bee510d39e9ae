//! The coarse level in PDDL, and plans that are read back.

use crate::common::{EASY, domains, goal, kit, replay};
use ramp_planner::{CoarseAction, Item, PlanError, State, pddl, pddl_plan, plan};

/// Our own plan, in the format of a PDDL planner.
pub(crate) fn as_pddl(name: &str) -> String {
    let steps = plan(&goal(name), &State::default(), domains()).unwrap().steps;
    let assembly = goal(name);
    let connection = |peg: &str| {
        let pinned = steps.iter().find_map(|step| match &step.coarse {
            CoarseAction::Fasten { connection, peg: other } if other == peg => {
                Some(connection.to_lowercase())
            }
            _ => None,
        });
        pinned.unwrap()
    };
    let mut text = String::from("; a plan\n");
    for step in &steps {
        let line = match &step.coarse {
            CoarseAction::Move { to } => format!("(move {})", format!("{to:?}").to_lowercase()),
            CoarseAction::PickUp { item: Item::Beam(beam) } => format!("(pick_up {beam})"),
            CoarseAction::PickUp { item: Item::Peg(peg) } => format!("(pick_up {})", connection(peg)),
            CoarseAction::Assemble { beam } => format!("(assemble {beam})"),
            CoarseAction::Fasten { connection, .. } => format!("(FASTEN {connection})"),
            CoarseAction::Push { beam } => format!("0.5: (push {beam}) [1.0]"),
            other => panic!("{other} is not in {}", assembly.name),
        };
        text.push_str(&line);
        text.push('\n');
    }
    text
}

#[test]
fn a_plan_from_outside_is_judged_and_refined() {
    for name in EASY {
        let assembly = goal(name);
        let text = as_pddl(name);
        let steps = pddl_plan(&assembly, &State::default(), domains(), &text).unwrap();
        assert_eq!(replay(&assembly, &State::default(), &steps), Ok(()));
        assert!(steps.iter().all(|step| !step.fine.is_empty()));
        // Without one of its lines it is refused, and the error names the step.
        let lines: Vec<&str> = text.lines().collect();
        for left_out in 1..lines.len() {
            let mut fewer = lines.clone();
            fewer.remove(left_out);
            let outcome = pddl_plan(&assembly, &State::default(), domains(), &fewer.join("\n"));
            assert!(matches!(outcome, Err(PlanError::Outside(_))), "{name} without {}", lines[left_out]);
        }
    }
}

#[test]
fn a_line_that_is_no_action_is_told_with_its_number() {
    let assembly = goal("easy-1");
    for (line, words) in [
        ("move input", "expected `(action object …)`"),
        ("(jump b4)", "no action `jump`"),
        ("(push b77)", "`b77` is not of the sort `beam`"),
        ("(push b4 b5)", "`push` has 1 arguments"),
        ("(push)", "`push` has 1 arguments"),
    ] {
        let text = format!("; first\n\n{line}\n");
        let error = pddl_plan(&assembly, &State::default(), domains(), &text).unwrap_err();
        let told = error.to_string();
        assert!(told.starts_with("line 3: ") && told.contains(words), "{told}");
    }
}

#[test]
fn what_is_written_says_what_stands_and_has_no_two_objects_of_one_name() {
    let state = State {
        in_assembly: vec!["b4".to_string()],
        fastened: vec![("C1".to_string(), "p1".to_string())],
        ..State::default()
    };
    let written = pddl(&goal("easy-1"), &state, domains()).unwrap();
    assert!(written.problem.contains("(in_assembly b4)") && written.problem.contains("(pinned c1)"));
    assert!(!written.problem.contains("(on_sheet c1)"));
    // Balanced parentheses, which every planner requires.
    for text in [&written.domain, &written.problem] {
        assert_eq!(text.matches('(').count(), text.matches(')').count());
    }
    // Columns of a frame are called c1, like the PDDL name of the connection C1.
    let made =
        ramp_assembly::generate(kit(), ramp_assembly::Request { beams: 12, seed: 1, class: None }).unwrap();
    let written = pddl(&made.assembly, &State::default(), domains()).unwrap();
    assert!(written.problem.contains(" c1_2"), "{}", written.problem);
}

/// Connections named like a beam, a way and a word of PDDL are objects of their own, and come back from
/// a plan as what they are.
#[test]
fn objects_of_one_name_get_names_of_their_own() {
    let text = std::fs::read_to_string("../../data/goals/easy-1.xml").unwrap();
    let text = text.replace("\"C1\"", "\"b4\"").replace("\"C2\"", "\"down\"").replace("\"C3\"", "\"not\"");
    let file = ramp_kit::source::SourceFile::new("clash.xml", &text);
    let assembly = ramp_assembly::read_goal_file(&file, kit()).unwrap();
    let written = pddl(&assembly, &State::default(), domains()).unwrap();
    // The declarations of both files: each name once.
    let mut declared: Vec<&str> = Vec::new();
    for line in written.problem.lines().chain(written.domain.lines()) {
        if let Some((names, _)) =
            line.trim_start_matches("(:constants").split_once(" - ").filter(|_| !line.contains('?'))
        {
            declared.extend(names.split_whitespace().filter(|name| !name.starts_with('(')));
        }
    }
    let objects = declared.iter().filter(|name| ["b4", "down", "not"].contains(name)).count();
    assert!(objects <= 2, "{}", written.problem);
    // The connection keeps `down`, and the way has another name.
    for name in ["b4_2", "not_2", "(joins down b5 b7)", "(entry b5 down_2)"] {
        assert!(written.problem.contains(name), "{}", written.problem);
    }
    // Our own plan with these names is accepted, and pins the connections of the goal.
    let names = |name: &str| {
        match name {
            "c1" => "b4_2",
            "c2" => "down",
            "c3" => "not_2",
            other => other,
        }
        .to_string()
    };
    let text: Vec<String> = as_pddl("easy-1")
        .lines()
        .map(|line| {
            let words = line.split_inclusive([' ', ')']);
            let rename = |word: &str| {
                let end = word.len() - word.trim_end_matches([' ', ')']).len();
                let (name, tail) = word.split_at(word.len() - end);
                names(&name.to_lowercase()) + tail
            };
            words.map(rename).collect()
        })
        .collect();
    let steps = pddl_plan(&assembly, &State::default(), domains(), &text.join("\n")).unwrap();
    let pinned: Vec<&str> = steps
        .iter()
        .filter_map(|step| match &step.coarse {
            CoarseAction::Fasten { connection, .. } => Some(connection.as_str()),
            _ => None,
        })
        .collect();
    assert_eq!(pinned, ["b4", "down", "not"]);
}
