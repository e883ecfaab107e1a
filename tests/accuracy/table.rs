//! The table, on the terminal and in `docs/accuracy.md`.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use super::record::{Case, Efficiency, Row, Verdict, short};

/// All rows so far, by group and by the place of the case in it.
#[derive(Default)]
pub struct Table {
    cases: BTreeMap<(&'static str, usize), Found>,
}

/// What a case wrote.
struct Found {
    rows: Vec<Row>,
    efficiencies: Vec<Efficiency>,
}

impl Table {
    pub fn add(&mut self, group: &'static str, place: usize, case: Case) {
        let Case { rows, efficiencies, .. } = case;
        self.cases.insert((group, place), Found { rows, efficiencies });
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

    /// Compares the document with what was tried: every row must be there. Writes the tables into it where `ETENDUE_WRITE`
    /// is set and the numbers are large.
    pub fn check_document(&self, is_full: bool) -> Result<(), String> {
        let path: PathBuf = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/accuracy.md");
        let mut text = std::fs::read_to_string(&path).map_err(|error| format!("{}: {error}", path.display()))?;
        if is_full && std::env::var_os("ETENDUE_WRITE").is_some() {
            for (group, _) in super::groups() {
                text = replaced(&text, group, &self.group_table(group))?;
            }
            text = replaced(&text, "time", &self.efficiency_table())?;
            text = replaced(&text, "summary", &self.summary())?;
            return std::fs::write(&path, text).map_err(|error| format!("{}: {error}", path.display()));
        }
        // One group alone, with the numbers of this run.
        if let Some(group) =
            std::env::var("ETENDUE_WRITE").ok().filter(|name| super::groups().iter().any(|(group, _)| group == name))
        {
            text = replaced(&text, &group, &self.group_table(&group))?;
            return std::fs::write(&path, text).map_err(|error| format!("{}: {error}", path.display()));
        }
        let missing: Vec<String> = self
            .rows()
            .map(|(_, row)| format!("| {} {} | {} |", row.id, row.title, row.what))
            .filter(|start| !text.contains(start.as_str()))
            .collect();
        if missing.is_empty() {
            return Ok(());
        }
        Err(format!(
            "docs/accuracy.md lacks {} rows (ETENDUE_WRITE=1 make accuracy writes it):\n{}",
            missing.len(),
            missing.join("\n")
        ))
    }
}

/// `text` with what stands between the marks of `name` replaced.
fn replaced(text: &str, name: &str, table: &str) -> Result<String, String> {
    let (start, end) = (format!("<!-- {name} -->\n"), format!("<!-- end {name} -->"));
    let missing = || format!("docs/accuracy.md has no marks for {name}");
    let (before, rest) = text.split_once(&start).ok_or_else(missing)?;
    let (_, after) = rest.split_once(&end).ok_or_else(missing)?;
    Ok(format!("{before}{start}\n{table}\n{end}{after}"))
}
