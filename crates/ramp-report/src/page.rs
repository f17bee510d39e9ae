//! The report as one HTML file that needs nothing else: no network, no font, no library. Light and dark, and to be
//! printed.

use std::fmt::Write;

use maud::{DOCTYPE, Markup, PreEscaped, html};

use crate::alone;
use crate::format::{NONE, seconds, share, small, time};
use crate::plot::{self, COLOURS};
use crate::report::{ClassPart, Report, TrackPart};
use crate::sums::{self, Comparison, Difference, Line, Scope};
use ramp_result::statistics::{DRAWS, FLIPS, SEED};

/// The page.
pub fn html(report: &Report) -> String {
    let episodes: usize = report.collection.entrants.iter().map(|it| it.files.len()).sum();
    let body = html! {
        (intro(report, episodes))
        @for part in &report.tracks {
            (track(report, part))
        }
        (alone::sections(&report.collection))
        @if !report.collection.entrants.is_empty() { (failures(report)) }
        @if !report.collection.entrants.is_empty() { (episodes_over_time(report)) }
        (method())
        (origin(report))
    };
    page("RAMP report", &body)
}

/// A whole page around `body`, with its colours and the switch between light and dark.
pub fn page(title: &str, body: &Markup) -> String {
    html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                title { (title) }
                style { (PreEscaped(colours())) (PreEscaped(include_str!("style.css"))) }
            }
            body {
                (body)
                script { (PreEscaped(SWITCH)) }
            }
        }
    }
    .into_string()
}

/// Changes between light and dark, and prints light.
const SWITCH: &str = "\
const root = document.documentElement;
const dark = () => root.dataset.theme
  ? root.dataset.theme === 'dark' : matchMedia('(prefers-color-scheme: dark)').matches;
document.querySelector('button')?.addEventListener('click', () => {
  root.dataset.theme = dark() ? 'light' : 'dark';
});";

/// The colours as CSS variables: light, dark by the system's wish or the reader's, and light on paper.
fn colours() -> String {
    let list = |pick: fn(&(&str, &'static str, &'static str)) -> &'static str| {
        let mut text = String::new();
        for colour in &COLOURS {
            let _ = write!(text, "--{}:{};", colour.0, pick(colour));
        }
        text
    };
    let (light, dark) = (list(|it| it.1), list(|it| it.2));
    format!(
        ":root{{{light}}}\n\
         @media screen and (prefers-color-scheme:dark){{:root:not([data-theme=light]){{{dark}}}}}\n\
         @media screen{{:root[data-theme=dark]{{{dark}color-scheme:dark}}:root[data-theme=light]{{color-scheme:light}}}}\n"
    )
}

fn percent(share: f64) -> String {
    format!("{:.1} %", 100.0 * share)
}

fn swatch(report: &Report, entrant: usize) -> Markup {
    let colour = plot::agent_colour(report.place(entrant));
    html! { span.swatch style=(format!("background:{colour}")) {} }
}

