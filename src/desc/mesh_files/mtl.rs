//! Reads material libraries of Wavefront OBJ files (.mtl), and makes descriptions of their materials.
//!
//! What a key becomes is in the table of `docs/materials.md`. Keys without a meaning here, and numbers out of range, are warned of once for each file and key; a number out of range becomes the nearest one that is in range.

use std::collections::{HashMap, HashSet};
use std::io::Read as _;
use std::path::{Path, PathBuf};

use super::mtl_maps::{Map, Slot};
use super::{Place, is_number};
use crate::desc::file::open;
use crate::desc::json::elided;
use crate::desc::warnings::warn;
use crate::desc::{BsdfDesc, ConductorDesc, MaterialDesc, MicrofacetsDesc, PrincipledDesc};
use crate::spectrum::Rgb;
use crate::{Error, Result};

/// Size of the largest library that is read, 64 MiB.
const SIZE_LIMIT: u64 = 64 << 20;
/// Most materials in one library.
const MATERIAL_LIMIT: usize = 1 << 16;
/// Most keys of one library that are warned of.
const KEY_LIMIT: usize = 100;

/// Albedo of a material that says nothing of its colour, as that of a principled material.
const GREY: [f64; 3] = [0.8; 3];
/// Roughness of a material that says nothing of its highlights, as that of a principled material.
const ROUGHNESS: f32 = 0.3;
/// Index of refraction of a material that does not say it.
const INDEX: f64 = 1.5;

/// The values of a material as its library has them. Colours and shares are in [0, 1].
#[derive(Clone, Debug, Default)]
pub(super) struct Entry {
    kd: Option<[f64; 3]>,
    ks: Option<[f64; 3]>,
    ke: Option<[f64; 3]>,
    tf: Option<[f64; 3]>,
    ns: Option<f64>,
    ni: Option<f64>,
    d: Option<f64>,
    tr: Option<f64>,
    illum: Option<u8>,
    pr: Option<f64>,
    pm: Option<f64>,
    ps: Option<f64>,
    pc: Option<f64>,
    pcr: Option<f64>,
    aniso: Option<f64>,
    anisor: Option<f64>,
    maps: Vec<Map>,
}

/// The materials of the libraries of one mesh file, by name.
#[derive(Debug, Default)]
pub(super) struct Library {
    entries: HashMap<String, Entry>,
    /// The files that were read.
    pub files: Vec<PathBuf>,
}

/// Where messages about a library come from.
pub(super) struct Source<'a> {
    pub(super) file: &'a Path,
    json_path: &'a str,
    warnings: &'a mut Vec<String>,
    /// What has been warned of.
    warned: HashSet<String>,
}

impl Source<'_> {
    fn fail(&self, line: usize, message: String) -> Error {
        Error::invalid(self.json_path, message).in_file(Some(self.file), line)
    }

    /// Warns of a key for the first time that it occurs.
    pub(super) fn warn(&mut self, line: usize, key: &str, message: &str) {
        if self.warned.len() < KEY_LIMIT && self.warned.insert(format!("{key} {message}")) {
            let place = Place { path: self.file, json_path: self.json_path };
            place.warn(self.warnings, line, &format!("{key} {message}"));
        }
    }
}

impl Library {
    /// Reads a library and adds its materials. The first of several materials of one name is used.
    pub fn read(&mut self, file: &Path, json_path: &str, warnings: &mut Vec<String>) -> Result<()> {
        let mut bytes = Vec::new();
        // The limit is one byte more than allowed, so that a file that grows during reading is noticed.
        let reader = open(file, SIZE_LIMIT).map_err(|error| error.at(json_path))?;
        reader
            .take(SIZE_LIMIT + 1)
            .read_to_end(&mut bytes)
            .map_err(|error| Error::io(file, "cannot read the material library", error).at(json_path))?;
        let mut source = Source { file, json_path, warnings, warned: HashSet::new() };
        if bytes.len() as u64 > SIZE_LIMIT {
            return Err(source.fail(0, format!("the file is larger than {SIZE_LIMIT} bytes")));
        }
        self.parse(&bytes, &mut source)?;
        self.files.push(file.to_owned());
        Ok(())
    }

