//! Materials of which textures vary parameters, opacity or normals.

use std::sync::Arc;

use super::material::turned_with_tangents;
use super::prepared_textures::{PreparedTextures, Reads, VertexColors};
use super::projection::Coordinates;
use super::relief::Relief;
use super::{SurfaceDetail, VaryingMaterial};
use crate::bsdf::{Black, Bsdf, ByWavelength, FilmRange, Lobes, Mix, Model as _, TwoSided};
use crate::desc::{
    BsdfDesc, MaterialDesc, Parameter, SceneDesc, SpectrumKey, THICKEST_FILM, TextureBinding, TextureChannel,
    TextureKey, TextureMapping, TextureSource, ThinFilmDesc,
};
use crate::embree::Device;
use crate::math::{DVec3, Vec3};
use crate::spectrum::Rgb;
use crate::texture::{SlopesOf, Texel, Texture, TexturePoint};
use crate::{Error, Result};

/// The place of a channel in a texel; `None` for the default.
pub(super) fn channel_of(channel: TextureChannel) -> Option<usize> {
    match channel {
        TextureChannel::Default => None,
        TextureChannel::Red => Some(0),
        TextureChannel::Green => Some(1),
        TextureChannel::Blue => Some(2),
        TextureChannel::Alpha => Some(3),
    }
}

/// What a filter averages of the texture of a material's normals; `None` where it averages nothing, and for other parameters.
fn slopes_of(binding: &TextureBinding, source: &TextureSource) -> Option<SlopesOf> {
    let TextureSource::Image(image) = source else { return None };
    match binding.key {
        _ if !image.filter.has_levels() => None,
        TextureKey::Normal => Some(SlopesOf::Normals),
        TextureKey::Bump => Some(SlopesOf::Heights(channel_of(binding.channel).unwrap_or(0))),
        _ => None,
    }
}

/// Where a texture lies, from texture coordinates or points of the scene frame.
#[derive(Clone, Copy, Debug)]
pub(super) enum Placement {
    /// The matrix by rows, and what is added.
    Uv { matrix: [[f32; 2]; 2], offset: [f32; 2] },
    /// Factors, and what is added to a point of the scene frame times these.
    Space { scale: DVec3, offset: DVec3 },
}

impl Placement {
    pub fn new(mapping: &TextureMapping, centre: DVec3) -> Self {
        match *mapping {
            TextureMapping::Uv { scale: [su, sv], rotation, offset, .. }
            | TextureMapping::Projected { scale: [su, sv], rotation, offset, .. } => {
                let (sin, cos) = rotation.sin_cos();
                let matrix = [[cos * su, -sin * sv], [sin * su, cos * sv]];
                Self::Uv { matrix: matrix.map(|row| row.map(|x| x as f32)), offset: offset.map(|x| x as f32) }
            }
            TextureMapping::Space { scale, offset } => Self::Space { scale, offset: offset + centre * scale },
        }
    }

    /// The derivatives of the position by the coordinates of the image, which may be turned and mirrored on the surface, from those
    /// by the coordinates of the surface.
    pub fn tangents(&self, [dpdu, dpdv]: [Vec3; 2]) -> [Vec3; 2] {
        let Self::Uv { matrix: [[a, b], [c, d]], .. } = *self else { return [dpdu, dpdv] };
        let determinant = a * d - b * c;
        let tangents = [(d * dpdu - c * dpdv) / determinant, (a * dpdv - b * dpdu) / determinant];
        if tangents.iter().all(|it| it.is_finite()) { tangents } else { [dpdu, dpdv] }
    }

