//! Notes at the head of a report.

use ramp_assembly::Class;
use ramp_result::collection::Collection;

/// Repeats of each goal that the protocol asks for, by class: five, and one in the open class, which has many
/// goals instead.
pub fn repeats(class: Option<&str>) -> u64 {
    if class.and_then(Class::of_name).is_some_and(Class::is_open) { 1 } else { 5 }
}

/// Deviations of the results from the protocol.
pub(super) fn notes(collection: &Collection) -> Vec<String> {
    let mut notes = collection.notes.clone();
    for entrant in &collection.entrants {
        let name = format!("{} on track {}", entrant.label, entrant.identity.track);
        for goal in &collection.goals {
            let mut seeds: Vec<u64> = entrant
                .files
                .iter()
                .filter(|file| file.result.goal == goal.name)
                .map(|file| file.result.seed)
                .chain(entrant.lost.iter().filter(|lost| lost.goal == goal.name).map(|lost| lost.seed))
                .collect();
            seeds.sort_unstable();
            let repeats = repeats(goal.class.as_deref());
            if !seeds.is_empty() && seeds != (1..=repeats).collect::<Vec<u64>>() {
                // A real robot has no seeds, but numbers its repeats.
                let noun = if entrant.identity.real.is_some() { "repeat" } else { "seed" };
                let many = if seeds.len() == 1 { "" } else { "s" };
                let seeds: Vec<String> = seeds.iter().map(u64::to_string).collect();
                notes.push(format!(
                    "{name}: {} was run with {noun}{many} {}, the protocol asks for {noun}{}",
                    goal.name,
                    seeds.join(", "),
                    if repeats == 1 { " 1".to_string() } else { format!("s 1 to {repeats}") }
                ));
            }
        }
        if !entrant.lost.is_empty() {
            notes.push(format!(
                "{name}: {} without a result (crashed, killed or out of time); each counts as an episode without pegs",
                match entrant.lost.len() {
                    1 => "1 episode is".to_string(),
                    count => format!("{count} episodes are"),
                }
            ));
        }
        let mut hosts: Vec<String> = entrant.files.iter().map(|file| file.result.host.cpu.clone()).collect();
        hosts.sort();
        hosts.dedup();
        if hosts.len() > 1 {
            notes.push(format!(
                "{name}: run on different computers ({}); planning and compute time are not those of one",
                hosts.join("; ")
            ));
        }
    }
    let mut software: Vec<String> = collection
        .entrants
        .iter()
        .map(|it| format!("ramp {} ({})", it.identity.version, it.identity.commit))
        .collect();
    software.sort();
    software.dedup();
    if software.len() > 1 {
        notes.push(format!(
            "results of different versions of the software stand side by side ({}); they are not added up, and a \
             difference between them may be that of the software",
            software.join("; ")
        ));
    }
    let twin = collection.entrants.iter().any(|it| it.identity.real.is_none());
    if twin && collection.entrants.iter().any(|it| it.identity.real.is_some()) {
        notes.push(
            "real robots and the twin stand side by side; a repeat of one is paired with the seed of the other, which \
             have nothing in common but the goal"
                .to_string(),
        );
    }
    if twin && !collection.published.is_empty() {
        notes.push("published figures are of real robots, and others here of the twin".to_string());
    }
    notes
}
