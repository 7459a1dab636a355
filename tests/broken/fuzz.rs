//! Seeded byte-mutating tests of every reader: whatever comes in, they return, in bounded time and memory.
//!
//! `CULLSCOPE_FUZZ_CASES` sets the cases for each reader (300 without it), `CULLSCOPE_FUZZ_SEED` the first
//! seed.

use std::fs;

use cullscope::geometry::{Flat, Solid};
use cullscope::scene::{AnyScene, LoadOptions, Quiet, load, load_bytes, parse_views};
use glam::DVec3;
use rand_pcg::Pcg32;
use rand_pcg::rand_core::Rng;

fn number(name: &str, default: u64) -> u64 {
    std::env::var(name).ok().and_then(|v| v.parse().ok()).unwrap_or(default)
}

/// Pieces that break readers more often than random bytes do.
const PIECES: &[&[u8]] = &[
    b"0",
    b"-1",
    b"99999999999",
    b"1e999",
    b"nan",
    b"-",
    b".",
    b"/",
    b"\\\n",
    b"\n",
    b"\r",
    b"\0",
    b"\xff",
    b"[",
    b"]",
    b"{",
    b"}",
    b"\"",
    b",",
    b":",
    b"f ",
    b"v ",
    b"f 1 2 3 4 5 1 2\n",
    b"usemtl ",
    b"o \n",
    b"g a b\n",
    b"null",
    b"true",
    b"1e38",
    b"4294967295",
    b"18446744073709551615",
    b"\xef\xbb\xbf",
    b"newmtl a\n",
    b"Kd 1\n",
];

/// Numbers at the ends of what readers expect.
const NUMBERS: &[&[u8]] = &[
    b"0",
    b"-1",
    b"3",
    b"180",
    b"65536",
    b"16777217",
    b"4294967295",
    b"99999999999",
    b"1e39",
    b"-1e-46",
    b"1e999",
    b"nan",
];

/// Replaces a whole number, so that the text around it stays valid and what lies behind the parser is
/// reached.
fn renumber(bytes: &mut Vec<u8>, rng: &mut Pcg32) {
    let from = rng.next_u32() as usize % bytes.len();
    let Some(start) = (from..bytes.len()).find(|&i| bytes[i].is_ascii_digit()) else { return };
    let end =
        (start..bytes.len()).find(|&i| !bytes[i].is_ascii_digit() && bytes[i] != b'.').unwrap_or(bytes.len());
    bytes.splice(start..end, NUMBERS[rng.next_u32() as usize % NUMBERS.len()].iter().copied());
}

/// A copy with a few bytes changed, cut, doubled, swapped or replaced by a piece; every third has only other
/// numbers.
fn mutated(seed: &[u8], rng: &mut Pcg32) -> Vec<u8> {
    let mut bytes = seed.to_vec();
    if rng.next_u32().is_multiple_of(3) {
        (0..1 + rng.next_u32() % 2).for_each(|_| renumber(&mut bytes, rng));
        return bytes;
    }
    for _ in 0..1 + rng.next_u32() % 6 {
        if bytes.is_empty() {
            return bytes;
        }
        let at = rng.next_u32() as usize % bytes.len();
        let to = (at + 1 + rng.next_u32() as usize % 24).min(bytes.len());
        let piece = PIECES[rng.next_u32() as usize % PIECES.len()];
        match rng.next_u32() % 7 {
            0 => bytes[at] = rng.next_u32() as u8,
            1 => bytes[at] ^= 1 << (rng.next_u32() % 8),
            2 => drop(bytes.drain(at..to)),
            3 => bytes.truncate(at),
            4 => drop(bytes.splice(at..at, piece.iter().copied())),
            5 => drop(bytes.splice(at..to, piece.iter().copied())),
            _ => {
                let copy = bytes[at..to].to_vec();
                let into = rng.next_u32() as usize % bytes.len();
                bytes.splice(into..into, copy);
            }
        }
    }
    bytes
}

/// Feeds mutations to a reader; it must return, and what it returns must hold together.
fn fuzz(what: &str, seeds: &[Vec<u8>], mut read: impl FnMut(&[u8])) {
    let (cases, first) = (number("CULLSCOPE_FUZZ_CASES", 300), number("CULLSCOPE_FUZZ_SEED", 0));
    for case in first..first + cases {
        let bytes = mutated(&seeds[case as usize % seeds.len()], &mut Pcg32::new(case, 99));
        // On a panic the case is the last line that was printed.
        println!("{what} case {case}");
        read(&bytes);
    }
}

