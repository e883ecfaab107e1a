//! How many rays a scene answers at once.

use super::sys;

/// How many rays Embree takes in one call.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum PacketWidth {
    One,
    Eight,
    Sixteen,
}

impl PacketWidth {
    /// The widest packets that the device answers natively.
    pub(super) fn of(device: sys::RTCDevice) -> Self {
        let has = |property| {
            // SAFETY: `device` is alive.
            unsafe { sys::rtcGetDeviceProperty(device, property) != 0 }
        };
        if has(sys::RTC_DEVICE_PROPERTY_NATIVE_RAY16_SUPPORTED) {
            Self::Sixteen
        } else if has(sys::RTC_DEVICE_PROPERTY_NATIVE_RAY8_SUPPORTED) {
            Self::Eight
        } else {
            Self::One
        }
    }
}
