//! Any bytes as a photometric web: they are refused with a message, or shine as a lamp can.

#![no_main]

use etendue::math::DVec3;
use etendue::photometry::Web;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    match Web::parse(data) {
        Ok(web) => {
            let flux = web.flux();
            assert!(flux.is_finite() && flux >= 0.0 && web.peak().is_finite());
            for [x, y, z] in [[0.0, 0.0, 1.0], [0.0, 0.0, -1.0], [1.0, 0.0, 0.0], [-0.3, 0.2, 0.1], [0.5, -0.5, -0.1]] {
                let candela = web.candela(DVec3::new(x, y, z));
                assert!((0.0..=web.peak() * (1.0 + 1e-9)).contains(&candela), "{candela}");
            }
            let sides = [true, false].map(|front| web.side(front));
            let of_sides: f64 = sides.iter().flatten().map(Web::flux).sum();
            assert!((of_sides - flux).abs() <= 1e-6 * flux, "{of_sides} {flux}");
            if flux > 0.0 {
                for u in [[0.0, 0.0], [0.5, 0.25], [1.0 - 1e-12, 1.0 - 1e-12]] {
                    let direction = web.sample(u);
                    assert!((direction.length() - 1.0).abs() < 1e-6, "{direction}");
                }
            }
        }
        Err(error) => {
            assert!(error.kind() != etendue::ErrorKind::Internal, "{error}");
            assert!(!error.message().is_empty() && error.message().len() < 2000, "{error}");
        }
    }
});
