//! The order in which a pass takes the samples of a tile, and the groups of pixels whose samples are taken together.

use std::ops::Range;

use crate::film::TILE;
use crate::integrator::reuse::GROUP;
use crate::sampling::hash;

/// Side of the squares of the picture that are divided into groups.
pub(super) const SQUARE: u32 = 8;

/// Number of groups of a square, and side of the cells of which each group has one pixel.
const GROUPS: u32 = SQUARE * SQUARE / GROUP as u32;
const CELL: u32 = 2;

const _: () = assert!(GROUPS == CELL * CELL);

/// A sample that is to be taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Wanted {
    /// Column and row in the picture.
    pub pixel: [u32; 2],
    /// Index of the pixel in the tile; `None` for a pixel elsewhere, whose sample is only a part of the group.
    pub index: Option<usize>,
    pub sample: u32,
}

/// Where a tile lies in the picture.
#[derive(Clone, Copy, Debug)]
pub(super) struct TilePlace {
    /// Column and row of the tile's first pixel in the picture.
    pub origin: [u32; 2],
    /// Columns and rows of the tile.
    pub size: [u32; 2],
    /// Columns and rows of the picture.
    pub picture: [u32; 2],
}

impl TilePlace {
    /// Index in the tile of a pixel of the picture, if the tile has it.
    fn index(&self, pixel: [u32; 2]) -> Option<usize> {
        let [x, y] = [0, 1].map(|axis| pixel[axis].wrapping_sub(self.origin[axis]));
        (x < self.size[0] && y < self.size[1]).then(|| (y * TILE + x) as usize)
    }

    /// Columns and rows of the squares of the picture that the tile has pixels of.
    fn squares(&self) -> [Range<u32>; 2] {
        [0, 1].map(|axis| {
            let begin = self.origin[axis];
            begin / SQUARE..(begin + self.size[axis]).div_ceil(SQUARE)
        })
    }
}

/// The order in which the samples of a tile are taken.
#[derive(Debug)]
pub(super) struct Order {
    place: TilePlace,
    /// A random number for the choice of groups; `None` where each pixel is by itself.
    groups: Option<u64>,
    /// Number of the pixel or square that comes next, and the samples and groups that the last one still wants.
    next: u32,
    samples: Range<u32>,
    group: u32,
}

impl Order {
    /// One pixel after the other.
    pub fn of_pixels(place: TilePlace) -> Self {
        Self { place, groups: None, next: 0, samples: 0..0, group: 0 }
    }

    /// Pixels in groups: one square of the picture after the other, and in a square one sample of all its pixels after the other.
    ///
    /// A group has one pixel of each cell of 2 x 2 pixels of its square. Which one is drawn anew for each sample, so that any two
    /// pixels of different cells have samples in common equally often. Squares are those of the picture, whatever part of it the film
    /// is, so that groups are the same in each part.
    pub fn of_groups(place: TilePlace, seed: u64) -> Self {
        Self { groups: Some(hash(seed, 0x67_726f_7570)), ..Self::of_pixels(place) }
    }

    /// Calls `push` with each sample of the next group. `false` where no group is left. `wants` says which samples the pixel with an
    /// index in the tile still wants.
    #[inline]
    pub fn next_group(&mut self, wants: impl Fn(usize) -> Range<u32>, push: impl FnMut(Wanted)) -> bool {
        match self.groups {
            None => self.next_pixel(wants, push),
            Some(key) => self.next_of_square(key, wants, push),
        }
    }

    #[inline]
    fn next_pixel(&mut self, wants: impl Fn(usize) -> Range<u32>, mut push: impl FnMut(Wanted)) -> bool {
        let TilePlace { origin, size: [width, height], .. } = self.place;
        let at = |number: u32| [number % width, number / width];
        loop {
            if let Some(sample) = self.samples.next() {
                let [x, y] = at(self.next - 1);
                let index = Some((y * TILE + x) as usize);
                push(Wanted { pixel: [origin[0] + x, origin[1] + y], index, sample });
                return true;
            }
            if self.next == width * height {
                return false;
            }
            let [x, y] = at(self.next);
            self.samples = wants((y * TILE + x) as usize);
            self.next += 1;
        }
    }

    fn next_of_square(&mut self, key: u64, wants: impl Fn(usize) -> Range<u32>, mut push: impl FnMut(Wanted)) -> bool {
        let [columns, rows] = self.place.squares();
        let across = columns.len() as u32;
        let square = |number: u32| [columns.start + number % across, rows.start + number / across];
        loop {
            while self.group < GROUPS && !self.samples.is_empty() {
                let (sample, group) = (self.samples.start, self.group);
                self.group += 1;
                let members = || self.members(square(self.next - 1), key, sample, group);
                // All pixels of a group have their samples added at once.
                let own = || members().filter_map(|pixel| self.place.index(pixel));
                if own().any(|index| wants(index).contains(&sample)) {
                    members().for_each(|pixel| push(Wanted { pixel, index: self.place.index(pixel), sample }));
                    return true;
                }
            }
            self.group = 0;
            if self.samples.next().is_some() && !self.samples.is_empty() {
                continue;
            }
            if self.next == across * rows.len() as u32 {
                self.samples = 0..0;
                return false;
            }
            self.samples = self.wanted_of(square(self.next), &wants);
            self.next += 1;
        }
    }

