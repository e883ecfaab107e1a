//! Calls that build and edit a scene. They can express everything that the scene format can, with the same checks and
//! the same names.
//!
//! A number that a call returns is the index in the list of materials, lights, meshes or surfaces; it never changes and
//! is never used again. Every call checks all of its arguments, and on an error leaves the description as it was.
//! Errors give the same JSON path as the format would (`surfaces[3].radius`, `meshes[0].triangles[7][2]`); for an
//! element that a file described, the path is the one in that file.

use std::ops::Range;
use std::path::Path;
use std::sync::Arc;

use super::group::has_mesh;
use super::json::{elided, join};
use super::mesh_files::{self, Part, Parts};
use super::surfaces::BlockFacts;
use super::texture_check;
use super::warnings::warn;
use super::{
    BsdfDesc, CameraDesc, MaterialDesc, MediumDesc, MeshDesc, SceneDesc, ShapeDesc, SurfaceDesc, camera_check,
    material_check, spectrum_edit, validate,
};
use crate::control::{Cancel, WorkProgress};
use crate::math::{Bounds, DAffine3};
use crate::spectrum::Rgb;
use crate::{Error, Result};

/// The properties of a surface other than its shape.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SurfaceLook {
    /// Number of the surface's material. With `None` the surface needs an emission and reflects nothing.
    pub material: Option<usize>,
    /// Emitted radiance [W m^-2 sr^-1] on the normal's side, each channel >= 0.
    pub emission: Option<Rgb>,
    /// Whether the surface emits on its other side too; false for one that does not emit.
    pub emits_both: bool,
    /// Object to world, invertible.
    pub transform: DAffine3,
}

/// Calls that build and edit a scene.
///
/// Calls that add an element take the same time however large the scene is, apart from the data that they copy; so do
/// calls that change a material, a light or a surface.
impl SceneDesc {
    /// Sets the camera.
    ///
    /// # Errors
    /// [`crate::ErrorKind::InvalidScene`] at `camera.origin`, `camera.lookAt`, `camera.up`, `camera.fieldOfView`, `camera.width`
    /// or `camera.height` for a number out of range, or for three vectors that give no frame; at `camera.lensRadius`,
    /// `camera.focusDistance`, `camera.focusAt`, `camera.blades`, `camera.bladeRotation` or `camera.squeeze` for a lens that is none;
    /// at `camera.shift` or `camera.pixelAspect` for a film out of range.
    pub fn set_camera(&mut self, camera: CameraDesc) -> Result<()> {
        self.camera = camera_check::camera("camera", camera)?;
        Ok(())
    }

    /// Adds a material and returns its number. A material with an empty `name` has no name: it cannot be looked up by
    /// name, and any number of materials may have the empty name.
    ///
    /// `survival` is the survival probability of Russian roulette, in (0, 1]. It is allowed for diffuse models only,
    /// and renders use it only with [`RouletteDesc::File`](super::RouletteDesc::File). With `None`, the library chooses
    /// the probability in these renders too.
    ///
    /// # Errors
    /// [`crate::ErrorKind::InvalidScene`] at `materials[..]`: `.name` if it is taken, `.color`, `.roughness`,
    /// `.sigmaDeg`, `.refractionIndex`, `.exteriorIndex` or `.reflectionRate` if it is out of range.
    pub fn add_material(&mut self, name: &str, bsdf: BsdfDesc, survival: Option<f32>) -> Result<usize> {
        let name = name.to_owned();
        self.add_material_desc(MaterialDesc { name, bsdf, survival, ..MaterialDesc::default() })
    }

    /// Adds a material with all that a file can say of it, and returns its number. Its `path` is not read.
    ///
    /// # Errors
    /// The errors are those of [`Self::add_material`] and [`Self::set_medium`], and [`crate::ErrorKind::InvalidScene`] at
    /// `materials[..]`: `.opacity` or `.emission[..]` for a number out of range, `.opacity` for a material that emits light and
    /// is not opaque.
    pub fn add_material_desc(&mut self, mut material: MaterialDesc) -> Result<usize> {
        material.path = format!("materials[{}]", self.materials.len());
        self.put_any(material)
    }

