//! Images as textures: lookups and filters.

use std::ops::RangeInclusive;
use std::sync::{Arc, LazyLock};

use super::pyramid::{Pyramid, wrapped};
use super::slopes::SlopesOf;
use super::texels::{ColorSpace, TexelImage};
use super::{Texel, TextureFilter, TexturePoint, Wrap};
use crate::rows::rows;

/// Most times that the longer axis of a footprint may be the shorter one; beyond, the shorter one is widened, which blurs and bounds
/// the texels of a lookup.
const MOST_ANISOTROPY: f32 = 16.0;

/// Most texels that a lookup sums up; a footprint of more is looked up in coarser levels instead.
const MOST_TEXELS: f32 = 8192.0;

/// Largest texture coordinate.
const MOST_COORDINATE: f32 = 1e9;

/// Radius of the filter in standard deviations of its Gaussian is 2: the weight exp(-2 r^2) at the edge of the ellipse.
const FALLOFF: f32 = 2.0;

/// An image with what is needed to read it.
#[derive(Clone, Debug)]
pub struct ImageTexture {
    image: Arc<TexelImage>,
    space: ColorSpace,
    wrap: [Wrap; 2],
    filter: TextureFilter,
    /// What the texels are turned into, for materials that need the slopes of a surface.
    slopes: Option<SlopesOf>,
    pyramid: Option<Arc<Pyramid>>,
    mean: Texel,
    range: [Texel; 2],
}

impl ImageTexture {
    /// Prepares an image: filters of levels make these levels.
    pub fn new(image: Arc<TexelImage>, space: ColorSpace, wrap: [Wrap; 2], filter: TextureFilter) -> Self {
        Self::by_threads(image, space, wrap, filter, 1)
    }

    /// As [`Self::new`], by at most so many threads, which end with the work. The result does not depend on their number.
    pub fn by_threads(
        image: Arc<TexelImage>,
        space: ColorSpace,
        wrap: [Wrap; 2],
        filter: TextureFilter,
        threads: usize,
    ) -> Self {
        let pyramid = filter.has_levels().then(|| Arc::new(Pyramid::new(&image, space, threads)));
        let (mean, range) = statistics(&image, threads, |x, y| image.texel(x, y, space));
        Self { image, space, wrap, filter, slopes: None, pyramid, mean, range }
    }

    /// The slopes that an image says and their squares ([`SlopesOf::at`]), with a filter of levels. Where texels are larger than
    /// what a pixel covers, the surface between them is smooth: the squares are those of the slopes.
    pub(crate) fn of_slopes(
        image: Arc<TexelImage>,
        space: ColorSpace,
        wrap: [Wrap; 2],
        filter: TextureFilter,
        of: SlopesOf,
        threads: usize,
    ) -> Self {
        let slopes = |x, y| of.at(&image, space, wrap, x, y);
        let pyramid = Some(Arc::new(Pyramid::of_values(&image, threads, slopes)));
        let (mean, range) = statistics(&image, threads, slopes);
        Self { image, space, wrap, filter, slopes: Some(of), pyramid, mean, range }
    }

    /// Bytes that the levels of an image take with this filter, at most; those of its slopes where `of_slopes`.
    pub(crate) fn bytes_of_levels(image: &TexelImage, filter: TextureFilter, of_slopes: bool) -> usize {
        match filter.has_levels() {
            false => 0,
            true if of_slopes => Pyramid::bytes_over_values(image),
            true => Pyramid::bytes_over(image),
        }
    }

    /// How it is filtered.
    pub fn filter(&self) -> TextureFilter {
        self.filter
    }

    /// The larger of the numbers of columns and rows.
    pub fn texels_across(&self) -> u32 {
        self.image.width().max(self.image.height())
    }

    /// The same image with the means of its light for levels, of at most `most` columns and rows, and the number of levels.
    pub(super) fn with_light(&self, threads: usize, most: u32) -> (Self, usize) {
        let pyramid = Pyramid::of_light(&self.image, self.space, threads, most);
        let levels = pyramid.len();
        (Self { pyramid: Some(Arc::new(pyramid)), ..self.clone() }, levels)
    }

    /// The level of one texel.
    pub(super) fn last_level(&self) -> usize {
        self.pyramid.as_ref().map_or(0, |pyramid| pyramid.len())
    }

