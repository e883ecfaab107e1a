//! What the bindings of an edited scene keep of those before, so that an edit costs by what it changes.

use std::sync::Arc;

use super::super::Scene;
use super::super::geometry::Geometry;
use super::super::interaction::{NO_EMITTER, Owner, Owners};
use super::super::record::AppearanceKey;
use super::{BindingBuilder, SurfaceBindings};
use crate::desc::Surfaces;
use crate::emitter::EnvironmentMap;
use crate::error::Result;
use crate::room::{shared, with_room};

/// Number of lamps that are made between two checks for a cancel.
const LAMPS_PER_CHECK: usize = 1024;

/// What the scene before has that the bindings of an edited description can keep.
#[derive(Default)]
pub(in crate::scene) struct Kept<'a> {
    /// The light of the environment.
    pub environment: Option<Arc<EnvironmentMap>>,
    /// The owners of single surfaces.
    pub owners: Option<KeptOwners<'a>>,
}

/// The owners in the scene before.
#[derive(Clone, Copy)]
pub(in crate::scene) struct KeptOwners<'a> {
    geometries: &'a [Geometry],
    owners: &'a [Owners],
    /// The blocks of surfaces with other materials, where there are any; see [`AppearanceKey::reclad`].
    pub reclad: Option<&'a [bool]>,
}

impl<'a> KeptOwners<'a> {
    pub fn new(scene: &'a Scene, reclad: Option<&'a [bool]>) -> Self {
        Self { geometries: &scene.geometries, owners: &scene.bindings.owners, reclad }
    }

    /// Those of a geometry that the scene before has too, if it is one of single surfaces that rest.
    pub fn of(&self, geometry: &Geometry) -> Option<&'a Arc<[Owner]>> {
        // Lamps that move are made by their steps, and not all surfaces may be such lamps.
        match geometry {
            Geometry::Loose { triangles, .. } if !triangles.mesh.is_deforming() => {}
            Geometry::Analytic { shapes, .. } if shapes.moving.is_empty() => {}
            _ => return None,
        }
        let is_same = |old: &Geometry| match (old, geometry) {
            (Geometry::Loose { parts: old, .. }, Geometry::Loose { parts, .. }) => Arc::ptr_eq(old, parts),
            (Geometry::Analytic { surfaces: old, .. }, Geometry::Analytic { surfaces, .. }) => {
                Arc::ptr_eq(old, surfaces)
            }
            _ => false,
        };
        match &self.owners[self.geometries.iter().position(is_same)?] {
            Owners::Each(each) => Some(each),
            Owners::One(_) => None,
        }
    }
}

/// Returns the bindings with the same emitters and the materials of `appearance`, which are others in these blocks of surfaces.
pub(in crate::scene) fn rebind_materials(
    old: &SurfaceBindings,
    appearance: &AppearanceKey,
    reclad: &[bool],
) -> SurfaceBindings {
    let owner = |owner: &Owner| match reclad[Surfaces::place_of(owner.surface as usize)] {
        true => Owner { material: appearance.material(owner.surface), ..*owner },
        false => *owner,
    };
    let owners = old.owners.iter().map(|owners| match owners {
        Owners::One(one) => Owners::One(owner(one)),
        Owners::Each(each) if each.iter().any(|it| owner(it).material != it.material) => {
            Owners::Each(each.iter().map(owner).collect())
        }
        Owners::Each(each) => Owners::Each(Arc::clone(each)),
    });
    SurfaceBindings {
        owners: owners.collect(),
        list_owners: old.list_owners.iter().map(owner).collect(),
        emitters: Arc::clone(&old.emitters),
    }
}

impl BindingBuilder<'_, '_> {
    /// The numbers of surfaces that emit, in order.
    pub(super) fn lamps(&self) -> Vec<u32> {
        let may_emit = self.desc.surfaces.of_blocks(|facts| facts.emits).map(|(number, _)| number as u32);
        may_emit.filter(|number| self.emission(*number).is_some()).collect()
    }

    /// The owners of single surfaces that had these owners before. Only the lamps among them, and the surfaces of blocks with other
    /// materials, are looked at. `lamps`: [`BindingBuilder::lamps`].
    pub(super) fn edited(
        &mut self,
        geometry: &Geometry,
        before: &Arc<[Owner]>,
        lamps: &[u32],
        reclad: Option<&[bool]>,
    ) -> Result<Owners> {
        // The owners of a surface are neighbours, and the surfaces are in order.
        let of = |&lamp: &u32| {
            let first = before.partition_point(|owner| owner.surface < lamp);
            first..first + before[first..].partition_point(|owner| owner.surface == lamp)
        };
        let lit: Vec<usize> = lamps.iter().flat_map(of).collect();
        if lit.is_empty() && reclad.is_none() && before.iter().all(|owner| owner.emitter == NO_EMITTER) {
            return Ok(Owners::Each(Arc::clone(before)));
        }
        let is_reclad = |surface: u32| reclad.is_some_and(|reclad| reclad[Surfaces::place_of(surface as usize)]);
        let owner = |owner: &Owner| match is_reclad(owner.surface) {
            true => self.owner(owner.surface, NO_EMITTER),
            false => Owner { emitter: NO_EMITTER, ..*owner },
        };
        let mut owners = with_room(before.len())?;
        owners.extend(before.iter().map(owner));
        let emits_both = lit.iter().any(|i| self.emits_both(owners[*i].surface));
        self.make_room(lit.len(), emits_both)?;
        for (count, i) in lit.into_iter().enumerate() {
            if count % LAMPS_PER_CHECK == 0 {
                self.progress.check()?;
            }
            let surface = owners[i].surface;
            let Some(radiance) = self.emission(surface) else { continue };
            owners[i].emitter = match geometry {
                Geometry::Analytic { shapes, .. } => self.emit_shape(&shapes.start[i], None, surface, radiance)?,
                Geometry::Loose { triangles, .. } => {
                    self.emit(geometry, triangles, i, surface, radiance).unwrap_or(NO_EMITTER)
                }
                Geometry::Flat { .. } | Geometry::Instance { .. } => NO_EMITTER,
            };
        }
        Ok(Owners::Each(shared(owners)?))
    }
}
