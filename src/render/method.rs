//! The integrator that takes the samples of a render.

use crate::desc::{IntegratorDesc, Preparation, SampleOrder};
use crate::integrator::photon::Gather;
use crate::integrator::radiosity::RadiosityPicture;
use crate::integrator::reuse::PathReuse;
use crate::integrator::{Direct, Irradiance, Path, Probes, Transport, Whitted};
use crate::spectrum::{Rgb, SampledSpectrum};

/// An integrator with its settings, and with its maps or its solution where it needs them.
#[derive(Clone)]
pub(super) enum Method {
    Path,
    /// Path tracing whose pixels share hits.
    Reuse(PathReuse),
    Whitted,
    Direct,
    /// Path tracing with photon maps.
    Gather(Box<Gather>),
    /// The same for paths that carry wavelengths.
    SpectralGather(Box<Gather<SampledSpectrum>>),
    /// Irradiance at points of surfaces, by path tracing.
    Irradiance(Irradiance),
    /// Irradiance or radiance at points of space.
    Probes(Probes),
    /// The picture of a radiosity solution.
    Radiosity(RadiosityPicture),
}

impl Method {
    /// Whether the pixels are places of their own instead of what a camera sees.
    pub fn is_of_places(&self) -> bool {
        matches!(self, Self::Irradiance(_) | Self::Probes(_))
    }

    /// What a method of places is called in messages.
    pub fn place_name(&self) -> &'static str {
        match self {
            Self::Irradiance(_) => "a light map",
            _ => "light at given points",
        }
    }

    /// The method of an integrator without preparation. For an integrator that needs maps or a solution, the method is path
    /// tracing until [`super::Render`] has made them, which happens before its first sample.
    pub fn new(integrator: IntegratorDesc) -> Self {
        match integrator {
            IntegratorDesc::Path => Self::Path,
            IntegratorDesc::Whitted => Self::Whitted,
            IntegratorDesc::Direct => Self::Direct,
            IntegratorDesc::PhotonDirect
            | IntegratorDesc::Caustic
            | IntegratorDesc::Photon
            | IntegratorDesc::IrradianceCache
            | IntegratorDesc::Ppm
            | IntegratorDesc::Sppm
            | IntegratorDesc::Radiosity
            | IntegratorDesc::Auto => Self::Path,
        }
    }
}

/// Whether the table of integrators says that samples are taken in waves. The assertions below compare the table with the
/// types of the integrators.
const fn goes_in_waves(integrator: IntegratorDesc) -> bool {
    matches!(integrator.info().order, SampleOrder::InWaves)
}

const _: () = {
    assert!(goes_in_waves(IntegratorDesc::Path) == <Path as Transport<Rgb>>::IN_WAVES);
    assert!(goes_in_waves(IntegratorDesc::Whitted) == <Whitted as Transport<Rgb>>::IN_WAVES);
    assert!(goes_in_waves(IntegratorDesc::Direct) == <Direct as Transport<Rgb>>::IN_WAVES);
    assert!(goes_in_waves(IntegratorDesc::Radiosity) == <RadiosityPicture as Transport<Rgb>>::IN_WAVES);
    let mut i = 0;
    while i < IntegratorDesc::ALL.len() {
        let integrator = IntegratorDesc::ALL[i];
        let reads_maps = matches!(integrator.info().preparation, Preparation::PhotonMaps(..));
        assert!(!reads_maps || goes_in_waves(integrator) == <Gather as Transport<Rgb>>::IN_WAVES);
        i += 1;
    }
};
