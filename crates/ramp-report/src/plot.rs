//! The report's figures as SVG. Colours are names of CSS variables, so that a page can show them light and
//! dark; [`standalone`] puts the light ones in.

use std::fmt::Write;

use crate::curves::Curves;
use ramp_result::activity::{self, Activity};
use ramp_result::episode::EpisodeResult;
use ramp_robot::EventKind;

/// Names of colours, with their values on light and dark ground. Those of activities and of the first six
/// agents are the set of Okabe and Ito, which people with any kind of colour vision can tell apart; some are
/// lighter where the ground is dark.
pub const COLOURS: [(&str, &str, &str); 24] = [
    ("paper", "#ffffff", "#14181d"),
    ("card", "#f6f7f9", "#1c2128"),
    ("ink", "#1b1f24", "#e6e9ed"),
    ("soft", "#57606a", "#9aa4af"),
    ("grid", "#dde1e6", "#343b44"),
    ("bad", "#b3261e", "#ff8a80"),
    ("agent0", "#0072b2", "#56b4e9"),
    ("agent1", "#d55e00", "#ff9248"),
    ("agent2", "#009e73", "#35cfa3"),
    ("agent3", "#cc79a7", "#e6a3c8"),
    ("agent4", "#b07c00", "#f0c04a"),
    ("agent5", "#57606a", "#c3cad2"),
    ("agent6", "#6a3d9a", "#b79ae0"),
    ("agent7", "#8c510a", "#cf9d62"),
    ("agent8", "#6b7d00", "#bccd3f"),
    ("agent9", "#a50f3c", "#ff7d9c"),
    ("planning", "#cc79a7", "#cc79a7"),
    ("compute", "#8c959f", "#8c959f"),
    ("moving", "#56b4e9", "#56b4e9"),
    ("gripping", "#e69f00", "#e69f00"),
    ("inserting", "#0072b2", "#2f8fd6"),
    ("fastening", "#009e73", "#009e73"),
    ("other", "#d9c700", "#f0e442"),
    ("untold", "#d5dae0", "#434c56"),
];

/// Number of agent colours; further agents reuse them with other dashes.
pub const AGENTS: usize = 10;

/// The colour of an agent, by its index on its track.
pub fn agent_colour(place: usize) -> String {
    format!("var(--agent{})", place % AGENTS)
}

fn agent_dash(place: usize) -> &'static str {
    ["", "7 3", "2 3", "9 3 2 3"][place / AGENTS % 4]
}

/// The colour of an activity.
pub fn activity_colour(activity: Activity) -> &'static str {
    match activity {
        Activity::Moving => "var(--moving)",
        Activity::Gripping => "var(--gripping)",
        Activity::Inserting => "var(--inserting)",
        Activity::Fastening => "var(--fastening)",
        Activity::Other => "var(--other)",
        Activity::Untold => "var(--untold)",
    }
}

/// A figure as a file of its own: light, on white.
pub fn standalone(svg: &str) -> String {
    let mut text = svg.to_string();
    for (name, light, _) in COLOURS {
        text = text.replace(&format!("var(--{name})"), light);
    }
    let ground = "<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>";
    match text.find('>') {
        Some(end) => text.insert_str(end + 1, ground),
        None => return text,
    }
    text.push('\n');
    text
}

/// Untrusted text for XML and a line of a figure.
pub fn words(text: &str, longest: usize) -> String {
    let mut short: String =
        text.chars().take(longest).map(|c| if c.is_control() { ' ' } else { c }).collect();
    if text.chars().count() > longest {
        short.push('…');
    }
    escape(&short)
}

fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            // Invalid in XML.
            '\u{fffe}' | '\u{ffff}' => out.push(' '),
            c if c.is_control() => out.push(' '),
            c => out.push(c),
        }
    }
    out
}

/// A round interval between marks on an axis that ends at `end`, with at most `most` marks.
pub(crate) fn axis_step(end: f64, most: f64) -> f64 {
    let mut step = 1.0;
    loop {
        for factor in [1.0, 2.0, 5.0] {
            if end / (step * factor) <= most {
                return step * factor;
            }
        }
        step *= 10.0;
    }
}

pub(crate) fn head(title: &str, width: f64, height: f64) -> String {
    let title = escape(title);
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width:.0} {height:.0}\" role=\"img\" \
         aria-label=\"{title}\" font-family=\"system-ui, 'Segoe UI', Helvetica, Arial, sans-serif\" font-size=\"12\">"
    )
}

