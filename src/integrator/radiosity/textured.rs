//! Albedos and emissions of elements where textures vary them.

use std::f64::consts::PI;
use std::sync::Arc;

use super::albedo::mean_albedos_by;
use super::elements::Patch;
use crate::bsdf::Bsdf;
use crate::emitter::{Emitter, PartRadiance};
use crate::math::DVec3;
use crate::scene::{Face, Facet, Scene};
use crate::texture::TextureLight;

/// Points of an element whose albedos are averaged.
const POINTS: u32 = 64;

/// Angles by which the albedo of a surface that is not Lambertian is integrated at one point.
pub(super) const STEPS: u32 = 64;

/// Where the radiance of an element differs by more than this share of its patch's mean, in the mean, the element is divided.
const UNEVEN: f64 = 0.02;

/// The mean albedo and emission of every element of a scene in which textures vary diffuse surfaces or lamps.
#[derive(Debug)]
pub(super) struct ElementTextures {
    scene: Scene,
    /// Textures of lamps, each with the means of its light.
    lights: Vec<TextureLight>,
    patches: Vec<PatchTextures>,
    /// Of each node. Those of clusters are not read.
    nodes: Vec<NodeMeans>,
}

/// What textures vary on a patch.
#[derive(Debug)]
struct PatchTextures {
    /// The face that the patch is on and its corners; `None` where its albedo is the same everywhere.
    reflecting: Option<(Facet, [DVec3; 3])>,
    /// The numbers of the emitter and of its texture among `lights`; `None` where its emission is the same everywhere.
    lamp: Option<(u32, usize)>,
}

/// Means over an element.
#[derive(Clone, Copy, Debug, Default)]
struct NodeMeans {
    albedo: DVec3,
    /// Emitted radiosity [W m^-2].
    emitted: DVec3,
    is_uneven_lamp: bool,
}

impl ElementTextures {
    /// `None` where textures vary neither diffuse surfaces nor lamps.
    pub fn new(scene: &Scene) -> Option<Self> {
        let has_textures = scene.textured_diffuse_surface().is_some() || scene.emitters().has_textured();
        let none = || Self { scene: scene.clone(), lights: Vec::new(), patches: Vec::new(), nodes: Vec::new() };
        has_textures.then(none)
    }

    /// Adds what varies on the next patch, which is on a side of a face that has the emitter `lamp`; `facet` is the part of the face that
    /// it is.
    pub fn add_patch(&mut self, face: &Face, lamp: Option<u32>, facet: &Facet, corners: [DVec3; 3]) {
        let reflects = self.scene.material(face.material).is_textured_diffuse();
        let lamp = lamp.and_then(|number| Some((number, self.light_of(number)?)));
        self.patches.push(PatchTextures { reflecting: reflects.then_some((*facet, corners)), lamp });
    }

    /// The number of an emitter's texture among `lights`, where it has one.
    fn light_of(&mut self, emitter: u32) -> Option<usize> {
        let texture = self.emitter(emitter).texture()?.clone();
        let known = self.lights.iter().position(|light| Arc::ptr_eq(light.texture(), &texture));
        Some(known.unwrap_or_else(|| {
            self.lights.push(TextureLight::new(texture, self.scene.device().threads()));
            self.lights.len() - 1
        }))
    }

    fn emitter(&self, number: u32) -> &Emitter {
        &self.scene.emitters().emitters()[number as usize]
    }

    /// The albedo of a node.
    pub fn albedo(&self, node: u32) -> DVec3 {
        self.nodes[node as usize].albedo
    }

    /// The radiosity [W m^-2] that a node emits.
    pub fn emitted(&self, node: u32) -> DVec3 {
        self.nodes[node as usize].emitted
    }

    /// Whether a texture varies anything on a patch.
    pub fn varies(&self, patch: u32) -> bool {
        let textures = &self.patches[patch as usize];
        textures.reflecting.is_some() || textures.lamp.is_some()
    }

    /// Whether the emission varies much over an element.
    pub fn is_uneven_lamp(&self, node: u32) -> bool {
        self.nodes[node as usize].is_uneven_lamp
    }

    /// Adds the means of the next node: `element` has the patch, its number and the corners of an element, and is `None` for a cluster.
    pub fn add_node(&mut self, element: Option<(&Patch, u32, [DVec3; 3])>) {
        let means = element.map_or_else(NodeMeans::default, |(patch, number, corners)| {
            let textures = &self.patches[number as usize];
            let albedo = match textures.reflecting {
                Some((facet, whole)) => self.mean_albedo(&facet, &whole, &corners, patch),
                None => patch.albedo,
            };
            let Some((emitter, light)) = textures.lamp else {
                return NodeMeans { albedo, emitted: patch.emitted, is_uneven_lamp: false };
            };
            let PartRadiance { mean, deviation } = self.emitter(emitter).part_radiance(&corners, &self.lights[light]);
            let is_uneven_lamp = PI * deviation > UNEVEN * patch.emitted.max_element();
            NodeMeans { albedo, emitted: PI * mean, is_uneven_lamp }
        });
        self.nodes.push(means);
    }

    /// Memory, bytes.
    pub fn bytes(&self) -> usize {
        let lights: usize = self.lights.iter().map(TextureLight::bytes).sum();
        size_of_val(&*self.patches) + size_of_val(&*self.nodes) + lights
    }

