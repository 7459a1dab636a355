//! The pseudocode of this method, and where it differs from the papers.

use super::{Form, Params, Volume};
use crate::method::{CodeLine, Departure, When};

/// The pseudocode.
pub(super) const CODE: &[CodeLine] = &[
    // Section 3.3. Marks of shared primitives are those of Section 3.1.
    CodeLine::new("Frame:1", "Frame(visible list L)"),
    CodeLine::departing("Frame:2", "  clear the tiles", "clear the z-buffer and the z-pyramid"),
    CodeLine::new("Frame:3", "  for each cube C of L in view, front to back"),
    CodeLine::new("Frame:4", "    Draw(C)"),
    CodeLine::departing("Frame:5", "    keep C, to be drawn with the others", "Draw(C)"),
    CodeLine::new("Frame:6", "  Draw(those kept)"),
    CodeLine::new("Frame:7", "  Visit(root)"),
    CodeLine::new("Frame:8", "  Draw(those kept since)"),
    CodeLine::new("Frame:9", "  for each primitive p that several cubes share"),
    CodeLine::new("Frame:10", "    if none of them was drawn: p is hidden"),
    CodeLine::new("Frame:11", "  if a check of L is due"),
    CodeLine::new("Frame:12", "    for each cube C of L in view"),
    CodeLine::new("Frame:13", "      if Obscured(C)"),
    CodeLine::departing("Frame:14", "        remove C from L, with all below it", "remove C from L"),
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
    CodeLine::new("Draw:1", "Draw(cube C)"),
    CodeLine::departing(
        "Draw:2",
        "  draw what C holds and is not drawn yet into the tiles, many at a time",
        "rasterize the primitives of C that are not drawn yet, and update the pyramid at every resolution",
    ),
    CodeLine::new("Draw:3", "  for each primitive p of these"),
    CodeLine::new("Draw:4", "    if p faces away from the eye: next p"),
    CodeLine::departing(
        "Draw:5",
        "    if p begins behind every tile that it covers",
        "if p is behind its pyramid cells",
    ),
    CodeLine::new("Draw:6", "      skip p"),
    CodeLine::new("Draw:7", "    p may show: it is drawn into the image"),
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
    // Section 3.2: "descending to higher resolutions", on three of them.
    CodeLine::departing(
        "Obscured:8",
        "  for each block q of 32×16 pixels that B touches",
        "q := the finest cell that covers F on the screen",
    ),
    CodeLine::departing(
        "Obscured:9",
        "    if B begins behind q, wherever it is in q: next q",
        "if the nearest depth of F is behind q: next F",
    ),
    CodeLine::departing(
        "Obscured:10",
        "    if B covers q and begins before all in it: return false",
        "no such end",
    ),
    CodeLine::departing(
        "Obscured:11",
        "    for each tile r of 8×4 pixels of q that B touches",
        "for each cell r of the four below q that F touches",
    ),
    CodeLine::new("Obscured:12", "      if B begins behind r, wherever it is in r: next r"),
    CodeLine::departing("Obscured:13", "      if B covers r and shows in it: return false", "no such end"),
    CodeLine::departing("Obscured:14", "      keep r", "descend to r"),
    CodeLine::departing("Obscured:15", "  for each tile r that was kept", "down to the samples"),
    CodeLine::new("Obscured:16", "    if B shows at a pixel of r that nothing covers: return false"),
    CodeLine::departing("Obscured:17", "  for each tile r that was kept", "down to the samples"),
    CodeLine::departing("Obscured:18", "    if B lies behind a plane that covers r: next r", "no such test"),
    CodeLine::departing(
        "Obscured:19",
        "    work out the depths of r's pixels, unless they are known",
        "the z-buffer has them",
    ),
    CodeLine::new("Obscured:20", "    if B is not behind a pixel of r: return false"),
    CodeLine::new("Obscured:21", "  return true"),
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
    pub const VISIT_ROOT: u8 = line(CODE, "Frame:7");
    pub const DRAW_FOUND: u8 = line(CODE, "Frame:8");
    pub const EACH_SHARED: u8 = line(CODE, "Frame:9");
    pub const UNSEEN: u8 = line(CODE, "Frame:10");
    pub const CHECK: u8 = line(CODE, "Frame:11");
    pub const EACH_CHECKED: u8 = line(CODE, "Frame:12");
    pub const CHECK_OBSCURED: u8 = line(CODE, "Frame:13");
    pub const UNLIST: u8 = line(CODE, "Frame:14");
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
    pub const TILES: u8 = line(CODE, "Draw:2");
    pub const EACH: u8 = line(CODE, "Draw:3");
    pub const FACES_AWAY: u8 = line(CODE, "Draw:4");
    pub const TEST: u8 = line(CODE, "Draw:5");
    pub const SKIP: u8 = line(CODE, "Draw:6");
    pub const LIST: u8 = line(CODE, "Draw:7");
    pub const QUERY: u8 = line(CODE, "Obscured:1");
    pub const NEAR: u8 = line(CODE, "Obscured:2");
    pub const CROSSES: u8 = line(CODE, "Obscured:3");
    pub const NO_PIXEL: u8 = line(CODE, "Obscured:4");
    pub const BOX: u8 = line(CODE, "Obscured:5");
    pub const RECTANGLE: u8 = line(CODE, "Obscured:6");
    pub const SPHERE: u8 = line(CODE, "Obscured:7");
    pub const BLOCK: u8 = line(CODE, "Obscured:8");
    pub const BEHIND_BLOCK: u8 = line(CODE, "Obscured:9");
    pub const COVERS_BLOCK: u8 = line(CODE, "Obscured:10");
    pub const TILE: u8 = line(CODE, "Obscured:11");
    pub const BEHIND_TILE: u8 = line(CODE, "Obscured:12");
    pub const COVERS_TILE: u8 = line(CODE, "Obscured:13");
    pub const KEEP_TILE: u8 = line(CODE, "Obscured:14");
    pub const KEPT: u8 = line(CODE, "Obscured:15");
    pub const BARE: u8 = line(CODE, "Obscured:16");
    pub const KEPT_STILL: u8 = line(CODE, "Obscured:17");
    pub const PLANE: u8 = line(CODE, "Obscured:18");
    pub const RESOLVE: u8 = line(CODE, "Obscured:19");
    pub const PIXEL: u8 = line(CODE, "Obscured:20");
    pub const ALL_HIDDEN: u8 = line(CODE, "Obscured:21");
}