pub(crate) fn label(svg: &mut String, at: [f64; 2], anchor: &str, fill: &str, text: &str) {
    let [x, y] = at;
    let _ = write!(
        svg,
        "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\" fill=\"var(--{fill})\">{text}</text>"
    );
}

/// An agent in a chart of curves.
pub struct Series<'c> {
    /// Its label.
    pub label: &'c str,
    /// Its index among the agents of its track.
    pub place: usize,
    /// Its curves.
    pub curves: &'c Curves,
}

/// A published mean on a chart of curves.
pub struct Mark<'c> {
    /// Its label.
    pub label: &'c str,
    /// Total time, s.
    pub time: f64,
    /// Completion.
    pub completion: f64,
}

/// Completion over total time of one goal or class: mean, deviation and best of each agent.
pub fn curves(title: &str, series: &[Series], marks: &[Mark]) -> String {
    let chart = CurveChart::new(series, marks);
    let mut svg = chart.frame(title);
    for one in series {
        chart.draw(&mut svg, one);
    }
    chart.legend(&mut svg, series, marks);
    svg.push_str("</svg>");
    svg
}

/// Layout of a chart of curves: its axes in units of the drawing and of the data.
struct CurveChart {
    /// Upper and lower edge of the plotting area.
    top: f64,
    bottom: f64,
    /// Interval between marks of the time axis, and its end, s.
    step: f64,
    last: f64,
}

impl CurveChart {
    const WIDTH: f64 = 480.0;
    const LEFT: f64 = 52.0;
    const RIGHT: f64 = 16.0;
    /// Height of a row of the legend.
    const ROW: f64 = 17.0;

    fn new(series: &[Series], marks: &[Mark]) -> CurveChart {
        let rows = (series.len() + marks.len()) as f64;
        let top = 34.0 + CurveChart::ROW * rows;
        let ends = series.iter().map(|it| it.curves.end).chain(marks.iter().map(|it| it.time));
        let end = ends.fold(1.0, f64::max);
        let step = axis_step(end, 8.0);
        CurveChart { top, bottom: top + 200.0, step, last: (end / step).ceil() * step }
    }

    /// Position of a time, s.
    fn x(&self, t: f64) -> f64 {
        let width = CurveChart::WIDTH - CurveChart::LEFT - CurveChart::RIGHT;
        CurveChart::LEFT + width * t / self.last
    }

    /// Position of a completion from 0 to 1.
    fn y(&self, share: f64) -> f64 {
        self.bottom - (self.bottom - self.top) * share.clamp(0.0, 1.0)
    }

    /// The head of the drawing with the title, the grid and both axes.
    fn frame(&self, title: &str) -> String {
        let bottom = self.bottom;
        let mut svg = head(&format!("Completion over time, {title}"), CurveChart::WIDTH, bottom + 44.0);
        let _ = write!(
            svg,
            "<text x=\"0\" y=\"16\" font-size=\"14\" font-weight=\"600\" fill=\"var(--ink)\">{}</text>",
            words(title, 60)
        );
        for share in [0.0, 0.25, 0.5, 0.75, 1.0] {
            let _ = write!(
                svg,
                "<path d=\"M{} {1:.1}H{2:.1}\" stroke=\"var(--grid)\"/>",
                CurveChart::LEFT,
                self.y(share),
                CurveChart::WIDTH - CurveChart::RIGHT
            );
            let at = [CurveChart::LEFT - 8.0, self.y(share) + 4.0];
            label(&mut svg, at, "end", "soft", &format!("{:.0} %", 100.0 * share));
        }
        for mark in 0..=(self.last / self.step).round() as usize {
            let t = mark as f64 * self.step;
            let _ = write!(svg, "<path d=\"M{:.1} {bottom:.1}v5\" stroke=\"var(--soft)\"/>", self.x(t));
            label(&mut svg, [self.x(t), bottom + 18.0], "middle", "soft", &format!("{t:.0}"));
        }
        let middle = (self.x(0.0) + self.x(self.last)) / 2.0;
        label(&mut svg, [middle, bottom + 36.0], "middle", "soft", "total time, s");
        svg
    }

