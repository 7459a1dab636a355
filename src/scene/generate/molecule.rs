//! `generate:molecule`: a protein-like molecule of one ball an atom.
//!
//! For Chamberlain et al. (1996, Plate 2): 6,534 atoms of 800 triangles, each an object. A chain runs to and
//! fro through each of up to three domains, in helices (Arnott and Dover 1967: 1.5 Å and 100° a residue) and
//! pairs of strands (3.3 Å), with side chains that point outward. It is no real fold, but has a real one's
//! density, size and mix of elements. Cost: O(polygons).

use glam::DVec3;
use rand_pcg::Pcg32;
use rand_pcg::rand_core::Rng;

use super::lathe::across;
use super::plan::signed;
use super::shapes::circle;
use super::tree::direction;
use super::walk::around;
use super::{Generator, GeneratorParam, LoadOptions, Part, Parts, Progress, SceneError, Values};
use crate::geometry::Solid;
use crate::scene::assemble::assemble;
use crate::scene::atoms::{Atom, Element, FINEST, mesh};
use crate::scene::{Object, Report};

pub(super) const GENERATOR: Generator = Generator {
    name: "molecule",
    meaning: "a protein-like molecule, a ball of 800 triangles an atom; after Chamberlain et al. 1996, \
              Plate 2",
    params: &[
        GeneratorParam {
            name: "atoms",
            default: 6_534,
            min: 1,
            max: 40_000,
            meaning: "balls of 800 triangles, each an object",
        },
        GeneratorParam {
            name: "seed",
            default: 1,
            min: 0,
            max: u32::MAX as u64,
            meaning: "chooses how the chain folds",
        },
    ],
    make,
};

/// Side chains of the twenty residues, from the main chain outward.
const SIDE_CHAINS: [&str; 20] = [
    "",
    "C",
    "CO",
    "CS",
    "CCC",
    "CCO",
    "CCC",
    "CCCC",
    "CCOO",
    "CCCC",
    "CCNO",
    "CCSC",
    "CCCOO",
    "CCCNO",
    "CCCCN",
    "CCNCCN",
    "CCCCCCC",
    "CCCNCNN",
    "CCCCCCCO",
    "CCCCNCCCCC",
];
/// Distance of the middle lines of neighboring helices, Å: a residue then takes 130 Å³, as in proteins.
const SPACING: f64 = 9.8;
/// Length of a bond, Å.
const BOND: f64 = 1.52;
/// A molecule of so many atoms has three domains, around its middle; a smaller one has one.
const ATOMS_OF_THREE: usize = 1_500;

fn make(
    values: &Values,
    source: &str,
    options: &LoadOptions,
    progress: &dyn Progress,
) -> Result<Parts<Solid>, SceneError> {
    let (count, seed) = (values.get("atoms") as usize, values.get("seed"));
    progress.report(0.05, "folding a chain");
    let domains = if count < ATOMS_OF_THREE { 1 } else { 3 };
    let mut atoms = Vec::with_capacity(count);
    for domain in 0..domains {
        let wanted = (count - atoms.len()) / (domains - domain);
        let (mut chain, radius) = folded(wanted, seed, domain as u64);
        let (c, s) = circle(domain as u32, domains as u32);
        // Three balls that touch have their middles 2/√3 radii from the middle of all.
        let from_middle = if domains > 1 { 1.12 * radius } else { 0.0 };
        let middle = DVec3::new(c, 0.22 * (domain as f64 - 1.0), s) * from_middle;
        chain.iter_mut().for_each(|a| a.place += middle);
        atoms.extend(chain.into_iter().map(|grown| {
            let name = format!("{}_{}", grown.element.symbol(), grown.residue + 1);
            let object = Object { name, group: format!("domain_{}", domain + 1), motion: None };
            Atom { element: grown.element, place: grown.place, object }
        }));
    }
    progress.report(0.1, "making balls");
    let rest = Part { whole: progress, start: 0.3, length: 0.7 };
    let mesh = mesh(atoms, FINEST);
    let mut parts = assemble(mesh, "molecule", source, options, Report::default(), &rest)?;
    parts.paths.extend(around(&parts.points, 25));
    Ok(parts)
}

/// An atom as it grows.
struct Grown {
    element: Element,
    /// From the domain's middle, Å.
    place: DVec3,
    residue: u32,
}

