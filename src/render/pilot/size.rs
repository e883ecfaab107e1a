//! How large a pilot is.

use std::time::Duration;

use super::super::order::SQUARE;
use super::super::settings::RenderSettings;

/// Number of squares in a row and in a column, and samples of each of their pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in super::super) struct Size {
    pub across: u32,
    pub samples: u32,
}

/// Sizes of one kind.
struct Kind {
    /// Number of samples of a picture over those of its pilot. All ways together take about the time of four paths for each sample of the
    /// pilot, which then is a thirtieth of the picture's.
    times_longer: u64,
    /// For each replicate one or two.
    samples: u32,
    /// Least and greatest number of squares in a row and in a column.
    across: [u32; 2],
    /// Shortest time limit of a render with such a pilot.
    least_time: Duration,
}

/// The pilot of long renders.
const LARGE: Kind = Kind { times_longer: 110, samples: 16, across: [6, 10], least_time: Duration::from_secs(10) };

/// That of shorter ones, which is unsure where there is little to gain. Its squares are rendered in all ways, and few of them at a time take
/// longer.
const SMALL: Kind = Kind { times_longer: 160, samples: 8, across: [3, 8], least_time: Duration::from_secs(3) };

impl Size {
    /// The size for a render that is so long that a pilot is a small part of it. `None` for others, and for adaptive renders.
    ///
    /// It is the picture that counts, whatever part of it is rendered: each part is to show what the whole picture does.
    pub fn of(settings: &RenderSettings) -> Option<Self> {
        if settings.adaptive.unwrap_or(settings.target_error.is_some()) {
            return None;
        }
        let [width, height] = settings.desc.resolution;
        let samples = u64::from(width) * u64::from(height) * u64::from(settings.desc.samples);
        let limit = settings.time_limit;
        let fitting = |kind: Kind| {
            let affordable = (samples / (kind.times_longer * u64::from(SQUARE * SQUARE * kind.samples))).isqrt();
            let across = affordable.min(u64::from(kind.across[1])).min(u64::from(width.min(height) / SQUARE)) as u32;
            // How many samples there will be is not known.
            let across = if limit.is_some() { across.min(kind.across[0]) } else { across };
            let is_long = limit.is_none_or(|limit| limit >= kind.least_time);
            (across >= kind.across[0] && is_long).then_some(Self { across, samples: kind.samples })
        };
        [LARGE, SMALL].into_iter().find_map(fitting)
    }

    /// Whether it is that of a long render.
    pub fn is_large(self) -> bool {
        self.samples == LARGE.samples
    }

    /// Number of squares.
    pub fn squares(self) -> usize {
        (self.across * self.across) as usize
    }

    /// Number of samples of a picture for which this is large enough: no more than those that were asked for.
    pub fn samples_of_picture(self) -> u64 {
        let kind = if self.is_large() { LARGE } else { SMALL };
        kind.times_longer * self.samples_of(self.squares() as f64) as u64
    }

    /// Number of samples of all pixels of so many squares.
    pub fn samples_of(self, squares: f64) -> f64 {
        squares * f64::from(SQUARE * SQUARE * self.samples)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::desc::RenderDesc;

    #[test]
    fn the_longer_a_render_the_larger_is_its_pilot() {
        let with = |resolution: [u32; 2], samples: u32, seconds: Option<u64>| {
            let desc = RenderDesc { resolution, samples, ..RenderDesc::default() };
            let time_limit = seconds.map(Duration::from_secs);
            Size::of(&RenderSettings { desc, time_limit, ..RenderSettings::default() })
                .map(|size| [size.across, size.samples])
        };
        let of = |samples| with([256, 256], samples, None);
        let sizes = [1, 11, 12, 16, 32, 61, 62, 64, 128, 172, 1 << 20].map(of);
        let expected = [
            None,
            None,
            Some([3, 8]),
            Some([3, 8]),
            Some([5, 8]),
            Some([6, 8]),
            Some([6, 16]),
            Some([6, 16]),
            Some([8, 16]),
            Some([10, 16]),
            Some([10, 16]),
        ];
        assert_eq!(sizes, expected);
        // Squares do not overlap.
        assert_eq!(with([23, 1000], 1 << 20, None), None);
        assert_eq!(with([47, 1000], 1 << 20, None), Some([5, 8]));
        // However many samples are asked for, time may end a render soon.
        let limited = |seconds| with([256, 256], 1 << 20, Some(seconds));
        assert_eq!([2, 3, 9, 10, 1000].map(limited), [None, Some([3, 8]), Some([3, 8]), Some([6, 16]), Some([6, 16])]);
        assert_eq!(with([256, 256], 16, Some(1000)), Some([3, 8]));
        assert_eq!(Size { across: 3, samples: 8 }.samples_of_picture(), 160 * 9 * 64 * 8);
    }
}