    fn parse(&mut self, bytes: &[u8], source: &mut Source<'_>) -> Result<()> {
        let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
        let mut current: Option<(String, Entry)> = None;
        for (line, text) in (1..).zip(bytes.split(|byte| *byte == b'\n')) {
            let text = text.trim_ascii();
            let (keyword, rest) = keyword(text);
            if keyword.is_empty() || keyword.starts_with(b"#") {
                continue;
            }
            let key = String::from_utf8_lossy(keyword);
            if key.eq_ignore_ascii_case("newmtl") {
                self.put(current.take());
                let name = String::from_utf8_lossy(rest).into_owned();
                if self.entries.len() >= MATERIAL_LIMIT {
                    return Err(source.fail(line, format!("the file has more than {MATERIAL_LIMIT} materials")));
                }
                if self.entries.contains_key(&name) {
                    let message = format!("'{}' is given twice; the first is used", elided(&name));
                    source.warn(line, "newmtl", &message);
                }
                current = Some((name, Entry::default()));
                continue;
            }
            let Some((_, entry)) = &mut current else {
                let message = format!("'{}' before the first newmtl; is it a material library?", elided(&key));
                return Err(source.fail(line, message));
            };
            entry.set(&key, rest, line, source)?;
        }
        self.put(current);
        Ok(())
    }

    fn put(&mut self, material: Option<(String, Entry)>) {
        if let Some((name, entry)) = material {
            self.entries.entry(name).or_insert(entry);
        }
    }

    pub fn find(&self, name: &str) -> Option<&Entry> {
        self.entries.get(name)
    }

    /// The names of all materials.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.entries.keys().map(String::as_str)
    }
}

/// Splits a line at its first blank.
pub(super) fn keyword(line: &[u8]) -> (&[u8], &[u8]) {
    let end = line.iter().position(u8::is_ascii_whitespace).unwrap_or(line.len());
    (&line[..end], line[end..].trim_ascii())
}

