//! The history of an episode: what was tried, with what and how it failed, and what is left to be tried.
//!
//! A plan that fails is followed by one that differs from it in a named way: after another look, with another
//! grasp, by another link, along another path, with a neighbour laid aside, with another peg, or after the
//! rest of the frame. What was
//! tried counts as long as the assembly is as it was: after progress it is worth another try. When nothing is
//! left, the history tells what was tried.

use std::collections::BTreeMap;
use std::fmt;

use ramp_assembly::Assembly;
use ramp_kit::source::{MAX_SENTENCE, plain};
use ramp_planner::{End, FineAction, Impossible, MotionFact, Plan};

use crate::change::{Change, Choice};
use crate::grasp::BeamGrasp;
use crate::skill::{ActionKind, Call};

/// The most characters of a reason in the account of what was tried.
const LONGEST_REASON: usize = 90;

/// The work at which an agent has failed: an action, or the check of two holes.
#[derive(Clone, Debug, PartialEq)]
pub struct Work {
    /// The action; `None` for the check of two holes before a peg is fetched.
    kind: Option<ActionKind>,
    /// The beam, the connection or the peg that it is about.
    about: String,
    /// The beam that it moves.
    beam: Option<String>,
    /// The link by which that beam is held.
    link: Option<String>,
    /// The peg that it moves.
    peg: Option<String>,
}

impl Work {
    /// A fine action.
    pub fn action(call: &Call, assembly: &Assembly) -> Work {
        let part = call.part().map(str::to_string);
        let is_beam = part.as_ref().is_some_and(|part| assembly.kit.beam(part).is_some());
        let about = match call.action {
            FineAction::Fasten { connection, .. } | FineAction::PullOut { connection, .. } => {
                Some(connection.clone())
            }
            _ => part.clone(),
        };
        Work {
            kind: Some(call.kind()),
            about: about.unwrap_or_else(|| call.action.to_string()),
            beam: part.clone().filter(|_| is_beam),
            link: call.link().map(str::to_string).filter(|_| is_beam),
            peg: part.filter(|_| !is_beam),
        }
    }

    /// The check of the holes of a connection.
    pub fn holes(connection: &str) -> Work {
        Work { kind: None, about: connection.to_string(), beam: None, link: None, peg: None }
    }

    /// The beam that it moves, if it moves one.
    pub fn beam(&self) -> Option<&str> {
        self.beam.as_deref()
    }

    /// The link by which that beam is held.
    pub fn link(&self) -> Option<&str> {
        self.link.as_deref()
    }

    /// The name of its beam, connection or peg.
    pub fn about(&self) -> &str {
        &self.about
    }

    /// The step, in words.
    pub fn step(&self) -> String {
        self.kind.map_or("align the holes", ActionKind::name).replace('_', " ")
    }

    /// Whether the beam stands in the assembly while it is worked on.
    fn stands(&self) -> bool {
        use ActionKind::{Push, Slide, SlideBack, TakeOut};
        matches!(self.kind, Some(Push | Slide | SlideBack | TakeOut))
    }
}

impl fmt::Display for Work {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self.kind {
            Some(kind) => write!(f, "{} {}", kind.name().replace('_', " "), self.about),
            None => write!(f, "align the holes of {}", self.about),
        }
    }
}

/// An attempt that failed.
#[derive(Clone, Debug, PartialEq)]
struct Tried {
    work: Work,
    /// Its difference from the attempt before; `None` of the first one.
    with: Option<Change>,
    /// The words of its failure.
    how: String,
    /// There was no plan with this difference: nothing was carried out.
    refused: bool,
    /// Beams that stood and pegs that were seated then.
    progress: usize,
}

/// The attempts so far.
#[derive(Clone, Debug, Default)]
pub struct History {
    tried: Vec<Tried>,
    /// The difference of the plan that is carried out.
    change: Option<(Work, Change)>,
    /// Facts by which the planner avoids what has failed.
    facts: Vec<MotionFact>,
    /// Grasps of beams that failed, by name.
    grasps: BTreeMap<String, Vec<BeamGrasp>>,
    /// Pegs that are set aside.
    aside: Vec<String>,
    /// Connections that are left for later.
    later: Vec<String>,
    /// Beams that are left for later, by name.
    left_out: Vec<String>,
    /// Beams that are not pushed, with the progress at which a push failed.
    skipped: Vec<(String, usize)>,
    /// The paths of beams in the plan, by name.
    paths: BTreeMap<String, String>,
}

