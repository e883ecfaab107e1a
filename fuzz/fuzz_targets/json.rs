//! Any bytes as a scene: they are refused with a message, or they are built and rendered.

#![no_main]

use std::ffi::{CStr, c_char};
use std::ptr::null_mut;
use std::sync::OnceLock;

use etendue::capi::*;
use libfuzzer_sys::fuzz_target;

/// A handle that may be used from any thread.
struct Shared(*mut etd_device);
// SAFETY: devices may.
unsafe impl Send for Shared {}
// SAFETY: as above.
unsafe impl Sync for Shared {}

/// One device for all runs: threads are not what is tested here.
fn device() -> *mut etd_device {
    static DEVICE: OnceLock<Shared> = OnceLock::new();
    DEVICE
        .get_or_init(|| {
            let options = etd_device_options {
                struct_size: size_of::<etd_device_options>(),
                threads: 1,
                log_choice: 0,
                memory_limit: 1 << 30,
                log: None,
                error: None,
                submit: None,
                user_data: null_mut(),
            };
            let mut device = null_mut();
            // SAFETY: the pointers are to what they say.
            assert_eq!(unsafe { etd_device_new(&raw const options, &raw mut device) }, ETD_OK);
            Shared(device)
        })
        .0
}

fn message_is_there() {
    // SAFETY: a C string.
    let message = unsafe { CStr::from_ptr(etd_last_error_message()) };
    assert!(!message.is_empty() && message.to_str().is_ok());
}

fuzz_target!(|data: &[u8]| {
    let mut scene = null_mut();
    // No file is to be found: what is tested is the text.
    let mut scene_options: etd_scene_options = unsafe { std::mem::zeroed() };
    scene_options.struct_size = size_of::<etd_scene_options>();
    scene_options.base_dir = c"/nowhere".as_ptr();
    // SAFETY: the pointers are to what they say.
    unsafe {
        let read = etd_scene_from_json(
            device(),
            data.as_ptr().cast::<c_char>(),
            data.len(),
            &raw const scene_options,
            &raw mut scene,
        );
        assert!(!matches!(read, ETD_PANIC | ETD_INTERNAL), "{read:?}");
        if read != ETD_OK {
            assert!(scene.is_null());
            message_is_there();
            return;
        }
        let built = etd_scene_commit(scene, None, null_mut());
        assert!(!matches!(built, ETD_PANIC | ETD_INTERNAL), "{built:?}");
        if built == ETD_OK {
            let film_options = etd_film_options {
                struct_size: size_of::<etd_film_options>(),
                width: 4,
                height: 3,
                layers: 255,
                reserved: 0,
            };
            let mut film = null_mut();
            assert_eq!(etd_film_new(device(), &raw const film_options, &raw mut film), ETD_OK);
            let mut options: etd_render_options = std::mem::zeroed();
            options.struct_size = size_of::<etd_render_options>();
            assert_eq!(etd_scene_get_render_options(scene, &raw mut options), ETD_OK);
            options.samples = options.samples.min(2);
            // Closed mirrors hold a path for ever; what is tested is that nothing breaks.
            options.max_depth = 16;
            options.shadow_rays = options.shadow_rays.min(2);
            let rendered = etd_render(scene, film, &raw const options);
            assert!(!matches!(rendered, ETD_PANIC | ETD_INTERNAL), "{rendered:?}");
            let mut summary: etd_summary = std::mem::zeroed();
            summary.struct_size = size_of::<etd_summary>();
            if rendered == ETD_OK {
                assert_eq!(etd_film_get_summary(film, &raw mut summary), ETD_OK);
            }
            etd_film_release(film);
        } else {
            message_is_there();
        }
        etd_scene_release(scene);
    }
});