    /// Checks a material and adds it, under its name if it has one.
    fn put_any(&mut self, mut material: MaterialDesc) -> Result<usize> {
        material_check::check(&mut material, &self.materials)?;
        texture_check::bindings(&material, &self.textures, &self.materials)?;
        if material.name.is_empty() {
            self.materials.push(material);
            return Ok(self.materials.len() - 1);
        }
        self.put_material(material)
    }

    /// Changes a material. The material keeps its name, and loses its medium, its opacity and its emission.
    ///
    /// # Errors
    /// The errors are those of [`Self::add_material`], and an error for a number that no material has.
    pub fn set_material(&mut self, material: usize, bsdf: BsdfDesc, survival: Option<f32>) -> Result<()> {
        self.set_material_desc(material, MaterialDesc { bsdf, survival, ..MaterialDesc::default() })
    }

    /// Changes all of a material but its name and path, which are not read. Where a material becomes an emitter or loses its
    /// opacity, the time grows with the number of surfaces that may have it.
    ///
    /// # Errors
    /// The errors are those of [`Self::add_material_desc`] and [`Self::set_material`]; an error at `materials[..].emission` for a
    /// material of a surface that cannot emit, and at `materials[..].opacity` for that of a surface with an emission.
    pub fn set_material_desc(&mut self, material: usize, to: MaterialDesc) -> Result<()> {
        let count = self.materials.len();
        let Some(known) = self.materials.get(material) else {
            return Err(none_such(&format!("materials[{material}]"), "material", material, count));
        };
        let mut to = MaterialDesc { name: known.name.clone(), path: known.path.clone(), ..to };
        material_check::check(&mut to, &self.materials[..material])?;
        texture_check::bindings(&to, &self.textures, &self.materials[..material])?;
        if to.emission.is_some() && known.emission.is_none() || !to.is_opaque() && known.is_opaque() {
            let has_users = |facts: &BlockFacts| facts.has(|it| it == Some(material));
            let shown =
                self.surfaces.of_blocks(has_users).map(|(_, surface)| surface).filter(|surface| !surface.hidden);
            let users = shown.chain(self.members());
            for user in users.filter(|surface| surface.material == Some(material)) {
                validate::look(&user.path, user.emission, &to, &user.shape, &user.to_world()).map_err(|error| {
                    let key = if to.emission.is_some() { "emission" } else { "opacity" };
                    let message = format!("{} cannot have this material: {}", user.path, error.message());
                    Error::new(error.kind(), message).at(join(&to.path, key))
                })?;
            }
        }
        let before = std::mem::replace(&mut self.materials[material], to);
        // Materials that name this one have conditions of their own.
        let names_others = |bsdf: &BsdfDesc| matches!(bsdf, BsdfDesc::Mix { .. } | BsdfDesc::TwoSided { .. });
        let mut later = (material + 1..count).filter(|later| names_others(&self.materials[*later].bsdf));
        let checked = later.try_for_each(|later| {
            let it = &self.materials[later];
            material_check::model(&it.path, &it.bsdf, &self.materials[..later])?;
            texture_check::bindings(it, &self.textures, &self.materials[..later])
        });
        if checked.is_err() {
            self.materials[material] = before;
        }
        checked
    }

    /// Sets the medium inside bodies of a material, or removes it.
    ///
    /// # Errors
    /// [`crate::ErrorKind::InvalidScene`] at `materials[..]`: `.absorption[..]` if it is not a number of 0 or more, `.medium`
    /// for a material whose model has no inside, and an error for a number that no material has.
    pub fn set_medium(&mut self, material: usize, medium: Option<MediumDesc>) -> Result<()> {
        let count = self.materials.len();
        let Some(known) = self.materials.get_mut(material) else {
            return Err(none_such(&format!("materials[{material}]"), "material", material, count));
        };
        if let Some(medium) = medium {
            material_check::medium(&known.path, &known.bsdf, medium)?;
        }
        known.medium = medium;
        Ok(())
    }

