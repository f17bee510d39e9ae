//! How a page calls an agent: its colour, its label, and where its own page is.

use maud::{Markup, html};

use crate::plot;
use crate::report::Report;

/// A report as a page shows it.
#[derive(Clone, Copy)]
pub struct View<'r> {
    /// What is shown.
    pub report: &'r Report,
    /// The folder of the agents' own pages, where they have some.
    pub folder: Option<&'r str>,
}

/// The file of an agent's own page.
pub fn agent_page(entrant: usize) -> String {
    format!("agent-{}.html", entrant + 1)
}

impl View<'_> {
    /// The colour of an agent that is drawn.
    pub fn swatch(&self, entrant: usize) -> Markup {
        let colour = self.report.place(entrant).map(plot::agent_colour);
        html! { @if let Some(colour) = colour { span.swatch style=(format!("background:{colour}")) {} } }
    }

    /// Colour and label, which leads to the agent's own page.
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