    /// The columns and rows of a level that a lookup of the image within a box of texture coordinates may read.
    pub(super) fn places_within(&self, level: usize, low: [f32; 2], high: [f32; 2]) -> [RangeInclusive<i64>; 2] {
        let (whole, size) = (self.size(0).map(f64::from), self.size(level).map(f64::from));
        // Rows go down from v = 1. A lookup reads half a texel of the image around it; rounding is far less than another half.
        let [[left, bottom], [right, top]] = [low, high].map(|uv| uv.map(f64::from));
        [(0, left, right), (1, 1.0 - top, 1.0 - bottom)].map(|(i, from, to): (usize, f64, f64)| {
            let margin = 1.0 / whole[i];
            ((from - margin) * size[i]).floor() as i64..=((to + margin) * size[i]).floor() as i64
        })
    }

    pub(super) fn mean(&self) -> Texel {
        self.mean
    }

    pub(super) fn range(&self) -> [Texel; 2] {
        // Beyond the edges lies black without opacity.
        if self.wrap.contains(&Wrap::Black) { [[0.0; 4], self.range[1]] } else { self.range }
    }

    pub(super) fn pyramid_bytes(&self) -> usize {
        self.pyramid.as_ref().map_or(0, |pyramid| pyramid.bytes())
    }

    /// Size of a level; level 0 is the image.
    pub(super) fn size(&self, level: usize) -> [u32; 2] {
        match &self.pyramid {
            Some(pyramid) if level > 0 => pyramid.size(level),
            _ => [self.image.width(), self.image.height()],
        }
    }

    /// A texel of a level, columns to the right and rows down, which may lie beyond the edges.
    #[inline]
    pub(super) fn texel(&self, level: usize, at: [i64; 2]) -> Texel {
        let Some([x, y]) = wrapped(self.wrap, self.size(level), at) else { return [0.0; 4] };
        let texel = self.stored(level, x, y);
        match self.slopes {
            Some(of) => of.beyond_edges(self.wrap, self.size(level), at, texel),
            None => texel,
        }
    }

    /// A texel of a level within its edges.
    #[inline]
    fn stored(&self, level: usize, x: u32, y: u32) -> Texel {
        match &self.pyramid {
            Some(pyramid) if level > 0 => pyramid.texel(level, x, y),
            _ => match self.slopes {
                None => self.image.texel(x, y, self.space),
                Some(of) => of.at(&self.image, self.space, self.wrap, x, y),
            },
        }
    }

    /// The coordinates at which texels are looked up.
    #[inline]
    fn coordinates(&self, at: &TexturePoint) -> [f32; 2] {
        // Beyond these coordinates single precision knows no texels.
        [0, 1].map(|i: usize| {
            let c = at.uv[i];
            let c = if c.is_finite() { c.clamp(-MOST_COORDINATE, MOST_COORDINATE) } else { 0.0 };
            // Near 0 single precision is finest, and texels need no division to be found.
            if self.wrap[i] == Wrap::Repeat { c - c.floor() } else { c }
        })
    }

    pub(super) fn at(&self, at: &TexturePoint) -> Texel {
        let uv = self.coordinates(at);
        match self.filter {
            TextureFilter::Nearest => self.nearest(0, uv),
            TextureFilter::Bilinear => self.bilinear(0, uv),
            TextureFilter::Mip => self.mip(uv, &at.axes),
            TextureFilter::Ewa => self.ewa(uv, &at.axes),
            TextureFilter::Stochastic => self.stochastic(uv, &at.axes),
        }
    }

    /// The place in texels of a level; the centre of the first is 0.
    #[inline]
    fn place(&self, level: usize, [u, v]: [f32; 2]) -> [f32; 2] {
        let [width, height] = self.size(level).map(|n| n as f32);
        [u * width - 0.5, (1.0 - v) * height - 0.5]
    }

    pub(super) fn nearest(&self, level: usize, uv: [f32; 2]) -> Texel {
        self.texel(level, self.place(level, uv).map(|x| (x + 0.5).floor() as i64))
    }

