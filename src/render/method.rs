//! What takes the samples of a render, by its integrator.

use crate::desc::{IntegratorDesc, Preparation, SampleOrder};
use crate::integrator::photon::Gather;
use crate::integrator::radiosity::RadiosityPicture;
use crate::integrator::{Direct, Irradiance, Path, Transport, Whitted};
use crate::spectrum::Rgb;

/// Light transport, ready to take samples.
#[derive(Clone)]
pub(super) enum Method {
    Path,
    Whitted,
    Direct,
    /// With photon maps.
    Gather(Box<Gather>),
    /// Irradiance of points of surfaces, by path tracing.
    Irradiance(Irradiance),
    /// Of a radiosity solution.
    Radiosity(RadiosityPicture),
}

impl Method {
    /// What takes the samples of an integrator, where nothing has to be made before; path tracing until maps or a solution are
    /// there, which [`super::Render`] makes before its first sample.
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

/// The table says of an integrator what its type does: its samples go in waves, or they do not.
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
