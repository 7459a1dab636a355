//! The pseudocode of this method, and where it differs from the papers.

use super::{Form, Params, Volume};
use crate::method::{CodeLine, Departure, When};

/// The pseudocode.
pub(super) const CODE: &[CodeLine] = &[
    // Section 3.3. Marks of shared primitives are those of Section 3.1.
    CodeLine::new("Frame:1", "Frame(visible list L)"),
    CodeLine::new("Frame:2", "  clear the z-buffer and the z-pyramid"),
    CodeLine::new("Frame:3", "  for each cube C of L in view, front to back"),
    CodeLine::new("Frame:4", "    Draw(C)"),
    CodeLine::departing("Frame:5", "    keep C, to be drawn with the others", "Draw(C)"),
    CodeLine::new("Frame:6", "  Draw(those kept)"),
    CodeLine::departing("Frame:7", "  bring the z-pyramid up to date", "the z-pyramid is up to date"),
    CodeLine::new("Frame:8", "  Visit(root)"),
    CodeLine::new("Frame:9", "  Draw(those kept since)"),
    CodeLine::new("Frame:10", "  for each primitive p that several cubes share"),
    CodeLine::new("Frame:11", "    if none of them was drawn: p is hidden"),
    CodeLine::new("Frame:12", "  if a check of L is due"),
    CodeLine::new("Frame:13", "    for each cube C of L in view"),
    CodeLine::new("Frame:14", "      if Obscured(C)"),
    CodeLine::departing("Frame:15", "        remove C from L, with all below it", "remove C from L"),
    // Section 3.1 for the tree; the list is that of Section 3.3.
    CodeLine::new("Visit:1", "Visit(cube C)"),
    CodeLine::new("Visit:2", "  if C is outside the view"),
    CodeLine::new("Visit:3", "    return"),
    CodeLine::new("Visit:4", "  if C was not drawn from L"),
    CodeLine::new("Visit:5", "    if Obscured(C)"),
    CodeLine::new("Visit:6", "      return"),
    CodeLine::new("Visit:7", "    add C to L"),
    CodeLine::new("Visit:8", "    Draw(C)"),
    CodeLine::departing("Visit:9", "    keep C, to be drawn with the others", "Draw(C)"),
    CodeLine::new("Visit:10", "  for each child D of C, front to back"),
    CodeLine::new("Visit:11", "    Visit(D)"),
    // Section 3.1 for what is drawn once; Greene, Kass and Miller 1993, Section 3.2, for the test of a
    // primitive.
    CodeLine::new("Draw:1", "Draw(cube C, or several)"),
    CodeLine::new("Draw:2", "  P := the primitives of C that are not drawn yet"),
    CodeLine::new("Draw:3", "  take those away from P that face away from the eye"),
    CodeLine::departing(
        "Draw:4",
        "  bring the pyramid up to date under C, if few of its tiles are stale",
        "the pyramid is up to date",
    ),
    CodeLine::new("Draw:5", "  for each primitive p of P"),
    CodeLine::new("Draw:6", "    if p is behind its pyramid cells"),
    CodeLine::new("Draw:7", "      skip p"),
    CodeLine::departing(
        "Draw:8",
        "    rasterize p; its tiles of the pyramid are stale from now on",
        "rasterize p; update the pyramid at every resolution",
    ),
    // Section 3.2; the sphere is that of Section 5.3.
    CodeLine::new("Obscured:1", "Obscured(cube C)"),
    CodeLine::new("Obscured:2", "  if C crosses the near plane"),
    CodeLine::new("Obscured:3", "    return false"),
    CodeLine::new("Obscured:4", "  if C covers no pixel: return true"),
    CodeLine::departing(
        "Obscured:5",
        "  B := the box of C, by its planes",
        "for each face F of C toward the eye",
    ),
    CodeLine::departing(
        "Obscured:6",
        "  B := the screen rectangle of C",
        "for each face F of C toward the eye",
    ),
    CodeLine::departing(
        "Obscured:7",
        "  B := the screen rectangle of the sphere around C",
        "the sphere at every pixel",
    ),
    CodeLine::departing(
        "Obscured:8",
        "  for each of the at most four cells q over B on the screen",
        "q := the finest cell that covers F on the screen",
    ),
    CodeLine::new("Obscured:9", "    if not Behind(B, q)"),
    CodeLine::new("Obscured:10", "      return false"),
    CodeLine::new("Obscured:11", "  return true"),
    // Section 3.2: the descent "to higher resolutions".
    CodeLine::new("Behind:1", "Behind(box B, cell q)"),
    CodeLine::departing(
        "Behind:2",
        "  if B begins behind q, wherever it is in q",
        "if the nearest depth of F is behind q",
    ),
    CodeLine::new("Behind:3", "    return true"),
    CodeLine::departing("Behind:4", "  if q is a pixel, or B covers q and is not behind", "if q is a pixel"),
    CodeLine::new("Behind:5", "    return false"),
    CodeLine::new("Behind:6", "  for each cell r of the four below q that B touches"),
    CodeLine::new("Behind:7", "    if not Behind(B, r)"),
    CodeLine::new("Behind:8", "      return false"),
    CodeLine::new("Behind:9", "  return true"),
];

