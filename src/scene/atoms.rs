//! Molecules as balls: what is known of each element, and the mesh of one ball an atom.
//!
//! A ball is `n` cells around and has `n + 1` rows, so 2 n² triangles: 800 at the finest, as the spheres of
//! the molecule of Chamberlain et al. (1996, Section 5). Each atom is an object of its own.

use std::collections::BTreeMap;

use glam::DVec3;

use super::assemble::assemble;
use super::circle::circle;
use super::mesh::Mesh;
use super::report::counted;
use super::{LoadOptions, Material, Object, Part, Parts, Progress, Report, SceneError};
use crate::geometry::Solid;

/// A chemical element by its atomic number; 0 is one that is not known.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Element(pub(super) u8);

/// Symbols by atomic number, from 1.
const SYMBOLS: [&str; 118] = [
    "H", "He", "Li", "Be", "B", "C", "N", "O", "F", "Ne", "Na", "Mg", "Al", "Si", "P", "S", "Cl", "Ar", "K",
    "Ca", "Sc", "Ti", "V", "Cr", "Mn", "Fe", "Co", "Ni", "Cu", "Zn", "Ga", "Ge", "As", "Se", "Br", "Kr",
    "Rb", "Sr", "Y", "Zr", "Nb", "Mo", "Tc", "Ru", "Rh", "Pd", "Ag", "Cd", "In", "Sn", "Sb", "Te", "I", "Xe",
    "Cs", "Ba", "La", "Ce", "Pr", "Nd", "Pm", "Sm", "Eu", "Gd", "Tb", "Dy", "Ho", "Er", "Tm", "Yb", "Lu",
    "Hf", "Ta", "W", "Re", "Os", "Ir", "Pt", "Au", "Hg", "Tl", "Pb", "Bi", "Po", "At", "Rn", "Fr", "Ra",
    "Ac", "Th", "Pa", "U", "Np", "Pu", "Am", "Cm", "Bk", "Cf", "Es", "Fm", "Md", "No", "Lr", "Rf", "Db",
    "Sg", "Bh", "Hs", "Mt", "Ds", "Rg", "Cn", "Nh", "Fl", "Mc", "Lv", "Ts", "Og",
];

/// Van der Waals radii by atomic number, from 1, Å; 0 where none is listed. Bondi, "van der Waals Volumes
/// and Radii", J. Phys. Chem. 68, 441 (1964), and for main-group elements that it lacks Mantina et al., J.
/// Phys. Chem. A 113, 5806 (2009).
const RADII: [f64; 118] = [
    1.20, 1.40, 1.82, 1.53, 1.92, 1.70, 1.55, 1.52, 1.47, 1.54, 2.27, 1.73, 1.84, 2.10, 1.80, 1.80, 1.75,
    1.88, 2.75, 2.31, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.63, 1.40, 1.39, 1.87, 2.11, 1.85, 1.90, 1.85,
    2.02, 3.03, 2.49, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.63, 1.72, 1.58, 1.93, 2.17, 2.06, 2.06, 1.98,
    2.16, 3.43, 2.68, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0,
    0.0, 0.0, 0.0, 0.0, 1.75, 1.66, 1.55, 1.96, 2.02, 2.07, 1.97, 2.02, 2.20, 3.48, 2.83, 0.0, 0.0, 0.0,
    1.86, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0,
    0.0, 0.0, 0.0, 0.0, 0.0, 0.0,
];
/// Radius of an element that neither lists, Å.
const OTHER_RADIUS: f64 = 2.0;

/// Linear colors, after the space-filling models of Corey, Pauling and Koltun.
const COLORS: &[(&str, [f32; 3])] = &[
    ("H", [0.80, 0.80, 0.80]),
    ("C", [0.17, 0.17, 0.17]),
    ("N", [0.07, 0.14, 0.72]),
    ("O", [0.70, 0.05, 0.03]),
    ("F", [0.22, 0.62, 0.16]),
    ("Na", [0.30, 0.10, 0.62]),
    ("Mg", [0.05, 0.35, 0.10]),
    ("P", [0.80, 0.28, 0.02]),
    ("S", [0.75, 0.60, 0.06]),
    ("Cl", [0.06, 0.55, 0.06]),
    ("K", [0.28, 0.07, 0.45]),
    ("Ca", [0.12, 0.40, 0.05]),
    ("Fe", [0.55, 0.17, 0.04]),
    ("Cu", [0.55, 0.22, 0.08]),
    ("Zn", [0.25, 0.25, 0.42]),
    ("Se", [0.70, 0.36, 0.02]),
    ("Br", [0.30, 0.03, 0.02]),
    ("I", [0.22, 0.02, 0.34]),
];
const OTHER_COLOR: [f32; 3] = [0.62, 0.22, 0.42];

