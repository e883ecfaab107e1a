//! The list of a description's surfaces, in blocks that descriptions and scenes share.
//!
//! A host edits one surface among many. Whatever looks at all surfaces leaves out the blocks that it has seen before, or whose facts say that
//! nothing in them matters, so that an edit costs by what changed.

use std::ops::{Index, IndexMut, Range};
use std::slice;
use std::sync::{Arc, OnceLock};

use super::object::{ShapeDesc, SurfaceDesc};

/// Number of surfaces of a block. An edit copies one block, which takes some 30 microseconds; a look at all blocks reads a cache line of each.
const BLOCK: usize = 256;

/// The surfaces of a description, in order.
///
/// It has the calls of a `Vec<SurfaceDesc>` that descriptions need, but is no slice. A clone shares the surfaces with the original
/// until one of both is edited, in blocks of 256; what was built from a description recognises in an edited one the blocks that are
/// still shared.
#[derive(Clone, Debug, Default)]
pub struct Surfaces {
    /// All are full but the last, and none is empty.
    blocks: Vec<Arc<Block>>,
}

/// Consecutive surfaces.
#[derive(Clone, Debug, Default)]
struct Block {
    surfaces: Vec<SurfaceDesc>,
    facts: OnceLock<BlockFacts>,
}

/// What a look at all surfaces asks before it looks at those of a block.
#[derive(Clone, Debug, Default)]
pub(crate) struct BlockFacts {
    /// The materials of surfaces that are not hidden, each once.
    pub materials: Vec<MaterialUse>,
    /// The largest number of a material, of hidden surfaces too.
    pub last_material: Option<usize>,
    /// Whether a surface has an emission of its own.
    pub emits: bool,
    /// Whether a surface has a photometric web or a spectrum.
    pub shines_unevenly: bool,
    /// The places of meshes in the block, of hidden ones too.
    meshes: Vec<u8>,
    /// Number of triangles that are surfaces, or halves of quads, and are not hidden.
    pub triangles: usize,
    /// Number of analytic shapes that are not hidden.
    pub shapes: usize,
}

/// How often surfaces that are not hidden have a material.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct MaterialUse {
    /// `None` for surfaces that have none.
    pub material: Option<usize>,
    /// Number of surfaces.
    pub surfaces: usize,
    /// Number of those without an emission of their own.
    pub unlit: usize,
}

impl BlockFacts {
    fn new(surfaces: &[SurfaceDesc]) -> Self {
        let mut facts = Self::default();
        for (place, surface) in surfaces.iter().enumerate() {
            facts.last_material = facts.last_material.max(surface.material);
            facts.emits |= surface.emission.is_some();
            facts.shines_unevenly |= surface.web.is_some() || surface.spectrum.is_some();
            let is_shown = usize::from(!surface.hidden);
            match surface.shape {
                ShapeDesc::Mesh { .. } => facts.meshes.push(place as u8),
                ShapeDesc::Triangle(_) => facts.triangles += is_shown,
                ShapeDesc::Quad(_) => facts.triangles += 2 * is_shown,
                ShapeDesc::Sphere { .. } | ShapeDesc::Disk { .. } | ShapeDesc::Quadric { .. } => {
                    facts.shapes += is_shown;
                }
            }
            if !surface.hidden {
                let unlit = usize::from(surface.emission.is_none());
                facts.materials.push(MaterialUse { material: surface.material, surfaces: 1, unlit });
            }
        }
        facts.materials.sort_unstable();
        facts.materials.dedup_by(|one, sum| {
            let is_same = one.material == sum.material;
            if is_same {
                *sum = MaterialUse { surfaces: sum.surfaces + 1, unlit: sum.unlit + one.unlit, ..*sum };
            }
            is_same
        });
        facts.materials.shrink_to_fit();
        facts
    }

    /// Whether a surface that is not hidden has such a material.
    pub fn has(&self, is_such: impl Fn(Option<usize>) -> bool) -> bool {
        self.materials.iter().any(|it| is_such(it.material))
    }
}

