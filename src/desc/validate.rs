//! Checks of single values: their physical meaning, and that single precision can hold them.

use super::json::{Whole, elided, join};
use super::{
    EnvironmentDesc, EnvironmentMapDesc, FormulaSkyDesc, LightDistribution, MaterialDesc, MeshDesc, PointLightDesc,
    ShapeDesc, SpotDesc, WebDesc, spectrum_edit,
};
use crate::emitter::SkyFormula;
use crate::math::{Bounds, DAffine3, DVec3, similarity_scale};
use crate::photometry::LampTilt;
use crate::spectrum::Rgb;
use crate::{Error, ErrorKind, Result};

const F32_MAX: f64 = f32::MAX as f64;
const F32_MIN: f64 = f32::MIN_POSITIVE as f64;

/// Greatest distance of a quad's fourth vertex from the plane of the other three, relative to the longest diagonal.
pub(super) const QUAD_FLATNESS: f64 = 1e-4;

/// Returns whether single precision can hold the number; false for NaN and infinity.
pub(super) fn fits(value: f64) -> bool {
    value.abs() <= F32_MAX
}

/// Checks a number that single precision must be able to hold.
pub(super) fn number(path: &str, value: f64) -> Result<f64> {
    if fits(value) {
        return Ok(value);
    }
    Err(Error::invalid(path, format!("{value:e} is beyond single precision, expected a magnitude up to 3.4e38")))
}

/// Checks a number that must be above zero, in single precision too.
pub(super) fn positive(path: &str, value: f64) -> Result<f64> {
    number(path, value)?;
    if value >= F32_MIN {
        return Ok(value);
    }
    let why = if value > 0.0 { "is too small for single precision" } else { "is not above 0" };
    Err(Error::invalid(path, format!("{value} {why}, expected a number > 0")))
}

/// Checks a number that must be in `[low, high]`.
pub(super) fn within(path: &str, value: f64, low: f64, high: f64) -> Result<f32> {
    if (low..=high).contains(&value) {
        return Ok(value as f32);
    }
    Err(Error::invalid(path, format!("{value} is out of range, expected a number in [{low}, {high}]")))
}

/// Checks a number that must be above 0, in single precision too, and at most `high`.
pub(super) fn up_to(path: &str, value: f64, high: f64) -> Result<()> {
    if (F32_MIN..=high).contains(&value) {
        return Ok(());
    }
    Err(Error::invalid(path, format!("{value} is out of range, expected a number above 0 and up to {high}")))
}

/// Checks a number that must be above 0 and below 1.
pub(super) fn share(path: &str, value: f64) -> Result<()> {
    if (F32_MIN..1.0).contains(&value) {
        return Ok(());
    }
    Err(Error::invalid(path, format!("{value} is out of range, expected a number above 0 and below 1")))
}

/// Checks a radius of density estimates, which must be within [`super::RADII`].
pub(super) fn radius(path: &str, value: f64) -> Result<()> {
    length(path, value, "a radius")
}

/// Checks a length, which must be within [`super::RADII`]. `what` names the length in messages.
pub(super) fn length(path: &str, value: f64, what: &str) -> Result<()> {
    positive(path, value)?;
    let [low, high] = super::RADII;
    if (low..=high).contains(&value) {
        return Ok(());
    }
    Err(Error::invalid(path, format!("{value:e} is out of range, expected {what} in [{low:e}, {high:e}]")))
}

/// Checks the cone filter's k, which must be 1 or more in single precision.
pub(super) fn cone(path: &str, k: f64) -> Result<f32> {
    number(path, k)?;
    if k >= 1.0 {
        return Ok(k as f32);
    }
    Err(Error::invalid(path, format!("{k} is out of range, expected a number >= 1")))
}

/// Checks a point or a vector.
pub(super) fn vector(path: &str, value: impl Into<DVec3>) -> Result<DVec3> {
    let value = value.into();
    for (i, component) in value.to_array().into_iter().enumerate() {
        if !fits(component) {
            number(&format!("{path}[{i}]"), component)?;
        }
    }
    Ok(value)
}

