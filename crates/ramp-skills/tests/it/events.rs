//! Actions and limits of the arm as events report them.

use ramp_planner::{Area, End, FineAction, Grasp, Impossible, InTheWay, Item, MotionFact, Place, Target};
use ramp_robot::{Action, EventKind};

/// Events have the text of the planner, made from their data alone.
#[test]
fn an_action_and_a_motion_fact_read_in_an_event_as_in_a_plan() {
    let [beam, joint, link] = ["b4", "b4j1", "b4l2"].map(|name| move || name.to_string());
    let areas = [Area::Input, Area::Intermediate, Area::Assembly].map(Place::Above);
    let places = [
        Place::Input(Item::Peg("p1".into())),
        Place::Approach(Target::Connection("C1".into())),
        Place::Target(Target::Beam(beam())),
    ];
    let moves = areas.into_iter().chain(places).map(|to| FineAction::Move { to });
    let mut actions: Vec<FineAction> = moves.collect();
    actions.extend([
        FineAction::PickUp { item: Item::Beam(beam()), grasp: Grasp::Link(link()) },
        FineAction::PickUp { item: Item::Peg("p1".into()), grasp: Grasp::Head },
        FineAction::PutDown { item: Item::Beam(beam()) },
        FineAction::AssembleSquare { beam: beam(), joint: joint() },
        FineAction::AssembleAngled { beam: beam(), joint: joint() },
        FineAction::AssembleThrough { beam: beam(), joint: joint(), through: vec![joint(), "b4j2".into()] },
        FineAction::AssembleDeep { beam: beam(), joint: joint() },
        FineAction::AssembleCap { beam: beam(), joints: vec![joint(), "b4j2".into()] },
        FineAction::LayDown { beam: beam() },
        FineAction::Slide { beam: beam(), link: link() },
        FineAction::Regrasp { beam: beam(), link: link() },
        FineAction::Push { beam: beam(), link: link() },
        FineAction::TakeOut { beam: beam(), link: link() },
        FineAction::PullOut { connection: "C1".into(), peg: "p1".into() },
        FineAction::SlideBack { beam: beam(), link: link() },
        FineAction::Fasten {
            connection: "C1".into(),
            female: "b7j1".into(),
            male: joint(),
            peg: "p1".into(),
        },
    ]);
    for action in &actions {
        assert_eq!(Action::of(action).to_string(), action.to_string());
    }
    let fact = |cannot, past| MotionFact { cannot, past, because: "the fingers would touch b3".into() };
    for fact in [
        fact(Impossible::Grasp { beam: beam(), link: link(), at: End::Start }, None),
        fact(
            Impossible::Grasp { beam: beam(), link: link(), at: End::Place },
            Some(InTheWay::Stands("b3".into())),
        ),
        fact(Impossible::Insert { beam: beam(), path: "x".into() }, Some(InTheWay::OnSheet("b3".into()))),
        fact(Impossible::Fasten { connection: "C1".into() }, None),
    ] {
        let event = EventKind::motion(&fact);
        assert_eq!((event.name(), event.to_string()), ("motion", fact.to_string()));
    }
}