/// A block of a list of surfaces.
#[derive(Clone, Copy)]
pub(crate) struct SurfaceBlock<'a> {
    /// The number of the block among those of the list.
    pub place: usize,
    block: &'a Arc<Block>,
}

impl<'a> SurfaceBlock<'a> {
    /// The numbers of the surfaces.
    pub fn numbers(self) -> Range<usize> {
        let first = BLOCK * self.place;
        first..first + self.block.surfaces.len()
    }

    /// The surfaces with their numbers.
    pub fn surfaces(self) -> impl Iterator<Item = (usize, &'a SurfaceDesc)> {
        self.numbers().zip(&self.block.surfaces)
    }

    /// The meshes with their numbers, hidden ones too.
    pub fn meshes(self) -> impl Iterator<Item = (usize, &'a SurfaceDesc)> {
        let first = self.numbers().start;
        let of = move |place: &u8| (first + usize::from(*place), &self.block.surfaces[usize::from(*place)]);
        self.facts().meshes.iter().map(of)
    }

    pub fn facts(self) -> &'a BlockFacts {
        self.block.facts.get_or_init(|| BlockFacts::new(&self.block.surfaces))
    }
}

impl Block {
    /// The surfaces, for an edit.
    fn edited(self: &mut Arc<Self>) -> &mut Vec<SurfaceDesc> {
        let block = Arc::make_mut(self);
        block.facts.take();
        &mut block.surfaces
    }
}

/// Looks that leave out blocks.
impl Surfaces {
    pub(crate) fn blocks(&self) -> impl Iterator<Item = SurfaceBlock<'_>> {
        self.blocks.iter().enumerate().map(|(place, block)| SurfaceBlock { place, block })
    }

    /// The surfaces of the blocks whose facts are such, with their numbers.
    pub(crate) fn of_blocks(
        &self,
        is_such: impl Fn(&BlockFacts) -> bool,
    ) -> impl Iterator<Item = (usize, &SurfaceDesc)> {
        self.blocks().filter(move |block| is_such(block.facts())).flat_map(SurfaceBlock::surfaces)
    }

    /// The surfaces that are meshes, hidden ones too, with their numbers.
    pub(crate) fn meshes(&self) -> impl Iterator<Item = (usize, &SurfaceDesc)> {
        self.blocks().flat_map(SurfaceBlock::meshes)
    }

    /// Whether both lists share this block.
    pub(crate) fn shares(&self, other: &Self, place: usize) -> bool {
        self.blocks.get(place).zip(other.blocks.get(place)).is_some_and(|(own, other)| Arc::ptr_eq(own, other))
    }

    /// The number of the block of a surface.
    pub(crate) fn place_of(number: usize) -> usize {
        number / BLOCK
    }

    /// Those surfaces of both lists that may differ, in pairs of the same number: all that are not in shared blocks. A surface that one list
    /// has more than the other is in no pair.
    pub(crate) fn unshared<'a>(
        &'a self,
        other: &'a Self,
    ) -> impl Iterator<Item = (usize, &'a SurfaceDesc, &'a SurfaceDesc)> {
        let pairs = self.blocks().zip(other.blocks()).filter(|(own, other)| !Arc::ptr_eq(own.block, other.block));
        pairs
            .flat_map(|(own, other)| own.surfaces().zip(&other.block.surfaces).map(|((i, own), other)| (i, own, other)))
    }
}

/// What a vector has.
impl Surfaces {
    /// Number of surfaces.
    pub fn len(&self) -> usize {
        self.blocks.last().map_or(0, |last| BLOCK * (self.blocks.len() - 1) + last.surfaces.len())
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.blocks.is_empty()
    }

    /// A surface, where there is one of this number.
    pub fn get(&self, number: usize) -> Option<&SurfaceDesc> {
        self.blocks.get(number / BLOCK)?.surfaces.get(number % BLOCK)
    }