    #[inline]
    fn bilinear(&self, level: usize, uv: [f32; 2]) -> Texel {
        if self.slopes.is_some() {
            return self.bilinear_slopes(level, uv);
        }
        let place = self.place(level, uv);
        let [x, y] = place.map(|x| x.floor() as i64);
        let [s, t] = [place[0] - x as f32, place[1] - y as f32];
        let (left, right) = (1.0 - s, s);
        let size = self.size(level);
        let [columns, rows] = [(x, 0), (y, 1)]
            .map(|(first, i): (i64, usize)| [first, first + 1].map(|place| self.wrap[i].place(place, size[i])));
        let rows = rows.map(|row| {
            let [a, b] = columns.map(|column| match (column, row) {
                (Some(x), Some(y)) => self.stored(level, x, y),
                _ => [0.0; 4],
            });
            std::array::from_fn(|c| left * a[c] + right * b[c])
        });
        let [upper, lower]: [Texel; 2] = rows;
        std::array::from_fn(|c| (1.0 - t) * upper[c] + t * lower[c])
    }

    /// [`Self::bilinear`] of slopes: between texels of the image itself the surface is smooth.
    fn bilinear_slopes(&self, level: usize, uv: [f32; 2]) -> Texel {
        let place = self.place(level, uv);
        let [x, y] = place.map(|x| x.floor() as i64);
        let [s, t] = [place[0] - x as f32, place[1] - y as f32];
        let mut value = [0.0; 4];
        for (dx, dy, weight) in
            [(0, 0, (1.0 - s) * (1.0 - t)), (1, 0, s * (1.0 - t)), (0, 1, (1.0 - s) * t), (1, 1, s * t)]
        {
            let texel = self.texel(level, [x + dx, y + dy]);
            value = std::array::from_fn(|c| value[c] + weight * texel[c]);
        }
        if level == 0 { [value[0], value[1], value[0] * value[0], value[1] * value[1]] } else { value }
    }

    /// Calls `each` with the texels between which [`Self::at`] interpolates, and their weights: those of the image, or of its levels.
    /// What other filters average over a footprint counts as one texel.
    pub(super) fn each_texel(&self, at: &TexturePoint, each: &mut dyn FnMut(f32, Texel)) {
        let uv = self.coordinates(at);
        match self.filter {
            TextureFilter::Bilinear => self.each_bilinear(0, uv, 1.0, each),
            TextureFilter::Mip => {
                let (lower, share) = self.levels(self.width_across(&at.axes));
                self.each_bilinear(lower, uv, 1.0 - share, each);
                if share > 0.0 {
                    self.each_bilinear((lower + 1).min(self.last_level()), uv, share, each);
                }
            }
            TextureFilter::Nearest | TextureFilter::Ewa | TextureFilter::Stochastic => each(1.0, self.at(at)),
        }
    }

    /// The four texels of [`Self::bilinear`] with their weights, times a factor.
    fn each_bilinear(&self, level: usize, uv: [f32; 2], factor: f32, each: &mut dyn FnMut(f32, Texel)) {
        let place = self.place(level, uv);
        let [x, y] = place.map(|x| x.floor() as i64);
        let [s, t] = [place[0] - x as f32, place[1] - y as f32];
        for (dx, dy, weight) in
            [(0, 0, (1.0 - s) * (1.0 - t)), (1, 0, s * (1.0 - t)), (0, 1, (1.0 - s) * t), (1, 1, s * t)]
        {
            each(factor * weight, self.texel(level, [x + dx, y + dy]));
        }
    }

    fn mip(&self, uv: [f32; 2], axes: &[[f32; 2]; 2]) -> Texel {
        self.between_levels(uv, self.width_across(axes))
    }

    /// The longer axis of a footprint in texels of the image.
    fn width_across(&self, axes: &[[f32; 2]; 2]) -> f32 {
        let size = self.size(0).map(|n| n as f32);
        let length = |[u, v]: [f32; 2]| (u * size[0]).hypot(v * size[1]);
        length(axes[0]).max(length(axes[1]))
    }

    /// The lower of the two levels whose texels are about `width` texels of the image wide, and the share of the other.
    fn levels(&self, width: f32) -> (usize, f32) {
        let last = self.last_level();
        let level = width.max(1.0).log2().min(last as f32);
        if level.is_nan() || level <= 0.0 {
            return (0, 0.0);
        }
        let lower = (level.floor() as usize).min(last);
        (lower, level - lower as f32)
    }

    /// Between the two levels whose texels are about `width` texels of the image wide.
    fn between_levels(&self, uv: [f32; 2], width: f32) -> Texel {
        let (lower, share) = self.levels(width);
        let a = self.bilinear(lower, uv);
        if share == 0.0 {
            return a;
        }
        let b = self.bilinear((lower + 1).min(self.last_level()), uv);
        std::array::from_fn(|c| a[c] + share * (b[c] - a[c]))
    }

