//! Independent random numbers from a counter.

/// A pseudo-random stream: SplitMix64, a counter put through a mixing function.
///
/// Its whole state is one integer, so that starting a stream anywhere costs one multiplication. It passes BigCrush and
/// is not suitable for cryptography.
///
/// Source: Steele, Lea, Flood 2014, "Fast Splittable Pseudorandom Number Generators", with the mixing constants of
/// Stafford's variant 13.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rng {
    state: u64,
}

/// 2^64 over the golden ratio, odd.
const GOLDEN_GAMMA: u64 = 0x9e37_79b9_7f4a_7c15;

/// A bijection of the 64-bit integers in which each input bit changes about half of the output bits.
#[inline]
pub(crate) fn mix(mut x: u64) -> u64 {
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}

/// An integer that depends on both arguments in every bit; not symmetric.
#[inline]
pub(crate) fn hash(key: u64, x: u64) -> u64 {
    mix(mix(key.wrapping_add(GOLDEN_GAMMA)) ^ x.wrapping_mul(GOLDEN_GAMMA))
}

/// Element `i` of the SplitMix64 stream that starts at `key`.
#[inline]
pub(crate) fn stream(key: u64, i: u64) -> u64 {
    mix(key.wrapping_add(i.wrapping_mul(GOLDEN_GAMMA)))
}

/// The upper 24 bits as a number in [0, 1), all of them exact multiples of 2^-24.
#[inline]
pub(crate) fn unit_f32(bits: u32) -> f32 {
    (bits >> 8) as f32 * (1.0 / 16_777_216.0)
}

impl Rng {
    /// The stream with index `stream` of the family `seed`.
    #[inline]
    pub fn new(seed: u64, stream: u64) -> Self {
        Self { state: hash(seed, stream) }
    }

    /// 64 random bits.
    #[inline]
    pub fn next_u64(&mut self) -> u64 {
        self.state = self.state.wrapping_add(GOLDEN_GAMMA);
        mix(self.state)
    }

    /// A number in [0, 1), a multiple of 2^-24.
    #[inline]
    pub fn next_f32(&mut self) -> f32 {
        unit_f32((self.next_u64() >> 32) as u32)
    }

    /// Two independent numbers in [0, 1).
    #[inline]
    pub fn next_2d(&mut self) -> [f32; 2] {
        let bits = self.next_u64();
        [unit_f32((bits >> 32) as u32), unit_f32(bits as u32)]
    }

    /// Four independent numbers in [0, 1).
    #[inline]
    pub fn next_4d(&mut self) -> [f32; 4] {
        let ([a, b], [c, d]) = (self.next_2d(), self.next_2d());
        [a, b, c, d]
    }
}
