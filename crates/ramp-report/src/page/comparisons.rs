//! Pairs of agents on a page.

use maud::{Markup, html};

use super::view::View;
use crate::columns::{Column, name, number, table};
use crate::format::{NONE, small};
use crate::report::ClassPart;
use crate::sums::{Comparison, Difference};

const COLUMNS: [Column; 8] = [
    name("first"),
    name("second"),
    name("measure"),
    number("pairs", ""),
    number("mean difference", ""),
    number("p", ""),
    number("p, corrected", ""),
    name("verdict"),
];

/// The pairs of the shown agents.
pub fn comparisons(view: View, class: &ClassPart) -> Markup {
    let is_shown = |it: &&Comparison| it.entrants.iter().all(|entrant| class.shown.contains(entrant));
    let pairs: Vec<&Comparison> = class.comparisons.iter().filter(is_shown).collect();
    html! {
        h3 { "Agents compared" }
        p.soft {
            "The first agent minus the second, on the goals and seeds that both have. Total time where both are complete."
        }
        (table(&COLUMNS, pairs.into_iter().flat_map(|comparison| {
            let (completion, total) = (Some(&comparison.completion), comparison.total.as_ref());
            [
                difference(view, comparison, "completion", completion, |it| format!("{:+.1} %", 100.0 * it)),
                difference(view, comparison, "total time", total, |it| format!("{it:+.1} s")),
            ]
        })))
    }
}

fn difference(
    view: View,
    comparison: &Comparison,
    measure: &str,
    test: Option<&Difference>,
    say: fn(f64) -> String,
) -> Vec<Markup> {
    let [one, two] = comparison.entrants;
    let p = |p: f64| if p < 0.0001 { "< 0.0001".to_string() } else { format!("{p:.4}") };
    let mut cells = vec![view.name(one), view.name(two), html! { (measure) }];
    match test {
        Some(test) => cells.extend([
            html! { (test.pairs) },
            html! { (say(test.mean)) (small(test.interval, say)) },
            html! { (p(test.p)) },
            html! { (p(test.corrected)) },
            html! { (if test.corrected < 0.05 { "differs" } else { "no difference shown" }) },
        ]),
        None => {
            cells.push(html! { "0" });
            cells.extend([NONE; 3].map(|none| html! { (none) }));
            cells.push(html! { "never both complete" });
        }
    }
    cells
}
