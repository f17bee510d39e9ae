//! The reference pages of the command line, of the worlds and of the starts equal the program's own help.
//!
//! `RAMP_WRITE=1 cargo test --release -p ramp-cli --test it reference` writes the page anew.

use ramp_world::{Quantity, Spread, Start, World};

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

/// The page of the worlds has a table of all quantities.
#[test]
fn the_table_of_the_worlds_is_up_to_date() {
    const WORLDS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/src/reference/worlds.md");
    let said = |quantity: &Quantity| {
        let values = &quantity.value;
        let same = values.iter().all(|it| it == &values[0]);
        let list = || values.iter().map(f64::to_string).collect::<Vec<_>>().join(", ");
        let value = if same { values[0].to_string() } else { format!("[{}]", list()) };
        match quantity.spread {
            Spread::Fixed => value,
            Spread::Within(half) => format!("{value} ± {half}"),
            Spread::Share(share) => format!("{value} ± {} %", (1000.0 * share).round() / 10.0),
            Spread::Sigma(sigma) => format!("{value}, σ {sigma}"),
        }
    };
    let mut table = String::from(
        "| quantity | unit | `real` | `hard` | `ideal` | range | meaning |\n|---|---|---|---|---|---|---|\n",
    );
    let [real, hard, ideal] =
        ["real", "hard", "ideal"].map(|name| World::shipped(name).unwrap().quantities().collect::<Vec<_>>());
    for ((group, field, quantity), (hard, ideal)) in real.iter().zip(hard.iter().zip(&ideal)) {
        let unit = if field.unit.is_empty() { "–" } else { field.unit };
        table.push_str(&format!(
            "| `{group}.{}` | {unit} | {} | {} | {} | {} to {} | {} |\n",
            field.name,
            said(quantity),
            said(hard.2),
            said(ideal.2),
            field.least,
            field.most,
            field.meaning.trim()
        ));
    }
    check_table(WORLDS, &table);
}

/// The page of the starts has a table of all quantities.
#[test]
fn the_table_of_the_starts_is_up_to_date() {
    const STARTS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/src/reference/starts.md");
    let mut table = String::from(
        "| quantity | unit | `moved` | `sheet` | `scattered` | `jumbled` | range | meaning |\n|---|---|---|---|---|---|---|---|\n",
    );
    let round = |value: &f64| format!("{value:.3e}").parse::<f64>().unwrap().to_string();
    let value = |quantity: Option<&Quantity>| {
        let numbers = quantity.map(|it| it.value.iter().map(round).collect::<Vec<_>>());
        numbers.map_or("–".to_string(), |it| it.join(" to "))
    };
    let starts = [Start::moved(), Start::sheet(), Start::scattered(), Start::jumbled()];
    let all = starts.map(|start| start.quantities().map(|(_, it)| it).collect::<Vec<_>>());
    for (index, (field, _)) in Start::moved().quantities().enumerate() {
        let values = all.each_ref().map(|quantities| value(quantities[index]));
        let unit = if field.unit.is_empty() { "–" } else { field.unit };
        table.push_str(&format!(
            "| `{}` | {unit} | {} | {} to {} | {} |\n",
            field.name,
            values.join(" | "),
            field.least,
            field.most,
            field.meaning.trim()
        ));
    }
    check_table(STARTS, &table);
}

/// Compares the table of quantities in a page, or writes it anew.
fn check_table(path: &str, table: &str) {
    let page = std::fs::read_to_string(path).unwrap();
    let (head, rest) = page.split_once("<!-- quantities -->\n").unwrap();
    let (_, tail) = rest.split_once("<!-- /quantities -->").unwrap();
    let expected = format!("{head}<!-- quantities -->\n{table}<!-- /quantities -->{tail}");
    if std::env::var_os("RAMP_WRITE").is_some() {
        std::fs::write(path, &expected).unwrap();
    } else {
        assert!(page == expected, "{path} is out of date: write it anew with RAMP_WRITE=1");
    }
}
