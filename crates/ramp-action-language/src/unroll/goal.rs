//! Goals at the last time: certain, impossible, or a literal that a solver decides.

use super::program::{GroundRule, Prospect};
use super::unrolled::Unrolled;
use crate::term::Term;

impl Unrolled<'_, '_> {
    /// Whether a goal is true at the last time. `coarse(F)` is a fluent defined by a bridge law.
    pub fn prospect(&mut self, fluent: &Term, truth: bool) -> Prospect {
        if let Some(("coarse", [coarse])) = fluent.parts() {
            return self.bridge(coarse);
        }
        let Some(ground) = self.model.ground(fluent) else {
            return if truth { Prospect::Never } else { Prospect::Certain };
        };
        let (may, must) = (self.in_state(&ground, &self.may), self.in_state(&ground, &self.must));
        match (truth, may, must) {
            (true, _, true) | (false, false, _) => Prospect::Certain,
            (true, false, _) | (false, _, true) => Prospect::Never,
            _ => Prospect::If(self.literal(&ground, truth)),
        }
    }

    fn bridge(&mut self, coarse: &Term) -> Prospect {
        let model = self.model;
        let mut bodies = Vec::new();
        for rule in &model.bridges {
            model.solve(rule, self.view(), &mut |binding| {
                let said = rule.heads.iter().any(|head| {
                    let row = model.row(&head.arguments, binding);
                    let arguments = row.into_iter().flatten().map(|value| model.term(value)).collect();
                    Term::Function(head.name.to_string(), arguments) == *coarse
                });
                if said {
                    bodies.push(self.body(&self.conditions(rule, binding, self.view())));
                }
                false
            });
        }
        if bodies.is_empty() {
            return Prospect::Never;
        }
        if bodies.iter().any(Vec::is_empty) {
            return Prospect::Certain;
        }
        let head = self.atom();
        let rules = bodies.into_iter().map(|body| GroundRule { choice: false, head: Some(head), body });
        self.rules.extend(rules);
        Prospect::If(head)
    }
}