/// Returns the unit vector of a vector of any length but zero.
pub(super) fn direction(path: &str, value: impl Into<DVec3>) -> Result<DVec3> {
    let v = vector(path, value)?;
    // The vector is scaled first, so that lengths near the ends of the range do not over- or underflow when squared.
    (v / v.abs().max_element()).try_normalize().ok_or_else(|| {
        let zero = v.to_array();
        Error::invalid(path, format!("{zero:?} has no direction, expected a vector that is not zero"))
    })
}

/// Checks a reflectance, which must be in [0, 1] per channel, since a larger value would create energy.
pub(super) fn reflectance(path: &str, value: impl Into<DVec3>) -> Result<Rgb> {
    let value = value.into().to_array();
    if let Some(i) = value.iter().position(|channel| !(0.0..=1.0).contains(channel)) {
        let bad = value[i];
        let message =
            format!("a reflectance of {bad} breaks conservation of energy, expected a number in [0, 1] per channel");
        return Err(Error::invalid(format!("{path}[{i}]"), message));
    }
    Ok(Rgb::from_f64(DVec3::from_array(value)))
}

/// Returns radiance or radiant intensity, which must be zero or more per channel, times `factor`.
pub(super) fn emission(path: &str, value: impl Into<DVec3>, factor: f64) -> Result<Rgb> {
    let value = value.into();
    for (i, channel) in value.to_array().into_iter().enumerate() {
        let path = format!("{path}[{i}]");
        number(&path, channel)?;
        if channel < 0.0 {
            return Err(Error::invalid(path, format!("{channel} is negative, expected light of 0 or more")));
        }
        number(&path, channel * factor)?;
    }
    Ok(Rgb::from_f64(factor * value))
}

/// Checks a factor on emitted light, which must be zero or more.
pub(super) fn intensity(path: &str, value: f64) -> Result<f64> {
    number(path, value)?;
    if value >= 0.0 {
        return Ok(value);
    }
    Err(Error::invalid(path, format!("{value} is negative, expected an intensity of 0 or more")))
}

/// Checks a whole number that must be in `[low, high]`.
pub(super) fn whole(path: &str, value: Whole, low: u64, high: u64) -> Result<u32> {
    u32::try_from(value.0).ok().filter(|_| (low..=high).contains(&value.0)).ok_or_else(|| {
        Error::invalid(path, format!("{} is out of range, expected a whole number from {low} to {high}", value.0))
    })
}

/// Checks the width and height of an image: at least one pixel each, and at most [`super::MAX_PIXELS`] pixels in total.
pub(super) fn resolution(path: &str, value: [Whole; 2]) -> Result<[u32; 2]> {
    const LIMIT: u64 = super::MAX_PIXELS;
    let width = whole(&format!("{path}[0]"), value[0], 1, LIMIT)?;
    let height = whole(&format!("{path}[1]"), value[1], 1, LIMIT)?;
    if u64::from(width) * u64::from(height) > LIMIT {
        let message = format!("{width} x {height} pixels are too many, expected {LIMIT} at most");
        return Err(Error::invalid(path, message));
    }
    Ok([width, height])
}

/// Makes a point light of radiant intensity `color` times `factor`.
pub(super) fn point_light(
    path: &str,
    position: impl Into<DVec3>,
    color: impl Into<DVec3>,
    factor: f64,
) -> Result<PointLightDesc> {
    let factor = intensity(&join(path, "intensity"), factor)?;
    let position = vector(&join(path, "origin"), position)?;
    let intensity = emission(&join(path, "color"), color, factor)?;
    Ok(PointLightDesc { path: path.to_owned(), ..PointLightDesc::even(position, intensity) })
}

/// Checks a point light and its distribution.
pub(super) fn light(light: PointLightDesc) -> Result<PointLightDesc> {
    let even = point_light(&light.path, light.position, light.intensity.to_f64(), 1.0)?;
    match &light.distribution {
        LightDistribution::Even => {}
        LightDistribution::Spot(it) => spot(&light.path, it)?,
        LightDistribution::Web(it) => web(&light.path, it, even.intensity)?,
    }
    let intensity = spectrum_edit::dressed(&light.path, light.spectrum.as_ref(), even.intensity)?;
    Ok(PointLightDesc { distribution: light.distribution, spectrum: light.spectrum, intensity, ..even })
}

