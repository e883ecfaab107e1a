//! Packing of rectangles into a square.

use crate::Result;
use crate::control::WorkProgress;

/// Positions of rectangles of these sizes in a square of side `side`, or `None` where they do not fit. The same sizes
/// give the same positions. A unit of work is a rectangle.
///
/// The highest rectangle comes first. Each is placed as low as possible, and then as far to the left. Source: Jylänki
/// 2010, "A Thousand Ways to Pack the Bin", skyline bottom-left.
pub(super) fn pack(sizes: &[[u32; 2]], side: u32, progress: &WorkProgress) -> Result<Option<Vec<[u32; 2]>>> {
    let mut order: Vec<u32> = (0..sizes.len() as u32).collect();
    order.sort_by_key(|&i| {
        let [width, height] = sizes[i as usize];
        (u32::MAX - height, u32::MAX - width, i)
    });
    let mut skyline = Skyline { side, steps: vec![Step { x: 0, y: 0, width: side }] };
    let mut places = vec![[0, 0]; sizes.len()];
    for i in order {
        progress.check()?;
        progress.spend(1);
        match skyline.place(sizes[i as usize]) {
            Some(place) => places[i as usize] = place,
            None => return Ok(None),
        }
    }
    Ok(Some(places))
}

/// The upper edge of the occupied area.
struct Skyline {
    side: u32,
    /// Steps from left to right, over the whole side.
    steps: Vec<Step>,
}

#[derive(Clone, Copy, Debug)]
struct Step {
    x: u32,
    y: u32,
    width: u32,
}

impl Skyline {
    fn place(&mut self, [width, height]: [u32; 2]) -> Option<[u32; 2]> {
        let mut best: Option<(u32, usize)> = None;
        for first in 0..self.steps.len() {
            let x = self.steps[first].x;
            if self.side - x < width {
                break;
            }
            let most = best.map_or(self.side.checked_sub(height)?, |(y, _)| y);
            let mut y = 0;
            for step in self.steps[first..].iter().take_while(|step| step.x < x + width) {
                y = y.max(step.y);
                if y > most {
                    break;
                }
            }
            if y <= most && best.is_none_or(|(low, _)| y < low) {
                best = Some((y, first));
            }
        }
        let (y, first) = best?;
        let x = self.steps[first].x;
        let (end, top) = (x + width, y + height);
        // Steps beneath the rectangle disappear.
        let covered = self.steps[first..].iter().take_while(|step| step.x + step.width <= end).count();
        if let Some(cut) = self.steps.get_mut(first + covered).filter(|step| step.x < end) {
            cut.width -= end - cut.x;
            cut.x = end;
        }
        self.steps.splice(first..first + covered, [Step { x, y: top, width }]);
        // Neighbouring steps of the same height are merged.
        for i in [first + 1, first] {
            if i > 0 && i < self.steps.len() && self.steps[i - 1].y == self.steps[i].y {
                self.steps[i - 1].width += self.steps[i].width;
                self.steps.remove(i);
            }
        }
        Some([x, y])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Cancel;
    use crate::sampling::Rng;

    fn are_apart(sizes: &[[u32; 2]], places: &[[u32; 2]], side: u32) {
        let mut taken = vec![false; (side * side) as usize];
        for ([w, h], [x, y]) in sizes.iter().zip(places) {
            assert!(x + w <= side && y + h <= side, "outside");
            for j in *y..y + h {
                for i in *x..x + w {
                    let place = &mut taken[(j * side + i) as usize];
                    assert!(!*place, "two rectangles share ({i}, {j})");
                    *place = true;
                }
            }
        }
    }

    #[test]
    fn rectangles_stay_apart_and_fill_the_square() {
        let mut rng = Rng::new(4, 0);
        for most in [3, 17, 60] {
            let mut size = || 1 + (rng.next_f32() * most as f32) as u32;
            let sizes: Vec<[u32; 2]> = (0..200).map(|_| [size(), size()]).collect();
            let area: u32 = sizes.iter().map(|[w, h]| w * h).sum();
            let least = f64::from(area).sqrt();
            let mut side = least as u32;
            let places = loop {
                if let Some(places) = pack(&sizes, side, &WorkProgress::new(&Cancel::new())).unwrap() {
                    break places;
                }
                side += 1;
            };
            are_apart(&sizes, &places, side);
            assert!(f64::from(side) < 1.12 * least, "{side} for {least}");
        }
    }

    #[test]
    fn exact_fits_and_no_fit() {
        let pack = |sizes: &[[u32; 2]], side| pack(sizes, side, &WorkProgress::new(&Cancel::new())).unwrap();
        let four = [[8, 8]; 4];
        are_apart(&four, &pack(&four, 16).unwrap(), 16);
        assert!(pack(&four, 15).is_none());
        assert!(pack(&[[17, 1]], 16).is_none());
        assert!(pack(&[[1, 17]], 16).is_none());
        assert_eq!(pack(&[], 16).unwrap().len(), 0);
    }
}
