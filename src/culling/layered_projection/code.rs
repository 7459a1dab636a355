//! The pseudocode: which lines belong to which parameters, what stands at them, and where they are not the
//! paper's. A line that departs from the paper's has its number with a prime.

use super::Params;
use super::rules::{Entering, Occupancy, Penalizing, Transfer, Update};
use crate::method::{Budget, CodeLine, Departure, When};

// Figures 4 and 5; Seed and Project are Sections 4.1 and 4.2, Queries and Quality Section 6.
pub(super) const CODE: &[CodeLine] = &[
    CodeLine::new("Seed:1", "put the cell that holds the eye, or else the closest one, into F"),
    CodeLine::departing(
        "Seed:1′",
        "put the cell that holds the eye, or else the nearest in view that holds something, into F",
        "the cell that holds the eye, or else the closest one",
    ),
    CodeLine::new(
        "Seed:2",
        "for each further seed: put the first cell on its ray that holds something into F",
    ),
    CodeLine::new("RenderingLoop:1", "while the front F is not empty"),
    CodeLine::new("RenderingLoop:2", "  c := the cell of least solidity of F"),
    CodeLine::new("Queries:1", "  if the budget was spent and the z-buffer hides c"),
    CodeLine::new("Queries:2", "    leave c out"),
    CodeLine::new("RenderingLoop:3", "  project c"),
    CodeLine::new("RenderingLoop:4", "  if the budget is spent"),
    CodeLine::new("Quality:1", "    let it grow if the rest can change too many pixels"),
    CodeLine::new("Queries:3", "    ask the z-buffer from here on"),
    CodeLine::new("RenderingLoop:5", "    break"),
    CodeLine::new("RenderingLoop:6", "  for each cell n adjacent to c"),
    CodeLine::new("RenderingLoop:7", "    if n is projected"),
    CodeLine::departing("RenderingLoop:7′", "    if n is projected or out of view", "if n is projected"),
    CodeLine::new("RenderingLoop:8", "      continue"),
    CodeLine::new("RenderingLoop:9", "    ρ := UpdateSolidity(n, c)"),
    CodeLine::new("RenderingLoop:10", "    enqueue n with ρ"),
    CodeLine::departing(
        "RenderingLoop:10′",
        "    enqueue n with ρ, unless it has what came from the eye's side, or less",
        "enqueue n with ρ",
    ),
    CodeLine::departing("Again:1", "if a cell in view was not reached: go on with the nearest", "end"),
    CodeLine::new("Queries:4", "for each p of several cells that none of them drew"),
    CodeLine::new("Queries:5", "  draw p if it is in view and the z-buffer does not hide it"),
    CodeLine::new("End:1", "leave out what was not reached"),
    CodeLine::new("Project:1", "project(c): if c lies outside the view: return"),
    CodeLine::new("Project:2", "  for each p of c that was not drawn"),
    CodeLine::new("Project:3", "    if p lies outside the view: skip p"),
    CodeLine::new("Project:4", "    if p faces away from the eye: skip p"),
    CodeLine::new("Project:5", "    draw p, if budget is left"),
    CodeLine::new("UpdateSolidity:0", "|A| := what of A faces the eye, each by its cosine"),
    CodeLine::new("UpdateSolidity:1", "ρ(B) := |A| / ρ_max + (v · n(B)) ρ(A)"),
    CodeLine::departing(
        "UpdateSolidity:1′",
        "ρ(B) := |A| / ρ_max + ρ(A)",
        "ρ(B) := |A| / ρ_max + (v · n(B)) ρ(A)",
    ),
    CodeLine::new("UpdateSolidity:2", "if B is not star-shaped toward the eye"),
    CodeLine::new("UpdateSolidity:3", "  ρ(B) := penalty factor × ρ(B)"),
    CodeLine::departing("UpdateSolidity:3′", "  ρ(B) := ρ(B) + penalty", "ρ(B) := penalty factor × ρ(B)"),
    CodeLine::new("UpdateSolidity:4", "return ρ(B)"),
];

