//! Molecules, `.pdb` and `.xyz`: what is read of them, what is said, and the first fault in one line.

use cullscope::geometry::Solid;
use cullscope::scene::Scene;

use super::{error, solid};

/// A record with its fields in the columns of the format (wwPDB format 3.3, ATOM).
fn record(
    kind: &str,
    name: &str,
    alternate: &str,
    residue: &str,
    number: u32,
    x: f64,
    element: &str,
) -> String {
    let (y, z) = (2.0, -3.5);
    format!(
        "{kind:<6}{:>5} {name:<4}{alternate:1}{residue:>3} A{number:>4}    \
         {x:>8.3}{y:>8.3}{z:>8.3}{:>6.2}{:>6.2}          {element:>2}\n",
        1, 1.0, 0.0
    )
}

fn names(scene: &Scene<Solid>) -> Vec<String> {
    let named = |o: &cullscope::scene::Object| {
        if o.group.is_empty() { o.name.clone() } else { format!("{} in {}", o.name, o.group) }
    };
    scene.objects().iter().map(named).collect()
}

/// The bounds of each object along an axis.
fn spans(scene: &Scene<Solid>, axis: usize) -> Vec<[f32; 2]> {
    let mut spans = vec![[f32::INFINITY, f32::NEG_INFINITY]; scene.objects().len()];
    for &prim in scene.live() {
        let ([low, high], bounds) = (&mut spans[scene.object_of(prim).at()], scene.prim_bounds(prim));
        *low = low.min(bounds.min[axis]);
        *high = high.max(bounds.max[axis]);
    }
    spans
}

/// Half the widths along y: the balls' radii, since their poles are there.
fn radii(scene: &Scene<Solid>) -> Vec<f32> {
    spans(scene, 1).iter().map(|[low, high]| ((high - low) * 50.0).round() / 100.0).collect()
}

/// Where the objects are along x, to a tenth.
fn places(scene: &Scene<Solid>) -> Vec<f32> {
    spans(scene, 0).iter().map(|[low, high]| ((low + high) * 5.0).round() / 10.0).collect()
}

/// Radii of Bondi 1964: N 1.55, C 1.70, O 1.52, S 1.80, H 1.20 Å; Mantina et al. 2009: Ca 2.31.
#[test]
fn atoms_are_balls_of_their_elements() {
    let text = [
        "HEADER    MADE BY HAND\n".to_owned(),
        record("ATOM", " N  ", "", "MET", 1, -10.0, "N"),
        // Without an element: the second column says carbon, the first of another residue calcium.
        record("ATOM", " CA ", "", "MET", 1, -5.0, ""),
        record("ATOM", " SD ", "", "MET", 1, 0.0, "S"),
        record("HETATM", "CA  ", "", " CA", 2, 5.0, ""),
        record("HETATM", " O  ", "", "HOH", 3, 10.0, "O"),
        record("HETATM", " QQ ", "", "UNK", 4, 15.0, ""),
        "END\n".to_owned(),
    ]
    .concat();
    let scene = solid("hand.pdb", text.as_bytes());
    assert_eq!(scene.live().len(), 6 * 800);
    assert_eq!(
        names(&scene),
        [
            "N MET 1 in chain A",
            "CA MET 1 in chain A",
            "SD MET 1 in chain A",
            "CA CA 2 in chain A",
            "O HOH 3 in water",
            "QQ UNK 4 in chain A",
        ]
    );
    assert_eq!(radii(&scene), [1.55, 1.70, 1.80, 2.31, 1.52, 2.0]);
    let bounds = scene.bounds();
    assert!((bounds.min.x + 11.55).abs() < 0.05 && (bounds.center().z + 3.5).abs() < 0.05, "{bounds:?}");
    assert_eq!(
        scene.report().notes,
        [
            "hand.pdb: 1 atom of water, in the group `water`",
            "hand.pdb: 2 atoms without an element in columns 77 and 78, so it was told by their names",
            "6 atoms: ? 1, C 1, N 1, O 1, S 1, Ca 1; each a ball of 800 triangles",
            "unknown elements: `QQ` 1; their balls have a radius of 2 Å",
        ]
    );
}

