//! Wavefront material files: which file is read, which colors come of it, and what is see-through.

use std::fs;

use cullscope::scene::{AnyScene, LoadOptions, Material, Quiet, load};

use super::files::folder;

/// The materials and notes of a model in a folder of these files.
fn loaded(test: &str, model: &[u8], files: &[(&str, &[u8])]) -> (Vec<Material>, Vec<String>) {
    let home = folder(test);
    for (name, bytes) in files {
        fs::write(home.join(name), bytes).expect("written");
    }
    fs::write(home.join("m.obj"), model).expect("written");
    match load(&home.join("m.obj").to_string_lossy(), &LoadOptions::default(), &Quiet) {
        Ok(AnyScene::Solid(s)) => (
            s.live().iter().map(|p| s.materials()[s.material_of(*p).at()].clone()).collect(),
            s.report().notes.clone(),
        ),
        other => panic!("it should load: {other:?}"),
    }
}

fn one(library: &str) -> (Material, Vec<String>) {
    let model = b"mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl pane\nf 1 2 3\n";
    let text = format!("newmtl pane\nKd 1 0 0\n{library}");
    let (materials, notes) = loaded("see_through", model, &[("m.mtl", text.as_bytes())]);
    (materials[0].clone(), notes)
}

/// Wavefront MTL: `d` is how much a material dissolves into the background, 1.0 fully opaque; `-halo` makes
/// it depend on the angle; `Tr`, which others added, is 1 − `d`; `map_d` holds `d` by place.
#[test]
fn what_dissolves_is_see_through() {
    let cases = [
        ("", false),
        ("d 1\n", false),
        ("d 0.05\n", true),
        ("d -halo 0.5\n", true),
        ("d -halo 1.0\n", false),
        ("D 0.5\n", true),
        ("Tr 0\n", false),
        ("Tr 0.25\n", true),
        ("tr 1\n", true),
        ("map_d leaf.png\n", true),
        ("d 1\nmap_D -s 1 1 1 leaf.png\n", true),
        ("d 0.9\nTr 0.1\n", true),
    ];
    for (text, see_through) in cases {
        assert_eq!(one(text), (Material { see_through, ..Material::new("pane", [1.0, 0.0, 0.0]) }, vec![]));
    }
    let said = |text: &str| {
        let (material, notes) = one(text);
        (material.see_through, notes.join("|"))
    };
    // As in tinyobjloader, `d` wins. Maya writes `illum 4` for what is opaque.
    let both = "material `pane`: `d` and `Tr` contradict each other; `d` counts";
    assert_eq!(said("Tr 1.0\nd 1.0\n"), (false, both.into()));
    assert_eq!(said("d 0.5\nTr 0\n"), (true, both.into()));
    let glass = "material `pane`: `illum` says that it is glass, no `d`, `Tr` or `map_d` does; it is opaque";
    assert_eq!(said("illum 4\n"), (false, glass.into()));
    assert_eq!(said("illum 4\nd 0.1\n"), (true, String::new()));
    let comma = "SOME:3: `d` of `pane` has a comma where a number has its point, so it does not count";
    assert_eq!(said("d 0,5\n"), (false, comma.replace("SOME", "m.mtl")));
}

#[test]
fn keywords_count_in_any_letter_case() {
    let model = b"mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl roof\nf 1 2 3\n";
    let (materials, notes) = loaded("letters", model, &[("m.mtl", b"NEWMTL roof\nkd 1 0 0\n")]);
    assert_eq!((materials[0].color, notes), ([1.0, 0.0, 0.0], vec![]));
}

#[test]
fn names_that_are_not_text_differ_by_their_bytes() {
    let model =
        b"mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl gr\xfcn\nf 1 2 3\nusemtl gr\xf6n\nf 3 2 1\n";
    let library = b"newmtl gr\xfcn\nKd 0 1 0\nnewmtl gr\xf6n\nKd 1 0 0\n";
    let (materials, _) = loaded("bytes", model, &[("m.mtl", library)]);
    assert_eq!(materials.iter().map(|m| m.color).collect::<Vec<_>>(), [[0.0, 1.0, 0.0], [1.0, 0.0, 0.0]]);
}

#[test]
fn what_is_not_used_is_said_once() {
    let model = b"mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\nusemtl b\nf 1 2 3\nusemtl \
                  c\nf 1 2 3\nusemtl d\nf 1 2 3\n";
    let library = b"newmtl a\nKa 0 0 0\nmap_Kd a.png\nnewmtl b\nKd 1 0 0\nNs 10\nKa 1 1 1\nmap_Kd \
                    b.png\nnewmtl c\nKd 0 1 0\nmap_Kd c.png\nnewmtl d\nillum 2\n";
    let (materials, notes) = loaded("unused", model, &[("m.mtl", library)]);
    assert_eq!(materials[0].color, [0.7; 3]);
    assert_eq!(
        notes,
        [
            "material `a`: its texture (`map_Kd`) is not read; without `Kd` it is gray",
            "material `b`: its texture (`map_Kd`) is not read; it has the color of its `Kd` \
             (and 1 more: `c`)",
            "material `d`: it has no `Kd`; it is gray",
            "not used of material files, with how often it stands there: `Ka` (2), `Ns` (1)",
        ]
    );
}

/// A name leads to the file beside the model that it most likely means, and the note says which.
#[test]
fn a_library_is_found_beside_the_model() {
    let red: &[u8] = b"newmtl red\nKd 1 0 0\n";
    let cases = [
        ("m2.mtl", "m2.mtl", ""),
        ("C:\\jobs\\17\\drive path.mtl", "drive path.mtl", "`drive path.mtl` beside the model was read"),
        ("/home/x/y/far.mtl", "far.mtl", "`far.mtl` beside the model was read"),
        ("..\\up\\up.mtl", "up.mtl", "`up.mtl` beside the model was read"),
        ("Roof.MTL", "roof.mtl", "`roof.mtl` beside the model was read"),
        ("\"quoted name.mtl\"", "quoted name.mtl", "`quoted name.mtl` beside the model was read"),
        ("said.mtl # by hand", "said.mtl", "`said.mtl` beside the model was read"),
        ("old_name.mtl", "m.mtl", "materials were read from `m.mtl`, which has the model's name"),
    ];
    for (named, there, note) in cases {
        let model = format!("mtllib {named}\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl red\nf 1 2 3\n");
        let (materials, notes) = loaded("found", model.as_bytes(), &[(there, red)]);
        assert_eq!(materials[0].color, [1.0, 0.0, 0.0], "{named}");
        assert!(notes.iter().any(|n| n.ends_with(note)) || note.is_empty() && notes.is_empty(), "{notes:?}");
    }
    // Two files in one line, each by its last part.
    let model = b"mtllib \\a\\one.mtl \\a\\two.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl blue\nf 1 2 3\n";
    let two: &[u8] = b"newmtl blue\nKd 0 0 1\n";
    let (materials, _) = loaded("found", model, &[("one.mtl", red), ("two.mtl", two)]);
    assert_eq!(materials[0].color, [0.0, 0.0, 1.0]);
}
