//! The z-buffer: triangles and megapixels per second, and ratios against its plain reference and against
//! the software renderer `euc`.
//!
//! Ratios are interleaved and paired: A B A B …, one ratio a round, the median is told. Every line ends
//! with a hash of the image that was timed. One thread unless a line says otherwise.

use std::time::Instant;

use cullscope::geometry::{PrimId, Projection, Solid, View};
use cullscope::raster::{Drawable, Isa, Options, Target};
use cullscope::scene::{AnyScene, LoadOptions, Quiet, Scene, framing_view, load};
use euc::buffer::Buffer2d;
use euc::{DepthStrategy, Interpolate, Pipeline, Target as _};

/// Rounds of each comparison.
const ROUNDS: usize = 11;
/// Views of a path that are timed, evenly spread.
const VIEWS: usize = 6;

fn main() {
    let ship = |name: &str| format!("{}/scenes3d/{name}/{name}.obj", env!("CARGO_MANIFEST_DIR"));
    let mut sources = vec![
        ship("freedoom_p2_map12"),
        ship("terrain_jacksboro_65k"),
        "generate:building".into(),
        "generate:building?polygons=1000000".into(),
    ];
    // Further models may be named on the command line.
    sources.extend(std::env::args().skip(1).filter(|a| !a.starts_with("--")));
    println!("instruction set {}, {ROUNDS} rounds a view, {VIEWS} views of each path", Isa::best().label());
    for source in sources {
        let scene = match load(&source, &LoadOptions::default(), &Quiet) {
            Ok(AnyScene::Solid(scene)) => scene,
            Ok(AnyScene::Flat(_)) => continue,
            Err(why) => {
                println!("skipped: {why}");
                continue;
            }
        };
        println!("\n{}: {} triangles, {} points", scene.name(), scene.live().len(), scene.points().len());
        for (width, height) in [(256, 256), (1024, 1024), (1920, 1080)] {
            speed(&scene, width, height);
        }
        against_reference(&scene);
        against_euc(&scene);
    }
}

fn views(scene: &Scene<Solid>, width: u32, height: u32) -> Vec<View<Solid>> {
    let all = scene
        .paths()
        .first()
        .map_or_else(|| vec![framing_view(&scene.bounds(), width, height)], |p| p.views.clone());
    let step = all.len().div_ceil(VIEWS).max(1);
    all.into_iter().step_by(step).map(|v| View { width, height, ..v }).collect()
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

fn timed_ms(work: impl FnOnce()) -> f64 {
    let start = Instant::now();
    work();
    start.elapsed().as_secs_f64() * 1e3
}

/// FNV-1a over the items and depths.
fn hash(target: &Target) -> u64 {
    let words = target.item.iter().copied().chain(target.depth.iter().map(|d| d.to_bits()));
    words.fold(0xcbf2_9ce4_8422_2325, |h, w| (h ^ u64::from(w)).wrapping_mul(0x100_0000_01b3))
}

fn draw_ms(target: &mut Target, scene: &Scene<Solid>, view: &View<Solid>, options: &Options) -> f64 {
    timed_ms(|| Solid::redraw(target, scene, view, scene.live(), options))
}

/// Clearing and drawing every triangle: the best and the median round of each view, each as the median
/// over views. Rates are of the best, which other work on the machine disturbs least.
fn speed(scene: &Scene<Solid>, width: u32, height: u32) {
    let forms =
        [("1 thread", Options::default()), ("all threads", Options { threads: 0, ..Options::default() })];
    for (name, options) in forms {
        let (mut target, mut best, mut middle, mut digest) = (Target::default(), Vec::new(), Vec::new(), 0);
        for view in views(scene, width, height) {
            let times: Vec<f64> = (0..ROUNDS).map(|_| draw_ms(&mut target, scene, &view, &options)).collect();
            best.push(times.iter().copied().fold(f64::INFINITY, f64::min));
            middle.push(median(times));
            digest ^= hash(&target);
        }
        let (best, middle) = (median(best), median(middle));
        let (triangles, pixels) =
            (scene.live().len() as f64 / best / 1e3, f64::from(width * height) / best / 1e3);
        println!(
            "  {width}×{height}, {name}: best {best:.2} ms, median {middle:.2} ms, {triangles:.1} M \
             triangles/s, {pixels:.0} MP/s  [{digest:016x}]"
        );
    }
}

/// The plain code at 256², and the narrower instruction sets at 1024².
fn against_reference(scene: &Scene<Solid>) {
    let (mut fast, mut plain) = (Target::default(), Target::default());
    let view = views(scene, 256, 256)[0];
    let ratios = (0..3).map(|_| {
        let ours = draw_ms(&mut fast, scene, &view, &Options::default());
        let theirs = timed_ms(|| {
            plain.clear(&view);
            Solid::draw_reference(&mut plain, scene, &view, scene.live(), &Options::default());
        });
        theirs / ours
    });
    let ratio = median(ratios.collect());
    println!(
        "  256×256, reference / fast: ×{ratio:.1}, {} wrong pixels  [{:016x}]",
        fast.wrong_pixels(&plain),
        hash(&fast)
    );
    let view = views(scene, 1024, 1024)[0];
    for isa in [Isa::Portable, Isa::Avx2] {
        let ratios = (0..ROUNDS).map(|_| {
            let ours = draw_ms(&mut fast, scene, &view, &Options::default());
            draw_ms(&mut plain, scene, &view, &Options { isa, ..Options::default() }) / ours
        });
        println!(
            "  1024×1024, {} / {}: ×{:.2}  [{:016x}]",
            isa.label(),
            Isa::best().label(),
            median(ratios.collect()),
            hash(&plain)
        );
    }
}

/// The peer's pipeline: the same projection, the item as the pixel, 1/w as the depth.
struct Peer<'a> {
    scene: &'a Scene<Solid>,
    projection: Projection<glam::Vec3>,
}

