//! The sort checker: from statements to a [`Domain`] in which every name is known and every variable has a sort.

use super::ast::{
    Atom, Condition, Expression, Law, Literal, Name, Shape, SortPart, Span, Statement, is_anonymous,
};
use super::parse::{KEYWORDS, statements};
use super::problem::{LanguageError, LanguageProblem};
use ramp_kit::source::{Fault, SourceFile, nearest};
use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::path::Path;

/// The sort of whole numbers, which every domain has.
pub(crate) const NUMBER: &str = "number";
/// Names that the translation needs for itself.
const RESERVED: [&str; 16] = [
    NUMBER,
    "resumed",
    "active",
    "holds",
    "occurs",
    "query",
    "told",
    "told_not",
    "final",
    "final_not",
    "avoid",
    "event",
    "failed",
    "happened",
    "observed",
    "observed_not",
];

/// A domain of the action language: parsed, and every sort checked.
///
/// ```
/// use ramp_kit::source::SourceFile;
/// use ramp_planner::language::Domain;
///
/// let file = SourceFile::new(
///     "lamp.al",
///     "sort lamp = { red, green }.
///      inertial fluent on(lamp).
///      action press(lamp).
///      press(L) causes on(L) if -on(L).",
/// );
/// assert!(Domain::new(&file, None).is_ok());
///
/// let file = SourceFile::new("lamp.al", "sort lamp = { red, green }. static brighter(lamp, lamp). brighter(rad, green).");
/// let error = Domain::new(&file, None).unwrap_err();
/// assert_eq!(format!("{error:#}"), "lamp.al:1:67: `rad` is not of the sort `lamp` (did you mean `red`?)");
/// ```
#[derive(Clone, Debug)]
pub struct Domain {
    pub(crate) file: SourceFile,
    pub(crate) sorts: BTreeMap<String, Sort>,
    /// The arguments of the functions that sorts are made of.
    pub(crate) functions: BTreeMap<String, Vec<String>>,
    pub(crate) predicates: BTreeMap<String, Predicate>,
    pub(crate) laws: Vec<CheckedLaw>,
}

/// What a name stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    Static,
    Fluent(FluentKind),
    Action { exogenous: bool },
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum FluentKind {
    /// Stays as it is unless a law changes it.
    Inertial,
    /// True exactly when a law says so.
    Defined,
}

impl Kind {
    fn describe(self) -> &'static str {
        match self {
            Kind::Static => "a static",
            Kind::Fluent(FluentKind::Inertial) => "an inertial fluent",
            Kind::Fluent(FluentKind::Defined) => "a defined fluent",
            Kind::Action { .. } => "an action",
        }
    }
}

#[derive(Clone, Debug)]
pub(crate) struct Predicate {
    pub kind: Kind,
    pub sorts: Vec<String>,
}

/// A sort, as the set of what it is made of.
#[derive(Clone, Debug, Default)]
pub(crate) struct Sort {
    pub leaves: BTreeSet<Leaf>,
}

#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Leaf {
    Number,
    /// The objects of this sort come with the goal.
    Open(String),
    Constant(String),
    Function(String),
}

/// A law with the sorts of its variables.
#[derive(Clone, Debug)]
pub(crate) struct CheckedLaw {
    pub law: Law,
    pub body: Vec<Condition>,
    pub span: Span,
    pub variables: BTreeMap<String, String>,
}

impl Domain {
    /// The objects that laws name: they are not like others.
    pub(crate) fn quoted(&self) -> BTreeSet<String> {
        let mut names = BTreeSet::new();
        for law in &self.laws {
            let heads: Vec<&Atom> = match &law.law {
                Law::Causal { action, heads } => {
                    [action].into_iter().chain(heads.iter().map(|head| &head.atom)).collect()
                }
                Law::Holds { head } | Law::Initially { head } | Law::Goal { head } => vec![&head.atom],
                Law::Impossible { action } => vec![action],
                Law::Bridge { head } => vec![head],
            };
            for atom in heads {
                atom.arguments.iter().for_each(|term| term.quoted(&mut names));
            }
            for condition in &law.body {
                match condition {
                    Condition::Literal(literal) => {
                        literal.atom.arguments.iter().for_each(|term| term.quoted(&mut names));
                    }
                    Condition::Comparison(comparison) => {
                        comparison.left.quoted(&mut names);
                        comparison.right.quoted(&mut names);
                    }
                }
            }
        }
        names
    }

