//! Divides the mesh of an OBJ file by the materials that the file names (`mtllib`, `usemtl`), and describes these materials.
//!
//! Files often name a material that no library has, a library that did not come along, or no material at all. Faces without a known
//! material get a grey diffuse one, with a warning.

use std::collections::HashMap;
use std::ops::Range;
use std::path::Path;

use super::mtl::{Library, keyword, settle_opacity};
use super::mtl_maps::{Ground, Maps};
use super::watched::image_bytes;
use super::{Place, Source, obj};
use crate::control::WorkProgress;
use crate::desc::json::{did_you_mean, elided};
use crate::desc::warnings::warn;
use crate::desc::{BsdfDesc, MaterialDesc, MeshDesc, TextureDesc};
use crate::room::check_room;
use crate::spectrum::Rgb;
use crate::{Error, ErrorKind, Result};

/// Most material libraries of one file.
const LIBRARY_LIMIT: usize = 64;
/// Most materials of one file.
const NAME_LIMIT: usize = 1 << 16;

/// The triangles of one material.
#[derive(Debug)]
pub(in crate::desc) struct Part {
    /// The material, after the materials that it consists of, which have no names. They name one another by the numbers that they
    /// have when they follow all materials of the parts before, the first of which has the number 0.
    pub materials: Vec<MaterialDesc>,
    pub mesh: MeshDesc,
}

/// The parts of a file.
#[derive(Debug)]
pub(in crate::desc) struct Parts {
    pub parts: Vec<Part>,
    /// The textures of the materials, which name them by their place here.
    pub textures: Vec<TextureDesc>,
    /// The material libraries and images that were read.
    pub files: Vec<std::path::PathBuf>,
}

/// Which faces of a file have which material.
#[derive(Debug, Default)]
pub(super) struct MaterialUses {
    /// Names after `mtllib`, with their lines.
    libraries: Vec<(Vec<u8>, usize)>,
    /// Names after `usemtl`, with the lines where they are used first; an empty one for faces that have no material.
    names: Vec<(String, usize)>,
    numbers: HashMap<String, usize>,
    /// The material from here on.
    current: Option<usize>,
    /// Triangles that follow one another and have the same material.
    runs: Vec<(usize, Range<usize>)>,
    triangles: usize,
}

impl MaterialUses {
    /// Reads `mtllib` or `usemtl`.
    pub fn read(&mut self, text: &[u8], line: usize) -> Result<(), String> {
        let (key, rest) = keyword(text);
        if key == b"mtllib" {
            if rest.is_empty() {
                return Ok(());
            }
            if self.libraries.len() == LIBRARY_LIMIT {
                return Err(format!("the file names more than {LIBRARY_LIMIT} material libraries"));
            }
            self.libraries.push((rest.to_owned(), line));
            return Ok(());
        }
        let name = String::from_utf8_lossy(rest);
        if self.names.len() == NAME_LIMIT && !self.numbers.contains_key(name.as_ref()) {
            return Err(format!("the file names more than {NAME_LIMIT} materials"));
        }
        self.current = Some(self.number(&name, line));
        Ok(())
    }

    /// The number of a name, which is used on this line.
    fn number(&mut self, name: &str, line: usize) -> usize {
        if let Some(number) = self.numbers.get(name) {
            return *number;
        }
        let number = self.names.len();
        self.numbers.insert(name.to_owned(), number);
        self.names.push((name.to_owned(), line));
        number
    }

    /// Notes the material of a face, which becomes a fan of triangles.
    pub fn face(&mut self, corners: usize, line: usize) {
        let from = self.triangles;
        self.triangles += corners - 2;
        let material = self.current.unwrap_or_else(|| self.number("", line));
        match self.runs.last_mut() {
            Some((last, run)) if *last == material && run.end == from => run.end = self.triangles,
            _ => self.runs.push((material, from..self.triangles)),
        }
    }

    /// Reads all libraries that the file at `path` names.
    fn library(&self, place: Place<'_>, warnings: &mut Vec<String>) -> Result<Library> {
        let Place { path, json_path } = place;
        let folder = path.parent().unwrap_or(Path::new(""));
        let mut library = Library::default();
        for (names, line) in &self.libraries {
            let names = String::from_utf8_lossy(names);
            let find = |name: &str| {
                let as_given = folder.join(name);
                let is_there = |path: &Path| path.symlink_metadata().is_ok();
                if is_there(&as_given) || !name.contains('\\') {
                    return is_there(&as_given).then_some(as_given);
                }
                Some(folder.join(name.replace('\\', "/"))).filter(|path| is_there(path))
            };
            // A name may hold blanks, and a line may hold several names.
            let mut files = Vec::new();
            match find(&names) {
                Some(file) => files.push(file),
                None => {
                    for name in names.split_ascii_whitespace() {
                        match find(name) {
                            Some(file) => files.push(file),
                            None => {
                                let missing = format!("there is no material library '{}'", elided(name));
                                place.warn(warnings, *line, &missing);
                            }
                        }
                    }
                }
            }
            for file in files {
                if library.files.len() == LIBRARY_LIMIT {
                    let message = format!("the file names more than {LIBRARY_LIMIT} material libraries");
                    return Err(Error::invalid(json_path, message).in_file(Some(path), *line));
                }
                library.read(&file, json_path, warnings)?;
            }
        }
        Ok(library)
    }
}

