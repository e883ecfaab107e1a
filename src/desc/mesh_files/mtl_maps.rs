//! Maps of material libraries (`map_Kd` and its kin): images that vary parameters of a material.
//!
//! An image that is missing or cannot be read is left out with a warning, as files often come along without theirs.

use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::mtl::{Source, keyword};
use super::{Place, is_number};
use crate::Result;
use crate::control::WorkProgress;
use crate::desc::builder::identity;
use crate::desc::json::elided;
use crate::desc::{
    BsdfDesc, ImageTextureDesc, MaterialDesc, TextureBinding, TextureChannel, TextureDesc, TextureKey, TextureMapping,
    TextureSource, texture_check,
};
use crate::texture::{
    ColorSpace, ImageSource, ReadImage, ReadingTogether, TexelImage, TextureFilter, Wrap, read_image, read_images,
};

/// Most texels of all images of a file.
const TEXEL_LIMIT: u64 = 1 << 30;

/// Height of a 1 in a map of heights, in diagonals of the box around the mesh. Libraries do not say a unit.
const HEIGHT: f64 = 0.01;

/// Largest number of an option.
const MOST_OPTION: f64 = 1e6;

/// Most files of a folder among which an image is looked for.
const MOST_ENTRIES: usize = 1 << 16;

/// What a map varies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Slot {
    Kd,
    Ks,
    Ke,
    D,
    Pr,
    Pm,
    Ps,
    Pc,
    Pcr,
    /// Heights; or normals, as many programs write them.
    Bump,
    /// Normals.
    Norm,
}

impl Slot {
    /// The map that a key in lower case names.
    pub fn by_key(key: &str) -> Option<Self> {
        Some(match key {
            "map_kd" => Self::Kd,
            "map_ks" => Self::Ks,
            "map_ke" => Self::Ke,
            "map_d" | "map_opacity" => Self::D,
            "map_pr" => Self::Pr,
            "map_pm" => Self::Pm,
            "map_ps" => Self::Ps,
            "map_pc" => Self::Pc,
            "map_pcr" => Self::Pcr,
            "bump" | "map_bump" => Self::Bump,
            "norm" | "map_norm" | "map_kn" => Self::Norm,
            _ => return None,
        })
    }

    /// Whether only the extension for physically based rendering has it.
    pub fn is_physical(self) -> bool {
        matches!(self, Self::Pr | Self::Pm | Self::Ps | Self::Pc | Self::Pcr)
    }

    /// The parameter of a model that the map varies.
    fn parameter(self, model: &BsdfDesc) -> Option<TextureKey> {
        match (self, model) {
            (Self::Kd, BsdfDesc::Lambert { .. }) => Some(TextureKey::Color),
            (Self::Kd, BsdfDesc::Principled(_)) => Some(TextureKey::BaseColor),
            (Self::Ks, BsdfDesc::Principled(_)) => Some(TextureKey::SpecularWeight),
            (Self::Ks, BsdfDesc::Conductor { .. }) => Some(TextureKey::Reflectance),
            (Self::Pr, BsdfDesc::Principled(_)) => Some(TextureKey::SpecularRoughness),
            (Self::Pm, BsdfDesc::Principled(_)) => Some(TextureKey::BaseMetalness),
            (Self::Ps, BsdfDesc::Principled(_)) => Some(TextureKey::FuzzWeight),
            (Self::Pc, BsdfDesc::Principled(_)) => Some(TextureKey::CoatWeight),
            (Self::Pcr, BsdfDesc::Principled(_)) => Some(TextureKey::CoatRoughness),
            _ => None,
        }
    }
}

/// An image, and how it is laid on the surface.
#[derive(Clone, Debug)]
pub(super) struct Map {
    pub slot: Slot,
    key: String,
    /// As the library names it.
    name: String,
    /// The library, and the line of the key.
    library: PathBuf,
    line: usize,
    scale: [f64; 2],
    offset: [f64; 2],
    is_clamped: bool,
    channel: TextureChannel,
    /// Factor on heights or slopes.
    multiplier: f64,
}