    fn mean_albedo(&self, facet: &Facet, whole: &[DVec3; 3], corners: &[DVec3; 3], patch: &Patch) -> DVec3 {
        let [a, b, c] = *corners;
        // Another part of an even sequence for each element, so that no pattern of a texture agrees with that of the points (Roberts
        // 2018).
        let plastic = 1.324_717_957_244_746_f64;
        let middle = (a + b + c).to_array().map(f64::to_bits);
        let seed = middle
            .into_iter()
            .fold(0_u64, |seed, bits| (seed ^ bits).wrapping_mul(0x9e37_79b9_7f4a_7c15).rotate_left(29));
        let start = [(seed >> 32) as f64, (seed & 0xffff_ffff) as f64].map(|bits| bits / 4_294_967_296.0);
        let mut sum = DVec3::ZERO;
        for i in 1..=POINTS {
            let i = f64::from(i);
            let [mut s, mut t] = [(start[0] + i / plastic).fract(), (start[1] + i / (plastic * plastic)).fract()];
            if s + t > 1.0 {
                (s, t) = (1.0 - s, 1.0 - t);
            }
            sum += self.at(facet, whole, (1.0 - s - t) * a + s * b + t * c, patch.is_front);
        }
        sum / f64::from(POINTS)
    }

    /// The albedo at a point.
    fn at(&self, facet: &Facet, [a, b, c]: &[DVec3; 3], p: DVec3, is_front: bool) -> DVec3 {
        let (side, other, to) = (*b - *a, *c - *a, p - *a);
        let (ss, so, oo) = (side.length_squared(), side.dot(other), other.length_squared());
        let determinant = ss * oo - so * so;
        let s = (oo * to.dot(side) - so * to.dot(other)) / determinant;
        let t = (ss * to.dot(other) - so * to.dot(side)) / determinant;
        let [s, t] = [s, t].map(|x| if x.is_finite() { x.clamp(0.0, 1.0) as f32 } else { 0.0 });
        let point = self.scene.facet_point(facet, s, t);
        let mut slot = None;
        let detail = |_| self.scene.detail(&facet.hit(s, t), &point);
        let (bsdf, _): (&Bsdf, _) = self.scene.material(point.material).at(detail, &(), &mut slot);
        mean_albedos_by(bsdf, STEPS)[usize::from(!is_front)]
    }
}

#[cfg(test)]
mod tests {
    use serde_json::{Value, json};

    use super::super::elements::Elements;
    use super::super::refine::LinkHierarchy;
    use super::*;
    use crate::desc;
    use crate::scene::BuildOptions;

    /// The elements of a lamp with this texture.
    fn lamp(geometry: &Value, texture: &Value) -> (Scene, Elements) {
        let mut surface = json!({"material": "lamp", "transform": {"rotate": [20, 50, 10]}});
        surface.as_object_mut().unwrap().extend(geometry.as_object().unwrap().clone());
        let mut described = json!({"name": "shines"});
        described.as_object_mut().unwrap().extend(texture.as_object().unwrap().clone());
        let scene = json!({
            "etendue": 1, "camera": {"origin": [0, 0, 4], "lookAt": [0, 0, 0]}, "textures": [described],
            "materials": [{"name": "lamp", "type": "diffuse", "color": [0.5, 0.5, 0.5], "emission": [3, 2, 1],
                "textures": {"emission": "shines"}}],
            "surfaces": [surface],
        });
        let desc = desc::parse(&scene.to_string(), "".as_ref(), None).unwrap();
        let scene = Scene::build(&desc, &BuildOptions::default()).unwrap();
        let elements = Elements::new(&scene, Some(0.05), 1 << 30).unwrap();
        let mut hierarchy = LinkHierarchy::new(&scene, elements).unwrap();
        hierarchy.divide_lamps(|| Ok(())).unwrap();
        let elements = hierarchy.oracle.elements;
        (scene, elements)
    }

    #[test]
    fn elements_emit_the_power_of_their_lamp() {
        let quad = json!({"geometry": "quad", "vertex-1": [-1, -1, 0], "vertex-2": [1, -1, 0], "vertex-3": [1, 1, 0],
            "vertex-4": [-1, 1, 0]});
        let ball = json!({"geometry": "sphere", "origin": [0.3, 0.1, 0], "radius": 0.7});
        let textures = [
            json!({"type": "checker", "scale": [6, 4]}),
            json!({"type": "gradient", "colors": [[1, 0, 0], [0, 0.5, 1]]}),
            json!({"type": "noise", "coordinates": "space", "scale": [2, 2, 2]}),
        ];
        for geometry in [&quad, &ball] {
            for texture in &textures {
                let (scene, elements) = lamp(geometry, texture);
                let roots = elements.patches.len();
                let leaves = elements.nodes.iter().zip(0..).filter(|(node, _)| node.is_leaf() && !node.is_cluster());
                let leaves: Vec<_> = leaves.collect();
                assert!(leaves.len() > 2 * roots, "{} elements of {roots} patches, {texture}", leaves.len());
                let emitted: DVec3 = leaves.iter().map(|(node, number)| node.area * elements.emitted(*number)).sum();
                let power: DVec3 = scene.emitters().emitters().iter().map(Emitter::power).sum();
                let off = (emitted / power - DVec3::ONE).abs().max_element();
                assert!(off < 3e-3, "{emitted} and not {power}, {texture}, {geometry}");
            }
        }
    }
}