/// Reads the file and the material libraries that it names, with a part for each material that a face has, in the order of their
/// first faces.
pub(super) fn load(source: Source<'_, '_>, warnings: &mut Vec<String>, work: &WorkProgress<'_>) -> Result<Parts> {
    let guessed = image_bytes(source.path, work);
    work.expect(guessed);
    let place = source.place();
    let (path, json_path) = (place.path, place.json_path);
    let mut noted = Vec::new();
    let (mesh, uses) = obj::read(source, Some(MaterialUses::default()), &mut noted, work)?;
    let uses = uses.unwrap_or_default();
    if uses.triangles != mesh.triangles.len() {
        let message = format!("{} triangles were made of {}", mesh.triangles.len(), uses.triangles);
        return Err(Error::new(ErrorKind::Internal, message).at(json_path));
    }
    // The parts, whose lists grow, beside the mesh.
    check_room(2 * bytes(&mesh) + size_of::<u32>() * mesh.positions.len()).map_err(|error| place.lacking(error))?;
    let library = uses.library(place, &mut noted)?;
    let mut runs: Vec<Vec<Range<usize>>> = vec![Vec::new(); uses.names.len()];
    for (material, run) in uses.runs {
        runs[material].push(run);
    }
    let mut numbered: Vec<_> = uses.names.iter().zip(runs).filter(|(_, runs)| !runs.is_empty()).collect();
    numbered.sort_by_key(|(_, runs)| runs[0].start);
    let mut split = Splitter { vertices: vec![u32::MAX; mesh.positions.len()], mesh: &mesh };
    let (mut parts, mut first) = (Vec::with_capacity(numbered.len()), 0);
    let mut maps = Maps::new(place);
    // From here on the images are known by themselves.
    work.expect(-guessed);
    if !mesh.uvs.is_empty() {
        let used = numbered.iter().filter_map(|((name, _), _)| library.find(name));
        maps.read_ahead(used.flat_map(|entry| entry.maps()), work)?;
    }
    let bounds = mesh.bounds();
    let diagonal = (bounds.max - bounds.min).length();
    for ((name, line), runs) in numbered {
        let full_name = format!("{}:{name}", path.display());
        let part = split.part(&runs, name);
        let materials = match library.find(name) {
            Some(entry) => {
                let mut materials = entry.describe(&full_name, json_path, first);
                let ground = Ground { has_uvs: !part.uvs.is_empty(), diagonal };
                maps.bind(entry.maps(), &mut materials, ground, &mut noted)?;
                if let Some(whole) = materials.last_mut() {
                    settle_opacity(whole, &mut noted);
                }
                materials
            }
            None => {
                let why = if name.is_empty() {
                    "faces have no material".to_owned()
                } else {
                    let hint = did_you_mean(name, library.names());
                    format!("no material named '{}' in its material libraries{hint}", elided(name))
                };
                let is_colored = !part.colors.is_empty();
                let taken =
                    if is_colored { "a diffuse one with the colours of their vertices" } else { "a grey diffuse one" };
                place.warn(&mut noted, *line, &format!("{why}; {taken} is taken"));
                let material = MaterialDesc { name: full_name, path: json_path.to_owned(), ..MaterialDesc::default() };
                vec![if is_colored {
                    maps.colored(material)
                } else {
                    MaterialDesc { bsdf: BsdfDesc::Lambert { albedo: Rgb::splat(0.8) }, ..material }
                }]
            }
        };
        first += materials.len();
        parts.push(Part { materials, mesh: part });
    }
    // The caller's description stays as it is where an error occurs.
    noted.into_iter().for_each(|warning| warn(warnings, warning));
    let files = library.files.into_iter().chain(maps.files).collect();
    Ok(Parts { parts, textures: maps.textures, files })
}

/// Memory of a mesh's lists.
fn bytes(mesh: &MeshDesc) -> usize {
    let MeshDesc { positions, normals, uvs, colors, triangles, .. } = mesh;
    size_of_val(&**positions)
        + size_of_val(&**normals)
        + size_of_val(&**uvs)
        + size_of_val(&**colors)
        + size_of_val(&**triangles)
}

/// Takes parts out of a mesh.
struct Splitter<'a> {
    mesh: &'a MeshDesc,
    /// The new number of each vertex in the part that is being made.
    vertices: Vec<u32>,
}

impl Splitter<'_> {
    fn part(&mut self, runs: &[Range<usize>], name: &str) -> MeshDesc {
        let whole = self.mesh;
        let mut part =
            MeshDesc { name: format!("{}:{name}", whole.name), path: whole.path.clone(), ..MeshDesc::default() };
        let mut used = Vec::new();
        for triangle in runs.iter().flat_map(|run| &whole.triangles[run.clone()]) {
            part.triangles.push(triangle.map(|vertex| {
                let number = &mut self.vertices[vertex as usize];
                if *number == u32::MAX {
                    *number = used.len() as u32;
                    used.push(vertex);
                }
                *number
            }));
        }
        for vertex in used {
            let vertex = vertex as usize;
            self.vertices[vertex] = u32::MAX;
            part.positions.push(whole.positions[vertex]);
            part.normals.extend(whole.normals.get(vertex));
            part.uvs.extend(whole.uvs.get(vertex));
            part.colors.extend(whole.colors.get(vertex));
        }
        part
    }
}