/// Lines by name.
pub(super) mod line {
    use super::CODE;
    use crate::method::line;
    pub const SEED: [u8; 2] = [line(CODE, "Seed:1"), line(CODE, "Seed:1′")];
    pub const SEEDS: u8 = line(CODE, "Seed:2");
    pub const WHILE: u8 = line(CODE, "RenderingLoop:1");
    pub const TAKE: u8 = line(CODE, "RenderingLoop:2");
    pub const ASK: u8 = line(CODE, "Queries:1");
    pub const LEAVE: u8 = line(CODE, "Queries:2");
    pub const PROJECT: u8 = line(CODE, "RenderingLoop:3");
    pub const IF_SPENT: u8 = line(CODE, "RenderingLoop:4");
    pub const GROW: u8 = line(CODE, "Quality:1");
    pub const ASK_ON: u8 = line(CODE, "Queries:3");
    pub const BREAK: u8 = line(CODE, "RenderingLoop:5");
    pub const EACH: u8 = line(CODE, "RenderingLoop:6");
    pub const IF_DONE: [u8; 2] = [line(CODE, "RenderingLoop:7"), line(CODE, "RenderingLoop:7′")];
    pub const CONTINUE: u8 = line(CODE, "RenderingLoop:8");
    pub const UPDATE: u8 = line(CODE, "RenderingLoop:9");
    pub const ENQUEUE: [u8; 2] = [line(CODE, "RenderingLoop:10"), line(CODE, "RenderingLoop:10′")];
    pub const AGAIN: u8 = line(CODE, "Again:1");
    pub const SHARED: u8 = line(CODE, "Queries:4");
    pub const COMPARE: u8 = line(CODE, "Queries:5");
    pub const END: u8 = line(CODE, "End:1");
    pub const IN_VIEW: u8 = line(CODE, "Project:1");
    pub const PRIMS: u8 = line(CODE, "Project:2");
    pub const OUTSIDE: u8 = line(CODE, "Project:3");
    pub const FACING: u8 = line(CODE, "Project:4");
    pub const DRAW: u8 = line(CODE, "Project:5");
    pub const COUNT: u8 = line(CODE, "UpdateSolidity:0");
    pub const SUM: [u8; 2] = [line(CODE, "UpdateSolidity:1"), line(CODE, "UpdateSolidity:1′")];
    pub const IF_STAR: u8 = line(CODE, "UpdateSolidity:2");
    pub const PENALTY: [u8; 2] = [line(CODE, "UpdateSolidity:3"), line(CODE, "UpdateSolidity:3′")];
    pub const RETURN: u8 = line(CODE, "UpdateSolidity:4");
}

/// The line that runs, of the paper's and ours.
pub(super) fn either([papers, ours]: [u8; 2], is_papers: bool) -> u8 {
    if is_papers { papers } else { ours }
}

/// Whether a line belongs to these parameters.
pub(super) fn has_line(params: &Params, line: u8) -> bool {
    let how = &params.how;
    let everywhere = how.front == Entering::Everywhere;
    // One of a pair: the paper's line or ours.
    let pairs = [
        (line::SEED, everywhere),
        (line::IF_DONE, everywhere),
        (line::ENQUEUE, how.update == Update::Latest),
        (line::SUM, how.transfer == Transfer::Aligned),
        (line::PENALTY, how.penalizing == Penalizing::Factor),
    ];
    if pairs.iter().any(|(pair, is_papers)| pair.contains(&line) && either(*pair, *is_papers) != line) {
        return false;
    }
    // With nothing to spend it ends with the first cell.
    let goes_on = !matches!(params.budget, Budget::Count(0) | Budget::Percent(0.0))
        || params.queries
        || params.quality > 0;
    match line {
        line::SEEDS => params.seeds > 1,
        line::ASK | line::LEAVE | line::ASK_ON | line::SHARED | line::COMPARE => params.queries,
        line::GROW => params.quality > 0 && !params.queries,
        // Queries take its place, but for a time that ends them too.
        line::BREAK => !params.queries || matches!(params.budget, Budget::Milliseconds(_)),
        line::AGAIN => !everywhere && goes_on,
        line::FACING => params.surfaces.one_sided,
        line::COUNT => params.occupancy == Occupancy::FrontFacing && goes_on,
        line::EACH | line::CONTINUE | line::UPDATE | line::IF_STAR | line::RETURN => goes_on,
        _ if [line::IF_DONE, line::ENQUEUE, line::SUM, line::PENALTY].iter().any(|l| l.contains(&line)) => {
            goes_on
        }
        _ => true,
    }
}