/// An element of two letters fills columns 77 and 78, whatever the name says.
#[test]
fn elements_stand_in_two_columns() {
    let text = [("CL", 0.0), ("Zn", 8.0), ("H", 16.0), ("Xq", 24.0)];
    let text = text.map(|(element, x)| record("ATOM", " N  ", "", "UNK", 1, x, element)).concat();
    assert_eq!(radii(&solid("two.pdb", text.as_bytes())), [1.75, 1.39, 1.2, 1.55]);
}

/// Of a residue with alternates the position that comes first is taken, of models the first.
#[test]
fn alternates_and_further_models_are_left_out_and_said() {
    let text = [
        "MODEL        1\n".to_owned(),
        record("ATOM", " CB ", "B", "SER", 7, 0.0, "C"),
        record("ATOM", " CB ", "A", "SER", 7, 3.0, "C"),
        record("ATOM", " OG ", "A", "SER", 7, 4.0, "O"),
        record("ATOM", " OG ", "B", "SER", 7, 1.4, "O"),
        record("ATOM", " CB ", "A", "SER", 8, 9.0, "C"),
        "ENDMDL\nMODEL        2\n".to_owned(),
        record("ATOM", " CB ", "", "SER", 7, 50.0, "C"),
        "ENDMDL\nEND\n".to_owned(),
    ]
    .concat();
    let scene = solid("two.pdb", text.replace('\n', "\r\n").as_bytes());
    assert_eq!(places(&scene), [0.0, 1.4, 9.0]);
    let notes = &scene.report().notes;
    assert_eq!(
        notes[0],
        "two.pdb: 2 atoms in alternate positions left out: of each residue the position that comes first is \
         shown"
    );
    assert_eq!(notes[1], "two.pdb: 1 atom of further models left out: the first model is shown");
}

/// Positions are chosen for each residue by itself: those of other chains, numbers and insertion codes have
/// nothing to do with it.
#[test]
fn alternates_are_chosen_for_each_residue() {
    let atom = |alternate: &str, x: f64| record("ATOM", " CB ", alternate, "SER", 7, x, "C");
    let text = [
        atom("B", 0.0),
        atom("A", 1.0),
        atom("A", 10.0).replace("SER A   7", "SER B   7"),
        atom("A", 20.0).replace("SER A   7", "SER A   8"),
        atom("A", 30.0).replace("SER A   7 ", "SER A   7X"),
        atom("B", 31.0).replace("SER A   7 ", "SER A   7X"),
        atom("", 40.0),
    ]
    .concat();
    let scene = solid("many.pdb", text.as_bytes());
    let wants = ["CB SER 7 in chain A", "CB SER 7 in chain B", "CB SER 8 in chain A", "CB SER 7X in chain A"];
    assert_eq!(names(&scene)[..4], wants);
    assert_eq!(places(&scene), [0.0, 10.0, 20.0, 30.0, 40.0]);
    assert!(scene.report().notes[0].contains(": 2 atoms in alternate positions"), "{:?}", scene.report());
}

/// A model ends where the next one begins, at its own end, and at that of the file, each by itself.
#[test]
fn a_model_ends_in_three_ways() {
    let atom = |x: f64| record("ATOM", " CB ", "", "SER", 7, x, "C");
    for between in ["MODEL        2\n", "ENDMDL\n", "END\n"] {
        let text = ["MODEL        1\n", &atom(0.0), between, &atom(50.0), &atom(60.0)].concat();
        let scene = solid("two.pdb", text.as_bytes());
        assert_eq!(scene.objects().len(), 1, "{between}");
        let want = "two.pdb: 2 atoms of further models left out: the first model is shown";
        assert_eq!(scene.report().notes[0], want, "{between}");
    }
    // What comes before any atom ends nothing.
    let text = ["END\nMODEL        1\n", &atom(0.0), &atom(5.0)].concat();
    assert_eq!(solid("one.pdb", text.as_bytes()).objects().len(), 2);
}

