//! Broken Wavefront text.

use cullscope::geometry::PrimId;
use cullscope::scene::Dropped::{Degenerate, Malformed, NotFinite, OutOfRange, Rounded, TooFar, TooLong};
use cullscope::scene::{AnyScene, LoadOptions, Quiet, Recenter, load_bytes};

use super::{counts, error, solid};

/// A square of four points and its first triangle; what follows breaks.
const GOOD: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\n";

#[test]
fn files_without_a_face_are_refused_with_a_guess_at_what_they_are() {
    let stl = "solid cube\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 1 1 \
               0\nendloop\nendfacet\nendsolid\n";
    let cases: [(&[u8], &str); 13] = [
        (b"", "the file is empty"),
        (b" \n\n\t", "the file is empty"),
        (b"v 0 0 0\nv 1 0 0\nv 0 1 0\n", "it has no faces (3 points)"),
        (
            b"v 0 0 0\nv 1 0 0\nl 1 2\np 1\n",
            "it has no faces (2 points): m.obj: 1 line element ignored; m.obj: 1 point element ignored",
        ),
        (
            b"v 0 0 0\nf 1 1\nf 1\n",
            "it has no faces (1 point): m.obj:2: a face of 2 needs three corners, so it was left out (and 1 \
             more: line 3)",
        ),
        (
            b"V 0 0 0\nF 1 1 1\nF 1 1 1\n",
            "it has no faces (0 points): m.obj:1: unknown statement `V` in 1 line ignored; keywords are in \
             small letters (and 1 more: `F` in 2 lines)",
        ),
        (stl.as_bytes(), "this is an STL file, not an OBJ"),
        (b"<!DOCTYPE html>\n<html><body>404</body></html>", "this is HTML or XML, not an OBJ"),
        (b"glTF\x02\x00\x00\x00", "this is a GLB file, not an OBJ"),
        (b"PK\x03\x04\x00\x00", "this is a ZIP archive, not an OBJ"),
        (b"ply\nformat ascii 1.0\n", "this is a PLY file, not an OBJ"),
        (b"{\"asset\":{}}", "this is JSON, not an OBJ"),
        (b"\xff\xfev\x00 \x000\x00", "is UTF-16 text; save it as UTF-8"),
    ];
    for (bytes, why) in cases {
        assert_eq!(error("m.obj", bytes), format!("m.obj: {why}"));
    }
}

#[test]
fn bad_faces_are_dropped_keep_their_ids_and_are_told_with_their_line() {
    let cases = [
        (
            "f 0 1 2",
            1,
            vec![(OutOfRange, 1)],
            "m.obj:6: corner `0` names a point before the first one, so the face is dropped",
        ),
        (
            "f 1 2 9",
            1,
            vec![(OutOfRange, 1)],
            "m.obj:6: corner 9 is past the last of 4 points, so the face is dropped",
        ),
        (
            "f 1 2 3 4 9",
            3,
            vec![(OutOfRange, 3)],
            "m.obj:6: corner 9 is past the last of 4 points, so the face is dropped",
        ),
        (
            "f 1 2 4294967296",
            1,
            vec![(OutOfRange, 1)],
            "m.obj:6: corner 4294967296 is past the last of 4 points, so the face is dropped",
        ),
        (
            "f 1 2 99999999999999999999",
            1,
            vec![(OutOfRange, 1)],
            "m.obj:6: corner `99999999999999999999` names a point past any last one, so the face is dropped",
        ),
        (
            "f -1 -2 -5",
            1,
            vec![(OutOfRange, 1)],
            "m.obj:6: corner `-5` names a point before the first one, so the face is dropped",
        ),
        ("f 1 2 x", 1, vec![(Malformed, 1)], "m.obj:6: corner `x` is not a number, so the face is dropped"),
        (
            "f 1/1 /2 3",
            1,
            vec![(Malformed, 1)],
            "m.obj:6: corner `/2` is not a number, so the face is dropped",
        ),
        (
            "f 1 2 2.5",
            1,
            vec![(Malformed, 1)],
            "m.obj:6: corner `2.5` is not a number, so the face is dropped",
        ),
        ("f 1 2", 0, vec![], "m.obj:6: a face of 2 needs three corners, so it was left out"),
        ("f", 0, vec![], "m.obj:6: a face of 0 needs three corners, so it was left out"),
        ("f 1 1 2", 1, vec![(Degenerate, 1)], ""),
        ("v 2 0 0\nf 1 2 5", 1, vec![(Degenerate, 1)], ""),
        ("f 1 1 1 1", 2, vec![(Degenerate, 2)], ""),
    ];
    for (line, ids, dropped, note) in cases {
        let scene = solid("m.obj", format!("{GOOD}{line}\nf 1 3 4\n").as_bytes());
        assert_eq!(counts(&scene), (2 + ids, 2, dropped), "{line}");
        assert_eq!(scene.report().notes.first().map_or("", String::as_str), note, "{line}");
        // The last face comes after the ids of the dropped one.
        assert!(scene.corners(PrimId(ids as u32 + 1)).is_some(), "{line}");
        assert!((1..=ids as u32).all(|p| scene.corners(PrimId(p)).is_none()), "{line}");
    }
}