/// A domain of so many atoms around 0, and its radius without the side chains: the least ball that holds
/// them.
fn folded(wanted: usize, seed: u64, domain: u64) -> (Vec<Grown>, f64) {
    let mut radius = 2.0;
    loop {
        let mut chain = Chain { atoms: Vec::new(), residue: 0, rng: Pcg32::new(seed, 70 + domain) };
        chain.fill(radius);
        if chain.atoms.len() >= wanted {
            // What is too much is the chain's end, at the rim.
            chain.atoms.truncate(wanted);
            return (chain.atoms, radius);
        }
        radius *= 1.03;
    }
}

/// A chain so far.
struct Chain {
    atoms: Vec<Grown>,
    residue: u32,
    rng: Pcg32,
}

/// A stretch of a chain: where it begins, the unit vector along it and two across.
#[derive(Clone, Copy)]
struct Rod {
    from: DVec3,
    along: DVec3,
    across: [DVec3; 2],
}

impl Rod {
    /// So far along it, away from its middle line and around it.
    fn at(&self, along: f64, out: f64, degrees: i64) -> DVec3 {
        self.from + self.along * along + self.outward(degrees) * out
    }
    fn outward(&self, degrees: i64) -> DVec3 {
        let (c, s) = circle(degrees.rem_euclid(360) as u32, 360);
        self.across[0] * c + self.across[1] * s
    }
}

impl Chain {
    /// Runs to and fro through a ball, in rows of parallel rods.
    fn fill(&mut self, radius: f64) {
        let axis = (direction(&mut self.rng) * 0.6 + DVec3::Y).normalize();
        let (u, v) = across(axis);
        let reach = (radius / SPACING) as i32 + 1;
        let mut up = true;
        let mut last: Option<DVec3> = None;
        for j in -reach..=reach {
            for i in -2 * reach..=2 * reach {
                // Every other row is passed the other way.
                let i = if j % 2 == 0 { i } else { -i };
                let aside = u * ((f64::from(i) + 0.5 * f64::from(j)) * SPACING)
                    + v * (f64::from(j) * SPACING * 0.75f64.sqrt());
                let half = (radius * radius - aside.length_squared()).max(0.0).sqrt();
                if half < 2.0 {
                    continue;
                }
                // Rods are not quite parallel: they cross the middle plane where they should, and lean.
                let lean = direction(&mut self.rng) * 0.13;
                let along = (axis * if up { 1.0 } else { -1.0 } + lean).normalize();
                let (a, b) = across(along);
                let rod = Rod { from: aside - along * half, along, across: [a, b] };
                if let Some(last) = last {
                    self.turn(last, rod.from);
                }
                if self.rng.next_u32() % 5 < 3 {
                    self.helix(&rod, 2.0 * half);
                } else {
                    self.strands(&rod, 2.0 * half);
                }
                last = Some(rod.at(2.0 * half, 0.0, 0));
                up = !up;
            }
        }
    }

    fn put(&mut self, symbol: &str, place: DVec3) {
        let element = Element::of(symbol.as_bytes()).unwrap_or_default();
        self.atoms.push(Grown { element, place, residue: self.residue });
    }

    fn helix(&mut self, rod: &Rod, length: f64) {
        for k in 0..(length / 1.5) as i64 {
            let (along, turn) = (1.5 * k as f64, 100 * k);
            self.put("N", rod.at(along - 0.9, 1.55, turn - 28));
            self.put("C", rod.at(along, 2.29, turn));
            self.put("C", rod.at(along + 1.1, 1.65, turn + 27));
            self.put("O", rod.at(along + 2.2, 2.0, turn + 20));
            self.side_chain(rod.at(along, 2.29, turn), rod.outward(turn - 15));
        }
    }

    /// Two strands side by side, the second on the way back.
    fn strands(&mut self, rod: &Rod, length: f64) {
        let count = (length / 3.3) as i64;
        for (beside, back) in [(-2.4, false), (2.4, true)] {
            for k in 0..count {
                let k = if back { count - 1 - k } else { k };
                let ahead = if back { -1.2 } else { 1.2 };
                let (along, fold) = (3.3 * k as f64, if k % 2 == 0 { 1.0 } else { -1.0 });
                let (side, out) = (rod.across[0] * beside, rod.across[1] * fold);
                let middle = rod.at(along, 0.0, 0) + side;
                self.put("N", middle - rod.along * ahead + out * 0.2);
                self.put("C", middle + out * 0.9);
                self.put("C", middle + rod.along * ahead + out * 0.2);
                let over = rod.across[0] * (1.1 * fold);
                self.put("O", middle + rod.along * ahead + over);
                self.side_chain(middle + out * 0.9, out);
            }
        }
    }

