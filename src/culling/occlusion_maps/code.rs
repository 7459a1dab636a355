//! The pseudocode of the method, and where it departs from the paper.

use super::stand_ins::Kind;
use super::{DepthKind, Params};
use crate::method::{CodeLine, Departure, When};

/// The pseudocode: Section 3 as procedures, and Figure 8.
pub(super) const CODE: &[CodeLine] = &[
    CodeLine::new("Frame:1", "Frame(eye)"),
    CodeLine::departing(
        "Frame:2",
        "  if culling did not pay lately: draw what is in view, try again later",
        "occlusion culling should be turned off (7)",
    ),
    CodeLine::new("Frame:3", "  C := the leaves of the occluder database in the frustum"),
    CodeLine::new("Frame:4", "  look up how large each of C looks from the grid points about the eye"),
    CodeLine::new("Frame:5", "  sort C by distance, or as it is chosen"),
    CodeLine::new("Frame:6", "  for each leaf B of C, in this order"),
    CodeLine::new("Frame:7", "    if B is beyond the distance limit: next B"),
    CodeLine::departing(
        "Frame:8",
        "    if the polygons of occluders with those of B exceed L: stop",
        "until their combined polygon count exceeds L (5.3.2)",
    ),
    CodeLine::new("Frame:9", "    B is an occluder"),
    CodeLine::new("Frame:10", "  Z := the nearest depth of the leaf that ended this, or the far plane"),
    CodeLine::new("Frame:11", "  for each occluder B"),
    CodeLine::new("Frame:12", "    draw B in white"),
    CodeLine::new("Frame:13", "    draw what stands in for B in white"),
    CodeLine::new("Frame:14", "    write B's farthest depth to the entries that its rectangle touches"),
    CodeLine::departing(
        "Frame:15",
        "  fill the holes of at most so many black samples",
        "ignores small holes by thresholds (5.4)",
    ),
    CodeLine::new("Frame:16", "  average 2×2 pixels, again and again, down to a map of 4×4"),
    CodeLine::new("Frame:17", "  Cull(root)"),
    CodeLine::departing(
        "Frame:18",
        "  adapt L and the distance limit by what was culled and drawn",
        "by what was culled and the frame rate (6.2)",
    ),
    CodeLine::new("Cull:1", "Cull(node T)"),
    CodeLine::new("Cull:2", "  if T lies outside the frustum: return"),
    CodeLine::departing("Cull:3", "  if T holds an occluder: it is in no need of a test", "it is tested"),
    CodeLine::new("Cull:4", "  R := the rectangle of T's box, z := its nearest depth"),
    CodeLine::new("Cull:5", "  if T reaches the near plane: it may be seen"),
    CodeLine::new("Cull:6", "  if R covers no pixel: T is culled, return"),
    CodeLine::new("Cull:7", "  if z is not beyond the plane Z: T may be seen"),
    CodeLine::new("Cull:8", "  if some entry that R touches is as far as z: T may be seen"),
    CodeLine::new("Cull:9", "  if OverlapTest(R): T is culled, return"),
    CodeLine::departing(
        "Cull:10",
        "  if not OverlapTest(R): T may be seen",
        "depth is compared before overlap is tested (3)",
    ),
    CodeLine::new(
        "Cull:11",
        "  if every sample under R that is covered is nearer than z: T is culled, return",
    ),
    CodeLine::new("Cull:12", "  if T is a leaf: Draw(T)"),
    CodeLine::new("Cull:13", "  else for each child T' of T: Cull(T')"),
    CodeLine::new("Draw:1", "Draw(leaf T)"),
    CodeLine::new("Draw:2", "  draw all of T"),
    CodeLine::new("Draw:3", "  for each polygon p of T"),
    CodeLine::new("Draw:4", "    if p faces away from the eye: next p"),
    CodeLine::departing(
        "Draw:5",
        "    if p was drawn in white, and was nowhere nearer than what was drawn before it: next p",
        "occluders are drawn again as they are",
    ),
    CodeLine::new("Draw:6", "    draw p"),
    CodeLine::departing(
        "Overlap:1",
        "OverlapTest(R): for each map pixel P under R, where P is about as large",
        "for each pixel, P, in HOM[HOM.HighestLevel] that intersects BoundingRect",
    ),
    CodeLine::new("Overlap:2", "    if not CheckPixel(P): return false"),
    CodeLine::new("Overlap:3", "  return true"),
    CodeLine::new("Check:1", "CheckPixel(P): look up the opacity of P"),
    CodeLine::departing(
        "Check:2",
        "  if it is at least the threshold of P's level",
        "if (Op > HOM[Level].OpacityThreshold)",
    ),
    CodeLine::new("Check:3", "    return true"),
    CodeLine::new("Check:4", "  else if P is on level 0"),
    CodeLine::new("Check:5", "    return false"),
    CodeLine::new("Check:6", "  else if it is below the threshold of level 0, and P lies in R"),
    CodeLine::new("Check:7", "    return false"),
    CodeLine::new(
        "Check:8",
        "  for each pixel S below P that overlaps R: if not CheckPixel(S): return false",
    ),
];

