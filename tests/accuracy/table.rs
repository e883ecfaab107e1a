//! The tables, on the terminal and in `docs/accuracy-tables.md`, and their contents in `docs/accuracy.md`.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use super::record::{Case, Efficiency, Row, Verdict, short};

/// The document of the tables.
const TABLES: &str = "docs/accuracy-tables.md";

/// The page in front of them, which counts what they hold.
const FRONT: &str = "docs/accuracy.md";

/// The document that has the table of a group: the common one, but for groups whose own page their readers look at.
fn page(group: &str) -> &'static str {
    if group == "photometry" { "docs/photometry.md" } else { TABLES }
}

/// All rows so far, by group and by the place of the case in it.
#[derive(Default)]
pub struct Table {
    cases: BTreeMap<(&'static str, usize), Found>,
}

/// What a case wrote, and what it took.
struct Found {
    rows: Vec<Row>,
    efficiencies: Vec<Efficiency>,
    seconds: f64,
    uncertainty: f64,
}

/// How many of the slowest cases are named.
const SLOWEST: usize = 20;

impl Table {
    pub fn add(&mut self, group: &'static str, place: usize, case: Case, seconds: f64) {
        let Case { rows, efficiencies, uncertainty, .. } = case;
        self.cases.insert((group, place), Found { rows, efficiencies, seconds, uncertainty });
    }

    fn rows(&self) -> impl Iterator<Item = (&'static str, &Row)> {
        self.cases.iter().flat_map(|((group, _), found)| found.rows.iter().map(|row| (*group, row)))
    }

    /// Cases and comparisons, passed and failed.
    fn summary(&self) -> String {
        let count = |verdict: fn(&Verdict) -> bool| self.rows().filter(|(_, row)| verdict(&row.verdict)).count();
        let known = count(|verdict| matches!(verdict, Verdict::Known(_)));
        let mut text = format!(
            "{} cases, {} comparisons: {} passed, {} failed, {} known to fail",
            self.cases.len(),
            self.rows().count(),
            count(|verdict| *verdict == Verdict::Pass),
            count(|verdict| *verdict == Verdict::Fail),
            known
        );
        let mut reasons: BTreeMap<&str, Vec<String>> = BTreeMap::new();
        for (_, row) in self.rows() {
            if let Verdict::Known(reason) = row.verdict {
                reasons.entry(reason).or_default().push(format!("{} {}: {}", row.id, row.title, row.what));
            }
        }
        for (reason, rows) in reasons {
            let _ = write!(text, "\n\n*{reason}*\n");
            rows.iter().for_each(|row| _ = write!(text, "\n- {row}"));
        }
        text
    }

    /// For the terminal: everything, or what failed only.
    pub fn to_text(&self, is_full: bool) -> String {
        let mut text = String::new();
        if is_full {
            let groups: Vec<&str> = super::groups().into_iter().map(|(group, _)| group).collect();
            for group in groups {
                let _ = write!(text, "\n{group}\n{}", self.group_table(group));
            }
            let _ = write!(text, "\ntime against error\n{}", self.efficiency_table());
        }
        let _ = writeln!(text, "\n{}", self.summary());
        if !is_full {
            text += &self.slowest();
        }
        text
    }

    /// Where the time goes. Cases run beside each other, so that these are not the seconds that a case takes alone.
    fn slowest(&self) -> String {
        let mut cases: Vec<&Found> = self.cases.values().filter(|found| !found.rows.is_empty()).collect();
        cases.sort_by(|a, b| b.seconds.total_cmp(&a.seconds));
        let all: f64 = cases.iter().map(|found| found.seconds).sum();
        let mut text = format!("\n{all:.0} s in all; the slowest, with their largest standard error over its limit:\n");
        for Found { rows, seconds, uncertainty, .. } in cases.into_iter().take(SLOWEST) {
            let _ = writeln!(text, "{seconds:5.1} s  {uncertainty:.2}  {} {}", rows[0].id, rows[0].title);
        }
        text
    }

    fn group_table(&self, group: &str) -> String {
        let mut text =
            "| case | what | expected | got | off by | tolerance | |\n|---|---|---|---|---|---|---|\n".to_owned();
        for (_, row) in self.rows().filter(|(of, _)| *of == group) {
            let Row { id, title, what, expected, got, off, tolerance, verdict } = row;
            let verdict = match verdict {
                Verdict::Pass => "pass",
                Verdict::Fail => "**FAIL**",
                Verdict::Known(_) => "**fails**",
            };
            let _ = writeln!(text, "| {id} {title} | {what} | {expected} | {got} | {off} | {tolerance} | {verdict} |");
        }
        text
    }

    fn efficiency_table(&self) -> String {
        let mut text = "| case | samples: seconds, relative RMSE, 1/(RMSE² s) | slope |\n|---|---|---|\n".to_owned();
        for efficiency in self.cases.values().flat_map(|found| &found.efficiencies) {
            let efforts: Vec<String> = efficiency
                .efforts
                .iter()
                .map(|effort| {
                    let per_second = 1.0 / (effort.rmse * effort.rmse * effort.seconds);
                    let [seconds, rmse, per_second] = [effort.seconds, effort.rmse, per_second].map(short);
                    format!("{}: {seconds}, {rmse}, {per_second}", effort.samples)
                })
                .collect();
            let Efficiency { id, what, slope, .. } = efficiency;
            let _ = writeln!(text, "| {id} {what} | {} | {} |", efforts.join("; "), short(*slope));
        }
        text
    }