fn holds_together(scene: &AnyScene, bytes: usize) {
    let (prims, live, memory) = match scene {
        AnyScene::Flat(s) => (s.prim_count(), s.live().len(), s.memory_bytes()),
        AnyScene::Solid(s) => {
            assert!(
                s.live()
                    .iter()
                    .all(|p| s.prim_bounds(*p).min.is_finite() && s.prim_bounds(*p).max.is_finite()),
                "live primitives are finite"
            );
            (s.prim_count(), s.live().len(), s.memory_bytes())
        }
    };
    assert!(live > 0 && live <= prims, "{live} live of {prims}");
    assert!(memory < 4096 + 64 * bytes, "{memory} bytes of tables for {bytes} bytes of file");
}

fn fuzz_scene(source: &str, seeds: &[Vec<u8>]) {
    fuzz(source, seeds, |bytes| {
        if let Ok(scene) = load_bytes(bytes, source, &LoadOptions::default(), &Quiet) {
            holds_together(&scene, bytes.len());
        }
    });
}

#[test]
fn mutated_obj_text_never_breaks_the_reader() {
    let square = b"# s\nmtllib m.mtl\no a\ng b c\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvn 0 0 \
                   1\nusemtl x\nf 1/1/1 2/1/1 3/1/1 4/1/1\nusemtl y\nf -4 -3 -2\nl 1 2\np 1\n";
    let star = b"v 0 3 0\nv -1.8 -2.4 0\nv 2.9 0.9 0\nv -2.9 0.9 0\nv 1.8 -2.4 0\nf 1 2 3 4 5\nf 5 4 3 2 \
                 1\nf 1 4 2 5 3\n"
        .to_vec();
    fuzz_scene("f.obj", &[square.to_vec(), star]);
}

#[test]
fn mutated_gltf_never_breaks_the_reader() {
    fuzz_scene(
        "f.gltf",
        &[
            super::gltf::valid().into_bytes(),
            super::gltf::animated("rotation").into_bytes(),
            super::gltf::animated("translation").into_bytes(),
        ],
    );
}

#[test]
fn mutated_glb_never_breaks_the_reader() {
    fuzz_scene("f.glb", &[super::gltf::glb()]);
}

#[test]
fn mutated_flatland_never_breaks_the_reader() {
    let home = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes2d");
    let seeds =
        ["fusion.json", "moving_door.json", "spiral.json"].map(|f| fs::read(home.join(f)).expect("a scene"));
    fuzz_scene("f.json", &seeds);
}

#[test]
fn mutated_views_never_break_the_reader() {
    let solid = br#"{"width":64,"height":64,"views":[{"eye":[0,0,5],"target":[0,0,0],"up":[0,1,0],
"fov_y_degrees":60,"near":0.1,"far":100}]}"#;
    let flat = br#"{"width":64,"height":1,"views":[{"eye":[0,5],"target":[0,0],
"fov_degrees":60,"near":0.1,"far":100}]}"#;
    fuzz("views", &[solid.to_vec(), flat.to_vec()], |bytes| {
        if let Ok(path) = parse_views::<Solid>(bytes, "v", DVec3::ZERO) {
            assert!(
                path.views.iter().all(|v| v.eye.fault().is_none() && v.width <= 16_384 && v.height <= 16_384)
            );
        }
        if let Ok(path) = parse_views::<Flat>(bytes, "v", DVec3::ZERO) {
            assert!(path.views.iter().all(|v| v.eye.fault().is_none() && v.height == 1));
        }
    });
}

#[test]
fn mutated_materials_never_break_the_reader() {
    let home = super::files::folder("fuzz_materials");
    let model = home.join("m.obj");
    fs::write(&model, "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl red\nf 1 2 3\n").expect("written");
    let seed =
        b"# m\nnewmtl red\nKa 0 0 0\nKd 1 0.5 0\nKs 0 0 0\nnewmtl blue\nKd 0 0 1\nmap_Kd a.png\n".to_vec();
    fuzz("materials", &[seed], |bytes| {
        fs::write(home.join("m.mtl"), bytes).expect("written");
        match load(&model.to_string_lossy(), &LoadOptions::default(), &Quiet) {
            Ok(AnyScene::Solid(s)) => {
                assert!(s.materials().iter().all(|m| m.color.iter().all(|c| (0.0..=1.0).contains(c))))
            }
            other => panic!("broken materials cost only colors: {other:?}"),
        }
    });
}
