//! A plan that the arm cannot carry out is changed before anything moves, and for the true reason.

use std::path::{Path, PathBuf};

use nalgebra::Point3;
use ramp_assembly::Assembly;
use ramp_kit::Kit;
use ramp_motion::{Checker, Joints, Pace, PathPlanner, Terms, TimeLaw};
use ramp_planner::{CoarseAction, Domains, FineAction, Grasp, PlanError, Replayer, State};
use ramp_robot::arm::ArmModel;
use ramp_robot::random::Stream;
use ramp_skills::grasp::point_on;
use ramp_skills::rehearsal::{Rehearsal, Rehearsed, plan_for_arm, quicker_for_arm};
use ramp_skills::{Parameters, Pose};

struct Data {
    kit: Kit,
    domains: Domains,
    arm: ArmModel,
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn data() -> Data {
    let data = root().join("data");
    Data {
        kit: ramp_kit::read_kit(&data.join("kit.xml")).unwrap(),
        domains: Domains::read(&data.join("domains")).unwrap(),
        arm: ArmModel::read(&data.join("arms/panda.json")).unwrap(),
    }
}

impl Data {
    /// A goal of the tests.
    fn goal(&self, name: &str) -> Assembly {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/goals");
        ramp_assembly::read_goal(&folder.join(format!("{name}.xml")), &self.kit).unwrap()
    }

