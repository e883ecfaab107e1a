//! Transforms by keyframes: the parts into which a transform is taken apart, and what is between two keys.

use super::{DAffine3, DMat3, DQuat, DVec3};

/// A transform as a stretch, then a rotation, then a translation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// Added last.
    pub translation: DVec3,
    /// A unit quaternion.
    pub rotation: DQuat,
    /// Applied first: a scale along axes, or any symmetric matrix.
    pub stretch: DMat3,
}

/// Iterations after which Newton's method has converged whatever invertible matrix it began with.
const ITERATIONS: u32 = 100;

impl Pose {
    /// Takes an invertible transform apart: M = R S, where R is the rotation nearest to M and S is symmetric. Where the transform
    /// mirrors, the signs of both R and S are reversed, so that R is a rotation.
    ///
    /// Source: Higham 1986, "Computing the Polar Decomposition", Eq. 3.5; Shoemake and Duff 1992, "Matrix Animation and Polar
    /// Decomposition".
    pub fn of(transform: &DAffine3) -> Self {
        let m = transform.matrix3;
        let largest = |m: &DMat3| m.to_cols_array().iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        let mut r = m * (1.0 / largest(&m));
        for _ in 0..ITERATIONS {
            let inverse = r.inverse().transpose();
            // The scale makes both of the same size, which keeps the number of steps small for far stretches.
            let scale = (largest(&inverse) / largest(&r)).sqrt();
            let next = (r * scale + inverse * (1.0 / scale)) * 0.5;
            let step = largest(&(next - r));
            r = next;
            if step < 1e-15 {
                break;
            }
        }
        if r.determinant() < 0.0 {
            r = -r;
        }
        let rotation = DQuat::from_mat3(&r).normalize();
        let s = DMat3::from_quat(rotation).transpose() * m;
        Self { translation: transform.translation, rotation, stretch: (s + s.transpose()) * 0.5 }
    }

    /// The transform of these parts.
    pub fn transform(&self) -> DAffine3 {
        DAffine3 { matrix3: DMat3::from_quat(self.rotation) * self.stretch, translation: self.translation }
    }

    /// What is between two poses: translation and stretch change linearly, and the rotation goes the shorter way at constant speed
    /// (Shoemake 1985, "Animating Rotation with Quaternion Curves").
    fn between(&self, to: &Self, share: f64) -> Self {
        Self {
            translation: self.translation.lerp(to.translation, share),
            rotation: self.rotation.slerp(to.rotation, share).normalize(),
            stretch: self.stretch * (1.0 - share) + to.stretch * share,
        }
    }
}

/// A transform that changes with time.
#[derive(Clone, Debug, PartialEq)]
pub struct KeyedPath {
    /// Times, each later than the one before, and what the transform is then; at least one.
    keys: Box<[(f64, Pose)]>,
}

impl KeyedPath {
    /// The path through these poses, whose times \[s\] grow. `None` where there is none.
    pub fn new(keys: impl IntoIterator<Item = (f64, Pose)>) -> Option<Self> {
        let keys: Box<[_]> = keys.into_iter().collect();
        (!keys.is_empty()).then_some(Self { keys })
    }

    /// The pose at a time \[s\]. Before the first key and after the last one, it is that of the key.
    pub fn pose(&self, time: f64) -> Pose {
        let after = self.keys.partition_point(|(key, _)| *key <= time);
        match (after.checked_sub(1).map(|before| &self.keys[before]), self.keys.get(after)) {
            (None, _) => self.keys[0].1,
            (Some((_, last)), None) => *last,
            (Some((from, before)), Some((to, after))) => before.between(after, (time - from) / (to - from)),
        }
    }

    /// The transform at a time \[s\].
    pub fn at(&self, time: f64) -> DAffine3 {
        self.pose(time).transform()
    }

