//! Parts of a Bsdf, as methods that store light on surfaces take it apart.

#[cfg(test)]
use super::Lobes;
use super::{Bsdf, Model};
use crate::spectrum::Spectrum;

bitflags::bitflags! {
    /// Parts of a Bsdf. The sum of all parts is the whole.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub struct Parts: u8 {
        /// Diffuse lobes: light on them can be stored and gathered.
        const DIFFUSE = 1;
        /// Glossy lobes that are not narrow.
        const GLOSSY = 1 << 1;
        /// Delta lobes, and glossy lobes that are so narrow that they count as delta lobes.
        const NARROW = 1 << 2;
    }
}

impl Parts {
    /// The part to which a model belongs that cannot be taken apart. Glossy lobes are narrow below the width `narrow_below`.
    pub(super) fn of_model<C: Spectrum>(model: &(impl Model<C> + ?Sized), narrow_below: f32) -> Self {
        let lobes = model.lobes();
        if lobes.have_diffuse() {
            Self::DIFFUSE
        } else if lobes.is_empty() {
            Self::empty()
        } else if model.narrowest() < narrow_below {
            Self::NARROW
        } else {
            Self::GLOSSY
        }
    }
}

impl<C: Spectrum> Bsdf<C> {
    /// The parts that the Bsdf has. Glossy lobes are narrow if their width ([`Model::narrowest`]) is below `narrow_below`, which is
    /// above 0.
    pub fn parts(&self, narrow_below: f32) -> Parts {
        match self {
            _ if self.is_black() => Parts::empty(),
            Self::Layered(layered) => layered.parts(narrow_below),
            Self::Mix(mix) => mix.parts(narrow_below),
            Self::TwoSided(two_sided) => two_sided.parts(narrow_below),
            #[cfg(test)]
            Self::LobeMixture(mixture) => mixture.parts(narrow_below),
            whole => Parts::of_model::<C>(whole, narrow_below),
        }
    }

    /// Only one part of the Bsdf, with f and densities of its own; `None` where there is no such part.
    pub fn part(&self, part: Parts, narrow_below: f32) -> Option<Self> {
        match self {
            _ if self.is_black() => None,
            Self::Layered(layered) => layered.part(part, narrow_below).map(Self::Layered),
            Self::Mix(mix) => mix.part(part, narrow_below).map(Self::Mix),
            Self::TwoSided(two_sided) => two_sided.part(part, narrow_below).map(Self::TwoSided),
            #[cfg(test)]
            Self::LobeMixture(mixture) => mixture.part(part, narrow_below).map(Self::LobeMixture),
            whole => part.intersects(Parts::of_model::<C>(whole, narrow_below)).then(|| whole.clone()),
        }
    }
}

/// The lobes of a part, among these single lobes of which the glossy ones have this width.
#[cfg(test)]
pub(super) fn lobes_of(part: Parts, glossy_is_narrow: bool) -> Lobes {
    let mut lobes = Lobes::empty();
    if part.contains(Parts::DIFFUSE) {
        lobes |= Lobes::DIFFUSE;
    }
    if part.contains(if glossy_is_narrow { Parts::NARROW } else { Parts::GLOSSY }) {
        lobes |= Lobes::GLOSSY;
    }
    if part.contains(Parts::NARROW) {
        lobes |= Lobes::SPECULAR;
    }
    lobes
}
