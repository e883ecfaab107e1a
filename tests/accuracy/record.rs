//! What a case writes down: one row for each thing it compared.

use std::fmt::Write as _;

/// A case of the table: some rows about one difficulty.
pub struct Entry {
    /// Letter and number, unique, such as "I7"; the letter is the group's.
    pub id: &'static str,
    /// The difficulty in a few words.
    pub title: &'static str,
    /// Compares, and writes rows.
    pub run: fn(&mut Case),
}

/// How a row came out.
#[derive(Clone, Debug, PartialEq)]
pub enum Verdict {
    Pass,
    Fail,
    /// Fails, as is known, for this reason.
    Known(&'static str),
}

/// One comparison.
#[derive(Clone, Debug)]
pub struct Row {
    pub id: &'static str,
    pub title: &'static str,
    /// What was compared, in words that are the same for every budget.
    pub what: String,
    pub expected: String,
    pub got: String,
    /// How far off, in the measure of the tolerance.
    pub off: String,
    pub tolerance: String,
    pub verdict: Verdict,
}

/// Time and error of one number of samples.
#[derive(Clone, Copy, Debug)]
pub struct Effort {
    pub samples: u32,
    pub seconds: f64,
    /// Root mean squared error relative to the exact value.
    pub rmse: f64,
}

/// Efforts of a case, for the table of time against error.
#[derive(Clone, Debug)]
pub struct Efficiency {
    pub id: &'static str,
    pub what: String,
    pub efforts: Vec<Effort>,
    pub slope: f64,
}

/// By how much a number may be off.
#[derive(Clone, Copy, Debug)]
pub enum Within {
    /// So many units in the last place of the expected value in single precision.
    Ulps(f64),
    /// Relative to the expected value.
    Relative(f64),
    /// In the value's own unit.
    Absolute(f64),
}

/// Error of a mean, over and above its standard error, that single precision arithmetic may cause.
const ARITHMETIC: f64 = 1e-6;

/// The largest slope of log error over log samples of an unbiased estimate, by the theory -0.5, with room for noise.
const SLOPE: f64 = -0.45;

/// A case that is being tried.
pub struct Case {
    id: &'static str,
    title: &'static str,
    is_full: bool,
    known: Option<&'static str>,
    /// The largest standard error of a mean over the largest that it may have. Its square is about the share of the samples
    /// that would do.
    pub uncertainty: f64,
    pub rows: Vec<Row>,
    pub efficiencies: Vec<Efficiency>,
}

impl Case {
    pub fn new(entry: &Entry, is_full: bool) -> Self {
        Self {
            id: entry.id,
            title: entry.title,
            is_full,
            known: None,
            uncertainty: 0.0,
            rows: Vec::new(),
            efficiencies: Vec::new(),
        }
    }

    /// Whether there is time for the large numbers.
    pub fn is_full(&self) -> bool {
        self.is_full
    }

    /// How many: `quick` in the test, `full` in the table of the documents.
    pub fn count(&self, quick: u64, full: u64) -> u64 {
        if self.is_full { full } else { quick }
    }

    /// The next row is known to fail, for this reason. If it passes after all, that is a failure of the case: the reason
    /// is out of date.
    pub fn known(&mut self, reason: &'static str) -> &mut Self {
        self.known = Some(reason);
        self
    }

    /// A number without statistics.
    pub fn exact(&mut self, what: impl Into<String>, got: f64, expected: f64, within: Within) {
        let off = (got - expected).abs();
        let ulps = off / ulp(expected);
        let (passes, off, tolerance) = match within {
            Within::Ulps(limit) => (ulps <= limit, format!("{} ulp", short(ulps)), format!("{} ulp", short(limit))),
            Within::Relative(limit) => {
                let relative = off / expected.abs();
                (relative <= limit, format!("{} rel", short(relative)), format!("{} rel", short(limit)))
            }
            Within::Absolute(limit) => (off <= limit, short(off), short(limit)),
        };
        self.row(what, long(expected), long(got), off, tolerance, passes);
    }

    /// Whether a standard error is small enough to prove something; notes how near to its limit it is.
    fn is_precise(&mut self, error: f64, limit: f64) -> bool {
        self.uncertainty = self.uncertainty.max(error / limit);
        error <= limit
    }

    /// A mean with its standard error: within four of them (and rounding), and precise enough to prove something: no
    /// larger than `tolerance`, relative to the exact value.
    pub fn mean(&mut self, what: impl Into<String>, (mean, error): (f64, f64), exact: f64, tolerance: f64) {
        let off = (mean - exact).abs();
        let is_precise = self.is_precise(error, tolerance * exact.abs());
        let standard_errors = if off <= ARITHMETIC * exact.abs() { 0.0 } else { off / error };
        let passes = off <= 4.0 * error + ARITHMETIC * exact.abs() && is_precise;
        self.row(
            what,
            long(exact),
            format!("{} ± {}", long(mean), short(error)),
            format!("{} s, {} rel", short(standard_errors), short(off / exact.abs())),
            format!("4 s, s ≤ {} rel", short(tolerance)),
            passes,
        );
    }

