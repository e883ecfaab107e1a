//! Finds the surfaces that make caustics, and their positions, at which photons for caustics are aimed: those with delta lobes, and
//! those with lobes so narrow that they count as delta lobes.

use super::geometry::Geometry;
use super::interaction::{Owner, Owners};
use super::{Material, Scene};
use crate::bsdf::Lobes;
use crate::math::{Bounds, DVec3, Vec3};
use crate::shape::Analytic;

/// A ball in the scene frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ball {
    /// Centre.
    pub centre: Vec3,
    /// Radius.
    pub radius: f32,
}

/// A specular surface at which photons can be aimed, in the scene frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SpecularPart {
    /// A ball that is the surface, or a ball that contains the surface.
    Ball(Ball),
    /// A triangle.
    Triangle([Vec3; 3]),
}

/// Factor by which a box's ball is enlarged to cover the rounding to single precision.
const MARGIN: f64 = 1.0 + 1e-5;

/// A specular surface: its box, and its exact shape where photons can be aimed at the shape.
struct Piece {
    bounds: Bounds,
    exact: Option<Exact>,
}

#[derive(Clone, Copy)]
enum Exact {
    Ball(DVec3, f64),
    Triangle([DVec3; 3]),
}

impl Scene {
    /// The owners of all surfaces, several times where a surface has several primitives.
    fn owners(&self) -> impl Iterator<Item = &Owner> {
        let in_embree = self.bindings.owners.iter().flat_map(|owners| match owners {
            Owners::One(owner) => std::slice::from_ref(owner),
            Owners::Each(owners) => owners,
        });
        self.bindings.list_owners.iter().chain(in_embree)
    }

    /// All lobes of all surfaces of the scene.
    pub fn lobes(&self) -> Lobes {
        self.owners().fold(Lobes::empty(), |lobes, owner| lobes | self.material(owner.material).lobes())
    }

    /// Whether some surface has delta lobes, or glossy lobes below this width.
    pub(crate) fn has_narrow(&self, narrow_below: f32) -> bool {
        self.has_material(|material| material.is_narrow(narrow_below))
    }

    /// Whether some surface has glossy lobes below this width.
    pub(crate) fn has_narrow_glossy(&self, narrow_below: f32) -> bool {
        self.has_material(|material| material.is_narrow_glossy(narrow_below))
    }

    fn has_material(&self, is_such: impl Fn(&Material) -> bool) -> bool {
        let such: Vec<bool> = self.materials.iter().map(is_such).collect();
        such.contains(&true) && self.owners().any(|owner| such[owner.material as usize])
    }

    /// Returns the number of the first surface that has one of these lobes.
    pub fn surface_with(&self, lobes: Lobes) -> Option<u32> {
        let of = |owner: &Owner| self.material(owner.material).lobes().intersects(lobes).then_some(owner.surface);
        self.owners().filter_map(of).min()
    }

    /// Returns the number of the first surface with diffuse lobes that textures vary.
    pub fn textured_diffuse_surface(&self) -> Option<u32> {
        let of = |owner: &Owner| self.material(owner.material).is_textured_diffuse().then_some(owner.surface);
        self.owners().filter_map(of).min()
    }

    /// Returns at most `most` (>= 1) parts that together contain every surface with delta lobes or with glossy lobes below this width.
    /// Spheres and loose triangles are parts themselves if there are few pieces; otherwise each part is a ball around several pieces.
    pub fn specular_parts(&self, narrow_below: f32, most: usize) -> Vec<SpecularPart> {
        let pieces = self.specular_pieces(narrow_below);
        let is_few = pieces.len() <= most && pieces.iter().all(|piece| piece.exact.is_some());
        if !is_few {
            return self.specular_balls(narrow_below, most).into_iter().map(SpecularPart::Ball).collect();
        }
        let part = |piece: &Piece| {
            Some(match piece.exact? {
                Exact::Ball(centre, radius) => SpecularPart::Ball(ball(centre, radius)),
                Exact::Triangle(corners) => SpecularPart::Triangle(corners.map(|corner| corner.as_vec3a())),
            })
        };
        pieces.iter().filter_map(part).collect()
    }