/// What stands at which lines.
pub(super) const STANDS: &[(&str, &[&str])] = &[
    ("CellSeeded", &["Seed:1", "Seed:1′", "Seed:2", "Again:1"]),
    (
        "NodeClassified",
        &["Seed:1", "Seed:1′", "Seed:2", "RenderingLoop:7′", "Again:1", "Project:1", "Quality:1", "End:1"],
    ),
    ("NodeDecided outside", &["Seed:1′", "RenderingLoop:7′", "Again:1", "Project:1", "Quality:1", "End:1"]),
    ("CellAsked", &["Queries:1"]),
    ("NodeDecided hidden", &["Queries:2"]),
    ("CellProjected", &["Project:1", "Project:5"]),
    ("NodeDecided visible", &["Project:5"]),
    ("NodeDecided partial", &["Project:5", "End:1"]),
    ("PrimClassified", &["Project:3", "Queries:5", "End:1"]),
    ("PrimDecided outside", &["Project:3", "Queries:5", "End:1"]),
    ("OrientationTested", &["Project:4", "Queries:5", "End:1"]),
    ("PrimDecided faces-away", &["Project:4", "Queries:5", "End:1"]),
    ("PrimDrawn", &["Project:5", "Quality:1"]),
    ("PrimDecided visible", &["Project:5", "Quality:1", "Queries:5"]),
    ("SolidityTransferred", &["UpdateSolidity:4"]),
    ("DoubtBounded", &["Quality:1"]),
    ("BudgetSpent", &["RenderingLoop:5"]),
    ("PrimCompared", &["Queries:5"]),
    ("PrimDecided hidden", &["Queries:5", "End:1"]),
    ("TraversalEnded", &["End:1"]),
    ("CellLeftOut", &["End:1"]),
    ("NodeDecided over-budget", &["End:1"]),
    ("PrimLeftOut", &["End:1"]),
    ("PrimDecided over-budget", &["End:1"]),
    ("PrimUnreached", &["End:1"]),
];

const fn departure(section: &'static str, what: &'static str, why: &'static str, when: When) -> Departure {
    Departure { section, what, why, when }
}

/// Where the method is not the paper's.
pub(super) const DEPARTURES: &[Departure] = &[
    departure(
        "3.2",
        "all of a cell's solidity is handed on in place of its part v · n, but with transfer=aligned or \
         rules=paper",
        "through the oblique faces of tetrahedra that part shrinks from cell to cell",
        When::Without("transfer", "aligned"),
    ),
    departure(
        "3.2",
        "v is the direction from the eye to the center of the cell, but with view-direction=frame or \
         rules=paper",
        "one direction for the whole frame says nothing near the rim of a wide view",
        When::Without("view-direction", "frame"),
    ),
    departure(
        "3.2",
        "the penalty is added, not multiplied, but with penalty-as=factor or rules=paper",
        "multiplying keeps empty space at solidity 0, so the front would flow around occluders at no cost",
        When::Without("penalty-as", "factor"),
    ),
    departure(
        "3.2",
        "the penalty factor is 2, with rules=paper too",
        "the paper gives none",
        When::With("penalty", "100"),
    ),
    departure(
        "3.2",
        "a cell keeps the solidity that came through the face toward the eye, or else the least, but with \
         update=latest or rules=paper the latest",
        "only that value is about what is in front of the cell; others are detours",
        When::Without("update", "latest"),
    ),
    departure(
        "4.2",
        "the front grows over cells in view only, but with front=everywhere or rules=paper",
        "nothing of the others is drawn, and what is in view beyond them is reached by other ways",
        When::Without("front", "everywhere"),
    ),
    departure(
        "4.2",
        "where the eye is outside of all cells, the front begins at the cell in view that holds something \
         and whose box is nearest, but with front=everywhere or rules=paper at the closest one",
        "from a cell out of view the front would not grow",
        When::Without("front", "everywhere"),
    ),
    departure(
        "4.2",
        "where the front runs dry before the budget does, a new one begins, but with front=everywhere or \
         rules=paper",
        "so with an unlimited budget nothing in view is missed",
        When::Without("front", "everywhere"),
    ),
    departure(
        "4.2",
        "in a cell that the border of the view cuts, primitives are tested one by one",
        "the paper culls by the view frustum without saying at what",
        When::Always,
    ),
    departure(
        "4.3",
        "the corners of the region are triangulated with the centers of the leaves",
        "cells then cover the whole scene, not only the convex hull of the centers",
        When::With("tessellation", "delaunay"),
    ),
    departure(
        "4.3",
        "neighbors are found by descending both sides of every dividing plane together",
        "this gives all pairs, across levels of any difference",
        When::Without("tessellation", "delaunay"),
    ),
    departure(
        "5",
        "back faces are culled with backface-culling=true only, with rules=paper too",
        "whether faces have one side is for the scene to say",
        When::Without("backface-culling", "true"),
    ),
    departure(
        "6",
        "what the budget leaves is compared with tiles of coverage masks and depths (Hasselgren, Andersson \
         and Akenine-Möller 2016), a cell by the planes of its box, and with exact depths where these do \
         not decide",
        "the paper asks the hardware's z-buffer",
        When::With("queries", "true"),
    ),
];