    /// The curves of an agent: the band of the deviation, the best episode, and the mean.
    fn draw(&self, svg: &mut String, one: &Series) {
        let colour = agent_colour(one.place);
        let (mut upper, mut lower, mut line) = (String::new(), String::new(), String::new());
        for (index, at) in one.curves.mean.iter().enumerate() {
            let next = one.curves.mean.get(index + 1);
            let (from, to) =
                (self.x(at.time), self.x(next.map_or(one.curves.end, |next| next.time).max(at.time)));
            // The band runs along the upper edge, and back along the lower one.
            let _ = write!(upper, "L{from:.1} {:.1}H{to:.1}", self.y(at.mean + at.deviation));
            lower = format!("L{to:.1} {:.1}H{from:.1}{lower}", self.y(at.mean - at.deviation));
            let _ = match index {
                0 => write!(line, "M{from:.1} {:.1}H{to:.1}", self.y(at.mean)),
                _ => write!(line, "V{:.1}H{to:.1}", self.y(at.mean)),
            };
        }
        let origin = [self.x(0.0), self.y(0.0)];
        let _ = write!(
            svg,
            "<path d=\"M{:.1} {:.1}{upper}{lower}Z\" fill=\"{colour}\" fill-opacity=\"0.16\"/>",
            origin[0], origin[1]
        );
        let mut best = format!("M{:.1} {:.1}", origin[0], origin[1]);
        for (time, share) in one.curves.best.iter().skip(1) {
            let _ = write!(best, "H{:.1}V{:.1}", self.x(*time), self.y(*share));
        }
        let _ = write!(best, "H{:.1}", self.x(one.curves.best_end));
        let _ = write!(
            svg,
            "<path d=\"{best}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"1.3\" stroke-dasharray=\"4 3\"/>"
        );
        let _ = write!(
            svg,
            "<path d=\"{line}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"2.4\" stroke-dasharray=\"{}\"/>",
            agent_dash(one.place)
        );
        if let Some(at) = one.curves.mean.last() {
            // After its end the episode keeps its completion.
            let (x, y) = (self.x(one.curves.end), self.y(at.mean));
            let _ = write!(
                svg,
                "<path d=\"M{x:.1} {y:.1}H{:.1}\" stroke=\"{colour}\" stroke-width=\"1.6\" stroke-dasharray=\"1.5 3.5\"/>\
                 <circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"3.4\" fill=\"{colour}\"/>",
                self.x(self.last)
            );
        }
    }

    /// The rows of the legend above the curves, and the marks of published means.
    fn legend(&self, svg: &mut String, series: &[Series], marks: &[Mark]) {
        for (index, one) in series.iter().enumerate() {
            let at = 34.0 + CurveChart::ROW * index as f64;
            let colour = agent_colour(one.place);
            let _ = write!(
                svg,
                "<path d=\"M0 {0:.1}h22\" stroke=\"{colour}\" stroke-width=\"2.4\" stroke-dasharray=\"{1}\"/>\
                 <path d=\"M0 {0:.1}h22\" stroke=\"{colour}\" stroke-width=\"11\" stroke-opacity=\"0.16\"/>",
                at - 4.0,
                agent_dash(one.place)
            );
            label(svg, [28.0, at], "start", "ink", &words(one.label, 60));
        }
        for (index, mark) in marks.iter().enumerate() {
            let at = 34.0 + CurveChart::ROW * (series.len() + index) as f64;
            for [x, y] in [[11.0, at - 4.0], [self.x(mark.time), self.y(mark.completion)]] {
                let _ = write!(
                    svg,
                    "<path d=\"M{:.1} {:.1}l5.5 5.5l-5.5 5.5l-5.5 -5.5Z\" fill=\"var(--paper)\" stroke=\"var(--ink)\" \
                     stroke-width=\"1.8\"/>",
                    x,
                    y - 5.5
                );
            }
            label(svg, [28.0, at], "start", "ink", &words(mark.label, 60));
        }
    }
}

/// A bar of [`bars`].
pub struct Bar {
    /// Its label.
    pub label: String,
    /// Planning, compute, and each activity, s.
    pub parts: Vec<f64>,
}

/// Names and colours of the parts of a [`Bar`].
pub fn bar_parts() -> Vec<(&'static str, &'static str)> {
    let mut parts = vec![("planning", "var(--planning)"), ("compute", "var(--compute)")];
    parts.extend(Activity::ALL.map(|activity| (activity.name(), activity_colour(activity))));
    parts
}

/// A row of coloured squares with labels; returns its height.
fn legend(svg: &mut String, parts: &[(&str, &str)], width: f64, top: f64) -> f64 {
    let (mut x, mut y) = (0.0, top);
    for (name, colour) in parts {
        let room = 34.0 + 7.0 * name.chars().count() as f64;
        if x > 0.0 && x + room > width {
            (x, y) = (0.0, y + 18.0);
        }
        let _ = write!(
            svg,
            "<rect x=\"{x:.1}\" y=\"{:.1}\" width=\"11\" height=\"11\" rx=\"2\" fill=\"{colour}\"/>",
            y - 10.0
        );
        label(svg, [x + 16.0, y], "start", "ink", name);
        x += room;
    }
    y - top + 18.0
}