    /// Adds a mesh, which consists of vectors or of the host's arrays, and returns its number. A mesh with an empty
    /// name has no name. The mesh's `path` is not read.
    ///
    /// # Errors
    /// [`crate::ErrorKind::InvalidScene`] at `meshes[..]`: `.name` if it is taken; `.triangles`, `.positions`,
    /// `.normals` or `.uvs` with the place of an index without a vertex, of a number beyond single precision, or of a
    /// wrong length.
    pub fn add_mesh(&mut self, mesh: MeshDesc) -> Result<usize> {
        let path = format!("meshes[{}]", self.meshes.len());
        if !mesh.name.is_empty() {
            self.check_mesh_name(&path, &mesh.name)?;
        }
        validate::mesh(&path, &mesh)?;
        let given = mesh.name.clone();
        let name = if given.is_empty() { path.clone() } else { given.clone() };
        let number = self.put_mesh(MeshDesc { name, path, ..mesh });
        self.index.name_mesh(given, number);
        Ok(number)
    }

    /// Adds the surfaces of a Wavefront OBJ file whose materials are those of the file: a mesh and a surface for each material that
    /// its faces have (`usemtl`), and these materials from the material libraries that the file names (`mtllib`). The materials are
    /// named after the file and the library's name for them, as in `car.obj:paint`, where no other has this name. Returns the numbers of the surfaces; materials
    /// and meshes can be found by them. `smooth` is as in [`ShapeDesc::Mesh`]. The file is read at each call; a relative path is
    /// resolved from the process's working directory.
    ///
    /// # Errors
    /// The errors are those of [`Self::add_mesh_file`] and [`Self::add_surface`]; [`crate::ErrorKind::Io`] for a library that cannot
    /// be read, [`crate::ErrorKind::InvalidScene`] for a face without a material, a material that no library has, and a library
    /// with invalid content, with the file and the line.
    pub fn add_file_surfaces(&mut self, file: &Path, smooth: bool, transform: DAffine3) -> Result<Range<usize>> {
        let path = format!("surfaces[{}]", self.surfaces.len());
        let at = join(&path, "file");
        mesh_files::check_name(&at, file)?;
        validate::invertible(&join(&path, "transform"), &transform)?;
        let mut warnings = Vec::new();
        let parts = mesh_files::load_parts(file, &at, &mut warnings, &WorkProgress::new(&Cancel::new()))?;
        for part in &parts.parts {
            validate::extent(&path, &part.mesh.bounds(), &transform)?;
        }
        let parts = self.put_parts(file, parts)?;
        warnings.into_iter().for_each(|warning| warn(&mut self.warnings, warning));
        let first = self.surfaces.len();
        for [material, mesh] in parts {
            let look = SurfaceLook { material: Some(material), transform, ..SurfaceLook::default() };
            self.put_surface(&path, ShapeDesc::Mesh { mesh, smooth }, DAffine3::IDENTITY, look)?;
        }
        Ok(first..self.surfaces.len())
    }

    /// Adds the textures, materials and meshes of a divided file. Returns the numbers of the material and the mesh of each part.
    /// What has a name that is taken gets none.
    pub(super) fn put_parts(&mut self, file: &Path, parts: Parts) -> Result<Vec<[usize; 2]>> {
        self.files.push(file.to_owned());
        self.files.extend(parts.files);
        let first = self.materials.len();
        let first_texture = self.textures.len();
        for mut texture in parts.textures {
            if self.find_texture(&texture.name).is_some() {
                texture.name.clear();
            }
            self.put_texture(texture)?;
        }
        let put = |part: Part| {
            let mut number = first;
            for mut material in part.materials {
                if self.find_material(&material.name).is_some() {
                    material.name.clear();
                }
                if let BsdfDesc::Mix { materials, .. } = &mut material.bsdf {
                    materials.iter_mut().for_each(|part| *part += first);
                }
                material.textures.iter_mut().for_each(|binding| binding.texture += first_texture);
                number = self.put_any(material)?;
            }
            Ok([number, self.put_mesh(part.mesh)])
        };
        parts.parts.into_iter().map(put).collect()
    }

