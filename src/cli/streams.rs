//! The three streams: data to stdout, everything else to stderr, progress only on a terminal.

use std::io::{self, BufWriter, IsTerminal as _, StdoutLock, Write as _};

use indicatif::{MultiProgress, ProgressBar, ProgressStyle};
use serde_json::{Value, json};

/// Version of the JSON output.
pub const JSON_SCHEMA: u32 = 2;

/// Where output goes. stdout is locked and buffered; a closed pipe comes back as an error and never
/// as a panic.
pub struct Streams {
    out: BufWriter<StdoutLock<'static>>,
    quiet: bool,
    /// Bars that are shown at the same time, one below the other.
    bars: MultiProgress,
    /// stdout carries one JSON object.
    pub json: bool,
}

impl Streams {
    pub fn new(quiet: bool, json: bool) -> Self {
        Self {
            out: BufWriter::new(io::stdout().lock()),
            quiet,
            bars: MultiProgress::new(),
            json,
        }
    }

    /// Data, to stdout.
    pub fn bytes(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.out.write_all(bytes)
    }

    pub fn text(&mut self, text: &str) -> io::Result<()> {
        self.bytes(text.as_bytes())
    }

    /// The one object of `--json`.
    pub fn object(&mut self, command: &str, adapter: Value, results: Vec<Value>) -> io::Result<()> {
        let object = json!({ "schema": JSON_SCHEMA, "command": command, "adapter": adapter, "results": results });
        self.text(&format!("{object:#}\n"))
    }

    /// A note for people, on stderr.
    pub fn note(&self, text: &str) {
        if !self.quiet {
            // A closed stderr leaves no place for an error.
            let _ = writeln!(io::stderr(), "{text}");
        }
    }

    /// A progress bar of `steps` on stderr that is removed at the end; hidden without a terminal
    /// and with `--quiet`.
    pub fn progress(&self, steps: u64) -> ProgressBar {
        let dumb = std::env::var_os("TERM").is_some_and(|term| term == "dumb");
        if self.quiet || dumb || !io::stderr().is_terminal() {
            return ProgressBar::hidden();
        }
        let style = ProgressStyle::with_template("{bar:32} {pos}/{len}  {eta} left  {msg}")
            .unwrap_or_else(|_| ProgressStyle::default_bar());
        self.bars.add(ProgressBar::new(steps).with_style(style))
    }

    /// A progress bar of bytes on stderr, as [`Self::progress`]. It appears where the work takes
    /// longer than a moment.
    pub fn byte_progress(&self) -> ProgressBar {
        let style = ProgressStyle::with_template("{bar:32} {msg}")
            .unwrap_or_else(|_| ProgressStyle::default_bar());
        self.progress(0).with_style(style)
    }

    /// Data that is written at once, without buffering.
    pub fn text_now(&mut self, text: &str) -> io::Result<()> {
        self.text(text)?;
        self.out.flush()
    }

    pub fn finish(&mut self) -> io::Result<()> {
        self.out.flush()
    }
}

/// Rows in aligned columns; the first row is the head. Columns of numbers are aligned right.
pub fn table(rows: &[Vec<String>]) -> String {
    let columns = Columns::of(rows);
    rows.iter().map(|row| columns.line(row)).collect()
}

/// Widths and alignment of a table's columns, for a table that is written line by line.
pub struct Columns(Vec<(usize, bool)>);

impl Columns {
    /// As wide as the widest of these rows, the first of which is the head; a column of numbers is
    /// aligned right.
    pub fn of(rows: &[Vec<String>]) -> Self {
        let columns = rows.iter().map(Vec::len).max().unwrap_or(0);
        let cell = |row: &[String], column: usize| row.get(column).cloned().unwrap_or_default();
        let width = |column| {
            rows.iter()
                .map(|row| cell(row, column).chars().count())
                .max()
                .unwrap_or(0)
        };
        let is_number = |text: &str| {
            text.is_empty() || text == "-" || text.starts_with(|c: char| c.is_ascii_digit())
        };
        let is_right =
            |column| rows.len() > 1 && rows[1..].iter().all(|row| is_number(&cell(row, column)));
        Self(
            (0..columns)
                .map(|column| (width(column), is_right(column)))
                .collect(),
        )
    }

    pub fn line(&self, row: &[String]) -> String {
        let cells = self
            .0
            .iter()
            .enumerate()
            .map(|(column, &(width, is_right))| {
                let text = row.get(column).map_or("", String::as_str);
                if is_right {
                    format!("{text:>width$}")
                } else {
                    format!("{text:<width$}")
                }
            });
        format!("{}\n", cells.collect::<Vec<_>>().join("  ").trim_end())
    }
}

/// A float for JSON, which has no numbers that are not finite.
pub fn number(value: f64) -> Value {
    match value {
        v if v.is_nan() => json!("NaN"),
        v if v == f64::INFINITY => json!("inf"),
        v if v == f64::NEG_INFINITY => json!("-inf"),
        v => json!(v),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_stand_right_and_words_left() {
        let row = |cells: [&str; 2]| cells.map(str::to_owned).to_vec();
        assert_eq!(
            table(&[row(["preset", "px"]), row(["a", "10"]), row(["facet", "9"])]),
            "preset  px\na       10\nfacet    9\n"
        );
    }

    #[test]
    fn json_never_says_null_for_a_number() {
        assert_eq!(
            [number(f64::NAN), number(f64::NEG_INFINITY), number(0.5)],
            [json!("NaN"), json!("-inf"), json!(0.5)]
        );
    }
}
