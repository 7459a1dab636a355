//! The trace format: what is written reads back, equal runs give equal bytes, and no input breaks the reader.

use std::io::BufReader;
use std::sync::Arc;

use cullscope::culling::Methods;
use cullscope::geometry::{Solid, View};
use cullscope::method::{Film, Settings};
use cullscope::scene::{AnyScene, LoadOptions, Quiet, Scene, framing_view, load};
use cullscope::trace::Detail;
use cullscope::trace::format::{Header, Reader, SCHEMA, TraceError, check, write_film, write_header};
use rand_pcg::Pcg32;
use rand_pcg::rand_core::Rng;
use serde_json::{Value as Json, json};

fn scene() -> Arc<Scene<Solid>> {
    match load("generate:building?polygons=1000&seed=3", &LoadOptions::default(), &Quiet).expect("a building")
    {
        AnyScene::Solid(scene) => scene,
        AnyScene::Flat(_) => panic!("a building stands in space"),
    }
}

fn film(scene: &Arc<Scene<Solid>>, cap: usize) -> Arc<dyn Film<Solid>> {
    let view: View<Solid> = framing_view(&scene.bounds(), 64, 64);
    let settings = Settings(
        [("tree-height".to_owned(), "4".to_owned()), ("backface-culling".to_owned(), "true".to_owned())]
            .into(),
    );
    let entry = Solid::method("frustum").expect("a method");
    entry.ready(scene, &settings, &Quiet).expect("settings").expect("not cancelled").record(&view, cap).film
}

fn header() -> Header {
    let map = |v: Json| v.as_object().cloned().expect("an object");
    Header {
        scene: "a \"scene\"\n".into(),
        method: "frustum".into(),
        params: map(json!({ "tree-height": 4 })),
        view: map(json!({ "width": 64 })),
        more: map(json!({ "detail": "full" })),
    }
}

fn written(film: &dyn Film<Solid>, detail: Detail) -> Vec<u8> {
    let mut bytes = Vec::new();
    write_header(&header(), &mut bytes).expect("memory takes it");
    for frame in 0..2 {
        write_film(film, frame, detail, &mut bytes, &|_| false).expect("memory takes it");
    }
    bytes
}

#[test]
fn what_is_written_reads_back() {
    let scene = scene();
    let film = film(&scene, usize::MAX);
    let bytes = written(&*film, Detail::Full);
    assert_eq!(bytes, written(&*self::film(&scene, usize::MAX), Detail::Full), "equal runs give equal bytes");
    let (read, mut reader) = Reader::new(&bytes[..]).expect("valid");
    assert_eq!(read, header());
    for frame in 0..2 {
        for at in 0..film.events().len() {
            let entry = reader.next_entry().expect("valid").expect("as many as events");
            let (kind, fields) = film.fields(at);
            assert_eq!((entry.frame, entry.step, entry.event.as_str()), (frame, at as u64 + 1, kind));
            assert_eq!(entry.fields.len(), fields.len());
            for field in fields {
                use cullscope::method::Value;
                let got = &entry.fields[field.name];
                match field.value {
                    // A 32-bit number is written with the digits of 32 bits.
                    Value::Number(v) => assert_eq!(got.as_f64().map(|g| g as f32), Some(v as f32)),
                    Value::List(list) => {
                        let got: Vec<f32> = got
                            .as_array()
                            .expect("a list")
                            .iter()
                            .map(|v| v.as_f64().expect("finite") as f32)
                            .collect();
                        assert_eq!(got, list.iter().map(|v| *v as f32).collect::<Vec<_>>());
                    }
                    Value::Integer(v) => assert_eq!(got.as_u64(), Some(v)),
                    Value::Switch(v) => assert_eq!(got.as_bool(), Some(v)),
                    Value::Word(v) => assert_eq!(got.as_str(), Some(v.as_str())),
                }
            }
        }
    }
    assert!(reader.next_entry().expect("valid").is_none());
    let summary = check(&bytes[..]).expect("valid");
    assert_eq!((summary.events, summary.frames), (2 * film.events().len() as u64, 2));
}

#[test]
fn lines_name_the_current_pseudocode() {
    let scene = scene();
    let film = film(&scene, usize::MAX);
    let bytes = written(&*film, Detail::Coarse);
    let (_, mut reader) = Reader::new(&bytes[..]).expect("valid");
    let mut seen = 0;
    while let Some(entry) = reader.next_entry().expect("valid") {
        assert_ne!(entry.event, "LineReached", "coarse");
        if entry.event == "OrientationTested" {
            assert_eq!(entry.line.as_deref(), Some("Gather:4"));
            seen += 1;
        }
    }
    assert!(seen > 10);
}

#[test]
fn a_capped_film_says_what_is_missing() {
    let scene = scene();
    let (whole, capped) = (film(&scene, usize::MAX), film(&scene, 10));
    let bytes = written(&*capped, Detail::Full);
    let text = String::from_utf8(bytes.clone()).expect("UTF-8");
    let lost = whole.events().len() - 10;
    assert_eq!(text.matches(&format!("\"lost_events\":{lost}}}")).count(), 2);
    assert_eq!(check(&bytes[..]).expect("valid").events, 22);
}