    /// Replaces the data of a mesh, for all surfaces that use the mesh. The mesh keeps its name and loses its steps; the name and path in
    /// `data` are not read. The time grows with the number of surfaces that use the mesh.
    ///
    /// # Errors
    /// The errors are those of [`Self::add_mesh`], an error at a surface whose coordinates would exceed single
    /// precision with the new data, and an error for a number that no mesh has or that belongs to a removed mesh.
    pub fn set_mesh(&mut self, mesh: usize, data: MeshDesc) -> Result<()> {
        let path = format!("meshes[{mesh}]");
        let name = self.usable_mesh(&path, mesh)?.name.clone();
        validate::mesh(&path, &data)?;
        let extent = data.bounds();
        let users = self.index.users(mesh, &self.surfaces);
        for surface in users.iter().filter_map(|number| self.surfaces.get(*number)) {
            validate::extent(&surface.path, &extent, &surface.to_world())?;
        }
        for member in self.members().filter(|member| has_mesh(member, mesh)) {
            validate::extent(&member.path, &extent, &member.to_world())?;
        }
        let data = Arc::new(MeshDesc { name, path, ..data });
        self.index.keep_users(mesh, users);
        self.index.measured(mesh, &data, extent);
        // Steps were those of the vertices before.
        self.motion.meshes.remove(&mesh);
        self.meshes[mesh] = data;
        Ok(())
    }

    /// Removes a mesh that no surface and no group uses any more and frees its memory. Its name may be used again; its number is not
    /// used again.
    ///
    /// # Errors
    /// [`crate::ErrorKind::InvalidScene`] at `meshes[..]` while a surface or a group uses the mesh, and for a number that no mesh
    /// has or that belongs to a removed mesh.
    pub fn remove_mesh(&mut self, mesh: usize) -> Result<()> {
        let path = format!("meshes[{mesh}]");
        self.usable_mesh(&path, mesh)?;
        if let Some(user) = self.index.users(mesh, &self.surfaces).first() {
            let message = format!("{} uses the mesh, expected one that no surface uses", self.surfaces[*user].path);
            return Err(Error::invalid(path, message));
        }
        if let Some(group) = self.group_with_mesh(mesh) {
            return Err(Error::invalid(path, format!("{group} uses the mesh, expected one that no group uses")));
        }
        let removed = std::mem::replace(&mut self.meshes[mesh], Arc::new(MeshDesc { path, ..MeshDesc::default() }));
        self.motion.meshes.remove(&mesh);
        self.index.forget_mesh(mesh, &removed.name);
        Ok(())
    }

    /// Adds a surface and returns its number. `local` is the transform from the shape's frame to the object's frame;
    /// [`ShapeDesc::cylinder`] and the other constructors return the shape and `local` together.
    ///
    /// # Errors
    /// All errors are at `surfaces[..]`: [`crate::ErrorKind::InvalidScene`] for a number out of range, a material or
    /// mesh that does not exist, a surface with neither material nor emission, a transform that is not invertible, or a
    /// position beyond single precision; [`crate::ErrorKind::Unsupported`] for an emission of a quadric that is no cylinder, or
    /// of a sphere that is stretched by its transform; at `.emits`, those of [`Self::set_emits_both`].
    pub fn add_surface(&mut self, shape: ShapeDesc, local: DAffine3, look: SurfaceLook) -> Result<usize> {
        let path = format!("surfaces[{}]", self.surfaces.len());
        shape.check(&path)?;
        if let ShapeDesc::Mesh { mesh, .. } = shape {
            self.usable_mesh(&join(&path, "mesh"), mesh)?;
        }
        self.put_surface(&path, shape, local, look)
    }

    /// Moves a surface. `transform` is the transform from the object's frame to the world frame.
    ///
    /// # Errors
    /// The errors are those of [`Self::add_surface`], and an error for a number that no surface has or that belongs to
    /// a removed surface.
    pub fn set_transform(&mut self, surface: usize, transform: DAffine3) -> Result<()> {
        self.check_move(surface, &transform)?;
        self.surfaces[surface].transform = transform;
        Ok(())
    }

