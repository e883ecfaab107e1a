//! Types that describe facets and the principled material.

pub use {etd_distribution::*, etd_masking::*};

/// How the slopes of facets are distributed.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum etd_distribution {
    /// Trowbridge and Reitz's distribution (GGX), which has long tails.
    ETD_DISTRIBUTION_GGX = 0,
    /// Beckmann's: a normal distribution of slopes.
    ETD_DISTRIBUTION_BECKMANN = 1,
}

/// Which facets hide others.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum etd_masking {
    /// Smith's, correlated by height.
    ETD_MASKING_SMITH = 0,
    /// Smith's, for the two directions apart.
    ETD_MASKING_SMITH_SEPARABLE = 1,
    /// Torrance and Sparrow's long symmetric grooves. Light that they scatter more than once is left out.
    ETD_MASKING_V_CAVITY = 2,
}

/// The parameters of a principled material. Names and defaults, which are in the initialiser, are those of OpenPBR Surface 1.1
/// where it has them. Colours and weights are in [0, 1]; every number is used as it is, also 0.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct etd_principled {
    /// `sizeof(etd_principled)`.
    pub struct_size: usize,
    /// Factor on `base_color`.
    pub base_weight: f32,
    /// Colour of the diffuse part; reflectance of the metal at normal incidence.
    pub base_color: [f32; 3],
    /// Roughness of the diffuse part, in [0, 1].
    pub base_diffuse_roughness: f32,
    /// Share of metal.
    pub base_metalness: f32,
    /// Factor on the reflectance of the metal and, at normal incidence, of the dielectric.
    pub specular_weight: f32,
    /// Tint of the edge of the metal.
    pub specular_color: [f32; 3],
    /// Perceptual roughness of metal and dielectric, in [0, 1].
    pub specular_roughness: f32,
    /// How much narrower highlights are along one direction, in [0, 0.99].
    pub specular_roughness_anisotropy: f32,
    /// Angle of that direction, degrees in [-360, 360].
    pub specular_rotation_deg: f32,
    /// Index of refraction of the dielectric, above 0 and up to 100.
    pub specular_ior: f32,
    /// Share of the dielectric that light passes, instead of being scattered diffusely.
    pub transmission_weight: f32,
    /// Colour of what is transmitted: of light that has entered and left, or that has travelled `transmission_depth` inside.
    pub transmission_color: [f32; 3],
    /// Share of the surface that has a coat.
    pub coat_weight: f32,
    /// Colour of what passes the coat down and up again along the normal.
    pub coat_color: [f32; 3],
    /// Perceptual roughness of the coat, in [0, 1].
    pub coat_roughness: f32,
    /// Anisotropy of the coat, in [0, 0.99].
    pub coat_roughness_anisotropy: f32,
    /// Index of refraction of the coat, in [1, 100].
    pub coat_ior: f32,
    /// How much light that bounces under the coat darkens the base: 1 is the physical darkening.
    pub coat_darkening: f32,
    /// Share of the surface that is covered by fuzz.
    pub fuzz_weight: f32,
    /// Colour of the fuzz.
    pub fuzz_color: [f32; 3],
    /// Perceptual roughness of the fuzz, in (0, 1].
    pub fuzz_roughness: f32,
    /// 1: the surface is a thin sheet, which does not refract what it transmits (OpenPBR's `geometry_thin_walled`); 0: it is the
    /// boundary of a body.
    pub thin_walled: u32,
    /// 0: light that facets scatter more than once is included; 1: it is left out.
    pub single_scattering: u32,
    /// The distance inside a body after which `transmission_color` is left [scene unit], >= 0. With 0 the colour belongs to the
    /// surface. A thin sheet has no inside.
    pub transmission_depth: f32,
}

enumerations! {
    etd_distribution: ETD_DISTRIBUTION_GGX, ETD_DISTRIBUTION_BECKMANN;
    etd_masking: ETD_MASKING_SMITH, ETD_MASKING_SMITH_SEPARABLE, ETD_MASKING_V_CAVITY;
}

versioned! {
    etd_principled, transmission_depth;
}
