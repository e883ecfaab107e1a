//! What a display is sent: tone maps, the sRGB curve, rounding.

use etendue::film::Image;
use etendue::output::{ToneMap, to_srgb8};
use etendue::spectrum::{srgb_decode, srgb_encode};

use crate::record::{Case, Entry, Within};

pub fn cases() -> Vec<Entry> {
    vec![Entry { id: "D66", title: "Display", run: display }]
}

const TONE_MAPS: [ToneMap; 4] = [ToneMap::Maximum, ToneMap::Clamp, ToneMap::Reinhard, ToneMap::Aces];

/// The bytes that these values become.
fn codes(tone_map: ToneMap, exposure: f32, values: &[f32]) -> Vec<u8> {
    let rgb = values.iter().flat_map(|&value| [value; 3]).collect();
    let image = Image { width: values.len() as u32, height: 1, rgb, ..Image::default() };
    to_srgb8(&image, tone_map, exposure).expect("an exposure in range").into_iter().step_by(3).collect()
}

fn display(case: &mut Case) {
    // 1.055 x^(1/2.4) - 0.055, or 12.92 x.
    for (linear, encoded) in [(0.18, 0.461356129500), (0.5, 0.735356983052), (0.0031308, 0.0404499360), (1.0, 1.0)] {
        let what = format!("sRGB of {linear}");
        // The argument is rounded, which is worth up to an ulp.
        case.exact(what, f64::from(srgb_encode(linear)), encoded, Within::Ulps(2.0));
    }
    let knee = 0.0031308_f64;
    let branches = (1.055 * knee.powf(1.0 / 2.4) - 0.055) - 12.92 * knee;
    let step = f64::from(srgb_encode(0.003_130_9)) - f64::from(srgb_encode(0.003_130_8));
    case.at_most("the published branches apart at 0.0031308", branches.abs(), 1e-7);
    case.at_most("across it, a step of 10^-7 becomes", step, 2e-6);
    let back = (0..=1000).map(|i| i as f32 / 1000.0).map(|x| f64::from((srgb_decode(srgb_encode(x)) - x).abs()));
    case.at_most("there and back, off", back.fold(0.0, f64::max), 5e-7);
    for (tone_map, x, mapped) in [
        (ToneMap::Reinhard, 1.0, 0.5),
        (ToneMap::Reinhard, 3.0, 0.75),
        (ToneMap::Aces, 1.0, 2.54 / 3.16),
        (ToneMap::Clamp, 0.25, 0.25),
        (ToneMap::Clamp, 4.0, 1.0),
    ] {
        case.exact(format!("{tone_map:?} of {x}"), tone_map.curve(x), mapped, Within::Relative(1e-12));
    }
    let bytes = codes(ToneMap::Clamp, 0.0, &[0.0, 0.18, 0.5, 1.0_f32.next_down(), 1.0, 1.0_f32.next_up(), 2.0]);
    case.holds(
        "bytes of 0, 0.18, 0.5, and 1 from below on",
        "0 118 188 255 255 255 255",
        shown(&bytes),
        bytes == [0, 118, 188, 255, 255, 255, 255],
    );
    // Rounded to nearest: the border between two bytes is half way between them, at every one of the 255 borders.
    let mut off = 0;
    for byte in 0..255_u8 {
        let border = (f64::from(byte) + 0.5) / 255.0;
        let linear = if border <= 0.04045 { border / 12.92 } else { ((border + 0.055) / 1.055).powf(2.4) };
        let found = codes(ToneMap::Clamp, 0.0, &[(linear * (1.0 - 1e-5)) as f32, (linear * (1.0 + 1e-5)) as f32]);
        off += u64::from(found != [byte, byte + 1]);
    }
    case.never("borders between bytes off by 10^-5", off, 255);

    let strange = [f32::NAN, -f32::NAN, f32::NEG_INFINITY, -1.0, -0.0, f32::INFINITY];
    let wrong = TONE_MAPS.iter().flat_map(|&tone_map| [-64.0, 0.0, 64.0].map(|stops| (tone_map, stops)));
    let wrong = wrong.filter(|&(tone_map, stops)| codes(tone_map, stops, &strange) != [0, 0, 0, 0, 0, 255]);
    case.never("NaN, negative not 0, or infinite not 255", wrong.count() as u64, 12);
    // Radiance from nothing to the largest number, in steps that are coprime to the spacing.
    let step = case.count(65_537, 1021) as usize;
    let rising: Vec<f32> = (0..=f32::MAX.to_bits()).step_by(step).map(f32::from_bits).collect();
    let falls = TONE_MAPS.iter().filter(|tone_map| !codes(**tone_map, 0.0, &rising).is_sorted()).count();
    case.never("tone maps that fall somewhere", falls as u64, 4);
}

fn shown(bytes: &[u8]) -> String {
    bytes.iter().map(u8::to_string).collect::<Vec<_>>().join(" ")
}