    /// Returns at most `most` (>= 1) balls that together contain every surface with delta lobes or with glossy lobes below this width,
    /// wherever it is while the shutter is open.
    pub fn specular_balls(&self, narrow_below: f32, most: usize) -> Vec<Ball> {
        let mut pieces = self.specular_pieces(narrow_below);
        let mut groups: Vec<&mut [Piece]> = Vec::new();
        if !pieces.is_empty() {
            groups.push(&mut pieces);
        }
        // The group with the largest extent is halved along the axis on which the middles of its pieces are spread
        // most.
        while groups.len() < most {
            let widest = (0..groups.len()).filter(|&i| groups[i].len() > 1);
            let size = |i: &usize| extent(union(groups[*i])).length();
            let Some(widest) = widest.max_by(|a, b| size(a).total_cmp(&size(b))) else { break };
            let group = groups.swap_remove(widest);
            let middles = Bounds::around(group.iter().map(|piece| piece.bounds.centre()));
            let spread = extent(middles);
            let axis = if spread.x >= spread.y && spread.x >= spread.z {
                0
            } else if spread.y >= spread.z {
                1
            } else {
                2
            };
            let half = group.len() / 2;
            let middle = |piece: &Piece| piece.bounds.centre()[axis];
            group.select_nth_unstable_by(half, |a, b| middle(a).total_cmp(&middle(b)));
            let (low, high) = group.split_at_mut(half);
            groups.push(low);
            groups.push(high);
        }
        groups
            .into_iter()
            .map(|group| {
                let (centre, radius) = match group {
                    [Piece { exact: Some(Exact::Ball(centre, radius)), .. }] => (*centre, *radius),
                    _ => {
                        let bounds = union(group);
                        (bounds.centre(), 0.5 * extent(bounds).length())
                    }
                };
                ball(centre, radius)
            })
            .collect()
    }

    fn specular_pieces(&self, narrow_below: f32) -> Vec<Piece> {
        let such: Vec<bool> = self.materials.iter().map(|material| material.is_narrow(narrow_below)).collect();
        let is_specular = |owner: Owner| such[owner.material as usize];
        let analytic = |shape: &Analytic| {
            let exact = match shape {
                Analytic::Sphere(sphere) => Some(Exact::Ball(sphere.centre, sphere.radius)),
                _ => None,
            };
            Piece { bounds: shape.bounds(), exact }
        };
        let mut pieces = Vec::new();
        for (shape, owner) in self.list.shapes().iter().zip(&*self.bindings.list_owners) {
            if is_specular(*owner) {
                pieces.push(analytic(shape));
            }
        }
        for (geometry, owners) in self.geometries.iter().zip(&*self.bindings.owners) {
            match geometry {
                Geometry::Loose { triangles, .. } => {
                    for primitive in 0..triangles.mesh.indices().len() as u32 {
                        if is_specular(owners.of(primitive)) {
                            let corners = triangles.corners(primitive, 0.0);
                            let exact = Some(Exact::Triangle(corners));
                            pieces.push(Piece { bounds: Bounds::around(corners), exact });
                        }
                    }
                }
                Geometry::Flat { triangles, .. } | Geometry::Instance { triangles, .. }
                    if is_specular(owners.of(0)) =>
                {
                    // Between its steps every point goes along a straight line, and stays in the boxes around both.
                    let steps = (0..triangles.mesh.time_steps()).map(|step| {
                        let vertices = triangles.mesh.vertices_at_step(step);
                        Bounds::around((0..vertices.len()).map(|i| DVec3::from(vertices.get(i).map(f64::from))))
                    });
                    let bounds = steps.fold(Bounds::EMPTY, |all, one| all.union(one));
                    let bounds = match geometry {
                        Geometry::Instance { instance_path, .. } => instance_path.bounds(&bounds),
                        _ => bounds,
                    };
                    pieces.push(Piece { bounds, exact: None });
                }
                Geometry::Analytic { shapes, .. } => {
                    for (primitive, shape) in shapes.start.iter().enumerate() {
                        if is_specular(owners.of(primitive as u32)) {
                            pieces.push(shapes.moving.get(primitive).map_or_else(
                                || analytic(shape),
                                |moving| Piece { bounds: moving.bounds(), exact: None },
                            ));
                        }
                    }
                }
                Geometry::Flat { .. } | Geometry::Instance { .. } => {}
            }
        }
        pieces
    }
}

/// Rounds a ball to single precision without making it smaller.
fn ball(centre: DVec3, radius: f64) -> Ball {
    let rounding = centre.abs().max_element() * f64::from(f32::EPSILON);
    Ball { centre: centre.as_vec3a(), radius: (radius * MARGIN + 2.0 * rounding) as f32 }
}

fn union(group: &[Piece]) -> Bounds {
    group.iter().fold(Bounds::default(), |bounds, piece| bounds.union(piece.bounds))
}

fn extent(bounds: Bounds) -> DVec3 {
    if bounds.is_empty() { DVec3::ZERO } else { bounds.max - bounds.min }
}