impl Element {
    /// The element of a symbol, in letters of either size; deuterium is hydrogen.
    pub(super) fn of(symbol: &[u8]) -> Option<Self> {
        if symbol.eq_ignore_ascii_case(b"D") {
            return Some(Self(1));
        }
        let at = SYMBOLS.iter().position(|s| s.as_bytes().eq_ignore_ascii_case(symbol))?;
        Some(Self(at as u8 + 1))
    }
    /// Its symbol; `?` if it is not known.
    pub(super) fn symbol(self) -> &'static str {
        usize::from(self.0).checked_sub(1).and_then(|at| SYMBOLS.get(at)).copied().unwrap_or("?")
    }
    /// Radius of its ball, Å; [`OTHER_RADIUS`] where none is known.
    fn radius(self) -> f64 {
        self.listed().unwrap_or(OTHER_RADIUS)
    }
    fn listed(self) -> Option<f64> {
        let at = usize::from(self.0).checked_sub(1)?;
        RADII.get(at).copied().filter(|r| *r > 0.0)
    }
    fn material(self) -> Material {
        let color = COLORS.iter().find(|c| c.0 == self.symbol()).map_or(OTHER_COLOR, |c| c.1);
        Material::new(if self.0 == 0 { "unknown" } else { self.symbol() }, color)
    }
}

/// An atom: an object that is a ball.
#[derive(Clone, Debug)]
pub(super) struct Atom {
    pub(super) element: Element,
    /// Å.
    pub(super) place: DVec3,
    pub(super) object: Object,
}

/// Cells around the finest ball: 800 triangles.
pub(super) const FINEST: u32 = 20;
/// Cells around the coarsest: 32 triangles.
const COARSEST: u32 = 4;

/// Triangles of a ball of `around` cells.
fn ball_triangles(around: u32) -> usize {
    2 * around as usize * around as usize
}

/// Cells around each of so many balls, at most [`FINEST`], of no more than `most` triangles together; `None`
/// if the coarsest have more.
fn cells_within(atoms: usize, most: usize) -> Option<u32> {
    (COARSEST..=FINEST).rev().find(|around| atoms.saturating_mul(ball_triangles(*around)) <= most)
}

/// Most atoms of a file.
pub(super) const MOST_ATOMS: usize = 1 << 20;
/// Most triangles of all balls of a file: some 2 GB of tables. All [`MOST_ATOMS`] have the coarsest balls.
const MOST_TRIANGLES: usize = 1 << 25;

/// What a file with more than [`MOST_ATOMS`] is told.
pub(super) fn too_many(source: &str, line: usize) -> SceneError {
    let why = format!("there are more than {MOST_ATOMS} atoms; write fewer of them to a file of their own");
    SceneError::Syntax { path: source.to_owned(), line, why }
}

/// The scene of a file's atoms: balls as fine as the limit of triangles allows. `unknown` counts the elements
/// that are not known, as the file writes them. `name` and `source` as in [`Parts`].
pub(super) fn scene(
    atoms: Vec<Atom>,
    unknown: &BTreeMap<String, usize>,
    (name, source): (&str, &str),
    options: &LoadOptions,
    mut report: Report,
    progress: &dyn Progress,
) -> Result<Parts<Solid>, SceneError> {
    let Some(around) = cells_within(atoms.len(), MOST_TRIANGLES) else { return Err(too_many(source, 1)) };
    let mut counts: BTreeMap<Element, usize> = BTreeMap::new();
    atoms.iter().for_each(|a| *counts.entry(a.element).or_default() += 1);
    let listed = |of: &dyn Fn(Element) -> bool| {
        let kept = counts.iter().filter(|(element, _)| of(**element));
        kept.map(|(element, count)| format!("{} {count}", element.symbol())).collect::<Vec<_>>().join(", ")
    };
    let all = listed(&|_| true);
    report.note(format!(
        "{}: {all}; each a ball of {} triangles",
        counted(atoms.len(), "atom"),
        ball_triangles(around)
    ));
    if around < FINEST {
        report.note(format!(
            "balls have fewer than {} triangles, since all together may have {MOST_TRIANGLES}",
            ball_triangles(FINEST)
        ));
    }
    let bare = listed(&|e| e.0 > 0 && e.listed().is_none());
    if !bare.is_empty() {
        report.note(format!(
            "no van der Waals radius is known here for {bare}: their balls have {OTHER_RADIUS} Å"
        ));
    }
    if !unknown.is_empty() {
        let words = unknown.iter().take(8).map(|(word, count)| format!("`{word}` {count}"));
        let words = words.collect::<Vec<_>>().join(", ");
        report.note(format!("unknown elements: {words}; their balls have a radius of {OTHER_RADIUS} Å"));
    }
    progress.report(0.5, "making balls");
    let rest = Part { whole: progress, start: 0.6, length: 0.4 };
    assemble(mesh(atoms, around), name, source, options, report, &rest)
}

