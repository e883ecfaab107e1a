//! The table of integrators: all properties of an integrator that are known without running it.
//!
//! Readers of files, the command line, the C interface, the schema, notes of a render and `docs/integrators.md` take
//! names and properties from this table. A new integrator needs its own file in [`crate::integrator`] and a row below.
//! The compiler then requires code that makes the integrator (`render/method.rs`), and tests require its value in
//! `etd_integrator` and its rows in the documents.

/// The properties of an integrator that are known before it runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct IntegratorInfo {
    /// The integrator's name in files and on the command line.
    pub name: &'static str,
    /// The integrator's value in the C enumeration `etd_integrator`.
    pub c_value: u32,
    /// A one-sentence description of what the integrator computes.
    pub description: &'static str,
    /// The bias of the integrator's expected image.
    pub bias: Bias,
    /// The order in which the samples of pixels are taken.
    pub order: SampleOrder,
    /// The structures that are built before samples are taken.
    pub preparation: Preparation,
    /// Whether `maxDepth` limits the length of the integrator's paths.
    pub cut_by_max_depth: bool,
    /// Whether the integrator takes light from emitters at infinity. An integrator that does not refuses scenes with such
    /// emitters.
    pub takes_infinite_emitters: bool,
    /// Whether the integrator takes points whose radiant intensity varies by direction. An integrator that does not refuses scenes
    /// with such points.
    pub takes_directed_points: bool,
    /// Whether media absorb the light of the integrator's paths. An integrator that does not know media refuses scenes in
    /// which one absorbs.
    pub takes_absorption: bool,
    /// How the integrator treats each kind of lobe; `None` for an integrator that chooses another one, whose support
    /// then applies.
    pub lobes: Option<LobeSupport>,
}

impl IntegratorInfo {
    /// Whether the integrator shows the motion of more than the camera: by rays each of which has a time of its own, or by passes of
    /// photons. What is prepared once belongs to one moment.
    pub const fn shows_motion(&self) -> bool {
        matches!(
            self.preparation,
            Preparation::Nothing
                | Preparation::Choice
                | Preparation::PhotonMaps(_, MapRenewal::EachPass | MapRenewal::EachPassByDefault)
        )
    }

    /// Whether paths may carry wavelengths: drawn anew for each path, or for each pass of photons (`progressive` says whether maps that
    /// the user may keep are made anew). What is prepared once would have one set of wavelengths for the whole image.
    pub const fn renders_wavelengths(&self, progressive: bool) -> bool {
        match self.preparation {
            Preparation::Nothing | Preparation::Choice | Preparation::PhotonMaps(_, MapRenewal::EachPass) => true,
            Preparation::PhotonMaps(_, MapRenewal::EachPassByDefault) => progressive,
            Preparation::PhotonMaps(_, MapRenewal::Once) | Preparation::RadiositySolution => false,
        }
    }
}

/// The difference between the expected image of an integrator and the solution of the rendering equation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bias {
    /// The expected image is the true one for any number of samples, unless paths are cut by `maxDepth`.
    Unbiased,
    /// The expected image has an error of this kind, which vanishes as the number of samples grows and which error
    /// estimates include.
    Consistent(&'static str),
    /// The expected image has an error of this kind, which remains for any number of samples and which error estimates
    /// do not include.
    Biased(&'static str),
    /// The bias is that of the integrator that is chosen.
    OfChoice,
}

/// The order in which the samples of pixels are taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SampleOrder {
    /// Many paths are traced at a time, vertex by vertex, so that rays are traced in packets.
    InWaves,
    /// One path is traced after another.
    OneByOne,
    /// One path is traced after another, and each pixel stores the results of its density estimates between samples.
    WithPixelMemory,
    /// The order is that of the integrator that is chosen.
    OfChoice,
}

/// The structures that are built for a scene before samples are taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Preparation {
    /// No structure is built.
    Nothing,
    /// Photon maps.
    PhotonMaps(PhotonMethod, MapRenewal),
    /// A radiosity solution.
    RadiositySolution,
    /// Another integrator is chosen, and its preparation is done.
    Choice,
}

/// A method that reads photon maps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PhotonMethod {
    /// A map of direct light with shadow photons, and a caustic map.
    Direct,
    /// A caustic map.
    Caustic,
    /// A caustic map, and a global map behind a final gather.
    FinalGather,
    /// A caustic map, and records of irradiance.
    IrradianceCache,
    /// A caustic map and a map of indirect light at the first diffuse hit, with one radius for all pixels.
    CommonRadius,
    /// The maps of [`Self::CommonRadius`], with a radius for each pixel.
    PixelRadii,
}

/// When the photon maps of a method are built.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MapRenewal {
    /// The maps are built once.
    Once,
    /// The maps are built for every pass, with radii that shrink.
    EachPass,
    /// The maps are built for every pass unless `photonsProgressive` is false.
    EachPassByDefault,
}