    /// A mean whose estimate may be biased by as much as `bias`, relative to the exact value, for a stated reason: within four
    /// standard errors and that.
    pub fn biased_mean(
        &mut self,
        what: impl Into<String>,
        (mean, error): (f64, f64),
        exact: f64,
        (bias, tolerance): (f64, f64),
    ) {
        let off = (mean - exact).abs();
        let is_precise = self.is_precise(error, tolerance * exact.abs());
        let beyond = (off - (bias + ARITHMETIC) * exact.abs()).max(0.0);
        let passes = beyond <= 4.0 * error && is_precise;
        self.row(
            what,
            long(exact),
            format!("{} ± {}", long(mean), short(error)),
            format!("{} s, {} rel", short(off / error), short(off / exact.abs())),
            format!("4 s + {} rel, s ≤ {} rel", short(bias), short(tolerance)),
            passes,
        );
    }

    /// Two means that should be one, each with its standard error.
    pub fn equal_means(&mut self, what: impl Into<String>, a: (f64, f64), b: (f64, f64), tolerance: f64) {
        let error = a.1.hypot(b.1);
        self.mean(what, (a.0, error), b.0, tolerance);
    }

    /// Something that must not happen.
    pub fn never(&mut self, what: impl Into<String>, bad: u64, tried: u64) {
        self.rarely(what, bad, tried, 0.0);
    }

    /// Something that may happen in this share of the tries at most.
    pub fn rarely(&mut self, what: impl Into<String>, bad: u64, tried: u64, share: f64) {
        let passes = tried > 0 && bad as f64 <= share * tried as f64;
        let rate = bad as f64 / tried.max(1) as f64;
        self.row(what, "0", format!("{bad} of {}", short(tried as f64)), short(rate), short(share), passes);
    }

    /// A number no larger than a limit.
    pub fn at_most(&mut self, what: impl Into<String>, got: f64, limit: f64) {
        self.row(what, format!("≤ {}", short(limit)), long(got), short(got / limit), "1", got <= limit);
    }

    /// A p-value out of a family of `tests`, at a significance of 1 % for the whole family (Šidák).
    pub fn p_value(&mut self, what: impl Into<String>, p: f64, tests: usize) {
        let limit = super::stats::sidak(super::stats::SIGNIFICANCE, tests);
        self.row(what, format!("p > {}", short(limit)), format!("p = {}", short(p)), short(p), short(limit), p > limit);
    }

    /// A statement that holds or not; `got` is what was seen.
    pub fn holds(&mut self, what: impl Into<String>, expected: &str, got: impl Into<String>, passes: bool) {
        self.row(what, expected, got, if passes { "0" } else { "—" }, "exact", passes);
    }

    /// The error of an estimate over rising numbers of samples: it must fall as theory says. Noted with its time.
    pub fn convergence(&mut self, what: impl Into<String>, efforts: &[Effort]) {
        let what = what.into();
        let points: Vec<_> = efforts.iter().map(|effort| (f64::from(effort.samples), effort.rmse)).collect();
        let slope = super::stats::log_log_slope(&points);
        self.efficiencies.push(Efficiency { id: self.id, what: what.clone(), efforts: efforts.to_vec(), slope });
        let what = format!("{what}: slope of log error over log samples");
        self.row(what, "≤ -0.5", long(slope), short(slope + 0.5), short(SLOPE + 0.5), slope <= SLOPE);
    }

    fn row(
        &mut self,
        what: impl Into<String>,
        expected: impl Into<String>,
        got: impl Into<String>,
        off: impl Into<String>,
        tolerance: impl Into<String>,
        passes: bool,
    ) {
        let verdict = match (passes, self.known.take()) {
            (true, None) => Verdict::Pass,
            (false, Some(reason)) => Verdict::Known(reason),
            (false, None) | (true, Some(_)) => Verdict::Fail,
        };
        self.rows.push(Row {
            id: self.id,
            title: self.title,
            what: what.into(),
            expected: expected.into(),
            got: got.into(),
            off: off.into(),
            tolerance: tolerance.into(),
            verdict,
        });
    }

    /// The rows that failed and should not have, for people.
    pub fn failures(&self) -> Option<String> {
        let mut text = String::new();
        for row in self.rows.iter().filter(|row| row.verdict == Verdict::Fail) {
            let Row { id, what, expected, got, off, tolerance, .. } = row;
            let _ = writeln!(text, "{id} {what}: expected {expected}, got {got}, off by {off}, tolerance {tolerance}");
        }
        (!text.is_empty()).then_some(text)
    }
}

/// A unit in the last place of a number's single-precision neighbour, the smallest normal one's for tiny numbers.
pub fn ulp(x: f64) -> f64 {
    let x = (x.abs() as f32).max(f32::MIN_POSITIVE);
    f64::from(x.next_up()) - f64::from(x)
}

/// Few digits.
pub fn short(x: f64) -> String {
    let size = x.abs();
    if x == 0.0 {
        "0".to_owned()
    } else if (1e-3..1e4).contains(&size) {
        let text = format!("{x:.*}", if size < 1.0 { 4 } else { 2 });
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        let text = format!("{x:.1e}");
        text.replace(".0e", "e")
    }
}

/// As many digits as single precision has, and some more.
fn long(x: f64) -> String {
    if x == 0.0 || (1e-3..1e7).contains(&x.abs()) {
        format!("{x:.9}").trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        format!("{x:.8e}")
    }
}
