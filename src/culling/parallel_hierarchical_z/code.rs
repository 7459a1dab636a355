//! The pseudocode of this method, and where it differs from the paper.

use super::Params;
use super::machine::{Allocation, Distribution, Volume};
use crate::method::{CodeLine, Departure, When};

/// The pseudocode.
pub(super) const CODE: &[CodeLine] = &[
    // Section 4.1 for the structures, Section 5.1 for the regions; marks of shared primitives are those of
    // Section 3.1.
    CodeLine::new("Frame:1", "Frame(structures, processors, renderers)"),
    CodeLine::new("Frame:2", "  in the first frame: deal the structures out to the processors"),
    CodeLine::departing(
        "Frame:3",
        "  leave out the structures outside the view",
        "each processor leaves out its own",
    ),
    CodeLine::new("Frame:4", "  give the regions of the screen to the renderers"),
    CodeLine::new("Frame:5", "  all at once: Process on each processor, Render on each renderer"),
    CodeLine::new("Frame:6", "  for each primitive p that several structures share"),
    CodeLine::new("Frame:7", "    if none of them was drawn: p is hidden"),
    CodeLine::new("Frame:8", "  all at once: Check on each processor"),
    // Section 5.1, in the orders of Section 4.2. Section 5.3 adds the farthest depths.
    CodeLine::new("Process:1", "Process(visible list V, invisible list I)"),
    CodeLine::new("Process:2", "  for each C of V, by decreasing area on the screen"),
    CodeLine::new("Process:3", "    Draw(C)"),
    CodeLine::new("Process:4", "  ask the renderers for the farthest depths of their regions"),
    CodeLine::new("Process:5", "  for each C of I, by increasing number of primitives"),
    CodeLine::departing(
        "Process:6",
        "    or for the cube C above several of them",
        "recombine them into a tree",
    ),
    CodeLine::new("Process:7", "    Query(C)"),
    CodeLine::new("Process:8", "    if C is hidden: skip it"),
    CodeLine::new("Process:9", "    else if C stands for several: query each of them"),
    CodeLine::new("Process:10", "    else move C to V"),
    CodeLine::new("Process:11", "    Draw(C)"),
    CodeLine::new("Process:12", "  wait while only replies are to come"),
    // Sections 4.2 and 5.1: not in every frame, since a test may take communication.
    CodeLine::new("Check:1", "Check(visible list V), when the image is finished"),
    CodeLine::new("Check:2", "  ask the renderers for the farthest depths of their regions"),
    CodeLine::new("Check:3", "  if enough frames have passed, or much has changed"),
    CodeLine::new("Check:4", "    for each C of V in view"),
    CodeLine::new("Check:5", "      Query(C)"),
    CodeLine::new("Check:6", "      if C is hidden: move it to I"),
    // Section 5.1. Section 5.3 adds the sphere, the farthest depths, and that a processor goes on meanwhile.
    CodeLine::new("Query:1", "Query(structure C)"),
    CodeLine::new("Query:2", "  transform its box"),
    CodeLine::new("Query:3", "  transform the sphere around it"),
    CodeLine::new("Query:4", "  if it crosses the near plane: C may be seen"),
    CodeLine::new("Query:5", "  if it covers no pixel: C is hidden"),
    CodeLine::new("Query:6", "  if it is behind the farthest depths of its regions: C is hidden"),
    CodeLine::new("Query:7", "  if no renderer holds one of its regions: C may be seen"),
    CodeLine::new("Query:8", "  send it to its regions"),
    CodeLine::new("Query:9", "  go on with other structures meanwhile"),
    CodeLine::new("Query:10", "  when all regions have answered: C is hidden, unless one saw it"),
    // Section 5: processors transform, renderers rasterize.
    CodeLine::new("Draw:1", "Draw(structure C)"),
    CodeLine::new("Draw:2", "  for each primitive p of C"),
    CodeLine::new("Draw:3", "    if p is shared and was drawn already: skip it"),
    CodeLine::new("Draw:4", "    if p faces away from the eye: skip it"),
    CodeLine::new("Draw:5", "    transform p; send it to its regions"),
    // Sections 5 and 5.1: whether a pixel is left on is the all-enables-off bit after a box was rasterized
    // without being written.
    CodeLine::new("Render:1", "Render(its regions): for each message in order of arrival"),
    CodeLine::new("Render:2", "  primitives: rasterize them"),
    CodeLine::new("Render:3", "  a box: compare its faces with the depths drawn so far"),
    CodeLine::departing(
        "Render:4",
        "  a sphere: compare its rectangle with the depths drawn so far",
        "compare it at every pixel",
    ),
    CodeLine::new("Render:5", "    answer whether any pixel is left on"),
    CodeLine::new("Render:6", "  asked for the farthest depths: answer with those of its regions"),
    CodeLine::departing(
        "Render:7",
        "  none is left: give the region up for the next that has some",
        "when it is finished",
    ),
];