/// A ball of radius 1 around the origin: points, and triangles that look outward.
fn unit_ball(around: u32) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let rows = around + 1;
    let mut points = vec![DVec3::Y];
    for i in 1..rows {
        let (up, out) = circle(i, 2 * rows);
        points.extend((0..around).map(|k| circle(k, around)).map(|(c, s)| DVec3::new(out * c, up, out * s)));
    }
    points.push(-DVec3::Y);
    let last = points.len() as u32 - 1;
    let at = |row: u32, k: u32| match row {
        0 => 0,
        _ if row == rows => last,
        _ => 1 + (row - 1) * around + k % around,
    };
    let mut triangles = Vec::with_capacity(ball_triangles(around));
    for row in 0..rows {
        for k in 0..around {
            let [a, b, c, d] = [at(row, k), at(row, k + 1), at(row + 1, k + 1), at(row + 1, k)];
            // At the poles two of the four are one.
            triangles.extend((row + 1 < rows).then_some([a, c, d]));
            triangles.extend((row > 0).then_some([a, b, c]));
        }
    }
    (points, triangles)
}

/// The balls of atoms, `around` cells each; a material for each element that occurs, by atomic number.
pub(super) fn mesh(atoms: Vec<Atom>, around: u32) -> Mesh {
    let (points, triangles) = unit_ball(around);
    let mut materials: BTreeMap<Element, u32> = atoms.iter().map(|a| (a.element, 0)).collect();
    materials.values_mut().enumerate().for_each(|(at, material)| *material = at as u32);
    let mut mesh = Mesh { materials: materials.keys().map(|e| e.material()).collect(), ..Mesh::default() };
    mesh.points.reserve(points.len() * atoms.len());
    mesh.corners.reserve(3 * triangles.len() * atoms.len());
    mesh.faces.reserve(triangles.len() * atoms.len());
    for (number, atom) in atoms.into_iter().enumerate() {
        let first = mesh.points.len() as u32;
        let radius = atom.element.radius();
        mesh.points.extend(points.iter().map(|p| atom.place + *p * radius));
        for triangle in &triangles {
            mesh.push(&triangle.map(|c| first + c), number as u32, materials[&atom.element]);
        }
        mesh.objects.push(atom.object);
    }
    mesh
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ball_has_800_triangles_that_look_outward() {
        let (points, triangles) = unit_ball(FINEST);
        // 20 rows of points between the poles.
        assert_eq!((points.len(), triangles.len()), (2 + 20 * 20, 800));
        let volume: f64 = triangles
            .iter()
            .map(|t| t.map(|c| points[c as usize]))
            .map(|[a, b, c]| a.dot(b.cross(c)) / 6.0)
            .sum();
        let whole = 4.0 / 3.0 * std::f64::consts::PI;
        assert!(volume < whole && volume > 0.97 * whole, "{volume} of {whole}");
        for t in triangles {
            let [a, b, c] = t.map(|c| points[c as usize]);
            assert!((b - a).cross(c - a).dot(a + b + c) > 0.0, "{t:?}");
        }
    }

    #[test]
    fn balls_become_coarser_where_there_are_many() {
        // 10 atoms: 8,000 triangles of 800; with one fewer, 19 cells around: 722 each.
        assert_eq!(cells_within(10, 8_000), Some(20));
        assert_eq!(cells_within(10, 7_999), Some(19));
        assert_eq!(cells_within(10, 320), Some(4));
        assert_eq!(cells_within(10, 319), None);
        assert_eq!(cells_within(usize::MAX, 1 << 25), None);
    }

    #[test]
    fn elements_are_found_by_their_symbols() {
        assert_eq!(Element::of(b"ca").map(|e| e.0), Some(20));
        assert_eq!(Element::of(b"Og").map(|e| e.0), Some(118));
        assert_eq!(Element::of(b"D"), Some(Element(1)));
        assert_eq!((Element::of(b"X"), Element::of(b"")), (None, None));
        let carbon = Element(6);
        assert_eq!((carbon.symbol(), carbon.radius()), ("C", 1.70));
        assert_eq!((Element(0).symbol(), Element(0).radius(), Element(26).radius()), ("?", 2.0, 2.0));
        assert_eq!(Element::of(b"U").map(Element::radius), Some(1.86));
        assert_eq!(COLORS.iter().find(|c| !SYMBOLS.contains(&c.0)), None);
    }
}
