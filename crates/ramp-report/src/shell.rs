//! The common frame of all pages: colours, and the switch between light and dark. A page is
//! self-contained: it needs no network, font or library.

use std::fmt::Write;

use maud::{DOCTYPE, Markup, PreEscaped, html};

use crate::plot::COLOURS;

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

/// The colours as CSS variables: light, dark if the system or the reader prefers it, and light in
/// print.
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
