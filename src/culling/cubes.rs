//! What methods share that cull the cubes of an octree: its parameters, and what is recorded of cubes and of
//! primitives that several of them share.

use crate::drawing::Subject;
use crate::geometry::{NodeId, PrimId, Space};
use crate::index::{Octree, Redistribution, Shape};
use crate::method::evidence::{integer, number, short};
use crate::method::{
    Claim, Compared, Context, Field, Knob, Knobs, Note, Tallied, Tally, Value, Words, words,
};
use crate::scene::{Progress, Scene};

/// How the octree is built.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Cubes {
    pub(crate) tree_levels: u32,
    /// 0: by the space.
    pub(crate) leaf_primitives: u32,
    pub(crate) redistribution: Redistribution,
    pub(crate) small_percent: u32,
}

impl Default for Cubes {
    fn default() -> Self {
        Self {
            // Section 3.1 gives no number for these: neither a depth of the tree, nor primitives of a leaf,
            // nor when a primitive is "small" compared to its cube.
            tree_levels: 12,
            leaf_primitives: 0,
            // Section 3.1: the strategy of the original algorithm.
            redistribution: Redistribution::Hybrid,
            small_percent: 12,
        }
    }
}

impl Words for Redistribution {
    const ALL: &'static [Self] = &Redistribution::ALL;
    const WORDS: &'static [&'static str] = &["hybrid", "parent", "grown", "split"];
}

impl Cubes {
    /// Declares the parameters.
    pub(crate) fn knobs(&mut self, knobs: &mut dyn Knobs) {
        let source = "Georges 1995, Section 3.1";
        knobs.integer(
            Knob::new("tree-levels", "levels", "levels of the octree at most", source),
            1..=Shape::MOST_LEVELS,
            &mut self.tree_levels,
        );
        knobs.integer(
            Knob::new(
                // Section 3.1: "The subdivision criteria is most commonly based on number of primitives in
                // the cell".
                "leaf-primitives",
                "",
                "a cube with no more primitives is not divided; 0: 128 triangles, 8 segments",
                source,
            ),
            0..=100_000,
            &mut self.leaf_primitives,
        );
        // Section 3.1 names three ways and what is wrong with each, then the hybrid of the original
        // algorithm: tiny primitives that straddle a boundary are not to share the visibility of a large
        // cube.
        let crossing = Knob::new(
            "redistribution",
            "",
            "where a primitive goes that crosses a cube's dividing planes: hybrid (stays, or if small to all \
             children it overlaps), parent (stays), grown (to one child, whose bounds grow), split (parts to \
             all children)",
            source,
        );
        knobs.words(crossing, &mut self.redistribution);
        knobs.integer(
            Knob::new(
                "small-percent",
                "%",
                "a primitive is small if it is no longer than this part of its cube",
                source,
            ),
            0..=100,
            &mut self.small_percent,
        );
    }
    /// Whether cubes of such a tree can share a primitive.
    pub(crate) fn may_share(&self) -> bool {
        let passes_on = match self.redistribution {
            // A primitive that is as long as nothing is not drawn, so no cube has it.
            Redistribution::Hybrid => self.small_percent > 0,
            Redistribution::Split => true,
            Redistribution::Parent | Redistribution::Grown => false,
        };
        passes_on && self.tree_levels > 1
    }
    /// The octree of a scene; `None` when cancelled.
    pub(crate) fn build<S: Space>(
        &self,
        scene: &Scene<S>,
        progress: &dyn Progress,
    ) -> Option<Octree<S::Vector>> {
        progress.report(0.0, "building the octree");
        let shape = Shape {
            levels: self.tree_levels,
            // Parameters are declared for any space, and the best number depends on it: 0 waits for the space
            // until here.
            leaf_prims: if self.leaf_primitives == 0 { leaf_prims::<S>() } else { self.leaf_primitives },
            redistribution: self.redistribution,
            small: self.small_percent as f32 / 100.0,
        };
        // Dropped primitives are never drawn, so no cube is to hold them.
        let boxes = scene.live().iter().map(|&p| (p, scene.prim_bounds(p)));
        let mut octree = Octree::build(boxes, &shape, &|| progress.cancelled())?;
        octree.refit(scene);
        Some(octree)
    }
}

/// Primitives of a cube that is not divided. In space a test costs about as much as drawing a dozen
/// triangles, and most cubes that are queried again and again are visible: 128 was the best of 16 to 128 on
/// generated rooms and cities. Flatland scenes are small and are there to be looked at.
fn leaf_prims<S: Space>() -> u32 {
    if S::CORNERS == 2 { 8 } else { 128 }
}

/// What is recorded of cubes.
#[derive(Clone, Copy, Debug)]
pub(crate) enum CubeNote {
    /// A cube left the visible list: with all below it, or alone from the list of a processor.
    Unlisted { node: NodeId, processor: Option<u16> },
    /// A primitive that several cubes share is drawn with the first of them.
    SharedDrawn(PrimId, NodeId),
    /// A primitive that several cubes share was in none that can be seen; the cube that passed it on.
    SharedUnseen(PrimId, NodeId),
    /// What is due at the end of a frame.
    Checked(Check),
}

