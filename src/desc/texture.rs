//! Descriptions of textures, and which parameters of a material they vary.

use std::fmt;
use std::path::PathBuf;
use std::sync::Arc;

use super::{BsdfDesc, ConductorDesc, MicrofacetsDesc, PrincipledDesc};
use crate::math::DVec3;
use crate::spectrum::Rgb;
use crate::texture::{ColorSpace, Procedural, TexelImage, TextureFilter, Wrap};

/// A named texture.
#[derive(Clone, Debug, PartialEq)]
pub struct TextureDesc {
    /// The texture's name.
    pub name: String,
    /// JSON path, for messages.
    pub path: String,
    /// What it shows.
    pub source: TextureSource,
    /// Where on a surface it lies.
    pub mapping: TextureMapping,
    /// Whether it is multiplied by the colours of the mesh's vertices ([`MeshDesc::colors`](super::MeshDesc::colors)), interpolated
    /// over the triangle, and its opacity by theirs. Surfaces without colours of vertices are white and opaque.
    pub vertex_colors: bool,
}

impl TextureDesc {
    /// The colours of vertices alone.
    pub fn of_vertex_colors(name: String, path: String) -> Self {
        Self { name, path, source: TextureSource::White, mapping: TextureMapping::default(), vertex_colors: true }
    }
}

/// What a texture shows.
#[derive(Clone, PartialEq)]
pub enum TextureSource {
    /// An image.
    Image(ImageTextureDesc),
    /// A formula.
    Procedural(Procedural),
    /// White and opaque, to be multiplied by the colours of vertices.
    White,
}

/// An image as a texture.
#[derive(Clone)]
pub struct ImageTextureDesc {
    /// The texels. Textures of the same file share them.
    pub image: Arc<TexelImage>,
    /// The file, where it came from one.
    pub file: Option<PathBuf>,
    /// What the numbers mean. `None` takes [`Self::suggested_space`] for colours and raw numbers for everything else.
    pub color_space: Option<ColorSpace>,
    /// What the format of the file suggests for colours.
    pub suggested_space: ColorSpace,
    /// What lies beyond the edges, to the sides and up and down.
    pub wrap: [Wrap; 2],
    /// How it is filtered.
    pub filter: TextureFilter,
}

impl PartialEq for ImageTextureDesc {
    /// Images are the same if they are the same `Arc`.
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.image, &other.image)
            && (self.color_space, self.suggested_space, self.wrap, self.filter)
                == (other.color_space, other.suggested_space, other.wrap, other.filter)
    }
}

impl fmt::Debug for TextureSource {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Image(it) => {
                let size = format_args!("{} x {} x {}", it.image.width(), it.image.height(), it.image.channels());
                let mut debug = f.debug_struct("Image");
                debug.field("file", &it.file).field("size", &size).field("color_space", &it.color_space);
                debug.field("wrap", &it.wrap).field("filter", &it.filter).finish()
            }
            Self::Procedural(it) => it.fmt(f),
            Self::White => f.write_str("White"),
        }
    }
}

/// Where on a surface a texture lies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TextureMapping {
    /// By texture coordinates: scaled, then turned counter-clockwise by an angle (radians), then moved.
    Uv {
        /// The set of texture coordinates, of which 0 is the first. Surfaces that lack it have the first.
        set: u32,
        /// Factors on u and v.
        scale: [f64; 2],
        /// The angle, radians.
        rotation: f64,
        /// Added at last.
        offset: [f64; 2],
    },
    /// By coordinates that a projection of the world gives, which are then scaled, turned and moved as those of [`Self::Uv`]. For
    /// surfaces without texture coordinates of their own.
    Projected {
        /// The projection.
        projection: Projection,
        /// Factors on u and v: repeats for each scene unit.
        scale: [f64; 2],
        /// The angle, radians.
        rotation: f64,
        /// Added at last.
        offset: [f64; 2],
    },
    /// By the point in world space: scaled, then moved. For formulas.
    Space {
        /// Factors on x, y and z.
        scale: DVec3,
        /// Added at last.
        offset: DVec3,
    },
}

/// How the world is projected to texture coordinates, in scene units.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Projection {
    /// From the six sides of a box: along the axis that the face's normal is closest to, from outside. The coordinates grow to the right
    /// and upwards (y up), as seen from there; on top and below, x goes to the right.
    Box,
    /// Along the x axis, seen from its positive end: u is -z, v is y.
    X,
    /// Along the y axis, seen from above: u is x, v is -z.
    Y,
    /// Along the z axis, seen from its positive end: u is x, v is y.
    Z,
}