    /// Checks that a surface can have this transform.
    pub(super) fn check_move(&mut self, surface: usize, transform: &DAffine3) -> Result<()> {
        let known = self.live_surface(surface)?;
        let (shape, local, material, emission) = (known.shape, known.local, known.material, known.emission);
        let path = known.path.clone();
        self.check_place(&path, &shape, &local, transform)?;
        self.check_look(&path, emission, material, &shape, &(*transform * local))
    }

    /// Gives a surface another material. For a surface that emits, `None` makes the surface reflect nothing.
    ///
    /// # Errors
    /// [`crate::ErrorKind::InvalidScene`] at `surfaces[..].material` for a material that does not exist, and at
    /// `surfaces[..]` for `None` on a surface without an emission, or for a number that no surface has or that belongs
    /// to a removed surface.
    pub fn set_surface_material(&mut self, surface: usize, material: Option<usize>) -> Result<()> {
        let known = self.live_surface(surface)?;
        let path = known.path.clone();
        self.check_material(&path, material, known.emission.is_some())?;
        self.check_look(&path, known.emission, material, &known.shape, &known.to_world())?;
        self.surfaces[surface].material = material;
        Ok(())
    }

    /// Sets the emission of a surface: radiance [W m^-2 sr^-1] on the normal's side, each channel >= 0, or the factor on its
    /// [web](Self::set_surface_web) where it has one. `None` removes
    /// the emission; a surface that had no material then stays black, and one whose material emits light has the emission of
    /// the material.
    ///
    /// # Errors
    /// At `surfaces[..].emission`, [`crate::ErrorKind::InvalidScene`] for a number out of range and
    /// [`crate::ErrorKind::Unsupported`] for a shape that cannot emit; at `surfaces[..]`, an error for a number that no
    /// surface has or that belongs to a removed surface.
    pub fn set_emission(&mut self, surface: usize, emission: Option<Rgb>) -> Result<()> {
        let known = self.live_surface(surface)?;
        let emission = check_emission(&known.path, emission)?;
        let emission =
            emission.map(|it| spectrum_edit::dressed(&known.path, known.spectrum.as_ref(), it)).transpose()?;
        self.check_look(&known.path, emission, known.material, &known.shape, &known.to_world())?;
        if let (Some(web), Some(factor)) = (&known.web, emission) {
            web.check(&known.path, &known.shape, factor, known.emits_both)?;
        }
        self.surfaces[surface].emission = emission;
        Ok(())
    }

    /// Sets whether a surface that emits does so on both of its sides, with the same radiance, or on the side of its normal only.
    /// A surface keeps this when its emission changes or is removed.
    ///
    /// # Errors
    /// At `surfaces[..].emits`, for `true`, [`crate::ErrorKind::InvalidScene`] for a surface that emits no light, neither by itself nor
    /// by its material, and [`crate::ErrorKind::Unsupported`] for a sphere, whose inside is closed; for `false`, those of
    /// [`Self::set_surface_web`] where the surface has a web; at `surfaces[..]`, an error for a
    /// number that no surface has or that belongs to a removed surface.
    pub fn set_emits_both(&mut self, surface: usize, emits_both: bool) -> Result<()> {
        let known = self.live_surface(surface)?;
        if emits_both {
            let emits = known.emission.or(self.material_of(known).and_then(|it| it.emission)).is_some();
            validate::emits_both(&known.path, &known.shape, emits)?;
        }
        if let Some(web) = &known.web {
            web.check(&known.path, &known.shape, known.emission.unwrap_or(Rgb::ZERO), emits_both)?;
        }
        self.surfaces[surface].emits_both = emits_both;
        Ok(())
    }

    /// Gives a surface a name, or takes it away where `name` is empty. Several surfaces may have one name: they are then one object for
    /// [`Mattes`](crate::render::Mattes). No picture depends on it, so nothing has to be built again.
    ///
    /// # Errors
    /// [`crate::ErrorKind::InvalidScene`] for a number that no surface has or that belongs to a removed surface, and for a name with a NUL.
    pub fn set_surface_name(&mut self, surface: usize, name: &str) -> Result<()> {
        self.live_surface(surface)?;
        if name.contains('\0') {
            return Err(Error::invalid(
                format!("surfaces[{surface}].name"),
                "the name has a NUL, which ends a name in C",
            ));
        }
        name.clone_into(&mut self.surfaces[surface].name);
        Ok(())
    }

