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
        "  if C is behind the few cells over its screen rectangle",
        "no such look: the faces come first",
    ),
    CodeLine::new("Obscured:6", "    return true"),
    CodeLine::new("Obscured:7", "  for each face F of C toward the eye"),
    CodeLine::new("Obscured:8", "    q := the finest cell that covers F on the screen"),
    CodeLine::new("Obscured:9", "    if not Behind(F, q)"),
    CodeLine::new("Obscured:10", "      return false"),
    CodeLine::new("Obscured:11", "  return true"),
    CodeLine::departing("Obscured:12", "  F := the screen rectangle of C", "each face toward the eye"),
    CodeLine::departing(
        "Obscured:13",
        "  F := the screen rectangle of the sphere around C",
        "the sphere at every pixel",
    ),
    CodeLine::new("Obscured:14", "  q := the finest cell that covers F on the screen"),
    CodeLine::new("Obscured:15", "  return Behind(F, q)"),
    // Section 3.2: the descent "to higher resolutions".
    CodeLine::new("Behind:1", "Behind(face F, cell q)"),
    CodeLine::departing(
        "Behind:2",
        "  if the nearest depth of C is behind q",
        "if the nearest depth of F is behind q",
    ),
    CodeLine::new("Behind:3", "    return true"),
    CodeLine::departing("Behind:4", "  if q is a pixel, or F covers q", "if q is a pixel"),
    CodeLine::new("Behind:5", "    return false"),
    CodeLine::new("Behind:6", "  for each cell r of the four below q that F touches"),
    CodeLine::new("Behind:7", "    if not Behind(F, r)"),
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
    pub const WHOLE: u8 = line(CODE, "Obscured:5");
    pub const WHOLE_HIDES: u8 = line(CODE, "Obscured:6");
    pub const FACE: u8 = line(CODE, "Obscured:7");
    pub const FINEST: u8 = line(CODE, "Obscured:8");
    pub const BEHIND_FACE: u8 = line(CODE, "Obscured:9");
    pub const SEEN: u8 = line(CODE, "Obscured:10");
    pub const ALL_HIDDEN: u8 = line(CODE, "Obscured:11");
    pub const RECTANGLE: u8 = line(CODE, "Obscured:12");
    pub const SPHERE: u8 = line(CODE, "Obscured:13");
    pub const FINEST_ONE: u8 = line(CODE, "Obscured:14");
    pub const BEHIND_ONE: u8 = line(CODE, "Obscured:15");
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
    (
        "ObscurationTested",
        &["Obscured:3", "Obscured:4", "Obscured:6", "Obscured:10", "Obscured:11", "Obscured:15"],
    ),
    ("CellRead", &["Obscured:5", "Behind:2"]),
    ("TileRefreshed", &["Obscured:5", "Behind:2"]),
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
        what: "for every face the nearest depth of the whole box is compared, not that of the face",
        why: "a triangle that the rasterizer snapped to its grid may come nearer than the face it shows \
               through, but never nearer than the box",
        when: When::Always,
    },
    Departure {
        section: "3.2",
        what: "before the faces the few cells over the rectangle of the whole box are read",
        why: "they decide for most of what is hidden",
        when: When::Always,
    },
    Departure {
        section: "3.2",
        what: "a cell that a face covers wholly and that is not nearer ends the descent",
        why: "some pixel of it shows the face",
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
        what: "with query=sphere the screen rectangle of the sphere is queried",
        why: "the sphere itself is what the machine of the paper draws",
        when: When::With("query", "sphere"),
    },
];

/// Whether a line belongs to these parameters.
pub(super) fn has_line(params: &Params, at: u8) -> bool {
    let (two_pass, sieved) = (params.form == Form::TwoPass, params.primitive_test);
    let (by_faces, is_one_cube) = (params.query == Volume::Faces, params.cubes.tree_levels == 1);
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
        line::HIDES | line::BELOW_HIDES => !is_one_cube,
        line::WHOLE_HIDES | line::ALL_HIDDEN => by_faces && !is_one_cube,
        line::WHOLE | line::FACE | line::FINEST | line::BEHIND_FACE | line::SEEN => by_faces,
        line::RECTANGLE => params.query == Volume::Rectangles,
        line::SPHERE => params.query == Volume::Sphere,
        line::FINEST_ONE | line::BEHIND_ONE => !by_faces,
        _ => true,
    }
}