    fn rehearsed(&self, goal: &Assembly) -> Result<Rehearsed, PlanError> {
        plan_for_arm(goal, &self.arm, &State::default(), &self.domains)
    }
}

#[test]
fn the_nine_goals_need_no_other_plan() {
    let data = data();
    for name in
        ["easy-1", "easy-2", "easy-3", "medium-1", "medium-2", "medium-3", "hard-1", "hard-2", "hard-3"]
    {
        let goal =
            ramp_assembly::read_goal(&root().join(format!("data/goals/{name}.xml")), &data.kit).unwrap();
        let rehearsed = data.rehearsed(&goal).unwrap();
        assert!(rehearsed.facts.is_empty(), "{name}: {:?}", rehearsed.facts);
        let plan = ramp_planner::plan(&goal, &State::default(), &data.domains).unwrap();
        assert_eq!(rehearsed.plan.steps, plan.steps, "{name}");
    }
}

/// The motions that a goal asks of the Panda, between the beams and pegs of that goal, with what they carry:
/// an arm of another maker finds them, too, and none of them leads it into itself.
#[test]
fn a_ur5e_finds_its_way_among_the_beams_of_a_goal() {
    let data = data();
    let arm: ArmModel<6> = ArmModel::read(&root().join("data/arms/ur5e.json")).unwrap();
    let goal = ramp_assembly::read_goal(&root().join("data/goals/medium-2.xml"), &data.kit).unwrap();
    let plan = ramp_planner::plan(&goal, &State::default(), &data.domains).unwrap();
    let (panda, planner) = (PathPlanner::new(&data.arm), PathPlanner::new(&arm));
    let parameters = Parameters::baseline();
    let rehearsal = Rehearsal::of_baseline(&goal, &data.arm, &panda, &State::default());
    let legs = rehearsal.legs(&plan);
    assert!(legs.len() > 15 && legs.iter().any(|leg| !leg.held.is_empty()));
    let law = TimeLaw::new(&arm, &Pace { velocity: 1.0, acceleration: 1.0, jerk: 1.0, ramp: 0.0 });
    let mut stream = Stream::new(1, "legs");
    for (number, leg) in legs.iter().enumerate() {
        let travel = &parameters.travel;
        let checker = Checker::new(&arm, leg.open, leg.held.clone(), &leg.around, travel.margin);
        let terms = Terms { height: travel.height, level: leg.level, checker: &checker, law: &law };
        let start = panda.kinematics.tip(&leg.q);
        let q = planner.solve(&start, &Joints::from(arm.home)).unwrap();
        let motion = planner.plan(&q, &leg.x_wt, &terms, &mut stream);
        let motion = motion.unwrap_or_else(|error| panic!("leg {number}: {error}"));
        let reached = planner.kinematics.tip(&motion.end());
        assert!((reached.translation.vector - leg.x_wt.translation.vector).norm() < 1e-5);
        for q in motion.samples() {
            assert_eq!(checker.touched(&planner.kinematics.frames(q)), None, "leg {number}");
        }
    }
}

/// Of the plans with as few actions, one is taken whose motions are shorter; and never one whose motions are
/// longer.
#[test]
fn pegs_are_exchanged_for_shorter_motions() {
    let (data, state) = (data(), State::default());
    for (name, least) in
        [("easy-1", 0.0), ("medium-3", 0.02), ("hard-1", 0.02), ("hard-2", 0.03), ("hard-3", 0.0)]
    {
        let goal =
            ramp_assembly::read_goal(&root().join(format!("data/goals/{name}.xml")), &data.kit).unwrap();
        let usual = ramp_planner::plan(&goal, &state, &data.domains).unwrap();
        let found = quicker_for_arm(&goal, &data.arm, &state, &data.domains, &usual).unwrap();
        assert!(
            found.seconds <= (1.0 - least) * found.before,
            "{name}: {} s, usually {} s",
            found.seconds,
            found.before
        );
        assert_eq!(found.plan.steps.len(), usual.steps.len(), "{name}");
        let mut table = Replayer::new(&goal, &data.domains, &state).unwrap();
        assert_eq!(table.run(&found.plan.steps), Ok(()), "{name}");
        // The time that is told is that of the plan.
        let planner = PathPlanner::new(&data.arm);
        let rehearsal = Rehearsal::of_baseline(&goal, &data.arm, &planner, &state);
        assert_eq!(rehearsal.seconds(&found.plan).unwrap(), found.seconds, "{name}");
    }
}

#[test]
fn a_plan_that_fails_for_motion_is_changed() {
    let data = data();
    let planner = PathPlanner::new(&data.arm);
    for (name, expected) in [
        ("medium-5-beams-2005", "b4 cannot be inserted along the path +X: the arm would touch b5"),
        (
            "medium-6-beams-2049",
            "b9 cannot be inserted along the path +X while b5 is at its start pose: the arm would touch b5",
        ),
        ("hard-6-beams-1016", "b4 cannot be inserted along the path +X: the arm would touch b5"),
        ("hard-6-beams-1027", "b4 cannot be inserted along the path +X: the arm would touch b5"),
        ("medium-6-beams-1039", "b4 cannot be inserted along the path +X: the arm would touch b5"),
    ] {
        let goal = data.goal(name);
        let state = State::default();
        let first = ramp_planner::plan(&goal, &state, &data.domains).unwrap();
        let rehearse = || Rehearsal::of_baseline(&goal, &data.arm, &planner, &state);
        assert_eq!(rehearse().check(&first).unwrap_err().to_string(), expected, "{name}");
        let rehearsed = data.rehearsed(&goal).unwrap();
        let facts: Vec<String> = rehearsed.facts.iter().map(ToString::to_string).collect();
        assert_eq!(facts, [expected], "{name}");
        assert!(rehearse().check(&rehearsed.plan).is_ok(), "{name}");
        let pegs = |plan: &ramp_planner::Plan| {
            plan.steps.iter().filter(|step| matches!(step.coarse, CoarseAction::Fasten { .. })).count()
        };
        assert_eq!(pegs(&rehearsed.plan), pegs(&first), "{name}");
    }
}

#[test]
fn a_place_that_only_another_grasp_reaches_is_reached() {
    let data = data();
    let goal = ramp_assembly::read_goal(&root().join("data/goals/easy-1.xml"), &data.kit).unwrap();
    let planner = PathPlanner::new(&data.arm);
    let state = State::default();
    let plan = ramp_planner::plan(&goal, &state, &data.domains).unwrap();
    let b4 = &goal.beams[goal.beam_index("b4").unwrap()];
    // A peg that stands beside the place of the beam, where a finger of the usual grasp would come down.
    let link = plan.fine().find_map(|action| match action {
        FineAction::PickUp { grasp: Grasp::Link(name), .. } => {
            b4.beam.links.iter().find(|link| link.name == *name)
        }
        _ => None,
    });
    let usual = point_on(link.unwrap(), b4.beam.span() / 2.0, &Parameters::baseline().grip);
    let beside = data.kit.x_wa() * b4.x_ab * Point3::new(usual, 0.045, 0.0);
    let x_wp = Pose::translation(beside.x, beside.y, 0.05);
    let rehearsal = Rehearsal::of_baseline(&goal, &data.arm, &planner, &state);
    let grasps =
        rehearsal.from_here([("p9".to_string(), x_wp)], data.arm.home.into(), 1).check(&plan).unwrap().grasps;
    assert!(grasps["b4"].because.contains("would touch p9"), "{}", grasps["b4"].because);
}

#[test]
fn without_a_plan_the_reason_is_told() {
    let data = data();
    let error = data.rehearsed(&data.goal("medium-5-beams-1008")).unwrap_err().to_string();
    assert!(error.contains("cannot be inserted along the path +X: the arm would touch b5"), "{error}");
}