impl History {
    /// Whether nothing has failed yet.
    pub fn is_empty(&self) -> bool {
        self.tried.is_empty()
    }

    /// The words of the last failure.
    pub fn last(&self) -> Option<String> {
        self.tried.last().map(|tried| tried.how.clone())
    }

    /// Whether an action is left out, because it failed in every way in the assembly as it is.
    pub fn skips(&self, action: &FineAction, progress: usize) -> bool {
        let FineAction::Push { beam, .. } = action else { return false };
        self.skipped.iter().any(|(other, then)| other == beam && *then == progress)
    }

    /// Takes over the paths of a plan that is going to be carried out.
    pub fn follows(&mut self, plan: &Plan) {
        self.paths.extend(plan.entries.iter().map(|entry| (entry.beam.clone(), entry.path.clone())));
    }

    /// Whether a limit of the arm stands against the work that failed last.
    pub fn failed_at(&self, fact: &MotionFact) -> bool {
        let Some(Tried { work, .. }) = self.tried.last() else { return false };
        match &fact.cannot {
            Impossible::Grasp { beam, .. } | Impossible::Insert { beam, .. } => {
                work.beam.as_ref() == Some(beam)
            }
            Impossible::Fasten { connection } => work.about == *connection,
        }
    }

    /// The facts for the planner.
    pub fn facts(&self) -> &[MotionFact] {
        &self.facts
    }

    /// The grasps of beams that failed, by name.
    pub fn grasps(&self) -> &BTreeMap<String, Vec<BeamGrasp>> {
        &self.grasps
    }

    /// The pegs that are set aside.
    pub fn aside(&self) -> &[String] {
        &self.aside
    }

    /// The connections that are left for later: plans take them for fastened.
    pub fn later(&self) -> &[String] {
        &self.later
    }

    /// The beams that are left for later, by name: plans do without them.
    pub fn left_out(&self) -> &[String] {
        &self.left_out
    }

    /// The rest is done: now is the time for the beams that were left for later, and for the connections that
    /// are not `pinned`. Returns whether there are any. With more `progress` than when they failed, they are
    /// worth another try.
    pub fn resumes(&mut self, pinned: &[(String, String)], progress: usize) -> bool {
        let (later, left_out) = (std::mem::take(&mut self.later), std::mem::take(&mut self.left_out));
        let is_open = |work: &Work| match work.brings() {
            Some(beam) => left_out.contains(beam),
            None => {
                work.is_of_connection()
                    && later.contains(&work.about)
                    && pinned.iter().all(|(connection, _)| *connection != work.about)
            }
        };
        let Some(last) = self.tried.iter().rev().find(|tried| is_open(&tried.work)).cloned() else {
            return false;
        };
        self.change = None;
        self.tried.push(Tried { with: Some(Change::Later), refused: false, progress, ..last });
        true
    }

    /// Records a failure. `progress` counts the beams that stand and the pegs that are seated.
    pub fn failed(&mut self, work: &Work, how: &str, progress: usize) {
        let stood = self.tried.last().is_some_and(|tried| tried.progress == progress);
        let change = self.change.take().filter(|(about, _)| stood && about.same(work));
        let with = change.map(|(_, change)| change);
        let how = plain(how, LONGEST_REASON);
        self.tried.push(Tried { work: work.clone(), with, how, refused: false, progress });
    }

    /// The next difference that was not tried yet for what has failed last, and takes it up; `None` when
    /// nothing is left.
    pub fn change(&mut self, choice: &Choice) -> Option<(Work, Change)> {
        let last = self.tried.last()?.clone();
        let is_left = |change: &Change| {
            let alike = |tried: &&Tried| tried.with.as_ref().is_some_and(|with| with.is_like(change));
            let tried = self.tried_so_far(&last).filter(alike);
            tried.clone().count() < change.most() && !tried.clone().any(|it| it.with.as_ref() == Some(change))
        };
        let change = self.options(&last.work, choice).into_iter().find(is_left)?;
        self.take_up(&last, &change);
        self.change = Some((last.work.clone(), change.clone()));
        Some((last.work, change))
    }

