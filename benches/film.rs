//! Films: bytes a million events take, and how long any step takes to reach.
//!
//! `cargo bench --bench film`. A step is reached when everything that the explorer shows of it is known:
//! counts, states of all nodes, line, call stack, sentence, fields and the evidence's marks.

use cullscope::culling::Methods;
use cullscope::drawing::Drawing;
use cullscope::geometry::{NodeId, PrimId, Solid};
use cullscope::measure::timing::timed;
use cullscope::method::{Event, Settings};
use cullscope::scene::{AnyScene, LoadOptions, Quiet, framing_view, load};
use cullscope::trace::{Moves, Stamps};

fn main() {
    let AnyScene::Solid(scene) =
        load("generate:building?polygons=350000", &LoadOptions::default(), &Quiet).expect("a scene")
    else {
        panic!("the generator makes a scene of space");
    };
    let view = framing_view::<Solid>(&scene.bounds(), 1024, 1024);
    let settings = Settings::of(&[("backface-culling", "true")]);
    let mut run = Solid::method("frustum")
        .expect("a method")
        .ready(&scene, &settings, &Quiet)
        .expect("settings")
        .expect("not cancelled");
    let (_, plain_ms) = timed(|| run.cull(&view));
    let (film, record_ms) = timed(|| run.record(&view, 10_000_000).film);
    let (stamps, stamps_ms) = timed(|| Stamps::new(&*film));
    let (moves, moves_ms) = timed(|| Moves::new(film.events()));
    let events = film.events();
    let million = events.len() as f64 / 1e6;
    println!(
        "scene: {} triangles; film: {} events, {} not kept",
        scene.live().len(),
        events.len(),
        film.lost()
    );
    println!(
        "plain run {plain_ms:.1} ms, recorded {record_ms:.1} ms, stamps {stamps_ms:.1} ms, moves \
         {moves_ms:.1} ms"
    );
    println!("events and notes: {:.1} MB a million events (limit 200)", film.bytes() as f64 / 1e6 / million);

    // Steps far apart, in no order.
    let mut times: Vec<f64> = Vec::new();
    let mut hash = 0u64;
    for i in 0..500u64 {
        let step = (i * 0x9E37_79B9 % (events.len() as u64 + 1)) as usize;
        let (seen, ms) = timed(|| {
            let counts = stamps.counts(step);
            let nodes = (0..film.hierarchy().node_count() as u32)
                .filter(|&n| stamps.node(NodeId(n), step) != cullscope::trace::State::Unseen)
                .count();
            let mut drawing = Drawing::default();
            film.explain(step, &mut drawing);
            let at = step.max(1) - 1;
            let words = film.sentence(at).len() + film.fields(at).1.len();
            let line = moves.line(events, step).map_or(0, usize::from);
            counts.undecided + nodes + drawing.items.len() + words + line + moves.stack(events, step).len()
        });
        hash = hash.wrapping_mul(31).wrapping_add(seen as u64);
        times.push(ms);
    }
    times.sort_by(f64::total_cmp);
    println!(
        "a step: median {:.3} ms, worst {:.3} ms of {} (limit 16)",
        times[times.len() / 2],
        times[times.len() - 1],
        times.len()
    );
    let decided = scene.live().iter().filter(|p: &&PrimId| stamps.prim_decision(**p).is_some()).count();
    let lines = events.iter().filter(|e| matches!(e, Event::Line(_))).count();
    println!("hash {:016x}", hash ^ (decided as u64) << 20 ^ lines as u64);
}
