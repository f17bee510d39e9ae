//! Taking a frame apart, piece by piece. One that does not come off is tried otherwise: after another look,
//! by another link, after a pause. What was tried counts until something has come off.

use ramp_planner::{FineAction, Plan, backwards, left_of};
use ramp_robot::{Retry, RobotError};

use super::Baseline;
use super::repair::look_at_frame;
use super::take_apart::{is_deep, stands};
use crate::cell::Workcell;
use crate::change::Change;
use crate::fault::SkillError;
use crate::history::Work;
use crate::recognition::recognise;
use crate::recovery::{clear_hand, note_fault};

/// The attempts at the piece that comes off next.
#[derive(Default)]
struct Attempts {
    /// Steps that were left when they began.
    left: Option<usize>,
    /// The differences so far, each with the words of its failure.
    tried: Vec<(Option<Change>, String)>,
    /// The beam that is held by this link from now on.
    link: Option<(String, String)>,
}

impl Attempts {
    /// The plan with its beam held by another link, if that is the difference.
    fn changed(&self, mut plan: Plan) -> Plan {
        let Some((beam, link)) = &self.link else { return plan };
        for action in plan.steps.iter_mut().flat_map(|step| &mut step.fine) {
            if let FineAction::TakeOut { beam: it, link: held }
            | FineAction::SlideBack { beam: it, link: held } = action
                && it == beam
            {
                held.clone_from(link);
            }
        }
        plan
    }

    /// Takes a failure, with this number of steps left, and gives the next difference, if there is one.
    fn next(&mut self, cell: &Workcell, work: &Work, why: &str, left: usize) -> Option<Change> {
        if self.left != Some(left) {
            *self = Attempts { left: Some(left), ..Attempts::default() };
            self.tried.push((None, why.to_string()));
        } else if let Some((_, how)) = self.tried.last_mut() {
            *how = why.to_string();
        }
        let tried = |change: &Change| self.tried.iter().any(|(other, _)| other.as_ref() == Some(change));
        let held = self.link.as_ref().map(|(_, link)| link.as_str()).or(work.link());
        let links = work.beam().and_then(|beam| cell.kit.beam(beam)).map_or(&[][..], |beam| &beam.links);
        let at = links.iter().position(|link| Some(link.name.as_str()) == held);
        let by_another =
            at.filter(|_| links.len() > 1).map(|at| Change::Link { not: links[at].name.clone() });
        let options = [Some(Change::Look), by_another, Some(Change::Pause)];
        let change = options.into_iter().flatten().find(|change| !tried(change))?;
        if let (Change::Link { .. }, Some(beam), Some(at)) = (&change, work.beam(), at) {
            let next = &links[(at + 1) % links.len()];
            self.link = Some((beam.to_string(), next.name.clone()));
        }
        self.tried.push((Some(change.clone()), String::new()));
        Some(change)
    }

    /// The piece that does not come off, and what was tried, for a person.
    fn account(&self, work: &Work) -> String {
        let tried = self.tried.iter().map(|(change, how)| match change {
            Some(change) => format!("{change}: {how}"),
            None => how.clone(),
        });
        format!("nothing is left to try to {work}: {}", tried.collect::<Vec<_>>().join("; "))
    }
}

impl Baseline<'_> {
    /// Takes apart what stands of the frame that a plan builds, as far as `cut` leaves its steps. Gives what
    /// was tried in vain where a piece does not come off.
    ///
    /// # Errors
    /// The robot's.
    pub(super) fn carry_out_backwards(
        &mut self,
        cell: &mut Workcell,
        built: &Plan,
        cut: &dyn Fn(Plan) -> Plan,
    ) -> Result<Option<String>, RobotError> {
        let mut attempts = Attempts::default();
        loop {
            let whole = backwards(built, &cell.belief.fastened());
            let left = cut(left_of(&whole, |item| stands(cell, item), |beam| is_deep(cell, beam)));
            let steps = left.steps.len();
            if !attempts.tried.is_empty() {
                self.replans(cell, &left);
            }
            self.report(cell);
            let failure = match self.run_plan(cell, &attempts.changed(left)) {
                Ok(()) => return Ok(None),
                Err(SkillError::Robot(error)) => return Err(error),
                Err(error) => error,
            };
            cell.record(failure.fault());
            self.report(cell);
            clear_hand(&self.skills, cell)?;
            let Some(work) = self.work.take() else { return Ok(Some(failure.to_string())) };
            if cell.hand.time() > cell.parameters.agent.latest {
                return Ok(Some(format!("no time is left; {failure}")));
            }
            let change = attempts.next(cell, &work, &failure.to_string(), steps);
            let Some(change) = change else { return Ok(Some(attempts.account(&work))) };
            cell.record(Retry::new("take_apart", work.about()).because(format!("{}, {change}", work.step())));
            match change {
                Change::Look => {
                    look_at_frame(cell)?;
                    recognise(cell);
                }
                Change::Pause => {
                    let waited = cell.hand.wait(cell.parameters.agent.pause);
                    note_fault(cell, waited)?;
                }
                _ => {}
            }
        }
    }
}
