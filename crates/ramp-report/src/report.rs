//! The report: results of one or several agents, summed up, drawn and compared.
//!
//! [`Report`] holds all numbers, which the other files write as a page, as CSV and as LaTeX. Agents
//! of different tracks are never compared.

mod notes;

use self::notes::notes;
pub use self::notes::repeats;
use crate::sums::{Comparison, Line, Scope};
use crate::{curves, plot, sums};
use ramp_assembly::Size;
use ramp_result::collection::{Collection, Setting, class_rank};
use ramp_result::episode::RobotKind;
use ramp_result::published::Published;
use ramp_result::statistics::holm;

/// Largest number of agents that one page shows in full. With more, a page plots and compares this
/// number of the best ones of each class, and each agent has a page of its own. Each of them has a colour.
pub const MOST: usize = plot::AGENTS;

/// All numbers of the report.
#[derive(Clone, Debug)]
pub struct Report {
    /// The results.
    pub collection: Collection,
    /// One for each track.
    pub tracks: Vec<TrackPart>,
    /// Deviations from the protocol, and other notes for the reader.
    pub notes: Vec<String>,
}

/// The report on one track.
#[derive(Clone, Debug)]
pub struct TrackPart {
    /// The conditions that its agents share.
    pub setting: Setting,
    /// Its agents, as indices into the collection.
    pub entrants: Vec<usize>,
    /// One for each class.
    pub classes: Vec<ClassPart>,
}

/// The report on one class of one track.
#[derive(Clone, Debug)]
pub struct ClassPart {
    /// The class.
    pub class: Option<String>,
    /// Its goals.
    pub goals: Vec<String>,
    /// Lines of each goal in turn.
    pub goal_lines: Vec<Line>,
    /// Lines of each size of a set of the open class.
    pub size_lines: Vec<Line>,
    /// Lines of the class.
    pub lines: Vec<Line>,
    /// Each pair of agents.
    pub comparisons: Vec<Comparison>,
    /// The agents that a page plots and compares, as indices into the collection: all, or the best
    /// ones of many.
    pub shown: Vec<usize>,
    /// Published means of the class.
    pub published: Vec<Published>,
}

impl ClassPart {
    /// Its name, for a person.
    pub fn name(&self) -> &str {
        self.class.as_deref().unwrap_or("goals without a class")
    }

    /// The name of the part of it that a line is of, for a person.
    pub fn name_of(&self, line: &Line) -> String {
        match &line.scope {
            Scope::Size(class, size) => format!("{class}, {size}"),
            Scope::Goal(goal) => goal.clone(),
            Scope::Class(_) => self.name().to_string(),
        }
    }
}

/// A figure or table as a file: its name without an extension, and its text.
pub struct Named {
    /// Letters, digits and hyphens.
    pub name: String,
    /// Its content.
    pub text: String,
}

impl Report {
    /// Computes all sums.
    pub fn new(collection: Collection) -> Report {
        let mut settings: Vec<Setting> = collection.entrants.iter().map(|it| it.identity.setting()).collect();
        for published in &collection.published {
            if !settings.iter().any(|it| it.track == published.track) {
                let track = published.track.clone();
                settings.push(Setting {
                    track,
                    arm: None,
                    world: None,
                    start: None,
                    robot: Some(RobotKind::Arm),
                    asynchronous: false,
                });
            }
        }
        let rank = |name: &String| ramp_robot::Track::ALL.iter().position(|track| track.name() == name);
        settings.sort_by_key(|it| {
            let (arm, world, start) = (it.arm.clone(), it.world.clone(), it.start.clone());
            (rank(&it.track), it.robot, it.asynchronous, arm, world, start)
        });
        settings.dedup();
        let mut parts: Vec<TrackPart> =
            settings.into_iter().map(|setting| TrackPart::new(&collection, setting)).collect();
        correct(&mut parts);
        let notes = notes(&collection);
        Report { collection, tracks: parts, notes }
    }

    /// Whether there are too many agents for one page.
    pub fn is_large(&self) -> bool {
        is_large(&self.collection)
    }

    /// The report of one agent of many.
    pub fn of_agent(&self, entrant: usize) -> Report {
        Report::new(one_agent(&self.collection, entrant))
    }

    /// The index of an agent among the plotted ones, which determines its colour: the same on all tracks.
    /// Where there are too many for one page, it is the index on its track.
    pub fn place(&self, entrant: usize) -> Option<usize> {
        let drawn = |it: &usize| {
            self.tracks.iter().flat_map(|part| &part.classes).any(|class| class.shown.contains(it))
        };
        if !drawn(&entrant) {
            return None;
        }
        let who = |index: usize| self.collection.entrants[index].identity.who();
        let own = self.tracks.iter().find(|part| part.entrants.contains(&entrant))?;
        let together = |other: &usize| !self.is_large() || own.entrants.contains(other);
        let mut agents = Vec::new();
        for index in (0..self.collection.entrants.len()).filter(|it| drawn(it) && together(it)) {
            if !agents.contains(&who(index)) {
                agents.push(who(index));
            }
        }
        agents.iter().position(|it| *it == who(entrant))
    }