impl Entry {
    /// Sets the value of a key, which is one line.
    fn set(&mut self, key: &str, rest: &[u8], line: usize, source: &mut Source<'_>) -> Result<()> {
        let rest = rest.split(|byte| *byte == b'#').next().unwrap_or_default();
        let lower = key.to_ascii_lowercase();
        if let Some(slot) = Slot::by_key(&lower) {
            if let Some(map) = Map::read(slot, key, rest, line, source) {
                self.maps.retain(|other| other.slot != slot);
                self.maps.push(map);
            }
            return Ok(());
        }
        let words: Vec<&[u8]> = rest.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty()).take(4).collect();
        let mut reader = Values { key, words: &words, line, source };
        match lower.as_str() {
            "kd" => self.kd = reader.color(1.0)?.or(self.kd),
            "ks" => self.ks = reader.color(1.0)?.or(self.ks),
            "tf" => self.tf = reader.color(1.0)?.or(self.tf),
            "ke" => self.ke = reader.color(f64::from(f32::MAX))?.or(self.ke),
            "ns" => self.ns = Some(reader.number(0.0, 1e9)?),
            "ni" => {
                let index = reader.number(0.0, 100.0)?;
                if index == 0.0 {
                    reader.warn("of 0 is no index of refraction; it is left out");
                } else {
                    self.ni = Some(index);
                }
            }
            "d" if words.first() == Some(&b"-halo".as_slice()) => {
                reader.warn("-halo has no meaning here; it is left out");
            }
            "d" => self.d = Some(reader.number(0.0, 1.0)?),
            "tr" => self.tr = Some(reader.number(0.0, 1.0)?),
            "illum" => {
                let model = reader.number(0.0, 10.0)?;
                if model.fract() != 0.0 {
                    return Err(reader.fail(&format!("{model}, expected a whole number from 0 to 10")));
                }
                self.illum = Some(model as u8);
            }
            "pr" => self.pr = Some(reader.number(0.0, 1.0)?),
            "pm" => self.pm = Some(reader.number(0.0, 1.0)?),
            "ps" => self.ps = Some(reader.number(0.0, 1.0)?),
            "pc" => self.pc = Some(reader.number(0.0, 1.0)?),
            "pcr" => self.pcr = Some(reader.number(0.0, 1.0)?),
            "aniso" => self.aniso = Some(reader.number(0.0, 0.99)?),
            "anisor" => self.anisor = Some(reader.number(-1.0, 1.0)?),
            _ => reader.warn("has no meaning here; it is left out"),
        }
        Ok(())
    }

    /// Whether the surface is one between two media that refracts light (Wavefront's models 6 and 7).
    fn refracts(&self) -> bool {
        matches!(self.illum, Some(6 | 7))
    }

    /// Whether the surface is a sheet of glass, which light passes straight on (models 4 and 9). Where such a material also has
    /// an opacity, the opacity says what passes.
    fn is_sheet(&self) -> bool {
        matches!(self.illum, Some(4 | 9)) && self.opacity() >= 1.0
    }

    fn opacity(&self) -> f64 {
        self.d.or(self.tr.map(|tr| 1.0 - tr)).unwrap_or(1.0)
    }

    /// The perceptual roughness of highlights: the width alpha of facets that a Phong lobe of exponent Ns has is
    /// sqrt(2 / (Ns + 2)), and roughness is its square root.
    fn roughness(&self) -> Option<f32> {
        self.ns.map(|ns| (2.0 / (ns + 2.0)).powf(0.25) as f32)
    }

    /// The index of refraction. Exporters write 1 where they know none.
    fn index(&self) -> f32 {
        self.ni.filter(|ni| *ni != 1.0).unwrap_or(INDEX) as f32
    }

    /// The index of an interface under which there is a body, so that it is larger than that of the air.
    fn coat_index(&self) -> f32 {
        self.ni.filter(|ni| *ni > 1.0).unwrap_or(INDEX) as f32
    }

    fn is_physical(&self) -> bool {
        [self.pr, self.pm, self.ps, self.pc, self.pcr, self.aniso, self.anisor].iter().any(Option::is_some)
            || self.maps.iter().any(|map| map.slot.is_physical())
    }

    /// The images that vary the material.
    pub fn maps(&self) -> &[Map] {
        &self.maps
    }

    /// What takes the place of a value that the library does not have: 1 where a map varies it, else the default.
    fn missing<T>(&self, slot: Slot, one: T, default: T) -> T {
        if self.maps.iter().any(|map| map.slot == slot) { one } else { default }
    }

    fn physical(&self) -> BsdfDesc {
        let default = PrincipledDesc::default();
        let share = |value: Option<f64>| value.unwrap_or(0.0) as f32;
        let mapped = |value: Option<f64>, slot: Slot| value.unwrap_or(self.missing(slot, 1.0, 0.0)) as f32;
        let roughness = self.pr.map(|pr| pr as f32).or(self.roughness());
        let is_clear = self.refracts() || self.is_sheet();
        BsdfDesc::Principled(PrincipledDesc {
            base_color: rgb(self.kd.unwrap_or(self.missing(Slot::Kd, [1.0; 3], GREY))),
            base_metalness: mapped(self.pm, Slot::Pm),
            specular_roughness: match self.pr {
                None if self.missing(Slot::Pr, true, false) => 1.0,
                _ => roughness.unwrap_or(ROUGHNESS),
            },
            specular_roughness_anisotropy: share(self.aniso),
            specular_rotation: (share(self.anisor) * 360.0).to_radians(),
            specular_ior: self.coat_index(),
            transmission_weight: if is_clear { 1.0 } else { 0.0 },
            transmission_color: rgb(self.tf.filter(|_| is_clear).unwrap_or([1.0; 3])),
            coat_weight: mapped(self.pc, Slot::Pc),
            coat_roughness: mapped(self.pcr, Slot::Pcr),
            fuzz_weight: mapped(self.ps, Slot::Ps),
            ..default
        })
    }

    /// The scattering model, or the two models of a sum and the share of the second.
    fn model(&self) -> Model {
        if self.is_physical() {
            return Model::One(self.physical());
        }
        let filter = self.tf.unwrap_or([1.0; 3]);
        if self.refracts() {
            let ior = self.index();
            return Model::One(if filter == [1.0; 3] {
                BsdfDesc::Dielectric { ior, exterior_ior: 1.0 }
            } else {
                BsdfDesc::Principled(PrincipledDesc {
                    specular_roughness: 0.0,
                    specular_ior: ior,
                    transmission_weight: 1.0,
                    transmission_color: rgb(filter),
                    ..PrincipledDesc::default()
                })
            });
        }
        if self.is_sheet() {
            let (ior, transmittance) = (self.index(), rgb(filter));
            return Model::One(BsdfDesc::ThinDielectric {
                ior,
                exterior_ior: 1.0,
                transmittance,
                microfacets: MicrofacetsDesc::default(),
            });
        }
        let ks = self.ks.unwrap_or(self.missing(Slot::Ks, [1.0; 3], [0.0; 3]));
        let no_kd = if self.ks.is_some() { [0.0; 3] } else { GREY };
        let kd = self.kd.unwrap_or(self.missing(Slot::Kd, [1.0; 3], no_kd));
        let [most_kd, most_ks] = [kd, ks].map(|color| color.into_iter().fold(0.0, f64::max));
        if most_ks == 0.0 || matches!(self.illum, Some(0 | 1 | 10)) {
            return Model::One(BsdfDesc::Lambert { albedo: rgb(kd) });
        }
        let is_mirror = matches!(self.illum, Some(3 | 8));
        let is_sharp = is_mirror || self.illum == Some(5);
        let roughness = self.roughness().unwrap_or(if is_sharp { 0.0 } else { ROUGHNESS });
        let metal = |scale: f64| BsdfDesc::Conductor {
            conductor: ConductorDesc::Reflectance {
                normal: rgb(ks.map(|channel| (channel * scale).min(1.0))),
                edge: Rgb::ONE,
            },
            microfacets: MicrofacetsDesc { roughness, ..MicrofacetsDesc::default() },
        };
        if most_kd == 0.0 {
            return Model::One(metal(1.0));
        }
        if is_mirror {
            // The sum Kd + Ks, scaled down where it would reflect more light than there is.
            let (sum, weight) = (most_kd + most_ks, most_ks / (most_kd + most_ks));
            let fit = 1.0 / sum.max(1.0);
            let albedo = rgb(kd.map(|channel| (channel * fit / (1.0 - weight)).min(1.0)));
            return Model::Sum([BsdfDesc::Lambert { albedo }, metal(fit / weight)], weight as f32);
        }
        Model::One(BsdfDesc::Principled(PrincipledDesc {
            base_color: rgb(kd),
            specular_weight: if self.illum == Some(5) { 1.0 } else { most_ks as f32 },
            specular_roughness: roughness,
            specular_ior: self.coat_index(),
            ..PrincipledDesc::default()
        }))
    }

    /// Describes the material, after the materials that it consists of. `first` is the number that the first of them will have. When
    /// its maps are known, [`settle_opacity`] has to follow.
    pub fn describe(&self, name: &str, path: &str, first: usize) -> Vec<MaterialDesc> {
        let ke = self.ke.or(self.missing(Slot::Ke, Some([1.0; 3]), None));
        let emission = ke.filter(|ke| *ke != [0.0; 3]).map(rgb);
        let is_clear = self.refracts() || self.is_sheet();
        let opacity = if is_clear { 1.0 } else { self.opacity() as f32 };
        let part = |bsdf| MaterialDesc { path: path.to_owned(), bsdf, ..MaterialDesc::default() };
        let whole = |bsdf| MaterialDesc { name: name.to_owned(), opacity, emission, ..part(bsdf) };
        match self.model() {
            Model::One(bsdf) => vec![whole(bsdf)],
            Model::Sum([one, other], weight) => {
                let mix = BsdfDesc::Mix { materials: [first, first + 1], weight };
                vec![part(one), part(other), whole(mix)]
            }
        }
    }
}