/// Bad lines, each with a word of the reason and its line.
#[test]
fn each_kind_of_bad_line_is_named() {
    let head = r#"{"trace":1,"scene":"s","method":"m","params":{},"view":{}}"#;
    let ok = r#"{"step":1,"frame":0,"event":"E"}"#;
    let cases: [(String, u64, &str); 27] = [
        (String::new(), 1, "empty"),
        ("\n".into(), 1, "blank"),
        ("not json\n".into(), 1, "not valid JSON"),
        ("[1]\n".into(), 1, "expected an object"),
        (format!("{ok}\n"), 1, "`trace` is missing"),
        (head.replace(":1,", ":2,"), 1, "trace version 2"),
        (head.replace(":1,", ":\"1\","), 1, "trace version \"1\""),
        (head.replace("\"scene\":\"s\",", ""), 1, "`scene` is missing"),
        (head.replace("\"m\"", "7"), 1, "`method` must be text"),
        (head.replace("\"params\":{}", "\"params\":[]"), 1, "`params` must be an object"),
        (head.replace(",\"view\":{}", ""), 1, "`view` is missing"),
        (format!("{head}\n{ok}\n\n"), 3, "blank"),
        (format!("{head}\n{ok}\n{ok}\n"), 3, "step 1 comes after step 1"),
        (format!("{head}\n{}\n{ok}\n", ok.replace(":0", ":3")), 3, "frame 0 comes after frame 3"),
        (format!("{head}\n{}", ok.replace(":1", ":0")), 2, "`step` is 0"),
        (format!("{head}\n{}", ok.replace(":1", ":-1")), 2, "`step` must be a whole number"),
        (format!("{head}\n{}", ok.replace(":1", ":1.5")), 2, "`step` must be a whole number"),
        (format!("{head}\n{}", ok.replace("\"step\":1,", "")), 2, "`step` is missing"),
        (format!("{head}\n{}", ok.replace(",\"frame\":0", "")), 2, "`frame` is missing"),
        (format!("{head}\n{}", ok.replace("\"E\"", "\"\"")), 2, "`event` is empty"),
        (format!("{head}\n{}", ok.replace("\"E\"", "null")), 2, "`event` must be text"),
        (format!("{head}\n{}", ok.replace('}', ",\"line\":4}")), 2, "`line` must be text"),
        (format!("{head}\n{}", ok.replace('}', ",\"x\":{}}")), 2, "`x` must be a number"),
        (format!("{head}\n{}", ok.replace('}', ",\"x\":[[1]]}")), 2, "`x` must be a number"),
        (format!("{head}\n{}", &ok[..20]), 2, "not valid JSON"),
        (format!("{head}\n{ok}\n{}", "[".repeat(100_000)), 3, "not valid JSON"),
        (format!("{head}\n{}", " ".repeat(17 << 20)), 2, "longer than"),
    ];
    for (text, line, why) in cases {
        let error = check(text.as_bytes()).expect_err(why);
        assert_eq!(error.line(), line, "{why}: {error}");
        assert!(error.why().contains(why), "{why}: {error}");
        assert!(error.to_string().len() < 200 && !error.to_string().contains('\n'), "{error}");
    }
    let bytes = [head.as_bytes(), b"\n\xff\xfe\n"].concat();
    assert_eq!(check(&bytes[..]).expect_err("not UTF-8").line(), 2);
    let foreign = format!(
        "{head}\r\n{}\r\n",
        ok.replace('}', ",\"engine\":\"ours\",\"culled\":true,\"where\":[1,null,2.5],\"none\":null}")
    );
    assert_eq!(check(foreign.as_bytes()).expect("valid").events, 1);
}

/// Seeded mutations of a real trace: whatever comes, the reader answers, and what it accepts keeps the rules.
#[test]
fn no_bytes_break_the_reader() {
    let scene = scene();
    let whole = written(&*film(&scene, 60), Detail::Full);
    let mut rng = Pcg32::new(2024, 17);
    let (mut refused, mut accepted) = (0, 0);
    for _ in 0..4000 {
        let mut bytes = whole.clone();
        for _ in 0..=rng.next_u32() % 4 {
            let at = rng.next_u32() as usize % bytes.len();
            let other = rng.next_u32() as usize % bytes.len();
            match rng.next_u32() % 6 {
                0 => bytes[at] = rng.next_u32() as u8,
                1 => bytes[at] = b"{}[]\",:\n\\0159-eE.ntf\xff"[rng.next_u32() as usize % 21],
                2 => bytes.truncate(at.max(1)),
                3 => drop(bytes.drain(at.min(other)..at.max(other).min(at.min(other) + 40))),
                4 => bytes.insert(at, b"\n\"}0"[rng.next_u32() as usize % 4]),
                _ => {
                    let copied = bytes[at..bytes.len().min(at + 60)].to_vec();
                    bytes.splice(other..other, copied);
                }
            }
            if bytes.is_empty() {
                break;
            }
        }
        match check(BufReader::with_capacity(64, &bytes[..])) {
            Ok(summary) => {
                accepted += 1;
                assert!(summary.events <= bytes.iter().filter(|b| **b == b'\n').count() as u64 + 1);
            }
            Err(TraceError::Bad { line, .. }) => {
                refused += 1;
                assert!(line >= 1 && line <= bytes.iter().filter(|b| **b == b'\n').count() as u64 + 1);
            }
            Err(other) => panic!("memory can be read: {other}"),
        }
    }
    assert!(refused > 1000 && accepted > 100, "the mutations hit: {refused} refused, {accepted} accepted");
}

#[test]
fn the_schema_is_json_and_names_what_is_required() {
    let schema: Json = serde_json::from_str(SCHEMA).expect("JSON");
    assert_eq!(schema["$defs"]["header"]["required"], json!(["trace", "scene", "method", "params", "view"]));
    assert_eq!(schema["$defs"]["event"]["required"], json!(["step", "frame", "event"]));
}
