//! Points at which light is measured: planes with a grid of points, single points with normals, and views of luminance.

use super::json::join;
use super::validate;
use crate::math::DVec3;
use crate::{Error, Result};

/// Most points of one grid.
pub const MAX_GRID_POINTS: u32 = 1 << 20;

/// Points at which one photometric quantity is measured, in the world frame.
#[derive(Clone, Debug, PartialEq)]
pub struct GridDesc {
    /// The name that results are listed under.
    pub name: String,
    /// The points.
    pub points: GridPoints,
}

/// The points of a grid.
#[derive(Clone, Debug, PartialEq)]
pub enum GridPoints {
    /// The middles of the cells of a parallelogram, whose illuminance is measured.
    Plane(PlaneGridDesc),
    /// Single points, whose illuminance is measured.
    Points {
        /// The points.
        points: Vec<DVec3>,
        /// The normals, of any length but 0: one for all points, or one for each.
        normals: Vec<DVec3>,
    },
    /// Views, whose luminance is measured.
    Views {
        /// The points that are looked from.
        points: Vec<DVec3>,
        /// The directions that are looked into, of any length but 0: one for all points, or one for each.
        directions: Vec<DVec3>,
    },
}

/// A parallelogram that is divided into cells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlaneGridDesc {
    /// A corner.
    pub origin: DVec3,
    /// The side along which the first number of a cell grows.
    pub u: DVec3,
    /// The side along which the second number of a cell grows.
    pub v: DVec3,
    /// Numbers of cells along `u` and `v`.
    pub counts: [u32; 2],
    /// The normal, of any length but 0. `None`: that of u x v.
    pub normal: Option<DVec3>,
}

/// Sine of the smallest angle between the sides of a plane.
const PARALLEL: f64 = 1e-6;

/// The unit vector of a direction, whose length is divided out first, so that no length is too small or too large to be squared.
fn scaled(v: DVec3) -> DVec3 {
    (v / v.abs().max_element()).normalize_or_zero()
}

impl PlaneGridDesc {
    /// The unit normal of a plane that has been checked.
    pub fn unit_normal(&self) -> DVec3 {
        self.normal.map_or_else(|| self.across().normalize_or_zero(), scaled)
    }

    /// The cross product of the unit vectors along both sides.
    fn across(&self) -> DVec3 {
        scaled(self.u).cross(scaled(self.v))
    }

    /// The middle of a cell.
    pub fn middle(&self, [i, j]: [u32; 2]) -> DVec3 {
        let [s, t] = [(i, self.counts[0]), (j, self.counts[1])]
            .map(|(number, count)| (f64::from(number) + 0.5) / f64::from(count.max(1)));
        self.origin + s * self.u + t * self.v
    }

    fn check(&self, path: &str) -> Result<()> {
        let at = |key: &str| join(path, key);
        validate::vector(&at("origin"), self.origin)?;
        validate::direction(&at("u"), self.u)?;
        validate::direction(&at("v"), self.v)?;
        validate::vector(path, self.origin + self.u + self.v)?;
        for (axis, count) in self.counts.into_iter().enumerate() {
            if !(1..=MAX_GRID_POINTS).contains(&count) {
                let message = format!("{count} is out of range, expected a whole number from 1 to {MAX_GRID_POINTS}");
                return Err(Error::invalid(format!("{}[{axis}]", at("counts")), message));
            }
        }
        let [columns, rows] = self.counts.map(u64::from);
        check_count(&at("counts"), columns * rows)?;
        match self.normal {
            Some(normal) => validate::direction(&at("normal"), normal).map(|_| ()),
            None if self.across().length() < PARALLEL => {
                let message = format!("{:?} is parallel to `u`, expected a plane, or a `normal`", self.v.to_array());
                Err(Error::invalid(at("v"), message))
            }
            None => Ok(()),
        }
    }
}

fn check_count(path: &str, count: u64) -> Result<()> {
    if count <= u64::from(MAX_GRID_POINTS) {
        return Ok(());
    }
    Err(Error::invalid(path, format!("{count} points are too many, expected {MAX_GRID_POINTS} at most")))
}

impl GridDesc {
    /// Whether luminance is measured, and not illuminance.
    pub fn is_luminance(&self) -> bool {
        matches!(self.points, GridPoints::Views { .. })
    }

    /// The plane, where the grid is one.
    pub fn plane(&self) -> Option<&PlaneGridDesc> {
        match &self.points {
            GridPoints::Plane(plane) => Some(plane),
            GridPoints::Points { .. } | GridPoints::Views { .. } => None,
        }
    }

