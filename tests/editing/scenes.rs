//! Scenes to be edited, and edits.

use std::any::Any;
use std::path::Path;
use std::sync::Arc;

use etendue::buffer::Buffer;
use etendue::desc::{
    self, BsdfDesc, CameraDesc, FilmDesc, FovAxis, HostMesh, KeyPlace, LightDistribution, MaterialDesc, MeshDesc,
    MotionDesc, MotionKey, PointLightDesc, SceneDesc, ShapeDesc, ShutterDesc, SpotDesc, SurfaceDesc,
};
use etendue::math::{DAffine3, DQuat, DVec3};
use etendue::spectrum::Rgb;

/// SplitMix64.
pub struct Random(pub u64);

impl Random {
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Uniform in [0, 1).
    pub fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1_u64 << 53) as f64
    }

    pub fn below(&mut self, count: usize) -> usize {
        (self.bits() % count as u64) as usize
    }

    /// Uniform in the cube from -1 to 1.
    pub fn cube(&mut self) -> DVec3 {
        DVec3::new(self.unit(), self.unit(), self.unit()) * 2.0 - 1.0
    }

    pub fn colour(&mut self) -> Rgb {
        Rgb::new(self.unit() as f32, self.unit() as f32, self.unit() as f32)
    }

    /// A turn, a stretch, perhaps a reflection, and a shift.
    pub fn placement(&mut self) -> DAffine3 {
        let turn = DQuat::from_scaled_axis(3.0 * self.cube());
        let mirror = if self.below(3) == 0 { -1.0 } else { 1.0 };
        let scale = DVec3::new(0.2 + 0.3 * self.unit(), mirror * (0.2 + 0.3 * self.unit()), 0.2 + 0.3 * self.unit());
        DAffine3::from_scale_rotation_translation(scale, turn, 2.0 * self.cube())
    }

    /// The same without stretch, as emitting spheres need it.
    pub fn similarity(&mut self) -> DAffine3 {
        let turn = DQuat::from_scaled_axis(3.0 * self.cube());
        DAffine3::from_scale_rotation_translation(DVec3::splat(0.2 + 0.3 * self.unit()), turn, 2.0 * self.cube())
    }
}

/// A wavy sheet of 2 n^2 triangles from (-1, -1, 0) to (1, 1, 0), no two of them in one plane.
pub fn sheet(n: usize, phase: f64, with_uvs: bool) -> MeshDesc {
    let at = |i: usize| 2.0 * i as f64 / n as f64 - 1.0;
    let grid = || (0..=n).flat_map(move |y| (0..=n).map(move |x| (x, y)));
    let height = |x: usize, y: usize| 0.2 * (3.1 * at(x) + phase).sin() * (2.3 * at(y) - phase).cos();
    let corner = |x: usize, y: usize| (y * (n + 1) + x) as u32;
    let cells = (0..n).flat_map(|y| (0..n).map(move |x| (x, y)));
    MeshDesc {
        name: format!("sheet of {n}"),
        path: "meshes".into(),
        positions: grid().map(|(x, y)| DVec3::new(at(x), at(y), height(x, y))).collect(),
        uvs: if with_uvs { grid().map(|(x, y)| [x as f32, y as f32]).collect() } else { Vec::new() },
        triangles: cells
            .flat_map(|(x, y)| {
                let [a, b, c, d] = [corner(x, y), corner(x + 1, y), corner(x + 1, y + 1), corner(x, y + 1)];
                [[a, b, c], [a, c, d]]
            })
            .collect(),
        ..MeshDesc::default()
    }
}

/// Memory of a host: vertices of twenty bytes, indices of sixteen.
pub struct HostMemory {
    vertices: Vec<[f32; 5]>,
    triangles: Vec<[u32; 4]>,
    normals: Vec<[f32; 3]>,
}