    /// The same for an edit.
    pub fn get_mut(&mut self, number: usize) -> Option<&mut SurfaceDesc> {
        let block = self.blocks.get_mut(number / BLOCK).filter(|block| number % BLOCK < block.surfaces.len())?;
        block.edited().get_mut(number % BLOCK)
    }

    /// The first surface.
    pub fn first(&self) -> Option<&SurfaceDesc> {
        self.get(0)
    }

    /// The last surface.
    pub fn last(&self) -> Option<&SurfaceDesc> {
        self.blocks.last()?.surfaces.last()
    }

    /// The same for an edit.
    pub fn last_mut(&mut self) -> Option<&mut SurfaceDesc> {
        self.blocks.last_mut()?.edited().last_mut()
    }

    /// All surfaces, in order.
    pub fn iter(&self) -> SurfaceIter<'_> {
        SurfaceIter { surfaces: self, left: 0..self.len() }
    }

    /// All surfaces for edits. The blocks that are passed are no longer shared.
    pub fn iter_mut(&mut self) -> SurfaceIterMut<'_> {
        SurfaceIterMut { blocks: self.blocks.iter_mut(), block: [].iter_mut() }
    }

    /// The surfaces of these numbers, where there are so many.
    pub fn range(&self, numbers: Range<usize>) -> Option<SurfaceIter<'_>> {
        (numbers.start <= numbers.end && numbers.end <= self.len())
            .then_some(SurfaceIter { surfaces: self, left: numbers })
    }

    /// Adds a surface at the end.
    pub fn push(&mut self, surface: SurfaceDesc) {
        match self.blocks.last_mut().filter(|last| last.surfaces.len() < BLOCK) {
            Some(last) => last.edited().push(surface),
            None => self.blocks.push(Arc::new(Block { surfaces: vec![surface], facts: OnceLock::new() })),
        }
    }

    /// Takes out the last surface.
    pub fn pop(&mut self) -> Option<SurfaceDesc> {
        self.split_off(self.len().checked_sub(1)?).pop()
    }

    /// Leaves only the first `len` surfaces.
    pub fn truncate(&mut self, len: usize) {
        if len >= self.len() {
            return;
        }
        self.blocks.truncate(len.div_ceil(BLOCK));
        if let Some(last) = self.blocks.last_mut()
            && !len.is_multiple_of(BLOCK)
        {
            last.edited().truncate(len % BLOCK);
        }
    }

    /// Takes out the surfaces from `first` on. This function panics where there are fewer before it.
    pub fn split_off(&mut self, first: usize) -> Vec<SurfaceDesc> {
        assert!(first <= self.len(), "there are {} surfaces, and none from {first} on", self.len());
        let taken = (first..self.len()).map(|number| self[number].clone()).collect();
        self.truncate(first);
        taken
    }

    /// Takes out a surface; those after it get other numbers. This function panics for a number that no surface has.
    pub fn remove(&mut self, number: usize) -> SurfaceDesc {
        assert!(number < self.len(), "there are {} surfaces, and no {number}", self.len());
        let mut after = self.split_off(number);
        let removed = after.remove(0);
        self.extend(after);
        removed
    }

    /// Takes out all surfaces.
    pub fn clear(&mut self) {
        self.blocks.clear();
    }
}

/// Iterates over the surfaces of a description.
#[derive(Clone, Debug)]
pub struct SurfaceIter<'a> {
    surfaces: &'a Surfaces,
    left: Range<usize>,
}

impl<'a> Iterator for SurfaceIter<'a> {
    type Item = &'a SurfaceDesc;

    fn next(&mut self) -> Option<Self::Item> {
        self.left.next().map(|number| &self.surfaces[number])
    }

    fn nth(&mut self, n: usize) -> Option<Self::Item> {
        self.left.nth(n).map(|number| &self.surfaces[number])
    }

    fn size_hint(&self) -> (usize, Option<usize>) {
        self.left.size_hint()
    }
}

