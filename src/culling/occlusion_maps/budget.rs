//! How many polygons of occluders a frame draws, and whether it draws any (Zhang et al. 1997, Sections 5.3.2,
//! 6.2 and 7).
//!
//! The paper adapts its limit L and its distance limit by the frame rate. Here counts say what a clock would,
//! so that a frame can be played again: polygons drawn stand for the time to draw them.

use crate::geometry::Space;

/// What a frame did, in primitives.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Work {
    /// In the frustum.
    pub in_view: u32,
    /// Of these culled.
    pub culled: u32,
    /// Drawn into the maps.
    pub occluders: u32,
    /// Tests of depth and overlap.
    pub tests: u32,
}

/// What is kept from frame to frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Budget {
    /// L: polygons of occluders, at most; 0 before the first frame.
    pub limit: u32,
    /// The distance limit as a share of the scene's diagonal.
    pub reach: f32,
    /// Frames in a row that culled less than they cost.
    pub losing: u32,
    /// Frames until culling is tried again; 0 while it is on.
    pub off: u32,
    /// Primitives drawn when it was turned off.
    drawn: u32,
}

/// What was decided about the next frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Adapted {
    pub work: Work,
    /// L and the distance limit, before and after.
    pub limit: [u32; 2],
    pub reach: [f32; 2],
    /// Whether the next frame culls by occlusion.
    pub is_on: bool,
}

/// Few culled: below this share more occluders are worth a try (Section 6.2).
const FEW: f32 = 0.9;
/// Occluders are this share of what is in view, at most: of a frame that culls nothing the paper's frames
/// spend 10 to 25 % on them (Section 6.2, Figure 10).
const MOST: f32 = 0.25;
/// By what the limits grow and shrink.
const GROW: f32 = 1.25;
const SHRINK: f32 = 0.8;
/// A test costs as much as so many primitives, and the maps as many as this.
const TEST: u32 = 4;
const MAPS: u32 = 500;
/// Frames in a row that must lose before culling is turned off, and after how many it is tried again.
const LOSING: u32 = 3;
const PAUSE: u32 = 30;

impl Budget {
    /// The budget of a first frame over a scene of so many primitives. `given`: the parameter, 0 for 1 %.
    pub fn first<S: Space>(given: u32, prims: usize) -> Self {
        let [least, most] = Self::range::<S>(prims);
        let share = if S::CORNERS == 2 { 10 } else { 100 };
        let limit = if given > 0 { given } else { (prims as u32 / share).clamp(least, most) };
        Self { limit, reach: 1.0, losing: 0, off: 0, drawn: 0 }
    }
    /// Least and greatest limit: below 500 triangles the maps cost more than what is drawn into them, and
    /// above a twentieth of the scene occluders are no small part of it. Flatland's scenes are small.
    fn range<S: Space>(prims: usize) -> [u32; 2] {
        let (least, share) = if S::CORNERS == 2 { (2, 5) } else { (MAPS, 20) };
        [least, (prims as u32 / share).max(least)]
    }
    /// Whether this frame culls by occlusion.
    pub fn is_on(&self) -> bool {
        self.off == 0
    }
    /// After a frame that did: L and the distance limit for the next one (Section 6.2), and whether culling
    /// pays (Section 7).
    pub fn adapt<S: Space>(&mut self, work: Work, prims: usize) -> Adapted {
        let before = *self;
        let [least, most] = Self::range::<S>(prims);
        let drawn = work.in_view - work.culled;
        let culled = work.culled as f32 / work.in_view.max(1) as f32;
        let share = work.occluders as f32 / work.in_view.max(1) as f32;
        // "If the percentage of the model culled is low, it increases the count. If the percentage is high
        // and the frame rate is low, it decreases the count."
        let factor = match (culled < FEW, share > MOST) {
            (true, false) if share < MOST => GROW,
            (false, true) => SHRINK,
            _ => 1.0,
        };
        self.limit = ((self.limit as f32 * factor).round() as u32).clamp(least, most.max(least));
        self.reach = (self.reach * factor).clamp(0.01, 1.0);
        // "It should at least cull away a similar percentage of the model so as to justify the overhead."
        // Flatland is there to be looked at: of its few segments none costs more than a test.
        let overhead = if S::CORNERS == 2 { 0 } else { TEST * work.tests + MAPS };
        let is_losing = work.occluders + overhead > work.culled;
        self.losing = if is_losing { self.losing + 1 } else { 0 };
        // Losses before a pause count on, so that one more after it is enough.
        if self.losing >= LOSING {
            (self.off, self.drawn) = (PAUSE, drawn);
        }
        self.adapted(before, work)
    }
    /// After a frame that did not: whether the next one does.
    pub fn pause(&mut self, work: Work) -> Adapted {
        let before = *self;
        self.off -= 1;
        // "Under some viewing conditions": another view is another matter.
        let drawn = work.in_view;
        if drawn.abs_diff(self.drawn) * 4 > self.drawn {
            self.off = 0;
        }
        self.adapted(before, work)
    }
    fn adapted(&self, before: Self, work: Work) -> Adapted {
        let (limit, reach) = ([before.limit, self.limit], [before.reach, self.reach]);
        Adapted { work, limit, reach, is_on: self.is_on() }
    }
}