    /// The label of an agent.
    pub fn label(&self, entrant: usize) -> &str {
        &self.collection.entrants[entrant].label
    }

    /// The curves of a class, or of a goal in it, as a figure.
    pub fn curves(&self, class: &ClassPart, scope: &Scope, published: &[Published]) -> String {
        let collection = &self.collection;
        let curves: Vec<(usize, curves::Curves)> = class
            .shown
            .iter()
            .filter_map(|&entrant| {
                let who = &collection.entrants[entrant];
                let results: Vec<_> = sums::results(collection, who, scope).collect();
                let in_scope =
                    |name: &str| collection.goals.iter().any(|goal| goal.name == name && scope.holds(goal));
                let lost = who.lost.iter().filter(|lost| in_scope(&lost.goal)).count();
                Some((entrant, curves::curves(&results, lost)?))
            })
            .collect();
        let series: Vec<plot::Series> = curves
            .iter()
            .map(|(entrant, curves)| plot::Series {
                label: self.label(*entrant),
                place: self.place(*entrant).unwrap_or(0),
                curves,
            })
            .collect();
        let marks: Vec<plot::Mark> = published
            .iter()
            .map(|it| plot::Mark { label: &it.name, time: it.total, completion: it.completion })
            .collect();
        plot::curves(scope.name(), &series, &marks)
    }

    /// Mean times of each agent, on each goal of a class and on the class.
    pub fn bars(&self, class: &ClassPart) -> String {
        let bars: Vec<plot::Bar> = class
            .goal_lines
            .iter()
            .chain(&class.lines)
            .filter(|line| class.shown.contains(&line.entrant))
            .filter_map(|line| {
                let time = line.summary.time?;
                let mut parts = vec![time.planning, time.compute];
                parts.extend(line.activities);
                let label = format!("{}, {}", line.scope.name(), self.label(line.entrant));
                Some(plot::Bar { label, parts })
            })
            .collect();
        plot::bars(&format!("Where the time went, {}", class.name()), &bars)
    }

    /// The episodes of an agent over time, those of one class.
    pub fn timeline(&self, entrant: usize, class: &ClassPart) -> Option<String> {
        let who = &self.collection.entrants[entrant];
        let scope = Scope::Class(class.class.clone());
        let episodes: Vec<_> = sums::results(&self.collection, who, &scope).collect();
        let title = format!("Episodes of {}, {}", who.label, class.name());
        (!episodes.is_empty()).then(|| plot::timeline(&title, &episodes))
    }

    /// Every figure as a file of its own, light, on white.
    pub fn figures(&self) -> Vec<Named> {
        let mut figures = Vec::new();
        let mut add = |name: &str, svg: &str| {
            let name = file_name(name, &figures);
            figures.push(Named { name, text: plot::standalone(svg) });
        };
        for part in &self.tracks {
            let track = &part.slug();
            for class in &part.classes {
                for goal in &class.goals {
                    let svg = self.curves(class, &Scope::Goal(goal.clone()), &[]);
                    add(&format!("curves-{track}-{goal}"), &svg);
                }
                let scope = Scope::Class(class.class.clone());
                let name = scope.name();
                add(&format!("curves-{track}-{name}"), &self.curves(class, &scope, &class.published));
                if class.lines.is_empty() {
                    continue;
                }
                add(&format!("time-{track}-{name}"), &self.bars(class));
                for &entrant in &part.entrants {
                    if let Some(svg) = self.timeline(entrant, class) {
                        add(&format!("episodes-{track}-{name}-{}", self.label(entrant)), &svg);
                    }
                }
            }
        }
        figures
    }
}

/// A unique file name made from untrusted text.
fn file_name(text: &str, others: &[Named]) -> String {
    let plain: String = text
        .chars()
        .take(80)
        .map(|c| if c.is_ascii_alphanumeric() || c == '.' { c.to_ascii_lowercase() } else { '-' })
        .collect();
    let taken = |name: &str| others.iter().any(|other| other.name == name);
    let mut name = plain.clone();
    let mut number = 2;
    while taken(&name) {
        name = format!("{plain}-{number}");
        number += 1;
    }
    name
}

impl TrackPart {
    /// Track, real robot or twin, arm, world, start and pace, for a person.
    pub fn title(&self) -> String {
        let Setting { track, arm, world, start, robot, asynchronous } = &self.setting;
        let robot = format!(", {}", robot.map_or("twin", RobotKind::words));
        let arm = arm.iter().map(|arm| format!(", arm {arm}"));
        let world = world.iter().map(|world| format!(", world {world}"));
        let start = start.iter().map(|start| format!(", start {start}"));
        let pace = asynchronous.then(|| ", async".to_string());
        [track.clone(), robot].into_iter().chain(arm).chain(world).chain(start).chain(pace).collect()
    }