#[test]
fn bad_points_drop_their_faces_and_shift_nothing() {
    let cases = [
        ("v nan 0 0", NotFinite, "a coordinate is not finite, so faces at this point are dropped"),
        ("v 0 inf 0", NotFinite, "a coordinate is not finite, so faces at this point are dropped"),
        ("v 0 0 1e999", NotFinite, "a coordinate is not finite, so faces at this point are dropped"),
        ("v 1 2", Malformed, "`v` needs three numbers, so faces at this point are dropped"),
        ("v 1 two 3", Malformed, "`v` needs three numbers, so faces at this point are dropped"),
        (
            "v 1,5 2,5 3,5",
            Malformed,
            "a coordinate has a comma where a number has its point, so faces at this point are dropped",
        ),
        ("v", Malformed, "`v` needs three numbers, so faces at this point are dropped"),
    ];
    for (line, why, note) in cases {
        let scene =
            solid("m.obj", format!("v 0 0 0\nv 1 0 0\n{line}\nv 0 1 0\nf 1 2 3\nf 1 2 4\n").as_bytes());
        assert_eq!(counts(&scene), (2, 1, vec![(why, 1)]), "{line}");
        assert_eq!(scene.report().notes, [format!("m.obj:3: {note}")], "{line}");
        let points: Vec<_> = scene.prim_points(PrimId(1)).map(|p| p.to_array()).collect();
        assert_eq!(points, [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], "{line}");
    }
    // A number that 32 bits hold, but whose products they do not.
    let huge = solid("m.obj", format!("{GOOD}v 1e30 0 0\nf 1 2 5\n").as_bytes());
    assert_eq!(counts(&huge), (2, 1, vec![(TooFar, 1)]));
}

#[test]
fn if_nothing_is_left_that_is_the_error() {
    let head = "m.obj: it has no triangle that can be drawn";
    assert_eq!(error("m.obj", b"v 0 0 0\nf 1 1 1\n"), format!("{head}: 1 degenerate"));
    assert_eq!(
        error("m.obj", b"v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 9\nf 7 8 9\nf 1 1 2\n"),
        format!(
            "{head}: 1 degenerate, 2 out of range; m.obj:4: corner 9 is past the last of 3 points, so the \
             face is dropped (and 1 more: line 5)"
        )
    );
}

#[test]
fn odd_text_is_read_as_meant() {
    let same = solid("m.obj", GOOD.as_bytes());
    let odd: [&[u8]; 7] = [
        b"\xef\xbb\xbfv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\n",
        b"v 0 0 0\rv 1 0 0\rv 1 1 0\rf 1 2 3",
        b"v 0 0 0\r\nv 1 0 0\r\nv 1 1 0\r\nf 1 2 3\r\n",
        b"v 0 \\\n0 0\nv 1 0 0\nv 1 1 0\nf 1 2 \\\n3\n",
        b"# back\\\nv 0 0 0 1.0\nv 1 0 0 0.5 0.5 0.5 # red\nv 1 1 0\n\tf  1/1/1 2//2 3/3 # a face",
        b"f -3 -2 -1\nv 0 0 0\nv 1 0 0\nv 1 1 0\nf -3 -2 -1\n",
        b"f 1 2 3\nv +0 -0 .0\nv 1e0 0. 0\nv 1 1 0\n",
    ];
    for bytes in odd {
        let scene = solid("m.obj", bytes);
        assert_eq!(scene.live().len(), 1);
        let points = |s: &cullscope::scene::Scene<_>| s.prim_points(s.live()[0]).collect::<Vec<_>>();
        assert_eq!(points(&scene), points(&same), "{}", String::from_utf8_lossy(bytes));
    }
}

