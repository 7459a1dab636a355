//! Pseudocode of the method, which events stand where in it, and where it departs from the paper. The paper's
//! own figure of it is lost; this is its text (Sections 3 and 4) in lines.

use super::{Order, Params};
use crate::method::{CodeLine, Departure, When};

/// Pseudocode.
pub(super) const CODE: &[CodeLine] = &[
    CodeLine::new("Render:1", "Render(cell C, planes P)"),
    CodeLine::new("Render:2", "  if C lies outside a plane of P"),
    CodeLine::new("Render:3", "    return"),
    CodeLine::new("Render:4", "  P' := the planes of P that cut C"),
    CodeLine::departing(
        "Render:5",
        "  draw into the depths what was drawn since the last question",
        "not asked",
    ),
    CodeLine::departing(
        "Render:6",
        "  if C is large on the screen and behind what is in the depths",
        "not asked",
    ),
    CodeLine::departing("Render:7", "    or behind that and color cubes that are full together", "not asked"),
    CodeLine::departing("Render:8", "    return", "not asked"),
    CodeLine::new("Render:9", "  if C is no larger on the screen than the pixel threshold"),
    CodeLine::departing("Render:10", "    and C's cube is not too wrong for its size", "no such test"),
    CodeLine::new("Render:11", "    draw the faces of C's color cube that face the eye"),
    CodeLine::departing(
        "Render:12",
        "  else if C is a leaf, or P' is empty and to look below C costs more than to draw it",
        "else if C is a leaf",
    ),
    CodeLine::new("Render:13", "    DrawGeometry(C)"),
    CodeLine::departing(
        "Render:14",
        "  else for each child C' of C, front to back",
        "for each child C' of C, back to front",
    ),
    CodeLine::new("Render:15", "  else for each child C' of C, back to front"),
    CodeLine::new("Render:16", "    Render(C', P')"),
    CodeLine::departing("Render:17", "  each primitive that C's children share is now settled:", "not said"),
    CodeLine::departing("Render:18", "    drawn, in color cubes alone, or out of view", "not said"),
    CodeLine::new("DrawGeometry:1", "DrawGeometry(C)"),
    CodeLine::new("DrawGeometry:2", "  draw the primitives of C that no other leaf holds"),
    CodeLine::new("DrawGeometry:3", "  for each other primitive p of C"),
    CodeLine::new("DrawGeometry:4", "    if p was drawn with another leaf: next p"),
    CodeLine::new("DrawGeometry:5", "    if p faces away from the eye: next p"),
    CodeLine::new("DrawGeometry:6", "    draw p"),
];

/// Lines of [`CODE`] that the run reaches.
pub(super) mod line {
    use super::CODE;
    use crate::method::line;
    pub const RENDER: u8 = line(CODE, "Render:1");
    pub const TEST: u8 = line(CODE, "Render:2");
    pub const OUTSIDE: u8 = line(CODE, "Render:3");
    pub const CUTTING: u8 = line(CODE, "Render:4");
    pub const DRAW_WAITING: u8 = line(CODE, "Render:5");
    pub const BEHIND: u8 = line(CODE, "Render:6");
    pub const BEHIND_CUBES: u8 = line(CODE, "Render:7");
    pub const LEFT_OUT: u8 = line(CODE, "Render:8");
    pub const SIZE: u8 = line(CODE, "Render:9");
    pub const ERROR: u8 = line(CODE, "Render:10");
    pub const CUBE: u8 = line(CODE, "Render:11");
    pub const LEAF: u8 = line(CODE, "Render:12");
    pub const CALL_DRAW: u8 = line(CODE, "Render:13");
    pub const CHILDREN: u8 = line(CODE, "Render:14");
    pub const FROM_BACK: u8 = line(CODE, "Render:15");
    pub const CHILD: u8 = line(CODE, "Render:16");
    pub const SHARED: u8 = line(CODE, "Render:17");
    pub const SETTLED: u8 = line(CODE, "Render:18");
    pub const DRAW: u8 = line(CODE, "DrawGeometry:1");
    pub const OWN: u8 = line(CODE, "DrawGeometry:2");
    pub const EACH: u8 = line(CODE, "DrawGeometry:3");
    pub const ONCE: u8 = line(CODE, "DrawGeometry:4");
    pub const FACES_AWAY: u8 = line(CODE, "DrawGeometry:5");
    pub const DRAW_PRIM: u8 = line(CODE, "DrawGeometry:6");
}