words! {
    /// Why a visible list is checked against the finished image (Georges 1995, Section 4.2).
    pub(crate) enum Due {
        /// "After a fixed number of frames".
        Interval = "interval",
        /// "Earlier if a large number of structures were suddenly added".
        Added = "added",
        /// "A rapid shift" of the farthest depth.
        Shifted = "shifted",
    }
}

/// Whether a visible list is checked at the end of a frame, and why.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Check {
    /// Whose list it is, if processors have one each.
    pub processor: Option<u16>,
    /// Frames since the last check, this one included.
    pub frames: u32,
    /// Frames between checks.
    pub interval: u32,
    /// Cubes that came onto the list in this frame.
    pub added: u32,
    /// Cubes on it.
    pub listed: u32,
    /// The farthest depth of the image, `1/w`, in this frame and in the one before. `None` where nothing
    /// depends on it, since every frame checks, or there was no frame before.
    pub farthest: Option<[f32; 2]>,
    /// Why it is made; `None` if it is not.
    pub due: Option<Due>,
}

/// The share of new cubes on the list from which on it is checked early (Section 4.2: "a large number of
/// structures were suddenly added"; it gives no number): a quarter.
const MANY_ADDED: u32 = 4;
/// The change of the farthest depth, as a factor, from which on the list is checked early (Section 4.2: "a
/// rapid shift in this value"; again without a number).
const RAPID_SHIFT: f32 = 1.5;

impl Check {
    /// What is due, by the three rules of Section 4.2. The depths are `1/w`, 0 where there is none.
    pub(crate) fn new(
        [frames, interval]: [u32; 2],
        [added, listed]: [u32; 2],
        [farthest, before]: [f32; 2],
    ) -> Self {
        let farthest = (farthest > 0.0 && before > 0.0).then_some([farthest, before]);
        let shift = farthest.map_or(1.0, |[now, before]| (now / before).max(before / now));
        let due = if frames >= interval {
            Some(Due::Interval)
        } else if added.saturating_mul(MANY_ADDED) > listed {
            Some(Due::Added)
        } else {
            (shift > RAPID_SHIFT).then_some(Due::Shifted)
        };
        Self { processor: None, frames, interval, added, listed, farthest, due }
    }
    fn fields(&self) -> Vec<Field> {
        let mut fields: Vec<Field> =
            self.processor.map(|p| integer("processor", p.into())).into_iter().collect();
        let due = self.due.map_or("no", Words::word);
        // Recorded as a whole: the memory of the last frame is written over when this one ends.
        fields.push(Field { name: "due", value: Value::Word(due.into()) });
        fields.push(integer("frames", self.frames));
        fields.push(integer("interval", self.interval));
        fields.push(integer("added", self.added));
        fields.push(integer("listed", self.listed));
        if let Some([now, before]) = self.farthest {
            // View depths for the reader; the shift is a ratio and the same in both measures.
            fields.push(number("farthest_units", (1.0 / now).into()));
            fields.push(number("farthest_before_units", (1.0 / before).into()));
        }
        fields
    }
    /// What made it due, or the frames that have passed.
    fn compared(&self) -> Compared {
        match (self.due, self.farthest) {
            (Some(Due::Added), _) => {
                let quarter = f64::from(self.listed) / f64::from(MANY_ADDED);
                Compared::of(("new on the list", self.added.into()), ("a quarter of it", quarter))
            }
            (Some(Due::Shifted), Some([now, before])) => {
                let shift = (now / before).max(before / now);
                Compared::of(("shift of the farthest depth", shift.into()), ("limit", RAPID_SHIFT.into()))
            }
            _ => {
                let (frames, interval) = (f64::from(self.frames), f64::from(self.interval));
                Compared::of(("frames since the last check", frames), ("interval", interval))
            }
        }
    }
    fn sentence(&self) -> String {
        let whose = self.processor.map_or(String::new(), |p| format!(" of processor {p}"));
        let (added, listed) = (self.added, plural(self.listed, "cube"));
        let of = format!(
            "{added} of {listed} on the visible list{whose} {}",
            if added == 1 { "is" } else { "are" }
        );
        let since = plural(self.frames, "frame");
        let depths = self.farthest.map_or(String::new(), |[now, before]| {
            format!(
                "the farthest depth is {}, after {} in the last frame",
                short(1.0 / now),
                short(1.0 / before)
            )
        });
        let why = match self.due {
            Some(Due::Interval) if self.interval == 1 => "it is checked after every frame".to_owned(),
            Some(Due::Interval) => format!("{since} since its last check, as many as are to pass"),
            Some(Due::Added) => "more than a quarter, so it is checked early".to_owned(),
            Some(Due::Shifted) => {
                format!("{depths}, a shift by more than {RAPID_SHIFT} times, so it is checked early")
            }
            None => {
                let depths = if depths.is_empty() { depths } else { format!(", and {depths}") };
                let interval = self.interval;
                return format!(
                    "{of} new, {since} after its last check{depths}: none is due yet, the next one after \
                     {interval} frames."
                );
            }
        };
        format!("{of} new; {why}: each of them in view is tested against the finished image.")
    }
}