    /// Reads a domain from a file. A fine domain is given the coarse one that it refines: it sees its sorts and
    /// statics, and its `bridge` laws are about its fluents.
    ///
    /// # Errors
    /// When the file cannot be read, or says something that the language does not allow.
    pub fn read(path: &Path, coarse: Option<&Domain>) -> Result<Domain, LanguageError> {
        Domain::new(&SourceFile::read(path)?, coarse)
    }

    /// The same for a file in memory.
    ///
    /// # Errors
    /// When it says something that the language does not allow.
    pub fn new(file: &SourceFile, coarse: Option<&Domain>) -> Result<Domain, LanguageError> {
        let statements = statements(file)?;
        let mut checker = Checker {
            coarse,
            domain: Domain {
                file: file.clone(),
                sorts: coarse.map(|domain| domain.sorts.clone()).unwrap_or_default(),
                functions: coarse.map(|domain| domain.functions.clone()).unwrap_or_default(),
                predicates: BTreeMap::new(),
                laws: Vec::new(),
            },
        };
        if let Some(coarse) = coarse {
            let statics = coarse.predicates.iter().filter(|(_, predicate)| predicate.kind == Kind::Static);
            checker.domain.predicates.extend(statics.map(|(name, p)| (name.clone(), p.clone())));
        }
        checker.declare(&statements)?;
        for statement in statements {
            if let Statement::Law { law, body, span } = statement {
                let law = checker.law(law, body, span)?;
                checker.domain.laws.push(law);
            }
        }
        checker.stratified()?;
        if let Some(coarse) = coarse {
            let inherited = coarse.laws.iter().filter(|law| coarse.is_static_law(law));
            checker.domain.laws.splice(0..0, inherited.cloned());
        }
        Ok(checker.domain)
    }

    /// The file.
    pub fn file(&self) -> &SourceFile {
        &self.file
    }

    /// What it declares under a name.
    pub(crate) fn kind(&self, name: &str) -> Option<Kind> {
        self.predicates.get(name).map(|predicate| predicate.kind)
    }

    /// Does a bridge law define a coarse fluent of this name?
    pub(crate) fn bridges(&self, name: &str) -> bool {
        self.laws.iter().any(|law| matches!(&law.law, Law::Bridge { head } if head.name.text == name))
    }

    fn is_static_law(&self, law: &CheckedLaw) -> bool {
        matches!(&law.law, Law::Holds { head } if self.kind(&head.atom.name.text) == Some(Kind::Static))
    }

    /// Is every element of the first sort one of the second?
    pub(crate) fn within(&self, inner: &str, outer: &str) -> bool {
        match (self.sorts.get(inner), self.sorts.get(outer)) {
            (Some(inner), Some(outer)) => inner.leaves.is_subset(&outer.leaves),
            _ => inner == outer,
        }
    }
}

struct Checker<'a> {
    coarse: Option<&'a Domain>,
    domain: Domain,
}

/// Where an atom stands, which says what it may be.
#[derive(Clone, Copy, PartialEq)]
enum Role {
    StaticBody,
    Body,
    Action,
    Effect,
    Fluent,
    Head,
}