    pub fn point(&self, at: &SurfaceDetail, with_axes: bool) -> TexturePoint {
        match self {
            Self::Uv { matrix, offset } => {
                let turned = |[u, v]: [f32; 2]| matrix.map(|[a, b]| a * u + b * v);
                let [u, v] = turned(at.uv);
                let axes = if with_axes { at.uv_axes().map(turned) } else { [[0.0; 2]; 2] };
                TexturePoint { uv: [u + offset[0], v + offset[1]], axes, ..TexturePoint::default() }
            }
            Self::Space { scale, offset } => {
                let p = at.p.as_dvec3() * scale + offset;
                TexturePoint { p: p.as_vec3a(), width: at.footprint, ..TexturePoint::default() }
            }
        }
    }
}

fn times(a: Texel, b: Texel) -> Texel {
    std::array::from_fn(|i| a[i] * b[i])
}

/// A texture bound to a parameter.
#[derive(Clone, Debug)]
pub(super) struct Bound {
    pub key: TextureKey,
    pub texture: Arc<Texture>,
    pub coordinates: Coordinates,
    pub placement: Placement,
    channel: usize,
    /// Whether the parameter, if it is a colour, takes all channels.
    is_whole: bool,
    pub strength: f32,
    asks_footprint: bool,
    /// The colours of vertices, by which the texture is multiplied.
    colors: Option<VertexColors>,
    /// Number of steps between 0 and 1 to which the parameter is rounded; 0 for none.
    steps: f32,
}

impl Bound {
    fn texel(&self, at: &SurfaceDetail) -> Texel {
        match &self.coordinates {
            Coordinates::Own => self.texel_at(at),
            coordinates => self.texel_at(&coordinates.apply(at)),
        }
    }

    /// The texel where `at` has the texture's own coordinates.
    pub fn texel_at(&self, at: &SurfaceDetail) -> Texel {
        let texel = self.texture.at(&self.placement.point(at, self.asks_footprint));
        if self.colors.is_some() { times(texel, at.vertex_color()) } else { texel }
    }

    /// The colours between which the texture interpolates there, and their weights.
    fn colors(&self, at: &SurfaceDetail) -> Vec<(f32, Rgb)> {
        let own;
        let at = match &self.coordinates {
            Coordinates::Own => at,
            coordinates => {
                own = coordinates.apply(at);
                &own
            }
        };
        let mut colors = Vec::with_capacity(4);
        self.texture.each_texel(&self.placement.point(at, self.asks_footprint), &mut |weight, texel| {
            let texel = if self.colors.is_some() { times(texel, at.vertex_color()) } else { texel };
            colors.push((weight, self.color(&texel)));
        });
        colors
    }

    fn mean(&self) -> Texel {
        let mean = self.texture.mean();
        self.colors.map_or(mean, |colors| times(mean, colors.mean))
    }

    /// The least (0) or greatest (1) of each channel.
    fn end(&self, end: usize) -> Texel {
        let texel = self.texture.range()[end];
        self.colors.map_or(texel, |colors| times(texel, colors.range[end]))
    }

    pub fn number(&self, texel: &Texel) -> f32 {
        texel[self.channel]
    }

    fn color(&self, texel: &Texel) -> Rgb {
        if self.is_whole { Rgb::new(texel[0], texel[1], texel[2]) } else { Rgb::splat(texel[self.channel]) }
    }

    /// Sets the parameter of a model, of which the description is the factor.
    fn apply(&self, desc: &mut BsdfDesc, texel: &Texel) {
        match desc.parameter(self.key) {
            Some(Parameter::Color(color)) => {
                *color = (*color * self.color(texel)).max(Rgb::ZERO).min(Rgb::ONE);
            }
            Some(Parameter::Number(number, [low, high])) => {
                let value = *number * self.number(texel);
                let value = if self.steps == 0.0 { value } else { rounded(value, self.steps) };
                *number = if value.is_nan() { low } else { value.clamp(low, high) };
            }
            None => {}
        }
    }
}

/// A parameter of tables at the nearest of its steps. What is not smooth stays rough.
fn rounded(value: f32, steps: f32) -> f32 {
    let step = (value * steps).round();
    (if value > 0.0 { step.max(1.0) } else { step }) / steps
}