/// A mesh as a host would have it, its memory read in place. `normals` are of any length.
pub fn hosted(mesh: &MeshDesc, with_normals: bool) -> (MeshDesc, Arc<HostMemory>) {
    let vertices = mesh.positions.iter().map(|p| [p.x as f32, p.y as f32, p.z as f32, f32::NAN, f32::NAN]).collect();
    let triangles = mesh.triangles.iter().map(|&[a, b, c]| [a, b, c, u32::MAX]).collect();
    let normals = mesh.positions.iter().map(|p| [p.x as f32, p.y as f32, 3.0]).collect();
    let memory = Arc::new(HostMemory { vertices, triangles, normals });
    let owner = || Arc::clone(&memory) as Arc<dyn Any + Send + Sync>;
    // SAFETY: the vectors are never changed and live as long as the owner; the last vertex is followed by eight bytes.
    let host = unsafe {
        HostMesh {
            positions: Buffer::foreign(memory.vertices.as_ptr().cast(), memory.vertices.len(), 20, owner()).unwrap(),
            triangles: Buffer::foreign(memory.triangles.as_ptr().cast(), memory.triangles.len(), 16, owner()).unwrap(),
            normals: with_normals
                .then(|| Buffer::foreign(memory.normals.as_ptr(), memory.normals.len(), 12, owner()).unwrap()),
            uvs: None,
        }
    };
    (MeshDesc { name: "host's".into(), path: "host".into(), host: Some(host), ..MeshDesc::default() }, memory)
}

pub fn surface(desc: &SceneDesc, shape: ShapeDesc, transform: DAffine3, emission: Option<Rgb>) -> SurfaceDesc {
    let number = desc.surfaces.len();
    SurfaceDesc {
        path: format!("surfaces[{number}]"),
        name: String::new(),
        shape,
        local: DAffine3::from_translation(DVec3::new(0.125, 0.0, 0.0)),
        transform,
        material: Some(number % desc.materials.len()),
        emission,
        emits_both: false,
        web: None,
        spectrum: None,
        hidden: false,
    }
}

fn material(number: usize, bsdf: BsdfDesc) -> MaterialDesc {
    MaterialDesc { name: format!("{number}"), path: format!("materials[{number}]"), bsdf, ..MaterialDesc::default() }
}

/// Everything but what a test is about: a camera, materials, a light, a lamp.
pub fn studio(random: &mut Random) -> SceneDesc {
    let mut desc = SceneDesc {
        camera: CameraDesc::Perspective {
            eye: DVec3::new(0.5, 1.0, 6.0),
            look_at: DVec3::ZERO,
            up: DVec3::Y,
            fov_deg: 60.0,
            fov_axis: FovAxis::Horizontal,
            film: FilmDesc::default(),
        },
        ..SceneDesc::default()
    };
    for number in 0..4 {
        desc.materials.push(material(number, BsdfDesc::Lambert { albedo: 0.8 * random.colour() }));
    }
    desc.materials.push(material(4, BsdfDesc::Mirror { reflectance: Rgb::splat(0.9) }));
    let position = DVec3::new(1.0, 5.0, 2.0);
    desc.lights.push(PointLightDesc { path: "lights[0]".into(), ..PointLightDesc::even(position, Rgb::splat(9.0)) });
    let lamp = [[-1.0, 4.0, -1.0], [1.0, 4.0, -1.0], [1.0, 4.0, 1.0], [-1.0, 4.0, 1.0]].map(DVec3::from_array);
    let lamp = surface(&desc, ShapeDesc::Quad(lamp), DAffine3::IDENTITY, Some(Rgb::splat(4.0)));
    desc.surfaces.push(lamp);
    let leaf = [[-3.0, -3.0, -4.0], [3.0, -3.0, -4.0], [0.0, 3.0, -4.5]].map(DVec3::from_array);
    let leaf = surface(&desc, ShapeDesc::Triangle(leaf), DAffine3::IDENTITY, None);
    desc.surfaces.push(leaf);
    desc
}

fn add_mesh(desc: &mut SceneDesc, mesh: MeshDesc) -> usize {
    desc.meshes.push(Arc::new(mesh));
    desc.meshes.len() - 1
}