    /// Removes a surface permanently: no ray hits it, no call can change it, its number is not used again, and it no
    /// longer uses its mesh.
    ///
    /// # Errors
    /// [`crate::ErrorKind::InvalidScene`] for a number that no surface has or that belongs to a removed surface.
    pub fn remove_surface(&mut self, surface: usize) -> Result<()> {
        self.live_surface(surface)?;
        self.surfaces[surface].hidden = true;
        self.motion.surfaces.remove(&surface);
        Ok(())
    }

    /// Returns the number of the material to which a file or a call gave this name.
    pub fn find_material(&self, name: &str) -> Option<usize> {
        self.index.materials.get(name).copied().filter(|number| *number < self.materials.len())
    }

    /// Returns the number of the mesh to which a file or a call gave this name.
    pub fn find_mesh(&self, name: &str) -> Option<usize> {
        let number = *self.index.meshes.get(name)?;
        self.meshes.get(number).filter(|mesh| !is_removed(mesh)).map(|_| number)
    }

    /// Returns the number of the surface at a path such as `surfaces[3]`, or `lights[0]` for an area light of a file.
    /// Removed surfaces are not found. The function searches all surfaces.
    pub fn find_surface(&self, json_path: &str) -> Option<usize> {
        self.surfaces.iter().position(|surface| !surface.hidden && surface.path == json_path)
    }

    /// Adds a named material whose numbers have been checked.
    pub(super) fn put_material(&mut self, material: MaterialDesc) -> Result<usize> {
        if self.find_material(&material.name).is_some() {
            let message = format!("the material name '{}' is given twice", elided(&material.name));
            return Err(Error::invalid(join(&material.path, "name"), message));
        }
        let number = self.materials.len();
        self.index.materials.insert(material.name.clone(), number);
        self.materials.push(material);
        Ok(number)
    }

    /// Adds a mesh whose numbers have been checked.
    pub(super) fn put_mesh(&mut self, mesh: MeshDesc) -> usize {
        let (number, mesh) = (self.meshes.len(), Arc::new(mesh));
        self.index.measured(number, &mesh, mesh.bounds());
        self.meshes.push(mesh);
        number
    }

    /// Adds a surface whose shape has been checked.
    pub(super) fn put_surface(
        &mut self,
        path: &str,
        shape: ShapeDesc,
        local: DAffine3,
        look: SurfaceLook,
    ) -> Result<usize> {
        let emission = check_emission(path, look.emission)?;
        // An emission allows a surface without a material, even if the emission is zero.
        self.check_material(path, look.material, look.emission.is_some())?;
        self.check_place(path, &shape, &local, &look.transform)?;
        self.check_look(path, emission, look.material, &shape, &(look.transform * local))?;
        if look.emits_both {
            let of_material = look.material.and_then(|material| self.materials[material].emission);
            validate::emits_both(path, &shape, emission.or(of_material).is_some())?;
        }
        self.surfaces.push(SurfaceDesc {
            path: path.to_owned(),
            name: String::new(),
            shape,
            local,
            transform: look.transform,
            material: look.material,
            emission,
            emits_both: look.emits_both,
            web: None,
            spectrum: None,
            hidden: false,
        });
        self.index.see(&self.surfaces);
        Ok(self.surfaces.len() - 1)
    }

    fn check_material(&self, path: &str, material: Option<usize>, emits: bool) -> Result<()> {
        match material {
            Some(material) if material >= self.materials.len() => {
                Err(none_such(&join(path, "material"), "material", material, self.materials.len()))
            }
            None if !emits => Err(Error::invalid(path, "missing key `material`")),
            _ => Ok(()),
        }
    }

