//! Rough boundaries of media.

use super::*;
use etendue::desc::MicrofacetsDesc;

pub fn cases() -> Vec<Entry> {
    vec![
        Entry { id: "A10", title: "furnace of nested rough media", run: furnace },
        Entry { id: "A13", title: "straight through an absorbing body with rough boundaries", run: straight },
    ]
}

/// A boundary of glass of this roughness, smooth for 0.
pub fn frosted(ior: f32, exterior_ior: f32, roughness: f32) -> BsdfDesc {
    if roughness == 0.0 {
        return glass(ior, exterior_ior);
    }
    BsdfDesc::RoughDielectric { ior, exterior_ior, microfacets: MicrofacetsDesc::rough(roughness) }
}

fn furnace(case: &mut Case) {
    for roughness in [0.3, 0.8] {
        nested(case, &[IntegratorDesc::Path, IntegratorDesc::Sppm], 8, roughness, |_, _| {});
    }
}

/// A body that hardly refracts lets light pass straight on, however rough it is.
fn straight(case: &mut Case) {
    let view = camera(DVec3::Z * 4.0, DVec3::ZERO, 0.01);
    let lamp = (plane(DVec3::NEG_Z * 3.0, DVec3::Z, 1e3), BsdfDesc::Black, Some(Rgb::ONE));
    for (what, roughness, anisotropy) in
        [("roughness 0.3", 0.3, 0.0), ("roughness 1", 1.0, 0.0), ("two widths", 0.6, 0.7)]
    {
        let microfacets = MicrofacetsDesc { anisotropy, ..MicrofacetsDesc::rough(roughness) };
        let body = BsdfDesc::RoughDielectric { ior: 1.0002, exterior_ior: 1.0, microfacets };
        let mut desc = scene(view, vec![(ball(DVec3::ZERO, 1.0), body, None), lamp]);
        fill(&mut desc, [0], ABSORPTION, 0);
        let image = image(&build(&desc), IntegratorDesc::Path, case.count(64, 1024), 1);
        for (i, exact) in left_after(2.0).into_iter().enumerate() {
            // Facets at grazing angles reflect and refract all the same.
            case.biased_mean(format!("{what}, channel {i}"), channel(&image, i), exact, (2e-3, pick(case, 2e-3, 1e-3)));
        }
    }
}
