//! The documents and the header say of integrators what the table of integrators says. `ETENDUE_WRITE=1 cargo test --test
//! integrators` writes the tables of the documents anew.

use std::path::Path;
use std::{env, fs};

use etendue::desc::{Bias, IntegratorDesc, LobeUse, MapRenewal, PhotonMethod, Preparation, SampleOrder};

fn read(file: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(file);
    fs::read_to_string(path).unwrap_or_else(|error| panic!("{file}: {error}"))
}

/// A table of a document: a heading, and a row for each integrator.
fn table(heading: &[&str], row: impl Fn(IntegratorDesc) -> Vec<String>) -> String {
    let mut lines = vec![format!("| {} |", heading.join(" | ")), format!("|{}", "---|".repeat(heading.len()))];
    lines.extend(IntegratorDesc::ALL.map(|integrator| format!("| {} |", row(integrator).join(" | "))));
    lines.join("\n") + "\n"
}

/// The table stands in the document between two comments with its name.
fn check(file: &str, name: &str, table: &str) {
    let text = read(file);
    let mark = format!("<!-- {name} -->\n");
    let start = text.find(&mark).unwrap_or_else(|| panic!("{file} has no table `{name}`")) + mark.len();
    let length =
        text[start..].find(&format!("<!-- end {name} -->")).unwrap_or_else(|| panic!("{file}: {name} has no end"));
    let end = start + length;
    if env::var_os("ETENDUE_WRITE").is_some() {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(file);
        fs::write(path, format!("{}{table}{}", &text[..start], &text[end..])).expect("the document can be written");
        return;
    }
    assert_eq!(&text[start..end], table, "{file}: write the table `{name}` anew with ETENDUE_WRITE=1");
}

fn bias(bias: Bias) -> String {
    match bias {
        Bias::Unbiased => "unbiased".to_owned(),
        Bias::Consistent(what) => format!("consistent ({what})"),
        Bias::Biased(what) => format!("biased ({what})"),
        Bias::OfChoice => "that of its choice".to_owned(),
    }
}

fn order(order: SampleOrder) -> &'static str {
    match order {
        SampleOrder::InWaves => "in waves",
        SampleOrder::OneByOne => "one by one",
        SampleOrder::WithPixelMemory => "one by one, with pixel memory",
        SampleOrder::OfChoice => "as its choice",
    }
}

fn preparation(preparation: Preparation) -> String {
    let (method, renewal) = match preparation {
        Preparation::Nothing => return "nothing".to_owned(),
        Preparation::RadiositySolution => return "a radiosity solution".to_owned(),
        Preparation::Choice => return "a look at the scene".to_owned(),
        Preparation::PhotonMaps(method, renewal) => (method, renewal),
    };
    let maps = match method {
        PhotonMethod::Direct => "a map of direct light, a caustic map",
        PhotonMethod::Caustic => "a caustic map",
        PhotonMethod::FinalGather => "a global and a caustic map",
        PhotonMethod::IrradianceCache => "a caustic map, records of irradiance",
        PhotonMethod::CommonRadius | PhotonMethod::PixelRadii => "a map of indirect light, a caustic map",
    };
    let when = match renewal {
        MapRenewal::Once => "once",
        MapRenewal::EachPass => "for every pass",
        MapRenewal::EachPassByDefault => "for every pass unless `photonsProgressive` is false",
    };
    format!("{maps}, {when}")
}

fn lobe(lobe: LobeUse) -> &'static str {
    match lobe {
        LobeUse::Followed => "followed",
        LobeUse::DirectLight => "direct light",
        LobeUse::Gathered => "gathered",
        LobeUse::StoredAndGathered => "stored and gathered",
        LobeUse::Ignored => "ignored",
        LobeUse::Refused => "refused",
    }
}

#[test]
fn documents_say_what_the_table_of_integrators_says() {
    let name = |integrator: IntegratorDesc| format!("`{}`", integrator.name());
    let names = table(&["name", "what it computes"], |integrator| {
        vec![name(integrator), integrator.info().description.to_owned()]
    });
    check("docs/scene-format.md", "integrators", &names);
    let heading = [
        "integrator",
        "bias",
        "samples",
        "made before samples",
        "`maxDepth`",
        "light from infinity",
        "uneven points",
        "absorbing media",
        "motion",
        "wavelengths",
    ];
    let properties = table(&heading, |integrator| {
        let info = integrator.info();
        let depth = if info.cut_by_max_depth { "cuts paths" } else { "has no effect" };
        let infinity = if info.takes_infinite_emitters { "taken" } else { "refused" };
        let points = if info.takes_directed_points { "taken" } else { "refused" };
        let (order, made) = (order(info.order).to_owned(), preparation(info.preparation));
        let motion = if info.shows_motion() { "shown" } else { "of the camera alone" };
        let media = if info.takes_absorption { "taken" } else { "refused" };
        let wavelengths = match [true, false].map(|progressive| info.renders_wavelengths(progressive)) {
            [true, true] => "carried",
            [true, false] => "carried, unless `photonsProgressive` is false",
            [false, _] => "refused",
        };
        let rest = [depth, infinity, points, media, motion, wavelengths].map(str::to_owned);
        [name(integrator), bias(info.bias), order, made].into_iter().chain(rest).collect()
    });
    check("docs/integrators.md", "properties", &properties);
    let lobes = table(&["integrator", "diffuse", "glossy", "specular"], |integrator| {
        let uses = integrator.info().lobes.map(|lobes| [lobes.diffuse, lobes.glossy, lobes.specular].map(lobe));
        std::iter::once(name(integrator)).chain(uses.unwrap_or(["as its choice"; 3]).map(str::to_owned)).collect()
    });
    check("docs/integrators.md", "lobes", &lobes);
    let photon_maps = read("docs/photon-maps.md");
    for integrator in IntegratorDesc::ALL {
        let reads_maps = matches!(integrator.info().preparation, Preparation::PhotonMaps(..));
        assert!(!reads_maps || photon_maps.contains(&format!("\n| `{}` |", integrator.name())), "{integrator:?}");
    }
}

#[test]
fn the_header_has_every_integrator_with_its_value_and_description() {
    let (header, layout) = (read("include/etendue.h"), read("tests/capi/layout.c"));
    let (_, rest) = header.split_once("\nenum etd_integrator").expect("the enumeration");
    let (body, _) = rest.split_once('}').expect("its end");
    for integrator in IntegratorDesc::ALL {
        let info = integrator.info();
        let name = format!("ETD_INTEGRATOR_{}", info.name.to_uppercase());
        let lines = format!("     * {}\n     */\n    {name} = {},\n", info.description, info.c_value);
        assert!(body.contains(&lines), "etd_integrator in src/capi/types/render.rs: expected\n{lines}in{body}");
        assert!(layout.contains(&format!("VALUE({name});")), "{name} is not in tests/capi/layout.c");
    }
    assert_eq!(body.matches("ETD_INTEGRATOR_").count(), IntegratorDesc::ALL.len(), "{body}");
}