    /// Checks the opacity and emission of every material, and that they agree with the surfaces, for a description that is put
    /// together by hand. Materials of surfaces must exist.
    pub(crate) fn check_looks(&self) -> Result<()> {
        for (number, material) in self.materials.iter().enumerate() {
            if material.emission.is_some() || !material.is_opaque() {
                material_check::check(&mut material.clone(), &self.materials[..number])?;
            }
        }
        let is_special = |material: &MaterialDesc| material.emission.is_some() || !material.is_opaque();
        let is_one = |number: Option<usize>| number.and_then(|it| self.materials.get(it)).is_some_and(is_special);
        for (_, surface) in self.surfaces.of_blocks(|facts| facts.has(is_one)) {
            if let Some(material) = self.material_of(surface).filter(|it| !surface.hidden && is_special(it)) {
                validate::look(&surface.path, surface.emission, material, &surface.shape, &surface.to_world())?;
            }
        }
        Ok(())
    }

    /// Checks that the shape can emit where the surface or its material emits, and that what emits is opaque.
    pub(super) fn check_look(
        &self,
        path: &str,
        emission: Option<Rgb>,
        material: Option<usize>,
        shape: &ShapeDesc,
        to_world: &DAffine3,
    ) -> Result<()> {
        match material.and_then(|material| self.materials.get(material)) {
            Some(material) => validate::look(path, emission, material, shape, to_world),
            None if emission.is_some() => validate::emitter(path, shape, to_world),
            None => Ok(()),
        }
    }

    /// Checks that the placement is invertible and that its coordinates fit single precision.
    pub(super) fn check_place(
        &mut self,
        path: &str,
        shape: &ShapeDesc,
        local: &DAffine3,
        transform: &DAffine3,
    ) -> Result<()> {
        let to_world = *transform * *local;
        validate::invertible(path, local)?;
        if *transform != DAffine3::IDENTITY {
            let at = join(path, "transform");
            validate::invertible(&at, transform)?;
            validate::invertible(&at, &to_world)?;
        }
        let extent =
            shape.extent(|mesh| self.meshes.get(mesh).map_or(Bounds::EMPTY, |data| self.index.extent(mesh, data)));
        validate::extent(path, &extent, &to_world)
    }

    /// Checks that no other mesh has this name.
    pub(super) fn check_mesh_name(&self, path: &str, name: &str) -> Result<()> {
        if self.find_mesh(name).is_some() {
            return Err(Error::invalid(join(path, "name"), format!("the mesh name '{}' is given twice", elided(name))));
        }
        Ok(())
    }

    /// Returns a mesh, or an error if the mesh does not exist or was removed. `path` is where the mesh's number is
    /// used.
    pub(super) fn usable_mesh(&self, path: &str, mesh: usize) -> Result<&MeshDesc> {
        let known = self.meshes.get(mesh).ok_or_else(|| none_such(path, "mesh", mesh, self.meshes.len()))?;
        if is_removed(known) {
            return Err(Error::invalid(path, format!("mesh {mesh} was removed")));
        }
        Ok(known)
    }

    /// Returns a surface, or an error if the surface does not exist or was removed.
    pub(super) fn live_surface(&self, surface: usize) -> Result<&SurfaceDesc> {
        let known = self
            .surfaces
            .get(surface)
            .ok_or_else(|| none_such(&format!("surfaces[{surface}]"), "surface", surface, self.surfaces.len()))?;
        if known.hidden {
            return Err(Error::invalid(&known.path, format!("surface {surface} was removed")));
        }
        Ok(known)
    }
}

/// Checks that the radiance is in range. An emission without any light becomes `None`.
fn check_emission(path: &str, emission: Option<Rgb>) -> Result<Option<Rgb>> {
    let Some(radiance) = emission else { return Ok(None) };
    validate::emission(&join(path, "emission"), radiance.to_f64(), 1.0)?;
    Ok((radiance != Rgb::ZERO).then_some(radiance))
}

/// Returns whether a mesh was removed. Only removed meshes are empty.
fn is_removed(mesh: &MeshDesc) -> bool {
    mesh.triangle_count() == 0
}

/// The error for a number that is not an index of the list.
pub(super) fn none_such(path: &str, what: &str, number: usize, count: usize) -> Error {
    Error::invalid(path, format!("there is no {what} {number}, expected an index below {count}"))
}
