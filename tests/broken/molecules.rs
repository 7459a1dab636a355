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

/// Half the widths of the objects' bounds along y: the ball's radius, since its poles are there.
fn radii(scene: &Scene<Solid>) -> Vec<f32> {
    let mut bounds = vec![(f32::INFINITY, f32::NEG_INFINITY); scene.objects().len()];
    for &prim in scene.live() {
        let (low, high) = &mut bounds[scene.object_of(prim).at()];
        *low = low.min(scene.prim_bounds(prim).min.y);
        *high = high.max(scene.prim_bounds(prim).max.y);
    }
    bounds.iter().map(|(low, high)| ((high - low) * 50.0).round() / 100.0).collect()
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
    assert_eq!(scene.objects().len(), 3);
    assert!(scene.bounds().max.x < 11.0 && scene.bounds().min.x > -2.0, "{:?}", scene.bounds());
    let notes = &scene.report().notes;
    assert_eq!(
        notes[0],
        "two.pdb: 2 atoms in alternate positions left out: of each residue the position that comes first is \
         shown"
    );
    assert_eq!(notes[1], "two.pdb: 1 atom of further models left out: the first model is shown");
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
        (
            "1048577\n\n",
            "l.xyz:1: there are more than 1048576 atoms; write fewer of them to a file of their own",
        ),
    ];
    for (text, want) in cases {
        assert_eq!(error("l.xyz", text.as_bytes()), want, "{text}");
    }
}
