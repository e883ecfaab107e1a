//! Sample points and pixel filters: evenness, independence, the speed at which errors fall, and whether the errors that a
//! render reports are the errors it has.

mod errors;
mod filters;
mod independence;
mod points;

use etendue::sampling::Sampler;

use crate::record::Entry;

pub fn cases() -> Vec<Entry> {
    [points::cases(), independence::cases(), errors::cases(), filters::cases()].into_iter().flatten().collect()
}

/// The first `N` numbers of one sample: the position, then those of sets of four.
fn numbers<const N: usize>(sampler: &mut impl Sampler, pixel: u32, sample: u32) -> [f32; N] {
    sampler.start(pixel, sample);
    let [x, y] = sampler.pixel_2d();
    let mut numbers = [0.0; N];
    numbers[..2].copy_from_slice(&[x, y]);
    for set in numbers[2..].chunks_mut(4) {
        set.copy_from_slice(&sampler.next_4d()[..set.len()]);
    }
    numbers
}