impl DoubleEndedIterator for SurfaceIter<'_> {
    fn next_back(&mut self) -> Option<Self::Item> {
        self.left.next_back().map(|number| &self.surfaces[number])
    }
}

impl ExactSizeIterator for SurfaceIter<'_> {}

/// Iterates over the surfaces of a description for edits.
#[derive(Debug)]
pub struct SurfaceIterMut<'a> {
    blocks: slice::IterMut<'a, Arc<Block>>,
    block: slice::IterMut<'a, SurfaceDesc>,
}

impl<'a> Iterator for SurfaceIterMut<'a> {
    type Item = &'a mut SurfaceDesc;

    fn next(&mut self) -> Option<Self::Item> {
        match self.block.next() {
            None => {
                self.block = self.blocks.next()?.edited().iter_mut();
                self.block.next()
            }
            surface => surface,
        }
    }
}

impl Index<usize> for Surfaces {
    type Output = SurfaceDesc;

    fn index(&self, number: usize) -> &SurfaceDesc {
        &self.blocks[number / BLOCK].surfaces[number % BLOCK]
    }
}

impl IndexMut<usize> for Surfaces {
    fn index_mut(&mut self, number: usize) -> &mut SurfaceDesc {
        &mut self.blocks[number / BLOCK].edited()[number % BLOCK]
    }
}

impl Extend<SurfaceDesc> for Surfaces {
    fn extend<I: IntoIterator<Item = SurfaceDesc>>(&mut self, surfaces: I) {
        surfaces.into_iter().for_each(|surface| self.push(surface));
    }
}

impl FromIterator<SurfaceDesc> for Surfaces {
    fn from_iter<I: IntoIterator<Item = SurfaceDesc>>(surfaces: I) -> Self {
        let mut all = Self::default();
        all.extend(surfaces);
        all
    }
}

impl From<Vec<SurfaceDesc>> for Surfaces {
    fn from(surfaces: Vec<SurfaceDesc>) -> Self {
        surfaces.into_iter().collect()
    }
}

impl<'a> IntoIterator for &'a Surfaces {
    type Item = &'a SurfaceDesc;
    type IntoIter = SurfaceIter<'a>;

    fn into_iter(self) -> Self::IntoIter {
        self.iter()
    }
}

impl<'a> IntoIterator for &'a mut Surfaces {
    type Item = &'a mut SurfaceDesc;
    type IntoIter = SurfaceIterMut<'a>;

    fn into_iter(self) -> Self::IntoIter {
        self.iter_mut()
    }
}

impl IntoIterator for Surfaces {
    type Item = SurfaceDesc;
    type IntoIter = std::vec::IntoIter<SurfaceDesc>;

    fn into_iter(mut self) -> Self::IntoIter {
        self.split_off(0).into_iter()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{DAffine3, DVec3};

    fn surface(number: usize) -> SurfaceDesc {
        SurfaceDesc {
            path: number.to_string(),
            name: String::new(),
            shape: match number % 3 {
                0 => ShapeDesc::Mesh { mesh: 0, smooth: false },
                1 => ShapeDesc::Quad([DVec3::ZERO; 4]),
                _ => ShapeDesc::Sphere { centre: DVec3::ZERO, radius: 1.0 },
            },
            local: DAffine3::IDENTITY,
            transform: DAffine3::IDENTITY,
            material: Some(number % 2),
            emission: None,
            emits_both: false,
            web: None,
            spectrum: None,
            hidden: false,
        }
    }

    fn numbers<'a>(surfaces: impl Iterator<Item = &'a SurfaceDesc>) -> Vec<usize> {
        surfaces.map(|surface| surface.path.parse().unwrap()).collect()
    }

