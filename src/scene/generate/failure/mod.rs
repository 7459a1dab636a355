//! `generate:failure`: where culling methods fail, as a catalogue of small scenes, each in space and in
//! flatland (`dimensions=2`), with the views at which it happens and what is counted of it.
//!
//! Each is one plan from which both scenes are made. What every method does there is asserted in
//! `tests/failures.rs`: who promises to draw all that is visible does so, and the known weakness shows.

mod cases;
mod layout;

use self::layout::Layout;
use super::{Generator, GeneratorParam, LoadOptions, Progress, SceneError, Values};
use crate::geometry::{Solid, Space};
use crate::scene::{Parts, Scene};

/// What is counted of a failure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Symptom {
    /// Primitives that were drawn and cannot be seen, per cent of the scene's.
    Kept,
    /// Visible primitives that were not drawn, per cent of those.
    Missed,
    /// Pixels whose color is wrong, per cent of the images.
    Wrong,
    /// What the method counted of its own work, for each primitive of the scene and frame.
    Work,
    /// Pixels that changed from view to view without cause, per cent of the images.
    Popped,
}

impl Symptom {
    /// All of them.
    pub const ALL: [Self; 5] = [Self::Kept, Self::Missed, Self::Wrong, Self::Work, Self::Popped];

    /// Kebab-case name, as tables of expectations have it.
    pub fn word(self) -> &'static str {
        match self {
            Self::Kept => "kept",
            Self::Missed => "missed",
            Self::Wrong => "wrong",
            Self::Work => "work",
            Self::Popped => "popped",
        }
    }
}

/// A way to fail, and the scene that shows it.
#[derive(Clone, Copy, Debug)]
pub struct Failure {
    /// Kebab-case name, as written in `generate:failure?case=NAME`.
    pub name: &'static str,
    /// What fails, why, and what one sees.
    pub meaning: &'static str,
    /// How much it fails.
    pub symptom: Symptom,
    make: fn(&mut Layout),
}

/// A line of the catalogue.
macro_rules! failures {
    ($($make:ident, $name:literal, $symptom:ident, $meaning:literal;)*) => {
        static FAILURES: &[Failure] = &[$(Failure {
            name: $name,
            meaning: $meaning,
            symptom: Symptom::$symptom,
            make: cases::$make,
        },)*];
        const NAMES: &[&str] = &[$($name,)*];
    };
}

failures! {
    on_a_plane, "on-a-plane", Kept,
        "The eye passes through the plane of an occluder: edge-on it hides nothing, its supporting planes \
         coincide, and the sign of the side on which the eye lies changes.";
    on_an_edge, "on-an-edge", Kept,
        "The eye stands at the end of an occluder's edge: every plane through that edge and the eye is \
         undefined, so it has to be left out, and hides nothing.";
    grazing_walls, "grazing-walls", Kept,
        "The eye comes up to a tenth of a millimeter to a long wall: depths run from near to far within a \
         few pixels, so boxes behind it cannot be told from the wall, and are drawn.";
    slivers, "slivers", Kept,
        "A wall of slivers and T-junctions: no part of it is large enough to be chosen as an occluder, and \
         rounding may leave cracks of single pixels that show what is behind.";
    doubled_faces, "doubled-faces", Kept,
        "Walls that lie in one plane, some of them twice: at equal depth none is behind another, so what \
         shows nothing is drawn all the same, and a method that takes ties for hidden loses the one that \
         shows.";
    interpenetration, "interpenetration", Kept,
        "Walls that cross, and crates that stick out of them: there is no order from front to back, and a \
         box that reaches before a wall is drawn though nearly all of it is hidden.";
    pixel_holes, "pixel-holes", Missed,
        "Slots as wide as a pixel: what shows through each is small and there is much of it, so a method \
         that rounds, samples or stops early loses it.";
    far_off, "far-off", Kept,
        "The scene lies 120,000 units from the origin, where 32-bit coordinates are 1/128 apart: crates \
         lose their shape, and arithmetic that does not subtract the eye first loses what they still have.";
    tiny_scale, "tiny-scale", Kept,
        "All is 8192 times smaller: a method with a fixed tolerance in world units decides otherwise than \
         at its usual size.";
    huge_scale, "huge-scale", Kept,
        "All is 8192 times larger: a method with a fixed size in world units decides otherwise than at its \
         usual size.";
    near_plane, "near-plane", Kept,
        "A wall passes the eye through the near plane: it has no finite image, so it is clipped or left out \
         as an occluder, and so is a box that reaches behind the eye.";
    not_convex, "not-convex", Kept,
        "A folded wall hides crates that no single part of it hides: an occluder that is not convex has to \
         be taken apart, and its parts have to be joined again.";
    disconnected, "disconnected", Kept,
        "Two walls overlap in the image and do not touch: together they hide what neither hides, which \
         methods that join occluders by common edges cannot see.";
    car_behind_a_car, "car-behind-a-car", Kept,
        "A car behind a car: the first hides one part of what is behind, the second the rest (occluder \
         fusion).";
    subpixel_slabs, "subpixel-slabs", Kept,
        "Slabs narrower than a pixel, some at the same depth: an image takes them for solid or loses them, \
         and most show in no pixel at all, though nothing hides them.";
    leaves, "leaves", Kept,
        "Light falls through leaves: many small holes and no large occluder, so an opacity map of few \
         pixels is gray everywhere, and what is behind is drawn, or lost where gray counts as black.";
    blind, "blind", Popped,
        "A blind whose slats turn their edges to the eye and then their sides: a small step changes what \
         they cover, which a color kept for a few directions cannot say.";
    tearing, "tearing", Wrong,
        "A closed wall seen at an angle between the axes: faces of a cell that look along it are nearly \
         empty, and seen aslant together with full ones they let what is behind shine through.";
    translucent_intersection, "translucent-intersection", Wrong,
        "Panels cut through leaves that are drawn as colors of their cells: a cell is before a panel or \
         behind it as a whole, though it has leaves on both sides.";
    see_through, "see-through", Kept,
        "Glass before crates, and a sheet that shows its back: glass hides nothing and has to be drawn, and \
         what has two sides has no back to cull.";
    bottleneck, "bottleneck", Kept,
        "All light comes through one slit and then another: next to nothing is visible, and a box that the \
         slit cuts is drawn whole.";
    outside_the_cells, "outside-the-cells", Missed,
        "The eye is far outside of all cells: a traversal that begins in the eye's cell has none to begin \
         in.";
    closed_building, "closed-building", Kept,
        "A closed house seen from outside and from above: all that is in it is hidden, and a method that \
         begins inside, or has no roof to hide behind, draws it.";
    low_occlusion, "low-occlusion", Work,
        "A row of which all is visible: culling finds nothing to cull, and costs more than it saves.";
    moving_occluder, "moving-occluder", Kept,
        "A door slides away: what was chosen or remembered of it when it was shut no longer holds.";
}

