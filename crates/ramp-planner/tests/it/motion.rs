//! Motion facts change the plan, or are the reason why there is none.

use crate::common::{domains, goal, kit, replay};
use ramp_assembly::Assembly;
use ramp_planner::{
    CoarseAction, End, FineAction, Grasp, Impossible, InTheWay, Item, MotionFact, Plan, PlanError, State,
    plan, why,
};

fn fact(cannot: Impossible, past: Option<InTheWay>) -> MotionFact {
    MotionFact { cannot, past, because: "the arm would touch something".to_string() }
}

fn grasp(beam: &str, link: &str, at: End) -> Impossible {
    Impossible::Grasp { beam: beam.to_string(), link: link.to_string(), at }
}

fn insert(beam: &str, path: &str) -> Impossible {
    Impossible::Insert { beam: beam.to_string(), path: path.to_string() }
}

fn stands(beam: &str) -> Option<InTheWay> {
    Some(InTheWay::Stands(beam.to_string()))
}

/// A plan that respects the facts, and that the replayer accepts.
fn planned(assembly: &Assembly, motion: Vec<MotionFact>) -> Result<Plan, PlanError> {
    let state = State { motion, ..State::default() };
    let plan = plan(assembly, &state, domains())?;
    replay(assembly, &state, &plan.steps).unwrap();
    Ok(plan)
}

/// The number of the step that places a beam, or that fastens a connection.
fn step(plan: &Plan, name: &str) -> usize {
    let is = |action: &CoarseAction| match action {
        CoarseAction::Assemble { beam } | CoarseAction::LayDown { beam } => beam == name,
        CoarseAction::Fasten { connection, .. } => connection == name,
        _ => false,
    };
    plan.steps.iter().position(|step| is(&step.coarse)).unwrap()
}

/// The links at which a plan grasps a beam.
fn links(plan: &Plan, beam: &str) -> Vec<String> {
    let link = |action: &FineAction| match action {
        FineAction::PickUp { item: Item::Beam(other), grasp: Grasp::Link(link) } if other == beam => {
            Some(link.clone())
        }
        _ => None,
    };
    plan.fine().filter_map(link).collect()
}

#[test]
fn a_beam_is_held_by_another_link() {
    let assembly = goal("hard-1");
    assert_eq!(links(&planned(&assembly, Vec::new()).unwrap(), "b4"), ["b4l2"]);
    for at in [End::Start, End::Place] {
        let plan = planned(&assembly, vec![fact(grasp("b4", "b4l2", at), None)]).unwrap();
        assert_eq!(links(&plan, "b4"), ["b4l1"], "{at:?}");
    }
}

#[test]
fn a_beam_that_leaves_no_grasp_of_another_is_placed_after_it() {
    let assembly = goal("hard-1");
    let plan = planned(&assembly, Vec::new()).unwrap();
    assert!(step(&plan, "b1") < step(&plan, "b2"));
    let links = &kit().beam("b2").unwrap().links;
    let facts = links.iter().map(|link| fact(grasp("b2", &link.name, End::Place), stands("b1"))).collect();
    let plan = planned(&assembly, facts).unwrap();
    assert!(step(&plan, "b2") < step(&plan, "b1"));
}

#[test]
fn a_beam_that_closes_a_path_is_placed_later() {
    let assembly = goal("hard-1");
    let plan = planned(&assembly, vec![fact(insert("b2", "-Y"), stands("b1"))]).unwrap();
    assert!(step(&plan, "b2") < step(&plan, "b1"));
}

#[test]
fn a_beam_that_lies_in_a_path_is_placed_sooner() {
    let assembly = goal("hard-1");
    let past = Some(InTheWay::OnSheet("b3".to_string()));
    let plan = planned(&assembly, vec![fact(insert("b1", "-Y"), past)]).unwrap();
    assert!(step(&plan, "b3") < step(&plan, "b1"));
}

#[test]
fn what_hides_a_hole_is_placed_after_its_peg() {
    let assembly = goal("hard-1");
    let hidden = Impossible::Fasten { connection: "C7".to_string() };
    let state = State { motion: vec![fact(hidden, stands("b1"))], ..State::default() };
    let plan = planned(&assembly, state.motion.clone()).unwrap();
    assert!(step(&plan, "C7") < step(&plan, "b1"));
    // For an order that was fixed before, the error gives the reason.
    let stood = State { in_assembly: ["b4", "b9", "b5", "b1"].map(str::to_string).to_vec(), ..state };
    let error = ramp_planner::plan(&assembly, &stood, domains()).unwrap_err().to_string();
    assert!(
        error.contains("C7 cannot be fastened once b1 is placed: the arm would touch something"),
        "{error}"
    );
}

#[test]
fn the_laws_that_speak_of_motion_explain_an_action() {
    let assembly = goal("hard-1");
    let lies = |motion| State { motion, ..State::default() };
    let past = Some(InTheWay::OnSheet("b3".to_string()));
    let state = lies(vec![fact(insert("b1", "-Y"), past)]);
    let law = "impossible assemble(B) if -can_enter(B)";
    let last = |state: &State| {
        let explanation = why(&assembly, state, domains(), "assemble(b1)").unwrap();
        explanation.reasons.iter().filter(|reason| reason.law == law).map(|reason| reason.to).max()
    };
    // Until the step that picks b3 up.
    let picked = CoarseAction::PickUp { item: Item::Beam("b3".to_string()) };
    let plan = planned(&assembly, state.motion.clone()).unwrap();
    let picked = plan.steps.iter().position(|step| step.coarse == picked).unwrap() + 1;
    assert_eq!(last(&state), Some(picked));
    assert_eq!(last(&lies(Vec::new())), None);
}

#[test]
fn without_a_plan_the_reason_is_what_the_arm_cannot_do() {
    let assembly = goal("hard-1");
    for cannot in [insert("b1", "-Y"), Impossible::Fasten { connection: "C3".to_string() }] {
        let error = planned(&assembly, vec![fact(cannot.clone(), None)]).unwrap_err();
        assert!(matches!(error, PlanError::Motion { .. }), "{cannot:?}: {error}");
        assert!(error.to_string().contains("the arm would touch something"), "{error}");
    }
}

#[test]
fn names_of_facts_are_looked_up() {
    let assembly = goal("easy-3");
    for (cannot, words) in [
        (grasp("b44", "b4l1", End::Start), "the beam `b44`, which easy-3 does not have; did you mean `b4`?"),
        (grasp("b4", "b4l9", End::Start), "the link `b4l9`, which b4 does not have; did you mean `b4l1`?"),
        (insert("b4", "up"), "the path `up`, which b4 does not have"),
        (Impossible::Fasten { connection: "C9".to_string() }, "the connection `C9`"),
    ] {
        let error = planned(&assembly, vec![fact(cannot, None)]).unwrap_err().to_string();
        assert!(error.contains(words), "{error}");
    }
    let error = planned(&assembly, vec![fact(insert("b4", "-Y"), stands("b77"))]).unwrap_err().to_string();
    assert!(error.contains("the beam `b77`"), "{error}");
}
