//! Files that are not what they should be, names that lead elsewhere, and calls of generators.

use std::fs;
use std::path::{Path, PathBuf};

use cullscope::geometry::PrimId;
use cullscope::scene::{AnyScene, LoadOptions, Quiet, load};

/// A fresh folder of this test's own.
pub fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("broken_scenes").join(name);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).expect("a folder for the test");
    folder
}

fn open(path: &Path) -> Result<AnyScene, String> {
    let shown = path.to_string_lossy().into_owned();
    load(&shown, &LoadOptions::default(), &Quiet).map_err(|e| e.to_string().replace(&shown, "IT"))
}

fn refused(path: &Path) -> String {
    match open(path) {
        Err(said) => said,
        Ok(_) => panic!("{} should be refused", path.display()),
    }
}

#[test]
fn files_that_cannot_be_scenes_are_refused() {
    let home = folder("kinds");
    fs::write(home.join("photo.jpeg"), b"x").expect("written");
    fs::create_dir(home.join("folder.obj")).expect("made");
    let known = "a scene is a path to .obj, .gltf, .glb, .pdb, .xyz or .json (flatland), or generate:NAME";
    assert_eq!(refused(&home), format!("IT: is a folder; {known}"));
    assert_eq!(refused(&home.join("photo.jpeg")), format!("IT: this kind of file cannot be read; {known}"));
    assert_eq!(
        refused(&home.join("nothing")),
        format!("IT: no such file, and no kind of scene either; {known}")
    );
    assert_eq!(refused(&home.join("folder.obj")), "IT: is a folder, not a file");
    assert!(
        refused(&home.join("nothing.obj")).starts_with("IT: No such file"),
        "{}",
        refused(&home.join("nothing.obj"))
    );
}

#[cfg(unix)]
#[test]
fn devices_and_pipes_are_refused_at_once() {
    let home = folder("devices");
    for extension in ["obj", "gltf", "glb", "pdb", "xyz", "json"] {
        let path = home.join(format!("endless.{extension}"));
        std::os::unix::fs::symlink("/dev/zero", &path).expect("linked");
        assert_eq!(refused(&path), "IT: is a device or a pipe, not a regular file");
    }
    let pipe = home.join("pipe.obj");
    if std::process::Command::new("mkfifo").arg(&pipe).status().is_ok_and(|s| s.success()) {
        assert_eq!(refused(&pipe), "IT: is a device or a pipe, not a regular file");
    }
}

const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl red\nf 1 2 3\n";

/// Color of the triangle, and the notes.
fn with_library(home: &Path, library: &str) -> ([f32; 3], Vec<String>) {
    fs::write(home.join("m.obj"), format!("mtllib {library}\n{TRIANGLE}")).expect("written");
    match open(&home.join("m.obj")) {
        Ok(AnyScene::Solid(s)) => (s.color_of(PrimId(0)), s.report().notes.clone()),
        other => panic!("{library}: {other:?}"),
    }
}

#[test]
fn material_files_are_read_only_from_the_folder_of_the_model() {
    let outer = folder("materials");
    let home = outer.join("model");
    fs::create_dir_all(home.join("sub")).expect("made");
    fs::write(outer.join("secret.mtl"), "newmtl red\nKd 1 0 0\n").expect("written");
    fs::write(home.join("good.mtl"), "newmtl red\nKd 1 0 0.5\n").expect("written");
    fs::write(home.join("with space.mtl"), "\u{feff}newmtl red\nKd 0.25\n").expect("written");
    fs::write(home.join("sub/in.mtl"), "newmtl red\nKd 0 2 -1\n").expect("written");
    let gray = [0.7; 3];
    assert_eq!(with_library(&home, "good.mtl"), ([1.0, 0.0, 0.5], vec![]));
    assert_eq!(with_library(&home, "with space.mtl"), ([0.25; 3], vec![]));
    assert_eq!(with_library(&home, "sub\\in.mtl"), ([0.0, 1.0, 0.0], vec![]));
    let missing = "material `red` is in no material file; it is gray".to_owned();
    let out = "the name leads out of the model's folder, so it was not opened";
    let mut cases = vec![
        ("../secret.mtl", format!("line 1: material file ../secret.mtl: {out}")),
        ("/dev/zero", format!("line 1: material file /dev/zero: {out}")),
        ("nothing.mtl", "line 1: material file nothing.mtl: there is no such file".into()),
        ("sub", "line 1: material file sub: is a folder, not a file".into()),
    ];
    if cfg!(unix) {
        #[cfg(unix)]
        std::os::unix::fs::symlink("../secret.mtl", home.join("link.mtl")).expect("linked");
        #[cfg(unix)]
        std::os::unix::fs::symlink("/dev/zero", home.join("zero.mtl")).expect("linked");
        let link = "it is a link out of the model's folder, so it was not opened";
        cases.push(("link.mtl", format!("line 1: material file link.mtl: {link}")));
        cases.push(("zero.mtl", format!("line 1: material file zero.mtl: {link}")));
    }
    for (library, note) in cases {
        assert_eq!(with_library(&home, library), (gray, vec![note, missing.clone()]), "{library}");
    }
}

