//! Scenes made and changed by calls: what the scene format can say, with its checks and its words.
//!
//! A number that a call gives is the place in the list of materials, lights, meshes or surfaces, and never changes or
//! comes again. Every call checks all it is given and on an error leaves the description as it was. Errors say where as
//! the format would (`surfaces[3].radius`, `meshes[0].triangles[7][2]`); for what a file described, the path is the
//! file's own.

use std::path::Path;
use std::sync::Arc;

use super::json::{elided, join};
use super::{BsdfDesc, CameraDesc, MaterialDesc, MeshDesc, SceneDesc, ShapeDesc, SurfaceDesc, obj, validate};
use crate::math::{Bounds, DAffine3, DVec3};
use crate::spectrum::Rgb;
use crate::{Error, Result};

/// Name of the material of surfaces that only emit.
const BLACK: &str = "(black)";

/// Everything about a surface but its shape.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SurfaceLook {
    /// Number of its material. `None` needs an emission: the surface then reflects nothing.
    pub material: Option<usize>,
    /// Emitted radiance [W m^-2 sr^-1] on the normal's side, each channel >= 0.
    pub emission: Option<Rgb>,
    /// Object to world, invertible.
    pub transform: DAffine3,
}

/// Calls that make and change a scene.
///
/// Those that add take the same time however large the scene is, but for what they copy; so do those that change a
/// material, a light or a surface.
impl SceneDesc {
    /// Sets where the scene is seen from.
    ///
    /// # Errors
    /// [`crate::ErrorKind::InvalidScene`] at `camera.origin`, `camera.lookAt`, `camera.up` or `camera.fieldOfView` for
    /// a number out of range, or three vectors that give no frame.
    pub fn set_camera(&mut self, camera: CameraDesc) -> Result<()> {
        self.camera = validate::camera("camera", camera)?;
        Ok(())
    }

    /// Adds a material and gives its number. An empty `name` is none: it is not looked up and may come again.
    ///
    /// `survival` is Russian roulette's survival probability in (0, 1], of diffuse models only, for renders with
    /// [`RouletteDesc::File`](super::RouletteDesc::File); `None` leaves it to the library in these too.
    ///
    /// # Errors
    /// [`crate::ErrorKind::InvalidScene`] at `materials[..]`: `.name` if it is taken, `.color`, `.roughness`,
    /// `.sigmaDeg`, `.refractionIndex`, `.exteriorIndex` or `.reflectionRate` if it is out of range.
    pub fn add_material(&mut self, name: &str, bsdf: BsdfDesc, survival: Option<f32>) -> Result<usize> {
        let path = format!("materials[{}]", self.materials.len());
        validate::material(&path, &bsdf, survival)?;
        let material = MaterialDesc { name: name.to_owned(), path, bsdf, survival };
        if name.is_empty() {
            self.materials.push(material);
            return Ok(self.materials.len() - 1);
        }
        self.put_material(material)
    }

    /// Changes a material; it keeps its name.
    ///
    /// # Errors
    /// As [`Self::add_material`], and for a number that is no material's or the one of surfaces without a material.
    pub fn set_material(&mut self, material: usize, bsdf: BsdfDesc, survival: Option<f32>) -> Result<()> {
        if self.black() == Some(material) {
            let message = "this is what surfaces without a material share, it stays black";
            return Err(Error::invalid(format!("materials[{material}]"), message));
        }
        let count = self.materials.len();
        let Some(known) = self.materials.get_mut(material) else {
            return Err(none_such(&format!("materials[{material}]"), "material", material, count));
        };
        validate::material(&known.path, &bsdf, survival)?;
        (known.bsdf, known.survival) = (bsdf, survival);
        Ok(())
    }

    /// Adds a point light and gives its number. `intensity` is radiant intensity [W sr^-1], each channel >= 0.
    ///
    /// # Errors
    /// [`crate::ErrorKind::InvalidScene`] at `lights[..].origin[..]` or `lights[..].color[..]`.
    pub fn add_point_light(&mut self, position: DVec3, intensity: Rgb) -> Result<usize> {
        let path = format!("lights[{}]", self.lights.len());
        self.lights.push(validate::point_light(&path, position, intensity.to_f64(), 1.0)?);
        Ok(self.lights.len() - 1)
    }