impl Projection {
    /// All of them, with what files call them.
    pub const ALL: [(Self, &'static str); 4] =
        [(Self::Box, "box"), (Self::X, "planar-x"), (Self::Y, "planar-y"), (Self::Z, "planar-z")];
}

impl TextureMapping {
    /// The set of texture coordinates that it reads.
    pub fn uv_set(&self) -> u32 {
        if let Self::Uv { set, .. } = self { *set } else { 0 }
    }
}

impl Default for TextureMapping {
    fn default() -> Self {
        Self::Uv { set: 0, scale: [1.0; 2], rotation: 0.0, offset: [0.0; 2] }
    }
}

/// Which number of a texture a parameter takes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum TextureChannel {
    /// Colours take red, green and blue; an opacity takes the texture's opacity if it has one; other numbers take red.
    #[default]
    Default,
    /// Red.
    Red,
    /// Green.
    Green,
    /// Blue.
    Blue,
    /// Opacity.
    Alpha,
}

/// A parameter of a material that a texture varies: its value is that of the description times that of the texture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TextureBinding {
    /// The parameter.
    pub key: TextureKey,
    /// The number of the texture.
    pub texture: usize,
    /// Which number of the texture counts.
    pub channel: TextureChannel,
    /// For [`TextureKey::Normal`]: factor on the slopes. For [`TextureKey::Bump`]: height of a 1 in the texture [scene unit]. Not used
    /// by other parameters.
    pub strength: f32,
    /// For [`TextureKey::Opacity`], in [0, 1]: above 0, the opacity is 1 where the texture has this value or more, and 0 elsewhere (a
    /// mask). 0: the opacity is the texture's. 0 for other parameters.
    pub cutoff: f32,
}

impl TextureBinding {
    /// All channels of a texture for a parameter.
    pub fn whole(key: TextureKey, texture: usize) -> Self {
        Self { key, texture, channel: TextureChannel::Default, strength: 1.0, cutoff: 0.0 }
    }
}