/// Marks of a time axis at the bottom of a chart, with vertical lines.
fn time_axis(svg: &mut String, from: [f64; 2], to: [f64; 2], last: f64, step: f64, title: &str) {
    let [left, top] = from;
    let [right, bottom] = to;
    for mark in 0..=(last / step).round() as usize {
        let t = mark as f64 * step;
        let x = left + (right - left) * t / last;
        let _ = write!(svg, "<path d=\"M{x:.1} {top:.1}V{bottom:.1}\" stroke=\"var(--grid)\"/>");
        label(svg, [x, bottom + 15.0], "middle", "soft", &format!("{t:.0}"));
    }
    label(svg, [(left + right) / 2.0, bottom + 32.0], "middle", "soft", title);
}

/// Mean times: a bar of parts for each line.
pub fn bars(title: &str, bars: &[Bar]) -> String {
    const WIDTH: f64 = 980.0;
    const LEFT: f64 = 250.0;
    const RIGHT: f64 = 70.0;
    const ROW: f64 = 24.0;
    let parts = bar_parts();
    // Parts that are zero everywhere are omitted.
    let used: Vec<usize> =
        (0..parts.len()).filter(|index| bars.iter().any(|bar| bar.parts[*index] > 0.0)).collect();
    let mut body = String::new();
    let shown: Vec<(&str, &str)> = used.iter().map(|index| parts[*index]).collect();
    let top = 8.0 + legend(&mut body, &shown, WIDTH, 14.0);
    let bottom = top + ROW * bars.len() as f64;
    let longest = bars.iter().map(|bar| bar.parts.iter().sum::<f64>()).fold(1.0, f64::max);
    let step = axis_step(longest, 12.0);
    let last = (longest / step).ceil() * step;
    let scale = (WIDTH - LEFT - RIGHT) / last;
    time_axis(&mut body, [LEFT, top], [WIDTH - RIGHT, bottom], last, step, "mean of an episode, s");
    for (row, bar) in bars.iter().enumerate() {
        let y = top + ROW * row as f64 + 3.0;
        label(&mut body, [LEFT - 10.0, y + 13.0], "end", "ink", &words(&bar.label, 38));
        let mut x = LEFT;
        for index in &used {
            let (name, colour) = parts[*index];
            let seconds = bar.parts[*index];
            if seconds <= 0.0 {
                continue;
            }
            let _ = write!(
                body,
                "<rect x=\"{x:.2}\" y=\"{y:.1}\" width=\"{:.2}\" height=\"{:.1}\" fill=\"{colour}\">\
                 <title>{name}: {seconds:.2} s</title></rect>",
                seconds * scale,
                ROW - 6.0
            );
            x += seconds * scale;
        }
        let total: f64 = bar.parts.iter().sum();
        label(&mut body, [x + 6.0, y + 13.0], "start", "soft", &format!("{total:.1} s"));
    }
    let mut svg = head(title, WIDTH, bottom + 40.0);
    svg.push_str(&body);
    svg.push_str("</svg>");
    svg
}

