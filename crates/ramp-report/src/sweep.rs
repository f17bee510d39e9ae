//! Completion and time against a quantity of the world: the results of a sweep, as a table, a
//! figure and a page.

use std::fmt::Write;

use maud::{Markup, PreEscaped, html};
use ramp_result::EpisodeResult;
use ramp_result::statistics::{Interval, wilson};
use ramp_result::summary::Spread;
use serde::Serialize;

use crate::columns::{Column, name, number, table};
use crate::format::{share, small};
use crate::plot::{agent_colour, axis_step, head, label, standalone, words};
use crate::shell;

/// A sweep: episodes in worlds that differ in one quantity.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Sweep {
    /// The quantity that was varied, such as `friction.coulomb`.
    pub quantity: String,
    /// Its unit; empty when it has none.
    pub unit: String,
    /// Its meaning.
    pub meaning: String,
    /// The world in which it was varied.
    pub world: String,
    /// The track.
    pub track: String,
    /// The goals.
    pub goals: Vec<String>,
    /// The first and the last seed of each goal.
    pub seeds: [u64; 2],
    /// The version of the program and its commit.
    pub software: String,
    /// One curve, or one for each value of a second quantity.
    pub curves: Vec<Curve>,
}

/// Results at each value.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Curve {
    /// Its distinguishing label; empty for a single curve.
    pub label: String,
    /// By value.
    pub points: Vec<Point>,
}

/// Results at one value.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Point {
    /// The value.
    pub value: f64,
    /// Number of episodes.
    pub episodes: usize,
    /// Number of complete ones.
    pub complete: usize,
    /// Wilson's interval of their share, 95 %.
    pub interval: Interval,
    /// Counted pegs, and all pegs, of all episodes together.
    pub pegs: [usize; 2],
    /// Robot time of the complete episodes, s.
    pub robot: Option<Spread>,
}

impl Point {
    /// The point of some episodes: the pegs in the goal of each, and its result if it has one.
    pub fn of(value: f64, episodes: &[(usize, Option<&EpisodeResult>)]) -> Point {
        let results = || episodes.iter().filter_map(|(_, result)| *result);
        let complete: Vec<&EpisodeResult> = results().filter(|it| crate::sums::is_complete(it)).collect();
        let times: Vec<f64> = complete.iter().map(|it| it.time.robot).collect();
        Point {
            value,
            episodes: episodes.len(),
            complete: complete.len(),
            interval: wilson(complete.len(), episodes.len()),
            pegs: [results().map(EpisodeResult::counted).sum(), episodes.iter().map(|(pegs, _)| pegs).sum()],
            robot: Spread::of(&times),
        }
    }
}

impl Sweep {
    /// The quantity with its unit.
    fn axis(&self) -> String {
        if self.unit.is_empty() { self.quantity.clone() } else { format!("{}, {}", self.quantity, self.unit) }
    }

    /// As CSV, one line for each point.
    pub fn csv(&self) -> String {
        let mut text = String::from(
            "quantity,curve,value,episodes,complete,share_low,share_high,pegs,of,robot_s,robot_deviation_s\n",
        );
        for curve in &self.curves {
            for point in &curve.points {
                let of = |pick: fn(&Spread) -> Option<f64>| {
                    point.robot.as_ref().and_then(pick).map_or(String::new(), |it| format!("{it:.2}"))
                };
                let _ = writeln!(
                    text,
                    "{},{},{},{},{},{:.4},{:.4},{},{},{},{}",
                    self.quantity,
                    curve.label.replace(',', ";"),
                    point.value,
                    point.episodes,
                    point.complete,
                    point.interval.low,
                    point.interval.high,
                    point.pegs[0],
                    point.pegs[1],
                    of(|it| Some(it.mean)),
                    of(|it| it.deviation),
                );
            }
        }
        text
    }

    /// The figure as a file of its own, light, on white.
    pub fn figure(&self) -> String {
        standalone(&self.svg())
    }

