//! `results.md`, and the same tables in a given document.

use std::fmt::Write;

use super::results::{Group, Point, Results, Series, Spread};

/// Start of the marker at which a table in a document begins; ` NAME -->` follows.
const OPEN: &str = "<!-- bench ";
/// The marker at which a table ends.
const CLOSE: &str = "<!-- /bench -->";
/// Name of the block that describes the machine.
const MACHINE: &str = "machine";

/// The whole document.
pub fn document(results: &Results) -> String {
    let mut text = format!("# {}\n\n", escape(&results.title));
    if !results.description.is_empty() {
        let _ = writeln!(text, "{}\n", escape(&results.description));
    }
    let _ = writeln!(text, "{}", machine(results));
    for group in &results.groups {
        let _ = write!(text, "\n## {}\n\n", escape(&group.title));
        if !group.description.is_empty() {
            let _ = writeln!(text, "{}\n", escape(&group.description));
        }
        text += &tables(results, group);
    }
    if !results.notes.is_empty() {
        text += "\n## Notes\n\n";
        results.notes.iter().for_each(|note| text += &format!("- {}\n", escape(note)));
    }
    text
}

/// The document `text` with new tables between its markers, and the names of the blocks without measurements, which
/// stay as they are.
pub fn fill(text: &str, results: &Results) -> Result<(String, Vec<String>), String> {
    let (mut filled, mut missing, mut rest) = (String::new(), Vec::new(), text);
    for (name, start, end) in blocks(text)? {
        let done = text.len() - rest.len();
        filled += &text[done..start];
        let group = results.groups.iter().find(|group| group.name == name);
        let table = if name == MACHINE { Some(machine(results) + "\n") } else { group.map(|g| tables(results, g)) };
        match table.filter(|table| !table.is_empty()) {
            Some(table) => filled += &format!("\n{}\n", table.trim_end()),
            None => {
                filled += &text[start..end];
                missing.push(name.to_owned());
            }
        }
        rest = &text[end..];
    }
    Ok((filled + rest, missing))
}

/// The blocks of a document: name, and the range of its content.
pub fn blocks(text: &str) -> Result<Vec<(&str, usize, usize)>, String> {
    let mut blocks = Vec::new();
    let mut at = 0;
    while let Some(open) = text[at..].find(OPEN).map(|found| at + found) {
        let line = 1 + text[..open].matches('\n').count();
        let name = open + OPEN.len();
        let length = text[name..].find(" -->").ok_or_else(|| format!("line {line}: the comment does not end"))?;
        let start = name + length + " -->".len();
        let end = text[start..].find(CLOSE).map(|found| start + found);
        let end = end.filter(|end| !text[start..*end].contains(OPEN));
        let end = end.ok_or_else(|| format!("line {line}: '{CLOSE}' is missing"))?;
        blocks.push((&text[name..name + length], start, end));
        at = end;
    }
    Ok(blocks)
}

/// A paragraph that describes the measurement.
fn machine(results: &Results) -> String {
    let mut text = String::new();
    if let Some(machine) = &results.machine {
        let _ = write!(
            text,
            "{}, {} logical cores, {}; {} with Embree {} ({}). ",
            escape(&machine.cpu),
            machine.logical_cores,
            escape(&machine.os),
            machine.renderer,
            machine.embree,
            machine.build
        );
    }
    let runs = results.runs;
    let _ = write!(
        text,
        "{}: medians of {runs} runs with different seeds (least–most), in turns. Error: relative mean squared error against \
         a path-traced reference without cuts, whose own noise is taken off. Noise: the share of it that differs from run \
         to run. Bias²: the share that all runs have in common; < x: cannot be told from none. Efficiency: 1 / (error × s).",
        results.when.split('T').next().unwrap_or_default()
    );
    if !results.complete {
        text += " **Stopped before its end.**";
    }
    text
}

/// The tables of a group, one for each scene.
fn tables(results: &Results, group: &Group) -> String {
    let mut text = String::new();
    let plots: Vec<_> = results.plots().into_iter().filter(|(of, _)| of.name == group.name).collect();
    for (_, scene) in &plots {
        if plots.len() > 1 {
            let _ = write!(text, "\n### {}\n\n", escape(scene));
        }
        let series: Vec<_> = results.series_of(&group.name, scene).collect();
        text += &against(results, &series);
        text += "| | samples | s | Mrays/s | error | noise | bias² | mean / reference | efficiency | peak MiB |\n";
        text += "|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|\n";
        for one in &series {
            for point in &one.points {
                text += &row(&label(one, &series), point);
            }
        }
    }
    text
}

/// The references of a table's curves.
fn against(results: &Results, series: &[&Series]) -> String {
    let is_used = |name: &str| series.iter().any(|one| one.reference.as_deref() == Some(name));
    let used = results.references.iter().filter(|reference| is_used(&reference.name));
    let lines = used.map(|reference| {
        let samples = reference.samples.map_or(String::new(), |samples| format!(", {samples} samples per pixel"));
        let noise =
            reference.noise.map_or("unknown noise".to_owned(), |noise| format!("own noise {}", scientific(noise)));
        format!("Reference: {}{samples}, {noise}.\n\n", escape(&reference.name))
    });
    lines.collect()
}

