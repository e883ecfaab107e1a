//! A hashed grid, for comparison.
//!
//! Source: Teschner et al. 2003, "Optimized Spatial Hashing for Collision Detection of Deformable Objects".

use etendue::integrator::photon::Photon;
use etendue::math::Vec3;

use super::LookUp;

/// Photons in the order of their cells' hashes.
pub struct Grid {
    photons: Vec<Photon>,
    /// Where each hash begins.
    starts: Vec<u32>,
    /// Cells per unit of length.
    scale: f32,
    bits: u32,
}

impl Grid {
    fn cell(&self, p: [f32; 3]) -> [i64; 3] {
        p.map(|x| (x * self.scale).floor() as i64)
    }

    fn hash(&self, [x, y, z]: [i64; 3]) -> usize {
        let key = (x as u64 & 0x1f_ffff) << 42 | (y as u64 & 0x1f_ffff) << 21 | z as u64 & 0x1f_ffff;
        (key.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> (64 - self.bits)) as usize
    }

    #[inline]
    fn visit(&self, p: Vec3, radius: f32, mut visit: impl FnMut(u32, &Photon, f32)) {
        let (min, max) = (self.cell((p - radius).to_array()), self.cell((p + radius).to_array()));
        let cells: i64 = (0..3).map(|axis| max[axis] - min[axis] + 1).product();
        let radius2 = radius * radius;
        let mut look = |range: std::ops::Range<u32>, cell: Option<[i64; 3]>| {
            for (i, photon) in range.clone().zip(&self.photons[range.start as usize..range.end as usize]) {
                let distance2 = photon.position().distance_squared(p);
                if distance2 < radius2 && cell.is_none_or(|cell| cell == self.cell(photon.p)) {
                    visit(i, photon, distance2);
                }
            }
        };
        if cells > self.photons.len() as i64 {
            return look(0..self.photons.len() as u32, None);
        }
        for x in min[0]..=max[0] {
            for y in min[1]..=max[1] {
                for z in min[2]..=max[2] {
                    let hash = self.hash([x, y, z]);
                    look(self.starts[hash]..self.starts[hash + 1], Some([x, y, z]));
                }
            }
        }
    }
}

impl LookUp for Grid {
    type Scratch = Vec<(u32, u32)>;

    fn build(photons: Vec<Photon>, radius: f32) -> Self {
        let bits = photons.len().max(2).ilog2().saturating_sub(2).max(1);
        let mut grid = Self { photons: Vec::new(), starts: vec![0; (1 << bits) + 1], scale: 0.5 / radius, bits };
        let hashes: Vec<u32> = photons.iter().map(|photon| grid.hash(grid.cell(photon.p)) as u32).collect();
        for &hash in &hashes {
            grid.starts[hash as usize + 1] += 1;
        }
        for i in 1..grid.starts.len() {
            grid.starts[i] += grid.starts[i - 1];
        }
        let mut places = grid.starts.clone();
        grid.photons = vec![Photon::default(); photons.len()];
        for (&hash, photon) in hashes.iter().zip(&photons) {
            let place = &mut places[hash as usize];
            grid.photons[*place as usize] = *photon;
            *place += 1;
        }
        grid
    }

    fn within(&self, p: Vec3, radius: f32, _: &mut Self::Scratch) -> (usize, f32) {
        let (mut count, mut sum) = (0, 0.0);
        self.visit(p, radius, |_, photon, distance2| {
            count += 1;
            sum += photon.power[0] * distance2;
        });
        (count, sum)
    }

    fn nearest(&self, p: Vec3, count: usize, found: &mut Self::Scratch) -> (usize, f32) {
        // Ever larger balls until one holds enough.
        let mut radius = 0.5 / self.scale;
        loop {
            found.clear();
            self.visit(p, radius, |i, _, distance2| found.push((distance2.to_bits(), i)));
            if found.len() >= count.min(self.photons.len()) {
                break;
            }
            radius *= 2.0;
        }
        if found.len() > count {
            found.select_nth_unstable(count - 1);
            found.truncate(count);
        }
        found.sort_unstable();
        let one = |&(bits, i): &(u32, u32)| self.photons[i as usize].power[0] * f32::from_bits(bits);
        (found.len(), found.iter().map(one).sum())
    }
}