    /// Above, the share of complete episodes with its interval; below, their robot time with its deviation.
    fn svg(&self) -> String {
        let layout = Layout::of(self);
        let mut svg = layout.frame(self);
        for (place, curve) in self.curves.iter().enumerate() {
            // Offset sideways so that points do not cover each other.
            let aside = 4.0 * (place as f64 - (self.curves.len() - 1) as f64 / 2.0);
            let shares = curve.points.iter().map(|it| {
                let share = it.complete as f64 / it.episodes.max(1) as f64;
                (it.value, [it.interval.low, share, it.interval.high])
            });
            layout.draw(&mut svg, 0, place, aside, shares);
            let times = curve.points.iter().filter_map(|it| {
                let robot = it.robot?;
                let deviation = robot.deviation.unwrap_or(0.0);
                let times = [robot.mean - deviation, robot.mean, robot.mean + deviation];
                Some((it.value, times.map(|t| t / layout.last)))
            });
            layout.draw(&mut svg, 1, place, aside, times);
            if self.curves.len() > 1 {
                let at = 34.0 + Layout::ROW * place as f64;
                let _ = write!(
                    svg,
                    "<path d=\"M0 {:.1}h22\" stroke=\"{}\" stroke-width=\"2.4\"/>",
                    at - 4.0,
                    agent_colour(place)
                );
                label(&mut svg, [28.0, at], "start", "ink", &words(&curve.label, 60));
            }
        }
        svg.push_str("</svg>");
        svg
    }

    /// As one HTML page with the figure and the table.
    pub fn page(&self) -> String {
        let [first, last] = self.seeds;
        let body = html! {
            header {
                h1 { "Sweep of " (self.quantity) }
                button type="button" { "light / dark" }
            }
            p {
                (self.meaning) " Varied in the world " (self.world) ", the same for all of a list; all else is drawn as ever. Goals: "
                (self.goals.join(", ")) ". Track " (self.track) ", seeds " (first) " to " (last) ". " (self.software) "."
            }
            figure { (PreEscaped(self.svg())) }
            p.soft {
                "An episode is complete when all its pegs count. The interval is Wilson's, 95 %. The time is robot time of \
                 complete episodes: mean and standard deviation."
            }
            (self.table())
        };
        shell::page(&format!("Sweep of {}", self.quantity), &body)
    }

    fn table(&self) -> Markup {
        let curve = (self.curves.len() > 1).then(|| name("curve"));
        let numbers = [
            number(&self.quantity, &self.unit),
            number("complete", "episodes"),
            number("share", "%"),
            number("pegs", ""),
            number("robot time", "s"),
        ];
        let columns: Vec<Column> = curve.into_iter().chain(numbers).collect();
        let points = self.curves.iter().flat_map(|curve| curve.points.iter().map(move |it| (curve, it)));
        table(
            &columns,
            points.map(|(curve, it)| {
                let label = (self.curves.len() > 1).then(|| html! { (curve.label) });
                let numbers = [
                    html! { (it.value) },
                    html! { (it.complete) " of " (it.episodes) },
                    html! {
                        (share(it.complete as f64 / it.episodes.max(1) as f64))
                        (small(Some(it.interval), share))
                    },
                    html! { (it.pegs[0]) " of " (it.pegs[1]) },
                    html! { (robot(it.robot)) },
                ];
                label.into_iter().chain(numbers).collect::<Vec<Markup>>()
            }),
        )
    }

    /// As text, for a terminal.
    pub fn text(&self) -> String {
        let [first, last] = self.seeds;
        let mut text = format!("world {}, track {}, seeds {first} to {last}\n", self.world, self.track);
        for curve in &self.curves {
            if !curve.label.is_empty() {
                let _ = writeln!(text, "{}", curve.label);
            }
            let _ = writeln!(
                text,
                "{:>width$}  complete  95 % interval  pegs     robot time",
                self.axis(),
                width = self.axis().chars().count().max(10)
            );
            for it in &curve.points {
                let _ = writeln!(
                    text,
                    "{:>width$}  {:>8}  {:>13}  {:<7}  {}",
                    it.value,
                    format!("{}/{}", it.complete, it.episodes),
                    format!("{:.0} to {:.0} %", 100.0 * it.interval.low, 100.0 * it.interval.high),
                    format!("{}/{}", it.pegs[0], it.pegs[1]),
                    robot(it.robot),
                    width = self.axis().chars().count().max(10)
                );
            }
        }
        text
    }
}