    /// The times of the keys within an interval, and its two ends.
    pub fn times_in(&self, [open, close]: [f64; 2]) -> impl Iterator<Item = f64> {
        let inner = self.keys.iter().map(|(time, _)| *time).filter(move |time| open < *time && *time < close);
        std::iter::once(open).chain(inner).chain(std::iter::once(close))
    }

    /// Whether nothing changes during an interval.
    pub fn rests_in(&self, interval: [f64; 2]) -> bool {
        let first = self.pose(interval[0]);
        interval[0] == interval[1] || self.times_in(interval).all(|time| self.pose(time) == first)
    }

    /// Whether nothing turns or stretches during an interval, so that points move along straight lines between keys.
    pub fn only_moves_in(&self, interval: [f64; 2]) -> bool {
        let first = self.pose(interval[0]);
        self.times_in(interval).all(|time| {
            let pose = self.pose(time);
            (pose.rotation, pose.stretch) == (first.rotation, first.stretch)
        })
    }

    /// Points at moments of an interval, and a distance from them, within which a point of the moved frame stays during the interval.
    pub fn reach(&self, point: DVec3, interval: [f64; 2]) -> (Vec<DVec3>, f64) {
        if self.only_moves_in(interval) {
            return (self.times_in(interval).map(|time| self.at(time).transform_point3(point)).collect(), 0.0);
        }
        // The translation changes linearly, and no rotation takes the point farther from it than the longest stretch does.
        let poses: Vec<_> = self.times_in(interval).map(|time| self.pose(time)).collect();
        let radius = poses.iter().map(|pose| (pose.stretch * point).length()).fold(0.0, f64::max);
        (poses.iter().map(|pose| pose.translation).collect(), radius)
    }
}

