//! Writes a mesh of a million triangles to a Wavefront OBJ: a trefoil knot of twisted, weathered rope.
//!
//! `cargo run --release --example million_triangles -- out/million.obj`
//!
//! The knot is a tube whose radius carries strands that wind about it, and fractal noise. Everything follows from the
//! count, so the same count gives the same file. Rows are written as they are made; memory does not grow with the
//! count.

use std::f64::consts::TAU;
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::PathBuf;

use clap::Parser;
use etendue::math::DVec3;

/// Mean radius of the tube; the knot reaches 3 from the middle.
const TUBE_RADIUS: f64 = 0.62;
/// Strands of the rope.
const STRANDS: f64 = 7.0;
/// How often the strands wind about the tube on their way around the knot.
const TWIST: f64 = 9.0;
/// Octaves of noise.
const OCTAVES: u32 = 7;

/// The knot's centre line at t in [0, 1): a trefoil, seen from +z.
fn knot(t: f64) -> DVec3 {
    let a = TAU * t;
    DVec3::new(a.sin() + 2.0 * (2.0 * a).sin(), a.cos() - 2.0 * (2.0 * a).cos(), -1.35 * (3.0 * a).sin())
}

/// The knot's derivative.
fn knot_tangent(t: f64) -> DVec3 {
    let a = TAU * t;
    TAU * DVec3::new(a.cos() + 4.0 * (2.0 * a).cos(), -a.sin() + 4.0 * (2.0 * a).sin(), -4.05 * (3.0 * a).cos())
}