/// Lines of [`CODE`] that the run reaches.
pub(super) mod line {
    use super::CODE;
    use crate::method::line;
    pub const FRAME: u8 = line(CODE, "Frame:1");
    pub const OFF: u8 = line(CODE, "Frame:2");
    pub const CANDIDATES: u8 = line(CODE, "Frame:3");
    pub const LOOK_UP: u8 = line(CODE, "Frame:4");
    pub const SORT: u8 = line(CODE, "Frame:5");
    pub const EACH: u8 = line(CODE, "Frame:6");
    pub const BEYOND: u8 = line(CODE, "Frame:7");
    pub const EXCEEDS: u8 = line(CODE, "Frame:8");
    pub const CHOOSE: u8 = line(CODE, "Frame:9");
    pub const PLANE: u8 = line(CODE, "Frame:10");
    pub const EACH_OCCLUDER: u8 = line(CODE, "Frame:11");
    pub const COVER: u8 = line(CODE, "Frame:12");
    pub const STAND_IN: u8 = line(CODE, "Frame:13");
    pub const WRITE: u8 = line(CODE, "Frame:14");
    pub const FILL: u8 = line(CODE, "Frame:15");
    pub const AVERAGE: u8 = line(CODE, "Frame:16");
    pub const ROOT: u8 = line(CODE, "Frame:17");
    pub const ADAPT: u8 = line(CODE, "Frame:18");
    pub const CULL: u8 = line(CODE, "Cull:1");
    pub const OUTSIDE: u8 = line(CODE, "Cull:2");
    pub const HOLDS: u8 = line(CODE, "Cull:3");
    pub const RECTANGLE: u8 = line(CODE, "Cull:4");
    pub const NEAR: u8 = line(CODE, "Cull:5");
    pub const NO_PIXEL: u8 = line(CODE, "Cull:6");
    pub const BEHIND_PLANE: u8 = line(CODE, "Cull:7");
    pub const BEHIND_ENTRIES: u8 = line(CODE, "Cull:8");
    pub const OVERLAP: u8 = line(CODE, "Cull:9");
    pub const NOT_COVERED: u8 = line(CODE, "Cull:10");
    pub const BEHIND_SAMPLES: u8 = line(CODE, "Cull:11");
    pub const LEAF: u8 = line(CODE, "Cull:12");
    pub const CHILDREN: u8 = line(CODE, "Cull:13");
    pub const DRAW: u8 = line(CODE, "Draw:1");
    pub const DRAW_ALL: u8 = line(CODE, "Draw:2");
    pub const EACH_PRIM: u8 = line(CODE, "Draw:3");
    pub const FACES_AWAY: u8 = line(CODE, "Draw:4");
    pub const SHOWS_NOWHERE: u8 = line(CODE, "Draw:5");
    pub const DRAW_PRIM: u8 = line(CODE, "Draw:6");
    pub const TEST_EACH: u8 = line(CODE, "Overlap:1");
    pub const TEST_CHECK: u8 = line(CODE, "Overlap:2");
    pub const COVERED: u8 = line(CODE, "Overlap:3");
    pub const CHECK: u8 = line(CODE, "Check:1");
    pub const COMPARE: u8 = line(CODE, "Check:2");
    pub const OPAQUE: u8 = line(CODE, "Check:3");
    pub const FINEST: u8 = line(CODE, "Check:4");
    pub const TRANSPARENT: u8 = line(CODE, "Check:5");
    pub const TOO_TRANSPARENT: u8 = line(CODE, "Check:6");
    pub const ENDS: u8 = line(CODE, "Check:7");
    pub const DESCEND: u8 = line(CODE, "Check:8");
}

