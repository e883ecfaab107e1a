//! What a scene holds, what was built for it and why.

use std::fmt;
use std::time::Duration;

use crate::math::Bounds;

/// The figures of a built scene; its `Display` is what `etendue info` prints.
#[derive(Clone, Debug, Default)]
pub struct SceneInfo {
    /// Surfaces described.
    pub surfaces: usize,
    /// Materials described.
    pub materials: usize,
    /// Triangles that Embree holds in the scene frame.
    pub triangles: usize,
    /// Instances of shared meshes.
    pub instances: usize,
    /// Triangles of the shared meshes, each counted once.
    pub shared_triangles: usize,
    /// Spheres, disks and quadrics tested in a list before Embree.
    pub listed_shapes: usize,
    /// Spheres, disks and quadrics that Embree holds as user geometry.
    pub embree_shapes: usize,
    /// Emitters that can be sampled.
    pub emitters: usize,
    /// How many of them are points.
    pub point_lights: usize,
    /// Meshes shaded smoothly.
    pub smooth_meshes: usize,
    /// Box around all surfaces, world frame.
    pub bounds: Bounds,
    /// Bytes of vertices, indices and normals.
    pub geometry_bytes: usize,
    /// Bytes that Embree holds for its trees.
    pub embree_bytes: usize,
    /// Time to build all of it.
    pub build_time: Duration,
    /// What was decided, a line each.
    pub decisions: Vec<String>,
    /// What this scene does not need and does not pay for.
    pub switched_off: Vec<&'static str>,
}

impl fmt::Display for SceneInfo {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mebibytes = |bytes: usize| bytes as f64 / (1024.0 * 1024.0);
        writeln!(f, "surfaces        {} of {} materials", self.surfaces, self.materials)?;
        writeln!(f, "triangles       {}", self.triangles)?;
        if self.instances > 0 {
            writeln!(f, "instances       {} of {} shared triangles", self.instances, self.shared_triangles)?;
        }
        writeln!(f, "analytic shapes {}", self.listed_shapes + self.embree_shapes)?;
        writeln!(f, "emitters        {} ({} points)", self.emitters, self.point_lights)?;
        if !self.bounds.is_empty() {
            let (min, max) = (self.bounds.min, self.bounds.max);
            writeln!(f, "bounds          [{}, {}, {}] to [{}, {}, {}]", min.x, min.y, min.z, max.x, max.y, max.z)?;
        }
        writeln!(
            f,
            "memory          {:.2} MiB geometry, {:.2} MiB Embree",
            mebibytes(self.geometry_bytes),
            mebibytes(self.embree_bytes)
        )?;
        writeln!(f, "built in        {:.1} ms", 1e3 * self.build_time.as_secs_f64())?;
        for decision in &self.decisions {
            writeln!(f, "decision        {decision}")?;
        }
        write!(f, "switched off    {}", self.switched_off.join(", "))
    }
}
