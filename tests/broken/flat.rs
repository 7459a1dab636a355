//! Broken flatland scenes and view files.

use cullscope::geometry::{Flat, Solid};
use cullscope::scene::{AnyScene, Dropped, parse_views};
use glam::DVec3;

use super::{error, read};

#[test]
fn broken_flatland_scenes_are_refused_with_their_line() {
    let cases = [
        ("", "1: the file is empty (EOF while parsing a value)"),
        ("{", "1: EOF while parsing an object"),
        ("{}", "1: missing field `segments`"),
        ("[]", "1: a flatland scene is a JSON object, { … }"),
        ("{\"segments\": []}", "1: there are no segments in it"),
        (
            "{\n \"segments\": [\n  [0, 0, 1, 0],\n  [0, 0, 1]]\n}",
            "4: invalid length 3, expected an array of length 4",
        ),
        ("{\n \"segments\": [\n  [0, 0, 1, \"a\"]]\n}", "3: invalid type: string \"a\", expected f64"),
        ("{\n \"segments\": [[0, 0, 1, 0],\n ]}", "3: trailing comma"),
        ("{\"segments\": [[0, 0, 1, 1e999]]}", "1: number out of range"),
        ("{\"segments\": [[0, 0, 1, NaN]]}", "1: expected value"),
        (
            "{\n\n \"fov_degrees\": 0, \"segments\": [[0, 0, 1, 0]]}",
            "3: fov_degrees must lie between 0.1 and 179, not 0",
        ),
        (
            "{\"segments\": [[0, 0, 1, 0]],\n \"objects\": [[0,\n  7]]}",
            "3: object 0 names segment 7, but there are only 1",
        ),
        (
            "{\"segments\": [[0, 0, 1, 0]],\n \"objects\": [[0],\n [0]]}",
            "3: segment 0 is in object 0 and in object 1",
        ),
        (
            "{\"segments\": [[0, 0, 1, 0]], \"objects\": [[0]],\n \"object_names\": [\"a\", \"b\"]}",
            "2: there are 2 object_names for 1 objects",
        ),
        (
            "{\"segments\": [[0, 0, 1, 0]], \"objects\": [[-1]]}",
            "1: invalid value: integer `-1`, expected usize",
        ),
        (
            "{\"segments\": [[0, 0, 1, 0]],\n \"eyes\": [[0, 0, 1, 0],\n [1, 1, 0, 0]]}",
            "3: eyes 1: the target is at the eye, so there is no direction to look in",
        ),
        (
            "{\"segments\": [[0, 0, 1, 0]],\n \"motions\": {\n \"door\": [[0, 0, 0]]}}",
            "3: there is no object `door` to move",
        ),
        (
            "{\"segments\": [[0, 0, 1, 0]],\n \"motions\": {\"walls\":\n []}}",
            "3: the motion of `walls` has no frames",
        ),
        (
            "{\"segments\": [[0, 0, 1, 0]],\n \"colors\": {\"walls\":\n [2, 0, 0]}}",
            "3: the color of `walls` must be three numbers from 0 to 1",
        ),
        (
            "{\"segments\": [[0, 0, 1, 0]],\n \"expect\": [{\"eye\": 3}]}",
            "2: fact 0 is about eye 3, but there are only 0",
        ),
        (
            "{\"segments\": [[0, 0, 1, 0]], \"eyes\": [[0, 1, 0, -1]],\n \"expect\": [{\"eye\": 0, \
             \"visible\": [0,\n 4]}]}",
            "3: fact 0 names segment 4, but there are only 1",
        ),
        ("{\"views\": []}", "1: this is a view file, not a flatland scene; give it with --view"),
        ("{\"segments\": [[0, 0, 1, 0]]} x", "1: trailing characters"),
    ];
    for (text, want) in cases {
        assert_eq!(error("s.json", text.as_bytes()), format!("s.json:{want}"), "{text}");
    }
    let typo = error("s.json", b"{\"segments\": [[0, 0, 1, 0]],\n \"eye\": []}");
    assert!(typo.starts_with("s.json:2: unknown field `eye`, expected one of"), "{typo}");
    assert_eq!(
        error("s.json", b"{\"segments\": [[0,0,1,0]], \"title\": \"\xff\"}"),
        "s.json:1: invalid unicode code point"
    );
    assert_eq!(error("s.json", b"\xfe\xff\0{"), "s.json: is UTF-16 text; save it as UTF-8");
    let deep = format!("{{\"segments\": {}", "[".repeat(100_000));
    assert!(error("s.json", deep.as_bytes()).starts_with("s.json:1: "), "deep nesting is no crash");
}