/// Steps to which parameters of tables are rounded, by how many of them vary: the product of steps is the number of tables.
const STEPS: [f32; 4] = [256.0, 64.0, 16.0, 8.0];

/// Binds the textures of a material.
struct Binder<'a> {
    desc: &'a SceneDesc,
    prepared: &'a mut PreparedTextures,
    before: Option<&'a PreparedTextures>,
    device: &'a Device,
    centre: DVec3,
    /// Whether facets are widened by the variance of slopes.
    widens: bool,
}

impl Binder<'_> {
    fn bind(&mut self, binding: &TextureBinding, steps: f32) -> Result<Bound> {
        let Some(desc) = self.desc.textures.get(binding.texture) else {
            return Err(Error::invalid(format!("textures[{}]", binding.texture), "there is no such texture"));
        };
        let reads = match slopes_of(binding, &desc.source) {
            Some(of) => Reads::Slopes(of),
            None if binding.key.is_color() => Reads::Color,
            None => Reads::Numbers,
        };
        let texture = self.prepared.get(desc, reads, self.before, self.device)?;
        let is_opaque = match &desc.source {
            TextureSource::Image(it) => !it.image.has_opacity(),
            TextureSource::Procedural(_) | TextureSource::White => true,
        };
        let is_opaque = is_opaque && !desc.vertex_colors;
        let is_of_opacity = binding.key == TextureKey::Opacity && !is_opaque;
        let channel = channel_of(binding.channel).unwrap_or(if is_of_opacity { 3 } else { 0 });
        Ok(Bound {
            key: binding.key,
            asks_footprint: texture.asks_footprint(),
            texture,
            coordinates: Coordinates::new(&desc.mapping, self.centre),
            placement: Placement::new(&desc.mapping, self.centre),
            channel,
            is_whole: binding.channel == TextureChannel::Default,
            strength: binding.strength,
            colors: desc.vertex_colors.then(|| self.prepared.vertex_colors(self.desc)),
            steps,
        })
    }

    /// The textures of a material's model, and the steps to which parameters of tables are rounded.
    fn of_model(&mut self, material: &MaterialDesc) -> Result<(Box<[Bound]>, f32)> {
        let own = material.textures.iter().filter(|binding| !binding.key.is_of_surface());
        let mut tables = own.clone().filter(|binding| binding.key.is_of_tables()).count();
        if self.widens {
            let varied = own.clone().filter(|binding| binding.key.is_width()).count();
            tables += material.bsdf.widths().saturating_sub(varied);
        }
        let steps = STEPS[tables.clamp(1, STEPS.len()) - 1];
        let bound = own.map(|it| self.bind(it, if it.key.is_of_tables() { steps } else { 0.0 })).collect::<Result<_>>();
        Ok((bound?, steps))
    }

    /// The recipes of two parts, which come before the whole.
    fn parts(&mut self, parts: [usize; 2], whole: usize) -> Result<Box<[Recipe; 2]>> {
        let mut part = |part: usize| {
            if part < whole { self.recipe(part) } else { Ok(Recipe::black()) }
        };
        Ok(Box::new([part(parts[0])?, part(parts[1])?]))
    }

    fn recipe(&mut self, number: usize) -> Result<Recipe> {
        let (before, rest) = self.desc.materials.split_at(number.min(self.desc.materials.len()));
        let Some(material) = rest.first() else { return Ok(Recipe::black()) };
        let is_mixed_body = matches!(material.bsdf, BsdfDesc::Mix { .. }) && material.body(before).is_some();
        Ok(match material.bsdf {
            desc if !varies(material, before) && !self.widens && !is_mixed_body => {
                let body = desc.interior().is_some().then_some(desc);
                let by = ByWavelength::new(material);
                let bsdf = Bsdf::of_materials(&desc, before).by_wavelength(&desc, &by, None, None);
                Recipe::Fixed { bsdf: Box::new(bsdf), body, by }
            }
            BsdfDesc::Mix { materials, .. } => {
                let parts = self.parts(materials, number)?;
                Recipe::Mix { desc: material.bsdf, parts, weight: self.of_model(material)?.0 }
            }
            BsdfDesc::TwoSided { front, back } => Recipe::TwoSided(self.parts([front, back], number)?),
            desc => {
                let (bound, steps) = self.of_model(material)?;
                let film = material.film.map(|film| films_of(film, &bound));
                let (is_body, by) = (desc.interior().is_some(), ByWavelength::with_film(material, film));
                let thickness = material.film.map_or(0.0, |film| film.thickness);
                Recipe::Model { desc, bound, steps, is_body, by, thickness }
            }
        })
    }
}