/// Lines of [`CODE`] that the run reaches.
pub(super) mod line {
    use super::CODE;
    use crate::method::line;
    pub const FRAME: u8 = line(CODE, "Frame:1");
    pub const CLEAR: u8 = line(CODE, "Frame:2");
    pub const EACH_LISTED: u8 = line(CODE, "Frame:3");
    pub const DRAW_LISTED: u8 = line(CODE, "Frame:4");
    pub const KEEP_LISTED: u8 = line(CODE, "Frame:5");
    pub const DRAW_KEPT: u8 = line(CODE, "Frame:6");
    pub const REFRESH_ALL: u8 = line(CODE, "Frame:7");
    pub const VISIT_ROOT: u8 = line(CODE, "Frame:8");
    pub const DRAW_FOUND: u8 = line(CODE, "Frame:9");
    pub const EACH_SHARED: u8 = line(CODE, "Frame:10");
    pub const UNSEEN: u8 = line(CODE, "Frame:11");
    pub const CHECK: u8 = line(CODE, "Frame:12");
    pub const EACH_CHECKED: u8 = line(CODE, "Frame:13");
    pub const CHECK_OBSCURED: u8 = line(CODE, "Frame:14");
    pub const UNLIST: u8 = line(CODE, "Frame:15");
    pub const VISIT: u8 = line(CODE, "Visit:1");
    pub const VIEW: u8 = line(CODE, "Visit:2");
    pub const OUTSIDE: u8 = line(CODE, "Visit:3");
    pub const UNLISTED: u8 = line(CODE, "Visit:4");
    pub const OBSCURED: u8 = line(CODE, "Visit:5");
    pub const HIDDEN: u8 = line(CODE, "Visit:6");
    pub const ADD: u8 = line(CODE, "Visit:7");
    pub const DRAW: u8 = line(CODE, "Visit:8");
    pub const KEEP: u8 = line(CODE, "Visit:9");
    pub const CHILDREN: u8 = line(CODE, "Visit:10");
    pub const CHILD: u8 = line(CODE, "Visit:11");
    pub const DRAW_CUBE: u8 = line(CODE, "Draw:1");
    pub const GATHER: u8 = line(CODE, "Draw:2");
    pub const FACES_AWAY: u8 = line(CODE, "Draw:3");
    pub const REFRESH: u8 = line(CODE, "Draw:4");
    pub const EACH: u8 = line(CODE, "Draw:5");
    pub const TEST: u8 = line(CODE, "Draw:6");
    pub const SKIP: u8 = line(CODE, "Draw:7");
    pub const RASTERIZE: u8 = line(CODE, "Draw:8");
    pub const QUERY: u8 = line(CODE, "Obscured:1");
    pub const NEAR: u8 = line(CODE, "Obscured:2");
    pub const CROSSES: u8 = line(CODE, "Obscured:3");
    pub const NO_PIXEL: u8 = line(CODE, "Obscured:4");
    pub const PLANES: u8 = line(CODE, "Obscured:5");
    pub const RECTANGLE: u8 = line(CODE, "Obscured:6");
    pub const SPHERE: u8 = line(CODE, "Obscured:7");
    pub const CELL: u8 = line(CODE, "Obscured:8");
    pub const ASK_CELL: u8 = line(CODE, "Obscured:9");
    pub const SEEN: u8 = line(CODE, "Obscured:10");
    pub const ALL_HIDDEN: u8 = line(CODE, "Obscured:11");
    pub const DESCENT: u8 = line(CODE, "Behind:1");
    pub const COMPARE: u8 = line(CODE, "Behind:2");
    pub const HIDES: u8 = line(CODE, "Behind:3");
    pub const COVERS: u8 = line(CODE, "Behind:4");
    pub const SHOWS: u8 = line(CODE, "Behind:5");
    pub const BELOW: u8 = line(CODE, "Behind:6");
    pub const ASK_BELOW: u8 = line(CODE, "Behind:7");
    pub const BELOW_SHOWS: u8 = line(CODE, "Behind:8");
    pub const BELOW_HIDES: u8 = line(CODE, "Behind:9");
}

