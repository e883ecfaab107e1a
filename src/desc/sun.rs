//! Where the sun stands.
//!
//! Source: The Astronomical Almanac's formulas of low precision (as in Michalsky 1988, "The Astronomical Almanac's algorithm for
//! approximate solar position"): within 0.01 degrees from 1950 to 2050. Refraction, which lifts the sun by half a degree at the horizon,
//! is left out.

use std::f64::consts::TAU;

use crate::math::DVec3;

/// Days from the epoch of time stamps, 1970-01-01, to that of the formulas, 2000-01-01 12:00.
const EPOCH_DAYS: f64 = 10957.5;

/// The direction towards the sun (unit), from a place on the earth at a time: east, north and up.
///
/// `latitude`: degrees north of the equator. `longitude`: degrees east of Greenwich. `seconds`: since 1970-01-01 00:00 UTC, without leap
/// seconds.
pub fn sun_direction(latitude: f64, longitude: f64, seconds: f64) -> DVec3 {
    let days = seconds / 86400.0 - EPOCH_DAYS;
    let turn = |degrees: f64| degrees.rem_euclid(360.0).to_radians();
    let anomaly = turn(357.528 + 0.985_600_3 * days);
    let ecliptic =
        turn(280.460 + 0.985_647_4 * days) + (1.915 * anomaly.sin() + 0.020 * (2.0 * anomaly).sin()).to_radians();
    let (sin_tilt, cos_tilt) = (23.439 - 4e-7 * days).to_radians().sin_cos();
    let ascension = (cos_tilt * ecliptic.sin()).atan2(ecliptic.cos());
    let sin_declination = sin_tilt * ecliptic.sin();
    let cos_declination = (1.0 - sin_declination * sin_declination).sqrt();
    // The sidereal time of Greenwich, in turns.
    let sidereal = (18.697_374_558 / 24.0 + 1.002_737_909_350_795 * days).rem_euclid(1.0);
    let (sin_hour, cos_hour) = (sidereal * TAU + longitude.to_radians() - ascension).sin_cos();
    let (sin_place, cos_place) = latitude.to_radians().sin_cos();
    DVec3::new(
        -cos_declination * sin_hour,
        cos_place * sin_declination - sin_place * cos_declination * cos_hour,
        sin_place * sin_declination + cos_place * cos_declination * cos_hour,
    )
    .normalize()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(time: &str) -> f64 {
        let time = humantime::parse_rfc3339(time).unwrap();
        time.duration_since(std::time::UNIX_EPOCH).unwrap().as_secs_f64()
    }

    fn declination(time: &str) -> f64 {
        // From the pole, the sun is as high as its declination.
        sun_direction(90.0, 0.0, at(time)).z.asin().to_degrees()
    }

    /// Minutes by which the sun is ahead of the clock of Greenwich.
    fn equation_of_time(date: &str) -> f64 {
        let noon = sun_direction(0.0, 0.0, at(&format!("{date}T12:00:00Z")));
        (-noon.x).atan2(noon.z).to_degrees() * 4.0
    }

    /// Equinoxes and solstices, whose times are known to the minute, and the extremes of the equation of time.
    #[test]
    fn the_sun_stands_where_almanacs_have_it() {
        // 2026: 20 March 14:46, 21 June 08:24, 23 September 00:05, 21 December 20:50 UTC.
        for (time, expected) in [
            ("2026-03-20T14:46:00Z", 0.0),
            ("2026-06-21T08:24:00Z", 23.436),
            ("2026-09-23T00:05:00Z", 0.0),
            ("2026-12-21T20:50:00Z", -23.436),
        ] {
            let found = declination(time);
            assert!((found - expected).abs() < 0.01, "{time}: {found}, not {expected}");
        }
        for (date, minutes) in [("2026-02-11", -14.2), ("2026-11-03", 16.4), ("2026-05-14", 3.7), ("2026-07-26", -6.5)]
        {
            let found = equation_of_time(date);
            assert!((found - minutes).abs() < 0.15, "{date}: {found}, not {minutes}");
        }
    }

    #[test]
    fn the_sun_goes_from_east_to_west_by_the_south() {
        let munich = |hour: u32| sun_direction(48.137, 11.575, at(&format!("2026-06-21T{hour:02}:00:00Z")));
        let (morning, noon, evening) = (munich(6), munich(11), munich(17));
        assert!(
            morning.x > 0.7 && evening.x < -0.7 && noon.y < -0.3 && noon.x.abs() < 0.2,
            "{morning} {noon} {evening}"
        );
        // At noon of the solstice, 90 - latitude + 23.44 degrees high.
        let highest = (0..120)
            .map(|minute| sun_direction(48.137, 11.575, at("2026-06-21T10:00:00Z") + 60.0 * f64::from(minute)).z);
        let highest = highest.fold(0.0, f64::max).asin().to_degrees();
        assert!((highest - (90.0 - 48.137 + 23.436)).abs() < 0.01, "{highest}");
        // In the south it stands in the north, and at night below the horizon.
        assert!(sun_direction(-33.9, 18.4, at("2026-06-21T10:45:00Z")).y > 0.5);
        assert!(munich(23).z < 0.0);
    }
}
