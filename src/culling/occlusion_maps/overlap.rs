//! The overlap test: whether a rectangle lies within what occluders cover (Zhang et al. 1997, Section 5.1,
//! Figure 8).
//!
//! A map pixel counts as *opaque* if at most `ignored` of its samples are black. By the paper's recurrence
//! for the thresholds of its levels (Section 5.4), O_{k+1} = (3 + O_k)/4, that is one number for all levels:
//! the threshold of level `k` is 1 − n/m_k, the opacity of a pixel 1 − black/m_k, so one is at least the
//! other where black ≤ n. In flatland, where a pixel has two children, O_{k+1} = (1 + O_k)/2 says the same.
//!
//! And since black samples add up, a pixel that passes has no descendant that would not: the answer is that
//! of level 0 alone, wherever the test begins. The hierarchy saves reads and ignores nothing of its own.

use crate::geometry::PixelRect;
use crate::raster::{Opacity, PyramidCell};

/// What followed from a map pixel that was read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Outcome {
    /// Its opacity is at least its level's threshold.
    Opaque,
    /// It is not, and there is no finer map.
    Transparent,
    /// It is so transparent that some pixel below it is not opaque, and all of these lie in the rectangle.
    TooTransparent,
    /// The pixels below it are read.
    Descends,
}

/// A map pixel was read.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct MapRead {
    /// Which; its level is that of the map.
    pub cell: PyramidCell,
    /// Its black samples, and all that it has.
    pub black: u32,
    pub present: u32,
    /// Whether it lies in the rectangle as a whole.
    pub is_inside: bool,
    pub outcome: Outcome,
}

/// Steps of Figure 8, in the order of its lines.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Step {
    /// The next pixel of the level that the test begins with.
    Each,
    /// A pixel's opacity is looked up.
    Check,
    /// It is compared with the threshold.
    Compare,
    Opaque,
    /// There is no finer map.
    Finest,
    Transparent,
    /// It is compared with the least threshold.
    TooTransparent,
    Ends,
    /// The pixels below it that overlap the rectangle.
    Descend,
    /// All that were checked are opaque.
    Covered,
}

/// Hears of the test; it returns nothing, so that a test with a listener and one without are the same.
pub(crate) trait Hears {
    fn reaches(&mut self, step: Step);
    fn reads(&mut self, read: MapRead);
}

/// What the test found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Overlap {
    /// Whether the rectangle lies within what is opaque.
    pub is_covered: bool,
    /// Samples of the pixels that were opaque enough which are black, or were before holes were filled.
    pub ignored: u32,
    /// Map pixels that were read.
    pub reads: u32,
}

/// One test.
struct Test<'a, H> {
    maps: &'a Opacity,
    /// Pixels of level 0 that the rectangle touches.
    under: PixelRect,
    /// Black samples that an opaque pixel has at most.
    ignored: u32,
    found: Overlap,
    hears: &'a mut H,
}

/// OverlapTest of Figure 8, for the pixels of level 0 that a rectangle touches; `ignored`: black samples that
/// an opaque pixel has at most; `start`: the level that it begins with.
pub(crate) fn overlap_test(
    maps: &Opacity,
    under: PixelRect,
    ignored: u32,
    start: u8,
    hears: &mut impl Hears,
) -> Overlap {
    let mut test = Test { maps, under, ignored, found: Overlap::default(), hears };
    let span = test.on_level(start);
    for y in span.y0..span.y1 {
        for x in span.x0..span.x1 {
            test.hears.reaches(Step::Each);
            if !test.check_pixel(PyramidCell { level: start, x: x as u16, y: y as u16 }) {
                return test.found;
            }
        }
    }
    test.hears.reaches(Step::Covered);
    Overlap { is_covered: true, ..test.found }
}

impl<H: Hears> Test<'_, H> {
    /// The pixels of a level that the rectangle touches.
    fn on_level(&self, level: u8) -> PixelRect {
        let past = |v: u32| ((v - 1) >> level) + 1;
        let r = self.under;
        PixelRect { x0: r.x0 >> level, x1: past(r.x1), y0: r.y0 >> level, y1: past(r.y1) }
    }
    /// CheckPixel of Figure 8.
    fn check_pixel(&mut self, cell: PyramidCell) -> bool {
        self.hears.reaches(Step::Check);
        let (black, present) = (self.maps.black(cell), self.maps.present(cell));
        let is_inside = self.is_inside(cell);
        self.found.reads += 1;
        let read = |to: &mut Self, outcome: Outcome| {
            to.hears.reads(MapRead { cell, black, present, is_inside, outcome });
        };
        // "If (Op > HOM[Level].OpacityThreshold)": at least, as footnote 1 says; else nothing would be opaque
        // where the threshold is 1.
        self.hears.reaches(Step::Compare);
        if black <= self.ignored {
            read(self, Outcome::Opaque);
            self.hears.reaches(Step::Opaque);
            self.found.ignored += black + self.maps.filled(cell);
            return true;
        }
        self.hears.reaches(Step::Finest);
        if cell.level == 0 {
            read(self, Outcome::Transparent);
            self.hears.reaches(Step::Transparent);
            return false;
        }
        // More black than all pixels of level 0 in it may have: one of them has too much (Section 5.4).
        self.hears.reaches(Step::TooTransparent);
        let most = u64::from(self.ignored) * u64::from(self.maps.finest_in(cell));
        if is_inside && u64::from(black) > most {
            read(self, Outcome::TooTransparent);
            self.hears.reaches(Step::Ends);
            return false;
        }
        read(self, Outcome::Descends);
        let span = self.on_level(cell.level - 1);
        let (x, y) = (2 * u32::from(cell.x), 2 * u32::from(cell.y));
        for y in y.max(span.y0)..(y + 2).min(span.y1) {
            for x in x.max(span.x0)..(x + 2).min(span.x1) {
                self.hears.reaches(Step::Descend);
                if !self.check_pixel(PyramidCell { level: cell.level - 1, x: x as u16, y: y as u16 }) {
                    return false;
                }
            }
        }
        true
    }
    /// Whether all pixels of level 0 in it lie under the rectangle.
    fn is_inside(&self, cell: PyramidCell) -> bool {
        let [columns, rows] = self.maps.size(0);
        let lies = |at: u16, end: u32, low: u32, past: u32| {
            let first = u32::from(at) << cell.level;
            low <= first && (first + (1 << cell.level)).min(end) <= past
        };
        let r = self.under;
        lies(cell.x, columns, r.x0, r.x1) && lies(cell.y, rows, r.y0, r.y1)
    }
}
