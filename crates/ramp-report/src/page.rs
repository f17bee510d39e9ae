//! The report as HTML: one file for a few agents; for many, a front page with sums and a page per
//! agent.

mod comparisons;
mod details;
mod method;
mod view;

use maud::{Markup, PreEscaped, html};

use self::comparisons::comparisons;
use self::details::{episodes_over_time, failures, origin};
use self::method::method;
use self::view::View;
use crate::alone;
use crate::columns::{self, Column, Row, name, number};
use crate::format::{NONE, counted, percent, seconds, share, small, time};
use crate::report::{ClassPart, MOST, Report, TrackPart};
use crate::shell::page;
use crate::sums::{self, Line, Scope};
pub use view::agent_page;

/// Number of lines per class on the front page of many agents.
const LINES: usize = 100;
/// Number of notes on the front page of many agents.
const NOTES: usize = 20;

/// The full page, for a few agents.
pub fn html(report: &Report) -> String {
    whole(report, None)
}

/// The page of one agent of many. `back` is the target and the text of its link back.
pub fn of_agent(report: &Report, back: (&str, &str)) -> String {
    whole(report, Some(back))
}

fn whole(report: &Report, back: Option<(&str, &str)>) -> String {
    let view = View { report, folder: None };
    let body = html! {
        @if let Some((href, text)) = back { p { a href=(href) { "← " (text) } } }
        (intro(view))
        @for part in &report.tracks {
            (track(view, part))
        }
        (alone::sections(&report.collection))
        @if !report.collection.entrants.is_empty() {
            (failures(view))
            (episodes_over_time(view))
        }
        @if !report.tracks.is_empty() { (method()) }
        @if !report.collection.entrants.is_empty() { (origin(view)) }
    };
    page("RAMP report", &body)
}

/// The front page of many agents: sums of all, plots and comparisons of the best. `folder` holds
/// the page of each agent, named by [`agent_page`].
pub fn front(report: &Report, folder: &str) -> String {
    let view = View { report, folder: Some(folder) };
    let body = html! {
        (intro(view))
        @for part in &report.tracks {
            (track(view, part))
        }
        (alone::sections(&report.collection))
        (agents(view))
        (method())
    };
    page("RAMP report", &body)
}

fn intro(view: View) -> Markup {
    let report = view.report;
    let episodes: usize = report.collection.entrants.iter().map(|it| it.files.len()).sum();
    let tracks: Vec<String> = report.tracks.iter().map(TrackPart::title).collect();
    let agents = report.collection.entrants.len();
    let (first, more) = report.notes.split_at(match view.folder {
        Some(_) => report.notes.len().min(NOTES),
        None => report.notes.len(),
    });
    html! {
        header {
            div {
                h1 { "RAMP report" }
                p.soft {
                    @if agents == 0 {
                        "Verdicts on single abilities."
                    } @else {
                        (counted(episodes, "episode", "episodes")) " of " (counted(agents, "agent", "agents"))
                        @if tracks.len() == 1 { ", track " (tracks[0]) }
                        ". Intervals are of 95 %."
                    }
                    @if view.folder.is_some() {
                        " Tiles, charts and comparisons are of the " (MOST) " best agents of each class. Each agent has \
                         a page of its own, with its goals, failures, episodes and files."
                    }
                }
                @if tracks.len() > 1 {
                    p.soft { "Results of these are never added up or compared:" }
                    ul.soft { @for it in &tracks { li { "track " (it) } } }
                }
            }
            button type="button" { "light / dark" }
        }
        @if !first.is_empty() {
            div.notes {
                strong { "Read this first" }
                ul {
                    @for note in first { li { (note) } }
                    @if !more.is_empty() { li { (more.len()) " more notes are on the pages of the agents" } }
                }
            }
        }
        div.tiles {
            @for part in &report.tracks {
                @for class in &part.classes {
                    @for line in shown_lines(class) { (tile(view, part, class, line)) }
                    @for it in &class.published {
                        div.tile {
                            div.name { (it.name) }
                            div.soft { (it.class) ", track " (it.track) ", published" }
                            div.figure { (percent(it.completion)) }
                            div { "in " (seconds(it.total)) " on average" }
                            div.soft { "planning " (format!("{:.0}", it.planning[0])) " to " (seconds(it.planning[1])) }
                        }
                    }
                }
            }
        }
    }
}

/// The lines of the plotted agents, in their order.
fn shown_lines(class: &ClassPart) -> impl Iterator<Item = &Line> {
    class.shown.iter().filter_map(|entrant| class.lines.iter().find(|line| line.entrant == *entrant))
}

/// All agents, with links to their pages.
fn agents(view: View) -> Markup {
    html! {
        h2 { "All agents" }
        (columns::table(
            &[name("agent"), name("track"), number("episodes", "")],
            view.report.collection.entrants.iter().enumerate().map(|(index, entrant)| vec![
                view.name(index),
                html! { (entrant.identity.track) },
                html! { (entrant.files.len() + entrant.lost.len()) },
            ]),
        ))
    }
}

fn tile(view: View, part: &TrackPart, class: &ClassPart, line: &Line) -> Markup {
    html! {
        div.tile {
            div.name { (view.name(line.entrant)) }
            div.soft { (class.name()) ", track " (part.title()) ", " (counted(line.summary.episodes, "episode", "episodes")) }
            div.figure { (percent(line.summary.completion.mean)) }
            @if let Some(time) = line.summary.time {
                div { "in " (seconds(time.total)) " on average" }
                div.soft { "planning " (seconds(time.planning)) }
            }
        }
    }
}