#[test]
fn bytes_that_are_not_text_cost_only_their_letters() {
    let scene = solid("m.obj", b"# \xff\nv 0 0 0\nv 1 0 0\nv 1 1 0\no caf\xe9\nusemtl r\xf6t\nf 1 2 3\n");
    assert_eq!(scene.objects()[0].name, "caf\u{fffd}");
    assert!(scene.report().notes.contains(
        &"m.obj:5: not UTF-8 from here on in 2 lines; names are shown as far as they can be".to_owned()
    ));
}

#[test]
fn what_is_no_face_is_left_out_and_told() {
    let text = format!("{GOOD}l 1 2\nl 2 3 4\np 1\nvp 0 0\ncurv 0 1 1 2\nfacets 12\nfacets 13\n");
    let scene = solid("m.obj", text.as_bytes());
    assert_eq!(counts(&scene), (1, 1, vec![]));
    let want = [
        "m.obj: 2 line elements ignored",
        "m.obj: 1 point element ignored",
        "m.obj: curves and surfaces are not read: `curv` (1), `vp` (1)",
        "m.obj:11: unknown statement `facets` in 2 lines ignored",
    ];
    assert_eq!(scene.report().notes, want);
}

#[test]
fn a_flood_of_complaints_is_cut_off_and_counted() {
    let mut text = GOOD.to_owned();
    (0..5_000).for_each(|k| text += &format!("f 1 2 {}\nq{k} 1\n", k + 50));
    let scene = solid("m.obj", text.as_bytes());
    assert_eq!(counts(&scene), (5_001, 1, vec![(OutOfRange, 5_000)]));
    let notes = &scene.report().notes;
    assert_eq!(
        *notes,
        [
            "m.obj:7: unknown statement `q0` in 1 line ignored (and 32 more: `q1` in 1 line, `q2` in 1 line, \
             `q3` in 1 line, `q4` in 1 line, …)",
            "m.obj:6: corner 50 is past the last of 4 points, so the face is dropped (and 4999 more: line 8, \
             line 10, line 12, line 14, …)",
        ]
    );
    assert_eq!(scene.report().unsaid, 0);
}

#[test]
fn objects_and_groups_are_put_together_again() {
    let text = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\no a\ng left\nusemtl x\nf 1 2 3\nusemtl y\nf 1 3 4\no \
                b\nusemtl x\nf 1 2 4\no a\nf 2 3 4\ng\nf 1 2 3\n";
    let scene = solid("m.obj", text.as_bytes());
    let objects: Vec<_> = scene.objects().iter().map(|o| (o.name.as_str(), o.group.as_str())).collect();
    assert_eq!(objects, [("a", "left"), ("b", "left"), ("a", "")]);
    let of: Vec<_> = (0..5).map(|p| (scene.object_of(PrimId(p)).0, scene.material_of(PrimId(p)).0)).collect();
    assert_eq!(of, [(0, 0), (0, 1), (1, 0), (0, 0), (2, 0)]);
    let plain = solid("m.obj", format!("{GOOD}g wall\nf 1 3 4\n").as_bytes());
    assert_eq!(plain.objects().iter().map(|o| o.name.as_str()).collect::<Vec<_>>(), ["default", "wall"]);
}

#[test]
fn polygons_are_cut_by_their_shape() {
    // A convex square is the fan and stays a polygon; an arrowhead is cut inside itself.
    let scene = solid("m.obj", format!("{GOOD}f 1 2 3 4\nv 0.4 0.3 0\nf 1 2 5 4\n").as_bytes());
    assert_eq!(counts(&scene), (5, 5, vec![]));
    assert_eq!(scene.faces().len(), 1);
    assert_eq!(scene.faces()[0].prims, [PrimId(1), PrimId(2)]);
    let area = |p: u32| scene.normal(PrimId(p)).length() * 0.5;
    assert!(
        (area(1) + area(2) - 1.0).abs() < 1e-6 && (area(3) + area(4) - 0.35).abs() < 1e-6,
        "{} {}",
        area(3),
        area(4)
    );
    // One that crosses itself, with nothing left of its area as a sum, is the fan, as in other readers.
    let bow_tie = solid("m.obj", b"v 0 0 0\nv 1 1 0\nv 1 0 0\nv 0 1 0\nf 1 2 3 4\n");
    assert_eq!(counts(&bow_tie), (2, 2, vec![]));
    // What stands upright on a polygon's plane is kept: a roof upon a floor.
    let front = solid("m.obj", b"v 0 0 2\nv 2 0 2\nv 2 0 0\nv 0 0 0\nv 1 1 0\nf 1 2 3 4 5\n");
    assert_eq!(counts(&front), (3, 3, vec![]));
    // Corners on a straight border, at the beginning and elsewhere, cost no triangle.
    let text = "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 4 0 0\nv 4 2 0\nv 4 4 0\nv 0 4 0\nf 1 2 3 4 5 6 7\nf 2 3 4 5 \
                6 7 1\n";
    let straight = solid("m.obj", text.as_bytes());
    assert_eq!((counts(&straight), straight.faces().len()), ((10, 10, vec![]), 2));
    // A corner named twice does.
    let twice = solid("m.obj", format!("{GOOD}f 1 2 2 3 4\n").as_bytes());
    assert_eq!(counts(&twice), (4, 3, vec![(Degenerate, 1)]));
}