/// Checks the directions and the tilt of a web, and that its intensities times `factor` fit single precision.
pub(super) fn web(path: &str, web: &WebDesc, factor: Rgb) -> Result<()> {
    direction(&join(path, "direction"), web.direction)?;
    direction(&join(path, "c0"), web.c0)?;
    let (at, tilt) = (join(path, "tilt"), web.tilt_deg);
    if !(-180.0..=180.0).contains(&tilt) {
        return Err(Error::invalid(at, format!("{tilt} degrees are out of range, expected an angle in [-180, 180]")));
    }
    if web.web.tilt_factor(tilt).is_none() {
        let [low, high] = web.web.tilt().map_or([-180.0, 180.0], LampTilt::range);
        let message = format!("{tilt} degrees are beyond the tilts of the file, expected an angle in [{low}, {high}]");
        return Err(Error::invalid(at, message));
    }
    for (i, channel) in factor.to_f64().to_array().into_iter().enumerate() {
        number(&format!("{path}.color[{i}]"), channel * web.web.peak() * web.tilt_factor())?;
    }
    Ok(())
}

/// Checks the axis and the angles of a spot light.
pub(super) fn spot(path: &str, spot: &SpotDesc) -> Result<()> {
    direction(&join(path, "direction"), spot.direction)?;
    let SpotDesc { outer_deg, inner_deg, .. } = *spot;
    let narrowest = SpotDesc::NARROWEST;
    if !(narrowest..=180.0).contains(&outer_deg) {
        let message =
            format!("{outer_deg} degrees are out of range, expected an angle from the axis in [{narrowest}, 180]");
        return Err(Error::invalid(join(path, "outerConeAngle"), message));
    }
    if !(0.0..=outer_deg).contains(&inner_deg) {
        let message =
            format!("{inner_deg} degrees are out of range, expected an angle from the axis in [0, {outer_deg}]");
        return Err(Error::invalid(join(path, "innerConeAngle"), message));
    }
    Ok(())
}

/// Makes an environment of radiance `color` times `factor`, the same from all directions.
pub(super) fn environment(path: &str, color: impl Into<DVec3>, factor: f64) -> Result<EnvironmentDesc> {
    let factor = intensity(&join(path, "intensity"), factor)?;
    let radiance = emission(&join(path, "color"), color, factor)?;
    Ok(EnvironmentDesc { path: path.to_owned(), ..EnvironmentDesc::even(radiance) })
}

/// Checks the directions of an environment with a texture.
pub(super) fn environment_map(path: &str, map: &EnvironmentMapDesc) -> Result<()> {
    let up = vector(&join(path, "up"), map.up)?;
    if up == DVec3::ZERO {
        return Err(Error::invalid(
            join(path, "up"),
            "the vector is zero, expected the direction that is up in the image",
        ));
    }
    number(&join(path, "rotation"), map.rotation_deg).map(|_| ())
}

/// Checks a sky by a formula, of which the environment has this radiance.
pub(super) fn formula_sky(path: &str, sky: &FormulaSkyDesc, radiance: Rgb) -> Result<()> {
    let SkyFormula { numbers, .. } = sky.formula;
    // Within these, no direction is brighter than 10^13 times the zenith or so.
    let bounds = [(-1e3, 1e3), (-1e3, 0.0), (-1e3, 1e3), (-1e3, 5.0), (-1e3, 1e3)];
    for (i, (value, (low, high))) in numbers.into_iter().zip(bounds).enumerate() {
        within(&join(path, &format!("perez[{i}]")), value, low, high)?;
    }
    let up = direction(&join(path, "up"), sky.up)?;
    let sun = direction(&join(path, "sun"), sky.sun)?;
    if sun.dot(up) <= 0.0 {
        let message = "the sun is not above the horizon, where skies have no formula";
        return Err(Error::invalid(join(path, "sun"), message));
    }
    reflectance(&join(path, "ground"), sky.ground.to_f64())?;
    if radiance != Rgb::ZERO && sky.model(radiance).is_none() {
        let message = "the formula gives no light, or light beyond single precision";
        return Err(Error::invalid(path, message));
    }
    Ok(())
}