#[test]
fn segments_that_cannot_be_drawn_keep_their_ids() {
    let text = b"{\"segments\": [[0, 0, 0, 0], [0, 0, 1e300, 0], [0, 0, 1, 0], [-0.0, 0, 0, 1]], \
                 \"objects\": [[2]]}";
    let Ok(AnyScene::Flat(scene)) = read("s.json", text) else { panic!("it should load") };
    assert_eq!((scene.prim_count(), scene.live().len(), scene.points().len()), (4, 2, 3));
    let dropped: Vec<_> = scene.report().dropped.iter().map(|(k, v)| (*k, *v)).collect();
    assert_eq!(dropped, [(Dropped::Degenerate, 1), (Dropped::NotFinite, 1)]);
    assert_eq!(scene.report().notes, ["3 segments are in no object; they make up one more, `rest`"]);
    assert_eq!(scene.objects().iter().map(|o| o.name.as_str()).collect::<Vec<_>>(), ["object_0", "rest"]);
}

#[test]
fn broken_views_are_refused_with_their_line_and_place() {
    let view = |inner: &str| {
        format!(
            "{{\"width\":64,\"height\":64,\"views\":[\n{{\"eye\":[0,0,0],\"target\":[0,0,-1]}},\
             \n{{{inner}}}]}}"
        )
    };
    let cases = [
        ("{}".to_owned(), "1: missing field `views`"),
        ("{\"views\":[]}".into(), "1: there are no views in it"),
        ("{\n\"width\":0,\"views\":[]}".into(), "2: width must be 1 to 16384 pixels, not 0"),
        ("{\"height\":99999,\"views\":[]}".into(), "1: height must be 1 to 16384 pixels, not 99999"),
        ("{\"width\":-5,\"views\":[]}".into(), "1: invalid value: integer `-5`, expected u32"),
        (view("\"eye\":[0,0],\"target\":[0,0,1]"), "3: view 1: `eye` needs 3 numbers in space, not 2"),
        (
            view("\"eye\":[0,0,0],\"target\":[0,0,0]"),
            "3: view 1: the target is at the eye, so there is no direction to look in",
        ),
        (
            view("\"eye\":[0,0,0],\"target\":[0,0,1],\"near\":0"),
            "3: view 1: near must be greater than 0 and far greater than near",
        ),
        (
            view("\"eye\":[0,0,0],\"target\":[0,0,1],\"near\":5,\"far\":5"),
            "3: view 1: near must be greater than 0 and far greater than near",
        ),
        (
            view("\"eye\":[0,0,0],\"target\":[0,0,1],\"fov_y_degrees\":180"),
            "3: view 1: the angle of view must lie between 0 and 180 degrees",
        ),
        (
            view("\"eye\":[0,0,0],\"target\":[0,0,1],\"fov_degrees\":90"),
            "3: view 1: space has `fov_y_degrees`, the vertical angle, and no `fov_degrees`",
        ),
        (
            view("\"eye\":[1e300,0,0],\"target\":[0,0,1]"),
            "3: view 1: a coordinate, the angle or a depth is not a finite number",
        ),
        (view("\"target\":[0,0,1]"), "3: missing field `eye`"),
        ("{\"views\":[{\"eye\":[0,0,0],\"target\":[0,0,1]}".into(), "1: EOF while parsing a list"),
    ];
    for (text, want) in cases {
        let said = parse_views::<Solid>(text.as_bytes(), "v.json", DVec3::ZERO).map_err(|e| e.to_string());
        assert_eq!(said, Err(format!("v.json:{want}")), "{text}");
    }
    let flat =
        |text: &str| parse_views::<Flat>(text.as_bytes(), "v.json", DVec3::ZERO).map_err(|e| e.to_string());
    assert_eq!(
        flat("{\"views\":[{\"eye\":[0,0],\"target\":[0,1],\"fov_y_degrees\":60}]}"),
        Err("v.json:1: view 0: flatland has `fov_degrees`, the angle across the image, and no \
             `fov_y_degrees`"
            .into())
    );
    assert_eq!(
        flat("{\"height\":2,\"views\":[{\"eye\":[0,0],\"target\":[0,1]}]}"),
        Err("v.json:1: a flatland image has height 1, not 2".into())
    );
    assert_eq!(
        flat("{\"views\":[{\"eye\":[0,0],\"target\":[0,1],\"up\":[0,1]}]}"),
        Err("v.json:1: view 0: there is no `up` in flatland".into())
    );
    assert!(flat("{\"views\":[{\"eye\":[0,0],\"target\":[0,1],\"fov_degrees\":60}]}").is_ok());
}