#[derive(Clone)]
struct Item(u32);

impl Interpolate for Item {
    fn lerp2(a: Self, _: Self, _: f32, _: f32) -> Self {
        a
    }
    fn lerp3(a: Self, _: Self, _: Self, _: f32, _: f32, _: f32) -> Self {
        a
    }
}

impl Pipeline for Peer<'_> {
    type Vertex = (u32, PrimId);
    type VsOut = Item;
    type Pixel = u32;
    fn vert(&self, &(corner, prim): &Self::Vertex) -> ([f32; 4], Item) {
        let clip = self.projection.clip(self.scene.points()[corner as usize]);
        ([clip.x, clip.y, 1.0, clip.z], Item(prim.0))
    }
    fn frag(&self, item: &Item) -> u32 {
        item.0
    }
    fn get_depth_strategy(&self) -> DepthStrategy {
        DepthStrategy::IfMoreWrite
    }
}

/// `euc` at 1024², from outside the scene, for it does not clip at the near plane. It draws both sides.
fn against_euc(scene: &Scene<Solid>) {
    let view: View<Solid> = framing_view(&scene.bounds(), 1024, 1024);
    let corners: Vec<(u32, PrimId)> = scene
        .live()
        .iter()
        .flat_map(|&p| scene.corners(p).into_iter().flatten().map(move |c| (c, p)))
        .collect();
    let (mut ours, size) = (Target::default(), [1024; 2]);
    let (mut color, mut depth) = (Buffer2d::new(size, Target::NONE), Buffer2d::new(size, 0f32));
    let peer = Peer { scene, projection: view.projection() };
    let ratios = (0..ROUNDS.min(5)).map(|_| {
        let a = draw_ms(&mut ours, scene, &view, &Options::default());
        let b = timed_ms(|| {
            color.clear(Target::NONE);
            depth.clear(1.0 / view.eye.far);
            peer.draw::<euc::rasterizer::Triangles<'_, _, euc::rasterizer::BackfaceCullingDisabled>, _>(
                &corners,
                &mut color,
                Some(&mut depth),
            );
        });
        b / a
    });
    let ratio = median(ratios.collect());
    let same = ours.item.iter().zip(color.as_ref()).filter(|p| p.0 == p.1).count();
    let share = same as f64 / ours.item.len() as f64 * 100.0;
    println!(
        "  1024×1024, euc / fast, seen from outside: ×{ratio:.1}, {share:.2} % of the pixels alike  \
         [{:016x}]",
        hash(&ours)
    );
}