#[test]
fn a_polygon_of_a_hundred_thousand_corners_loads() {
    // A comb: teeth of two corners and a gap, along a back.
    let teeth = 33_333;
    let mut text = format!("v {} -1 0\n", 2 * teeth);
    for k in (0..teeth).rev() {
        text += &format!("v {} 0 0\nv {} {} 0\nv {} 0 0\n", 2 * k + 2, 2 * k + 1, 5 + k % 7, 2 * k);
    }
    text += "v 0 -1 0\nf";
    let corners = 3 * teeth + 2;
    (1..=corners).for_each(|k| text += &format!(" {k}"));
    let scene = solid("comb.obj", text.as_bytes());
    assert_eq!(scene.prim_count(), corners - 2);
    let area: f64 = scene.live().iter().map(|p| f64::from(scene.normal(*p).length()) * 0.5).sum();
    let want = 2.0 * teeth as f64 + (0..teeth).map(|k| 5.0 + (k % 7) as f64).sum::<f64>();
    assert!((area / want - 1.0).abs() < 1e-6, "{area} instead of {want}");
}

#[test]
fn a_polygon_too_long_to_be_cut_is_left_out_and_told() {
    let n = 140_000;
    let mut text = String::from("v 0 0 0\nv 9 0 0\nv 0 9 0\nf 1 2 3\n");
    for k in 0..n {
        let angle = std::f64::consts::TAU * f64::from(k) / f64::from(n);
        let radius = if k % 2 == 0 { 100.0 } else { 90.0 };
        text += &format!("v {} {} 0\n", radius * angle.cos(), radius * angle.sin());
    }
    text += "f";
    (4..n + 4).for_each(|k| text += &format!(" {k}"));
    let scene = solid("star.obj", text.as_bytes());
    assert_eq!(counts(&scene), (n as usize - 1, 1, vec![(TooLong, n as usize - 2)]));
    assert_eq!(
        scene.report().notes,
        ["a concave polygon of 140000 corners is too long to be cut, so it was left out"]
    );
}

#[test]
fn far_off_models_keep_their_detail() {
    let text =
        b"v 500000.001 4649776.001 0\nv 500000.002 4649776.001 0\nv 500000.002 4649776.003 0\nf 1 2 3\n";
    let scene = solid("m.obj", text);
    let size = scene.bounds().size();
    assert!((size.x - 0.001).abs() < 1e-8 && (size.y - 0.002).abs() < 1e-8, "{size:?}");
    assert!(
        (scene.origin().x - 500_000.0).abs() < 0.01 && scene.report().notes[0].starts_with("recentered"),
        "{:?}",
        scene.report()
    );
    let stay = LoadOptions { recenter: Recenter::Never, ..LoadOptions::default() };
    let refused = load_bytes(text, "m.obj", &stay, &Quiet).map_err(|e| e.to_string());
    let why = "no triangle that can be drawn: 1 too small for 32-bit coordinates here; rounding to 32 bits";
    assert!(matches!(&refused, Err(e) if e.contains(why)), "{refused:?}");
}