impl Checker<'_> {
    fn fault<T>(&self, problem: LanguageProblem, span: &Span) -> Result<T, LanguageError> {
        Err(Fault::new(problem, self.domain.file.place(span.clone())))
    }

    // ---- Declarations -----------------------------------------------------------------------------------------

    fn declare(&mut self, statements: &[Statement]) -> Result<(), LanguageError> {
        let number = Sort { leaves: BTreeSet::from([Leaf::Number]) };
        self.domain.sorts.insert(NUMBER.to_string(), number);
        let mut parts: BTreeMap<&str, (&Name, &Option<Vec<SortPart>>)> = BTreeMap::new();
        let mut places: HashMap<String, Span> = HashMap::new();
        for statement in statements {
            let name = match statement {
                Statement::Sort { name, .. }
                | Statement::Static { name, .. }
                | Statement::Fluent { name, .. }
                | Statement::Action { name, .. } => name,
                Statement::Law { .. } => continue,
            };
            let taken = RESERVED.contains(&name.text.as_str())
                || self.domain.sorts.contains_key(&name.text)
                || self.domain.predicates.contains_key(&name.text);
            let before = places.insert(name.text.clone(), name.span.clone());
            if taken || before.is_some() {
                let problem = LanguageProblem::Twice { name: name.text.clone() };
                let fault = Fault::new(problem, self.domain.file.place(name.span.clone()));
                return Err(match before {
                    Some(span) => fault.also(span, "first here"),
                    None => fault,
                });
            }
            if let Statement::Sort { name, parts: of } = statement {
                parts.insert(&name.text, (name, of));
            }
        }
        for name in parts.keys().copied().collect::<Vec<_>>() {
            self.sort(name, &parts, &mut Vec::new())?;
        }
        for (_, of) in parts.values() {
            for part in of.iter().flatten() {
                if let SortPart::Function(name, sorts) = part {
                    self.known_sorts(sorts)?;
                    let sorts: Vec<String> = sorts.iter().map(|sort| sort.text.clone()).collect();
                    match self.domain.functions.insert(name.text.clone(), sorts.clone()) {
                        Some(other) if other != sorts => {
                            return self
                                .fault(LanguageProblem::Twice { name: name.text.clone() }, &name.span);
                        }
                        _ => {}
                    }
                }
            }
        }
        for statement in statements {
            let (name, sorts, kind) = match statement {
                Statement::Static { name, sorts } => (name, sorts, Kind::Static),
                Statement::Fluent { name, sorts, inertial } => {
                    let kind = if *inertial { FluentKind::Inertial } else { FluentKind::Defined };
                    (name, sorts, Kind::Fluent(kind))
                }
                Statement::Action { name, sorts, exogenous } => {
                    (name, sorts, Kind::Action { exogenous: *exogenous })
                }
                Statement::Sort { .. } | Statement::Law { .. } => continue,
            };
            self.known_sorts(sorts)?;
            let numbers = matches!(kind, Kind::Action { .. } | Kind::Fluent(FluentKind::Inertial));
            if let Some(sort) = sorts.iter().find(|sort| numbers && sort.text == NUMBER) {
                // There are too many numbers to try each.
                let problem = LanguageProblem::Kind {
                    name: NUMBER.to_string(),
                    found: "a sort without an end",
                    expected: "a sort of objects",
                };
                return self.fault(problem, &sort.span);
            }
            let sorts = sorts.iter().map(|sort| sort.text.clone()).collect();
            self.domain.predicates.insert(name.text.clone(), Predicate { kind, sorts });
        }
        Ok(())
    }

    fn known_sorts(&self, sorts: &[Name]) -> Result<(), LanguageError> {
        match sorts.iter().find(|sort| !self.domain.sorts.contains_key(&sort.text)) {
            Some(sort) => self.unknown("sort", sort, self.domain.sorts.keys()),
            None => Ok(()),
        }
    }

    fn unknown<'n, T>(
        &self,
        kind: &'static str,
        name: &Name,
        names: impl Iterator<Item = &'n String>,
    ) -> Result<T, LanguageError> {
        let nearest = nearest(&name.text, names.map(String::as_str)).map(str::to_string);
        self.fault(LanguageProblem::Unknown { kind, name: name.text.clone(), nearest }, &name.span)
    }

    /// Finds the leaves of a sort, those of the sorts in it first.
    fn sort(
        &mut self,
        name: &str,
        parts: &BTreeMap<&str, (&Name, &Option<Vec<SortPart>>)>,
        within: &mut Vec<String>,
    ) -> Result<(), LanguageError> {
        if self.domain.sorts.contains_key(name) {
            return Ok(());
        }
        let Some((place, of)) = parts.get(name) else { return Ok(()) };
        // A chain of sorts as long as a file would be too deep to walk.
        if within.len() > 64 || within.iter().any(|outer| outer == name) {
            return self.fault(LanguageProblem::Circle { name: name.to_string() }, &place.span);
        }
        within.push(name.to_string());
        let mut leaves = BTreeSet::new();
        match of {
            None => {
                leaves.insert(Leaf::Open(name.to_string()));
            }
            Some(of) => {
                for part in of {
                    match part {
                        SortPart::Constant(constant) => {
                            leaves.insert(Leaf::Constant(constant.text.clone()));
                        }
                        SortPart::Function(function, _) => {
                            leaves.insert(Leaf::Function(function.text.clone()));
                        }
                        SortPart::Sort(inner) => {
                            self.sort(&inner.text, parts, within)?;
                            match self.domain.sorts.get(&inner.text) {
                                Some(sort) => leaves.extend(sort.leaves.iter().cloned()),
                                None => {
                                    let names: Vec<String> =
                                        parts.keys().map(|name| name.to_string()).collect();
                                    return self.unknown("sort", inner, names.iter());
                                }
                            }
                        }
                    }
                }
            }
        }
        within.pop();
        self.domain.sorts.insert(name.to_string(), Sort { leaves });
        Ok(())
    }

    // ---- Laws -------------------------------------------------------------------------------------------------

    fn law(&self, law: Law, body: Vec<Condition>, span: Span) -> Result<CheckedLaw, LanguageError> {
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
                self.no_anonymous(&head.atom.arguments, "what a law concludes")?;
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
                self.no_anonymous(&head.atom.arguments, "what an initial state or a goal says")?;
                body_role = Role::StaticBody;
            }
            Law::Bridge { head } => {
                self.bridge(head, &mut variables)?;
                self.no_anonymous(&head.arguments, "what a law concludes")?;
            }
        }
        for condition in &body {
            match condition {
                Condition::Literal(literal) => {
                    self.atom(&literal.atom, body_role, &mut variables)?;
                    if literal.positive {
                        bind(&literal.atom.arguments, &mut variables);
                    } else {
                        self.no_anonymous(&literal.atom.arguments, "what is negated")?;
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
        // Every variable has a sort; a number has a value besides, for there are too many to try.
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

    /// The terms of a comparison outside of every atom: functions and sums still say what is in them.
    fn side(&self, term: &Expression, variables: &mut Variables) -> Result<(), LanguageError> {
        match &term.what {
            Shape::Sum(left, _, right) => {
                self.term(left, NUMBER, variables)?;
                self.term(right, NUMBER, variables)
            }
            Shape::Function(name, arguments) if !arguments.is_empty() => {
                match self.domain.functions.get(name) {
                    Some(sorts) => self.arguments(name, arguments, sorts, &term.span, variables),
                    None => {
                        let name = Name { text: name.clone(), span: term.span.clone() };
                        self.unknown("function", &name, self.domain.functions.keys())
                    }
                }
            }
            Shape::Function(name, _) => {
                let constant = Leaf::Constant(name.clone());
                if self.domain.sorts.values().any(|sort| sort.leaves.contains(&constant)) {
                    return Ok(());
                }
                let name = Name { text: name.clone(), span: term.span.clone() };
                self.unknown("constant", &name, std::iter::empty())
            }
            Shape::Variable(_) | Shape::Number(_) | Shape::Quoted(_) => Ok(()),
        }
    }

    fn atom(&self, atom: &Atom, role: Role, variables: &mut Variables) -> Result<(), LanguageError> {
        let name = &atom.name.text;
        let Some(predicate) = self.domain.predicates.get(name) else {
            let fits = |predicate: &Predicate| match role {
                Role::Action => matches!(predicate.kind, Kind::Action { .. }),
                Role::Effect | Role::Fluent => matches!(predicate.kind, Kind::Fluent(_)),
                _ => !matches!(predicate.kind, Kind::Action { .. }),
            };
            let kind = match role {
                Role::Action => "action",
                Role::Effect | Role::Fluent => "fluent",
                Role::StaticBody => "static",
                Role::Body | Role::Head => "static or fluent",
            };
            let names = self.domain.predicates.iter().filter(|(_, p)| fits(p)).map(|(name, _)| name);
            // A keyword misspelt at the beginning of a statement looks like a head.
            let keywords: Vec<String> = KEYWORDS.map(str::to_string).to_vec();
            return self.unknown(kind, &atom.name, names.chain(keywords.iter()));
        };
        let expected = match (role, predicate.kind) {
            (Role::Action, Kind::Action { .. })
            | (Role::Effect, Kind::Fluent(FluentKind::Inertial))
            | (Role::Fluent, Kind::Fluent(_))
            | (Role::StaticBody, Kind::Static)
            | (Role::Body | Role::Head, Kind::Static | Kind::Fluent(_)) => None,
            (Role::Action, _) => Some("an action"),
            (Role::Effect, _) => Some("an inertial fluent"),
            (Role::Fluent, _) => Some("a fluent"),
            (Role::StaticBody, _) => Some("a static"),
            (Role::Body | Role::Head, _) => Some("a static or a fluent"),
        };
        if let Some(expected) = expected {
            let found = predicate.kind.describe();
            return self.fault(LanguageProblem::Kind { name: name.clone(), found, expected }, &atom.span);
        }
        self.arguments(name, &atom.arguments, &predicate.sorts, &atom.span, variables)
    }

    /// The head of a bridge law: a fluent of the coarse domain.
    fn bridge(&self, atom: &Atom, variables: &mut Variables) -> Result<(), LanguageError> {
        let coarse = self.coarse.map(|coarse| &coarse.predicates);
        let fluents = |p: &&Predicate| matches!(p.kind, Kind::Fluent(_));
        match coarse.and_then(|coarse| coarse.get(&atom.name.text)).filter(fluents) {
            Some(fluent) => {
                self.arguments(&atom.name.text, &atom.arguments, &fluent.sorts, &atom.span, variables)
            }
            None => {
                let names = coarse.into_iter().flatten().filter(|(_, p)| fluents(p)).map(|(name, _)| name);
                self.unknown("coarse fluent", &atom.name, names)
            }
        }
    }

    fn arguments(
        &self,
        name: &str,
        arguments: &[Expression],
        sorts: &[String],
        span: &Span,
        variables: &mut Variables,
    ) -> Result<(), LanguageError> {
        if arguments.len() != sorts.len() {
            let (found, expected) = (arguments.len(), sorts.len());
            return self.fault(LanguageProblem::Arguments { name: name.to_string(), found, expected }, span);
        }
        arguments.iter().zip(sorts).try_for_each(|(term, sort)| self.term(term, sort, variables))
    }

    /// A term where a sort is expected.
    fn term(&self, term: &Expression, sort: &str, variables: &mut Variables) -> Result<(), LanguageError> {
        let leaves = &self.domain.sorts[sort].leaves;
        let fits = match &term.what {
            Shape::Variable(variable) => {
                let sorts = &mut variables.sorts;
                match sorts.get(variable) {
                    Some(known) if self.domain.within(known, sort) => {}
                    Some(known) if !self.domain.within(sort, known) => {
                        let problem = LanguageProblem::Clash {
                            variable: variable.clone(),
                            first: known.clone(),
                            second: sort.to_string(),
                        };
                        return self.fault(problem, &term.span);
                    }
                    _ => {
                        sorts.insert(variable.clone(), sort.to_string());
                    }
                }
                true
            }
            Shape::Number(_) => leaves.contains(&Leaf::Number),
            // Which objects there are is known when there is a goal.
            Shape::Quoted(_) => leaves.iter().any(|leaf| matches!(leaf, Leaf::Open(_))),
            Shape::Function(name, arguments) if arguments.is_empty() => {
                leaves.contains(&Leaf::Constant(name.clone()))
            }
            Shape::Function(name, arguments) => {
                if leaves.contains(&Leaf::Function(name.clone())) {
                    let sorts = &self.domain.functions[name];
                    return self.arguments(name, arguments, sorts, &term.span, variables);
                }
                false
            }
            Shape::Sum(left, _, right) => {
                if leaves.contains(&Leaf::Number) {
                    self.term(left, NUMBER, variables)?;
                    return self.term(right, NUMBER, variables);
                }
                false
            }
        };
        if fits {
            return Ok(());
        }
        let text = self.domain.file.text().get(term.span.clone()).unwrap_or_default();
        let names = leaves.iter().filter_map(|leaf| match leaf {
            Leaf::Constant(name) | Leaf::Function(name) => Some(name.as_str()),
            _ => None,
        });
        let head = match &term.what {
            Shape::Function(name, _) => name.as_str(),
            _ => text,
        };
        let nearest = nearest(head, names).map(str::to_string);
        let problem = LanguageProblem::Sort { term: shorten(text), sort: sort.to_string(), nearest };
        self.fault(problem, &term.span)
    }

    /// What is defined must not depend on its own negation, however far around.
    fn stratified(&self) -> Result<(), LanguageError> {
        let defined = |name: &str| {
            matches!(self.domain.kind(name), Some(Kind::Static | Kind::Fluent(FluentKind::Defined)))
        };
        let mut needs: BTreeMap<&str, BTreeSet<&str>> = BTreeMap::new();
        let mut negations: Vec<(&str, &Literal)> = Vec::new();
        for law in &self.domain.laws {
            let Law::Holds { head } = &law.law else { continue };
            let name = head.atom.name.text.as_str();
            if !defined(name) {
                continue;
            }
            for condition in &law.body {
                if let Condition::Literal(literal) = condition
                    && defined(&literal.atom.name.text)
                {
                    needs.entry(name).or_default().insert(&literal.atom.name.text);
                    if !literal.positive {
                        negations.push((name, literal));
                    }
                }
            }
        }
        for (name, literal) in negations {
            let mut reached = BTreeSet::new();
            let mut open = vec![literal.atom.name.text.as_str()];
            while let Some(next) = open.pop() {
                if next == name {
                    return self
                        .fault(LanguageProblem::Negation { name: name.to_string() }, &literal.atom.span);
                }
                if reached.insert(next) {
                    open.extend(needs.get(next).into_iter().flatten());
                }
            }
        }
        Ok(())
    }
}

/// What is known of the variables of a law.
#[derive(Default)]
struct Variables {
    sorts: BTreeMap<String, String>,
    /// Those that a positive literal gives a value.
    bound: BTreeSet<String>,
}

/// Notes the variables that a positive literal binds: those that stand in it plainly, not in a sum.
fn bind(terms: &[Expression], variables: &mut Variables) {
    for term in terms {
        match &term.what {
            Shape::Variable(name) => {
                variables.bound.insert(name.clone());
            }
            Shape::Function(_, arguments) => bind(arguments, variables),
            Shape::Number(_) | Shape::Quoted(_) | Shape::Sum(..) => {}
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

/// No more of a term than a message needs.
fn shorten(text: &str) -> String {
    let mut short: String = text.chars().take(40).collect();
    if short.len() < text.len() {
        short.push('…');
    }
    short
}