    /// Changes a point light; no intensity switches it off.
    ///
    /// # Errors
    /// As [`Self::add_point_light`], and for a number that is no light's.
    pub fn set_point_light(&mut self, light: usize, position: DVec3, intensity: Rgb) -> Result<()> {
        let count = self.lights.len();
        let Some(known) = self.lights.get_mut(light) else {
            return Err(none_such(&format!("lights[{light}]"), "point light", light, count));
        };
        *known = validate::point_light(&known.path, position, intensity.to_f64(), 1.0)?;
        Ok(())
    }

    /// Adds a mesh, of vectors or of the host's arrays, and gives its number. An empty name is none; `path` is not
    /// looked at.
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

    /// Adds the mesh in a Wavefront OBJ file and gives its number. The file is read at each call; a relative one is
    /// looked up from the process's working directory. An empty name is none. What is left out of the file is said in
    /// `warnings`.
    ///
    /// # Errors
    /// [`crate::ErrorKind::Io`] if the file cannot be read, [`crate::ErrorKind::InvalidScene`] for what it holds, with
    /// the file and its line, and at `meshes[..].name` for a name that is taken.
    pub fn add_mesh_file(&mut self, name: &str, file: &Path) -> Result<usize> {
        let path = format!("meshes[{}]", self.meshes.len());
        if !name.is_empty() {
            self.check_mesh_name(&path, name)?;
        }
        let at = join(&path, "file");
        obj::check_name(&at, file)?;
        // It adds warnings only once nothing can fail any more.
        let mesh = obj::load(file, &at, &mut self.warnings)?;
        self.files.push(file.to_owned());
        let number = self.put_mesh(mesh);
        self.index.name_mesh(name.to_owned(), number);
        Ok(number)
    }

    /// Replaces the data of a mesh, for all surfaces that use it. It keeps its name; name and path in `data` are not
    /// looked at. Takes time with the number of surfaces that use it.
    ///
    /// # Errors
    /// As [`Self::add_mesh`]; at a surface that the new data would carry beyond single precision; and for a number that
    /// is no mesh's or that of a removed one.
    pub fn set_mesh(&mut self, mesh: usize, data: MeshDesc) -> Result<()> {
        let path = format!("meshes[{mesh}]");
        let name = self.usable_mesh(&path, mesh)?.name.clone();
        validate::mesh(&path, &data)?;
        let extent = data.bounds();
        let users = self.index.users(mesh, &self.surfaces);
        for surface in users.iter().filter_map(|number| self.surfaces.get(*number)) {
            validate::extent(&surface.path, &extent, &surface.to_world())?;
        }
        let data = Arc::new(MeshDesc { name, path, ..data });
        self.index.keep_users(mesh, users);
        self.index.measured(mesh, &data, extent);
        self.meshes[mesh] = data;
        Ok(())
    }

    /// Removes a mesh that no surface shows any more and gives back its memory. Its name is free again, its number is
    /// not.
    ///
    /// # Errors
    /// [`crate::ErrorKind::InvalidScene`] at `meshes[..]` while a surface uses it, and for a number that is no mesh's
    /// or that of a removed one.
    pub fn remove_mesh(&mut self, mesh: usize) -> Result<()> {
        let path = format!("meshes[{mesh}]");
        self.usable_mesh(&path, mesh)?;
        if let Some(user) = self.index.users(mesh, &self.surfaces).first() {
            let message = format!("{} uses the mesh, expected one that no surface uses", self.surfaces[*user].path);
            return Err(Error::invalid(path, message));
        }
        let removed = std::mem::replace(&mut self.meshes[mesh], Arc::new(MeshDesc { path, ..MeshDesc::default() }));
        self.index.forget_mesh(mesh, &removed.name);
        Ok(())
    }