fn intro(report: &Report, episodes: usize) -> Markup {
    let tracks: Vec<&str> = report.tracks.iter().map(|part| part.track.as_str()).collect();
    let agents = report.collection.entrants.len();
    html! {
        header {
            div {
                h1 { "RAMP report" }
                p.soft {
                    (episodes) (if episodes == 1 { " episode" } else { " episodes" }) " of "
                    (agents) (if agents == 1 { " agent" } else { " agents" }) ", "
                    (if tracks.len() == 1 { "track " } else { "tracks " }) (tracks.join(", "))
                    ". Intervals are of 95 %."
                }
            }
            button type="button" { "light / dark" }
        }
        @if !report.notes.is_empty() {
            div.notes {
                strong { "Read this first" }
                ul { @for note in &report.notes { li { (note) } } }
            }
        }
        div.tiles {
            @for part in &report.tracks {
                @for class in &part.classes {
                    @for line in &class.lines { (tile(report, part, class, line)) }
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

fn tile(report: &Report, part: &TrackPart, class: &ClassPart, line: &Line) -> Markup {
    html! {
        div.tile {
            div.name { (swatch(report, line.entrant)) (report.label(line.entrant)) }
            div.soft { (class.name()) ", track " (part.track) ", " (line.summary.episodes) " episodes" }
            div.figure { (percent(line.summary.completion.mean)) }
            @if let Some(time) = line.summary.time {
                div { "in " (seconds(time.total)) " on average" }
                div.soft { "planning " (seconds(time.planning)) }
            }
        }
    }
}

fn track(report: &Report, part: &TrackPart) -> Markup {
    html! {
        @for class in &part.classes {
            h2 { (capital(class.name())) ", track " (part.track) }
            @if !class.lines.is_empty() {
                p.soft {
                    "Complete: episodes with every peg. ± is one sample standard deviation, over episodes; below it stands \
                     the interval of 95 %. How it is made is told at the end."
                }
                (table(report, class))
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
                    figure { (PreEscaped(report.curves(part, &Scope::Goal(goal.clone()), &[]))) }
                }
                @if class.goals.len() != 1 {
                    figure {
                        (PreEscaped(report.curves(part, &Scope::Class(class.class.clone()), &class.published)))
                    }
                }
            }
            @if !class.lines.is_empty() {
                h3 { "Where the time went" }
                figure { (PreEscaped(report.bars(class))) }
            }
            @if !class.comparisons.is_empty() { (comparisons(report, class)) }
        }
    }
}

fn capital(text: &str) -> String {
    let mut chars = text.chars();
    chars.next().map_or_else(String::new, |first| first.to_uppercase().chain(chars).collect())
}

fn table(report: &Report, class: &ClassPart) -> Markup {
    let one = class.lines.len() == 1;
    html! {
        div.wide {
            table {
                thead { tr {
                    th.name { "goal" }
                    @if !one { th.name { "agent" } }
                    th { "episodes" }
                    th { "complete" small { "%" } }
                    th { "completion" small { "%" } }
                    th { "best" small { "%" } }
                    th { "pegs" }
                    th { "total time" small { "s" } }
                    th { "planning" small { "s" } }
                    th { "compute" small { "s" } }
                    th { "robot" small { "s" } }
                } }
                tbody {
                    @for line in class.goal_lines.iter().chain(&class.lines) { (row(report, line, one)) }
                }
            }
        }
    }
}

fn row(report: &Report, line: &Line, one: bool) -> Markup {
    let sum = &line.summary;
    let class = matches!(line.scope, Scope::Class(_));
    let lost = sum.episodes - sum.finished;
    html! {
        tr.sum[class] {
            td.name { (line.scope.name()) }
            @if !one { td.name { (swatch(report, line.entrant)) (report.label(line.entrant)) } }
            td { (sum.episodes) @if lost > 0 { small.bad { (lost) " lost" } } }
            td { (line.complete) (small(Some(line.complete_interval), share)) }
            td {
                (share(sum.completion.mean))
                @if let Some(deviation) = sum.completion.deviation { " ± " (share(deviation)) }
                (small(line.completion_interval, share))
            }
            td {
                @if let Some(best) = sum.best { (share(best.completion)) small { "in " (time(best.total)) " s" } }
                @else { (NONE) }
            }
            td { (sum.pegs_counted) "/" (sum.pegs) }
            @if let Some(mean) = sum.time {
                td {
                    (time(mean.total))
                    @if let Some(deviation) = mean.total_deviation { " ± " (time(deviation)) }
                    (small(line.total_interval, time))
                }
                td { (format!("{:.2}", mean.planning)) }
                td { (format!("{:.2}", mean.compute)) }
                td { (time(mean.robot)) }
            } @else {
                @for _ in 0..4 { td { (NONE) } }
            }
        }
    }
}

fn published(class: &ClassPart) -> Markup {
    html! {
        @for it in &class.published {
            p {
                strong { (it.name) } ": " (percent(it.completion)) " in " (seconds(it.total)) ", planning "
                (format!("{:.0}", it.planning[0])) " to " (seconds(it.planning[1])) ", mean of " (it.goals)
                (if it.goals == 1 { " goal" } else { " goals" }) " run " (it.repeats) " times on " (it.robot)
                ". Published as means alone, so that there is no interval and no test against them. "
                span.soft { (it.source) }
            }
        }
    }
}

fn comparisons(report: &Report, class: &ClassPart) -> Markup {
    html! {
        h3 { "Agents compared" }
        p.soft {
            "The first agent minus the second, on the goals and seeds that both have. Total time where both are complete."
        }
        div.wide {
            table {
                thead { tr {
                    th.name { "first" } th.name { "second" } th.name { "measure" }
                    th { "pairs" } th { "mean difference" } th { "p" } th { "p, corrected" } th.name { "" }
                } }
                tbody {
                    @for comparison in &class.comparisons {
                        (difference(report, comparison, "completion", Some(&comparison.completion), |it| format!("{:+.1} %", 100.0 * it)))
                        (difference(report, comparison, "total time", comparison.total.as_ref(), |it| format!("{it:+.1} s")))
                    }
                }
            }
        }
    }
}

fn difference(
    report: &Report,
    comparison: &Comparison,
    measure: &str,
    test: Option<&Difference>,
    say: fn(f64) -> String,
) -> Markup {
    let [one, two] = comparison.entrants;
    let p = |p: f64| if p < 0.0001 { "< 0.0001".to_string() } else { format!("{p:.4}") };
    html! {
        tr {
            td.name { (swatch(report, one)) (report.label(one)) }
            td.name { (swatch(report, two)) (report.label(two)) }
            td.name { (measure) }
            @if let Some(test) = test {
                td { (test.pairs) }
                td { (say(test.mean)) (small(test.interval, say)) }
                td { (p(test.p)) }
                td { (p(test.corrected)) }
                td.name { (if test.corrected < 0.05 { "differs" } else { "no difference shown" }) }
            } @else {
                td { "0" }
                @for _ in 0..3 { td { (NONE) } }
                td.name { "never both complete" }
            }
        }
    }
}

fn failures(report: &Report) -> Markup {
    html! {
        h2 { "Failures by cause" }
        @for (index, entrant) in report.collection.entrants.iter().enumerate() {
            @let failures = sums::failures(entrant);
            h3 { (swatch(report, index)) (entrant.label) ", track " (entrant.identity.track) }
            @if failures.is_empty() {
                p { "Every episode is complete." }
            } @else {
                div.wide {
                    table {
                        thead { tr { th { "episodes" } th.name { "cause" } th.name { "which, and what was said" } } }
                        tbody {
                            @for failure in &failures {
                                tr {
                                    td { (failure.episodes.len()) }
                                    td.long { (failure.cause) }
                                    td.long {
                                        @for (goal, seed, reason) in &failure.episodes {
                                            div { (goal) ", seed " (seed) ": " span.soft { (reason) } }
                                        }
                                    }
                                }
                            }
                        }
                    }
                }
            }
        }
    }
}

fn episodes_over_time(report: &Report) -> Markup {
    html! {
        h2 { "Every episode over time" }
        p.soft { "A line is an episode: its goal and seed. Point at a mark or a stretch to read what it was." }
        @for part in &report.tracks {
            @for class in &part.classes {
                @for &entrant in &part.entrants {
                    @if let Some(svg) = report.timeline(entrant, class) {
                        h3 {
                            (swatch(report, entrant)) (report.label(entrant)) ": " (class.name()) ", track " (part.track)
                        }
                        figure { (PreEscaped(svg)) }
                    }
                }
            }
        }
    }
}

fn method() -> Markup {
    html! {
        h2 { "How the numbers are made" }
        p {
            "Completion of an episode is pegs that count / pegs in the goal; the mean is over episodes, and a lost episode \
             (crashed, killed, or out of time on the wall) counts as one without pegs. Means of time are over the episodes \
             that have a result, complete or not."
        }
        p {
            "The pegs of an episode are not independent: where one is not seated, later ones often cannot be. So no interval \
             is made from pegs; the unit is the episode. " strong { "Complete" } " is the number of episodes with every peg \
             and Wilson's interval of their share. " strong { "Completion" } " and " strong { "times" } " have a percentile \
             bootstrap of " (DRAWS) " draws of episodes, each goal from its own, for the goals are chosen and not sampled. \
             Where all episodes are complete, or none has a peg, a bootstrap can draw nothing else; then the interval is \
             Wilson's of the share of such episodes, which is wider than the truth on the safe side. With five repeats of a \
             goal all these intervals are rough."
        }
        p {
            strong { "Comparisons" } " pair episodes of one goal and seed: two-sided sign-flip (paired permutation) test of \
             the mean difference, exact up to 20 pairs that differ, else of " (FLIPS) " draws. The corrected p is Holm's, \
             over all tests of this report; “differs” is below 0.05. All draws come from named streams of the seed " (SEED)
            ": the same results give the same report to the last bit."
        }
        p {
            "Robot time is cut by the events of a result: an action begins with " code { "start" } " and ends with "
            code { "done" } ", or where the next one starts. Time outside actions, and all time of an agent that tells no \
             events, is “between actions”."
        }
    }
}

/// The first digits of a hash from a file.
fn short(hash: Option<&str>) -> String {
    hash.map_or_else(|| NONE.to_string(), |hash| hash.chars().take(16).collect())
}

fn origin(report: &Report) -> Markup {
    html! {
        h2 { "Where this comes from" }
        @for (index, entrant) in report.collection.entrants.iter().enumerate() {
            @let it = &entrant.identity;
            h3 { (swatch(report, index)) (it.agent) " " (it.agent_version) ", track " (it.track) }
            p {
                @if let Some(real) = &it.real {
                    "A real robot: " (real.robot) ". Scored by " (real.scorer) ". " (real.source) ". "
                } @else {
                    "In the twin. "
                }
                "ramp " (it.version) " (" code { (it.commit) } "), rules " (ramp_result::episode::RULES) ", schema "
                code { (ramp_result::episode::SCHEMA) } "."
                @if let Some(file) = entrant.files.first() {
                    " Computer: " (file.result.host.cpu) ", " (file.result.host.cores) " threads."
                }
            }
            div.wide {
                table {
                    thead { tr {
                        th.name { "file" } th.name { "goal" } th { "seed" } th { "completion" } th { "total time" }
                        th.name { "ended" } th.name { "SHA-256" } th.name { "of its log" }
                    } }
                    tbody {
                        @for file in &entrant.files {
                            tr {
                                td.name { (file.path.file_name().unwrap_or_default().to_string_lossy()) }
                                td.name { (file.result.goal) }
                                td { (file.result.seed) }
                                td { (percent(file.result.completion)) }
                                td { (seconds(file.result.time.total)) }
                                td.long { (file.result.ended.reason) }
                                td.name { code { (&file.sha256[..16]) } }
                                td.name { code { (short(file.result.log.as_deref())) } }
                            }
                        }
                    }
                }
            }
        }
    }
}