/// At which lines each kind of event stands.
pub(super) const STANDS: &[(&str, &[&str])] = &[
    ("NodeClassified", &["Visit:2"]),
    ("CubeListed", &["Frame:3", "Visit:4"]),
    ("ObscurationTested", &["Obscured:3", "Obscured:4", "Obscured:10", "Obscured:11"]),
    ("CellRead", &["Behind:2"]),
    ("TileRefreshed", &["Behind:2"]),
    ("TilesRefreshed", &["Draw:4"]),
    ("PyramidRefreshed", &["Frame:7"]),
    ("OrientationTested", &["Draw:3"]),
    ("PrimitiveBehind", &["Draw:6"]),
    ("PrimitiveRasterized", &["Draw:8"]),
    ("SharedUnseen", &["Frame:11"]),
    ("ListChecked", &["Frame:12"]),
    ("CubeUnlisted", &["Frame:15"]),
    ("NodeDecided outside", &["Visit:3"]),
    ("NodeDecided hidden", &["Visit:6"]),
    ("NodeDecided partial", &["Visit:4", "Visit:5"]),
    ("PrimDecided faces-away", &["Draw:3"]),
    ("PrimDecided hidden", &["Draw:7", "Frame:11"]),
    ("PrimDecided visible", &["Draw:8"]),
];

/// Where it differs from the papers.
pub(super) const DEPARTURES: &[Departure] = &[
    Departure {
        section: "3.1",
        what: "a primitive is small up to 12 % of its cube (small-percent), and cubes are divided down to \
               128 triangles or 8 segments (leaf-primitives)",
        why: "the paper gives no numbers",
        when: When::Always,
    },
    Departure {
        section: "3.2",
        what: "the bounds of what a cube holds are queried, not the cube",
        why: "they are smaller and more often hidden",
        when: When::Always,
    },
    Departure {
        section: "3.2",
        what: "with query=planes, the default, the box is asked by its planes, which say where it begins \
               over each cell and whether it touches it, not by its faces as projected, each at the depth \
               of its nearest vertex",
        why: "it comes nearer to the truth, it holds at every pixel, and no image of a face is made",
        when: When::With("query", "planes"),
    },
    Departure {
        section: "3.2",
        what: "the descent begins at the at most four cells that cover the box, not at the finest single one",
        why: "what lies across a border of large cells would begin far up",
        when: When::Always,
    },
    Departure {
        section: "3.2",
        what: "a cell that the box covers, beginning before the farthest thing in it, ends the descent",
        why: "some pixel of it shows the box",
        when: When::Always,
    },
    Departure {
        section: "3.2",
        what: "the pyramid is brought up to date where it is read, not where it is drawn",
        why: "most of it is not read before it is drawn into again",
        when: When::Always,
    },
    Departure {
        section: "3.2 (Greene, Kass and Miller)",
        what: "a primitive is compared with the at most four cells over its rectangle, none of them a \
               pixel",
        why: "then it does not matter in which order, and on how many threads, primitives are drawn",
        when: When::Always,
    },
    Departure {
        section: "3.3",
        what: "with form=two-pass all cubes are queried against what was on the list; incremental is the \
               way of the paper",
        why: "today's engines do so",
        when: When::With("form", "two-pass"),
    },
    Departure {
        section: "3.3",
        what: "the list is kept as marks on the tree, and a cube leaves it with all below it",
        why: "listed cubes are drawn front to back, and no cube is on the list below one that is not",
        when: When::Always,
    },
    Departure {
        section: "4.2",
        what: "a check is early if a quarter of the list is new, or the farthest depth shifts by more than \
               1.5 times",
        why: "the paper gives no numbers",
        when: When::Always,
    },
    Departure {
        section: "5.3",
        what: "with query=sphere the screen rectangle of the sphere is queried, with query=rectangles that \
               of the box",
        why: "the sphere itself is what the machine of the paper draws; to compare both with the planes",
        when: When::Always,
    },
];

/// Whether a line belongs to these parameters.
pub(super) fn has_line(params: &Params, at: u8) -> bool {
    let (two_pass, sieved) = (params.form == Form::TwoPass, params.primitive_test);
    let is_one_cube = params.cubes.tree_levels == 1;
    match at {
        line::EACH_LISTED | line::UNLISTED | line::ADD => params.coherence,
        line::CHECK | line::EACH_CHECKED | line::CHECK_OBSCURED | line::UNLIST => params.coherence,
        line::DRAW_LISTED => params.coherence && !two_pass,
        line::KEEP_LISTED | line::DRAW_KEPT => params.coherence && two_pass,
        line::REFRESH_ALL | line::DRAW_FOUND | line::KEEP => two_pass,
        line::DRAW => !two_pass,
        line::EACH_SHARED | line::UNSEEN => params.cubes.may_share(),
        line::CHILD => !is_one_cube,
        line::FACES_AWAY => params.surfaces.one_sided,
        line::REFRESH => sieved && !two_pass,
        line::TEST => sieved,
        // Of one cube nothing is drawn before it is asked for, so nothing hides it or any of it.
        line::SKIP => sieved && !is_one_cube,
        line::HIDES | line::BELOW_HIDES | line::ALL_HIDDEN => !is_one_cube,
        line::PLANES => params.query == Volume::Planes,
        line::RECTANGLE => params.query == Volume::Rectangles,
        line::SPHERE => params.query == Volume::Sphere,
        _ => true,
    }
}