/// The films of a material, of which a texture may vary the thickness.
fn films_of(film: ThinFilmDesc, bound: &[Bound]) -> FilmRange {
    let Some(bound) = bound.iter().find(|bound| bound.key == TextureKey::FilmThickness) else { return film.into() };
    let end = |end: usize| film.thickness * bound.number(&bound.end(end));
    let [least, most] = [0, 1].map(|it| end(it).clamp(0.0, THICKEST_FILM as f32));
    FilmRange { ior: film.ior, thickness: [least.min(most), most] }
}

/// Whether textures vary the model of a material or of one of its parts.
fn varies(material: &MaterialDesc, materials: &[MaterialDesc]) -> bool {
    let part_varies = |part: usize| materials.get(part).is_some_and(|it| varies(it, &materials[..part]));
    material.textures.iter().any(|binding| !binding.key.is_of_surface())
        || match material.bsdf {
            BsdfDesc::Mix { materials: [a, b], .. } | BsdfDesc::TwoSided { front: a, back: b } => {
                part_varies(a) || part_varies(b)
            }
            _ => false,
        }
}

/// Whether a material or one of its parts has facets that are not smooth.
fn has_facets(material: &MaterialDesc, materials: &[MaterialDesc]) -> bool {
    let of_part = |part: usize| materials.get(part).is_some_and(|it| has_facets(it, &materials[..part]));
    match material.bsdf {
        BsdfDesc::Mix { materials: [a, b], .. } | BsdfDesc::TwoSided { front: a, back: b } => of_part(a) || of_part(b),
        bsdf => bsdf.widths() > 0,
    }
}

/// The texture of a material's normals.
fn relief_of(material: &MaterialDesc) -> Option<&TextureBinding> {
    material.textured(TextureKey::Normal).or_else(|| material.textured(TextureKey::Bump))
}

/// What a filter averages of the texture of a material's normals.
fn averaged_slopes(material: &MaterialDesc, desc: &SceneDesc) -> Option<SlopesOf> {
    relief_of(material).and_then(|binding| slopes_of(binding, &desc.textures.get(binding.texture)?.source))
}

/// Whether the facets of a material are widened by what a filter averages of its normals.
fn is_widened(desc: &SceneDesc, number: usize) -> bool {
    let material = &desc.materials[number];
    averaged_slopes(material, desc).is_some() && has_facets(material, &desc.materials[..number])
}

/// Whether the Bsdf of a material depends on the place.
pub(super) fn has_varying_bsdf(desc: &SceneDesc, number: usize) -> bool {
    varies(&desc.materials[number], &desc.materials[..number]) || is_widened(desc, number)
}

/// How the Bsdf at a point is made.
#[derive(Debug)]
enum Recipe {
    /// The same everywhere; of a body, the description, since its surface is another one in each medium around it.
    Fixed { bsdf: Box<Bsdf>, body: Option<BsdfDesc>, by: ByWavelength },
    /// A model with its parameters, the steps to which widened facets are rounded, whether its surfaces bound bodies, and the
    /// thickness of its film \[nm\].
    Model { desc: BsdfDesc, bound: Box<[Bound]>, steps: f32, is_body: bool, by: ByWavelength, thickness: f32 },
    /// A mixture.
    Mix { desc: BsdfDesc, parts: Box<[Recipe; 2]>, weight: Box<[Bound]> },
    /// A model for each side.
    TwoSided(Box<[Recipe; 2]>),
}