impl Map {
    /// Reads what follows the key: options, then a file name, which may hold blanks. `None`, with a warning, without a name.
    pub fn read(slot: Slot, key: &str, rest: &[u8], line: usize, source: &mut Source<'_>) -> Option<Self> {
        let mut map = Self {
            slot,
            key: key.to_owned(),
            name: String::new(),
            library: source.file.to_owned(),
            line,
            scale: [1.0; 2],
            offset: [0.0; 2],
            is_clamped: false,
            channel: TextureChannel::Default,
            multiplier: 1.0,
        };
        let rest = rest.trim_ascii();
        // Names may begin with a dash or hold one.
        if map.is_found(rest) {
            map.name = name_of(rest);
            return Some(map);
        }
        let mut rest = map.options(rest, source);
        // Some programs write options after the name.
        if !map.is_found(rest)
            && let Some(end) = first_option(rest)
        {
            let left = map.options(&rest[end..], source);
            if !left.is_empty() {
                let left = String::from_utf8_lossy(left).into_owned();
                source.warn(line, &elided(key), &format!("'{}' follows the name; it is left out", elided(&left)));
            }
            rest = rest[..end].trim_ascii_end();
        }
        map.name = name_of(rest);
        if map.name.is_empty() {
            source.warn(line, &elided(key), "names no image; it is left out");
            return None;
        }
        Some(map)
    }

    /// Reads options from the beginning of a text and returns what follows them.
    fn options<'t>(&mut self, mut rest: &'t [u8], source: &mut Source<'_>) -> &'t [u8] {
        while rest.starts_with(b"-") {
            let (option, after) = keyword(rest);
            let most = match option {
                b"-o" | b"-s" | b"-t" => 3,
                b"-mm" => 2,
                _ if takes_word(option) => 1,
                // One that nobody knows has the numbers that follow it.
                _ => 3,
            };
            let (mut words, mut left) = (Vec::new(), after);
            while words.len() < most && !left.is_empty() {
                let (word, next) = keyword(left);
                let word = String::from_utf8_lossy(word).into_owned();
                // `nan` and `1e400` are no numbers to compute with, but no names either.
                if !takes_word(option) && word.parse::<f64>().is_err() {
                    break;
                }
                words.push(word);
                left = next;
            }
            if !self.set(option, &words) {
                let option = String::from_utf8_lossy(option);
                let option = elided(&option);
                let message = format!("{option} {} has no meaning here; it is left out", elided(&words.join(" ")));
                source.warn(self.line, &elided(&self.key), &message);
            }
            rest = left;
        }
        rest
    }

    /// Whether this is the name of a file, as it stands.
    fn is_found(&self, name: &[u8]) -> bool {
        !name.is_empty() && Self { name: name_of(name), ..self.clone() }.file().is_some()
    }

    /// Sets an option; whether it has a meaning.
    fn set(&mut self, option: &[u8], words: &[String]) -> bool {
        let number = |i: usize, missing: f64| match words.get(i) {
            // Beyond these, single precision knows no texels.
            Some(word) => word.parse().ok().filter(|value: &f64| is_number(word) && value.abs() <= MOST_OPTION),
            None => Some(missing),
        };
        let word = words.first().map_or("", String::as_str);
        match option {
            // One number is for u alone.
            b"-s" | b"-o" => {
                let missing = if option == b"-s" { 1.0 } else { 0.0 };
                let (Some(u), Some(v)) = (number(0, missing), number(1, missing)) else { return false };
                *(if option == b"-s" { &mut self.scale } else { &mut self.offset }) = [u, v];
            }
            b"-clamp" => self.is_clamped = word.eq_ignore_ascii_case("on"),
            b"-bm" => match number(0, 1.0) {
                Some(multiplier) => self.multiplier = multiplier,
                None => return false,
            },
            b"-imfchan" => {
                self.channel = match word {
                    "r" => TextureChannel::Red,
                    "g" => TextureChannel::Green,
                    "b" => TextureChannel::Blue,
                    "m" => TextureChannel::Alpha,
                    "l" => TextureChannel::Default,
                    _ => return false,
                }
            }
            // They choose a filter or a size, which are our own, or name the default.
            b"-blendu" | b"-blendv" | b"-cc" | b"-texres" | b"-boost" | b"-type" => {}
            b"-mm" => return number(0, 0.0) == Some(0.0) && number(1, 1.0) == Some(1.0),
            b"-t" => return words.iter().all(|word| word.parse() == Ok(0.0)),
            _ => return false,
        }
        true
    }