    /// Checks the numbers; `path` is where messages say that the grid is.
    ///
    /// # Errors
    /// [`crate::ErrorKind::InvalidScene`] below `path`: at `name`, `origin`, `u`, `v`, `counts`, `normal`, `points[..]`,
    /// `normals` or `directions`.
    pub fn check(&self, path: &str) -> Result<()> {
        if self.name.is_empty() || self.name.chars().any(char::is_control) {
            let message = format!("{:?} is no name, expected one or more printable characters", self.name);
            return Err(Error::invalid(join(path, "name"), message));
        }
        let (points, directions, key) = match &self.points {
            GridPoints::Plane(plane) => return plane.check(path),
            GridPoints::Points { points, normals } => (points, normals, "normals"),
            GridPoints::Views { points, directions } => (points, directions, "directions"),
        };
        if points.is_empty() {
            return Err(Error::invalid(join(path, "points"), "is empty, expected one point or more"));
        }
        check_count(&join(path, "points"), points.len() as u64)?;
        for (number, point) in points.iter().enumerate() {
            validate::vector(&format!("{}[{number}]", join(path, "points")), *point)?;
        }
        if directions.len() != 1 && directions.len() != points.len() {
            let message = format!("{} for {} points, expected one, or one for each", directions.len(), points.len());
            return Err(Error::invalid(join(path, key), message));
        }
        for (number, direction) in directions.iter().enumerate() {
            validate::direction(&format!("{}[{number}]", join(path, key)), *direction)?;
        }
        Ok(())
    }

    /// Number of points of a grid that has been checked.
    pub fn count(&self) -> usize {
        match &self.points {
            GridPoints::Plane(plane) => plane.counts.iter().map(|count| *count as usize).product(),
            GridPoints::Points { points, .. } | GridPoints::Views { points, .. } => points.len(),
        }
    }

    /// The points of a grid that has been checked, each with its unit normal or unit direction. Those of a plane are row by
    /// row: the number along `u` grows first.
    pub fn places(&self) -> Vec<[DVec3; 2]> {
        match &self.points {
            GridPoints::Plane(plane) => {
                let ([columns, rows], normal) = (plane.counts, plane.unit_normal());
                // Without a zero that is negative, which tables would show.
                let normal = normal + DVec3::ZERO;
                let cells = (0..rows).flat_map(|j| (0..columns).map(move |i| [i, j]));
                // The list knows its length, and does not grow.
                let mut places = Vec::with_capacity(self.count());
                places.extend(cells.map(|cell| [plane.middle(cell), normal]));
                places
            }
            GridPoints::Points { points, normals: directions } | GridPoints::Views { points, directions } => {
                let of = |number: usize| directions.get(number).or(directions.first()).copied().unwrap_or(DVec3::Y);
                points.iter().enumerate().map(|(number, &point)| [point, scaled(of(number))]).collect()
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_of_a_plane_are_the_middles_of_its_cells() {
        let plane = PlaneGridDesc {
            origin: DVec3::new(1.0, 2.0, 3.0),
            u: DVec3::new(0.0, 0.0, 4.0),
            v: DVec3::new(2.0, 0.0, 0.0),
            counts: [2, 2],
            normal: None,
        };
        let grid = GridDesc { name: "desk".to_owned(), points: GridPoints::Plane(plane) };
        grid.check("grids[0]").unwrap();
        let places: Vec<[f64; 3]> = grid.places().iter().map(|[p, _]| p.to_array()).collect();
        assert_eq!(places, [[1.5, 2.0, 4.0], [1.5, 2.0, 6.0], [2.5, 2.0, 4.0], [2.5, 2.0, 6.0]]);
        assert!(grid.places().iter().all(|[_, normal]| *normal == DVec3::Y));
    }

    #[test]
    fn one_normal_serves_all_points() {
        let points = vec![DVec3::ZERO, DVec3::X];
        let grid = |normals| GridDesc {
            name: "eyes".to_owned(),
            points: GridPoints::Points { points: points.clone(), normals },
        };
        assert_eq!(grid(vec![DVec3::Z * 1e-30]).places()[1], [DVec3::X, DVec3::Z]);
        let error = grid(vec![DVec3::Z; 3]).check("grids[1]").unwrap_err();
        assert_eq!(error.location().json_path, "grids[1].normals");
    }
}