/// Episodes over robot time: activities, counted pegs, and faults.
pub fn timeline(title: &str, episodes: &[&EpisodeResult]) -> String {
    const WIDTH: f64 = 980.0;
    const LEFT: f64 = 130.0;
    const RIGHT: f64 = 96.0;
    const ROW: f64 = 24.0;
    let spans: Vec<Vec<activity::Span>> = episodes.iter().map(|episode| activity::spans(episode)).collect();
    let used = Activity::ALL.into_iter().filter(|it| spans.iter().flatten().any(|span| span.activity == *it));
    let shown: Vec<(&str, &str)> = used.map(|it| (it.name(), activity_colour(it))).collect();
    let mut body = String::new();
    let mut top = 8.0 + legend(&mut body, &shown, WIDTH, 14.0);
    let signs =
        [("peg", "peg that counts"), ("fault", "fault"), ("retry", "tried again"), ("replan", "new plan")];
    let mut x = 6.0;
    for (kind, name) in signs {
        sign(&mut body, kind, [x, top + 3.0], "");
        label(&mut body, [x + 10.0, top + 7.0], "start", "ink", name);
        x += 34.0 + 7.0 * name.len() as f64;
    }
    top += 24.0;
    let bottom = top + ROW * episodes.len() as f64;
    let longest = episodes.iter().map(|episode| episode.time.robot).fold(1.0, f64::max);
    let step = axis_step(longest, 12.0);
    let last = (longest / step).ceil() * step;
    let scale = (WIDTH - LEFT - RIGHT) / last;
    time_axis(&mut body, [LEFT, top], [WIDTH - RIGHT, bottom], last, step, "robot time, s");
    for (row, (episode, spans)) in episodes.iter().zip(&spans).enumerate() {
        let y = top + ROW * row as f64;
        let name = format!("{}, {}", words(&episode.goal, 14), episode.seed);
        label(&mut body, [LEFT - 10.0, y + 17.0], "end", "ink", &name);
        for span in spans {
            let name = || span.activity.name().to_string();
            let action = span.action.map(ToString::to_string).unwrap_or_else(name);
            let _ = write!(
                body,
                "<rect x=\"{:.2}\" y=\"{:.1}\" width=\"{:.2}\" height=\"11\" fill=\"{}\">\
                 <title>{:.1} s to {:.1} s: {}</title></rect>",
                LEFT + span.from * scale,
                y + 9.0,
                (span.to - span.from) * scale,
                activity_colour(span.activity),
                span.from,
                span.to,
                words(&action, 80)
            );
        }
        let place = |t: f64| LEFT + t.clamp(0.0, episode.time.robot) * scale;
        for event in &episode.events {
            let name = event.kind.name();
            let kind = match event.kind {
                EventKind::Fault(_) | EventKind::Retry(_) | EventKind::Replan { .. } => name,
                // A stop of the arm.
                EventKind::Recovered { .. } => "fault",
                _ => continue,
            };
            let note = format!("{:.1} s, {name}: {}", event.time, event.kind);
            sign(&mut body, kind, [place(event.time), y + 14.5], &note);
        }
        for peg in episode.pegs.iter().flatten() {
            let note = format!("{:.1} s: {} counts", peg.t_robot, peg.connection);
            sign(&mut body, "peg", [place(peg.t_robot), y + 5.0], &note);
        }
        let share = format!("{} of {} pegs", episode.counted(), episode.pegs.len());
        let fill = if crate::sums::is_complete(episode) { "soft" } else { "bad" };
        label(&mut body, [place(episode.time.robot) + 6.0, y + 18.0], "start", fill, &share);
    }
    let mut svg = head(title, WIDTH, bottom + 40.0);
    svg.push_str(&body);
    svg.push_str("</svg>");
    svg
}

/// A mark of the time line with a tooltip.
fn sign(svg: &mut String, kind: &str, at: [f64; 2], note: &str) {
    let [x, y] = at;
    let title = if note.is_empty() { String::new() } else { format!("<title>{}</title>", words(note, 160)) };
    let _ = match kind {
        "peg" => {
            write!(svg, "<path d=\"M{x:.1} {:.1}l3.6 -6h-7.2Z\" fill=\"var(--ink)\">{title}</path>", y + 3.0)
        }
        "fault" => write!(
            svg,
            "<path d=\"M{0:.1} {1:.1}l7 7m0 -7l-7 7\" stroke=\"var(--paper)\" stroke-width=\"4.5\" fill=\"none\"/>\
             <path d=\"M{0:.1} {1:.1}l7 7m0 -7l-7 7\" stroke=\"var(--bad)\" stroke-width=\"2.2\" fill=\"none\">{title}</path>",
            x - 3.5,
            y - 3.5
        ),
        "retry" => write!(
            svg,
            "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"3.2\" fill=\"var(--paper)\" stroke=\"var(--ink)\" \
             stroke-width=\"1.5\">{title}</circle>"
        ),
        _ => write!(
            svg,
            "<path d=\"M{x:.1} {:.1}v17\" stroke=\"var(--bad)\" stroke-width=\"2\">{title}</path>",
            y - 8.5
        ),
    };
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::curves::curves as make_curves;
    use ramp_result::testing::episode;

    #[test]
    fn a_figure_of_its_own_is_xml_without_variables_whatever_the_names() {
        let mut one = episode("<goal & \"1\">\u{1}", 1, &[10.0], 2);
        one.agent.name = "]]><script>".into();
        let curves = make_curves(&[&one], 0).unwrap();
        let series = [Series { label: &one.agent.name, place: 7, curves: &curves }];
        let marks = [Mark { label: "'pub'", time: 20.0, completion: 0.5 }];
        let bar = Bar { label: one.goal.clone(), parts: vec![1.0; bar_parts().len()] };
        for svg in
            [super::curves(&one.goal, &series, &marks), bars(&one.goal, &[bar]), timeline(&one.goal, &[&one])]
        {
            let text = standalone(&svg);
            assert!(!text.contains("var("), "{text}");
            assert!(!text.contains("<script>"));
            roxmltree::Document::parse(&text).unwrap();
        }
    }
}