/// At which lines each kind of event stands.
pub(super) const STANDS: &[(&str, &[&str])] = &[
    ("NodeClassified", &["Cull:2"]),
    ("OccludersGathered", &["Frame:5"]),
    ("GridLookedUp", &["Frame:4"]),
    ("OccluderChosen", &["Frame:9"]),
    ("OccluderRefused", &["Frame:7", "Frame:8"]),
    ("PlaneSet", &["Frame:10"]),
    ("OccluderDrawn", &["Frame:12", "Frame:13"]),
    ("DepthWritten", &["Frame:14"]),
    ("MapsBuilt", &["Frame:16"]),
    ("BudgetAdapted", &["Frame:18"]),
    ("CullingPaused", &["Frame:2"]),
    ("OccluderHeld", &["Cull:3"]),
    ("DepthCompared", &["Cull:7", "Cull:8", "Cull:11"]),
    ("CellRead", &["Cull:11"]),
    ("TileRefreshed", &["Cull:11"]),
    ("MapRead", &["Check:2", "Check:4", "Check:6"]),
    ("OcclusionTested", &["Cull:5", "Cull:6", "Cull:7", "Cull:8", "Cull:9", "Cull:10", "Cull:11"]),
    ("OrientationTested", &["Draw:4"]),
    ("PrimitiveBehind", &["Draw:5"]),
    ("NodeDecided outside", &["Cull:2"]),
    ("NodeDecided hidden", &["Cull:6", "Cull:9", "Cull:11"]),
    ("NodeDecided presumed", &["Cull:6", "Cull:9", "Cull:11"]),
    ("NodeDecided partial", &["Cull:13"]),
    ("NodeDecided visible", &["Cull:12"]),
    ("PrimDecided faces-away", &["Draw:4"]),
    ("PrimDecided hidden", &["Draw:5"]),
    ("PrimDecided visible", &["Draw:6"]),
];