/// A number in [-1, 1) for a lattice point.
fn lattice(x: i64, y: i64, z: i64) -> f64 {
    // Odd constants spread the coordinates over 64 bits, SplitMix64's finaliser mixes them.
    let mut h = (x as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15)
        ^ (y as u64).wrapping_mul(0xc2b2_ae3d_27d4_eb4f)
        ^ (z as u64).wrapping_mul(0x1656_67b1_9e37_79f9);
    h = (h ^ (h >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    h = (h ^ (h >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((h ^ (h >> 31)) >> 11) as f64 * (2.0 / (1u64 << 53) as f64) - 1.0
}

/// Value noise in [-1, 1): random numbers at lattice points, smoothly blended.
fn noise(p: DVec3) -> f64 {
    let cell = p.floor();
    let f = p - cell;
    let w = f * f * (DVec3::splat(3.0) - 2.0 * f);
    let [x, y, z] = cell.to_array().map(|c| c as i64);
    let blend = |a: f64, b: f64, t: f64| a + t * (b - a);
    let edge = |y: i64, z: i64| blend(lattice(x, y, z), lattice(x + 1, y, z), w.x);
    let face = |z: i64| blend(edge(y, z), edge(y + 1, z), w.y);
    blend(face(z), face(z + 1), w.z)
}

/// Octaves of noise, each twice as fine and a little less than half as strong.
fn fractal(p: DVec3) -> f64 {
    let (mut sum, mut scale, mut weight) = (0.0, 1.0, 1.0);
    for _ in 0..OCTAVES {
        sum += weight * noise(scale * p);
        (scale, weight) = (2.03 * scale, 0.47 * weight);
    }
    sum
}

/// The point of the surface at (along, around) in [0, 1)^2.
fn surface(along: f64, around: f64) -> DVec3 {
    let centre = knot(along);
    let tangent = knot_tangent(along).normalize();
    // A frame from a fixed direction closes on itself; the tangent is never along it.
    let side = tangent.cross(DVec3::Z).normalize();
    let up = side.cross(tangent);
    let angle = TAU * around;
    let outwards = angle.cos() * side + angle.sin() * up;
    // Strands: arcs that meet in sharp grooves.
    let strand = (0.5 * (STRANDS * angle + TWIST * TAU * along * STRANDS)).sin().abs();
    let smooth = centre + TUBE_RADIUS * outwards;
    let weathered = fractal(3.1 * smooth);
    let fibres = (STRANDS * 9.0 * angle + 3.0 * weathered + TWIST * TAU * along * STRANDS * 6.0).sin();
    centre + outwards * (TUBE_RADIUS * (0.80 + 0.20 * strand.sqrt()) + 0.030 * weathered + 0.004 * fibres)
}

/// Steps along and around the tube with 2 x along x around triangles, as near to `count` as equal divisions allow:
/// exact for a count that has a fitting divisor, such as a million.
fn divisions(count: u64) -> (u64, u64) {
    let quads = (count / 2).max(9);
    // The tube is about eight times longer than its circumference; look for a divisor near that.
    let ideal = ((quads as f64 / 8.0).sqrt() as u64).max(3);
    let around = (0..=ideal / 3)
        .flat_map(|step| [ideal - step, ideal + step])
        .find(|around| *around >= 3 && quads.is_multiple_of(*around))
        .unwrap_or(ideal);
    ((quads / around).max(3), around)
}

/// Writes the mesh; returns its numbers of vertices and triangles.
fn write_obj(count: u64, out: &mut impl Write) -> io::Result<(u64, u64)> {
    let (along, around) = divisions(count);
    writeln!(out, "# A trefoil of rope, {} triangles, written by examples/million_triangles.rs", 2 * along * around)?;
    for i in 0..along {
        for j in 0..around {
            let p = surface(i as f64 / along as f64, j as f64 / around as f64);
            writeln!(out, "v {:.6} {:.6} {:.6}", p.x, p.y, p.z)?;
        }
    }
    for i in 0..along {
        for j in 0..around {
            // OBJ counts from one.
            let vertex = |i: u64, j: u64| (i % along) * around + j % around + 1;
            let [a, b, c, d] = [vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)];
            writeln!(out, "f {a} {b} {c}\nf {a} {c} {d}")?;
        }
    }
    Ok((along * around, 2 * along * around))
}

/// Writes a mesh of a million triangles to a Wavefront OBJ.
#[derive(Parser)]
struct Args {
    /// Triangles, to the nearest number that divides evenly.
    #[arg(long, default_value_t = 1_000_000, value_parser = clap::value_parser!(u64).range(18..=4_000_000_000))]
    triangles: u64,
    /// Where to write; its folder is made.
    #[arg(default_value = "out/million.obj")]
    output: PathBuf,
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let args = Args::parse();
    if let Some(folder) = args.output.parent() {
        std::fs::create_dir_all(folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    }
    let file = File::create(&args.output).map_err(|error| format!("{}: {error}", args.output.display()))?;
    let mut out = BufWriter::with_capacity(1 << 20, file);
    let (vertices, triangles) = write_obj(args.triangles, &mut out)?;
    out.flush()?;
    println!("{}: {vertices} vertices, {triangles} triangles", args.output.display());
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashMap;

    #[test]
    fn a_million_is_a_million() {
        let (along, around) = divisions(1_000_000);
        assert_eq!(2 * along * around, 1_000_000);
        for count in [18, 100, 12_345, 1_000_003, 10_000_000] {
            let (along, around) = divisions(count);
            assert!((2 * along * around).abs_diff(count) <= 2 * around, "{count}: {along} x {around}");
        }
    }

    /// Each edge is used once in each direction, the volume is positive (wound outwards), and the same count gives the
    /// same file.
    #[test]
    fn is_closed_and_repeatable() {
        let [first, second] = [(); 2].map(|()| {
            let mut text = Vec::new();
            write_obj(20_000, &mut text).expect("memory does not fail");
            String::from_utf8(text).expect("ASCII")
        });
        assert_eq!(first, second);
        let numbers =
            |line: &str| line.split(' ').skip(1).map(|x| x.parse::<f64>().expect("a number")).collect::<Vec<_>>();
        let rows = |key: &str| first.lines().filter(|line| line.starts_with(key)).map(numbers).collect::<Vec<_>>();
        let (vertices, faces) = (rows("v "), rows("f "));
        let mut edges: HashMap<[usize; 2], u32> = HashMap::new();
        let mut volume = 0.0;
        for face in &faces {
            let id = [0, 1, 2].map(|k| face[k] as usize - 1);
            for k in 0..3 {
                *edges.entry([id[k], id[(k + 1) % 3]]).or_default() += 1;
            }
            let [a, b, c] = id.map(|i| DVec3::from_slice(&vertices[i]));
            volume += a.dot(b.cross(c)) / 6.0;
        }
        assert!(edges.iter().all(|(&[a, b], &count)| count == 1 && edges.contains_key(&[b, a])));
        assert!(volume > 0.0, "{volume}");
        assert_eq!(faces.len(), 2 * vertices.len());
    }
}
