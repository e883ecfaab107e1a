//! Results as a table for people, as CSV and as JSON.

use std::fmt::Write as _;

use etendue::lighting::{Measured, Statistics};
use serde_json::{Value, json};

use super::{GridResult, LuxResult};
use crate::args::LuxArgs;

/// Most columns and rows of a plane whose values are printed as they lie; of others, the figures alone are.
const MOST_COLUMNS: u32 = 12;
const MOST_ROWS: u32 = 40;

/// Most single points that are printed.
const MOST_POINTS: usize = 40;

/// The table for people: of each grid its figures, and its values where they are few.
pub fn for_people(result: &LuxResult) -> String {
    let mut text = String::new();
    if let Some((outside, error)) = result.exterior {
        let _ = writeln!(text, "outside, horizontal: {} ± {} lx\n", value(outside), digits(error));
    }
    for grid in &result.grids {
        let _ = writeln!(text, "{}: {}, {}", grid.grid.name, grid.quantity(), described(grid));
        figures(&mut text, &grid.measured, grid.unit(), 1.0);
        if let Some(factors) = &grid.factors {
            figures(&mut text, factors, "% of outside", 100.0);
        }
        values(&mut text, grid);
        text.push('\n');
    }
    text
}

fn described(grid: &GridResult) -> String {
    match grid.grid.plane() {
        Some(plane) => {
            let [columns, rows] = plane.counts;
            let [x, y, z] = plane.unit_normal().to_array().map(trimmed);
            format!("{columns} x {rows} points, normal {x} {y} {z}")
        }
        None => format!("{} points", grid.places.len()),
    }
}

fn figures(text: &mut String, measured: &Measured, unit: &str, factor: f64) {
    let Some(figures) = measured.statistics() else { return };
    let Statistics { mean, mean_error, min, max, uniformity, worst_relative_error } = figures;
    let [mean, mean_error, min, max] = [mean, mean_error, min, max].map(|x| factor * x);
    let _ = writeln!(
        text,
        "  mean {} ± {}   min {}   max {}   U0 {}   {unit}, each ± {} or less",
        value(mean),
        digits(mean_error),
        value(min),
        value(max),
        if uniformity.is_nan() { "-".to_owned() } else { format!("{uniformity:.3}") },
        if worst_relative_error.is_nan() {
            "?".to_owned()
        } else {
            format!("{} %", digits(100.0 * worst_relative_error))
        }
    );
}

fn values(text: &mut String, grid: &GridResult) {
    let shown = grid.factors.as_ref().map_or((&grid.measured, 1.0), |factors| (factors, 100.0));
    match grid.grid.plane() {
        Some(plane) => {
            let [columns, rows] = plane.counts;
            if columns > MOST_COLUMNS || rows > MOST_ROWS {
                return;
            }
            // The second side points upwards, as in a picture.
            for row in shown.0.values.chunks(columns as usize).rev() {
                row.iter().for_each(|x| _ = write!(text, " {:>9}", value(shown.1 * x)));
                text.push('\n');
            }
        }
        None => {
            for (number, [at, _]) in grid.places.iter().enumerate().take(MOST_POINTS) {
                let (found, error) = (shown.1 * shown.0.values[number], shown.1 * shown.0.standard_errors[number]);
                let [x, y, z] = at.to_array();
                let _ = writeln!(text, "  {number:>3}  at {x}, {y}, {z}: {} ± {}", value(found), digits(error));
            }
            if grid.places.len() > MOST_POINTS {
                let _ = writeln!(text, "  and {} more", grid.places.len() - MOST_POINTS);
            }
        }
    }
}

/// A number with four digits that count.
pub fn value(x: f64) -> String {
    significant(x, 4)
}

/// The same without zeros at its end.
pub fn trimmed(x: f64) -> String {
    let text = value(x + 0.0);
    if text.contains('.') && !text.contains('e') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text
    }
}

/// A number with two digits that count, such as an error; `?` where it is not known.
fn digits(x: f64) -> String {
    if x.is_nan() { "?".to_owned() } else { significant(x, 2) }
}

fn significant(x: f64, count: i32) -> String {
    if x == 0.0 || !x.is_finite() {
        return format!("{x}");
    }
    let size = x.abs().log10().floor() as i32;
    match size {
        -4..=5 => format!("{x:.*}", (count - 1 - size).max(0) as usize),
        _ => format!("{x:.*e}", (count - 1) as usize),
    }
}

