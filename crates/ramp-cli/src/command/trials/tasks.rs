//! The contact steps of a goal's plan, each as a task of its own.

use miette::{IntoDiagnostic, Report, miette};
use nalgebra::Vector3;
use ramp_assembly::Assembly;
use ramp_eval::manipulation::{Aim, Build, Task};
use ramp_kit::Kit;
use ramp_planner::{CoarseAction, CoarseStep, Domains, FineAction, Item, Plan, Replayer, State, plan};
use ramp_robot::random::Stream;

/// A goal with the contact steps of its plan.
pub struct Goal {
    pub assembly: Assembly,
    pub steps: Vec<Step>,
}

/// A contact step of a plan.
pub struct Step {
    pub task: Task,
    /// What stands before it, as the planner knows it.
    pub state: State,
    /// The piece of the plan that does it: from where the hand picks up what it needs.
    pub plan: Plan,
}

impl Goal {
    /// Plans the goal, and takes the plan apart.
    pub fn new(assembly: Assembly, kit: &Kit, domains: &Domains) -> Result<Goal, Report> {
        let plan = plan(&assembly, kit, &State::default(), domains).into_diagnostic()?;
        let coarse: Vec<CoarseAction> = plan.steps.iter().map(|step| step.coarse.clone()).collect();
        let mut steps = Vec::new();
        for (index, step) in plan.steps.iter().enumerate() {
            let Some((skill, aim)) = aim(&assembly, &plan, index) else { continue };
            // What is needed is picked up where nothing is in the hand: there the piece begins.
            let begin = match &aim {
                Aim::Held { .. } | Aim::Straight { .. } => index,
                Aim::Placed { .. } if matches!(step.coarse, CoarseAction::Slide { .. }) => index,
                _ => coarse[..index]
                    .iter()
                    .rposition(|action| matches!(action, CoarseAction::PickUp { .. }))
                    .ok_or_else(|| miette!("{}: step {} needs nothing", assembly.name, index + 1))?,
            };
            let mut table = Replayer::new(&assembly, kit, domains, &State::default()).into_diagnostic()?;
            table.carry_out(&coarse[..begin]).into_diagnostic()?;
            let state = table.state();
            steps.push(Step {
                task: Task {
                    skill,
                    step: index + 1,
                    action: step.coarse.to_string(),
                    build: build(&assembly, &plan, &state),
                    aim,
                },
                state,
                plan: Plan { steps: plan.steps[begin..=index].to_vec(), ..plan.clone() },
            });
        }
        Ok(Goal { assembly, steps })
    }
}

/// One of some steps, from the seed.
pub fn draw<T: Copy>(steps: &[T], seed: u64) -> Option<T> {
    let index = (Stream::new(seed, "step").uniform() * steps.len() as f64) as usize;
    steps.get(index).copied()
}

/// What a contact step's skill is called, and what it is to bring about; `None` for all other steps.
fn aim(assembly: &Assembly, plan: &Plan, index: usize) -> Option<(String, Aim)> {
    let contact = plan.steps[index].fine.iter().find(|action| {
        !matches!(action, FineAction::Move { .. } | FineAction::Regrasp { .. } | FineAction::PutDown { .. })
    })?;
    let beam = |name: &str| assembly.beam_index(name);
    let placed =
        |name: &str| Some(Aim::Placed { connections: closed(assembly, &plan.steps[index..], beam(name)?) });
    let (skill, aim) = match contact {
        FineAction::PickUp { item: Item::Peg(peg), .. } => ("pick-up-peg", Aim::Held { peg: peg.clone() }),
        FineAction::AssembleSquare { beam, .. } => ("assemble-square", placed(beam)?),
        FineAction::AssembleAngled { beam, .. } => ("assemble-angled", placed(beam)?),
        FineAction::AssembleThrough { beam, .. } => ("assemble-through", placed(beam)?),
        FineAction::AssembleCap { beam, .. } => ("assemble-cap", placed(beam)?),
        FineAction::Slide { beam, .. } => ("slide", placed(beam)?),
        FineAction::AssembleDeep { beam: name, .. } => {
            ("assemble-deep", Aim::Deep { beam: beam(name)?, shift: depth(plan, name)? })
        }
        FineAction::LayDown { beam: name } => ("lay-down", Aim::Laid { beam: beam(name)? }),
        FineAction::Push { beam: name, .. } => ("push", Aim::Straight { beam: beam(name)? }),
        FineAction::Fasten { connection, .. } => {
            let connection = assembly.connection_index(connection)?;
            let female = assembly.connections[connection].female;
            let kind = assembly.beams[female.beam].beam.joints[female.joint].kind;
            return Some((format!("fasten-{}", kind.name()), Aim::Pinned { connection }));
        }
        _ => return None,
    };
    Some((skill.to_string(), aim))
}

/// The connections of the beam that the first of some steps puts in, which pegs are then to pin as it has left them: the plan
/// pushes neither beam before.
fn closed(assembly: &Assembly, steps: &[CoarseStep], beam: usize) -> Vec<usize> {
    let pushed = |steps: &[CoarseStep], name: &str| {
        steps.iter().any(|step| matches!(&step.coarse, CoarseAction::Push { beam } if beam == name))
    };
    let brought = |steps: &[CoarseStep], name: &str| {
        steps.iter().any(|step| {
            matches!(
                &step.coarse,
                CoarseAction::Assemble { beam } | CoarseAction::AssembleDeep { beam }
                | CoarseAction::LayDown { beam } | CoarseAction::Slide { beam } if beam == name
            )
        })
    };
    let closed = |index: &usize| {
        let connection = &assembly.connections[*index];
        let Some((_, theirs)) = assembly.sides(connection, beam) else { return false };
        let pinned = steps.iter().position(
            |step| matches!(&step.coarse, CoarseAction::Fasten { connection: name, .. } if *name == connection.name),
        );
        let Some(before) = pinned.map(|end| &steps[1..end]) else { return false };
        let names = [beam, theirs.beam].map(|beam| assembly.beams[beam].beam.name.as_str());
        !brought(before, names[1]) && names.iter().all(|name| !pushed(before, name))
    };
    (0..assembly.connections.len()).filter(closed).collect()
}

/// How far from its place a beam stands that was put in too deep: axes of the assembly frame, m.
fn depth(plan: &Plan, beam: &str) -> Option<Vector3<f64>> {
    let entry = plan.entries.iter().find(|entry| entry.beam == beam)?;
    Some(Vector3::from(entry.direction) * entry.depth)
}

/// What stands, for the twin.
fn build(assembly: &Assembly, plan: &Plan, state: &State) -> Build {
    let index = |name: &String| assembly.beam_index(name);
    Build {
        standing: state.in_assembly.iter().filter_map(index).collect(),
        deep: state.deep.iter().filter_map(|name| Some((index(name)?, depth(plan, name)?))).collect(),
        crooked: state.misaligned.iter().filter_map(index).collect(),
        pinned: state
            .fastened
            .iter()
            .filter_map(|(name, peg)| Some((assembly.connection_index(name)?, peg.clone())))
            .collect(),
    }
}