/// Lines of [`CODE`] that the run reaches.
pub(super) mod line {
    use super::CODE;
    use crate::method::line;
    pub const FRAME: u8 = line(CODE, "Frame:1");
    pub const DEAL: u8 = line(CODE, "Frame:2");
    pub const OUTSIDE: u8 = line(CODE, "Frame:3");
    pub const ALLOCATE: u8 = line(CODE, "Frame:4");
    pub const START: u8 = line(CODE, "Frame:5");
    pub const EACH_SHARED: u8 = line(CODE, "Frame:6");
    pub const UNSEEN: u8 = line(CODE, "Frame:7");
    pub const CHECK_ALL: u8 = line(CODE, "Frame:8");
    pub const PROCESS: u8 = line(CODE, "Process:1");
    pub const EACH_VISIBLE: u8 = line(CODE, "Process:2");
    pub const DRAW_VISIBLE: u8 = line(CODE, "Process:3");
    pub const ASK_FARTHEST: u8 = line(CODE, "Process:4");
    pub const TAKE: u8 = line(CODE, "Process:5");
    pub const GROUP: u8 = line(CODE, "Process:6");
    pub const ASK: u8 = line(CODE, "Process:7");
    pub const HIDDEN: u8 = line(CODE, "Process:8");
    pub const EACH_OF_GROUP: u8 = line(CODE, "Process:9");
    pub const FOUND: u8 = line(CODE, "Process:10");
    pub const DRAW_FOUND: u8 = line(CODE, "Process:11");
    pub const WAIT: u8 = line(CODE, "Process:12");
    pub const CHECK: u8 = line(CODE, "Check:1");
    pub const CHECK_FARTHEST: u8 = line(CODE, "Check:2");
    pub const DUE: u8 = line(CODE, "Check:3");
    pub const EACH_CHECKED: u8 = line(CODE, "Check:4");
    pub const RECHECK: u8 = line(CODE, "Check:5");
    pub const UNLIST: u8 = line(CODE, "Check:6");
    pub const QUERY: u8 = line(CODE, "Query:1");
    pub const BOX: u8 = line(CODE, "Query:2");
    pub const SPHERE: u8 = line(CODE, "Query:3");
    pub const NEAR: u8 = line(CODE, "Query:4");
    pub const NO_PIXEL: u8 = line(CODE, "Query:5");
    pub const FARTHEST: u8 = line(CODE, "Query:6");
    pub const UNHELD: u8 = line(CODE, "Query:7");
    pub const SEND: u8 = line(CODE, "Query:8");
    pub const MEANWHILE: u8 = line(CODE, "Query:9");
    pub const DECIDE: u8 = line(CODE, "Query:10");
    pub const DRAW: u8 = line(CODE, "Draw:1");
    pub const EACH: u8 = line(CODE, "Draw:2");
    pub const DRAWN: u8 = line(CODE, "Draw:3");
    pub const FACES_AWAY: u8 = line(CODE, "Draw:4");
    pub const TRANSFORM: u8 = line(CODE, "Draw:5");
    pub const RENDER: u8 = line(CODE, "Render:1");
    pub const RASTERIZE: u8 = line(CODE, "Render:2");
    pub const COMPARE_BOX: u8 = line(CODE, "Render:3");
    pub const COMPARE_SPHERE: u8 = line(CODE, "Render:4");
    pub const ANSWER: u8 = line(CODE, "Render:5");
    pub const FIND_FARTHEST: u8 = line(CODE, "Render:6");
    pub const TAKE_REGION: u8 = line(CODE, "Render:7");
}

/// At which lines each kind of event stands.
pub(super) const STANDS: &[(&str, &[&str])] = &[
    ("NodeClassified", &["Frame:3"]),
    ("PrimClassified", &["Frame:3"]),
    ("VisibleDrawn", &["Draw:1"]),
    ("FoundDrawn", &["Draw:1"]),
    ("BoxTransformed", &["Query:2", "Query:3"]),
    ("BoxRechecked", &["Query:2", "Query:3"]),
    ("FarthestAsked", &["Process:4", "Check:2"]),
    ("Waited", &["Process:12"]),
    ("RegionRasterized", &["Render:2"]),
    ("RegionAnswered", &["Render:5"]),
    ("FarthestFound", &["Render:6"]),
    ("ObscurationTested", &["Query:4", "Query:5", "Query:6", "Query:7", "Query:10"]),
    ("CellRead", &["Render:3", "Render:4"]),
    ("TileRefreshed", &["Render:3", "Render:4"]),
    ("PrimitiveRasterized", &["Render:2"]),
    ("OrientationTested", &["Draw:4"]),
    ("SharedDrawn", &["Draw:5"]),
    ("SharedUnseen", &["Frame:7"]),
    ("ListChecked", &["Check:3"]),
    ("CubeUnlisted", &["Check:6"]),
    ("NodeDecided outside", &["Frame:3"]),
    ("NodeDecided partial", &["Draw:1"]),
    ("PrimDecided outside", &["Frame:3"]),
    ("PrimDecided faces-away", &["Draw:4"]),
    ("PrimDecided hidden", &["Process:8", "Frame:7"]),
    ("PrimDecided visible", &["Draw:5"]),
];