/// Checks an absorption coefficient, which must be 0 or more per channel.
pub(super) fn absorption(path: &str, value: impl Into<DVec3>) -> Result<Rgb> {
    let value = value.into();
    for (i, channel) in value.to_array().into_iter().enumerate() {
        let path = format!("{path}[{i}]");
        number(&path, channel)?;
        if channel < 0.0 {
            return Err(Error::invalid(path, format!("{channel} is negative, expected an absorption of 0 or more")));
        }
    }
    Ok(Rgb::from_f64(value))
}

/// Returns the absorption coefficient of a medium that leaves this share of light after `distance`. The share must be above 0
/// and at most 1 per channel. `keys` names the two values.
pub(super) fn transmittance(keys: [&str; 2], value: impl Into<DVec3>, distance: f64) -> Result<Rgb> {
    let [path, distance_path] = keys;
    let value = value.into();
    positive(distance_path, distance)?;
    for (i, channel) in value.to_array().into_iter().enumerate() {
        up_to(&format!("{path}[{i}]"), channel, 1.0)?;
    }
    let coefficient = -value.map(f64::ln) / distance;
    if !fits(coefficient.max_element()) {
        let message = format!("{distance:e} is too short for a transmittance of {value}, expected a longer distance");
        return Err(Error::invalid(distance_path, message));
    }
    // Full transmittance gives -0.
    Ok(Rgb::from_f64(coefficient + DVec3::ZERO))
}

/// Checks a probability of survival, which must be above 0 and at most 1.
pub(super) fn survival_rate(path: &str, rate: f64) -> Result<f32> {
    positive(path, rate)?;
    within(path, rate, 0.0, 1.0)
}

/// Checks a mesh: it has triangles, their indices are those of its vertices, and its numbers of normals and of texture
/// coordinates match the number of vertices.
pub(super) fn mesh(path: &str, mesh: &MeshDesc) -> Result<()> {
    let at = |key: &str| join(path, key);
    let own = |len: usize| (len > 0).then_some(len);
    let own_lens = [own(mesh.normals.len()), own(mesh.uvs.len())];
    let lens = match &mesh.host {
        None => own_lens,
        Some(_) if !(mesh.positions.is_empty() && mesh.triangles.is_empty() && own_lens == [None; 2]) => {
            let message = "the mesh is given twice, expected arrays of its own or of the host";
            return Err(Error::invalid(path, message));
        }
        Some(host) => [host.normals.as_ref().map(|n| n.len()), host.uvs.as_ref().map(|uvs| uvs.len())],
    };
    if mesh.triangle_count() == 0 {
        return Err(Error::invalid(at("triangles"), "the mesh is empty, expected at least one triangle"));
    }
    let count = mesh.vertex_count();
    for i in 0..mesh.triangle_count() {
        let triangle = mesh.triangle(i);
        if let Some(k) = triangle.iter().position(|index| *index as usize >= count) {
            let message = format!("there is no vertex {}, expected an index below {count}", triangle[k]);
            return Err(Error::invalid(at(&format!("triangles[{i}][{k}]")), message));
        }
    }
    let [colors, tangents] = [mesh.colors.len(), mesh.tangents.len()].map(|len| Some(len).filter(|len| *len > 0));
    if mesh.further_uvs.len() >= MeshDesc::MOST_UV_SETS {
        let (given, most) = (mesh.further_uvs.len(), MeshDesc::MOST_UV_SETS - 1);
        return Err(Error::invalid(at("furtherUvs"), format!("{given} further sets, expected {most} at most")));
    }
    let one_each = |key: &str, what: &str, given: Option<usize>| match given {
        Some(given) if given != count => {
            Err(Error::invalid(at(key), format!("{given} {what} for {count} positions, expected one each")))
        }
        _ => Ok(()),
    };
    for (key, given) in [("normals", lens[0]), ("uvs", lens[1]), ("colors", colors), ("tangents", tangents)] {
        one_each(key, key, given)?;
    }
    for (set, uvs) in mesh.further_uvs.iter().enumerate().filter(|(_, uvs)| !uvs.is_empty()) {
        let key = format!("furtherUvs[{set}]");
        one_each(&key, "uvs", Some(uvs.len()))?;
        uvs.iter().enumerate().try_for_each(|(i, uv)| numbers(path, &key, i, uv.map(f64::from)))?;
    }
    for i in 0..count {
        numbers(path, "positions", i, mesh.position(i).to_array())?;
        if let Some(normal) = mesh.normal(i) {
            numbers(path, "normals", i, normal.map(f64::from))?;
        }
        if let Some(uv) = mesh.uv(i) {
            numbers(path, "uvs", i, uv.map(f64::from))?;
        }
        if let Some(tangent) = mesh.tangents.get(i) {
            numbers(path, "tangents", i, tangent.map(f64::from))?;
        }
        if let Some(color) = mesh.colors.get(i) {
            numbers(path, "colors", i, color.map(f64::from))?;
            if let Some(k) = (0..4).find(|k| color[*k] < 0.0 || *k == 3 && color[3] > 1.0) {
                let expected = if k == 3 { "an opacity in [0, 1]" } else { "0 or more" };
                let message = format!("{} is out of range, expected {expected}", color[k]);
                return Err(Error::invalid(at(&format!("colors[{i}][{k}]")), message));
            }
        }
    }
    Ok(())
}