/// Such as `1 cube` or `12 cubes`.
fn plural(n: u32, name: &str) -> String {
    format!("{n} {name}{}", if n == 1 { "" } else { "s" })
}

impl Tallied for CubeNote {
    fn tally(&self, tally: &mut Tally) {
        match self {
            Self::Unlisted { .. } => tally.add("cubes_unlisted", 1),
            Self::SharedDrawn(..) => tally.add("shared_primitives_drawn", 1),
            Self::SharedUnseen(..) => tally.add("shared_primitives_unseen", 1),
            // Every frame records whether a check is due; those that are made count.
            Self::Checked(check) => tally.add("checks", check.due.is_some().into()),
        }
    }
}

impl<S: Space> Note<S> for CubeNote {
    fn kind(&self) -> &'static str {
        match self {
            Self::Unlisted { .. } => "CubeUnlisted",
            Self::SharedDrawn(..) => "SharedDrawn",
            Self::SharedUnseen(..) => "SharedUnseen",
            Self::Checked(_) => "ListChecked",
        }
    }
    fn subject(&self) -> Subject {
        match self {
            Self::Unlisted { node, .. } => Subject::Node(*node),
            // The decision that follows is about the primitive; the cube is a field.
            Self::SharedDrawn(prim, _) | Self::SharedUnseen(prim, _) => Subject::Prim(*prim),
            // About the list as a whole.
            Self::Checked(_) => Subject::None,
        }
    }
    fn claim(&self, _: &Context<'_, S>) -> Option<Claim<S::Vector>> {
        match self {
            Self::SharedUnseen(..) => Some(Claim::Hidden),
            // That a cube leaves a list rests on the answer before it.
            _ => None,
        }
    }
    fn compared(&self, _: &Context<'_, S>) -> Option<Compared> {
        match self {
            Self::Checked(check) => Some(check.compared()),
            _ => None,
        }
    }
    fn fields(&self, _: &Context<'_, S>) -> Vec<Field> {
        match self {
            Self::Unlisted { node, processor } => {
                let whose = processor.map(|p| integer("processor", p.into()));
                std::iter::once(integer("node", node.0)).chain(whose).collect()
            }
            Self::SharedDrawn(prim, node) | Self::SharedUnseen(prim, node) => {
                vec![integer("prim", prim.0), integer("node", node.0)]
            }
            Self::Checked(check) => check.fields(),
        }
    }
    fn sentence(&self, _: &Context<'_, S>) -> String {
        match self {
            Self::Unlisted { node, processor: None } => format!(
                "Node {node} cannot be seen in the finished image; it leaves the visible list with all below \
                 it."
            ),
            // Structures have none below them: each is on a list by itself.
            Self::Unlisted { node, processor: Some(p) } => format!(
                "What node {node} holds itself cannot be seen in the finished image; it leaves the visible \
                 list of processor {p}."
            ),
            Self::SharedDrawn(prim, node) => format!(
                "The {} {prim} lies in several cubes and is drawn once, with the first of them: node {node}.",
                S::PRIM
            ),
            Self::SharedUnseen(prim, node) => format!(
                "The {} {prim} lies in several cubes below node {node}; none of them can be seen.",
                S::PRIM
            ),
            Self::Checked(check) => check.sentence(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_check_is_due_by_three_rules_and_says_which() {
        let check = |frames, added, farthest| Check::new([frames, 30], [added, 20], farthest);
        let cases = [
            (check(30, 0, [0.1, 0.1]), Some(Due::Interval), "30 frames since its last check, as many as are"),
            (
                check(3, 6, [0.1, 0.1]),
                Some(Due::Added),
                "6 of 20 cubes on the visible list are new; more than",
            ),
            (check(3, 5, [0.1, 0.2]), Some(Due::Shifted), "the farthest depth is 10.00, after 5.00"),
            (check(1, 1, [0.1, 0.12]), None, "1 of 20 cubes on the visible list is new, 1 frame after"),
            (check(1, 0, [0.1, 0.0]), None, "none is due yet, the next one after 30 frames"),
            (
                Check::new([1, 1], [0, 1], [0.0; 2]),
                Some(Due::Interval),
                "0 of 1 cube on the visible list are",
            ),
        ];
        for (check, due, words) in cases {
            assert_eq!(check.due, due, "{check:?}");
            assert!(check.sentence().contains(words), "{}", check.sentence());
        }
        assert!(
            check(1, 0, [0.1, 0.0]).fields().iter().all(|f| f.name != "farthest_units"),
            "nothing before"
        );
    }
}
