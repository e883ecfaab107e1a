//! What the three channels of a film of wavelengths are.

use super::observer::VISIBLE;
use crate::{Error, Result};

/// What the three channels of a film are, whose paths carry wavelengths.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Sensor {
    /// The colour that the standard observer sees, in linear Rec. 709.
    #[default]
    Observer,
    /// The mean spectral radiance [W m^-2 sr^-1 nm^-1] over each of three adjacent bands of equal width.
    Bands {
        /// The first and the last wavelength \[nm\] of the three bands together, within [`VISIBLE`].
        range: [f64; 2],
    },
}

impl Sensor {
    /// Least width \[nm\] of a band.
    pub const LEAST_WIDTH: f64 = 0.1;

    /// Checks the wavelengths of bands.
    ///
    /// # Errors
    /// [`crate::ErrorKind::InvalidScene`] at `path` for bands outside of [`VISIBLE`] or narrower than [`Sensor::LEAST_WIDTH`].
    pub fn check(self, path: &str) -> Result<()> {
        let Self::Bands { range: [first, last] } = self else { return Ok(()) };
        let ([low, high], least) = (VISIBLE, 3.0 * Self::LEAST_WIDTH);
        // Not so for NaN.
        if first >= low && last <= high && last - first >= least {
            return Ok(());
        }
        let message = format!(
            "[{first}, {last}] is no range of bands, expected two wavelengths from {low} to {high} nm that are {least:.1} nm apart \
             or more"
        );
        Err(Error::invalid(path, message))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bands_that_cannot_be_are_refused() {
        let check = |range| Sensor::Bands { range }.check("sensorBands");
        for range in [[360.0, 830.0], [400.0, 400.4], [555.0, 600.0]] {
            assert!(check(range).is_ok(), "{range:?}");
        }
        for range in [
            [359.0, 500.0],
            [500.0, 831.0],
            [500.0, 500.0],
            [600.0, 500.0],
            [f64::NAN, 500.0],
            [500.0, f64::NAN],
            [0.0, 0.0],
        ] {
            let message = check(range).unwrap_err().to_string();
            assert!(message.contains("sensorBands") && message.contains("no range of bands"), "{message}");
        }
        assert!(Sensor::Observer.check("").is_ok());
    }
}
