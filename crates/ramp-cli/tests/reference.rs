//! The page of the command line is what the program says of itself.
//!
//! `RAMP_WRITE=1 cargo test --release --workspace --test reference` writes the page anew.

// A failed unwrap here is a failed test.
#![allow(clippy::unwrap_used)]

const PAGE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/src/reference/cli.md");

#[test]
fn the_page_of_the_command_line_is_up_to_date() {
    let options = clap_markdown::MarkdownOptions::new().title("Command line".to_string()).show_footer(false);
    let page = clap_markdown::help_markdown_command_custom(&ramp_cli::arguments(), &options);
    let page = format!("{}\n", page.trim_end());
    if std::env::var_os("RAMP_WRITE").is_some() {
        std::fs::write(PAGE, &page).unwrap();
    }
    let found = std::fs::read_to_string(PAGE).unwrap_or_default();
    assert!(found == page, "docs/src/reference/cli.md is out of date: write it anew with RAMP_WRITE=1");
}
