//! Sorts photons along a space-filling curve, so that neighbours on the curve are neighbours in space.

use super::Photon;
use crate::spectrum::Spectrum;
use crate::{Cancel, Error, ErrorKind, Result};

/// Items between two checks for cancellation.
const CHUNK: usize = 1 << 13;

/// A comparison sort is faster than a counting sort for fewer items than this.
const FEW: usize = 1 << 11;

/// The order of `photons` along a Morton curve, as indices in the lower half of each item.
///
/// The first sort has keys of 32 bits: 10 for each axis, or 16 for each of two if all photons lie in one plane, or 32 on a
/// line. Photons that share a cell, if they are more than `few`, are sorted again within their own box, and so on, so that
/// dense spots and photons far outside are in order too. A box is at least 1023 times as small as the one before, so that
/// few rounds are needed. Photons at the same position keep their order.
///
/// # Errors
/// [`ErrorKind::Cancelled`]; [`ErrorKind::Unsupported`] for 2^32 photons or more.
pub(super) fn order<C: Spectrum>(photons: &[Photon<C>], few: usize, cancel: &Cancel) -> Result<Vec<u64>> {
    if u32::try_from(photons.len()).is_err() {
        return Err(Error::new(ErrorKind::Unsupported, "a photon map holds fewer than 2^32 photons"));
    }
    let mut items: Vec<u64> = (0..photons.len() as u64).collect();
    let mut spare = vec![0; items.len()];
    let mut dense = vec![(0, items.len())];
    while let Some((start, end)) = dense.pop() {
        cancel.check()?;
        let items = &mut items[start..end];
        let Some(cells) = Cells::new(items, photons, cancel)? else { continue };
        for items in items.chunks_mut(CHUNK) {
            cancel.check()?;
            for item in items {
                let index = *item & u64::from(u32::MAX);
                *item = u64::from(cells.key(&photons[index as usize].p)) << 32 | index;
            }
        }
        sort(items, &mut spare[start..end], cancel)?;
        let mut cell = start;
        for same in items.chunk_by(|a, b| a >> 32 == b >> 32) {
            if same.len() > few {
                dense.push((cell, cell + same.len()));
            }
            cell += same.len();
        }
    }
    Ok(items)
}

/// Sorts `items` by their upper halves, and equal ones by their lower halves, in which order they are given.
fn sort(items: &mut [u64], spare: &mut [u64], cancel: &Cancel) -> Result<()> {
    const BITS: u32 = 11;
    if items.len() < FEW {
        items.sort_unstable();
        return Ok(());
    }
    let digit = |item: u64, pass: u32| (item >> (32 + BITS * pass)) as usize & ((1 << BITS) - 1);
    let mut counts = [[0_u32; 1 << BITS]; 3];
    for items in items.chunks(CHUNK) {
        cancel.check()?;
        for &item in items {
            for (pass, counts) in counts.iter_mut().enumerate() {
                counts[digit(item, pass as u32)] += 1;
            }
        }
    }
    let (mut from, mut to) = (items, spare);
    let mut swapped = false;
    for (pass, places) in counts.iter_mut().enumerate() {
        if places.iter().any(|&count| count as usize == from.len()) {
            continue;
        }
        let mut place = 0;
        for count in places.iter_mut() {
            place += std::mem::replace(count, place);
        }
        for items in from.chunks(CHUNK) {
            cancel.check()?;
            for &item in items {
                let place = &mut places[digit(item, pass as u32)];
                to[*place as usize] = item;
                *place += 1;
            }
        }
        std::mem::swap(&mut from, &mut to);
        swapped = !swapped;
    }
    if swapped {
        to.copy_from_slice(from);
    }
    Ok(())
}

/// A box divided into cells, which are cubes in as many dimensions as the box has.
struct Cells {
    min: [f64; 3],
    /// Cells per unit of length.
    scale: f64,
    /// The axes along which it extends, longest first.
    axes: [usize; 3],
    dimensions: u32,
}

impl Cells {
    /// Creates the cells around these photons; `None` if all photons are at one position.
    fn new<C: Spectrum>(items: &[u64], photons: &[Photon<C>], cancel: &Cancel) -> Result<Option<Self>> {
        let (mut min, mut max) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
        for items in items.chunks(CHUNK) {
            cancel.check()?;
            for item in items {
                let p = photons[*item as u32 as usize].p;
                for axis in 0..3 {
                    // Coordinates that are not numbers belong to no box.
                    min[axis] = if p[axis] < min[axis] { p[axis] } else { min[axis] };
                    max[axis] = if p[axis] > max[axis] { p[axis] } else { max[axis] };
                }
            }
        }
        let finite = |v: f32| f64::from(v.clamp(f32::MIN, f32::MAX));
        let extent: [f64; 3] = std::array::from_fn(|axis| finite(max[axis]) - finite(min[axis]));
        let mut axes = [0, 1, 2];
        axes.sort_by(|&a, &b| extent[b].total_cmp(&extent[a]));
        let longest = extent[axes[0]];
        if longest <= 0.0 {
            return Ok(None);
        }
        let dimensions = extent.iter().filter(|&&extent| extent > longest / 1024.0).count() as u32;
        let scale = 2_f64.powi([0, 32, 16, 10][dimensions as usize]) / longest;
        Ok(Some(Self { min: min.map(finite), scale, axes, dimensions }))
    }

    /// The index along the curve of the cell that contains a point.
    #[inline]
    fn key(&self, p: &[f32; 3]) -> u32 {
        // The conversion saturates and maps NaN to 0.
        let cell = |i: usize| {
            let axis = self.axes[i];
            ((f64::from(p[axis]) - self.min[axis]) * self.scale) as u32
        };
        match self.dimensions {
            3 => spread3(cell(0).min(1023)) << 2 | spread3(cell(1).min(1023)) << 1 | spread3(cell(2).min(1023)),
            2 => spread2(cell(0).min(0xffff)) << 1 | spread2(cell(1).min(0xffff)),
            _ => cell(0),
        }
    }
}

/// Inserts two zeros between the bits of a 10-bit number.
fn spread3(x: u32) -> u32 {
    let x = (x | x << 16) & 0x0300_00ff;
    let x = (x | x << 8) & 0x0300_f00f;
    let x = (x | x << 4) & 0x030c_30c3;
    (x | x << 2) & 0x0924_9249
}

/// Inserts a zero between the bits of a 16-bit number.
fn spread2(x: u32) -> u32 {
    let x = (x | x << 8) & 0x00ff_00ff;
    let x = (x | x << 4) & 0x0f0f_0f0f;
    let x = (x | x << 2) & 0x3333_3333;
    (x | x << 1) & 0x5555_5555
}
