//! The integrator of a render, made for its scene.

use crate::integrator::Irradiance;
use crate::integrator::photon::Gather;
use crate::integrator::radiosity::RadiosityPicture;

/// What estimates the samples of a pass.
#[derive(Clone)]
pub(super) enum Method {
    Path,
    Whitted,
    Direct,
    Gather(Box<Gather>),
    Irradiance(Irradiance),
    Radiosity(RadiosityPicture),
}