    /// Adds a surface and gives its number. `local` takes the shape's frame to the object's; [`ShapeDesc::cylinder`]
    /// and its like give both.
    ///
    /// # Errors
    /// At `surfaces[..]`. [`crate::ErrorKind::InvalidScene`] for a number out of range, a material or mesh that does
    /// not exist, neither material nor emission, a transform that cannot be undone, or a place beyond single precision;
    /// [`crate::ErrorKind::Unsupported`] for an emission of a quadric, a disk or a sphere stretched by its transform.
    pub fn add_surface(&mut self, shape: ShapeDesc, local: DAffine3, look: SurfaceLook) -> Result<usize> {
        let path = format!("surfaces[{}]", self.surfaces.len());
        shape.check(&path)?;
        if let ShapeDesc::Mesh { mesh, .. } = shape {
            self.usable_mesh(&join(&path, "mesh"), mesh)?;
        }
        self.put_surface(&path, shape, local, look)
    }

    /// Moves a surface: `transform` takes the object to the world.
    ///
    /// # Errors
    /// As [`Self::add_surface`], and for a number that is no surface's or that of a removed one.
    pub fn set_transform(&mut self, surface: usize, transform: DAffine3) -> Result<()> {
        let known = self.live_surface(surface)?;
        let (shape, local, emits) = (known.shape, known.local, known.emission.is_some());
        self.check_place(&self.surfaces[surface].path.clone(), &shape, &local, &transform, emits)?;
        self.surfaces[surface].transform = transform;
        Ok(())
    }

    /// Gives a surface another material; `None`, for a surface that emits, makes it reflect nothing.
    ///
    /// # Errors
    /// [`crate::ErrorKind::InvalidScene`] at `surfaces[..].material` for a material that does not exist, at
    /// `surfaces[..]` for none without an emission, or for a number that is no surface's or that of a removed one.
    pub fn set_surface_material(&mut self, surface: usize, material: Option<usize>) -> Result<()> {
        let known = self.live_surface(surface)?;
        let path = known.path.clone();
        self.check_material(&path, material, known.emission.is_some())?;
        self.surfaces[surface].material = material.unwrap_or_else(|| self.shared_black(&path));
        Ok(())
    }

    /// Lets a surface emit, or stop doing so: radiance [W m^-2 sr^-1] on the normal's side, each channel >= 0. One that
    /// had no material stays black without its light.
    ///
    /// # Errors
    /// At `surfaces[..].emission`: [`crate::ErrorKind::InvalidScene`] for a number out of range,
    /// [`crate::ErrorKind::Unsupported`] for a shape that cannot emit; at `surfaces[..]` for a number that is no
    /// surface's or that of a removed one.
    pub fn set_emission(&mut self, surface: usize, emission: Option<Rgb>) -> Result<()> {
        let known = self.live_surface(surface)?;
        let emission = check_emission(&known.path, emission)?;
        if emission.is_some() {
            validate::emitter(&known.path, &known.shape, &known.to_world())?;
        }
        self.surfaces[surface].emission = emission;
        Ok(())
    }

    /// Removes a surface for good: no ray meets it and no call changes it any more, its number is not used again, and
    /// it no longer uses its mesh.
    ///
    /// # Errors
    /// [`crate::ErrorKind::InvalidScene`] for a number that is no surface's or that of a removed one.
    pub fn remove_surface(&mut self, surface: usize) -> Result<()> {
        self.live_surface(surface)?;
        self.surfaces[surface].hidden = true;
        Ok(())
    }

    /// The material that a file or a call gave this name.
    pub fn find_material(&self, name: &str) -> Option<usize> {
        self.index.materials.get(name).copied().filter(|number| *number < self.materials.len())
    }

    /// The mesh that a file or a call gave this name.
    pub fn find_mesh(&self, name: &str) -> Option<usize> {
        let number = *self.index.meshes.get(name)?;
        self.meshes.get(number).filter(|mesh| !is_removed(mesh)).map(|_| number)
    }

