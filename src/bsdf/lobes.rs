//! What a Bsdf scatters, as integrators need to know it.

bitflags::bitflags! {
    /// Kinds of lobes: how widely light is scattered, and to which side of the surface.
    ///
    /// Integrators decide by lobes how a surface is treated: which of them find light samples, are stored in photon maps, are
    /// followed by chance alone or are refused (`docs/integrators.md` has the table).
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
    pub struct Lobes: u8 {
        /// Wide reflection, which a photon map or a radiosity element can hold.
        const DIFFUSE_REFLECTION = 1;
        /// Reflection around the mirror direction with a density.
        const GLOSSY_REFLECTION = 1 << 1;
        /// Reflection into one direction: a delta distribution.
        const SPECULAR_REFLECTION = 1 << 2;
        /// Wide transmission.
        const DIFFUSE_TRANSMISSION = 1 << 3;
        /// Transmission around the refracted direction with a density.
        const GLOSSY_TRANSMISSION = 1 << 4;
        /// Transmission into one direction: a delta distribution.
        const SPECULAR_TRANSMISSION = 1 << 5;

        /// Both wide lobes.
        const DIFFUSE = Self::DIFFUSE_REFLECTION.bits() | Self::DIFFUSE_TRANSMISSION.bits();
        /// Both glossy lobes.
        const GLOSSY = Self::GLOSSY_REFLECTION.bits() | Self::GLOSSY_TRANSMISSION.bits();
        /// Both delta lobes.
        const SPECULAR = Self::SPECULAR_REFLECTION.bits() | Self::SPECULAR_TRANSMISSION.bits();
        /// Lobes that have a density, so that light samples can find light for them.
        const SMOOTH = Self::DIFFUSE.bits() | Self::GLOSSY.bits();
        /// Lobes on the side that light comes from.
        const REFLECTION = Self::DIFFUSE_REFLECTION.bits() | Self::GLOSSY_REFLECTION.bits() | Self::SPECULAR_REFLECTION.bits();
        /// Lobes on the other side.
        const TRANSMISSION =
            Self::DIFFUSE_TRANSMISSION.bits() | Self::GLOSSY_TRANSMISSION.bits() | Self::SPECULAR_TRANSMISSION.bits();
    }
}

impl Lobes {
    /// Whether light samples can find light: some lobe has a density.
    #[inline(always)]
    pub const fn are_sampled_by_lights(self) -> bool {
        self.bits() & Self::SMOOTH.bits() != 0
    }

    /// Whether some lobe is wide enough for photon maps, caches and radiosity to hold its light.
    #[inline(always)]
    pub const fn have_diffuse(self) -> bool {
        self.bits() & Self::DIFFUSE.bits() != 0
    }

    /// Whether some lobe is a delta distribution.
    #[inline(always)]
    pub const fn have_specular(self) -> bool {
        self.bits() & Self::SPECULAR.bits() != 0
    }

    /// Whether light that comes from one side counts on the other too.
    #[inline(always)]
    pub const fn have_smooth_transmission(self) -> bool {
        self.bits() & (Self::DIFFUSE_TRANSMISSION.bits() | Self::GLOSSY_TRANSMISSION.bits()) != 0
    }
}

/// What travels along a path, where radiance and importance are scattered differently: at refraction, and by models that
/// are not reciprocal.
///
/// Source: Veach 1997, Sec. 5.2.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TransportMode {
    /// A path from the camera: `wo` points to the camera, and radiance flows along it. Refraction scales radiance by
    /// (n_o / n_i)^2.
    Radiance,
    /// A path from a light, as photons take it: `wo` points to the light, and power flows away from it. Refraction does not
    /// scale power.
    Importance,
}