/// Checks the numbers of element `i` of a mesh's array.
pub(super) fn numbers<const N: usize>(path: &str, key: &str, i: usize, values: [f64; N]) -> Result<()> {
    match values.into_iter().position(|value| !fits(value)) {
        None => Ok(()),
        Some(k) => number(&join(path, &format!("{key}[{i}][{k}]")), values[k]).map(|_| ()),
    }
}

/// Checks the box that clips a quadric.
pub(super) fn clip(path: &str, clip: &Bounds) -> Result<()> {
    let Bounds { min, max } = *clip;
    vector(&join(path, "min"), min)?;
    vector(&join(path, "max"), max)?;
    if clip.is_empty() {
        return Err(Error::invalid(path, format!("the box is empty: min {min} is not below max {max}")));
    }
    Ok(())
}

/// Checks that a quadrilateral is convex and flat and that its first three vertices give a normal.
///
/// A quadrilateral is flat if the fourth vertex is off the plane of the first three by at most 1e-4 of the longer
/// diagonal. This tolerance allows rounded coordinates at any scale.
pub(super) fn quad(path: &str, v: [DVec3; 4]) -> Result<()> {
    let longest = (v[2] - v[0]).abs().max_element().max((v[3] - v[1]).abs().max_element());
    if longest == 0.0 {
        return Err(Error::invalid(path, "the quad has no area, its opposite vertices are equal"));
    }
    // All values below are in units of the quad's size.
    let v = v.map(|vertex| (vertex - v[0]) / longest);
    let Some(n) = v[1].cross(v[2]).try_normalize().filter(|_| v[1].cross(v[2]).length() > 1e-12) else {
        return Err(Error::invalid(path, "the quad's first three vertices lie on a line, expected a corner"));
    };
    let off = n.dot(v[3]).abs();
    let diagonal = v[2].length().max((v[3] - v[1]).length());
    if off > QUAD_FLATNESS * diagonal {
        let message = format!(
            "the quad is not flat: vertex-4 is off the plane of the others by {:.3e} of its diagonal, expected \
             {QUAD_FLATNESS:e} at most; use two triangles",
            off / diagonal
        );
        return Err(Error::invalid(join(path, "vertex-4"), message));
    }
    for i in 0..4 {
        let (a, b, c) = (v[i], v[(i + 1) % 4], v[(i + 2) % 4]);
        if (b - a).cross(c - b).dot(n) < -1e-9 {
            let message = "the quad is not convex, or its vertices are not in order around the edge; use two triangles";
            return Err(Error::invalid(join(path, &format!("vertex-{}", (i + 1) % 4 + 1)), message));
        }
    }
    Ok(())
}

