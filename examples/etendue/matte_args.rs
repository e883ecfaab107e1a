//! The options of `render` about mattes.

use clap::Args;
use etendue::render::MAX_MATTE_LEVELS;

/// Options about mattes.
#[derive(Debug, Args)]
pub struct MatteArgs {
    /// Layers of an EXR by which compositing programs pick objects and materials by name, as Cryptomatte 1.2 has them: ids with their
    /// coverage of the pixel. One more ray for each sample, after the render.
    #[arg(long, conflicts_with = "share")]
    pub cryptomatte: bool,
    /// Number of objects, and of materials, that a pixel keeps: those that cover most of it. Even, 2 to 64. With --cryptomatte.
    #[arg(long, value_name = "N", default_value = "6", requires = "cryptomatte", value_parser = parse_levels)]
    pub cryptomatte_levels: u32,
}

fn parse_levels(text: &str) -> Result<u32, String> {
    let levels = text.parse().ok().filter(|levels| (2..=MAX_MATTE_LEVELS).contains(levels) && levels % 2 == 0);
    levels.ok_or_else(|| format!("expected an even number from 2 to {MAX_MATTE_LEVELS}"))
}