/// Whether the determinant of the matrix that changes linearly from one to another falls below a thousandth of both
/// ends' smaller determinant in between, so that an object is squeezed flat or turned inside out on its way.
pub(crate) fn flattens_between(from: DMat3, to: DMat3) -> bool {
    /// Halvings of the interval, after which the smallest Bernstein coefficient stands for the smallest value.
    const HALVINGS: u32 = 8;
    fn reaches([a, b, c, d]: [f64; 4], least: f64, halvings: u32) -> bool {
        if a.min(d) < least {
            return true;
        }
        // The values lie between the smallest and the largest Bernstein coefficient.
        if b.min(c) >= least {
            return false;
        }
        if halvings == 0 {
            return true;
        }
        let middle = |x: f64, y: f64| 0.5 * (x + y);
        let (ab, bc, cd) = (middle(a, b), middle(b, c), middle(c, d));
        let (abc, bcd) = (middle(ab, bc), middle(bc, cd));
        let abcd = middle(abc, bcd);
        reaches([a, ab, abc, abcd], least, halvings - 1) || reaches([abcd, bcd, cd, d], least, halvings - 1)
    }
    let start = from.determinant();
    // The determinant is a cubic polynomial of time. Its Bernstein coefficients are means of the determinants of the
    // matrices that have some columns of one end and the others of the other end.
    let ends = [from.to_cols_array_2d().map(DVec3::from), to.to_cols_array_2d().map(DVec3::from)];
    let mixed =
        |x: usize, y: usize, z: usize| DMat3::from_cols(ends[x][0], ends[y][1], ends[z][2]).determinant() / start;
    let coefficients = [
        1.0,
        (mixed(1, 0, 0) + mixed(0, 1, 0) + mixed(0, 0, 1)) / 3.0,
        (mixed(0, 1, 1) + mixed(1, 0, 1) + mixed(1, 1, 0)) / 3.0,
        mixed(1, 1, 1),
    ];
    reaches(coefficients, 1e-3 * coefficients[3].min(1.0), HALVINGS)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(a: &DAffine3, b: &DAffine3) -> bool {
        let pairs = a.to_cols_array().into_iter().zip(b.to_cols_array());
        let size = b.to_cols_array().iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        pairs.into_iter().all(|(a, b)| (a - b).abs() < 1e-12 * size)
    }

    #[test]
    fn a_transform_is_the_product_of_its_parts() {
        let turn = DMat3::from_axis_angle(DVec3::new(1.0, 2.0, -0.5).normalize(), 2.1);
        let shear = DMat3::from_cols(DVec3::X, DVec3::new(0.7, 1.0, 0.0), DVec3::new(-0.2, 0.4, 1.0));
        let scales = [DVec3::ONE, DVec3::new(1e-6, 1.0, 1e5), DVec3::new(-2.0, 3.0, 1.0), DVec3::splat(-1.0)];
        for scale in scales {
            for m in [turn * DMat3::from_diagonal(scale), shear * DMat3::from_diagonal(scale), turn * shear] {
                let whole = DAffine3::from_mat3_translation(m, DVec3::new(1.0, -2.0, 3.0));
                let pose = Pose::of(&whole);
                assert!(close(&pose.transform(), &whole), "{whole} {}", pose.transform());
                assert!((pose.rotation.length() - 1.0).abs() < 1e-15);
            }
        }
        // The rotation of what only turns and grows is its own.
        let pose = Pose::of(&DAffine3::from_mat3(turn * 3.0));
        assert!((DMat3::from_quat(pose.rotation) - turn).to_cols_array().iter().all(|x| x.abs() < 1e-14));
        assert!((pose.stretch - DMat3::IDENTITY * 3.0).to_cols_array().iter().all(|x| x.abs() < 1e-14));
    }

    #[test]
    fn between_keys_rotations_turn_evenly_and_keep_lengths() {
        let pose = |degrees: f64, x: f64| Pose {
            translation: DVec3::X * x,
            rotation: DQuat::from_rotation_z(degrees.to_radians()),
            stretch: DMat3::IDENTITY,
        };
        let path = KeyedPath::new([(1.0, pose(0.0, 0.0)), (2.0, pose(170.0, 4.0)), (4.0, pose(270.0, 0.0))]).unwrap();
        for (time, degrees, x) in [
            (0.0, 0.0, 0.0),
            (1.0, 0.0, 0.0),
            (1.25, 42.5, 1.0),
            (2.0, 170.0, 4.0),
            (3.0, 220.0, 2.0),
            (9.0, 270.0, 0.0),
        ] {
            let at = path.at(time);
            let arm = at.transform_vector3(DVec3::X);
            assert!((arm.length() - 1.0).abs() < 1e-14);
            let expected = DVec3::new(f64::to_radians(degrees).cos(), f64::to_radians(degrees).sin(), 0.0);
            assert!((arm - expected).length() < 1e-14, "{time}: {arm}");
            assert!((at.translation.x - x).abs() < 1e-14);
        }
        assert!(path.rests_in([4.0, 9.0]) && path.rests_in([3.0, 3.0]) && !path.rests_in([3.0, 3.1]));
        assert!(path.only_moves_in([-2.0, 1.0]) && !path.only_moves_in([1.0, 1.1]));
        // A turning point stays where its reach says.
        let point = DVec3::new(0.3, -0.8, 0.2);
        let (places, radius) = path.reach(point, [1.2, 3.9]);
        let [low, high] = [f64::min, f64::max].map(|pick| places.iter().map(|it| it.x).reduce(pick).unwrap());
        for i in 0..=100 {
            let x = path.at(1.2 + 0.027 * f64::from(i)).transform_point3(point).x;
            assert!(x > low - radius && x < high + radius);
        }
    }

    #[test]
    fn what_is_flattened_on_its_way_is_told() {
        let diagonal = |x: f64, y: f64| DMat3::from_diagonal(DVec3::new(x, y, 1.0));
        assert!(!flattens_between(diagonal(1.0, 1.0), diagonal(5.0, 0.1)));
        assert!(flattens_between(diagonal(1.0, 1.0), diagonal(-1.0, 1.0)));
        assert!(flattens_between(diagonal(1.0, 1.0), diagonal(-1.0, -1.0)));
    }
}
