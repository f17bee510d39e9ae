//! Episodes with an injected fault: checks whether the agent diagnosed it and still built the goal.
//!
//! An agent names the cause by an event of the kind `diagnosis`. The right causes of each fault are in
//! [`accepted`].
//!
//! Beams jam now and then without a fault. So an episode is compared with its control, the same goal from the
//! same seed without the fault: events that the agent reports there too are not attributed to the fault.

use ramp_robot::{Cause, Event, EventKind};
use ramp_twin::FaultKind;
use serde::Serialize;
use serde_json::Value;

use ramp_result::episode::EpisodeResult;
use ramp_result::statistics::{Interval, wilson};

/// The causes that are correct for a fault: its own, and those that cannot be distinguished from it by what a
/// robot senses.
pub fn accepted(kind: FaultKind) -> &'static [Cause] {
    match kind {
        FaultKind::PegDropped => &[Cause::PartLost],
        FaultKind::PegTilted | FaultKind::BeamSlipped | FaultKind::BeamTurned => &[Cause::GripMoved],
        FaultKind::BeamBumped => &[Cause::BeamMoved],
        FaultKind::HolderShifted => &[Cause::HolderMoved],
        FaultKind::Jam => &[Cause::Jam],
        FaultKind::PegMissing => &[Cause::PartMissing],
        FaultKind::TagCovered | FaultKind::CameraFrozen => &[Cause::Sight],
        // A grip that lets a part stay behind looks like one that lost it.
        FaultKind::GripperWeak => &[Cause::GripWeak, Cause::PartLost],
        FaultKind::ForceDrift => &[Cause::ForceBias],
    }
}

/// Fields of events that are text for a person.
const PROSE: [&str; 4] = ["evidence", "because", "why", "text"];

/// An event without its numbers and without text for a person: its kind, its cause and the parts in it.
/// Events of two episodes are the same when this is.
fn gist(event: &Event) -> Value {
    let mut value = serde_json::to_value(&event.kind).unwrap_or_default();
    if let Some(fields) = value.as_object_mut() {
        fields.retain(|name, field| !PROSE.contains(&name.as_str()) && !field.is_number());
    }
    value
}

/// The outcome of an episode in which a fault struck.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Judgement {
    /// The cause in the first diagnosis after the strike that is not in the control as well.
    pub told: Option<Cause>,
    /// True if that is correct.
    pub diagnosed: bool,
    /// All pegs of the goal count at the end.
    pub recovered: bool,
    /// True if the agent reported a fault or re-planned after the injection, but not in the control episode.
    pub repaired: bool,
}

impl Judgement {
    /// The goal was built, nothing was diagnosed and nothing had to be repaired.
    pub fn harmless(&self) -> bool {
        self.recovered && self.told.is_none() && !self.repaired
    }
}

/// Judges an episode beside its control, if there is one; `None` when it had no fault or its occasion did not
/// come.
pub fn judge(result: &EpisodeResult, control: Option<&EpisodeResult>) -> Option<Judgement> {
    let fault = result.fault.as_ref()?;
    let struck = fault.at?;
    let kind = FaultKind::ALL.into_iter().find(|kind| kind.name() == fault.kind)?;
    // Each event of the control stands for one.
    let mut ordinary: Vec<Value> = control.iter().flat_map(|it| &it.events).map(gist).collect();
    let mut events: Vec<&Event> = result.events.iter().collect();
    events.retain(|event| {
        let known = ordinary.iter().position(|it| *it == gist(event));
        known.is_none_or(|known| {
            ordinary.swap_remove(known);
            false
        })
    });
    let mut after = events.iter().filter(|event| event.time >= struck).map(|event| &event.kind);
    let told = after.clone().find_map(|event| match event {
        EventKind::Diagnosis { cause, .. } => Some(*cause),
        _ => None,
    });
    let repaired = after.any(|event| matches!(event, EventKind::Fault(_) | EventKind::Replan { .. }));
    let diagnosed = told.is_some_and(|cause| accepted(kind).contains(&cause));
    Some(Judgement { told, diagnosed, recovered: result.counted() == result.pegs.len(), repaired })
}

/// A share with its interval.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Share {
    /// The number of episodes.
    pub hits: usize,
    /// Of how many.
    pub count: usize,
    /// Wilson's interval of 95 %.
    pub interval: Interval,
}

impl Share {
    fn of(hits: usize, count: usize) -> Share {
        Share { hits, count, interval: wilson(hits, count) }
    }
}

/// Episodes with one kind of fault, counted.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Tally {
    /// Episodes asked for.
    pub episodes: usize,
    /// Episodes without a result.
    pub lost: usize,
    /// Episodes in which the fault was triggered.
    pub struck: usize,
    /// Of these, the episodes without a diagnosis or a repair.
    pub harmless: usize,
    /// Diagnosed rightly, of those struck that were not harmless.
    pub diagnosed: Share,
    /// Complete at the end, of those struck.
    pub recovered: Share,
}

