//! `report.html`: one file that contains all data, scripts, styles and pictures.

use std::collections::BTreeMap;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde::Serialize;

use super::markdown::label;
use super::results::Results;
use crate::Failure;

const TEMPLATE: &str = include_str!("report.html");
const STYLE: &str = include_str!("report.css");
/// The scripts in the order in which the page needs them.
const SCRIPTS: [&str; 4] =
    [include_str!("page.js"), include_str!("plot.js"), include_str!("viewer.js"), include_str!("report.js")];

/// Data that the page's script reads.
#[derive(Serialize)]
struct Data<'a> {
    results: &'a Results,
    plots: Vec<Plot<'a>>,
    /// Data URLs of the pictures, by their names in `results`.
    pictures: BTreeMap<String, String>,
}

/// A group on a scene.
#[derive(Serialize)]
struct Plot<'a> {
    group: &'a str,
    title: &'a str,
    description: &'a str,
    scene: &'a str,
    /// Index in `results.series`, and the curve's label here.
    series: Vec<(usize, String)>,
}

/// The page. Its pictures have numbers, so that the page does not show names of files.
pub fn page(mut results: Results) -> Result<String, Failure> {
    let mut pictures = BTreeMap::new();
    let contents = std::mem::take(&mut results.contents);
    for (number, path) in results.pictures_mut().enumerate() {
        let bytes = contents.get(path.as_str());
        let bytes = bytes.ok_or_else(|| Failure::running(format!("{path}: the picture was not read")))?;
        *path = number.to_string();
        pictures.insert(path.clone(), format!("data:image/png;base64,{}", STANDARD.encode(bytes.as_slice())));
    }
    let data = Data { plots: plots(&results), results: &results, pictures };
    let json = serde_json::to_string(&data).map_err(Failure::running)?;
    let scripts = SCRIPTS.join("\n");
    let mut page = String::with_capacity(TEMPLATE.len() + STYLE.len() + scripts.len() + json.len());
    let mut rest = TEMPLATE;
    // Each placeholder is replaced once, in this order: inserted text is never searched again.
    for (mark, text) in [("{{style}}", STYLE), ("{{data}}", &quiet(&json)), ("{{script}}", &scripts)] {
        let Some((before, after)) = rest.split_once(mark) else {
            return Err(Failure::running(format!("the template of the report has no {mark}")));
        };
        page += before;
        page += text;
        rest = after;
    }
    Ok(page + rest)
}

/// JSON that cannot end the HTML element that contains it, or begin another one: in JSON these letters occur in strings
/// only.
fn quiet(json: &str) -> String {
    json.replace('<', "\\u003c").replace('>', "\\u003e").replace('&', "\\u0026")
}

fn plots(results: &Results) -> Vec<Plot<'_>> {
    let number = |one| results.series.iter().position(|other| std::ptr::eq(other, one)).unwrap_or(0);
    let plots = results.plots().into_iter().map(|(group, scene)| {
        let neighbours: Vec<_> = results.series_of(&group.name, scene).collect();
        let series = neighbours.iter().map(|one| (number(*one), label(one, &neighbours))).collect();
        Plot { group: &group.name, title: &group.title, description: &group.description, scene, series }
    });
    plots.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_name_can_leave_the_script_it_stands_in() {
        let title = "</script><script>alert(1)</script><!-- {{script}}".to_owned();
        let results = Results { title: title.clone(), ..Results::default() };
        let page = page(results).unwrap();
        assert!(!page.contains("alert(1)</script>"), "the title ends its element");
        let (_, data) = page.split_once("application/json\">").unwrap();
        let (data, _) = data.split_once("</script>").unwrap();
        let data: serde_json::Value = serde_json::from_str(data).unwrap();
        assert_eq!(data["results"]["title"], title.as_str());
    }
}