    /// Calls by which a list grows and shrinks leave what they leave of a vector, at every number around the ends of blocks.
    #[test]
    fn lists_are_as_vectors_are() {
        for count in [0, 1, BLOCK - 1, BLOCK, BLOCK + 1, 2 * BLOCK, 2 * BLOCK + 3] {
            let list: Surfaces = (0..count).map(surface).collect();
            assert_eq!((list.len(), list.is_empty()), (count, count == 0));
            assert_eq!(numbers(list.iter()), (0..count).collect::<Vec<_>>());
            assert_eq!(numbers(list.iter().rev()), (0..count).rev().collect::<Vec<_>>());
            assert!(list.get(count).is_none() && list.clone().get_mut(count).is_none());
            assert_eq!(list.last().map(|it| it.path.clone()), count.checked_sub(1).map(|it| it.to_string()));
            for at in [0, 1, BLOCK - 1, BLOCK, BLOCK + 1, count.saturating_sub(1)].map(|at| at.min(count)) {
                let mut short = list.clone();
                let taken = short.split_off(at);
                assert_eq!((numbers(short.iter()), numbers(taken.iter())), ((0..at).collect(), (at..count).collect()));
                assert_eq!(numbers(list.range(at..count).unwrap()), (at..count).collect::<Vec<_>>());
                short.extend(taken);
                assert_eq!(numbers(short.iter()), (0..count).collect::<Vec<_>>());
                if at < count {
                    assert_eq!(short.remove(at).path, at.to_string());
                    assert_eq!(numbers(short.iter()), (0..count).filter(|i| *i != at).collect::<Vec<_>>());
                }
            }
            assert!(list.range(0..count + 1).is_none());
            for past in [count, count + 1, count + BLOCK + 1] {
                let mut same = list.clone();
                same.truncate(past);
                assert_eq!(same.len(), count);
            }
        }
    }

    /// An edit of a clone leaves the original as it is, and all blocks but one are still shared.
    #[test]
    fn an_edit_unshares_one_block() {
        let list: Surfaces = (0..3 * BLOCK).map(surface).collect();
        let mut edited = list.clone();
        assert_eq!(list.unshared(&edited).count(), 0);
        edited[BLOCK + 5].hidden = true;
        assert_eq!(list.iter().filter(|it| it.hidden).count(), 0);
        assert_eq!([0, 1, 2].map(|place| list.shares(&edited, place)), [true, false, true]);
        let differ: Vec<usize> =
            list.unshared(&edited).filter(|(_, a, b)| a.hidden != b.hidden).map(|(i, ..)| i).collect();
        assert_eq!((list.unshared(&edited).count(), differ), (BLOCK, vec![BLOCK + 5]));
    }

    /// The facts of a block are those of its surfaces, also after each kind of edit.
    #[test]
    fn facts_follow_edits() {
        let mut list: Surfaces = (0..6).map(surface).collect();
        let facts = |list: &Surfaces| list.blocks().next().unwrap().facts().clone();
        let before = facts(&list);
        assert_eq!((before.triangles, before.shapes, list.meshes().count()), (4, 2, 2));
        let used = |material: usize, surfaces, unlit| MaterialUse { material: Some(material), surfaces, unlit };
        assert_eq!((&*before.materials, before.last_material), (&[used(0, 3, 3), used(1, 3, 3)][..], Some(1)));
        assert!(!before.emits && !before.shines_unevenly);
        list[1].hidden = true;
        list.get_mut(2).unwrap().emission = Some(crate::spectrum::Rgb::ONE);
        assert_eq!((facts(&list).triangles, facts(&list).emits), (2, true));
        assert_eq!(facts(&list).materials, [used(0, 3, 2), used(1, 2, 2)]);
        list.iter_mut().for_each(|surface| surface.material = None);
        let none = MaterialUse { material: None, surfaces: 5, unlit: 4 };
        assert_eq!((facts(&list).materials, facts(&list).last_material), (vec![none], None));
        list.last_mut().unwrap().material = Some(7);
        assert_eq!(facts(&list).last_material, Some(7));
        list.push(surface(6));
        assert_eq!(list.meshes().map(|(i, _)| i).collect::<Vec<_>>(), [0, 3, 6]);
        list.truncate(3);
        assert_eq!((facts(&list).triangles, list.meshes().count()), (0, 1));
    }
}