    /// Takes back a difference that cannot be carried out, for this reason, and counts it as tried.
    pub fn refused(&mut self, why: &str) {
        let Some((work, change)) = self.change.take() else { return };
        match &change {
            Change::Link { .. } | Change::Path { .. } => drop(self.facts.pop()),
            Change::Peg { not } => self.aside.retain(|peg| peg != not),
            Change::AsItIs => drop(self.skipped.pop()),
            Change::Later if work.brings().is_some() => drop(self.left_out.pop()),
            Change::Later => drop(self.later.pop()),
            Change::Look | Change::Pause | Change::Grasp { .. } | Change::Aside { .. } => {}
        }
        let progress = self.tried.last().map_or(0, |tried| tried.progress);
        let how = plain(why, LONGEST_REASON);
        self.tried.push(Tried { work, with: Some(change), how, refused: true, progress });
    }

    /// The attempts at the work that failed last, for a person.
    pub fn account(&self) -> String {
        let Some(last) = self.tried.last() else { return "nothing was tried".to_string() };
        // Differences that ended alike stand together.
        let mut endings: Vec<(Vec<String>, &str)> = Vec::new();
        for Tried { with, how, .. } in self.tried_so_far(last) {
            let with = with.as_ref().map(Change::to_string);
            match endings.last_mut().filter(|(before, same)| !before.is_empty() && same == how) {
                Some((before, _)) => before.extend(with),
                None => endings.push((with.into_iter().collect(), how)),
            }
        }
        let words = |(with, how): &(Vec<String>, &str)| match with.is_empty() {
            true => how.to_string(),
            false => format!("{}: {how}", with.join(", ")),
        };
        let tried: Vec<String> = endings.iter().map(words).collect();
        let text = format!("nothing is left to try to {}: {}", last.work, tried.join("; "));
        plain(&text, MAX_SENTENCE - 1)
    }

    /// The attempts at the same thing since the last progress.
    fn tried_so_far<'h>(&'h self, last: &'h Tried) -> impl Iterator<Item = &'h Tried> + Clone {
        self.tried.iter().filter(|tried| tried.work.same(&last.work) && tried.progress == last.progress)
    }

    /// Everything that might be done otherwise, the least invasive first.
    fn options(&self, work: &Work, choice: &Choice) -> Vec<Change> {
        let mut options = vec![Change::Look];
        if let Some(beam) = &work.beam {
            if !work.stands()
                && let Some(grasp) = choice.gripped.get(beam)
            {
                options.push(Change::Grasp { not: *grasp });
            }
            if let Some(not) = work.link.clone() {
                options.push(Change::Link { not });
            }
            if work.kind == Some(ActionKind::Push) {
                options.push(Change::AsItIs);
            }
            if let Some(path) = self.paths.get(beam).filter(|_| !work.stands()) {
                options.push(Change::Path { not: path.clone() });
            }
            if work.kind == Some(ActionKind::PickUp) {
                let beside = choice.beside.get(beam).into_iter().flatten();
                options.extend(beside.map(|beam| Change::Aside { beam: beam.clone() }));
            }
        }
        if let Some(peg) = work.peg.clone().filter(|_| choice.spare > self.aside.len()) {
            options.push(Change::Peg { not: peg });
        }
        options.push(Change::Pause);
        if work.is_of_connection() || work.brings().is_some() {
            options.push(Change::Later);
        }
        options
    }

    fn take_up(&mut self, last: &Tried, change: &Change) {
        let carried_out = self.tried.iter().rev().find(|tried| !tried.refused);
        let because = format!("it was tried: {}", carried_out.map_or(&last.how, |tried| &tried.how));
        let at = if last.work.stands() { End::Place } else { End::Start };
        let beam = last.work.beam.clone().unwrap_or_default();
        match change {
            Change::Look | Change::Pause | Change::Aside { .. } => {}
            Change::AsItIs => self.skipped.push((beam, last.progress)),
            Change::Later if last.work.brings().is_some() => self.left_out.push(beam),
            Change::Later => self.later.push(last.work.about.clone()),
            Change::Grasp { not } => self.grasps.entry(beam).or_default().push(*not),
            Change::Link { not } => {
                let cannot = Impossible::Grasp { beam, link: not.clone(), at };
                self.facts.push(MotionFact { cannot, past: None, because });
            }
            Change::Path { not } => {
                let cannot = Impossible::Insert { beam, path: not.clone() };
                self.facts.push(MotionFact { cannot, past: None, because });
            }
            Change::Peg { not } => self.aside.push(not.clone()),
        }
    }
}