/// At which lines each kind of event stands.
pub(super) const STANDS: &[(&str, &[&str])] = &[
    ("NodeClassified", &["Visit:2"]),
    ("CubeListed", &["Frame:3", "Visit:4"]),
    (
        "ObscurationTested",
        &[
            "Obscured:3",
            "Obscured:4",
            "Obscured:10",
            "Obscured:13",
            "Obscured:16",
            "Obscured:20",
            "Obscured:21",
        ],
    ),
    ("CellRead", &["Obscured:9", "Obscured:12", "Obscured:16", "Obscured:18", "Obscured:20"]),
    ("TileRefreshed", &["Obscured:12", "Obscured:19", "Draw:5"]),
    ("CubeDrawn", &["Draw:2"]),
    ("OrientationTested", &["Draw:4"]),
    ("PrimitiveBehind", &["Draw:5"]),
    ("PrimitiveRasterized", &["Draw:7"]),
    ("SharedUnseen", &["Frame:10"]),
    ("ListChecked", &["Frame:11"]),
    ("CubeUnlisted", &["Frame:14"]),
    ("NodeDecided outside", &["Visit:3"]),
    ("NodeDecided hidden", &["Visit:6"]),
    ("NodeDecided partial", &["Visit:4", "Visit:5"]),
    ("PrimDecided faces-away", &["Draw:4"]),
    ("PrimDecided hidden", &["Draw:6", "Frame:10"]),
    ("PrimDecided visible", &["Draw:7"]),
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
        what: "the z-buffer and its pyramid are tiles: what is drawn sets bits in the masks of tiles of 8×4 \
               pixels, and bounds on their depths (Hasselgren, Andersson and Akenine-Möller 2016); of the \
               levels there are three: pixels, tiles, and blocks of 32×16",
        why: "many pixels are drawn and asked about at a time, in a sixteenth of the memory",
        when: When::Always,
    },
    Departure {
        section: "3.2",
        what: "depths of pixels are worked out only where tiles do not decide, from the primitives that were \
               drawn there, and are those of the image",
        why: "few tiles of an image are ever asked about so closely",
        when: When::Always,
    },
    Departure {
        section: "3.2",
        what: "the descent begins at the blocks under the box, not at the finest single cell that covers it",
        why: "what lies across a border of large cells would begin far up, and a row of blocks is compared \
              at a time",
        when: When::Always,
    },
    Departure {
        section: "3.2",
        what: "a block or a tile that the box covers, beginning before all that is drawn in it, ends the \
               descent",
        why: "some pixel of it shows the box",
        when: When::Always,
    },
    Departure {
        section: "3.2",
        what: "what a block holds is brought up to date where it is read, not where it is drawn",
        why: "most of it is not read before it is drawn into again",
        when: When::Always,
    },
    Departure {
        section: "3.2 (Greene, Kass and Miller)",
        what: "a primitive is compared with the tiles that it covers, and no pixel, as it is drawn into them",
        why: "that costs nothing beside drawing, and tells which primitives the image needs",
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
    let (two_pass, tested) = (params.form == Form::TwoPass, params.primitive_test);
    let is_one_cube = params.cubes.tree_levels == 1;
    match at {
        line::EACH_LISTED | line::UNLISTED | line::ADD => params.coherence,
        line::CHECK | line::EACH_CHECKED | line::CHECK_OBSCURED | line::UNLIST => params.coherence,
        line::DRAW_LISTED => params.coherence && !two_pass,
        line::KEEP_LISTED | line::DRAW_KEPT => params.coherence && two_pass,
        line::DRAW_FOUND | line::KEEP => two_pass,
        line::DRAW => !two_pass,
        line::EACH_SHARED | line::UNSEEN => params.cubes.may_share(),
        line::CHILD => !is_one_cube,
        line::FACES_AWAY => params.surfaces.one_sided,
        line::TEST | line::SKIP => tested,
        // Of one cube nothing is drawn before it is asked for, so nothing hides it.
        line::KEEP_TILE | line::KEPT | line::BARE | line::KEPT_STILL => !is_one_cube,
        line::PLANE | line::RESOLVE | line::PIXEL | line::ALL_HIDDEN => !is_one_cube,
        line::BOX => params.query == Volume::Planes,
        line::RECTANGLE => params.query == Volume::Rectangles,
        line::SPHERE => params.query == Volume::Sphere,
        _ => true,
    }
}