    /// The file, which is looked for as it is named, with slashes for backslashes, and by its last name beside the library, since
    /// libraries often hold paths of the machine that wrote them; at last without regard to the case of letters, which that machine
    /// may not have distinguished.
    fn file(&self) -> Option<PathBuf> {
        let plain = self.name.replace('\\', "/");
        let last = plain.rsplit('/').next().unwrap_or_default();
        let folder = self.library.parent().unwrap_or(Path::new(""));
        let names = [self.name.as_str(), &plain, last];
        names.into_iter().map(|name| folder.join(name)).find(|file| file.is_file()).or_else(|| {
            let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
            let entries = std::fs::read_dir(folder).ok()?.take(MOST_ENTRIES).flatten();
            // The first in the order of names, since folders have none.
            let same =
                entries.filter(|entry| entry.file_name().to_str().is_some_and(|it| it.eq_ignore_ascii_case(last)));
            same.map(|entry| entry.path()).filter(|file| file.is_file()).min()
        })
    }

    /// Why there is no file.
    fn no_file(&self) -> String {
        let folder = self.library.parent().unwrap_or(Path::new(""));
        let is_folder = !self.name.is_empty() && folder.join(&self.name).is_dir();
        if is_folder { "is a folder, expected an image" } else { "does not exist" }.to_owned()
    }
}

/// The name of a file, which some programs put into quotation marks.
fn name_of(text: &[u8]) -> String {
    let text = text.trim_ascii();
    let plain = text.strip_prefix(b"\"").and_then(|text| text.strip_suffix(b"\"")).unwrap_or(text);
    String::from_utf8_lossy(plain).trim().to_owned()
}

/// Whether an option is followed by one word.
fn takes_word(option: &[u8]) -> bool {
    matches!(
        option,
        b"-blendu" | b"-blendv" | b"-cc" | b"-clamp" | b"-texres" | b"-imfchan" | b"-bm" | b"-boost" | b"-type"
    )
}

/// Where the first option after a name begins.
fn first_option(text: &[u8]) -> Option<usize> {
    let is_option = |start: &usize| {
        let (word, _) = keyword(&text[*start..]);
        takes_word(word) || matches!(word, b"-o" | b"-s" | b"-t" | b"-mm")
    };
    let starts = (1..text.len()).filter(|i| text[i - 1].is_ascii_whitespace() && text[*i] == b'-');
    starts.into_iter().find(is_option)
}

/// An image and the colour space that its format suggests.
type Read = (Arc<TexelImage>, ColorSpace);

/// The textures of one mesh file.
pub(super) struct Maps<'a> {
    /// Where messages come from: the mesh file.
    place: Place<'a>,
    /// Images that were read; `None` for those that cannot be.
    images: HashMap<PathBuf, Option<Read>>,
    /// Images that were decoded before a map asked for them.
    ahead: HashMap<PathBuf, ReadImage>,
    texels_left: u64,
    /// What was made, named by its number in bindings.
    pub textures: Vec<TextureDesc>,
    /// The image files that were read.
    pub files: Vec<PathBuf>,
}

/// What a material's maps are laid on.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ground {
    /// Whether the mesh has texture coordinates.
    pub has_uvs: bool,
    /// Diagonal of the box around the mesh [scene unit].
    pub diagonal: f64,
}

impl<'a> Maps<'a> {
    pub fn new(place: Place<'a>) -> Self {
        let (images, ahead) = (HashMap::new(), HashMap::new());
        Self { place, images, ahead, texels_left: TEXEL_LIMIT, textures: Vec::new(), files: Vec::new() }
    }