/// One line for each point.
pub fn csv(result: &LuxResult) -> String {
    let has_factors = result.exterior.is_some();
    let more = if has_factors { ",daylight_factor,daylight_factor_error" } else { "" };
    let mut text = format!("grid,quantity,unit,point,x,y,z,nx,ny,nz,value,standard_error{more}\r\n");
    for grid in &result.grids {
        let name = quoted(&grid.grid.name);
        for (number, [at, direction]) in grid.places.iter().enumerate() {
            let [x, y, z] = at.to_array();
            let [nx, ny, nz] = direction.to_array();
            let (quantity, unit) = (grid.quantity(), grid.unit());
            let [found, error] = of(&grid.measured, number).map(known);
            let _ = write!(text, "{name},{quantity},{unit},{number},{x},{y},{z},{nx},{ny},{nz},{found},{error}");
            if has_factors {
                let [factor, error] =
                    grid.factors.as_ref().map_or([const { String::new() }; 2], |all| of(all, number).map(known));
                let _ = write!(text, ",{factor},{error}");
            }
            text.push_str("\r\n");
        }
    }
    text
}

fn of(measured: &Measured, number: usize) -> [f64; 2] {
    [measured.values[number], measured.standard_errors[number]]
}

/// A number, or nothing where it is not known.
fn known(x: f64) -> String {
    if x.is_nan() { String::new() } else { x.to_string() }
}

/// A field as RFC 4180 has it.
fn quoted(text: &str) -> String {
    if text.contains([',', '"', '\n', '\r']) { format!("\"{}\"", text.replace('"', "\"\"")) } else { text.to_owned() }
}

/// One object with all results.
pub fn json(args: &LuxArgs, result: &LuxResult) -> String {
    let measured = |measured: &Measured| {
        let figures = measured.statistics().map(|figures| {
            json!({
                "mean": figures.mean,
                "meanStandardError": figures.mean_error,
                "min": figures.min,
                "max": figures.max,
                "uniformity": figures.uniformity,
                "worstRelativeError": figures.worst_relative_error,
            })
        });
        json!({"values": measured.values, "standardErrors": measured.standard_errors, "figures": figures})
    };
    let grids: Vec<Value> = result
        .grids
        .iter()
        .map(|grid| {
            let vectors = |which: usize| grid.places.iter().map(|both| both[which].to_array()).collect::<Vec<_>>();
            let mut object = measured(&grid.measured);
            object["name"] = json!(grid.grid.name);
            object["quantity"] = json!(grid.quantity());
            object["unit"] = json!(grid.unit());
            object["counts"] = json!(grid.grid.plane().map(|plane| plane.counts));
            object["points"] = json!(vectors(0));
            object["directions"] = json!(vectors(1));
            object["daylightFactors"] = json!(grid.factors.as_ref().map(measured));
            object["samples"] = json!(grid.summary.samples);
            object["seconds"] = json!(grid.summary.elapsed.as_secs_f64());
            object["rays"] = json!(grid.summary.rays);
            object["ended"] = json!(grid.summary.ended.name());
            object["nonFinite"] = json!(grid.summary.non_finite);
            object["notes"] = json!(grid.summary.notes);
            object
        })
        .collect();
    let exterior = result.exterior.map(|(value, error)| json!({"illuminance": value, "standardError": error}));
    let object = json!({
        "version": env!("CARGO_PKG_VERSION"),
        "scene": args.scene.display().to_string(),
        "method": format!("{:?}", args.method).to_lowercase(),
        "luminousEfficacy": etendue::photometry::LUMENS_PER_WATT,
        "targetError": result.target,
        "exterior": exterior,
        "grids": grids,
    });
    serde_json::to_string_pretty(&object).unwrap_or_default() + "\n"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_the_digits_that_count() {
        assert_eq!([value(111.1111), value(0.012345), value(12345.6), value(0.0)], ["111.1", "0.01235", "12346", "0"]);
        assert_eq!([trimmed(30.0), trimmed(0.5), trimmed(-0.0), trimmed(-1.0)], ["30", "0.5", "0", "-1"]);
        assert_eq!([value(1.23456e9), digits(0.0456), digits(f64::NAN)], ["1.235e9", "0.046", "?"]);
    }

    #[test]
    fn names_are_quoted_where_they_must_be() {
        assert_eq!(quoted("desk"), "desk");
        assert_eq!(quoted("a \"b\", c"), "\"a \"\"b\"\", c\"");
    }
}