impl Recipe {
    fn black() -> Self {
        Self::Fixed { bsdf: Box::new(Bsdf::Black(Black)), body: None, by: ByWavelength::default() }
    }

    /// The Bsdf where the textures have the texels that `texel` gives, and slopes vary so much where a filter has averaged them.
    /// `around`: the index of refraction around a body, where it is not the one that the description states.
    /// `spread`: the point, for paths in wavelengths, where texels become spectra before they are interpolated.
    fn bsdf(
        &self,
        texel: &dyn Fn(&Bound) -> Texel,
        variance: f32,
        around: Option<f32>,
        spread: Option<&SurfaceDetail>,
    ) -> Bsdf {
        let of = |part: &Self| part.bsdf(texel, variance, around, spread);
        match self {
            Self::Fixed { bsdf, body, by } => match (around, body) {
                (Some(_), Some(desc)) => Bsdf::at_point(desc, around).by_wavelength(desc, by, around, None),
                _ => Bsdf::clone(bsdf),
            },
            Self::Model { desc, bound, steps, is_body, by, thickness } => {
                let stated = desc;
                let film = bound.iter().find(|bound| bound.key == TextureKey::FilmThickness);
                let thickness = film.map(|bound| thickness * bound.number(&texel(bound)));
                let mut desc = applied(desc, bound, texel);
                if variance > 0.0 {
                    desc.widen(variance, |width| rounded(width, *steps));
                }
                let around = around.filter(|_| *is_body);
                let bsdf = Bsdf::at_point(&desc, around).by_wavelength(&desc, by, around, thickness);
                let spread = spread.map_or(Vec::new(), |at| spread_colors(stated, bound, at));
                if spread.is_empty() { bsdf } else { bsdf.with_interpolated_colors(spread) }
            }
            Self::Mix { desc, parts, weight } => {
                let BsdfDesc::Mix { weight, .. } = applied(desc, weight, texel) else { return Bsdf::Black(Black) };
                match weight {
                    0.0 => of(&parts[0]),
                    1.0 => of(&parts[1]),
                    weight => Bsdf::Mix(Mix::new(parts.each_ref().map(of), weight)),
                }
            }
            Self::TwoSided(faces) => Bsdf::TwoSided(TwoSided::new(faces.each_ref().map(of))),
        }
    }

    fn each(&self, f: &mut dyn FnMut(&Bound)) {
        match self {
            Self::Fixed { .. } => {}
            Self::Model { bound, .. } => bound.iter().for_each(f),
            Self::Mix { parts, weight, .. } => {
                weight.iter().for_each(&mut *f);
                parts.iter().for_each(|part| part.each(f));
            }
            Self::TwoSided(faces) => faces.iter().for_each(|face| face.each(f)),
        }
    }
}

