//! Display of an agent on a page: its colour, its label, and the link to its own page.

use maud::{Markup, html};

use crate::plot;
use crate::report::Report;

/// A report as a page shows it.
#[derive(Clone, Copy)]
pub struct View<'r> {
    /// The report.
    pub report: &'r Report,
    /// The folder of the agents' own pages, if any.
    pub folder: Option<&'r str>,
}

/// The file of an agent's own page.
pub fn agent_page(entrant: usize) -> String {
    format!("agent-{}.html", entrant + 1)
}

impl View<'_> {
    /// The colour of a plotted agent.
    pub fn swatch(&self, entrant: usize) -> Markup {
        let colour = self.report.place(entrant).map(plot::agent_colour);
        html! { @if let Some(colour) = colour { span.swatch style=(format!("background:{colour}")) {} } }
    }

    /// Colour and label, with a link to the agent's own page.
    pub fn name(&self, entrant: usize) -> Markup {
        html! {
            (self.swatch(entrant))
            @if let Some(folder) = self.folder {
                a href=(format!("{folder}/{}", agent_page(entrant))) { (self.report.label(entrant)) }
            } @else {
                (self.report.label(entrant))
            }
        }
    }
}