/// Layout of the figure: two panels over the varied quantity.
struct Layout {
    /// Upper edges of the panels.
    tops: [f64; 2],
    /// Smallest and largest value of the quantity.
    range: [f64; 2],
    /// Interval between marks of the robot time, and the end of its axis, s.
    step: f64,
    last: f64,
}

impl Layout {
    const WIDTH: f64 = 560.0;
    const LEFT: f64 = 58.0;
    const RIGHT: f64 = 18.0;
    /// Height of a row of the legend.
    const ROW: f64 = 17.0;
    /// Height of a panel.
    const PANEL: f64 = 150.0;

    fn of(sweep: &Sweep) -> Layout {
        let labelled = if sweep.curves.len() > 1 { sweep.curves.len() as f64 } else { 0.0 };
        let first = 52.0 + Layout::ROW * labelled;
        let points = || sweep.curves.iter().flat_map(|curve| &curve.points);
        let low = points().map(|it| it.value).fold(f64::INFINITY, f64::min);
        let high = points().map(|it| it.value).fold(f64::NEG_INFINITY, f64::max);
        let longest = points()
            .filter_map(|it| it.robot.map(|robot| robot.mean + robot.deviation.unwrap_or(0.0)))
            .fold(1.0, f64::max);
        let step = axis_step(longest, 5.0);
        Layout {
            tops: [first, first + Layout::PANEL + 34.0],
            range: [low, high],
            step,
            last: (longest / step).ceil() * step,
        }
    }

    /// Position of a value of the quantity.
    fn x(&self, value: f64) -> f64 {
        let [low, high] = self.range;
        let share = if high > low { (value - low) / (high - low) } else { 0.5 };
        Layout::LEFT + 12.0 + (Layout::WIDTH - Layout::LEFT - Layout::RIGHT - 24.0) * share
    }

    /// Position of a share of a panel's height.
    fn y(&self, panel: usize, share: f64) -> f64 {
        self.tops[panel] + Layout::PANEL * (1.0 - share.clamp(0.0, 1.0))
    }

    /// A line of a panel's grid with its label.
    fn grid(&self, svg: &mut String, panel: usize, share: f64, text: &str) {
        let at = self.y(panel, share);
        let (left, right) = (Layout::LEFT, Layout::WIDTH - Layout::RIGHT);
        let _ = write!(svg, "<path d=\"M{left} {at:.1}H{right:.1}\" stroke=\"var(--grid)\"/>");
        label(svg, [left - 8.0, at + 4.0], "end", "soft", text);
    }

    /// The head of the drawing with the title, the grids and the axes.
    fn frame(&self, sweep: &Sweep) -> String {
        let goals = sweep.goals.join(", ");
        let title =
            format!("{goals}, track {}: {} varied in the world {}", sweep.track, sweep.quantity, sweep.world);
        let bottom = self.tops[1] + Layout::PANEL;
        let mut svg = head(&title, Layout::WIDTH, bottom + 44.0);
        let _ = write!(
            svg,
            "<text x=\"0\" y=\"16\" font-size=\"14\" font-weight=\"600\" fill=\"var(--ink)\">{}</text>",
            words(&format!("{goals}, track {}, world {}", sweep.track, sweep.world), 70)
        );
        for mark in [0.0, 0.25, 0.5, 0.75, 1.0] {
            self.grid(&mut svg, 0, mark, &format!("{:.0} %", 100.0 * mark));
        }
        for mark in 0..=(self.last / self.step).round() as usize {
            let seconds = mark as f64 * self.step;
            self.grid(&mut svg, 1, seconds / self.last, &format!("{seconds:.0} s"));
        }
        label(&mut svg, [Layout::LEFT, self.tops[0] - 8.0], "start", "soft", "complete episodes");
        label(
            &mut svg,
            [Layout::LEFT, self.tops[1] - 8.0],
            "start",
            "soft",
            "robot time of complete episodes",
        );
        let points = sweep.curves.iter().flat_map(|curve| &curve.points);
        let mut values: Vec<f64> = points.map(|it| it.value).collect();
        values.sort_by(f64::total_cmp);
        values.dedup();
        // As many labels as there is room for.
        for value in values.iter().step_by(values.len().div_ceil(10).max(1)) {
            let x = self.x(*value);
            let _ = write!(svg, "<path d=\"M{x:.1} {bottom:.1}v5\" stroke=\"var(--soft)\"/>");
            label(&mut svg, [x, bottom + 18.0], "middle", "soft", &value.to_string());
        }
        let middle = (Layout::LEFT + Layout::WIDTH - Layout::RIGHT) / 2.0;
        label(&mut svg, [middle, bottom + 36.0], "middle", "soft", &words(&sweep.axis(), 60));
        svg
    }