/// The colours between which parameters of a model are interpolated at a point, and their weights; none where they are all the same,
/// and of models whose colours are more than a factor.
fn spread_colors(stated: &BsdfDesc, bound: &[Bound], at: &SurfaceDetail) -> Vec<(SpectrumKey, f32, Rgb)> {
    let of = match *stated {
        BsdfDesc::Lambert { albedo: color }
        | BsdfDesc::OrenNayar { albedo: color, .. }
        | BsdfDesc::OrenNayarQualitative { albedo: color, .. }
        | BsdfDesc::Eon { albedo: color, .. }
        | BsdfDesc::Mirror { reflectance: color }
        | BsdfDesc::Sheen { color, .. } => [Some((SpectrumKey::Color, TextureKey::Color, color)), None],
        BsdfDesc::DiffuseTransmission { reflectance, transmittance } => [
            Some((SpectrumKey::Color, TextureKey::Color, reflectance)),
            Some((SpectrumKey::Transmittance, TextureKey::Transmittance, transmittance)),
        ],
        _ => return Vec::new(),
    };
    let (mut spread, mut most) = (Vec::new(), 0.0);
    for (spectrum, key, factor) in of.into_iter().flatten() {
        let Some(bound) = bound.iter().find(|bound| bound.key == key && bound.is_whole) else {
            most += factor.max_element();
            continue;
        };
        let colors = bound.colors(at);
        most += colors.iter().map(|(_, color)| (factor * *color).max_element()).fold(0.0, f32::max);
        if colors.windows(2).any(|pair| pair[0].1 != pair[1].1) {
            let color = |(weight, color): (f32, Rgb)| (spectrum, weight, (factor * color).max(Rgb::ZERO).min(Rgb::ONE));
            spread.extend(colors.into_iter().map(color));
        }
    }
    // Sheets whose textures may sum to more than all light keep the colours that were scaled to sum to less.
    if most > 1.0 && of[1].is_some() { Vec::new() } else { spread }
}

/// The description of a model at a point.
fn applied(desc: &BsdfDesc, bound: &[Bound], texel: &dyn Fn(&Bound) -> Texel) -> BsdfDesc {
    let mut desc = *desc;
    for bound in bound {
        bound.apply(&mut desc, &texel(bound));
    }
    if let BsdfDesc::DiffuseTransmission { reflectance, transmittance } = &mut desc {
        // Two textures may sum to more than all light.
        let scale = (*reflectance + *transmittance).to_array().map(|sum| 1.0 / sum.max(1.0));
        let scale = Rgb::from_array(scale);
        (*reflectance, *transmittance) = (*reflectance * scale, *transmittance * scale);
    }
    desc
}

/// A material of which textures vary something.
#[derive(Debug)]
pub(super) struct Textured {
    recipe: Recipe,
    opacity: Option<Bound>,
    /// The opacity from which a mask is opaque; 0 where there is no mask.
    cutoff: f32,
    normal: Option<Relief>,
    /// Whether facets are widened by what a filter averages of the normals.
    widens: bool,
    mean: Bsdf,
    extremes: Vec<Bsdf>,
    lobes: Lobes,
    asks_footprint: bool,
    asks_tangents: bool,
}