/// The label of a curve among its neighbours, without the words that all of them share.
pub fn label(one: &Series, series: &[&Series]) -> String {
    let differs = |key: fn(&Series) -> String| series.iter().any(|other| key(other) != key(one));
    let mut words = Vec::new();
    if differs(|series| series.renderer.clone()) {
        words.push(one.renderer.clone());
    }
    if !one.name.is_empty() {
        words.push(one.name.clone());
    }
    if let (Some(threads), true) = (one.threads, differs(|series| format!("{:?}", series.threads))) {
        words.push(format!("{threads} thread{}", if threads == 1 { "" } else { "s" }));
    }
    words.join(", ")
}

fn row(name: &str, point: &Point) -> String {
    let optional = |text: Option<String>| text.unwrap_or_else(|| "–".to_owned());
    let mebibytes = |bytes: u64| bytes.div_ceil(1 << 20).to_string();
    let cells = [
        escape(name),
        optional(point.samples.map(|samples| samples.to_string())),
        spread(&point.seconds, three_digits),
        optional(point.rays_per_second.map(|rate| format!("{:.2}", 1e-6 * rate.median))),
        spread(&point.rel_mse, scientific),
        optional(point.noise.map(scientific)),
        optional(bias(point)),
        optional(point.mean_ratio.map(|ratio| format!("{ratio:.4}"))),
        optional(point.efficiency.map(|efficiency| three_digits(efficiency.median))),
        optional(point.peak_memory.map(mebibytes)),
    ];
    format!("| {} |\n", cells.join(" | "))
}

/// The squared bias, or its upper limit.
fn bias(point: &Point) -> Option<String> {
    let (bias, resolution) = (point.bias?, point.bias_resolution?);
    Some(if bias > resolution { scientific(bias) } else { format!("< {}", scientific(resolution)) })
}

fn spread(spread: &Spread, number: fn(f64) -> String) -> String {
    let (median, min, max) = (number(spread.median), number(spread.min), number(spread.max));
    if min == max { median } else { format!("{median} ({min}–{max})") }
}

/// Three significant digits, without an exponent where that is readable.
fn three_digits(value: f64) -> String {
    if !(1e-3..=1e6).contains(&value.abs()) {
        return scientific(value);
    }
    let digits = value.abs().log10().floor() as i32;
    format!("{value:.*}", usize::try_from(2 - digits).unwrap_or(0))
}

fn scientific(value: f64) -> String {
    format!("{value:.2e}")
}

/// Escapes names from files for a table: no markup, no new column, no new line.
fn escape(text: &str) -> String {
    let mut escaped = String::new();
    for letter in text.chars() {
        match letter {
            '\n' | '\r' => escaped.push(' '),
            '&' => escaped += "&amp;",
            '<' => escaped += "&lt;",
            '|' | '*' | '_' | '`' | '[' | ']' | '\\' => escaped.extend(['\\', letter]),
            letter => escaped.push(letter),
        }
    }
    escaped
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_go_between_their_markers_and_nowhere_else() {
        let group = Group { name: "a".to_owned(), title: "A".to_owned(), description: String::new() };
        let number = |value| Spread { median: value, min: value, max: value };
        let point = Point {
            samples: Some(16),
            budget_seconds: None,
            seconds: number(2.0),
            rel_mse: number(0.5),
            rays_per_second: None,
            efficiency: None,
            noise: Some(0.5),
            bias: Some(0.0),
            bias_resolution: Some(0.01),
            mean_ratio: None,
            peak_memory: None,
            runs: Vec::new(),
        };
        let name = "x|y".to_owned();
        let series = Series { name, group: Some("a".to_owned()), points: vec![point], ..Series::default() };
        let results = Results { groups: vec![group], series: vec![series], ..Results::default() };
        let text = "one\n<!-- bench a -->\nold\n<!-- /bench -->\ntwo\n<!-- bench b -->\nkept\n<!-- /bench -->\nthree";
        let (filled, missing) = fill(text, &results).unwrap();
        assert_eq!(missing, ["b"]);
        assert!(filled.starts_with("one\n<!-- bench a -->\n| |"), "{filled}");
        assert!(filled.contains("| x\\|y | 16 | 2.00 | – | 5.00e-1 | 5.00e-1 | < 1.00e-2 |"), "{filled}");
        assert!(filled.ends_with("<!-- /bench -->\ntwo\n<!-- bench b -->\nkept\n<!-- /bench -->\nthree"), "{filled}");
        assert_eq!(fill(&filled, &results).unwrap().0, filled);
        assert!(blocks("<!-- bench a -->\n<!-- bench b --><!-- /bench -->").is_err());
        assert!(blocks("<!-- bench a").is_err());
    }

    #[test]
    fn numbers_have_three_digits() {
        let written: Vec<_> = [123.4, 12.34, 1.234, 0.1234, 0.0001234, 12345.0, 1.234e9].map(three_digits).into();
        assert_eq!(written, ["123", "12.3", "1.23", "0.123", "1.23e-4", "12345", "1.23e9"]);
    }
}