/// Scenes that between them hold every kind of geometry.
pub fn scenes() -> Vec<(&'static str, SceneDesc)> {
    let room = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/room.json");
    let room = desc::load(&room, None).expect("the room");

    let mut random = Random(11);
    let mut meshes = studio(&mut random);
    for (n, smooth, emits) in [(24, false, false), (20, true, false), (3, false, false), (12, false, true)] {
        let mesh = add_mesh(&mut meshes, sheet(n, n as f64, n == 20));
        let emission = emits.then(|| random.colour());
        let new = surface(&meshes, ShapeDesc::Mesh { mesh, smooth }, random.placement(), emission);
        meshes.surfaces.push(new);
    }
    // With triangles that have no area, of the first and of the last.
    let mut torn = sheet(10, 0.5, true);
    for index in [0, 77, 199] {
        torn.triangles[index] = [5, 5, 9];
    }
    let mesh = add_mesh(&mut meshes, torn);
    let new = surface(&meshes, ShapeDesc::Mesh { mesh, smooth: true }, random.placement(), None);
    meshes.surfaces.push(new);

    let mut random = Random(12);
    let mut instances = studio(&mut random);
    // More than the ten thousand from which a static scene makes instances.
    let mesh = add_mesh(&mut instances, sheet(72, 1.0, false));
    for _ in 0..5 {
        let new = surface(&instances, ShapeDesc::Mesh { mesh, smooth: false }, random.placement(), None);
        instances.surfaces.push(new);
    }

    let mut random = Random(13);
    let mut spheres = studio(&mut random);
    for number in 0..20 {
        let shape = ShapeDesc::Sphere { centre: random.cube(), radius: 0.5 };
        let emission = (number % 7 == 0).then(|| random.colour());
        let new = surface(&spheres, shape, random.similarity(), emission);
        spheres.surfaces.push(new);
    }
    let mesh = add_mesh(&mut spheres, sheet(16, 0.0, false));
    let new = surface(&spheres, ShapeDesc::Mesh { mesh, smooth: true }, random.placement(), None);
    spheres.surfaces.push(new);

    let mut random = Random(14);
    let mut host = studio(&mut random);
    for (with_normals, smooth, emits) in
        [(true, true, false), (false, true, false), (false, false, false), (true, true, true)]
    {
        let mesh = add_mesh(&mut host, hosted(&sheet(18, 2.0, false), with_normals).0);
        let emission = emits.then(|| random.colour());
        let new = surface(&host, ShapeDesc::Mesh { mesh, smooth }, random.placement(), emission);
        host.surfaces.push(new);
    }

    // More single surfaces than are built together with all others.
    let mut random = Random(15);
    let mut singles = studio(&mut random);
    for number in 0..1300 {
        let at = random.cube();
        let corner = |random: &mut Random| at + 0.2 * random.cube();
        let corners = [corner(&mut random), corner(&mut random), corner(&mut random)];
        let shape = if number % 100 == 0 {
            ShapeDesc::Quad([corners[0], corners[1], corners[1] + corners[2] - corners[0], corners[2]])
        } else {
            ShapeDesc::Triangle(corners)
        };
        let emission = (number == 500).then(|| random.colour());
        let new = surface(&singles, shape, random.placement(), emission);
        singles.surfaces.push(new);
        let shape = ShapeDesc::Sphere { centre: random.cube(), radius: 0.05 };
        let emission = (number == 600).then(|| random.colour());
        let new = surface(&singles, shape, random.similarity(), emission);
        singles.surfaces.push(new);
    }
    let mesh = add_mesh(&mut singles, sheet(16, 0.0, false));
    for _ in 0..2 {
        let new = surface(&singles, ShapeDesc::Mesh { mesh, smooth: true }, random.placement(), None);
        singles.surfaces.push(new);
    }
    vec![
        ("room", room),
        ("meshes", meshes),
        ("instances", instances),
        ("spheres", spheres),
        ("host", host),
        ("singles", singles),
    ]
}