    /// The axes in texels of the image, the longer first, with the shorter one widened.
    fn ellipse(&self, axes: &[[f32; 2]; 2]) -> Option<[[f32; 2]; 2]> {
        let [width, height] = self.size(0).map(|n| n as f32);
        // v grows up, rows grow down.
        let mut axes = axes.map(|[u, v]| [u * width, -v * height]);
        let length = |[x, y]: [f32; 2]| x.hypot(y);
        if length(axes[0]) < length(axes[1]) {
            axes.swap(0, 1);
        }
        let [long, short] = axes.map(length);
        if !long.is_finite() || long <= 0.0 {
            return None;
        }
        // The axes of an ellipse are across each other; those of a footprint on a texture that is skewed are not. The short one is
        // therefore what is left of it across the long one.
        let along = [axes[0][0] / long, axes[0][1] / long];
        let across = [-along[1], along[0]];
        let part = (axes[1][0] * across[0] + axes[1][1] * across[1]).abs().min(short);
        let part = part.max(long / MOST_ANISOTROPY);
        Some([axes[0], across.map(|x| x * part)])
    }

    fn ewa(&self, uv: [f32; 2], axes: &[[f32; 2]; 2]) -> Texel {
        let Some([long, short]) = self.ellipse(axes) else { return self.bilinear(0, uv) };
        let width = long[0].hypot(long[1]);
        if self.slopes.is_some() && width < 2.0 {
            // The ellipse is a texel wider than what is seen. What it holds of a surface that is seen from near, nothing has averaged.
            let share = (width - 1.0).max(0.0);
            let [near, far] = [self.bilinear(0, uv), self.ewa_mean(uv, long, short)];
            return std::array::from_fn(|c| near[c] + share * (far[c] - near[c]));
        }
        self.ewa_mean(uv, long, short)
    }

    fn ewa_mean(&self, uv: [f32; 2], long: [f32; 2], short: [f32; 2]) -> Texel {
        // In the lower level the short axis is two texels or more, so that its ellipses hold enough of them.
        let width = 0.5 * short[0].hypot(short[1]);
        let last = self.last_level();
        let level = width.max(1.0).log2().min(last as f32);
        let lower = (level.floor() as usize).min(last);
        let share = level - lower as f32;
        let a = self.ellipse_mean(lower, uv, long, short);
        if share == 0.0 || lower == last {
            return a;
        }
        let b = self.ellipse_mean(lower + 1, uv, long, short);
        std::array::from_fn(|c| a[c] + share * (b[c] - a[c]))
    }

    /// The mean over an ellipse with the given half axes (in texels of the image), weighed by a Gaussian.
    fn ellipse_mean(&self, level: usize, uv: [f32; 2], long: [f32; 2], short: [f32; 2]) -> Texel {
        let (size, whole) = (self.size(level), self.size(0));
        let scale = [0, 1].map(|i: usize| size[i] as f32 / whole[i] as f32);
        let [a, b] = [long, short].map(|[x, y]| [x * scale[0], y * scale[1]]);
        // The ellipse A x^2 + B x y + C y^2 = F. Its axes are wider by a texel of the image, so that it holds the centre of one (Heckbert
        // 1989); what the texels of the level, which are means over squares, blur by themselves is taken off. A Gaussian that is exp(-2)
        // at its edge has the variance r^2 / 4, a square 1/12.
        let own = scale.map(|s| s * s - (1.0 - s * s) / 3.0);
        let (mut qa, mut qb, mut qc) = (
            a[1] * a[1] + b[1] * b[1] + own[1],
            -2.0 * (a[0] * a[1] + b[0] * b[1]),
            a[0] * a[0] + b[0] * b[0] + own[0],
        );
        let inverse = 1.0 / (qa * qc - 0.25 * qb * qb);
        (qa, qb, qc) = (qa * inverse, qb * inverse, qc * inverse);
        let below = 4.0 * qa * qc - qb * qb;
        let reach = [2.0 * (qc / below).sqrt(), 2.0 * (qa / below).sqrt()];
        let place = self.place(level, uv);
        if !reach.iter().chain(&place).all(|x| x.is_finite()) {
            return self.mean;
        }
        if 4.0 * reach[0] * reach[1] > MOST_TEXELS {
            return self.between_levels(uv, long[0].hypot(long[1]));
        }
        let range = |i: usize| (place[i] - reach[i]).ceil() as i64..=(place[i] + reach[i]).floor() as i64;
        let (mut sum, mut weights) = ([0.0; 4], 0.0);
        for y in range(1) {
            let dy = y as f32 - place[1];
            for x in range(0) {
                let dx = x as f32 - place[0];
                let r2 = qa * dx * dx + qb * dx * dy + qc * dy * dy;
                if r2 < 1.0 {
                    let weight = gaussian(r2);
                    let texel = self.texel(level, [x, y]);
                    sum = std::array::from_fn(|c| sum[c] + weight * texel[c]);
                    weights += weight;
                }
            }
        }
        if weights > 0.0 { sum.map(|v| v / weights) } else { self.bilinear(level, uv) }
    }

