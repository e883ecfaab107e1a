//! Reads files of grids: the points at which light is measured (`docs/photometry.md`).

use std::collections::HashSet;
use std::path::Path;

use serde::Deserialize;
use serde_json::value::RawValue;

use super::file::read_text;
use super::json::{self, Whole, join};
use super::read::located;
use super::{GridDesc, GridPoints, MAX_GRID_POINTS, PlaneGridDesc, validate};
use crate::math::DVec3;
use crate::{Error, Result};

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Top<'a> {
    #[serde(rename = "description")]
    _description: Option<String>,
    #[serde(borrow)]
    grids: &'a RawValue,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Plane {
    #[serde(rename = "type")]
    _type: String,
    name: String,
    origin: [f64; 3],
    u: [f64; 3],
    v: [f64; 3],
    counts: [Whole; 2],
    normal: Option<[f64; 3]>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Points {
    #[serde(rename = "type")]
    _type: String,
    name: String,
    points: Vec<[f64; 3]>,
    normals: Vec<[f64; 3]>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Views {
    #[serde(rename = "type")]
    _type: String,
    name: String,
    points: Vec<[f64; 3]>,
    directions: Vec<[f64; 3]>,
}

/// Reads a file of grids.
///
/// # Errors
/// [`crate::ErrorKind::Io`] if the file cannot be read, otherwise those of [`parse_grids`]; with file, line and JSON path.
pub fn load_grids(file: &Path) -> Result<Vec<GridDesc>> {
    parse_grids(&read_text(file)?, Some(file))
}

/// Reads grids from a string. `file` is used in messages.
///
/// # Errors
/// [`crate::ErrorKind::InvalidScene`] for text that is no such file, for numbers that [`GridDesc::check`] refuses, for a name
/// that two grids have, and for no grid at all.
pub fn parse_grids(json: &str, file: Option<&Path>) -> Result<Vec<GridDesc>> {
    let json = json.strip_prefix('\u{feff}').unwrap_or(json);
    read(json).map_err(|error| located(error, json, file))
}

fn read(json: &str) -> Result<Vec<GridDesc>> {
    let top: Top<'_> = json::object(json::document(json)?, "")?;
    let (mut grids, mut names) = (Vec::new(), HashSet::new());
    json::each(Some(top.grids), "grids", |path, raw| {
        let grid = grid(raw, path)?;
        grid.check(path)?;
        if !names.insert(grid.name.clone()) {
            let message = format!("'{}' is the name of another grid", json::elided(&grid.name));
            return Err(Error::invalid(join(path, "name"), message));
        }
        grids.push(grid);
        Ok(())
    })?;
    if grids.is_empty() {
        return Err(Error::invalid("grids", "is empty, expected one grid or more"));
    }
    Ok(grids)
}

fn grid(raw: &RawValue, path: &str) -> Result<GridDesc> {
    let vectors = |values: Vec<[f64; 3]>| values.into_iter().map(DVec3::from_array).collect();
    match json::tag(raw, path, "type", &["plane", "points", "luminance"])?.as_str() {
        "plane" => {
            let Plane { name, origin, u, v, counts, normal, .. } = json::object(raw, path)?;
            let count = |axis: usize| {
                validate::whole(&format!("{}[{axis}]", join(path, "counts")), counts[axis], 1, MAX_GRID_POINTS.into())
            };
            let counts = [count(0)?, count(1)?];
            let [origin, u, v] = [origin, u, v].map(DVec3::from_array);
            let normal = normal.map(DVec3::from_array);
            Ok(GridDesc { name, points: GridPoints::Plane(PlaneGridDesc { origin, u, v, counts, normal }) })
        }
        "points" => {
            let Points { name, points, normals, .. } = json::object(raw, path)?;
            Ok(GridDesc { name, points: GridPoints::Points { points: vectors(points), normals: vectors(normals) } })
        }
        _ => {
            let Views { name, points, directions, .. } = json::object(raw, path)?;
            let points = GridPoints::Views { points: vectors(points), directions: vectors(directions) };
            Ok(GridDesc { name, points })
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOOD: &str = r#"{"description": "of a test", "grids": [
        {"name": "desk", "type": "plane", "origin": [0, 0.8, 0], "u": [0, 0, 2], "v": [3, 0, 0], "counts": [4, 6.0]},
        {"name": "eyes", "type": "points", "points": [[1, 2, 3]], "normals": [[0, 0, 1]]},
        {"name": "screen", "type": "luminance", "points": [[1, 2, 3], [2, 2, 3]], "directions": [[0, 0, -1]]}
    ]}"#;

    #[test]
    fn each_kind_is_read() {
        let grids = parse_grids(GOOD, None).unwrap();
        let counts: Vec<usize> = grids.iter().map(|grid| grid.places().len()).collect();
        assert_eq!(counts, [24, 1, 2]);
        assert_eq!(grids.iter().map(GridDesc::is_luminance).collect::<Vec<_>>(), [false, false, true]);
    }

    #[test]
    fn what_is_wrong_is_named_with_its_place_and_value() {
        for (from, to, path, line, words) in [
            ("[0, 0, 2]", "[0, 0, 0]", "grids[0].u", 2, "no direction"),
            ("[3, 0, 0]", "[0, 0, 7]", "grids[0].v", 2, "is parallel to `u`"),
            ("[3, 0, 0]", "[1e-9, 1e-9, 7]", "grids[0].v", 2, "is parallel to `u`"),
            ("[4, 6.0]", "[0, 6]", "grids[0].counts[0]", 2, "0 is out of range"),
            ("[4, 6.0]", "[4, -6]", "grids[0].counts[1]", 2, "-6"),
            ("[4, 6.0]", "[4000, 4000]", "grids[0].counts", 2, "16000000 points are too many"),
            ("[4, 6.0]", "[4]", "grids[0].counts", 2, "length 1"),
            ("[0, 0.8, 0]", "[0, 1e39, 0]", "grids[0].origin[1]", 2, "beyond single precision"),
            ("\"desk\"", "\"\"", "grids[0].name", 2, "is no name"),
            ("\"eyes\"", "\"desk\"", "grids[1].name", 3, "'desk' is the name of another grid"),
            ("\"plane\"", "\"plain\"", "grids[0].type", 2, "did you mean 'plane'?"),
            ("\"counts\"", "\"count\"", "grids[0].count", 2, "unknown key"),
            ("[[1, 2, 3]], \"normals\"", "[], \"normals\"", "grids[1].points", 3, "is empty"),
            ("[[0, 0, 1]]", "[]", "grids[1].normals", 3, "0 for 1 points"),
            ("[[0, 0, -1]]", "[[0, 0, -1], [0, 0, 0]]", "grids[2].directions[1]", 4, "no direction"),
            ("\"grids\"", "\"grid\"", "grid", 1, "unknown key"),
        ] {
            let text = GOOD.replacen(from, to, 1);
            assert_ne!(text, GOOD, "{from}");
            let error = parse_grids(&text, Some("grids.json".as_ref())).unwrap_err();
            let location = error.location();
            assert_eq!((location.json_path.as_str(), location.line), (path, line), "{to}: {error}");
            assert!(error.to_string().contains(words) && error.to_string().contains("grids.json"), "{to}: {error}");
        }
        for (text, words) in
            [("", "the text ends inside"), ("[]", "expected an object"), (r#"{"grids": []}"#, "is empty")]
        {
            assert!(parse_grids(text, None).unwrap_err().to_string().contains(words), "{text}");
        }
    }
}