/// A change to a description.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Edit {
    MaterialParameters,
    MaterialIndex,
    EmissionColour,
    EmissionToggled,
    Light,
    LightAdded,
    CameraTurned,
    CameraMoved,
    Transform,
    Local,
    Hidden,
    ShapeParameters,
    Smooth,
    MeshReplaced,
    MeshAdded,
    UseAdded,
    Removed,
    Motion,
    MaterialAdded,
    MaterialTaken,
    MaterialEmits,
    BothSides,
}

pub const EDITS: [Edit; 22] = [
    Edit::MaterialParameters,
    Edit::MaterialIndex,
    Edit::EmissionColour,
    Edit::EmissionToggled,
    Edit::Light,
    Edit::LightAdded,
    Edit::CameraTurned,
    Edit::CameraMoved,
    Edit::Transform,
    Edit::Local,
    Edit::Hidden,
    Edit::ShapeParameters,
    Edit::Smooth,
    Edit::MeshReplaced,
    Edit::MeshAdded,
    Edit::UseAdded,
    Edit::Removed,
    Edit::Motion,
    Edit::MaterialAdded,
    Edit::MaterialTaken,
    Edit::MaterialEmits,
    Edit::BothSides,
];

impl Edit {
    /// Applies it somewhere; does nothing where the scene holds nothing of the kind.
    pub fn apply(self, desc: &mut SceneDesc, random: &mut Random) {
        let number = random.below(desc.surfaces.len());
        let is_sphere = matches!(desc.surfaces[number].shape, ShapeDesc::Sphere { .. });
        let place = if is_sphere { random.similarity() } else { random.placement() };
        let meshes: Vec<usize> = (0..desc.surfaces.len())
            .filter(|&number| matches!(desc.surfaces[number].shape, ShapeDesc::Mesh { .. }))
            .collect();
        let one_mesh = (!meshes.is_empty()).then(|| meshes[random.below(meshes.len().max(1))]);
        match self {
            Self::MaterialParameters => {
                let number = random.below(desc.materials.len());
                desc.materials[number].bsdf = BsdfDesc::Lambert { albedo: random.colour() };
            }
            Self::MaterialIndex => desc.surfaces[number].material = Some(random.below(desc.materials.len())),
            Self::EmissionColour => {
                for surface in &mut desc.surfaces {
                    surface.emission = surface.emission.map(|_| 3.0 * random.colour());
                }
            }
            Self::EmissionToggled => {
                let surface = &mut desc.surfaces[number];
                if !matches!(surface.shape, ShapeDesc::Quadric { .. } | ShapeDesc::Disk { .. }) {
                    surface.emission = if surface.emission.is_some() { None } else { Some(random.colour()) };
                }
            }
            Self::Light => {
                for light in &mut desc.lights {
                    light.intensity = 9.0 * random.colour();
                    light.position += 0.1 * random.cube();
                    let direction = random.cube();
                    let outer_deg = 30.0 + 60.0 * random.unit();
                    light.distribution = if random.unit() < 0.5 {
                        LightDistribution::Spot(SpotDesc { outer_deg, inner_deg: 20.0, direction })
                    } else {
                        LightDistribution::Even
                    };
                }
            }
            Self::LightAdded => {
                let position = 2.0 * random.cube();
                let intensity = random.colour();
                desc.lights.push(PointLightDesc { path: "lights".into(), ..PointLightDesc::even(position, intensity) });
            }
            Self::CameraTurned | Self::CameraMoved => {
                let by = random.cube();
                let is_plane = matches!(desc.camera, CameraDesc::ViewPlane { .. });
                let [origin, look_at, _] = desc.camera.view_mut();
                if self == Self::CameraTurned {
                    *look_at += 0.2 * by;
                } else {
                    *origin += if is_plane { 0.2 } else { 0.5 } * by;
                }
            }
            Self::Transform => desc.surfaces[number].transform = place,
            Self::Local => desc.surfaces[number].local = DAffine3::from_translation(0.3 * random.cube()),
            Self::Hidden => desc.surfaces[number].hidden ^= true,
            Self::ShapeParameters => match &mut desc.surfaces[number].shape {
                ShapeDesc::Sphere { radius, .. } => *radius *= 0.5 + random.unit(),
                ShapeDesc::Triangle(corners) => corners[0] += 0.2 * random.cube(),
                ShapeDesc::Quad(corners) => {
                    let by = random.cube();
                    corners.iter_mut().for_each(|corner| *corner += 0.2 * by);
                }
                ShapeDesc::Disk { radius, .. } => *radius *= 0.5 + random.unit(),
                ShapeDesc::Mesh { .. } | ShapeDesc::Quadric { .. } => {}
            },
            Self::Smooth => {
                if let Some(number) = one_mesh
                    && let ShapeDesc::Mesh { smooth, .. } = &mut desc.surfaces[number].shape
                {
                    *smooth ^= true;
                }
            }
            Self::MeshReplaced => {
                if !desc.meshes.is_empty() {
                    let number = random.below(desc.meshes.len());
                    let mesh = Arc::make_mut(&mut desc.meshes[number]);
                    if mesh.host.is_some() {
                        *mesh = hosted(&sheet(14, random.unit(), false), true).0;
                    } else {
                        mesh.positions.iter_mut().for_each(|p| p.z = 0.7 * p.z + 0.1);
                    }
                }
            }
            Self::MeshAdded => {
                let sizes = [2, 9, 20];
                let mesh = add_mesh(desc, sheet(sizes[random.below(3)], random.unit(), random.below(2) == 0));
                let shape = ShapeDesc::Mesh { mesh, smooth: random.below(2) == 0 };
                let new = surface(desc, shape, random.placement(), None);
                desc.surfaces.push(new);
            }
            Self::UseAdded => {
                if let Some(number) = one_mesh {
                    let new = surface(desc, desc.surfaces[number].shape, random.placement(), None);
                    desc.surfaces.push(new);
                }
            }
            Self::Removed => {
                if desc.surfaces.len() > 3 {
                    desc.surfaces.remove(number);
                    // The surfaces after it have other numbers.
                    desc.motion.surfaces.split_off(&number);
                }
            }
            Self::MaterialAdded => {
                let added = desc.materials.len();
                desc.materials.push(material(added, BsdfDesc::Lambert { albedo: random.colour() }));
                desc.surfaces[number].material = Some(added);
            }
            Self::MaterialTaken => desc.surfaces[number].material = None,
            Self::MaterialEmits => {
                let number = random.below(desc.materials.len());
                let users = || desc.surfaces.iter().filter(|it| !it.hidden && it.material == Some(number));
                let can_emit =
                    |it: &SurfaceDesc| !matches!(it.shape, ShapeDesc::Quadric { .. } | ShapeDesc::Disk { .. });
                if users().all(can_emit) && users().count() < 10 {
                    let material = &mut desc.materials[number];
                    material.emission = if material.emission.is_some() { None } else { Some(random.colour()) };
                }
            }
            Self::BothSides => {
                if !is_sphere {
                    desc.surfaces[number].emits_both ^= true;
                }
            }
            // A shift that lasts as long as the shutter is open, or is over before.
            Self::Motion => {
                let close = random.below(3).min(1) as f64;
                desc.motion.shutter = ShutterDesc { open: 0.0, close, curve: Vec::new() };
                let key = |time, by| MotionKey { time, place: KeyPlace::Matrix(DAffine3::from_translation(by)) };
                let keys = vec![key(-1.0, DVec3::ZERO), key(1.0, 0.2 * random.cube())];
                let can_move =
                    !matches!(desc.surfaces[number].shape, ShapeDesc::Quadric { .. } | ShapeDesc::Disk { .. });
                if desc.motion.surfaces.remove(&number).is_none() && can_move {
                    desc.motion.surfaces.insert(number, Arc::new(MotionDesc { keys }));
                }
            }
        }
    }
}