/// Makes a material that emits opaque, and warns of what cannot be seen.
pub(super) fn settle_opacity(material: &mut MaterialDesc, warnings: &mut Vec<String>) {
    let at = if material.path.is_empty() { String::new() } else { format!("{}: ", material.path) };
    let name = elided(&material.name);
    if material.emission.is_some() && material.opacity < 1.0 {
        warn(warnings, format!("{at}the material '{name}' emits light (Ke); it is opaque"));
        material.opacity = 1.0;
    }
    if material.opacity == 0.0 {
        warn(warnings, format!("{at}the material '{name}' is invisible, its opacity is 0"));
    }
}

enum Model {
    One(BsdfDesc),
    Sum([BsdfDesc; 2], f32),
}

fn rgb([r, g, b]: [f64; 3]) -> Rgb {
    Rgb::new(r as f32, g as f32, b as f32)
}

/// The values of one line.
struct Values<'a, 'b, 'c> {
    key: &'a str,
    words: &'a [&'a [u8]],
    line: usize,
    source: &'b mut Source<'c>,
}

impl Values<'_, '_, '_> {
    fn fail(&self, message: &str) -> Error {
        self.source.fail(self.line, format!("{}: {message}", elided(self.key)))
    }

    fn warn(&mut self, message: &str) {
        let key = elided(self.key);
        self.source.warn(self.line, &key, message);
    }

    /// A number, moved into a range.
    fn value(&mut self, word: &[u8], low: f64, high: f64) -> Result<f64> {
        let text = String::from_utf8_lossy(word);
        if !is_number(&text) {
            return Err(self.fail(&format!("'{}' is not a finite number", elided(&text))));
        }
        let value: f64 = text.parse().unwrap_or(0.0);
        if (low..=high).contains(&value) {
            return Ok(value);
        }
        let most = if high > 1e9 { " or more".to_owned() } else { format!(" to {high}") };
        self.warn(&format!("is out of range, expected {low}{most}; the nearest number in range is used"));
        Ok(value.clamp(low, high))
    }

    fn number(&mut self, low: f64, high: f64) -> Result<f64> {
        match self.words.first() {
            None => Err(self.fail("a number is missing")),
            Some(word) => self.value(word, low, high),
        }
    }

    /// A colour: three numbers, or one for all channels. `None` for one that is not given by numbers.
    fn color(&mut self, most: f64) -> Result<Option<[f64; 3]>> {
        match *self.words {
            [b"spectral" | b"xyz", ..] => {
                self.warn("of a spectrum or in CIE XYZ has no meaning here; it is left out");
                Ok(None)
            }
            [one] => {
                let grey = self.value(one, 0.0, most)?;
                Ok(Some([grey; 3]))
            }
            [r, g, b, ..] => {
                Ok(Some([self.value(r, 0.0, most)?, self.value(g, 0.0, most)?, self.value(b, 0.0, most)?]))
            }
            _ => Err(self.fail(&format!("a colour has three numbers, found {}", self.words.len()))),
        }
    }
}
