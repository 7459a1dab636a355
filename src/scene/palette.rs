//! Colors at points as materials: each face has the mean color of its corners, in a bounded palette.
//!
//! A primitive has one material, so a color that runs across it cannot be kept; its mean can. Colors that are
//! few (of 8 bits a channel) stay as they are. If they are many, each channel has up to [`LEVELS`] levels,
//! and a material the mean color of its faces. Cost: O(n log m) for n faces and m materials.

use std::collections::BTreeMap;

use super::mesh::Mesh;
use super::mtl::GRAY;
use super::report::counted;
use super::{Material, Report};

/// Colors that stay as they are.
const EXACT: usize = 256;
/// Levels of a channel where there are more.
const LEVELS: u32 = 6;
/// About how many materials come of colors at most; with many materials there are fewer levels.
const MOST: usize = 1024;

/// The faces of one color and one material.
#[derive(Default)]
struct Pot {
    sum: [f64; 3],
    faces: u32,
    material: u32,
}

/// Gives each face whose corners all have a color a material of its own color, times the material's (a
/// material without a color of its own, [`GRAY`], counts as white). What lets light through stays.
pub(super) fn paint(mesh: &mut Mesh, report: &mut Report) {
    let mut means: Vec<(u32, [f32; 3])> = Vec::new();
    for (k, corners) in mesh.rings().enumerate() {
        let mut sum = [0.0f32; 3];
        for &corner in corners {
            let color = mesh.colors.get(corner as usize).copied().unwrap_or(Mesh::NO_COLOR);
            sum = std::array::from_fn(|c| sum[c] + color[c]);
        }
        if !corners.is_empty() && sum.iter().all(|c| c.is_finite()) {
            means.push((k as u32, sum.map(|c| (c / corners.len() as f32).clamp(0.0, 1.0))));
        }
    }
    mesh.colors = Vec::new();
    if means.is_empty() {
        return;
    }
    let mut levels = 256;
    if distinct(mesh, &means, levels) > EXACT {
        let used = distinct(mesh, &means, 1);
        levels = (1..=LEVELS).rev().find(|l| used * l.pow(3) as usize <= MOST).unwrap_or(1);
    }
    let mut pots: BTreeMap<(u32, u32), Pot> = BTreeMap::new();
    for (face, color) in &means {
        let pot = pots.entry((mesh.faces[*face as usize].material, bucket(*color, levels))).or_default();
        pot.sum = std::array::from_fn(|c| pot.sum[c] + f64::from(color[c]));
        pot.faces += 1;
    }
    for ((material, _), pot) in &mut pots {
        pot.material = mesh.materials.len() as u32;
        let base = mesh.materials[*material as usize].clone();
        let tint = if base.color == GRAY { [1.0; 3] } else { base.color };
        let color = [0, 1, 2].map(|c| (pot.sum[c] / f64::from(pot.faces)) as f32 * tint[c]);
        let [r, g, b] = color.map(|c| (c * 255.0).round() as u8);
        let name = format!("{} #{r:02x}{g:02x}{b:02x}", base.name);
        mesh.materials.push(Material { name, color, ..base });
    }
    for (face, color) in &means {
        let face = &mut mesh.faces[*face as usize];
        if let Some(pot) = pots.get(&(face.material, bucket(*color, levels))) {
            face.material = pot.material;
        }
    }
    report.note(format!(
        "colors at points: the mean of the corners for {}, in {}",
        counted(means.len(), "face"),
        counted(pots.len(), "material")
    ));
}

/// Where a color falls if each channel has so many levels.
fn bucket(color: [f32; 3], levels: u32) -> u32 {
    color.iter().fold(0, |n, c| n * levels + ((c * levels as f32) as u32).min(levels - 1))
}

/// How many pairs of a material and a color there are; counted up to one more than [`EXACT`].
fn distinct(mesh: &Mesh, means: &[(u32, [f32; 3])], levels: u32) -> usize {
    let mut seen = std::collections::BTreeSet::new();
    for (face, color) in means {
        seen.insert((mesh.faces[*face as usize].material, bucket(*color, levels)));
        if levels > 1 && seen.len() > EXACT {
            break;
        }
    }
    seen.len()
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;

    /// A row of triangles, each of one color of `colors`.
    fn painted(colors: &[[f32; 3]], base: Material) -> (Mesh, Report) {
        let mut mesh = Mesh { materials: vec![base], ..Mesh::default() };
        for (k, color) in colors.iter().enumerate() {
            let x = k as f64;
            let corners = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)];
            mesh.points.extend(corners.map(|(u, v)| DVec3::new(x + u, v, 0.0)));
            mesh.colors.extend([*color; 3]);
            let first = 3 * k as u32;
            mesh.push(&[first, first + 1, first + 2], 0, 0);
        }
        let mut report = Report::default();
        paint(&mut mesh, &mut report);
        (mesh, report)
    }

    #[test]
    fn few_colors_stay_and_tint_their_material() {
        let red = [1.0, 0.0, 0.0];
        let (mesh, report) = painted(&[red, [0.5, 0.25, 1.0], red], Material::new("default", GRAY));
        let of = |k: usize| mesh.materials[mesh.faces[k].material as usize].color;
        assert_eq!((of(0), of(1), of(2), mesh.materials.len()), (red, [0.5, 0.25, 1.0], red, 3));
        assert_eq!(report.notes, ["colors at points: the mean of the corners for 3 faces, in 2 materials"]);
        let glass = Material { see_through: true, ..Material::new("glass", [0.5, 1.0, 1.0]) };
        let (mesh, _) = painted(&[red], glass);
        let tinted = &mesh.materials[mesh.faces[0].material as usize];
        assert_eq!((tinted.color, tinted.see_through), ([0.5, 0.0, 0.0], true));
        let (mesh, report) = painted(&[Mesh::NO_COLOR], Material::new("default", GRAY));
        assert_eq!((mesh.materials.len(), report.notes.len()), (1, 0));
    }

    #[test]
    fn many_colors_are_bounded_and_near() {
        let step = |k: u32| (k % 20) as f32 / 19.0;
        let colors: Vec<[f32; 3]> = (0..8000).map(|k| [step(k), step(k / 20), step(k / 400)]).collect();
        let (mesh, _) = painted(&colors, Material::new("default", GRAY));
        assert!(mesh.materials.len() <= 217, "{} materials", mesh.materials.len());
        for (face, color) in mesh.faces.iter().zip(&colors) {
            let got = mesh.materials[face.material as usize].color;
            assert!((0..3).all(|c| (got[c] - color[c]).abs() < 1.0 / 6.0), "{got:?} for {color:?}");
        }
    }
}