/// Ten slats a tenth wide, five thousand kilometers from the point where the survey's marker stands.
#[test]
fn a_marker_at_the_origin_does_not_take_the_detail_of_the_rest() {
    let mut text = String::from("v 0 0 0\nv 0.1 0 0\nv 0 0.1 0\nf 1 2 3\n");
    for k in 0..10 {
        let y = 5_403_210.5 + 0.2 * f64::from(k);
        for (x, y) in [(0.25, y), (2.25, y), (2.25, y + 0.1), (0.25, y + 0.1)] {
            text += &format!("v {:.3} {y:.3} 100\n", 512_345.0 + x);
        }
        text += "f -4 -3 -2 -1\n";
    }
    let scene = solid("m.obj", text.as_bytes());
    assert_eq!(counts(&scene), (21, 20, vec![(Rounded, 1)]));
    let widths = scene.live().iter().map(|p| scene.prim_bounds(*p).size().y);
    assert!(widths.into_iter().all(|w| (w - 0.1).abs() < 1e-5));
    let notes = &scene.report().notes;
    assert!(notes[0].starts_with("recentered: (512"), "{notes:?}");
    assert_eq!(
        notes[1..],
        ["rounding to 32 bits moves points by up to 0.10 units; that changes the area of 1 face by more \
          than an eighth, and takes 1 triangle"]
    );
}

/// What has an area in the file and none in 32 bits is not called degenerate; what has none is.
#[test]
fn what_rounding_takes_is_told_from_what_has_no_area() {
    let mut text = String::new();
    for x in ["0", "1000000", "2000000"] {
        text += &format!("v {x} 0 0\nv {x}.01 0 0\nv {x} 0.01 0\nf -3 -2 -1\n");
    }
    text += "v 1000000.1 0 0\nv 1000000.2 0 0\nv 1000000.3 0 0\nf -3 -2 -1\n";
    let scene = solid("m.obj", text.as_bytes());
    let (ids, live, dropped) = counts(&scene);
    assert_eq!((ids, live, dropped), (4, 1, vec![(Degenerate, 1), (Rounded, 2)]));
    // Three points on a line, which 64 bits hold only nearly.
    let line = "v 512345.1 5403210.11 0\nv 512345.2 5403210.12 0\nv 512345.3 5403210.13 0\nf 1 2 3\n";
    let stay = LoadOptions { recenter: Recenter::Never, ..LoadOptions::default() };
    let refused = load_bytes(line.as_bytes(), "m.obj", &stay, &Quiet).map_err(|e| e.to_string());
    assert!(matches!(&refused, Err(e) if e.contains("drawn: 1 degenerate")), "{refused:?}");
    // Two sites of their own size lose nothing with the origin in between or in one of them.
    let two = solid(
        "m.obj",
        b"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1000000 0 0\nv 1000000.01 0 0\nv 1000000 0.01 \
                               0\nf 1 2 3\nf 4 5 6\n",
    );
    assert_eq!(counts(&two), (2, 2, vec![]));
}

/// `v x y z r g b`, as MeshLab, ZBrush and others write it; also with a weight, and in bytes.
#[test]
fn colors_at_points_become_materials() {
    let red = "v -1 0 0 1 0 0\nv 1 0 0 1 0 0\nv 0 1 0 1 0 0\nf 1 2 3\n";
    for color in [" 1 0 0\n", " 255 0 0\n", " 1 1 0 0\n"] {
        let text = red.replace(" 1 0 0\n", color);
        let scene = solid("m.obj", text.as_bytes());
        assert_eq!(scene.color_of(PrimId(0)), [1.0, 0.0, 0.0], "{text}");
        assert_eq!(
            scene.report().notes,
            ["colors at points: the mean of the corners for 1 face, in 1 material"]
        );
    }
    // A face at a point without a color keeps its material.
    let scene = solid("m.obj", format!("{red}v 0 0 1\nf 1 2 4\n").as_bytes());
    assert_eq!(scene.color_of(PrimId(1)), [0.7; 3]);
}

#[test]
fn preprocessing_can_be_left_off() {
    let text = b"v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 0 0\nf 1 2 3\nf 4 2 3\nf 1 4 2\n";
    let load = |options: &LoadOptions| match load_bytes(text, "m.obj", options, &Quiet) {
        Ok(AnyScene::Solid(s)) => (s.points().len(), s.live().len()),
        other => panic!("{other:?}"),
    };
    assert_eq!(load(&LoadOptions::default()), (3, 2));
    assert_eq!(load(&LoadOptions { weld: false, ..LoadOptions::default() }), (4, 2));
    assert_eq!(load(&LoadOptions { drop_degenerate: false, ..LoadOptions::default() }), (3, 3));
}