/// Water by the names that programs give it; what is only called so in part is none.
#[test]
fn water_has_many_names() {
    let residues = ["HOH", "WAT", "H2O", "DOD", "TIP", "TP3", "SOL", "HO", "SOX"];
    let atoms = residues.iter().zip(0u16..);
    let atoms = atoms
        .map(|(name, k)| record("HETATM", " O  ", "", name, 1, 4.0 * f64::from(k), "O"))
        .collect::<String>();
    let scene = solid("wet.pdb", atoms.as_bytes());
    let groups: Vec<&str> = scene.objects().iter().map(|o| o.group.as_str()).collect();
    assert_eq!(groups, [["water"; 7].as_slice(), &["chain A"; 2]].concat());
    assert_eq!(scene.report().notes[0], "wet.pdb: 7 atoms of water, in the group `water`");
}

/// Bondi 1964 and, for elements of the main groups that he lacks, Mantina et al. 2009, Table 12; Å.
const RADII: &str = "\
    H 1.20 He 1.40 Li 1.82 Be 1.53 B 1.92 C 1.70 N 1.55 O 1.52 F 1.47 Ne 1.54 Na 2.27 Mg 1.73 Al 1.84 \
    Si 2.10 P 1.80 S 1.80 Cl 1.75 Ar 1.88 K 2.75 Ca 2.31 Ni 1.63 Cu 1.40 Zn 1.39 Ga 1.87 Ge 2.11 As 1.85 \
    Se 1.90 Br 1.85 Kr 2.02 Rb 3.03 Sr 2.49 Pd 1.63 Ag 1.72 Cd 1.58 In 1.93 Sn 2.17 Sb 2.06 Te 2.06 \
    I 1.98 Xe 2.16 Cs 3.43 Ba 2.68 Pt 1.75 Au 1.66 Hg 1.55 Tl 1.96 Pb 2.02 Bi 2.07 Po 1.97 At 2.02 \
    Rn 2.20 Fr 3.48 Ra 2.83 U 1.86";

#[test]
fn radii_are_those_of_the_tables() {
    let words: Vec<&str> = RADII.split_whitespace().collect();
    let table = words.as_chunks::<2>().0;
    let rows = table.iter().zip(0u16..).map(|([symbol, _], k)| format!("{symbol} {} 0 0\n", 8 * k));
    let text = format!("{}\n\n{}", table.len(), rows.collect::<String>());
    let scene = solid("all.xyz", text.as_bytes());
    assert_eq!(table.len(), 54);
    for ([symbol, radius], found) in table.iter().zip(radii(&scene)) {
        assert_eq!(format!("{found:.2}"), *radius, "{symbol}");
    }
}

#[test]
fn the_first_fault_of_a_pdb_file_is_told() {
    let good = record("ATOM", " N  ", "", "MET", 1, 0.0, "N");
    let bad = |from: &str, to: &str| format!("REMARK\n{good}{}", good.replace(from, to));
    let cases = [
        (
            bad("   2.000", "   2,000"),
            "m.pdb:3: `2,000` is not a number; columns 39 to 46 hold y of an atom, and the columns of a PDB \
             file are fixed",
        ),
        (bad("   2.000", "     nan"), "m.pdb:3: y of an atom is not finite; give it a place or leave it out"),
        (
            good[..38].to_owned(),
            "m.pdb:1: an atom has no y, which stands in columns 39 to 46; the columns of a PDB file are \
             fixed, with spaces and no tabs",
        ),
        (String::new(), "m.pdb: the file is empty"),
        ("data_1ABC\n".to_owned(), "m.pdb: this is mmCIF, not PDB; save it as PDB"),
        ("<html>\n".to_owned(), "m.pdb: this is HTML or XML, not PDB"),
        ("v 0 0 0\n".to_owned(), "m.pdb: there is no atom in it: no line begins with ATOM or HETATM"),
    ];
    for (text, want) in cases {
        assert_eq!(error("m.pdb", text.as_bytes()), want, "{text}");
    }
    // A number that the end of the line cuts off is still one; only z is missing.
    assert_eq!(
        error("m.pdb", &good.as_bytes()[..44]),
        "m.pdb:1: an atom has no z, which stands in columns 47 to 54; the columns of a PDB file are fixed, \
         with spaces and no tabs"
    );
}