/// Where it differs from the paper.
pub(super) const DEPARTURES: &[Departure] = &[
    Departure {
        section: "3",
        what: "overlap is tested before depths are compared",
        why: "to compare the depths of samples takes longer, and most of what may be seen is not covered",
        when: When::With("depth", "samples"),
    },
    Departure {
        section: "3",
        what: "of an occluder those polygons are left out that were nowhere nearer than what had been drawn \
               in white before them; not with depth=plane, nor with samples of the maps' own",
        why: "drawing them in white has shown that they are hidden",
        when: When::Always,
    },
    Departure {
        section: "4.1",
        what: "the maps are made of the image's own samples, and a map pixel is a square of them; \
               samples=1, 4 or 16 gives the maps samples of their own, as in the paper",
        why: "a map of any resolution is then exact for the image, which a smaller image of the occluders is \
              not",
        when: When::With("samples", "image"),
    },
    Departure {
        section: "4.1",
        what: "counts of black samples are kept, not averages",
        why: "whole numbers are not rounded; opacity is shown as what they amount to",
        when: When::Always,
    },
    Departure {
        section: "5.1",
        what: "the comparisons of Figure 8 are at least and equal, as footnote 1 and the text say, and the \
               test begins where a map pixel is about as large as the rectangle, as the text says",
        why: "as printed nothing is opaque where the threshold is 1",
        when: When::Always,
    },
    Departure {
        section: "5.2.1",
        what: "occluders are drawn as far as the plane Z only",
        why: "one that crosses the plane may lie behind what is beyond it",
        when: When::With("depth", "plane"),
    },
    Departure {
        section: "5.2.2",
        what: "what is as deep as an entry is not behind it, and an entry that no occluder touches says \
               nothing",
        why: "a flat occluder that faces the eye would cull itself; the paper names no first value",
        when: When::With("depth", "estimation"),
    },
    Departure {
        section: "5.2.2",
        what: "with depth=samples the occluders' own depths are compared, at the samples that they cover: \
               the no-background z-buffer of Zhang's dissertation (1998)",
        why: "they are at hand, and much nearer to the truth than corners of boxes",
        when: When::With("depth", "samples"),
    },
    Departure {
        section: "5.3.1",
        what: "small is below 2 ‰ of the scene (occluder-size); redundant, closer than 2 % before one of the \
               1,000 largest faces and within it; complex, above 8 times the median of primitives for its \
               size",
        why: "the paper gives no numbers",
        when: When::Always,
    },
    Departure {
        section: "5.3.2",
        what: "L is not exceeded, and last frame's occluders stay while they rank within 1.25 L",
        why: "a limit is a limit, and a set that flickers makes what is culled flicker",
        when: When::Always,
    },
    Departure {
        section: "5.3.2",
        what: "with selection=grid leaves come by the angle under which the grid points about the eye see \
               them, each point by its trilinear weight, and the nearest of all others follow",
        why: "the paper says that occluders can be chosen from lists, not in which order",
        when: When::With("selection", "grid"),
    },
    Departure {
        section: "5.4",
        what: "with closing holes of at most so many black samples, connected if only at corners, are filled \
               before the maps are averaged",
        why: "a threshold counts black samples of a map pixel, whether they are one hole or part of a slit",
        when: When::Without("closing", "0"),
    },
    Departure {
        section: "5.5",
        what: "with selection=grid what moves is in no list, and is chosen by distance after what is in one",
        why: "the paper has no preprocess where things move; what stands still need not do without",
        when: When::With("selection", "grid"),
    },
    Departure {
        section: "5.5",
        what: "boxes of what moves stay along the axes, refit to where its points are, and are not oriented",
        why: "refit to points they are as tight as boxes that turn along; even the rectangle of the points \
              themselves would spare 6 % of what is drawn of the swarm",
        when: When::Always,
    },
    Departure {
        section: "6.2",
        what: "L and the distance limit change by a quarter, by counts of polygons and not by the clock; \
               below 500 polygons (2 in flatland) or above 5 % of the scene (20 %) L does not go",
        why: "a frame can then be played again; the paper gives no numbers",
        when: When::With("adapt", "true"),
    },
    Departure {
        section: "6.2",
        what: "with occluders=merged, largest or inner what stands in for an occluder covers no sample that \
               it does not cover, nearer than it does; where snapping to the pixel grid could undo that, \
               the occluder itself is drawn, or, of inner boxes, nothing",
        why: "the paper's simplified occluders have error bounds and do not preserve occlusion, which \
              Section 8 wishes for",
        when: When::Without("occluders", "original"),
    },
    Departure {
        section: "7",
        what: "culling is turned off after three frames that cull fewer polygons than occluders and tests \
               cost, and tried again after 30, or when a quarter more or less is drawn",
        why: "the paper says that it should be turned off, not when",
        when: When::With("adapt", "true"),
    },
];

/// Whether a line belongs to these parameters.
pub(super) fn has_line(params: &Params, at: u8) -> bool {
    let is_plane = params.depth == DepthKind::Plane;
    match at {
        line::OFF | line::ADAPT | line::BEYOND => params.adapts,
        line::PLANE | line::BEHIND_PLANE => is_plane,
        line::WRITE | line::BEHIND_ENTRIES => params.depth == DepthKind::Estimation,
        line::NOT_COVERED | line::BEHIND_SAMPLES => params.depth == DepthKind::Samples,
        line::HOLDS | line::OVERLAP => params.depth != DepthKind::Samples,
        line::COVER => params.occluders == Kind::Original,
        line::STAND_IN => params.occluders != Kind::Original,
        line::FILL => params.closing > 0,
        line::LOOK_UP => params.uses_grid(),
        line::DRAW_ALL => !params.surfaces.one_sided,
        line::EACH_PRIM | line::DRAW_PRIM => params.surfaces.one_sided || params.knows_what_shows(),
        line::FACES_AWAY => params.surfaces.one_sided,
        line::SHOWS_NOWHERE => params.knows_what_shows(),
        _ => true,
    }
}