/// Where methods fail, in the order in which lists show it.
pub fn failures() -> &'static [Failure] {
    FAILURES
}

impl Failure {
    /// The scene as it is given on the command line, in a space.
    pub fn source<S: Space>(&self) -> String {
        match S::CORNERS {
            2 => format!("generate:failure?case={}&dimensions=2", self.name),
            _ => format!("generate:failure?case={}&dimensions=3", self.name),
        }
    }
    /// The scene, with the views at which it happens as its only path.
    ///
    /// # Errors
    /// None but what [`Scene::new`] refuses, which a test rules out.
    pub fn scene<S: Space>(&self) -> Result<Scene<S>, SceneError> {
        Scene::new(self.parts(&self.source::<S>()))
    }
    fn parts<S: Space>(&self, source: &str) -> Parts<S> {
        let mut plan = Layout::new();
        (self.make)(&mut plan);
        let mut parts = plan.parts(self.name, source);
        parts.report.notes.push(format!("What fails here: {}", self.meaning));
        parts
    }
}

/// The parameter that has words for its numbers, and these.
pub(super) const CASES: (&str, &[&str]) = ("case", NAMES);

pub(super) const GENERATOR: Generator = Generator {
    name: "failure",
    meaning: "where culling methods fail: small scenes, each with the views at which it happens",
    params: &[
        GeneratorParam {
            name: CASES.0,
            default: 0,
            min: 0,
            max: NAMES.len() as u64 - 1,
            meaning: "what fails, by name",
        },
        GeneratorParam {
            name: DIMENSIONS,
            default: 3,
            min: 2,
            max: 3,
            meaning: "3 in space, 2 the same in flatland",
        },
    ],
    make,
};
const DIMENSIONS: &str = "dimensions";

fn make(
    values: &Values,
    source: &str,
    _: &LoadOptions,
    _: &dyn Progress,
) -> Result<Parts<Solid>, SceneError> {
    Ok(FAILURES[values.get(CASES.0) as usize].parts(source))
}

/// The same in flatland, if a call of a generator asks for that.
pub(super) fn in_flatland(
    generator: &Generator,
    values: &Values,
    source: &str,
) -> Option<Parts<crate::geometry::Flat>> {
    let asked = generator.name == GENERATOR.name && values.get(DIMENSIONS) == 2;
    asked.then(|| FAILURES[values.get(CASES.0) as usize].parts(source))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Flat;
    use crate::scene::{AnyScene, Quiet, load};

    fn each_is_a_scene<S: Space>() {
        for failure in failures() {
            let scene = failure.scene::<S>().expect("a scene");
            let views = &scene.paths()[0].views;
            assert!((1..=8).contains(&views.len()), "{}", failure.name);
            assert!(views.iter().all(|v| v.eye.fault().is_none()), "{}", failure.name);
            assert!((20..2000).contains(&scene.live().len()), "{}: {}", failure.name, scene.live().len());
            assert_eq!(scene.live().len(), scene.prim_count(), "{}", failure.name);
            assert!(failure.meaning.ends_with('.'), "{}", failure.name);
        }
    }

    #[test]
    fn each_failure_is_a_scene_in_both_spaces() {
        each_is_a_scene::<Flat>();
        each_is_a_scene::<Solid>();
    }

    #[test]
    fn cases_are_called_by_name() {
        let load = |call: &str| load(call, &LoadOptions::default(), &Quiet);
        for failure in failures() {
            let AnyScene::Flat(flat) = load(&failure.source::<Flat>()).expect("a scene") else {
                panic!("{} is not flat", failure.name)
            };
            let AnyScene::Solid(solid) = load(&failure.source::<Solid>()).expect("a scene") else {
                panic!("{} is flat", failure.name)
            };
            assert_eq!((flat.name(), solid.name()), (failure.name, failure.name));
            assert_eq!(solid.source(), failure.source::<Solid>());
            assert_eq!(flat.objects().len(), solid.objects().len());
        }
        let wrong = load("generate:failure?case=grazing-wall").expect_err("no such case").to_string();
        assert!(wrong.contains("`grazing-wall`") && wrong.contains("grazing-walls"), "{wrong}");
    }
}