/// Symbols in any letters, with labels, and atomic numbers; what follows the coordinates is not read.
#[test]
fn lists_of_atoms_are_read() {
    let text = "5\n water, and more \nO 0 0 0\n h1 0.76 0.59 0 0.5\n1\t-0.76 0.59 0\nFe 5e0 0 -1\nXx 9 0 0\n";
    let scene = solid("w.xyz", text.as_bytes());
    assert_eq!(names(&scene), ["O_1", "H_2", "H_3", "Fe_4", "?_5"]);
    assert_eq!(radii(&scene), [1.52, 1.2, 1.2, 2.0, 2.0]);
    assert_eq!(
        scene.report().notes,
        [
            "5 atoms: ? 1, H 2, O 1, Fe 1; each a ball of 800 triangles",
            "no van der Waals radius is known here for Fe 1: their balls have 2 Å",
            "unknown elements: `Xx` 1; their balls have a radius of 2 Å",
        ]
    );
}

#[test]
fn of_several_frames_the_first_is_shown() {
    let frame = |x: f64| format!("1\nframe\nC {x} 0 0\n");
    let scene = solid("f.xyz", [frame(0.0), frame(9.0), frame(18.0)].concat().as_bytes());
    assert_eq!(scene.objects().len(), 1);
    assert!(scene.bounds().max.x < 2.0);
    assert_eq!(scene.report().notes[0], "f.xyz: 2 further frames left out: the first one is shown");
    let scene = solid("f.xyz", (frame(0.0) + "\nC 1 1 1\n").as_bytes());
    assert_eq!(scene.report().notes[0], "f.xyz:5: what follows the atoms from here on is not read");
}

#[test]
fn the_first_fault_of_a_list_of_atoms_is_told() {
    let cases = [
        ("", "l.xyz: the file is empty"),
        ("O 0 0 0\n", "l.xyz:1: `O 0 0 0` is not the number of atoms, with which an XYZ file begins"),
        ("0\n\n", "l.xyz:1: there are no atoms: the number of atoms is 0"),
        ("2\n\nO 0 0 0\n", "l.xyz:3: the file ends after 1 of 2 atoms, the number in its first line"),
        ("1\n", "l.xyz:1: the file ends after 0 of 1 atom, the number in its first line"),
        ("1\n\n\n", "l.xyz:3: an empty line stands where an atom should: symbol, x, y, z"),
        ("1\n\nO 0 0\n", "l.xyz:3: an atom has no z; a line is a symbol, x, y and z, with spaces between"),
        ("1\n\nO 0 0 inf\n", "l.xyz:3: z of an atom is not finite; give it a place or leave it out"),
        (
            "1\n\nO 0 1,5 0\n",
            "l.xyz:3: `1,5` is not a number, where y of an atom should be; numbers have a point, not a comma",
        ),
        ("1048576\n\n", "l.xyz:2: the file ends after 0 of 1048576 atoms, the number in its first line"),
        (
            "1048577\n\n",
            "l.xyz:1: there are more than 1048576 atoms; write fewer of them to a file of their own",
        ),
    ];
    for (text, want) in cases {
        assert_eq!(error("l.xyz", text.as_bytes()), want, "{text}");
    }
}