fn track(view: View, part: &TrackPart) -> Markup {
    let report = view.report;
    html! {
        @for class in &part.classes {
            h2 { (capital(class.name())) ", track " (part.title()) }
            @if !class.lines.is_empty() {
                p.soft {
                    "Complete: episodes with every peg, below it the interval of their share. ± is one sample standard deviation, over episodes; below it stands \
                     the interval of 95 %. How it is made is told at the end."
                }
                (table(view, class))
            }
            @if !class.published.is_empty() { (published(class)) }
            h3 { "Completion over time" }
            @if !class.lines.is_empty() { p.soft {
                "Thick: mean of all episodes, with a band of one sample standard deviation. Dashed: the best episode. An \
                 episode that has ended keeps what it had: the dot is where the last one ended, and dots go on from there. Time is planning, compute \
                 and robot time together."
            } }
            div.charts {
                @for goal in &class.goals {
                    figure { (PreEscaped(report.curves(class, &Scope::Goal(goal.clone()), &[]))) }
                }
                @if class.goals.len() != 1 {
                    figure {
                        (PreEscaped(report.curves(class, &Scope::Class(class.class.clone()), &class.published)))
                    }
                }
            }
            @if !class.lines.is_empty() {
                h3 { "Where the time went" }
                figure.wide { (PreEscaped(report.bars(class))) }
            }
            @if !class.comparisons.is_empty() { (comparisons(view, class)) }
        }
    }
}

pub(crate) fn capital(text: &str) -> String {
    let mut chars = text.chars();
    chars.next().map_or_else(String::new, |first| first.to_uppercase().chain(chars).collect())
}

/// The rows of each goal and the class; for many agents of the class alone, the best first.
fn table(view: View, class: &ClassPart) -> Markup {
    let one = class.lines.len() == 1;
    let mut lines: Vec<&Line> = class.lines.iter().collect();
    if view.folder.is_some() {
        lines.sort_by(|a, b| sums::better(a, b).then(a.entrant.cmp(&b.entrant)));
        lines.truncate(LINES);
    } else {
        lines.splice(..0, class.goal_lines.iter().chain(&class.size_lines));
    }
    let columns: Vec<Column> = COLUMNS
        .into_iter()
        .enumerate()
        .filter(|(index, _)| !(one && *index == AGENT))
        .map(|it| it.1)
        .collect();
    html! {
        @if lines.len() < class.lines.len() {
            p.soft { "The " (LINES) " best of " (class.lines.len()) " agents." }
        }
        (columns::table(&columns, lines.into_iter().map(|line| row(view, line, one))))
    }
}

/// The columns of a class.
const COLUMNS: [Column; 13] = [
    name("goal"),
    name("agent"),
    number("episodes", ""),
    number("complete", "episodes"),
    number("completion", "%"),
    number("best", "%"),
    number("pegs", ""),
    number("total time", "s"),
    number("planning", "s"),
    number("compute", "s"),
    number("robot", "s"),
    number("bound", "s"),
    number("reference", "s"),
];
/// The index of the agent's column, which a report of one agent does not need.
const AGENT: usize = 1;

fn row(view: View, line: &Line, one: bool) -> Row {
    let sum = &line.summary;
    let mut cells = vec![html! { (line.scope.name()) }];
    if !one {
        cells.push(view.name(line.entrant));
    }
    cells.extend([
        html! { (sum.episodes) @if sum.technical > 0 { small.bad { (sum.technical) " technical" } } },
        html! { (line.complete) " of " (sum.episodes) (small(Some(line.complete_interval), percent)) },
        html! {
            (share(sum.completion.mean))
            @if let Some(deviation) = sum.completion.deviation { " ± " (share(deviation)) }
            (small(line.completion_interval, share))
        },
        html! {
            @if let Some(best) = sum.best { (share(best.completion)) small { "in " (time(best.total)) " s" } }
            @else { (NONE) }
        },
        html! { (sum.pegs_counted) "/" (sum.pegs) },
    ]);
    match sum.time {
        Some(mean) => {
            let compared = |it: Option<f64>| html! { (it.map_or_else(|| NONE.to_string(), time)) };
            cells.extend([
                html! {
                    (time(mean.total))
                    @if let Some(deviation) = mean.total_deviation { " ± " (time(deviation)) }
                    (small(line.total_interval, time))
                },
                html! { (format!("{:.2}", mean.planning)) },
                html! { (format!("{:.2}", mean.compute)) },
                html! { (time(mean.robot)) },
                compared(mean.compared.map(|it| it.bound)),
                compared(mean.compared.map(|it| it.reference)),
            ]);
        }
        None => cells.extend([NONE; 6].map(|none| html! { (none) })),
    }
    Row { cells, is_sum: view.folder.is_none() && !matches!(line.scope, Scope::Goal(_)) }
}

fn published(class: &ClassPart) -> Markup {
    html! {
        @for it in &class.published {
            p {
                strong { (it.name) } ": " (percent(it.completion)) " in " (seconds(it.total)) ", planning "
                (format!("{:.0}", it.planning[0])) " to " (seconds(it.planning[1])) ", mean of "
                (counted(it.goals, "goal", "goals")) " run " (it.repeats)
                (if it.repeats == 1 { " time" } else { " times" }) " on " (it.robot)
                ". Published as means alone, so that there is no interval and no test against them. "
                span.soft { (it.source) }
            }
        }
    }
}