    /// Decodes the images of these maps, several at a time, for [`Self::bind`].
    pub fn read_ahead<'m>(&mut self, maps: impl Iterator<Item = &'m Map>, work: &WorkProgress<'_>) -> Result<()> {
        let mut known = HashSet::new();
        let mut files: Vec<_> = maps.filter_map(Map::file).map(|file| identity(&file)).collect();
        files.retain(|file| known.insert(file.clone()));
        let sources: Vec<_> = files.iter().map(|file| ImageSource::File(file.into())).collect();
        let how = ReadingTogether { most_texels: TEXEL_LIMIT, stops_at_error: false };
        let read = read_images(&sources, how, work)?;
        self.ahead = files.into_iter().zip(read).filter_map(|(file, read)| Some((file, read?.ok()?))).collect();
        Ok(())
    }

    /// Puts maps on a material, which follows the materials that it consists of.
    pub fn bind(
        &mut self,
        maps: &[Map],
        materials: &mut [MaterialDesc],
        ground: Ground,
        warnings: &mut Vec<String>,
    ) -> Result<()> {
        // Without the map of its emission a material does not emit, and has an opacity; maps of normals say more than those of heights.
        let mut maps: Vec<&Map> = maps.iter().collect();
        maps.sort_by_key(|map| match map.slot {
            Slot::Ke => 0,
            Slot::Norm => 1,
            _ => 2,
        });
        for map in maps {
            let place = Place { path: &map.library, json_path: self.place.json_path };
            let mut leave_out = |why: &str| {
                let message = format!("{} '{}' {why}; it is left out", elided(&map.key), elided(&map.name));
                place.warn(warnings, map.line, &message);
            };
            if !ground.has_uvs {
                leave_out("lies on a mesh without texture coordinates");
                if let (Slot::Ke, Some(whole)) = (map.slot, materials.last_mut()) {
                    whole.emission = None;
                }
                continue;
            }
            let Some(whole) = materials.last() else { return Ok(()) };
            let refracts = matches!(whole.bsdf, BsdfDesc::Dielectric { .. } | BsdfDesc::ThinDielectric { .. })
                || matches!(&whole.bsdf, BsdfDesc::Principled(it) if it.transmission_weight > 0.0);
            if map.slot == Slot::D && (whole.emission.is_some() || refracts) {
                leave_out("is the opacity of a material that emits or refracts light");
                continue;
            }
            if map.slot == Slot::Ke && whole.emission.is_none() {
                leave_out("varies an emission (Ke) that is 0");
                continue;
            }
            let is_surface = matches!(map.slot, Slot::D | Slot::Ke | Slot::Bump | Slot::Norm);
            let target = materials.iter().rposition(|it| is_surface || map.slot.parameter(&it.bsdf).is_some());
            let Some(target) = target else {
                leave_out("varies nothing that the material has");
                continue;
            };
            let (image, suggested_space) = match self.image(map) {
                Ok(read) => read,
                Err(why) => {
                    leave_out(&why);
                    if let (Slot::Ke, Some(whole)) = (map.slot, materials.last_mut()) {
                        // Without its map, which is dark in most places, all of the surface would shine.
                        whole.emission = None;
                    }
                    continue;
                }
            };
            let holds_normals = map.slot == Slot::Norm || map.slot == Slot::Bump && looks_like_normals(&image);
            let (key, strength) = match map.slot {
                Slot::D => (TextureKey::Opacity, 1.0),
                Slot::Ke => (TextureKey::Emission, 1.0),
                Slot::Bump | Slot::Norm if holds_normals => (TextureKey::Normal, map.multiplier),
                Slot::Bump | Slot::Norm => (TextureKey::Bump, map.multiplier * HEIGHT * ground.diagonal),
                slot => match slot.parameter(&materials[target].bsdf) {
                    Some(key) => (key, 1.0),
                    None => continue,
                },
            };
            let bound = &mut materials[target].textures;
            if bound.iter().any(|other| other.key == key || is_relief(other.key) && is_relief(key)) {
                leave_out("is a second map for the normal");
                continue;
            }
            // Images of one channel that is opaque everywhere hold the mask in their colour.
            let channel = match map.channel {
                TextureChannel::Default if map.slot == Slot::D && is_opaque(&image) => TextureChannel::Red,
                channel => channel,
            };
            let texture = self.texture(map, image, suggested_space)?;
            bound.push(TextureBinding { key, texture, channel, strength: strength as f32, cutoff: 0.0 });
        }
        Ok(())
    }

    /// The number of the texture of a map.
    fn texture(&mut self, map: &Map, image: Arc<TexelImage>, suggested_space: ColorSpace) -> Result<usize> {
        let wrap = if map.is_clamped { Wrap::Clamp } else { Wrap::Repeat };
        let file = map.file();
        let source = TextureSource::Image(ImageTextureDesc {
            image,
            file,
            color_space: None,
            suggested_space,
            wrap: [wrap; 2],
            filter: TextureFilter::default(),
        });
        let mapping = TextureMapping::Uv { set: 0, scale: map.scale, rotation: 0.0, offset: map.offset };
        if let Some(known) = self.textures.iter().position(|it| it.source == source && it.mapping == mapping) {
            return Ok(known);
        }
        let name = format!("{}:{}", self.place.path.display(), map.name);
        let path = self.place.json_path.to_owned();
        let texture = TextureDesc { name, path, source, mapping, vertex_colors: false };
        texture_check::texture(&texture)?;
        self.textures.push(texture);
        Ok(self.textures.len() - 1)
    }

    /// A diffuse material of the colours of vertices.
    pub fn colored(&mut self, material: MaterialDesc) -> MaterialDesc {
        let known = self.textures.iter().position(|it| it.source == TextureSource::White);
        let texture = known.unwrap_or_else(|| {
            let name = format!("{}:vertex colors", self.place.path.display());
            self.textures.push(TextureDesc::of_vertex_colors(name, self.place.json_path.to_owned()));
            self.textures.len() - 1
        });
        MaterialDesc { name: material.name, path: material.path, ..MaterialDesc::textured_diffuse(texture) }
    }

    /// The image of a map, or why there is none.
    fn image(&mut self, map: &Map) -> Result<Read, String> {
        let Some(file) = map.file() else { return Err(map.no_file()) };
        let identity = identity(&file);
        if let Some(known) = self.images.get(&identity) {
            return known.clone().ok_or_else(|| "is not read, as said before".to_owned());
        }
        let read = match self.ahead.remove(&identity) {
            Some(read) => Ok(read),
            None => read_image(&file),
        };
        let read = read.map_err(|error| format!("cannot be read: {}", error.message())).and_then(|(image, space)| {
            let texels = u64::from(image.width()) * u64::from(image.height());
            match self.texels_left.checked_sub(texels) {
                Some(left) => self.texels_left = left,
                None => {
                    return Err(format!("is too much: the images of the file have more than {TEXEL_LIMIT} texels"));
                }
            }
            Ok((Arc::new(image), space))
        });
        self.images.insert(identity, read.as_ref().ok().cloned());
        self.files.extend(read.is_ok().then_some(file));
        read
    }
}

fn is_relief(key: TextureKey) -> bool {
    matches!(key, TextureKey::Bump | TextureKey::Normal)
}

/// Whether the colours of an image are mostly the blue of normals that point up.
fn looks_like_normals(image: &TexelImage) -> bool {
    if image.channels() < 3 {
        return false;
    }
    let mean = mean(image);
    mean[2] > 0.7 && mean[..2].iter().all(|x| (x - 0.5).abs() < 0.1)
}

/// Whether an image has no opacity or one that is 1 everywhere.
fn is_opaque(image: &TexelImage) -> bool {
    !image.has_opacity() || mean(image)[3] >= 1.0
}

/// The mean of what is stored.
fn mean(image: &TexelImage) -> [f64; 4] {
    let mut sum = [0.0; 4];
    for y in 0..image.height() {
        for x in 0..image.width() {
            let texel = image.texel(x, y, ColorSpace::Raw);
            sum.iter_mut().zip(texel).for_each(|(sum, value)| *sum += f64::from(value));
        }
    }
    let count = f64::from(image.width()) * f64::from(image.height());
    sum.map(|sum| sum / count)
}