    /// Compares the document with what was tried: every row must be there. Writes the tables into it, and their contents into
    /// the page in front of them, where `ETENDUE_WRITE` is set and the numbers are large, or one group's where it names that.
    pub fn check_document(&self, is_full: bool) -> Result<(), String> {
        let group = std::env::var("ETENDUE_WRITE").ok();
        // One group alone, with the numbers of this run; the others keep theirs.
        if let Some(group) = group.as_ref().filter(|name| super::groups().iter().any(|(group, _)| group == name)) {
            self.write_group(group)?;
            return write_front();
        }
        if is_full && group.is_some() {
            for (group, _) in super::groups() {
                self.write_group(group)?;
            }
            for (name, table) in [("time", self.efficiency_table()), ("summary", self.summary())] {
                write(TABLES, &replaced(&read(TABLES)?, name, &table)?)?;
            }
            return write_front();
        }
        let mut texts = BTreeMap::new();
        for (group, _) in super::groups() {
            texts.insert(group, read(page(group))?);
        }
        let missing: Vec<String> = self
            .rows()
            .map(|(group, row)| (group, format!("| {} {} | {} |", row.id, row.title, row.what)))
            .filter(|(group, start)| !texts[group].contains(start.as_str()))
            .map(|(group, start)| format!("{}: {start}", page(group)))
            .collect();
        if missing.is_empty() {
            return Ok(());
        }
        Err(format!(
            "the tables lack {} rows (ETENDUE_WRITE=1 make accuracy writes them):\n{}",
            missing.len(),
            missing.join("\n")
        ))
    }

    fn write_group(&self, group: &str) -> Result<(), String> {
        write(page(group), &replaced(&read(page(group))?, group, &self.group_table(group))?)
    }
}

/// Whether the page in front of the tables counts what they hold.
pub fn check_front() -> Result<(), String> {
    let front = read(FRONT)?;
    let counted = replaced(&front, "contents", &contents()?)?;
    if counted == front {
        Ok(())
    } else {
        Err(format!(
            "{FRONT} does not count what the tables hold (ETENDUE_WRITE=front cargo test --test accuracy does)"
        ))
    }
}

/// A line for each group, with the heading over its table and what the table holds.
fn contents() -> Result<String, String> {
    let mut text =
        "| topic | cases | comparisons | passed | known to fail | farthest mean, standard errors (limit 4) |\n\
                    |---|--:|--:|--:|--:|--:|\n"
            .to_owned();
    let mut total = Contents::default();
    for (group, _) in super::groups() {
        let tables = read(page(group))?;
        let (before, table, _) = divided(&tables, group)?;
        let heading = before.lines().rfind(|line| line.starts_with("## ")).map_or(group, |line| &line[3..]);
        let anchor = heading.to_lowercase().replace(' ', "-");
        let file = page(group).trim_start_matches("docs/");
        let contents = Contents::of(table);
        let _ = writeln!(text, "| [{heading}]({file}#{anchor}) | {} |", contents.to_cells());
        total.cases += contents.cases;
        total.rows += contents.rows;
        total.passed += contents.passed;
        total.known += contents.known;
        total.farthest = total.farthest.max(contents.farthest);
    }
    let _ = writeln!(text, "| all | {} |", total.to_cells());
    Ok(text)
}

/// What a table holds.
#[derive(Default)]
struct Contents {
    cases: usize,
    rows: usize,
    passed: usize,
    known: usize,
    /// Standard errors by which a mean that passed is off, at most, where that is all it may be off by.
    farthest: f64,
}

impl Contents {
    fn of(table: &str) -> Self {
        let mut contents = Self::default();
        let mut cases = BTreeSet::new();
        // Without the names of the columns.
        for row in table.lines().filter(|line| line.starts_with("| ")).skip(1) {
            let cells: Vec<&str> = row.trim_matches(['|', ' ']).split(" | ").collect();
            let &[case, _, _, _, off, tolerance, verdict] = &cells[..] else { continue };
            cases.insert(case);
            contents.rows += 1;
            contents.known += usize::from(verdict == "**fails**");
            if verdict == "pass" {
                contents.passed += 1;
                let errors = off.split_once(" s, ").filter(|_| tolerance.starts_with("4 s, "));
                contents.farthest = contents.farthest.max(errors.and_then(|(s, _)| s.parse().ok()).unwrap_or(0.0));
            }
        }
        contents.cases = cases.len();
        contents
    }

    fn to_cells(&self) -> String {
        let Self { cases, rows, passed, known, farthest } = *self;
        let farthest = if farthest == 0.0 { "—".to_owned() } else { short(farthest) };
        format!("{cases} | {rows} | {passed} | {known} | {farthest}")
    }
}

fn path(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(name)
}

fn read(name: &str) -> Result<String, String> {
    std::fs::read_to_string(path(name)).map_err(|error| format!("{name}: {error}"))
}

fn write(name: &str, text: &str) -> Result<(), String> {
    std::fs::write(path(name), text).map_err(|error| format!("{name}: {error}"))
}

/// Writes what the tables hold into the page in front of them.
pub fn write_front() -> Result<(), String> {
    write(FRONT, &replaced(&read(FRONT)?, "contents", &contents()?)?)
}

/// `text` before, between and after the marks of `name`.
fn divided<'t>(text: &'t str, name: &str) -> Result<(&'t str, &'t str, &'t str), String> {
    let (start, end) = (format!("<!-- {name} -->\n"), format!("<!-- end {name} -->"));
    let missing = || format!("a document of the accuracy has no marks for {name}");
    let (before, rest) = text.split_once(&start).ok_or_else(missing)?;
    let (between, after) = rest.split_once(&end).ok_or_else(missing)?;
    Ok((before, between, after))
}

/// `text` with what stands between the marks of `name` replaced.
fn replaced(text: &str, name: &str, table: &str) -> Result<String, String> {
    let (before, _, after) = divided(text, name)?;
    Ok(format!("{before}<!-- {name} -->\n\n{table}\n<!-- end {name} -->{after}"))
}