macro_rules! keys {
    ($($(#[$doc:meta])* $key:ident = $name:literal,)*) => {
        /// The parameters that textures can vary.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub enum TextureKey {
            $($(#[$doc])* $key,)*
        }

        impl TextureKey {
            /// All of them.
            pub const ALL: &[Self] = &[$(Self::$key,)*];

            /// What files call it.
            pub fn name(self) -> &'static str {
                match self {
                    $(Self::$key => $name,)*
                }
            }
        }
    };
}

keys! {
    /// `color` of diffuse, reflective, sheen, diffuse-transmission and coated-diffuse materials.
    Color = "color",
    /// `roughness` of materials with facets, of rough diffuse ones and of sheen.
    Roughness = "roughness",
    /// `anisotropy` of materials with facets.
    Anisotropy = "anisotropy",
    /// `rotation` of materials with facets.
    Rotation = "rotation",
    /// `reflectance` of metals.
    Reflectance = "reflectance",
    /// `edgeTint` of metals.
    EdgeTint = "edgeTint",
    /// `transmittance` of diffuse-transmission and thin-refractive materials.
    Transmittance = "transmittance",
    /// `weight` of a mixture.
    Weight = "weight",
    /// [`PrincipledDesc::base_weight`].
    BaseWeight = "base_weight",
    /// [`PrincipledDesc::base_color`].
    BaseColor = "base_color",
    /// [`PrincipledDesc::base_diffuse_roughness`].
    BaseDiffuseRoughness = "base_diffuse_roughness",
    /// [`PrincipledDesc::base_metalness`].
    BaseMetalness = "base_metalness",
    /// [`PrincipledDesc::specular_weight`].
    SpecularWeight = "specular_weight",
    /// [`PrincipledDesc::specular_color`].
    SpecularColor = "specular_color",
    /// [`PrincipledDesc::specular_roughness`].
    SpecularRoughness = "specular_roughness",
    /// [`PrincipledDesc::specular_roughness_anisotropy`].
    SpecularRoughnessAnisotropy = "specular_roughness_anisotropy",
    /// [`PrincipledDesc::specular_rotation`].
    SpecularRotation = "specular_rotation",
    /// [`PrincipledDesc::transmission_weight`].
    TransmissionWeight = "transmission_weight",
    /// [`PrincipledDesc::transmission_color`], where it colours the surface.
    TransmissionColor = "transmission_color",
    /// [`PrincipledDesc::coat_weight`].
    CoatWeight = "coat_weight",
    /// [`PrincipledDesc::coat_color`].
    CoatColor = "coat_color",
    /// [`PrincipledDesc::coat_roughness`].
    CoatRoughness = "coat_roughness",
    /// [`PrincipledDesc::fuzz_weight`].
    FuzzWeight = "fuzz_weight",
    /// [`PrincipledDesc::fuzz_color`].
    FuzzColor = "fuzz_color",
    /// [`PrincipledDesc::fuzz_roughness`].
    FuzzRoughness = "fuzz_roughness",
    /// The thickness of a thin film, as a factor: also values above 1.
    FilmThickness = "filmThickness",
    /// The opacity of any material.
    Opacity = "opacity",
    /// The emission of a material that has one, as a factor: also values above 1.
    Emission = "emission",
    /// The temperature of a material that emits as a black body, as a factor: also values above 1.
    Temperature = "temperature",
    /// The shading normal of any material: red, green and blue are (x + 1) / 2, (y + 1) / 2 and (z + 1) / 2 of a normal in the frame of the
    /// tangents (x along u, y along v).
    Normal = "normal",
    /// Height over the surface, which tilts the shading normal of any material.
    Bump = "bump",
}

impl TextureKey {
    /// The parameter that files call this.
    pub fn by_name(name: &str) -> Option<Self> {
        Self::ALL.iter().copied().find(|key| key.name() == name)
    }

    /// Whether it is not a parameter of the scattering model.
    pub fn is_of_surface(self) -> bool {
        matches!(self, Self::Opacity | Self::Emission | Self::Temperature | Self::Normal | Self::Bump)
    }

    /// Whether it is a colour.
    pub fn is_color(self) -> bool {
        matches!(
            self,
            Self::Color
                | Self::Reflectance
                | Self::EdgeTint
                | Self::Transmittance
                | Self::BaseColor
                | Self::SpecularColor
                | Self::TransmissionColor
                | Self::CoatColor
                | Self::FuzzColor
                | Self::Emission
        )
    }

    /// Whether slopes that a filter averages change it: roughness and anisotropy of facets.
    pub(crate) fn is_width(self) -> bool {
        matches!(
            self,
            Self::Roughness
                | Self::Anisotropy
                | Self::SpecularRoughness
                | Self::SpecularRoughnessAnisotropy
                | Self::CoatRoughness
        )
    }

    /// Whether tables of rough surfaces depend on it: these are made for rounded values.
    pub(crate) fn is_of_tables(self) -> bool {
        matches!(
            self,
            Self::Roughness
                | Self::Anisotropy
                | Self::BaseDiffuseRoughness
                | Self::SpecularWeight
                | Self::SpecularRoughness
                | Self::SpecularRoughnessAnisotropy
                | Self::CoatWeight
                | Self::CoatRoughness
                | Self::FuzzRoughness
                | Self::FilmThickness
        )
    }
}

/// A parameter of a scattering model, to be changed.
pub(crate) enum Parameter<'a> {
    /// A colour in [0, 1].
    Color(&'a mut Rgb),
    /// A number and the range it has to be in.
    Number(&'a mut f32, [f32; 2]),
}

/// Range of shares, weights and roughness.
const SHARE: [f32; 2] = [0.0, 1.0];
/// Range of anisotropy.
const ANISOTROPY: [f32; 2] = [0.0, 0.99];
/// Range of angles.
const ANGLE: [f32; 2] = [-std::f32::consts::TAU, std::f32::consts::TAU];
/// Range of the roughness of fibres.
const FIBRES: [f32; 2] = [0.01, 1.0];

impl BsdfDesc {
    /// The parameter of this model that a texture varies; `None` where it has no such parameter.
    pub(crate) fn parameter(&mut self, key: TextureKey) -> Option<Parameter<'_>> {
        use Parameter::{Color, Number};
        match (self, key) {
            (
                Self::Lambert { albedo: color }
                | Self::OrenNayar { albedo: color, .. }
                | Self::OrenNayarQualitative { albedo: color, .. }
                | Self::Eon { albedo: color, .. }
                | Self::Mirror { reflectance: color }
                | Self::DiffuseTransmission { reflectance: color, .. }
                | Self::Sheen { color, .. }
                | Self::CoatedDiffuse { albedo: color, .. },
                TextureKey::Color,
            )
            | (
                Self::DiffuseTransmission { transmittance: color, .. }
                | Self::ThinDielectric { transmittance: color, .. },
                TextureKey::Transmittance,
            )
            | (
                Self::Conductor { conductor: ConductorDesc::Reflectance { normal: color, .. }, .. },
                TextureKey::Reflectance,
            )
            | (
                Self::Conductor { conductor: ConductorDesc::Reflectance { edge: color, .. }, .. },
                TextureKey::EdgeTint,
            ) => Some(Color(color)),
            (Self::OrenNayar { roughness, .. } | Self::Eon { roughness, .. }, TextureKey::Roughness) => {
                Some(Number(roughness, SHARE))
            }
            (Self::Sheen { roughness, .. }, TextureKey::Roughness) => Some(Number(roughness, FIBRES)),
            (
                Self::Conductor { microfacets, .. }
                | Self::RoughDielectric { microfacets, .. }
                | Self::ThinDielectric { microfacets, .. }
                | Self::CoatedDiffuse { microfacets, .. },
                key,
            ) => microfacets.parameter(key),
            (Self::Mix { weight, .. }, TextureKey::Weight) => Some(Number(weight, SHARE)),
            (Self::Principled(desc), key) => desc.parameter(key),
            _ => None,
        }
    }

    /// Number of parameters that [`Self::widen`] changes: the roughness of facets that are not smooth, and their anisotropy.
    pub(crate) fn widths(&self) -> usize {
        let mut count = 0;
        let mut desc = *self;
        desc.each_facets(|facets| {
            if !facets.are_smooth() {
                count += 1 + usize::from(facets.anisotropy > 0.0);
            }
            facets
        });
        count
    }

    /// Widens the facets of this model by slopes of this variance, each number of them `round` to the nearest of some values
    /// ([`MicrofacetsDesc::widened`]).
    pub(crate) fn widen(&mut self, variance: f32, round: impl Fn(f32) -> f32) {
        self.each_facets(|facets| facets.widened(variance, &round));
    }

    fn each_facets(&mut self, mut change: impl FnMut(MicrofacetsDesc) -> MicrofacetsDesc) {
        match self {
            Self::Conductor { microfacets, .. }
            | Self::RoughDielectric { microfacets, .. }
            | Self::ThinDielectric { microfacets, .. }
            | Self::CoatedDiffuse { microfacets, .. } => *microfacets = change(*microfacets),
            Self::Principled(it) => {
                let specular = change(it.specular_facets());
                (it.specular_roughness, it.specular_roughness_anisotropy) = (specular.roughness, specular.anisotropy);
                if it.coat_weight > 0.0 {
                    let coat = change(it.coat_facets());
                    (it.coat_roughness, it.coat_roughness_anisotropy) = (coat.roughness, coat.anisotropy);
                }
            }
            _ => {}
        }
    }

    /// The parameters of this model that textures can vary.
    pub(crate) fn parameters(&self) -> Vec<TextureKey> {
        let mut desc = *self;
        let keys = TextureKey::ALL.iter().copied();
        keys.filter(|&key| key.is_of_surface() || desc.parameter(key).is_some()).collect()
    }
}

impl MicrofacetsDesc {
    fn parameter(&mut self, key: TextureKey) -> Option<Parameter<'_>> {
        match key {
            TextureKey::Roughness => Some(Parameter::Number(&mut self.roughness, SHARE)),
            TextureKey::Anisotropy => Some(Parameter::Number(&mut self.anisotropy, ANISOTROPY)),
            TextureKey::Rotation => Some(Parameter::Number(&mut self.rotation, ANGLE)),
            _ => None,
        }
    }
}

impl PrincipledDesc {
    fn parameter(&mut self, key: TextureKey) -> Option<Parameter<'_>> {
        use Parameter::{Color, Number};
        Some(match key {
            TextureKey::BaseWeight => Number(&mut self.base_weight, SHARE),
            TextureKey::BaseColor => Color(&mut self.base_color),
            TextureKey::BaseDiffuseRoughness => Number(&mut self.base_diffuse_roughness, SHARE),
            TextureKey::BaseMetalness => Number(&mut self.base_metalness, SHARE),
            TextureKey::SpecularWeight => Number(&mut self.specular_weight, SHARE),
            TextureKey::SpecularColor => Color(&mut self.specular_color),
            TextureKey::SpecularRoughness => Number(&mut self.specular_roughness, SHARE),
            TextureKey::SpecularRoughnessAnisotropy => Number(&mut self.specular_roughness_anisotropy, ANISOTROPY),
            TextureKey::SpecularRotation => Number(&mut self.specular_rotation, ANGLE),
            TextureKey::TransmissionWeight => Number(&mut self.transmission_weight, SHARE),
            // With a depth, the colour is that of the medium inside, which is the same everywhere.
            TextureKey::TransmissionColor if self.transmission_depth == 0.0 => Color(&mut self.transmission_color),
            TextureKey::CoatWeight => Number(&mut self.coat_weight, SHARE),
            TextureKey::CoatColor => Color(&mut self.coat_color),
            TextureKey::CoatRoughness => Number(&mut self.coat_roughness, SHARE),
            TextureKey::FuzzWeight => Number(&mut self.fuzz_weight, SHARE),
            TextureKey::FuzzColor => Color(&mut self.fuzz_color),
            TextureKey::FuzzRoughness => Number(&mut self.fuzz_roughness, FIBRES),
            _ => return None,
        })
    }
}