    /// A few residues from the end of a rod to the beginning of the next, bent outward.
    fn turn(&mut self, from: DVec3, to: DVec3) {
        let outward = (from + to).normalize_or(DVec3::Y);
        for k in 1..4 {
            let t = f64::from(k) * 0.25;
            let here = from.lerp(to, t) + outward * (10.0 * t * (1.0 - t));
            let ahead = (to - from).normalize_or(DVec3::X);
            self.put("N", here - ahead * 1.2);
            self.put("C", here + outward * 0.5);
            self.put("C", here + ahead * 1.2);
            self.put("O", here + ahead * 1.2 - outward * 1.2);
            self.side_chain(here + outward * 0.5, outward);
        }
    }

    /// A side chain drawn by lot ends a residue.
    fn side_chain(&mut self, from: DVec3, outward: DVec3) {
        let chain = SIDE_CHAINS[self.rng.next_u32() as usize % SIDE_CHAINS.len()];
        let (mut at, mut ahead) = (from, outward);
        for k in 0..chain.len() {
            at += ahead * BOND;
            self.put(&chain[k..=k], at);
            ahead = (ahead + outward * 0.3 + direction(&mut self.rng) * (0.9 + 0.2 * signed(&mut self.rng)))
                .normalize_or(outward);
        }
        self.residue += 1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::generate::generate;
    use crate::scene::generate::walk::touched;
    use crate::scene::{Quiet, Scene};

    fn molecule(call: &str) -> Scene<Solid> {
        Scene::new(generate(call, &LoadOptions::default(), &Quiet).expect("a molecule")).expect("a scene")
    }

    /// Chamberlain et al. 1996, Plate 2 and Table 1: 6,534 atoms of 800 triangles, 5,227,200.
    #[test]
    fn it_has_as_many_atoms_as_it_should() {
        let counts = GENERATOR.params.iter().find(|p| p.name == "atoms").map(|p| p.default);
        assert_eq!(counts, Some(5_227_200 / 800));
        for atoms in [1usize, 40, 1_501] {
            let folds: Vec<_> = if atoms < ATOMS_OF_THREE { vec![atoms] } else { vec![501, 500, 500] }
                .into_iter()
                .map(|n| folded(n, 4, 0).0.len())
                .collect();
            assert_eq!(folds.iter().sum::<usize>(), atoms);
        }
        let scene = molecule("molecule?atoms=40");
        assert_eq!((scene.live().len(), scene.objects().len()), (40 * 800, 40));
        assert_eq!(touched(&scene), None);
        assert_ne!(scene.hash_hex(), molecule("molecule?atoms=40&seed=2").hash_hex());
        // Machines must agree, so the bits are written down.
        assert_eq!(scene.hash_hex(), "56ceb41369532ef5aa1b998ae8a9762527f346daaa3ad5b435ed475aec48fa9c");
    }

    /// Proteins without hydrogen have about 17 Å³ an atom, and of 100 atoms about 64 are carbon, 17 nitrogen,
    /// 18 oxygen and less than one sulfur.
    #[test]
    fn it_is_as_dense_as_a_protein_and_of_its_elements() {
        let (atoms, radius) = folded(2_178, 1, 0);
        let inner = atoms.iter().filter(|a| a.place.length() < 0.8 * radius).count() as f64;
        let volume = 4.0 / 3.0 * std::f64::consts::PI * (0.8 * radius) * (0.8 * radius) * (0.8 * radius);
        let each = volume / inner;
        assert!(each > 12.0 && each < 24.0, "{each} Å³ an atom");
        let share = |symbol: &str| {
            atoms.iter().filter(|a| a.element.symbol() == symbol).count() as f64 / atoms.len() as f64
        };
        let [c, n, o, s] = ["C", "N", "O", "S"].map(share);
        assert!((0.55..0.70).contains(&c) && (0.12..0.22).contains(&n), "{c} carbon, {n} nitrogen");
        assert!((0.12..0.25).contains(&o) && (0.001..0.03).contains(&s), "{o} oxygen, {s} sulfur");
    }
}