    /// The curve of an agent in a panel: points with their lower and upper ends, as shares of its height.
    fn draw(
        &self,
        svg: &mut String,
        panel: usize,
        place: usize,
        aside: f64,
        dots: impl Iterator<Item = (f64, [f64; 3])>,
    ) {
        let colour = agent_colour(place);
        let mut line = String::new();
        for (value, shares) in dots {
            let at = self.x(value) + aside;
            let [low, mid, high] = shares.map(|share| self.y(panel, share));
            let begin = if line.is_empty() { "M" } else { "L" };
            let _ = write!(line, "{begin}{at:.1} {mid:.1}");
            let _ = write!(
                svg,
                "<path d=\"M{at:.1} {low:.1}V{high:.1}\" stroke=\"{colour}\" stroke-width=\"1.4\"/>\
                 <circle cx=\"{at:.1}\" cy=\"{mid:.1}\" r=\"3.2\" fill=\"{colour}\"/>"
            );
        }
        let _ = write!(svg, "<path d=\"{line}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"2\"/>");
    }
}

/// A robot time with its deviation, s.
fn robot(spread: Option<Spread>) -> String {
    match spread {
        None => "–".to_string(),
        Some(Spread { mean, deviation: None }) => format!("{mean:.1}"),
        Some(Spread { mean, deviation: Some(deviation) }) => format!("{mean:.1} ± {deviation:.1}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ramp_result::testing::episode;

    fn sweep() -> Sweep {
        let whole = episode("easy-1", 1, &[10.0, 20.0], 2);
        let half = episode("easy-1", 2, &[10.0], 2);
        let points = vec![
            Point::of(0.0, &[(2, Some(&whole)), (2, Some(&whole))]),
            Point::of(0.5, &[(2, Some(&whole)), (2, Some(&half))]),
            Point::of(1.0, &[(2, Some(&half)), (2, None)]),
        ];
        Sweep {
            quantity: "friction.coulomb".into(),
            unit: "N·m".into(),
            meaning: "Dry friction.".into(),
            world: "real".into(),
            track: "state".into(),
            goals: vec!["easy-1".into()],
            seeds: [1, 2],
            software: "ramp 0.1.0 (abc)".into(),
            curves: ["a <b>", ""].map(|label| Curve { label: label.into(), points: points.clone() }).into(),
        }
    }

    /// A lost episode counts as incomplete, and times are of complete ones only.
    #[test]
    fn points_count_lost_episodes() {
        let sweep = sweep();
        let points = &sweep.curves[0].points;
        let counts: Vec<_> = points.iter().map(|it| (it.complete, it.episodes, it.pegs)).collect();
        assert_eq!(counts, [(2, 2, [4, 4]), (1, 2, [3, 4]), (0, 2, [1, 4])]);
        assert!(points[2].robot.is_none());
        assert_eq!(sweep.csv().lines().count(), 7);
        assert!(sweep.text().contains("1/2"));
    }

    #[test]
    fn the_figure_is_xml_and_the_page_holds_it() {
        let sweep = sweep();
        roxmltree::Document::parse(&sweep.figure()).unwrap_or_else(|error| panic!("{error}"));
        let page = sweep.page();
        assert!(page.contains("<svg") && page.contains("a &lt;b&gt;") && !page.contains("a <b>"));
    }
}
