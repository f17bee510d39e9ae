//! The paper's curve: completion over time, as a picture.

use std::fmt::Write;

use ramp_result::episode::EpisodeResult;

const WIDTH: f64 = 720.0;
const HEIGHT: f64 = 400.0;
const LEFT: f64 = 64.0;
const RIGHT: f64 = 24.0;
const TOP: f64 = 56.0;
const BOTTOM: f64 = 56.0;

/// Completion over total time (planning, computing and robot) as SVG: one step for each counted peg.
pub fn completion_svg(result: &EpisodeResult) -> String {
    let total = result.wanted().max(1) as f64;
    let pegs = result.pegs.iter().flatten().map(|peg| (peg.t_total, peg.connection.as_str()));
    let parts = result.parts.iter().filter_map(|part| Some((part.t_total?, part.part.as_str())));
    let mut pegs: Vec<(f64, &str)> = pegs.chain(parts).collect();
    pegs.sort_by(|a, b| a.0.total_cmp(&b.0));
    let end = result.time.total.max(1.0);
    let step = tick(end);
    let last = (end / step).ceil() * step;
    let x = |t: f64| LEFT + (WIDTH - LEFT - RIGHT) * t / last;
    let y = |share: f64| HEIGHT - BOTTOM - (HEIGHT - TOP - BOTTOM) * share;
    let mut svg = format!(
        r##"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" font-family="sans-serif" font-size="13">
<rect width="{WIDTH}" height="{HEIGHT}" fill="#fff"/>
<text x="{LEFT}" y="24" font-size="16" fill="#222">{}: {:.0} % in {:.1} s</text>
<text x="{LEFT}" y="42" fill="#666">{}, track {}, seed {}; planning {:.2} s, computing {:.2} s, robot {:.1} s</text>
"##,
        escape(&result.goal),
        100.0 * result.completion,
        result.time.total,
        escape(&result.agent.name),
        escape(&result.track),
        result.seed,
        result.time.planning,
        result.time.compute,
        result.time.robot,
    );
    for share in [0.0, 0.25, 0.5, 0.75, 1.0] {
        let _ = writeln!(
            svg,
            r##"<path d="M{0:.1} {2:.1}H{1:.1}" stroke="#ddd"/><text x="{3:.1}" y="{4:.1}" text-anchor="end" fill="#444">{5:.0} %</text>"##,
            x(0.0),
            x(last),
            y(share),
            LEFT - 8.0,
            y(share) + 4.0,
            100.0 * share
        );
    }
    let mut time = 0.0;
    while time <= last + 1e-9 {
        let _ = writeln!(
            svg,
            r##"<path d="M{0:.1} {1:.1}v5" stroke="#444"/><text x="{0:.1}" y="{2:.1}" text-anchor="middle" fill="#444">{3:.0}</text>"##,
            x(time),
            y(0.0),
            y(0.0) + 20.0,
            time
        );
        time += step;
    }
    let _ = writeln!(
        svg,
        r##"<text x="{:.1}" y="{:.1}" text-anchor="middle" fill="#222">total time, s</text>"##,
        (x(0.0) + x(last)) / 2.0,
        HEIGHT - 14.0
    );
    let mut path = format!("M{:.1} {:.1}", x(0.0), y(0.0));
    for (count, (t, _)) in pegs.iter().enumerate() {
        let _ = write!(path, "H{:.1}V{:.1}", x(*t), y((count + 1) as f64 / total));
    }
    let _ = write!(path, "H{:.1}", x(result.time.total));
    let _ = writeln!(svg, r##"<path d="{path}" fill="none" stroke="#1f6fb4" stroke-width="2.5"/>"##);
    for (count, (t, connection)) in pegs.iter().enumerate() {
        let share = (count + 1) as f64 / total;
        let _ = writeln!(
            svg,
            r##"<circle cx="{0:.1}" cy="{1:.1}" r="4" fill="#1f6fb4"/><text x="{2:.1}" y="{3:.1}" text-anchor="end" fill="#1f6fb4">{4}</text>"##,
            x(*t),
            y(share),
            x(*t) - 7.0,
            y(share) - 6.0,
            escape(connection)
        );
    }
    svg.push_str("</svg>\n");
    svg
}

/// A round interval between marks on the time axis, s.
fn tick(end: f64) -> f64 {
    [1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0]
        .into_iter()
        .find(|step| end / step <= 10.0)
        .unwrap_or(1000.0)
}

fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}