    /// The surface at a path such as `surfaces[3]`, or `lights[0]` for an area light of a file; none that was removed.
    /// Searches them all.
    pub fn find_surface(&self, json_path: &str) -> Option<usize> {
        self.surfaces.iter().position(|surface| !surface.hidden && surface.path == json_path)
    }

    /// Adds a material with a name, and with numbers that are in order.
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

    /// Adds a mesh whose numbers are in order.
    pub(super) fn put_mesh(&mut self, mesh: MeshDesc) -> usize {
        let (number, mesh) = (self.meshes.len(), Arc::new(mesh));
        self.index.measured(number, &mesh, mesh.bounds());
        self.meshes.push(mesh);
        number
    }

    /// Adds a surface whose shape is in order.
    pub(super) fn put_surface(
        &mut self,
        path: &str,
        shape: ShapeDesc,
        local: DAffine3,
        look: SurfaceLook,
    ) -> Result<usize> {
        let emission = check_emission(path, look.emission)?;
        // Even an emission of zero may stand without a material.
        self.check_material(path, look.material, look.emission.is_some())?;
        self.check_place(path, &shape, &local, &look.transform, emission.is_some())?;
        let material = look.material.unwrap_or_else(|| self.shared_black(path));
        self.surfaces.push(SurfaceDesc {
            path: path.to_owned(),
            shape,
            local,
            transform: look.transform,
            material,
            emission,
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

    /// A place that can be undone, that single precision can follow, and where the shape can emit if it does.
    fn check_place(
        &mut self,
        path: &str,
        shape: &ShapeDesc,
        local: &DAffine3,
        transform: &DAffine3,
        emits: bool,
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
        validate::extent(path, &extent, &to_world)?;
        if emits { validate::emitter(path, shape, &to_world) } else { Ok(()) }
    }

    /// What surfaces without a material share, if there is one yet.
    fn black(&self) -> Option<usize> {
        let is_black = |number: &usize| self.materials.get(*number).is_some_and(|it| it.bsdf == BsdfDesc::Black);
        self.index.black.filter(is_black)
    }

    /// What surfaces without a material share, made when first needed.
    fn shared_black(&mut self, path: &str) -> usize {
        self.black().unwrap_or_else(|| {
            let number = self.materials.len();
            self.materials.push(MaterialDesc {
                name: BLACK.to_owned(),
                path: path.to_owned(),
                bsdf: BsdfDesc::Black,
                survival: None,
            });
            self.index.black = Some(number);
            number
        })
    }

    /// A name that no other mesh has.
    pub(super) fn check_mesh_name(&self, path: &str, name: &str) -> Result<()> {
        if self.find_mesh(name).is_some() {
            return Err(Error::invalid(join(path, "name"), format!("the mesh name '{}' is given twice", elided(name))));
        }
        Ok(())
    }

    /// A mesh that exists and was not removed; `path` is where its number is used.
    fn usable_mesh(&self, path: &str, mesh: usize) -> Result<&MeshDesc> {
        let known = self.meshes.get(mesh).ok_or_else(|| none_such(path, "mesh", mesh, self.meshes.len()))?;
        if is_removed(known) {
            return Err(Error::invalid(path, format!("mesh {mesh} was removed")));
        }
        Ok(known)
    }

    /// A surface that exists and was not removed.
    fn live_surface(&self, surface: usize) -> Result<&SurfaceDesc> {
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

/// Radiance in range; no light at all is no emission.
fn check_emission(path: &str, emission: Option<Rgb>) -> Result<Option<Rgb>> {
    let Some(radiance) = emission else { return Ok(None) };
    validate::emission(&join(path, "emission"), radiance.to_f64(), 1.0)?;
    Ok((radiance != Rgb::ZERO).then_some(radiance))
}

/// Only a removed mesh is empty.
fn is_removed(mesh: &MeshDesc) -> bool {
    mesh.triangle_count() == 0
}

/// A number that is none of a list's.
fn none_such(path: &str, what: &str, number: usize, count: usize) -> Error {
    Error::invalid(path, format!("there is no {what} {number}, expected an index below {count}"))
}