    /// The same for a file name: letters, digits and hyphens.
    pub fn slug(&self) -> String {
        let Setting { track, arm, world, start, robot, asynchronous } = &self.setting;
        let robot = robot.map_or(String::new(), |kind| format!("-{}", kind.words()));
        let pace = asynchronous.then(|| "async".to_string());
        let conditions = arm.iter().chain(world).chain(start).chain(&pace).map(|it| format!("-{it}"));
        let plain = |c: char| if c.is_ascii_alphanumeric() { c.to_ascii_lowercase() } else { '-' };
        let name: String = [track.clone(), robot].into_iter().chain(conditions).collect();
        name.chars().map(plain).collect()
    }

    fn new(collection: &Collection, setting: Setting) -> TrackPart {
        let track = &setting.track;
        let of = |index: &usize| &collection.entrants[*index].identity;
        let entrants: Vec<usize> =
            (0..collection.entrants.len()).filter(|index| of(index).setting() == setting).collect();
        let worked_on = |name: &str| {
            entrants.iter().any(|index| {
                let entrant = &collection.entrants[*index];
                entrant.files.iter().any(|file| file.result.goal == name)
            })
        };
        let mut classes: Vec<Option<String>> = collection
            .goals
            .iter()
            .filter(|goal| worked_on(&goal.name))
            .map(|goal| goal.class.clone())
            .chain(
                collection.published.iter().filter(|it| it.track == *track).map(|it| Some(it.class.clone())),
            )
            .collect();
        classes.sort_by_key(|class| class_rank(class.as_deref()));
        classes.dedup();
        let classes = classes
            .into_iter()
            .map(|class| {
                let scope = Scope::Class(class.clone());
                let goals: Vec<String> = collection
                    .goals
                    .iter()
                    .filter(|goal| goal.class == class && worked_on(&goal.name))
                    .map(|goal| goal.name.clone())
                    .collect();
                let lines = |scope: &Scope| {
                    entrants
                        .iter()
                        .filter_map(|entrant| sums::line(collection, *entrant, scope))
                        .collect::<Vec<_>>()
                };
                let goal_lines = goals.iter().flat_map(|goal| lines(&Scope::Goal(goal.clone()))).collect();
                let sizes =
                    Size::ALL.into_iter().flat_map(|size| Some(Scope::Size(class.clone()?, size.name())));
                let size_lines = sizes.flat_map(|scope| lines(&scope)).collect();
                let pairs = entrants
                    .iter()
                    .enumerate()
                    .flat_map(|(index, one)| entrants[index + 1..].iter().map(move |two| [*one, *two]));
                let comparisons = pairs.filter_map(|pair| sums::compare(collection, pair, &scope)).collect();
                let published = collection.published.iter();
                let published =
                    published.filter(|it| Some(&it.class) == class.as_ref() && it.track == *track);
                let published = published.cloned().collect();
                let lines = lines(&scope);
                let shown = shown(&lines, is_large(collection));
                ClassPart { lines, class, goals, goal_lines, size_lines, comparisons, shown, published }
            })
            .collect();
        TrackPart { setting, entrants, classes }
    }
}

fn is_large(collection: &Collection) -> bool {
    collection.entrants.len() > MOST
}

/// The agents of a class to plot: all, in their order, or the best ones of many, the best first.
fn shown(lines: &[Line], is_large: bool) -> Vec<usize> {
    let mut lines: Vec<&Line> = lines.iter().collect();
    if is_large {
        lines.sort_by(|a, b| sums::better(a, b).then(a.entrant.cmp(&b.entrant)));
        lines.truncate(MOST);
    }
    lines.into_iter().map(|line| line.entrant).collect()
}

/// The part of a collection that belongs to one agent of many.
pub fn one_agent(collection: &Collection, entrant: usize) -> Collection {
    let entrants = vec![collection.entrants[entrant].clone()];
    let worked_on = |goal: &str| {
        let mut files = entrants.iter().flat_map(|it| &it.files).map(|file| &file.result.goal);
        let mut lost = entrants.iter().flat_map(|it| &it.lost).map(|lost| &lost.goal);
        files.any(|it| it == goal) || lost.any(|it| it == goal)
    };
    Collection {
        goals: collection.goals.iter().filter(|goal| worked_on(&goal.name)).cloned().collect(),
        entrants,
        published: Vec::new(),
        plans: Vec::new(),
        perception: Vec::new(),
        trials: Vec::new(),
        notes: Vec::new(),
    }
}

/// Holm's correction over all tests of the report.
fn correct(parts: &mut [TrackPart]) {
    let mut tests: Vec<&mut sums::Difference> = parts
        .iter_mut()
        .flat_map(|part| &mut part.classes)
        .flat_map(|class| &mut class.comparisons)
        .flat_map(|it| std::iter::once(&mut it.completion).chain(it.total.as_mut()))
        .collect();
    let corrected = holm(&tests.iter().map(|test| test.p).collect::<Vec<_>>());
    for (test, corrected) in tests.iter_mut().zip(corrected) {
        test.corrected = corrected;
    }
}