impl Tally {
    /// Counts episodes, each with its control; `None` stands for one without a result.
    pub fn of<'r>(results: impl Iterator<Item = [Option<&'r EpisodeResult>; 2]>) -> Tally {
        let (mut episodes, mut lost) = (0, 0);
        let mut judged: Vec<Judgement> = Vec::new();
        for [result, control] in results {
            episodes += 1;
            lost += usize::from(result.is_none());
            judged.extend(result.and_then(|result| judge(result, control)));
        }
        let count = |wanted: fn(&Judgement) -> bool| judged.iter().filter(|it| wanted(it)).count();
        let harmless = count(Judgement::harmless);
        Tally {
            episodes,
            lost,
            struck: judged.len(),
            harmless,
            diagnosed: Share::of(count(|it| it.diagnosed), judged.len() - harmless),
            recovered: Share::of(count(|it| it.recovered), judged.len()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ramp_result::episode::FaultInfo;
    use ramp_result::testing::episode;
    use ramp_robot::Fault;

    /// A diagnosis in the words of `CAUSE: PART evidence`.
    fn diagnosis(words: &str) -> EventKind {
        let (cause, evidence) = words.split_once(": ").unwrap();
        let part = evidence.split(' ').next().map(str::to_string);
        EventKind::Diagnosis { cause: Cause::named(cause).unwrap(), part, evidence: evidence.to_string() }
    }

    fn struck(kind: FaultKind, at: Option<f64>, seated: &[f64], told: &[(f64, &str)]) -> EpisodeResult {
        let mut result = episode("easy-1", 1, seated, 3);
        let name = kind.name().to_string();
        result.fault =
            Some(FaultInfo { kind: name, occasion: 1, at, part: None, size: None, text: String::new() });
        result.events = told.iter().map(|(t, words)| Event::new(*t, diagnosis(words))).collect();
        result
    }

    const ALL: &[f64] = &[1.0, 2.0, 3.0];

    #[test]
    fn the_first_diagnosis_after_the_strike_is_the_one_that_counts() {
        let told = [(1.0, "sight: dark"), (5.0, "jam: b4"), (6.0, "sight: dark")];
        let right = judge(&struck(FaultKind::Jam, Some(2.0), ALL, &told), None).unwrap();
        assert!(right.diagnosed && right.recovered && !right.harmless());
        let wrong = judge(&struck(FaultKind::TagCovered, Some(2.0), ALL, &told), None).unwrap();
        assert!(!wrong.diagnosed && wrong.told == Some(Cause::Jam));
        let early = judge(&struck(FaultKind::TagCovered, Some(0.0), ALL, &told), None).unwrap();
        assert!(early.diagnosed);
    }

    #[test]
    fn what_nobody_noticed_is_harmless_only_if_the_goal_was_built() {
        assert!(judge(&struck(FaultKind::Jam, Some(2.0), ALL, &[]), None).unwrap().harmless());
        let failed = judge(&struck(FaultKind::Jam, Some(2.0), &[1.0], &[]), None).unwrap();
        assert!(!failed.harmless() && !failed.diagnosed && !failed.recovered);
        let mut repaired = struck(FaultKind::Jam, Some(2.0), ALL, &[]);
        repaired.events.push(Event::new(3.0, EventKind::Replan { coarse: 5 }));
        let judgement = judge(&repaired, None).unwrap();
        assert!(!judgement.harmless() && !judgement.diagnosed && judgement.recovered);
    }

    #[test]
    fn what_is_said_without_the_fault_too_is_not_said_of_it() {
        let said = [(1.0, "jam: b6 meets 12 N 180.5 mm before its place"), (5.0, "beam-moved: b4")];
        let mut control = struck(FaultKind::Jam, None, ALL, &said);
        control.fault = None;
        let mut harmless = struck(
            FaultKind::BeamTurned,
            Some(0.5),
            ALL,
            &[(1.5, "jam: b6 meets 13 N 179.8 mm before its place"), (5.0, "beam-moved: b4")],
        );
        for (result, t) in [(&mut control, 6.0), (&mut harmless, 6.5)] {
            let fault = Fault::Misaligned { connection: "C6".into(), offset: t * 1e-3 };
            result.events.push(Event::new(t, fault.into()));
        }
        assert!(judge(&harmless, Some(&control)).unwrap().harmless());
        assert!(!judge(&harmless, None).unwrap().harmless());
        // Another part, and once more than usual, are news.
        for news in ["jam: b5 meets 12 N 180.5 mm before its place", "beam-moved: b4"] {
            let told = [said[0], said[1], (7.0, news)];
            let judged = judge(&struck(FaultKind::Jam, Some(0.5), ALL, &told), Some(&control)).unwrap();
            assert_eq!(judged.told.map(Cause::name), news.split(':').next());
        }
    }

    #[test]
    fn episodes_without_a_strike_or_a_result_count_for_no_share() {
        assert_eq!(judge(&episode("easy-1", 1, ALL, 3), None), None);
        let results = [
            struck(FaultKind::Jam, None, ALL, &[]),
            struck(FaultKind::Jam, Some(2.0), ALL, &[]),
            struck(FaultKind::Jam, Some(2.0), ALL, &[(3.0, "jam: b4")]),
            struck(FaultKind::Jam, Some(2.0), &[1.0], &[(3.0, "sight: b4")]),
        ];
        let tally = Tally::of(results.iter().map(|it| [Some(it), None]).chain([[None; 2]]));
        assert_eq!((tally.episodes, tally.lost, tally.struck, tally.harmless), (5, 1, 3, 1));
        assert_eq!((tally.diagnosed.hits, tally.diagnosed.count), (1, 2));
        assert_eq!((tally.recovered.hits, tally.recovered.count), (2, 3));
        assert_eq!(tally.diagnosed.interval, wilson(1, 2));
    }

    #[test]
    fn every_cause_is_right_for_some_fault() {
        for cause in Cause::ALL {
            assert!(FaultKind::ALL.iter().any(|kind| accepted(*kind).contains(&cause)), "{cause:?}");
            assert_eq!(Cause::named(cause.name()), Some(cause));
        }
    }
}