/// At which lines each kind of event stands.
pub(super) const STANDS: &[(&str, &[&str])] = &[
    ("NodeClassified", &["Render:2"]),
    ("DepthsDrawn", &["Render:5"]),
    ("CellRead", &["Render:6"]),
    ("TileRefreshed", &["Render:6"]),
    ("ObscurationTested", &["Render:6"]),
    ("SaturationTested", &["Render:7"]),
    ("NodeDecided hidden", &["Render:8"]),
    ("NodeDecided presumed", &["Render:8"]),
    ("CellSized", &["Render:9"]),
    ("CubeMeasured", &["Render:10"]),
    ("CubeDrawn", &["Render:11"]),
    ("GeometryDrawn", &["Render:13"]),
    ("OrientationTested", &["DrawGeometry:5"]),
    ("PrimitiveDrawn", &["DrawGeometry:6"]),
    ("SharedSettled", &["Render:18"]),
    ("NodeDecided outside", &["Render:3"]),
    ("NodeDecided approximated", &["Render:11"]),
    ("NodeDecided partial", &["Render:14", "Render:15"]),
    ("NodeDecided visible", &["Render:13"]),
    ("PrimDecided visible", &["DrawGeometry:6"]),
    ("PrimDecided faces-away", &["DrawGeometry:5"]),
    ("PrimDecided approximated", &["Render:18"]),
    ("PrimDecided presumed", &["Render:18"]),
    ("PrimDecided hidden", &["Render:18"]),
];

/// Where it differs from the paper.
pub(super) const DEPARTURES: &[Departure] = &[
    Departure {
        section: "3",
        what: "cells are visited front to back and cubes put under what is there; geometry is drawn first, \
               and cubes are tested against its depths, which they leave as they are",
        why: "the picture is that of the paper's back to front wherever cubes and geometry do not mix, and \
              depends on no order where they do (Section 5.1); what is full is left alone",
        when: When::Without("order", "paper"),
    },
    Departure {
        section: "3",
        what: "a cell's size on the screen is that of a side at the depth of its center",
        why: "the paper gives no measure; this one halves from level to level and does not change as a cell \
              is seen from another side",
        when: When::Always,
    },
    Departure {
        section: "3",
        what: "a cell in full view is drawn as geometry at once where visits, cubes, and the primitives that \
               are drawn all the same would cost more",
        why: "a view that needs geometry costs hardly more than geometry, where the paper's took up to 2.5 \
              times as long (Table 2)",
        when: When::Always,
    },
    Departure {
        section: "3",
        what: "the light is fixed in the world",
        why: "what is kept on faces cannot depend on the eye; the paper does not speak of light",
        when: When::Always,
    },
    Departure {
        section: "4",
        what: "a primitive's cost is shared equally by the children that it goes to, cell by cell",
        why: "the number of cells that the paper divides by changes while the tree grows",
        when: When::Always,
    },
    Departure {
        section: "4",
        what: "a primitive goes to the cells that it meets, not to those that its box meets",
        why: "slanted primitives meet far fewer",
        when: When::Always,
    },
    Departure {
        section: "4",
        what: "with interior=direct faces of inner cells are made as those of leaves",
        why: "the paper names it, at the price of more preprocessing: half-covered faces in a row then come \
              out right",
        when: When::With("interior", "direct"),
    },
    Departure {
        section: "4",
        what: "with faces=analytic the color of a face follows from the areas that show, not from samples",
        why: "the paper names it as well; two halves of a face then are a half each, where of 4×4 samples \
              one has 6 and the other 10",
        when: When::With("faces", "analytic"),
    },
    Departure {
        section: "6",
        what: "cells behind geometry that is drawn are left out, and with occlusion=depth-and-opacity those \
               behind color cubes that let less than 1/1024 of the light through as well",
        why: "the paper names the hierarchical z-buffer as future work; a cell that does not show need be \
              drawn neither as a cube nor as geometry",
        when: When::Without("occlusion", "none"),
    },
    Departure {
        section: "5.1",
        what: "with an error-bound cells are refined whose cubes are too wrong, as measured between the axes",
        why: "surfaces then stay whole, where the paper's are torn; it wishes for various techniques by \
              geometry (Section 6)",
        when: When::Without("error-bound", "0"),
    },
];

/// Whether a line belongs to these parameters.
pub(super) fn has_line(params: &Params, at: u8) -> bool {
    let has_children = params.tree_levels > 1;
    match at {
        line::CUBE => params.pixel_threshold > 0.0,
        line::DRAW_WAITING | line::BEHIND | line::LEFT_OUT => params.hides(),
        line::BEHIND_CUBES => params.hides_behind_cubes(),
        line::ERROR => params.measures() && params.pixel_threshold > 0.0,
        line::CHILDREN => has_children && params.order == Order::Exact,
        line::FROM_BACK => has_children && params.order == Order::Paper,
        line::CHILD | line::SHARED | line::SETTLED => has_children,
        line::EACH | line::ONCE => has_children,
        line::DRAW_PRIM => has_children || params.surfaces.one_sided,
        line::OWN => !params.surfaces.one_sided,
        line::FACES_AWAY => params.surfaces.one_sided,
        _ => true,
    }
}