impl Work {
    /// Whether it is the same work on the same thing, whatever part it is done with.
    fn same(&self, other: &Work) -> bool {
        self.kind == other.kind && (self.about == other.about || self.is_peg() && other.is_peg())
    }

    /// The beam that it brings to the frame, if any: without it, the rest of a frame can be built.
    fn brings(&self) -> Option<&String> {
        self.beam.as_ref().filter(|_| !self.stands())
    }

    /// Whether it is about a connection: without its peg, the rest of a frame can be built.
    fn is_of_connection(&self) -> bool {
        matches!(self.kind, None | Some(ActionKind::Fasten))
    }

    /// Whether it fetches a peg: which one makes no other work of it.
    fn is_peg(&self) -> bool {
        self.peg.is_some() && !matches!(self.kind, Some(ActionKind::Fasten))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn insertion() -> Work {
        let [beam, link] = ["b4", "b4l2"].map(|name| Some(name.to_string()));
        Work { kind: Some(ActionKind::AssembleSquare), about: "b4".into(), beam, link, peg: None }
    }

    fn gripped(s: f64, reverse: bool, spare: usize) -> Choice {
        let gripped = BTreeMap::from([("b4".to_string(), BeamGrasp { s, reverse })]);
        Choice { gripped, spare, ..Choice::default() }
    }

    /// The choice of a history after each of so many failures of the same work.
    fn changes(history: &mut History, work: &Work, choices: &[Choice]) -> Vec<Option<String>> {
        let change = |choice: &Choice| {
            history.failed(work, "it jams", 3);
            history.change(choice).map(|(_, change)| change.to_string())
        };
        choices.iter().map(change).collect()
    }

    /// A plan that fails the same way leads to another choice each time, until nothing is left; the account
    /// tells each of them.
    #[test]
    fn nothing_is_tried_twice() {
        let mut history = History::default();
        history.paths.insert("b4".into(), "along x".into());
        let choices = [0.10, 0.10, 0.12, 0.14, 0.14, 0.14, 0.14, 0.14].map(|s| gripped(s, false, 0));
        let found = changes(&mut history, &insertion(), &choices);
        let expected = [
            Some("after another look"),
            Some("with another grasp than 100 mm from its j1 hole"),
            Some("with another grasp than 120 mm from its j1 hole"),
            Some("by another link than b4l2"),
            Some("along another path than along x"),
            Some("after a pause"),
            Some("after the rest"),
            None,
        ];
        assert_eq!(found, expected.map(|words| words.map(str::to_string)));
        let account = history.account();
        assert!(
            account.starts_with("nothing is left to try to assemble square b4: it jams; after another look"),
            "{account}"
        );
        assert!(
            account.contains(&expected.iter().flatten().copied().collect::<Vec<_>>().join(", ")),
            "{account}"
        );
        assert_eq!(history.facts().len(), 2);
        assert_eq!(history.grasps()["b4"].len(), 2);
        assert_eq!(history.left_out(), ["b4"]);
        // The rest has brought the frame on: the beam is worth another try.
        assert!(history.resumes(&[], 6) && history.left_out().is_empty());
        assert_eq!(history.change(&choices[0]).map(|(_, change)| change), Some(Change::Look));
    }

    /// With a beam or a peg more, the same is worth another try.
    #[test]
    fn progress_makes_it_worth_another_try() {
        let mut history = History::default();
        for progress in [3, 4] {
            history.failed(&insertion(), "it jams", progress);
            let change = history.change(&gripped(0.1, false, 0)).map(|(_, change)| change);
            assert_eq!(change, Some(Change::Look), "{progress}");
        }
    }

    /// Another peg only where there is a spare one; which peg it is makes no other work of it.
    #[test]
    fn pegs_are_set_aside_as_long_as_there_are_spare_ones() {
        let fetch = |peg: &str| Work {
            kind: Some(ActionKind::PickUp),
            about: peg.into(),
            beam: None,
            link: None,
            peg: Some(peg.into()),
        };
        let mut history = History::default();
        let mut change = |peg: &str| {
            history.failed(&fetch(peg), "it is not in the hand", 3);
            history.change(&gripped(0.1, false, 1)).map(|(_, change)| change.to_string())
        };
        assert_eq!(change("p1").as_deref(), Some("after another look"));
        assert_eq!(change("p1").as_deref(), Some("with another peg than p1"));
        assert_eq!(change("p2").as_deref(), Some("after a pause"));
        assert_eq!(change("p2"), None);
    }

    /// Beams beside the one that cannot be fetched are laid aside, one after another.
    #[test]
    fn neighbours_are_laid_aside() {
        let fetch = Work { kind: Some(ActionKind::PickUp), ..insertion() };
        let beside = ["b8", "b2", "b3"].map(str::to_string).to_vec();
        let choice = Choice { beside: [("b4".to_string(), beside)].into(), ..Choice::default() };
        let mut history = History::default();
        let mut changes = Vec::new();
        for _ in 0..6 {
            history.failed(&fetch, "the fingers have no room", 3);
            changes.extend(history.change(&choice).map(|(_, change)| change.to_string()));
        }
        assert_eq!(
            changes[2..5],
            ["with b8 laid aside", "with b2 laid aside", "after a pause"],
            "{changes:?}"
        );
    }

    /// A connection that fails in every way is left for later, and the rest of the frame comes first. When
    /// that is done it is worth another try; a frame in which nothing else could be done is given up.
    #[test]
    fn a_connection_is_left_for_later() {
        let fasten = Work {
            kind: Some(ActionKind::Fasten),
            about: "C2".into(),
            beam: None,
            link: None,
            peg: Some("p2".into()),
        };
        let mut history = History::default();
        let fails = |history: &mut History, progress: usize| {
            history.failed(&fasten, "p2 is not flush", progress);
            history.change(&Choice::default()).map(|(_, change)| change.to_string())
        };
        let words: Vec<_> = (0..3).map(|_| fails(&mut history, 3)).collect();
        assert_eq!(words[2].as_deref(), Some("after the rest"));
        assert_eq!(history.later(), ["C2"]);
        // The rest has brought the frame on.
        assert!(history.resumes(&[], 6) && history.later().is_empty());
        let change = history.change(&Choice::default()).map(|(_, change)| change);
        assert_eq!(change, Some(Change::Look));
        assert_eq!(fails(&mut history, 6).as_deref(), Some("after a pause"));
        assert_eq!(fails(&mut history, 6), None);
        assert!(!history.resumes(&[], 6));
        // There is no rest.
        let mut history = History::default();
        for _ in 0..3 {
            fails(&mut history, 3);
        }
        assert!(history.resumes(&[], 3));
        assert_eq!(history.change(&Choice::default()), None);
        assert!(history.account().ends_with("after the rest: p2 is not flush"), "{}", history.account());
        // It was fastened meanwhile.
        let mut history = History::default();
        for _ in 0..3 {
            fails(&mut history, 3);
        }
        assert!(!history.resumes(&[("C2".into(), "p2".into())], 4));
    }

    /// A difference with which there is no plan counts as tried, and the planner does not keep it.
    #[test]
    fn a_difference_without_a_plan_is_taken_back() {
        let mut history = History::default();
        let push = Work { kind: Some(ActionKind::Push), ..insertion() };
        history.failed(&push, "b4 stands 3.4 mm off", 3);
        history.change(&Choice::default());
        history.failed(&push, "b4 stands 3.5 mm off", 3);
        let change = history.change(&Choice::default()).map(|(_, change)| change);
        assert_eq!(change, Some(Change::Link { not: "b4l2".into() }));
        assert!(matches!(&history.facts()[0].cannot, Impossible::Grasp { at: End::Place, .. }));
        history.refused("no plan: b4 cannot be grasped");
        assert!(history.facts().is_empty());
        // A push that fails in every way is left out, until the assembly has changed.
        assert_eq!(history.change(&Choice::default()).map(|(_, change)| change), Some(Change::AsItIs));
        let action = FineAction::Push { beam: "b4".into(), link: "b4l2".into() };
        assert!(history.skips(&action, 3) && !history.skips(&action, 4));
        history.failed(&push, "b4 stands 3.5 mm off", 3);
        assert_eq!(history.change(&Choice::default()).map(|(_, change)| change), Some(Change::Pause));
        history.failed(&push, "b4 stands 3.5 mm off", 3);
        assert_eq!(history.change(&Choice::default()), None);
        assert!(history.account().contains("by another link than b4l2: no plan: b4 cannot be grasped"));
    }
}
