//! The report as a table for a paper: LaTeX, with the package `booktabs`.

use std::fmt::Write;

use crate::report::Report;
use crate::sums::Line;
use ramp_result::statistics::Interval;

/// One table with a row per agent and goal, and one for the class.
pub fn latex(report: &Report) -> String {
    let mut text = String::from(
        "% Needs \\usepackage{booktabs}. Completion in per cent and total time in seconds: mean, sample standard\n\
         % deviation, interval of 95 % (see the report for how it is made). The robot's own part of the time in seconds,\n\
         % and bound and reference that it is to be compared with: means. Written by `ramp report --paper`.\n\
         \\begin{tabular}{llrrrrrrrr}\n\\toprule\n\
         Agent & Goal & Episodes & Complete & Completion (\\%) & Best (\\%) & Total time (s) & Robot (s) & Bound (s) & \
         Reference (s) \\\\\n",
    );
    for part in &report.tracks {
        for class in &part.classes {
            let _ = write!(
                text,
                "\\midrule\n\\multicolumn{{10}}{{l}}{{Class {}, track {}}} \\\\\n",
                escape(class.name()),
                escape(&part.title())
            );
            for &entrant in &part.entrants {
                let goals = class.goal_lines.iter().chain(&class.size_lines).chain(&class.lines);
                for (index, it) in goals.filter(|it| it.entrant == entrant).enumerate() {
                    let name = if index == 0 { escape(report.label(entrant)) } else { String::new() };
                    line(&mut text, &name, it);
                }
            }
            for it in &class.published {
                let _ = writeln!(
                    text,
                    "{} (published) & {} & {} & -- & {:.1} & -- & {:.1} & -- & -- & -- \\\\",
                    escape(&it.name),
                    escape(&it.class),
                    it.goals * it.repeats,
                    100.0 * it.completion,
                    it.total
                );
            }
        }
    }
    text.push_str("\\bottomrule\n\\end{tabular}\n");
    text
}

fn line(text: &mut String, name: &str, it: &Line) {
    let sum = &it.summary;
    let of = |mean: f64, deviation: Option<f64>, interval: Option<Interval>, scale: f64| {
        let deviation = deviation.map_or_else(String::new, |it| format!(" \\pm {:.1}", it * scale));
        let interval = interval
            .map_or_else(String::new, |it| format!("\\ [{:.1}, {:.1}]", it.low * scale, it.high * scale));
        format!("${:.1}{deviation}{interval}$", mean * scale)
    };
    let total = sum.time.map_or_else(
        || "--".to_string(),
        |time| of(time.total, time.total_deviation, it.total_interval, 1.0),
    );
    let compared = sum.time.and_then(|time| time.compared);
    let seconds = |mean: Option<f64>| mean.map_or_else(|| "--".to_string(), |it| format!("{it:.1}"));
    let best = sum.best.map_or_else(|| "--".to_string(), |best| format!("{:.0}", 100.0 * best.completion));
    let _ = writeln!(
        text,
        "{name} & {} & {} & {} & {} & {best} & {total} & {} & {} & {} \\\\",
        escape(it.scope.name()),
        sum.episodes,
        it.complete,
        of(sum.completion.mean, sum.completion.deviation, it.completion_interval, 100.0),
        seconds(sum.time.map(|it| it.robot)),
        seconds(compared.map(|it| it.bound)),
        seconds(compared.map(|it| it.reference)),
    );
}

/// Untrusted text, escaped for LaTeX.
fn escape(text: &str) -> String {
    let mut out = String::new();
    for c in text.chars() {
        match c {
            '\\' => out.push_str("\\textbackslash{}"),
            '~' => out.push_str("\\textasciitilde{}"),
            '^' => out.push_str("\\textasciicircum{}"),
            '<' => out.push_str("\\textless{}"),
            '>' => out.push_str("\\textgreater{}"),
            '|' => out.push_str("\\textbar{}"),
            '&' | '%' | '$' | '#' | '_' | '{' | '}' => {
                out.push('\\');
                out.push(c);
            }
            // At the start of a row, LaTeX takes `[` and `*` as arguments of the line end before
            // it.
            '[' | ']' | '*' => {
                out.push('{');
                out.push(c);
                out.push('}');
            }
            c if c.is_control() => out.push(' '),
            c => out.push(c),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_cannot_be_commands() {
        assert_eq!(escape("[5cm] a*"), "{[}5cm{]} a{*}");
        assert_eq!(escape("my_agent 100% \\input{x}"), "my\\_agent 100\\% \\textbackslash{}input\\{x\\}");
    }
}
