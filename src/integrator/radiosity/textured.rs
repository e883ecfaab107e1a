//! Albedos of elements where textures vary them.

use super::elements::{Patch, mean_albedos_by};
use crate::bsdf::Bsdf;
use crate::math::DVec3;
use crate::scene::{Facet, Scene};

/// Points of an element whose albedos are averaged.
const POINTS: u32 = 64;

/// Angles by which the albedo of a surface that is not Lambertian is integrated at one point.
pub(super) const STEPS: u32 = 64;

/// The mean albedo of every element of a scene in which textures vary diffuse surfaces.
#[derive(Debug)]
pub(super) struct ElementAlbedos {
    scene: Scene,
    /// Of each patch, the face that it is on and its corners; `None` where its albedo is the same everywhere.
    faces: Vec<Option<(Facet, [DVec3; 3])>>,
    /// Of each node. Those of clusters are not read.
    of_nodes: Vec<DVec3>,
}

impl ElementAlbedos {
    pub fn new(scene: &Scene) -> Self {
        Self { scene: scene.clone(), faces: Vec::new(), of_nodes: Vec::new() }
    }

    /// Adds the face of the next patch.
    pub fn add_patch(&mut self, facet: &Facet, corners: [DVec3; 3], material: u32) {
        self.faces.push(self.scene.material(material).is_textured_diffuse().then_some((*facet, corners)));
    }

    /// The albedo of a node.
    pub fn of(&self, node: u32) -> DVec3 {
        self.of_nodes[node as usize]
    }

    /// Adds the albedo of the next node: `element` has the patch, its number and the corners of an element, and is `None` for a cluster.
    pub fn add_node(&mut self, element: Option<(&Patch, u32, [DVec3; 3])>) {
        let albedo = element.map_or(DVec3::ZERO, |(patch, number, corners)| match self.faces[number as usize] {
            Some((facet, whole)) => self.mean(&facet, &whole, &corners, patch),
            None => patch.albedo,
        });
        self.of_nodes.push(albedo);
    }

    /// Memory, bytes.
    pub fn bytes(&self) -> usize {
        size_of_val(&*self.faces) + size_of_val(&*self.of_nodes)
    }

    fn mean(&self, facet: &Facet, whole: &[DVec3; 3], corners: &[DVec3; 3], patch: &Patch) -> DVec3 {
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