/// How an integrator treats light that a surface scatters in one kind of lobe.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LobeUse {
    /// Paths sample the lobe and continue.
    Followed,
    /// Direct light is estimated by light samples and by the emitters that the lobe's samples hit. No path continues.
    DirectLight,
    /// Light that was stored at other surfaces is gathered there. The surface itself stores nothing.
    Gathered,
    /// Light is stored there (as photons, records or irradiance of elements) and gathered. Paths find the light that is
    /// not stored.
    StoredAndGathered,
    /// The surface counts as black, and a warning says so.
    Ignored,
    /// The scene is refused with an error that names the surface.
    Refused,
}

/// How an integrator treats each kind of lobe.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LobeSupport {
    /// Lobes that are wide in every direction: Lambert's and Oren and Nayar's.
    pub diffuse: LobeUse,
    /// Lobes around a direction that have a density.
    pub glossy: LobeUse,
    /// Lobes of single directions: perfect mirrors and smooth dielectrics.
    pub specular: LobeUse,
}

/// Generates the enumeration, the list of its values and the table from the rows. The comment above a row is the
/// description of its integrator.
macro_rules! integrators {
    ($(
        #[doc = $description:literal]
        $(#[$default:ident])?
        $variant:ident {
            name: $name:literal,
            c_value: $c_value:literal,
            bias: $bias:expr,
            order: $order:expr,
            preparation: $preparation:expr,
            cut_by_max_depth: $cut_by_max_depth:literal,
            takes_infinite_emitters: $takes_infinite_emitters:literal,
            takes_directed_points: $takes_directed_points:literal,
            takes_absorption: $takes_absorption:literal,
            lobes: $lobes:expr,
        }
    )*) => {
        /// A light transport algorithm.
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
        pub enum IntegratorDesc {
            $(#[doc = $description] $(#[$default])? $variant,)*
        }

        impl IntegratorDesc {
            /// All of them.
            pub const ALL: [Self; [$($c_value),*].len()] = [$(Self::$variant),*];

            /// Its row of the table of integrators.
            pub const fn info(self) -> &'static IntegratorInfo {
                match self {
                    $(Self::$variant => {
                        const INFO: IntegratorInfo = IntegratorInfo {
                            name: $name,
                            c_value: $c_value,
                            description: $description.trim_ascii(),
                            bias: $bias,
                            order: $order,
                            preparation: $preparation,
                            cut_by_max_depth: $cut_by_max_depth,
                            takes_infinite_emitters: $takes_infinite_emitters,
                            takes_directed_points: $takes_directed_points,
                            takes_absorption: $takes_absorption,
                            lobes: $lobes,
                        };
                        &INFO
                    })*
                }
            }
        }
    };
}

/// The support of integrators whose paths follow every kind of lobe.
const FOLLOWED: LobeSupport =
    LobeSupport { diffuse: LobeUse::Followed, glossy: LobeUse::Followed, specular: LobeUse::Followed };

/// The support of integrators that store photons on diffuse surfaces. Light paths and eye paths follow all other lobes.
const STORED: LobeSupport = LobeSupport { diffuse: LobeUse::StoredAndGathered, ..FOLLOWED };

integrators! {
    /// Path tracing: all light, by paths from the camera.
    #[default]
    Path {
        name: "path",
        c_value: 0,
        bias: Bias::Unbiased,
        order: SampleOrder::InWaves,
        preparation: Preparation::Nothing,
        cut_by_max_depth: true,
        takes_infinite_emitters: true,
        takes_directed_points: true,
        takes_absorption: true,
        lobes: Some(FOLLOWED),
    }
    /// Direct light, perfect mirrors and glass; no diffuse interreflection.
    Whitted {
        name: "whitted",
        c_value: 1,
        bias: Bias::Biased("light that is scattered more often"),
        order: SampleOrder::OneByOne,
        preparation: Preparation::Nothing,
        cut_by_max_depth: true,
        takes_infinite_emitters: true,
        takes_directed_points: true,
        takes_absorption: true,
        lobes: Some(LobeSupport {
            diffuse: LobeUse::DirectLight,
            glossy: LobeUse::DirectLight,
            specular: LobeUse::Followed,
        }),
    }
    /// Emission and light scattered once.
    Direct {
        name: "direct",
        c_value: 2,
        bias: Bias::Biased("light that is scattered more often"),
        order: SampleOrder::InWaves,
        preparation: Preparation::Nothing,
        cut_by_max_depth: false,
        takes_infinite_emitters: true,
        takes_directed_points: true,
        takes_absorption: true,
        lobes: Some(LobeSupport {
            diffuse: LobeUse::DirectLight,
            glossy: LobeUse::DirectLight,
            specular: LobeUse::DirectLight,
        }),
    }
    /// The report's photon map: direct light from photons, where no shadow photon is among them.
    PhotonDirect {
        name: "photon_direct",
        c_value: 3,
        bias: Bias::Biased("photon maps that are made once"),
        order: SampleOrder::WithPixelMemory,
        preparation: Preparation::PhotonMaps(PhotonMethod::Direct, MapRenewal::Once),
        cut_by_max_depth: true,
        takes_infinite_emitters: true,
        takes_directed_points: true,
        takes_absorption: true,
        lobes: Some(STORED),
    }
    /// Path tracing, with caustics from a photon map.
    Caustic {
        name: "caustic",
        c_value: 4,
        bias: Bias::Consistent("blurred caustics"),
        order: SampleOrder::WithPixelMemory,
        preparation: Preparation::PhotonMaps(PhotonMethod::Caustic, MapRenewal::EachPassByDefault),
        cut_by_max_depth: true,
        takes_infinite_emitters: true,
        takes_directed_points: true,
        takes_absorption: true,
        lobes: Some(STORED),
    }
    /// A global and a caustic photon map, with final gathering.
    Photon {
        name: "photon",
        c_value: 5,
        bias: Bias::Biased("photon maps that are made once"),
        order: SampleOrder::WithPixelMemory,
        preparation: Preparation::PhotonMaps(PhotonMethod::FinalGather, MapRenewal::Once),
        cut_by_max_depth: true,
        takes_infinite_emitters: true,
        takes_directed_points: true,
        takes_absorption: true,
        lobes: Some(STORED),
    }
    /// All light, with indirect diffuse light interpolated between final gathers.
    IrradianceCache {
        name: "irradiance_cache",
        c_value: 6,
        bias: Bias::Biased("the irradiance cache"),
        order: SampleOrder::WithPixelMemory,
        preparation: Preparation::PhotonMaps(PhotonMethod::IrradianceCache, MapRenewal::Once),
        cut_by_max_depth: true,
        takes_infinite_emitters: true,
        takes_directed_points: true,
        takes_absorption: true,
        lobes: Some(STORED),
    }
    /// The diffuse scene solved as a whole, for every view of it.
    Radiosity {
        name: "radiosity",
        c_value: 10,
        bias: Bias::Biased("the radiosity solution"),
        order: SampleOrder::OneByOne,
        preparation: Preparation::RadiositySolution,
        cut_by_max_depth: false,
        takes_infinite_emitters: true,
        takes_directed_points: true,
        takes_absorption: false,
        lobes: Some(LobeSupport {
            diffuse: LobeUse::StoredAndGathered,
            glossy: LobeUse::Refused,
            specular: LobeUse::Ignored,
        }),
    }
    /// Progressive photon mapping: a new map every pass, with one shrinking radius.
    Ppm {
        name: "ppm",
        c_value: 7,
        bias: Bias::Consistent("blurred caustics and indirect light"),
        order: SampleOrder::WithPixelMemory,
        preparation: Preparation::PhotonMaps(PhotonMethod::CommonRadius, MapRenewal::EachPass),
        cut_by_max_depth: true,
        takes_infinite_emitters: true,
        takes_directed_points: true,
        takes_absorption: true,
        lobes: Some(STORED),
    }
    /// Stochastic progressive photon mapping: a new map every pass, with radii that shrink pixel by pixel.
    Sppm {
        name: "sppm",
        c_value: 8,
        bias: Bias::Consistent("blurred caustics and indirect light"),
        order: SampleOrder::WithPixelMemory,
        preparation: Preparation::PhotonMaps(PhotonMethod::PixelRadii, MapRenewal::EachPass),
        cut_by_max_depth: true,
        takes_infinite_emitters: true,
        takes_directed_points: true,
        takes_absorption: true,
        lobes: Some(STORED),
    }
    /// Path tracing, path tracing with a caustic map, or stochastic progressive photon mapping, by what the scene holds; the irradiance cache where a bias is allowed.
    Auto {
        name: "auto",
        c_value: 9,
        bias: Bias::OfChoice,
        order: SampleOrder::OfChoice,
        preparation: Preparation::Choice,
        cut_by_max_depth: true,
        takes_infinite_emitters: true,
        takes_directed_points: true,
        takes_absorption: true,
        lobes: None,
    }
}

impl IntegratorDesc {
    /// Its name in files and on the command line.
    pub const fn name(self) -> &'static str {
        self.info().name
    }

    /// The integrator of this name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|integrator| integrator.name() == name)
    }

    /// Its value in C, of `etd_integrator`.
    pub const fn c_value(self) -> u32 {
        self.info().c_value
    }

    /// The integrator of this value in C.
    pub fn from_c_value(value: u32) -> Option<Self> {
        Self::ALL.into_iter().find(|integrator| integrator.c_value() == value)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_and_values_stand_for_one_integrator_each() {
        for integrator in IntegratorDesc::ALL {
            assert_eq!(IntegratorDesc::from_name(integrator.name()), Some(integrator));
            assert_eq!(IntegratorDesc::from_c_value(integrator.c_value()), Some(integrator));
            // The values have no gaps, so that a host may iterate over them.
            assert!((integrator.c_value() as usize) < IntegratorDesc::ALL.len(), "{integrator:?}");
        }
        assert_eq!(IntegratorDesc::from_c_value(IntegratorDesc::ALL.len() as u32), None);
        assert_eq!(IntegratorDesc::from_name("bdpt"), None);
    }
}