    /// The samples that any pixel of a square wants.
    fn wanted_of(&self, square: [u32; 2], wants: impl Fn(usize) -> Range<u32>) -> Range<u32> {
        let pixels = (0..SQUARE * SQUARE).map(|i| [square[0] * SQUARE + i % SQUARE, square[1] * SQUARE + i / SQUARE]);
        let wanted = pixels.filter_map(|pixel| self.place.index(pixel)).map(wants);
        wanted.reduce(|all, one| all.start.min(one.start)..all.end.max(one.end)).unwrap_or(0..0)
    }

    /// The pixels of a group of a square that are in the picture.
    fn members(&self, square: [u32; 2], key: u64, sample: u32, group: u32) -> impl Iterator<Item = [u32; 2]> + use<> {
        let picture = self.place.picture;
        // Two bits for each cell.
        let drawn = hash(hash(key, u64::from(square[0]) << 32 | u64::from(square[1])), u64::from(sample));
        (0..GROUP as u32).filter_map(move |cell| {
            let which = group ^ (drawn >> (2 * cell)) as u32 & 3;
            let across = SQUARE / CELL;
            let x = square[0] * SQUARE + cell % across * CELL + which % CELL;
            let y = square[1] * SQUARE + cell / across * CELL + which / CELL;
            (x < picture[0] && y < picture[1]).then_some([x, y])
        })
    }
}

#[cfg(test)]
mod tests {
    use std::collections::{HashMap, HashSet};

    use super::*;

    fn place(origin: [u32; 2], size: [u32; 2], picture: [u32; 2]) -> TilePlace {
        TilePlace { origin, size, picture }
    }

    /// All groups of a tile, with the samples that their pixels want.
    fn groups(mut order: Order, wants: impl Fn(usize) -> Range<u32>) -> Vec<Vec<Wanted>> {
        let mut groups = Vec::new();
        loop {
            let mut group = Vec::new();
            if !order.next_group(&wants, |wanted| group.push(wanted)) {
                return groups;
            }
            groups.push(group);
        }
    }

    #[test]
    fn each_pixel_has_each_sample_once() {
        // A whole tile, one at the picture's edge, and one that does not begin with a square.
        for place in [
            place([16, 32], [16, 16], [64, 64]),
            place([16, 32], [13, 5], [29, 37]),
            place([21, 35], [16, 16], [64, 64]),
            place([0, 0], [1, 1], [1, 1]),
        ] {
            let mut seen = HashMap::new();
            for group in groups(Order::of_groups(place, 7), |_| 2..5) {
                let cells: HashSet<_> = group.iter().map(|one| one.pixel.map(|x| x / CELL)).collect();
                assert_eq!(cells.len(), group.len(), "one pixel of each cell");
                assert!(group.iter().all(|one| one.sample == group[0].sample));
                for one in group {
                    let inside = [0, 1].map(|axis| one.pixel[axis].wrapping_sub(place.origin[axis]));
                    let is_own = inside[0] < place.size[0] && inside[1] < place.size[1];
                    assert_eq!(one.index, is_own.then(|| (inside[1] * TILE + inside[0]) as usize));
                    assert!(one.pixel[0] < place.picture[0] && one.pixel[1] < place.picture[1]);
                    *seen.entry((one.pixel, one.sample)).or_insert(0) += usize::from(is_own);
                }
            }
            let own: Vec<_> = seen.values().filter(|count| **count > 0).collect();
            assert_eq!(own.len() as u32, 3 * place.size[0] * place.size[1]);
            assert!(own.iter().all(|count| **count == 1));
        }
    }

    /// Groups do not depend on the tile by which they are found, nor on what was taken before.
    #[test]
    fn groups_are_those_of_the_picture() {
        let of = |place, wants: Range<u32>| -> HashSet<Vec<([u32; 2], u32)>> {
            let groups = groups(Order::of_groups(place, 3), |_| wants.clone());
            groups.iter().map(|group| group.iter().map(|one| (one.pixel, one.sample)).collect()).collect()
        };
        let whole = of(place([16, 16], [16, 16], [64, 64]), 0..4);
        assert_eq!(whole.len(), 64);
        let part = of(place([19, 18], [5, 4], [64, 64]), 0..4);
        assert!(part.is_subset(&whole), "{part:?}");
        let later = of(place([16, 16], [16, 16], [64, 64]), 2..4);
        assert!(later.len() == 32 && later.is_subset(&whole));
    }

    #[test]
    fn a_square_goes_on_where_it_was_stopped() {
        let place = place([0, 0], [16, 16], [64, 64]);
        let all = groups(Order::of_groups(place, 3), |_| 0..2);
        // The first five groups are done.
        let done: HashSet<_> = all[..5].iter().flatten().map(|one| (one.index, one.sample)).collect();
        let count = |index| (0..2).filter(|sample| done.contains(&(Some(index), *sample))).count() as u32;
        assert_eq!(groups(Order::of_groups(place, 3), |index| count(index)..2), all[5..]);
    }

    #[test]
    fn pixels_by_themselves_go_row_by_row() {
        let order = Order::of_pixels(place([32, 16], [2, 2], [64, 64]));
        let taken: Vec<_> = groups(order, |index| if index == 0 { 4..4 } else { 4..6 }).concat();
        let pixels: Vec<_> = taken.iter().map(|one| (one.pixel, one.index, one.sample)).collect();
        let expected = [([33, 16], 1), ([32, 17], 16), ([33, 17], 17)];
        let expected = expected.map(|(pixel, index)| [4, 5].map(|sample| (pixel, Some(index), sample)));
        assert_eq!(pixels, expected.concat());
    }
}