/// Checks that a transform is invertible.
///
/// The check is independent of scale: each axis must keep a length, and the volume that the axes span must be above
/// 1e-9 of the product of their lengths.
pub(super) fn invertible(path: &str, transform: &DAffine3) -> Result<()> {
    if !transform.is_finite() {
        return Err(Error::invalid(path, "the transform overflows, expected finite numbers"));
    }
    let m = transform.matrix3;
    let lengths = [m.x_axis, m.y_axis, m.z_axis].map(|axis| axis.length());
    let relative = m.determinant().abs() / (lengths[0] * lengths[1] * lengths[2]);
    let inverse_is_finite = || transform.inverse().is_finite();
    // Lengths of zero give NaN, for which the comparison is false.
    if relative > 1e-9 && inverse_is_finite() {
        return Ok(());
    }
    Err(Error::invalid(path, "the transform cannot be undone: it flattens the object"))
}

/// Checks that world coordinates fit single precision.
pub(super) fn extent(path: &str, bounds: &Bounds, transform: &DAffine3) -> Result<()> {
    let world = bounds.transformed(transform);
    if world.is_empty() {
        return Err(Error::invalid(path, "the surface holds no point with finite coordinates"));
    }
    let reach = world.min.abs().max(world.max.abs()).max_element();
    if reach <= F32_MAX {
        // A single point is accepted, because a degenerate mesh or triangle is no mistake.
        let size = (world.max - world.min).max_element();
        if size > 0.0 && size < F32_MIN {
            let message = format!("the surface is {size:e} large, too small for single precision");
            return Err(Error::invalid(path, message));
        }
        return Ok(());
    }
    Err(Error::invalid(
        path,
        format!("the surface reaches to {reach:e}, beyond single precision; expected coordinates up to 3.4e38"),
    ))
}

/// Checks that a shape can emit light under its transform. `to_world` is the transform from the shape's frame to the
/// world frame.
pub(super) fn emitter(path: &str, shape: &ShapeDesc, to_world: &DAffine3) -> Result<()> {
    let message = match shape {
        _ if !shape.can_emit() => {
            "of the quadrics, only cylinders can emit light; use a sphere, cylinder, disk, triangle, quad or mesh"
        }
        ShapeDesc::Sphere { .. } if similarity_scale(to_world).is_none() => {
            "a sphere under a transform that stretches it cannot emit"
        }
        _ => return Ok(()),
    };
    Err(Error::new(ErrorKind::Unsupported, message).at(join(path, "emission")))
}

/// Checks that a surface of this shape, which may emit light, can emit on both of its sides.
pub(super) fn emits_both(path: &str, shape: &ShapeDesc, emits: bool) -> Result<()> {
    let at = join(path, "emits");
    if let ShapeDesc::Sphere { .. } = shape {
        let message =
            "'both' of a sphere, which is closed: no light would leave its inside; expected 'front', or another shape";
        return Err(Error::new(ErrorKind::Unsupported, message).at(at));
    }
    if !emits {
        return Err(Error::invalid(at, "'both' of a surface that emits no light, expected one with an emission"));
    }
    Ok(())
}

/// Checks the emission of a surface, its own or that of its material. `to_world` is as for [`emitter`].
pub(super) fn look(
    path: &str,
    emission: Option<Rgb>,
    material: &MaterialDesc,
    shape: &ShapeDesc,
    to_world: &DAffine3,
) -> Result<()> {
    let name = elided(&material.name);
    if emission.is_some() {
        if !material.is_opaque() {
            let message = format!(
                "the material '{name}' has an opacity of {}, expected an opaque one where a surface emits light",
                material.opacity
            );
            return Err(Error::invalid(join(path, "emission"), message));
        }
        return emitter(path, shape, to_world);
    }
    if material.emission.is_none() {
        return Ok(());
    }
    emitter(path, shape, to_world).map_err(|error| {
        let message = format!("the material '{name}' emits light: {}", error.message());
        Error::new(error.kind(), message).at(join(path, "material"))
    })
}