/// Where it differs from the paper.
pub(super) const DEPARTURES: &[Departure] = &[
    Departure {
        section: "3.1",
        what: "marks of shared primitives are known to all processors at once, as if they shared memory",
        why: "each primitive is drawn once",
        when: When::Always,
    },
    Departure {
        section: "4.1",
        what: "with distribution=hybrid, the default, a processor first queries the cube above several of \
               its invisible structures",
        why: "the paper leaves open how a processor recombines its allotment into a tree",
        when: When::With("distribution", "hybrid"),
    },
    Departure {
        section: "4.1",
        what: "distribution=subtree deals whole parts of the scene out",
        why: "it shows what dealing finely avoids",
        when: When::With("distribution", "subtree"),
    },
    Departure {
        section: "4.2",
        what: "a check is early if a quarter of the list is new, or the farthest depth shifts by more than \
               1.5 times; for that each processor asks the renderers when the image is finished",
        why: "the paper gives no numbers and no way",
        when: When::Always,
    },
    Departure {
        section: "5",
        what: "what operations cost is a parameter",
        why: "the paper gives no costs",
        when: When::Always,
    },
    Departure {
        section: "5",
        what: "a renderer answers from the z-pyramid, for a box by its planes",
        why: "the answer is the same as by comparing the triangles of its faces at all pixels at once, and \
              the cells that it reads can be shown",
        when: When::Always,
    },
    Departure {
        section: "5.1",
        what: "what is out of view is left out before the machine begins, whole cubes at a time",
        why: "it takes no part in what is compared",
        when: When::Always,
    },
    Departure {
        section: "5.1",
        what: "with allocation=dynamic a renderer that has nothing to do gives its region up, and may take \
               it again",
        why: "on the machine a region is finished when all its primitives are known, which a query has to \
               come before",
        when: When::With("allocation", "dynamic"),
    },
    Departure {
        section: "5.3",
        what: "with query=sphere the screen rectangle of the sphere is compared",
        why: "the renderers here have no evaluator of quadratic expressions",
        when: When::With("query", "sphere"),
    },
    Departure {
        section: "5.3",
        what: "the farthest depths are asked for once, when the visible list is drawn",
        why: "it is the time that the paper proposes",
        when: When::Always,
    },
];

/// Whether a line belongs to these parameters.
pub(super) fn has_line(params: &Params, at: u8) -> bool {
    let machine = &params.machine;
    // Where every frame checks, nothing is to be decided by the farthest depth.
    let asks_for_checks = params.coherence && params.check_interval > 1;
    let asks = params.coherence && machine.farthest_first;
    let is_one_cube = params.cubes.tree_levels == 1;
    match at {
        line::EACH_SHARED | line::UNSEEN | line::DRAWN => params.cubes.may_share(),
        line::CHECK_ALL | line::EACH_VISIBLE | line::DRAW_VISIBLE => params.coherence,
        line::CHECK | line::DUE | line::EACH_CHECKED | line::RECHECK | line::UNLIST => params.coherence,
        line::CHECK_FARTHEST => asks_for_checks,
        // It is asked by a processor that has drawn from one list and has something on the other.
        line::ASK_FARTHEST | line::FARTHEST => asks && !is_one_cube,
        line::FIND_FARTHEST => asks && !is_one_cube || asks_for_checks,
        line::GROUP | line::EACH_OF_GROUP => machine.distribution == Distribution::Hybrid && !is_one_cube,
        line::UNHELD | line::TAKE_REGION => machine.allocation == Allocation::Dynamic,
        line::MEANWHILE => machine.overlap,
        line::BOX | line::COMPARE_BOX => machine.query == Volume::Faces,
        line::SPHERE | line::COMPARE_SPHERE => machine.query == Volume::Sphere,
        line::FACES_AWAY => params.surfaces.one_sided,
        _ => true,
    }
}
