//! Types that describe light from infinity by formula.

/// Light that comes from one direction of infinity, such as that of the sun: parallel, or of a disk of even radiance.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct etd_distant_light {
    /// `sizeof(etd_distant_light)`.
    pub struct_size: usize,
    /// The direction towards the light, of any length but 0.
    pub towards: [f64; 3],
    /// Irradiance of a surface across the light [W m^-2], each channel >= 0.
    pub irradiance: [f32; 3],
    /// 1: camera rays do not see the disk, only mirrors, glass and other light do; 0: they do.
    pub hidden: u32,
    /// Angular diameter of the disk, degrees in [0, 180]; 0: parallel light. That of the sun is about 0.533.
    pub angle_deg: f64,
}

/// A sky by a formula of the angles to the zenith and to the sun, over a ground. The disk of the sun is an `etd_distant_light`, or comes with
/// the sky of a `turbidity`.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct etd_sky {
    /// `sizeof(etd_sky)`.
    pub struct_size: usize,
    /// Type of the CIE's general sky, 1 to 15: 1 is the overcast sky, 5 an even one, 12 the clear one; 0: the formula of Perez and
    /// others, with `perez`, or with `turbidity` the clear sky of Hosek and Wilkie.
    pub cie: u32,
    /// 0: `radiance` is that at the zenith [W m^-2 sr^-1]; 1: it is the irradiance of a horizontal surface by the sky [W m^-2].
    pub horizontal: u32,
    /// What `horizontal` says, each channel >= 0. With `turbidity` a factor on the sky's own radiance and on that of its sun, and
    /// `horizontal` must be 0.
    pub radiance: [f32; 3],
    /// The share of the light that the ground sends back evenly from below the horizon, in [0, 1] per channel.
    pub ground: [f32; 3],
    /// 1: camera rays do not see it, only mirrors, glass and other light do; 0: they do.
    pub hidden: u32,
    /// Must be 0.
    pub reserved: u32,
    /// The direction towards the sun, above the horizon; with `turbidity` not below it. `etd_sun_direction` has it for places and times.
    pub sun: [f64; 3],
    /// The direction of the zenith.
    pub up: [f64; 3],
    /// The numbers a to e of the formula (1 + a exp(b / cos Z)) (1 + c exp(d chi) + e cos^2 chi), of the angle Z to the zenith and chi
    /// to the sun. Not used with `cie` or `turbidity`.
    pub perez: [f64; 5],
    /// How hazy the air of the clear sky of Hosek and Wilkie is, in [1, 10]: 2 is very clear, 3 clear, 6 warm and moist; 0: another
    /// formula. Its radiance is in W m^-2 sr^-1 per channel of linear Rec. 709, and includes what `ground` sends back to the sky.
    pub turbidity: f64,
    /// With `turbidity`: angular diameter of the disk of the sun, degrees in [0, 180]; 0: parallel light. The irradiance is that of the real
    /// sun in any case.
    pub angle_deg: f64,
    /// With `turbidity`: 1: the sky alone; 0: with the disk of its sun.
    pub no_disk: u32,
    /// Must be 0.
    pub reserved_1: u32,
}

versioned! {
    etd_distant_light, angle_deg;
    etd_sky, perez;
}
