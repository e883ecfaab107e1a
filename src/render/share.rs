//! Parts of a render that different processes take: tiles, spread over the picture.

use crate::film::Film;
use crate::{Error, Result};

/// One of several parts of a render, each of which may be rendered by a process of its own, on any machine. All parts together are
/// the whole picture, to the last bit (see [`Checkpoint::merge`](super::Checkpoint::merge)).
///
/// A part has tiles that are spread over the picture, with all of their samples. What is prepared before the first sample, such as photon
/// maps, each part prepares for itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Share {
    number: u32,
    count: u32,
}

/// Greatest number of parts of a render.
pub const MAX_SHARES: u32 = 1 << 16;

impl Share {
    /// Part `number`, counted from 1, of `count`.
    ///
    /// # Errors
    /// [`ErrorKind::InvalidScene`](crate::ErrorKind::InvalidScene) for a number that is not in 1 to `count`, and for more than
    /// [`MAX_SHARES`] parts.
    pub fn new(number: u32, count: u32) -> Result<Self> {
        if (1..=count).contains(&number) && count <= MAX_SHARES {
            return Ok(Self { number, count });
        }
        let message =
            format!("{number} of {count}; expected a number from 1 to that of the parts, at most {MAX_SHARES}");
        Err(Error::invalid("share", message))
    }

    /// The number of the part, counted from 1.
    pub fn number(self) -> u32 {
        self.number
    }

    /// How many parts there are.
    pub fn count(self) -> u32 {
        self.count
    }
}

/// The tiles that a pass takes, in their order.
#[derive(Clone, Debug)]
pub(super) enum Tiles {
    /// `count` of `all` tiles of the film, from the first on, with the way from one to the next.
    Steps {
        all: usize,
        count: usize,
        first: usize,
        step: usize,
    },
    List(Vec<usize>),
}

impl Tiles {
    /// All tiles of a film, row by row, or those of a part.
    pub fn of(film: &Film, share: Option<Share>) -> Self {
        let all = film.tile_count();
        let Some(Share { number, count }) = share else { return Self::Steps { all, count: all, first: 0, step: 1 } };
        let (number, count) = (number as usize, count as usize);
        // The part has some consecutive steps of the way through all tiles.
        let [begin, end] = [number - 1, number].map(|number| number * all / count);
        let step = stride(all);
        Self::Steps { all, count: end - begin, first: begin * step % all.max(1), step }
    }

    /// These tiles of a film.
    pub fn list(tiles: Vec<usize>) -> Self {
        Self::List(tiles)
    }

    /// One tile only.
    pub fn single(film: &Film, tile: usize) -> Self {
        Self::Steps { all: film.tile_count(), count: 1, first: tile, step: 1 }
    }

    /// How many tiles there are.
    pub fn count(&self) -> usize {
        match self {
            Self::Steps { count, .. } => *count,
            Self::List(tiles) => tiles.len(),
        }
    }

    /// The tile with this place in the order; `None` after the last.
    #[inline]
    pub fn get(&self, place: usize) -> Option<usize> {
        match self {
            Self::Steps { all, count, first, step } => (place < *count).then(|| (first + place * step) % all),
            Self::List(tiles) => tiles.get(place).copied(),
        }
    }
}

/// A step by which all of `all` tiles are visited, consecutive ones far from each other: no common factor, and about the golden
/// section. Any run of consecutive steps is spread evenly (Weyl 1916), so that what is slow in the picture is spread over the parts.
fn stride(all: usize) -> usize {
    let golden = (all as f64 * 0.618_033_988_749_895) as usize;
    (golden.max(1)..=all.max(1)).find(|step| gcd(*step, all) == 1).unwrap_or(1)
}

fn gcd(a: usize, b: usize) -> usize {
    if b == 0 { a } else { gcd(b, a % b) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::FilmOptions;

    #[test]
    fn parts_have_each_tile_once() {
        for resolution in [[1, 1], [16, 16], [17, 33], [320, 240], [1000, 30]] {
            let film = Film::new(FilmOptions {
                resolution,
                placement: None,
                auxiliary: false,
                light_parts: false,
                share: 1,
                weighted: false,
                gathering: false,
            })
            .unwrap();
            for count in [1, 2, 3, 16, 400] {
                let mut taken = vec![0; film.tile_count()];
                let mut most = 0;
                for number in 1..=count {
                    let tiles = Tiles::of(&film, Some(Share::new(number, count).unwrap()));
                    (0..tiles.count()).for_each(|place| taken[tiles.get(place).unwrap()] += 1);
                    assert_eq!(tiles.get(tiles.count()), None);
                    most = most.max(tiles.count());
                }
                assert!(taken.iter().all(|times| *times == 1), "{resolution:?} in {count}: {taken:?}");
                assert_eq!(most, film.tile_count().div_ceil(count as usize));
            }
        }
        assert!(Share::new(0, 3).is_err() && Share::new(4, 3).is_err() && Share::new(1, MAX_SHARES + 1).is_err());
    }

    #[test]
    fn a_part_is_spread_over_the_picture() {
        // 20 x 15 tiles in 4 parts: every quarter of the picture has about a quarter of each part.
        let film = Film::new(FilmOptions {
            resolution: [320, 240],
            placement: None,
            auxiliary: false,
            light_parts: false,
            share: 1,
            weighted: false,
            gathering: false,
        })
        .unwrap();
        for number in 1..=4 {
            let tiles = Tiles::of(&film, Some(Share::new(number, 4).unwrap()));
            let mut quarters = [0; 4];
            for place in 0..tiles.count() {
                let tile = tiles.get(place).unwrap();
                quarters[usize::from(tile % 20 >= 10) + 2 * usize::from(tile / 20 >= 7)] += 1;
            }
            assert!(quarters.iter().all(|count| (13..=24).contains(count)), "{quarters:?}");
        }
    }
}
