//! Laws: syntax checks, and a sort for every variable.

use super::checker::Checker;
use super::terms::{Role, Variables, bind};
use crate::ast::{Atom, Condition, Expression, Law, Span, is_anonymous};
use crate::domain::{CheckedLaw, FluentKind, Kind, Leaf};
use crate::problem::{LanguageError, LanguageProblem};

impl Checker<'_> {
    /// A law with the sorts of its variables.
    pub(crate) fn law(
        &self,
        law: Law,
        body: Vec<Condition>,
        span: Span,
    ) -> Result<CheckedLaw, LanguageError> {
        let mut variables = Variables::default();
        let mut body_role = Role::Body;
        match &law {
            Law::Causal { action, heads } => {
                self.atom(action, Role::Action, &mut variables)?;
                for head in heads {
                    self.atom(&head.atom, Role::Effect, &mut variables)?;
                    self.no_anonymous(&head.atom.arguments, "an effect")?;
                }
            }
            Law::Impossible { action } => self.atom(action, Role::Action, &mut variables)?,
            Law::Holds { head } => {
                self.atom(&head.atom, Role::Head, &mut variables)?;
                self.no_anonymous(&head.atom.arguments, "the conclusion of a law")?;
                let kind = self.domain.kind(&head.atom.name.text);
                match kind {
                    Some(kind @ (Kind::Static | Kind::Fluent(FluentKind::Defined))) if !head.positive => {
                        let name = head.atom.name.text.clone();
                        let problem = LanguageProblem::NegatedHead { name, found: kind.describe() };
                        return self.fault(problem, &head.atom.span);
                    }
                    Some(Kind::Static) => body_role = Role::StaticBody,
                    _ => {}
                }
            }
            Law::Initially { head } | Law::Goal { head } => {
                let role = if matches!(law, Law::Initially { .. }) { Role::Effect } else { Role::Fluent };
                self.atom(&head.atom, role, &mut variables)?;
                self.no_anonymous(&head.atom.arguments, "an initial state or a goal")?;
                body_role = Role::StaticBody;
            }
            Law::Bridge { head } => {
                self.bridge(head, &mut variables)?;
                self.no_anonymous(&head.arguments, "the conclusion of a law")?;
            }
        }
        for condition in &body {
            match condition {
                Condition::Literal(literal) => {
                    self.atom(&literal.atom, body_role, &mut variables)?;
                    if literal.positive {
                        bind(&literal.atom.arguments, &mut variables);
                    } else {
                        self.no_anonymous(&literal.atom.arguments, "a negated condition")?;
                    }
                }
                Condition::Comparison(comparison) => {
                    let sides = [comparison.left.clone(), comparison.right.clone()];
                    self.no_anonymous(&sides, "a comparison")?;
                    for side in &sides {
                        self.side(side, &mut variables)?;
                    }
                }
            }
        }
        if let Law::Causal { action, .. } | Law::Impossible { action } = &law {
            bind(&action.arguments, &mut variables);
        }
        // Every variable has a sort; a number must also be bound, because numbers are too many to
        // enumerate.
        let mut unsafe_variable = None;
        let mut visit = |variable: &str, span: &Span| {
            let sort = variables.sorts.get(variable);
            let number = sort.is_some_and(|sort| {
                self.domain.sorts.get(sort).is_some_and(|sort| sort.leaves.contains(&Leaf::Number))
            });
            if (sort.is_none() || number && !variables.bound.contains(variable)) && unsafe_variable.is_none()
            {
                unsafe_variable = Some((variable.to_string(), span.clone()));
            }
        };
        each_expression(&law, &body, &mut |expression| expression.variables(&mut visit));
        if let Some((variable, span)) = unsafe_variable {
            return self.fault(LanguageProblem::Unsafe { variable }, &span);
        }
        Ok(CheckedLaw { law, body, span, variables: variables.sorts })
    }

    fn no_anonymous(&self, terms: &[Expression], place: &'static str) -> Result<(), LanguageError> {
        let mut found = None;
        for term in terms {
            term.variables(&mut |variable, span| {
                if is_anonymous(variable) && found.is_none() {
                    found = Some(span.clone());
                }
            });
        }
        match found {
            Some(span) => self.fault(LanguageProblem::Anonymous { place }, &span),
            None => Ok(()),
        }
    }
}

/// Every term of a law.
fn each_expression(law: &Law, body: &[Condition], with: &mut impl FnMut(&Expression)) {
    let mut atom = |atom: &Atom| atom.arguments.iter().for_each(&mut *with);
    match law {
        Law::Causal { action, heads } => {
            atom(action);
            heads.iter().for_each(|head| atom(&head.atom));
        }
        Law::Impossible { action: head } | Law::Bridge { head } => atom(head),
        Law::Holds { head } | Law::Initially { head } | Law::Goal { head } => atom(&head.atom),
    }
    for condition in body {
        match condition {
            Condition::Literal(literal) => literal.atom.arguments.iter().for_each(&mut *with),
            Condition::Comparison(comparison) => {
                with(&comparison.left);
                with(&comparison.right);
            }
        }
    }
}