    fn stochastic(&self, uv: [f32; 2], axes: &[[f32; 2]; 2]) -> Texel {
        let [u1, u2, s, t] = hashed(uv, axes);
        let place = self.place(0, uv);
        // Bilinear weights as probabilities.
        let near = |[x, y]: [f32; 2]| self.texel(0, [(x + s).floor() as i64, (y + t).floor() as i64]);
        let Some([long, short]) = self.ellipse(axes) else {
            return near(place);
        };
        // The Gaussian of the filter, cut off at the edge of the ellipse like the other; with the widening by a texel.
        let r2 = -(1.0 - u1 * (1.0 - (-FALLOFF).exp())).ln() / FALLOFF;
        let (r, (sin, cos)) = (r2.sqrt(), (std::f32::consts::TAU * u2).sin_cos());
        let wider = |axis: [f32; 2]| {
            let length = axis[0].hypot(axis[1]);
            let factor = if length > 0.0 { (length * length + 1.0).sqrt() / length } else { 0.0 };
            axis.map(|x| x * factor)
        };
        let (a, b) = (wider(long), wider(short));
        near([0, 1].map(|i: usize| place[i] + r * (cos * a[i] + sin * b[i])))
    }
}

/// The weight at this square of the radius. It does not fall to 0 at the edge, so that the stochastic filter draws from the same.
#[inline]
fn gaussian(r2: f32) -> f32 {
    static TABLE: LazyLock<[f32; 256]> =
        LazyLock::new(|| std::array::from_fn(|i| (-FALLOFF * (i as f32 + 0.5) / 256.0).exp()));
    TABLE[((r2 * 256.0) as usize).min(255)]
}

/// Four numbers in [0, 1) that a lookup determines, so that the same path reads the same texel on any thread.
fn hashed(uv: [f32; 2], axes: &[[f32; 2]; 2]) -> [f32; 4] {
    let mut state = 0x9e37_79b9_7f4a_7c15_u64;
    let mut mix = |word: u32| {
        state = (state ^ u64::from(word)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        state = (state ^ (state >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        state ^= state >> 31;
        state
    };
    uv.into_iter().chain(axes.iter().flatten().copied()).for_each(|x| {
        mix(x.to_bits());
    });
    let part = |bits: u64| (bits & 0xff_ffff) as f32 / (1 << 24) as f32;
    let [a, b] = [mix(1), mix(2)];
    [part(a >> 40), part(a >> 8), part(b >> 40), part(b >> 8)]
}

/// The mean of the texels and the range of each channel.
fn statistics(image: &TexelImage, threads: usize, value: impl Fn(u32, u32) -> Texel + Sync) -> (Texel, [Texel; 2]) {
    let row = |y: u32| {
        let (mut sum, mut low, mut high) = ([0.0_f64; 4], [f32::INFINITY; 4], [f32::NEG_INFINITY; 4]);
        for x in 0..image.width() {
            let texel = value(x, y);
            for c in 0..4 {
                sum[c] += f64::from(texel[c]);
                low[c] = low[c].min(texel[c]);
                high[c] = high[c].max(texel[c]);
            }
        }
        (sum, low, high)
    };
    let rows = rows(image.height(), threads, row);
    // Sums are taken row by row in order: the same on any number of threads.
    let count = f64::from(image.width()) * f64::from(image.height());
    let (mut sum, mut low, mut high) = ([0.0_f64; 4], [f32::INFINITY; 4], [f32::NEG_INFINITY; 4]);
    for (s, l, h) in rows {
        for c in 0..4 {
            sum[c] += s[c];
            low[c] = low[c].min(l[c]);
            high[c] = high[c].max(h[c]);
        }
    }
    (sum.map(|s| (s / count) as f32), [low, high])
}
