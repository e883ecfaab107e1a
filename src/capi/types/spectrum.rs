//! Types of spectra.

use super::numbers::{EtdIlluminant, EtdSpectrumKind};
pub use {etd_illuminant::*, etd_spectrum_kind::*, etd_spectrum_target::*};

/// What says how a spectrum is.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum etd_spectrum_kind {
    /// Samples of wavelength and value.
    ETD_SPECTRUM_SAMPLES = 0,
    /// An illuminant of the CIE.
    ETD_SPECTRUM_ILLUMINANT = 1,
    /// A phase of daylight by its temperature.
    ETD_SPECTRUM_DAYLIGHT = 2,
    /// A black body by its temperature.
    ETD_SPECTRUM_BLACK_BODY = 3,
}

/// Illuminants of CIE 015:2018 and, of fluorescent lamps, CIE 15:2004.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum etd_illuminant {
    /// Tungsten.
    ETD_ILLUMINANT_A = 0,
    /// Daylight of about 5003 K.
    ETD_ILLUMINANT_D50 = 1,
    /// Daylight of about 5503 K.
    ETD_ILLUMINANT_D55 = 2,
    /// Daylight of about 6504 K, the white of Rec. 709.
    ETD_ILLUMINANT_D65 = 3,
    /// Daylight of about 7504 K.
    ETD_ILLUMINANT_D75 = 4,
    /// The same power at all wavelengths.
    ETD_ILLUMINANT_E = 5,
    /// A fluorescent lamp of about 6430 K, of a broad band.
    ETD_ILLUMINANT_FL1 = 6,
    /// A fluorescent lamp of about 4230 K, of a broad band.
    ETD_ILLUMINANT_FL2 = 7,
    /// A fluorescent lamp of about 3450 K, of a broad band.
    ETD_ILLUMINANT_FL3 = 8,
    /// A fluorescent lamp of about 2940 K, of a broad band.
    ETD_ILLUMINANT_FL4 = 9,
    /// A fluorescent lamp of about 6350 K, of a broad band.
    ETD_ILLUMINANT_FL5 = 10,
    /// A fluorescent lamp of about 4150 K, of a broad band.
    ETD_ILLUMINANT_FL6 = 11,
    /// A fluorescent lamp of about 6500 K, of several bands.
    ETD_ILLUMINANT_FL7 = 12,
    /// A fluorescent lamp of about 5000 K, of several bands.
    ETD_ILLUMINANT_FL8 = 13,
    /// A fluorescent lamp of about 4150 K, of several bands.
    ETD_ILLUMINANT_FL9 = 14,
    /// A fluorescent lamp of about 5000 K, of three narrow bands.
    ETD_ILLUMINANT_FL10 = 15,
    /// A fluorescent lamp of about 4000 K, of three narrow bands.
    ETD_ILLUMINANT_FL11 = 16,
    /// A fluorescent lamp of about 3000 K, of three narrow bands.
    ETD_ILLUMINANT_FL12 = 17,
}

/// What can have a spectrum of its own.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum etd_spectrum_target {
    /// The emission of a surface.
    ETD_SPECTRUM_OF_SURFACE = 0,
    /// A point light of any kind.
    ETD_SPECTRUM_OF_POINT_LIGHT = 1,
    /// A distant light.
    ETD_SPECTRUM_OF_DISTANT_LIGHT = 2,
    /// The environment, whose number is 0, unless it is a sky by a formula.
    ETD_SPECTRUM_OF_ENVIRONMENT = 3,
    /// Of a material: what a diffuse or reflective one, fibres or a sheet that transmits diffusely reflect, in [0, 1].
    ETD_SPECTRUM_OF_COLOR = 4,
    /// Of a material: what a sheet that transmits diffusely lets through, in [0, 1].
    ETD_SPECTRUM_OF_TRANSMITTANCE = 5,
    /// Of a material: what a conductor reflects at normal incidence, in [0, 1].
    ETD_SPECTRUM_OF_REFLECTANCE = 6,
    /// Of a material: index of refraction of a conductor, above 0.
    ETD_SPECTRUM_OF_ETA = 7,
    /// Of a material: extinction coefficient of a conductor.
    ETD_SPECTRUM_OF_K = 8,
    /// Of a material: absorption coefficient inside a refractive body [1 / scene unit].
    ETD_SPECTRUM_OF_ABSORPTION = 9,
    /// Of a material: emitted radiance.
    ETD_SPECTRUM_OF_EMISSION = 10,
}

/// A spectrum. Illuminants and daylight as light are of luminance 1, which is 683 cd m^-2 for a radiance of 1; black bodies and samples
/// are absolute, for a radiance in W m^-2 sr^-1 nm^-1.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct etd_spectrum {
    /// `sizeof(etd_spectrum)`.
    pub struct_size: usize,
    /// What says how it is.
    pub kind: EtdSpectrumKind,
    /// With `ETD_SPECTRUM_ILLUMINANT`: which one.
    pub illuminant: EtdIlluminant,
    /// Temperature in kelvin: of daylight in [4000, 25000], of a black body in [500, 1000000].
    pub temperature: f64,
    /// With `ETD_SPECTRUM_SAMPLES`: pairs of a wavelength, nm, in growing order, and a value of 0 or more, which are copied. Between them
    /// the spectrum is linear; light is 0 outside, and everything else as at the nearest sample. `etd_scene_get_spectrum` sets it to NULL.
    pub samples: *const f64,
    /// Number of pairs.
    pub sample_count: usize,
}

enumerations! {
    etd_spectrum_kind: ETD_SPECTRUM_SAMPLES, ETD_SPECTRUM_ILLUMINANT, ETD_SPECTRUM_DAYLIGHT, ETD_SPECTRUM_BLACK_BODY;
    etd_illuminant:
        ETD_ILLUMINANT_A, ETD_ILLUMINANT_D50, ETD_ILLUMINANT_D55, ETD_ILLUMINANT_D65, ETD_ILLUMINANT_D75, ETD_ILLUMINANT_E,
        ETD_ILLUMINANT_FL1, ETD_ILLUMINANT_FL2, ETD_ILLUMINANT_FL3, ETD_ILLUMINANT_FL4, ETD_ILLUMINANT_FL5, ETD_ILLUMINANT_FL6,
        ETD_ILLUMINANT_FL7, ETD_ILLUMINANT_FL8, ETD_ILLUMINANT_FL9, ETD_ILLUMINANT_FL10, ETD_ILLUMINANT_FL11, ETD_ILLUMINANT_FL12;
    etd_spectrum_target:
        ETD_SPECTRUM_OF_SURFACE, ETD_SPECTRUM_OF_POINT_LIGHT, ETD_SPECTRUM_OF_DISTANT_LIGHT, ETD_SPECTRUM_OF_ENVIRONMENT,
        ETD_SPECTRUM_OF_COLOR, ETD_SPECTRUM_OF_TRANSMITTANCE, ETD_SPECTRUM_OF_REFLECTANCE, ETD_SPECTRUM_OF_ETA,
        ETD_SPECTRUM_OF_K, ETD_SPECTRUM_OF_ABSORPTION, ETD_SPECTRUM_OF_EMISSION;
}

versioned! {
    etd_spectrum, sample_count;
}