impl Textured {
    /// The material of this number; `None` where no texture varies it.
    ///
    /// # Errors
    /// [`crate::ErrorKind::OutOfMemory`] where the textures are past the allowance of `device`.
    pub fn new(
        desc: &SceneDesc,
        number: usize,
        centre: DVec3,
        device: &Device,
        prepared: &mut PreparedTextures,
        before: Option<&PreparedTextures>,
    ) -> Result<Option<Self>> {
        let material = &desc.materials[number];
        // Emission is that of emitters.
        let of_surface = material
            .textures
            .iter()
            .any(|binding| matches!(binding.key, TextureKey::Opacity | TextureKey::Normal | TextureKey::Bump));
        if !of_surface && !varies(material, &desc.materials[..number]) {
            return Ok(None);
        }
        let slopes = averaged_slopes(material, desc);
        let widens = is_widened(desc, number);
        let mut binder = Binder { desc, prepared, before, device, centre, widens };
        let recipe = binder.recipe(number)?;
        let mut surface =
            |binding: Option<&TextureBinding>| binding.map(|binding| binder.bind(binding, 0.0)).transpose();
        let opacity = surface(material.textured(TextureKey::Opacity))?;
        let cutoff = material.textured(TextureKey::Opacity).map_or(0.0, |binding| binding.cutoff);
        let normal = surface(relief_of(material))?.map(|bound| Relief { bound, has_slopes: slopes.is_some() });
        let recipe_bsdf = |texel: &dyn Fn(&Bound) -> Texel| recipe.bsdf(texel, 0.0, None, None);
        let mean = recipe_bsdf(&Bound::mean);
        // Each parameter at its smallest and largest while the others are at their means; all together; and those of rough surfaces
        // at their smallest while all others are at either end.
        let mut bound_at = Vec::new();
        let mut asks_footprint = normal.as_ref().is_some_and(|it| it.bound.asks_footprint);
        recipe.each(&mut |bound| {
            bound_at.push(std::ptr::from_ref(bound).addr());
            asks_footprint |= bound.asks_footprint;
        });
        let mut extremes = vec![mean.clone()];
        for end in [0, 1] {
            for one in &bound_at {
                let is_it = |bound: &Bound| std::ptr::from_ref(bound).addr() == *one;
                let texel = |bound: &Bound| {
                    if is_it(bound) { bound.end(end) } else { bound.mean() }
                };
                extremes.push(recipe_bsdf(&texel));
            }
            extremes.push(recipe_bsdf(&|bound| bound.end(end)));
            let smoothest = |bound: &Bound| bound.end(if bound.key.is_of_tables() { 0 } else { end });
            extremes.push(recipe_bsdf(&smoothest));
        }
        let lobes = extremes.iter().map(|bsdf| bsdf.lit_lobes()).fold(Lobes::empty(), |all, some| all | some);
        // Footprints are ellipses in the tangents.
        let asks_tangents = asks_footprint || normal.is_some() || extremes.iter().any(|bsdf| bsdf.is_anisotropic());
        Ok(Some(Self { recipe, opacity, cutoff, normal, widens, mean, extremes, lobes, asks_footprint, asks_tangents }))
    }
}

impl Textured {
    fn bsdf_at(&self, at: &SurfaceDetail, around: Option<f32>, spread: Option<&SurfaceDetail>) -> Bsdf {
        let variance = self.normal.as_ref().filter(|_| self.widens).map_or(0.0, |it| it.variance(at));
        let bsdf = self.recipe.bsdf(&|bound| bound.texel(at), variance, around, spread);
        if bsdf.is_anisotropic() { turned_with_tangents(&bsdf, at) } else { bsdf }
    }
}

impl VaryingMaterial for Textured {
    fn bsdf(&self, at: &SurfaceDetail) -> Bsdf {
        self.bsdf_at(at, None, None)
    }

    fn bsdf_in(&self, at: &SurfaceDetail, around: f32) -> Bsdf {
        self.bsdf_at(at, Some(around), None)
    }

    fn bsdf_by_wavelength(&self, at: &SurfaceDetail) -> Bsdf {
        self.bsdf_at(at, None, Some(at))
    }

    fn mean(&self) -> Bsdf {
        self.mean.clone()
    }

    fn extremes(&self) -> Vec<Bsdf> {
        self.extremes.clone()
    }

    fn lobes(&self) -> Lobes {
        self.lobes
    }

    fn is_opaque(&self) -> bool {
        self.opacity.is_none()
    }

    fn opacity(&self, at: &SurfaceDetail) -> f32 {
        let Some(bound) = &self.opacity else { return 1.0 };
        let opacity = bound.number(&bound.texel(at)).clamp(0.0, 1.0);
        match self.cutoff > 0.0 {
            true if opacity >= self.cutoff => 1.0,
            true => 0.0,
            false => opacity,
        }
    }

    fn asks_footprint(&self) -> bool {
        self.asks_footprint
    }

    fn asks_tangents(&self) -> bool {
        self.asks_tangents
    }

    fn is_textured(&self) -> bool {
        true
    }

    fn has_normals(&self) -> bool {
        self.normal.is_some()
    }

    fn normal(&self, at: &SurfaceDetail) -> Vec3 {
        let Some(relief) = &self.normal else { return at.ns };
        relief.normal(at).try_normalize().filter(|n| n.is_finite() && n.dot(at.ns) > 0.0).unwrap_or(at.ns)
    }
}
