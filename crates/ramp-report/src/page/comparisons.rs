//! Pairs of agents on a page.

use maud::{Markup, html};

use super::view::View;
use crate::format::{NONE, small};
use crate::report::ClassPart;
use crate::sums::{Comparison, Difference};

/// The pairs of the shown agents.
pub fn comparisons(view: View, class: &ClassPart) -> Markup {
    let is_shown = |it: &&Comparison| it.entrants.iter().all(|entrant| class.shown.contains(entrant));
    let pairs: Vec<&Comparison> = class.comparisons.iter().filter(is_shown).collect();
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
                    @for comparison in pairs {
                        (difference(view, comparison, "completion", Some(&comparison.completion), |it| format!("{:+.1} %", 100.0 * it)))
                        (difference(view, comparison, "total time", comparison.total.as_ref(), |it| format!("{it:+.1} s")))
                    }
                }
            }
        }
    }
}

fn difference(
    view: View,
    comparison: &Comparison,
    measure: &str,
    test: Option<&Difference>,
    say: fn(f64) -> String,
) -> Markup {
    let [one, two] = comparison.entrants;
    let p = |p: f64| if p < 0.0001 { "< 0.0001".to_string() } else { format!("{p:.4}") };
    html! {
        tr {
            td.name { (view.name(one)) }
            td.name { (view.name(two)) }
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