#[test]
fn broken_material_files_leave_gray_and_a_note() {
    let home = folder("broken_materials");
    let cases: [(&[u8], [f32; 3], &str); 7] = [
        (b"Kd 1 0 0\n", [0.7; 3], "material `red` is in no material file; it is gray"),
        (b"newmtl red\nKd nan 0 0\n", [0.7; 3], "b.mtl:2: `Kd` of `red` is not finite, so it does not count"),
        (
            b"newmtl red\nKd 1 0\n",
            [0.7; 3],
            "b.mtl:2: `Kd` of `red` is not three numbers, so it does not count",
        ),
        (
            b"newmtl red\nKd 0,5 0 1\n",
            [0.7; 3],
            "b.mtl:2: `Kd` of `red` has a comma where a number has its point, so it does not count",
        ),
        (
            b"newmtl red\nKd spectral file.rfl\n",
            [0.7; 3],
            "b.mtl:2: `Kd` of `red` is not made of numbers, so it does not count",
        ),
        (
            b"newmtl red\nKd 1 0 0\nnewmtl red\nKd 0 1 0\n",
            [1.0, 0.0, 0.0],
            "b.mtl:3: material `red` is defined twice; the first counts",
        ),
        (b"\xff\xfen\0", [0.7; 3], "b.mtl: is UTF-16 text; save it as UTF-8"),
    ];
    for (bytes, color, note) in cases {
        fs::write(home.join("b.mtl"), bytes).expect("written");
        let (got, notes) = with_library(&home, "b.mtl");
        assert_eq!((got, notes.first().map_or("", String::as_str)), (color, note));
    }
}

#[test]
fn buffers_are_read_only_from_the_folder_of_the_model() {
    let outer = folder("buffers");
    let home = outer.join("model");
    fs::create_dir_all(&home).expect("made");
    fs::write(outer.join("secret.bin"), super::gltf::buffer()).expect("written");
    fs::write(home.join("good one.bin"), super::gltf::buffer()).expect("written");
    let inline =
        format!("data:application/octet-stream;base64,{}", super::gltf::base64(&super::gltf::buffer()));
    let with = |uri: &str| {
        fs::write(home.join("m.gltf"), super::gltf::valid().replace(&inline, uri)).expect("written");
        open(&home.join("m.gltf")).map(|_| ())
    };
    assert_eq!(with("good%20one.bin"), Ok(()));
    assert_eq!(with("nothing.bin"), Err("IT: buffer file nothing.bin: there is no such file".into()));
    for uri in
        ["../secret.bin", "%2e%2e/secret.bin", "/dev/zero", "file:///dev/zero", "https://example.org/a.bin"]
    {
        let said = with(uri).expect_err("refused");
        assert!(said.starts_with(&format!("IT: buffer file {uri}: ")), "{said}");
    }
}

#[test]
fn views_beside_a_model_become_its_paths_or_a_note() {
    let home = folder("views");
    fs::write(home.join("m.obj"), TRIANGLE).expect("written");
    fs::write(home.join("m.views.json"), "{\"views\":[{\"eye\":[0,0,5],\"target\":[0,0,0]}]}")
        .expect("written");
    fs::write(home.join("m.walk.views.json"), "{\"views\":[{\"eye\":[0,0,5],\"target\":[0,0,5]}]}")
        .expect("written");
    let Ok(AnyScene::Solid(scene)) = open(&home.join("m.obj")) else { panic!("it should load") };
    assert_eq!(scene.paths().iter().map(|p| p.name.as_str()).collect::<Vec<_>>(), ["views"]);
    let note = scene.report().notes.last().cloned().unwrap_or_default();
    assert!(
        note.starts_with("view path left out: ")
            && note.contains("m.walk.views.json:1: view 0: the target is at the eye"),
        "{note}"
    );
}

#[test]
fn generators_say_what_they_take() {
    let cases = [
        (
            "generate:castle",
            "generate:castle: there is no generator `castle`; there are: building, city, machine-room, \
             box-and-objects, thin-slabs, seminar-room, cars, forest, swarm, terrain, tree, \
             tree-quadrupling, molecule, terrain-island, venetian-blind, bust, suspension, failure",
        ),
        (
            "generate:",
            "generate:: there is no generator ``; there are: building, city, machine-room, box-and-objects, \
             thin-slabs, seminar-room, cars, forest, swarm, terrain, tree, tree-quadrupling, molecule, \
             terrain-island, venetian-blind, bust, suspension, failure",
        ),
        (
            "generate:building?storeys=3",
            "generate:building?storeys=3: `building` has no parameter `storeys`; it has: polygons, seed, \
             rooms",
        ),
        ("generate:building?seed", "generate:building?seed: `seed` should read key=value"),
        (
            "generate:building?polygons=10",
            "generate:building?polygons=10: `polygons` must be a whole number from 1000 to 8000000, not `10` \
             (triangles, met within a few percent)",
        ),
        (
            "generate:building?seed=-1",
            "generate:building?seed=-1: `seed` must be a whole number from 0 to 4294967295, not `-1` (\
             chooses widths of rooms, sides of doors and furniture)",
        ),
    ];
    for (call, want) in cases {
        let said = load(call, &LoadOptions::default(), &Quiet).map(|_| ()).map_err(|e| e.to_string());
        assert_eq!(said, Err(want.to_owned()));
    }
}
