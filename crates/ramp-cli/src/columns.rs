//! Tables of text. One that is wider than the terminal is split into several, one below the other.

use std::io::stdout;

use rustix::termios::tcgetwinsize;

/// Space between two columns, characters.
const GAP: usize = 2;

/// Width of the terminal that standard output is, or the environment variable `COLUMNS` says; characters.
/// Nothing if the output goes elsewhere.
pub fn terminal_width() -> Option<usize> {
    let told = || std::env::var("COLUMNS").ok()?.parse().ok();
    tcgetwinsize(stdout()).ok().map(|size| usize::from(size.ws_col)).or_else(told).filter(|&width| width > 0)
}

/// A table: the first columns name its rows.
pub struct Table {
    /// Number of columns that name a row.
    names: usize,
    /// Rows, headings first.
    rows: Vec<Vec<String>>,
}

impl Table {
    /// A table with these headings. The first `names` columns name its rows, and are aligned to the left.
    pub fn new<const N: usize>(names: usize, headings: [&str; N]) -> Table {
        Table { names, rows: vec![headings.map(str::to_string).to_vec()] }
    }

    /// Adds a row: a cell for each heading.
    pub fn add<const N: usize>(&mut self, cells: [String; N]) {
        self.rows.push(cells.to_vec());
    }

    /// The lines of the table. With more columns than fit into `width` characters, the names are repeated
    /// with the columns that are left, after an empty line.
    pub fn text(&self, width: Option<usize>) -> String {
        let widths: Vec<usize> = (0..self.rows[0].len())
            .map(|column| {
                self.rows
                    .iter()
                    .filter_map(|row| row.get(column))
                    .map(|it| it.chars().count())
                    .max()
                    .unwrap_or(0)
            })
            .collect();
        let names: usize = widths[..self.names].iter().map(|width| width + GAP).sum();
        let mut text = String::new();
        let mut from = self.names;
        while from < widths.len() {
            // At least one column, however narrow the terminal.
            let mut to = from + 1;
            let mut used = names + widths[from];
            while to < widths.len() && width.is_none_or(|width| used + GAP + widths[to] <= width) {
                used += GAP + widths[to];
                to += 1;
            }
            if from > self.names {
                text.push('\n');
            }
            for row in &self.rows {
                self.line(&mut text, row, &widths, from..to);
            }
            from = to;
        }
        text
    }

    /// Adds the line of a row with the columns of a range.
    fn line(&self, text: &mut String, row: &[String], widths: &[usize], columns: std::ops::Range<usize>) {
        let begin = text.len();
        for column in (0..self.names).chain(columns) {
            let cell = row.get(column).map_or("", String::as_str);
            let space = " ".repeat(widths[column] - cell.chars().count());
            let gap = if text.len() == begin { "" } else { "  " };
            text.push_str(gap);
            let [before, after] = if column < self.names { ["", &space] } else { [&space[..], ""] };
            text.extend([before, cell, after]);
        }
        text.truncate(text.trim_end().len());
        text.push('\n');
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_is_split_where_the_terminal_ends_and_repeats_its_names() {
        let mut table = Table::new(1, ["goal", "episodes", "time"]);
        table.add(["easy-1".into(), "2/2".into(), "81.1 s ± 0.1 s".into()]);
        let whole = "goal    episodes            time\neasy-1       2/2  81.1 s ± 0.1 s\n";
        assert_eq!(table.text(None), whole);
        assert_eq!(table.text(Some(32)), whole);
        let split = "goal    episodes\neasy-1       2/2\n\ngoal              time\neasy-1  81.1 s ± 0.1 s\n";
        assert_eq!(table.text(Some(31)), split);
        assert_eq!(table.text(Some(1)), split);
    }
}
