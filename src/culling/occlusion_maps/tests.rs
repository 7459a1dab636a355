//! Worked examples of the paper's rules, and whole frames.

use glam::{Vec2, vec2};

use super::budget::Work;
use super::depth::DepthBuffer;
use super::overlap::{Hears, MapRead, Outcome, Overlap, Step, overlap_test};
use super::parts::Mapper;
use super::selection::{Candidate, Choosing, Known, Order};
use super::*;
use crate::geometry::dice::Dice;
use crate::geometry::{
    Eye, Flat, Frustum, FrustumTest, NodeId, PixelRect, PrimId, Solid, View, nearest_depth,
};
use crate::method::{Recorder, Verdict, Words};
use crate::raster::PyramidCell;
use crate::scene::{Face, LoadOptions, Parts, Quiet};

/// Hears nothing.
struct Deaf;

impl Hears for Deaf {
    fn reaches(&mut self, _: Step) {}
    fn reads(&mut self, _: MapRead) {}
}

/// Keeps what is read.
#[derive(Default)]
struct Heard(Vec<(u8, f64, Outcome)>);

impl Hears for Heard {
    fn reaches(&mut self, _: Step) {}
    fn reads(&mut self, read: MapRead) {
        self.0.push((read.cell.level, read.opacity(), read.outcome));
    }
}

/// Maps of an image of samples, `false` where nothing covers them, with pixels of `1 << shift` samples a
/// side.
fn maps(width: u32, height: u32, shift: u32, covered: impl Fn(u32, u32) -> bool) -> Opacity {
    let depths: Vec<f32> = (0..height)
        .flat_map(|y| (0..width).map(move |x| (x, y)))
        .map(|(x, y)| if covered(x, y) { 1.0 } else { 0.0 })
        .collect();
    let mut maps = Opacity::default();
    maps.clear([width, height], shift, height == 1);
    maps.build_from_depths(&depths, 0.0);
    maps
}

/// The 4×4 map `1 1 1 0 / 1 1 1 1 / 0 0 1 1 / 1 1 1 ½` in the corner of one of 16×16, of 2×2 samples a pixel.
fn example_map() -> Opacity {
    maps(32, 32, 1, |x, y| match (x / 2, y / 2) {
        (3, 0) | (0 | 1, 2) => false,
        (3, 3) => y % 2 == 0,
        _ => true,
    })
}

fn rect([x0, x1]: [u32; 2], [y0, y1]: [u32; 2]) -> PixelRect {
    PixelRect { x0, x1, y0, y1 }
}

fn test(maps: &Opacity, under: PixelRect, ignored: u32, start: u8) -> (bool, Vec<(u8, f64, Outcome)>) {
    let mut heard = Heard::default();
    let found = overlap_test(maps, under, ignored, start, &mut heard);
    assert_eq!(found, overlap_test(maps, under, ignored, start, &mut Deaf));
    (found.is_covered, heard.0)
}

#[test]
fn levels_are_averages() {
    let maps = example_map();
    let opacity = |level, x, y| maps.opacity(PyramidCell { level, x, y });
    assert_eq!([opacity(0, 2, 0), opacity(0, 3, 0), opacity(0, 3, 3)], [1.0, 0.0, 0.5]);
    assert_eq!([opacity(1, 0, 0), opacity(1, 1, 0)], [1.0, 0.75]);
    assert_eq!([opacity(1, 0, 1), opacity(1, 1, 1)], [0.5, 0.875]);
    assert_eq!(opacity(2, 0, 0), 25.0 / 32.0);
}

#[test]
fn figure_8_reads_what_decides() {
    use Outcome::{Descends, Opaque, TooTransparent, Transparent};
    let maps = example_map();
    let opaque = vec![(1, 1.0, Opaque)];
    assert_eq!(test(&maps, rect([0, 2], [0, 2]), 0, 1), (true, opaque));
    // Wholly in the rectangle, so that its black sample counts.
    assert_eq!(test(&maps, rect([2, 4], [0, 2]), 0, 1), (false, vec![(1, 0.75, TooTransparent)]));
    let (down, on) = ((1, 0.75, Descends), (0, 1.0, Opaque));
    let all = vec![down, on, on, (1, 0.875, Descends), on, on];
    assert_eq!(test(&maps, rect([2, 4], [1, 3]), 0, 1), (true, all));
    let ends = vec![(1, 0.5, Descends), (0, 0.0, Transparent)];
    assert_eq!(test(&maps, rect([1, 3], [2, 4]), 0, 1), (false, ends));
    assert_eq!(test(&maps, rect([0, 4], [0, 4]), 0, 2), (false, vec![(2, 25.0 / 32.0, TooTransparent)]));
}

#[test]
fn as_opaque_as_the_threshold_is_opaque() {
    use Outcome::{Descends, Opaque, Transparent};
    // O_0 = 1/2 is 2 of 4 samples, on level 1 O_1 = 7/8, on level 2 31/32.
    let maps = example_map();
    assert_eq!(test(&maps, rect([2, 4], [2, 4]), 2, 1), (true, vec![(1, 0.875, Opaque)]));
    let reads = vec![
        (2, 25.0 / 32.0, Descends),
        (1, 1.0, Opaque),
        (1, 0.75, Descends),
        (0, 1.0, Opaque),
        (0, 0.0, Transparent),
    ];
    assert_eq!(test(&maps, rect([0, 4], [0, 4]), 2, 2), (false, reads));
    // A full map needs one look with any threshold; as printed, with "greater", it would never be opaque.
    let full = super::tests::maps(32, 32, 1, |_, _| true);
    let wide = rect([3, 7], [2, 6]);
    assert_eq!(test(&full, wide, 0, full.start(wide)).1, vec![(2, 1.0, Opaque); 4]);
    assert!(test(&full, rect([0, 2], [0, 2]), 0, 1) == (true, vec![(1, 1.0, Opaque)]));
}

#[test]
fn thresholds_of_section_5_4() {
    let threshold = |t: f32, resolution: u32, side: u32| {
        let params = Params { opacity_threshold: t, map_resolution: resolution, ..Params::default() };
        let mut maps = Opacity::default();
        maps.clear([side, side], (side / resolution).trailing_zeros(), false);
        let n = params.ignored(&maps);
        let level = |k: u8| 1.0 - f64::from(n) / f64::from(maps.whole() << (2 * k));
        (n, [level(0), level(1), level(2)])
    };
    // "1 − 25/(16·16) = 0.90", and one level up "1 − 25/(32·32) = 0.98".
    let (n, levels) = threshold(0.902_343_75, 64, 1024);
    assert_eq!((n, levels), (25, [0.902_343_75, 0.975_585_937_5, 0.993_896_484_375]));
    assert_eq!(levels[1], (3.0 + levels[0]) / 4.0, "O_1 = (3 + O_0)/4");
    // 0.9 of 16 samples: one may be black.
    assert_eq!(threshold(0.9, 256, 1024).0, 1);
    // In flatland a pixel has two below it: O_1 = (1 + O_0)/2.
    let mut flat = Opacity::default();
    flat.clear([512, 1], 3, true);
    assert_eq!(Params { opacity_threshold: 0.75, ..Params::default() }.ignored(&flat), 2);
    assert_eq!((1.0 + 0.75) / 2.0, 1.0 - 2.0 / f64::from(2 * flat.whole()));
}

/// Whether all pixels of level 0 under a rectangle are opaque.
fn flat_test(maps: &Opacity, under: PixelRect, ignored: u32) -> bool {
    let mut cells = (under.y0..under.y1).flat_map(|y| (under.x0..under.x1).map(move |x| (x, y)));
    cells.all(|(x, y)| maps.black(PyramidCell { level: 0, x: x as u16, y: y as u16 }) <= ignored)
}

/// `CULLSCOPE_RECTANGLES` says how many; ten million take about a minute.
#[test]
fn the_hierarchy_never_changes_an_answer() {
    let many = std::env::var("CULLSCOPE_RECTANGLES").ok().and_then(|n| n.parse().ok()).unwrap_or(200_000);
    let (mut dice, mut asked, mut covered) = (Dice::new(95), 0, 0);
    while asked < many {
        let is_flat = dice.below(4) == 0;
        let (width, height) = (1 + dice.below(200), if is_flat { 1 } else { 1 + dice.below(120) });
        let shift = dice.below(4);
        // Mostly covered, with holes of all sizes.
        let holes: Vec<[u32; 4]> = (0..dice.below(12))
            .map(|_| [dice.below(width), dice.below(height), 1 + dice.below(6), 1 + dice.below(6)])
            .collect();
        let in_hole = |x: u32, y: u32| {
            holes.iter().any(|h| (h[0]..h[0] + h[2]).contains(&x) && (h[1]..h[1] + h[3]).contains(&y))
        };
        let maps = super::tests::maps(width, height, shift, |x, y| !in_hole(x, y));
        for _ in 0..500 {
            let span = |dice: &mut Dice, end: u32| {
                let (a, b) = (dice.below(end), dice.below(end));
                [a.min(b), a.max(b) + 1]
            };
            let pixels = rect(span(&mut dice, width), span(&mut dice, height));
            let under = maps.under(pixels);
            let ignored = [0, 1, dice.below(1 + maps.whole() / 2)][dice.below(3) as usize];
            let flat = flat_test(&maps, under, ignored);
            for start in [maps.start(under), dice.below(maps.levels().into()) as u8] {
                let found = overlap_test(&maps, under, ignored, start, &mut Deaf);
                assert_eq!(found.is_covered, flat, "{under:?} from level {start}, {ignored} ignored");
                assert!(found.ignored == 0 || ignored > 0, "{found:?}");
            }
            if flat && ignored == 0 {
                // Brute force over the samples.
                let mut all =
                    (pixels.y0..pixels.y1).flat_map(|y| (pixels.x0..pixels.x1).map(move |x| (x, y)));
                assert!(all.all(|(x, y)| !in_hole(x, y)), "a hole shows in {pixels:?}");
            }
            (asked, covered) = (asked + 1, covered + usize::from(flat));
        }
    }
    assert!(covered > asked / 20 && covered < asked - asked / 20, "{covered} of {asked} are covered");
}

/// A hole is counted a map pixel at a time (Section 5.4 promises its size): a slit and a hole on a corner are
/// larger than what is said to be ignored.
#[test]
fn what_thresholds_do_not_bound() {
    let n = 25;
    let all = |maps: &Opacity| {
        let [columns, rows] = maps.size(0);
        overlap_test(
            maps,
            rect([0, columns], [0, rows]),
            n,
            maps.start(rect([0, columns], [0, rows])),
            &mut Deaf,
        )
    };
    let slit = maps(1024, 1024, 4, |x, _| x != 500);
    assert_eq!(all(&slit), Overlap { is_covered: true, ignored: 1024, reads: all(&slit).reads });
    let hole = |x0: u32, y0: u32, side: u32| {
        maps(1024, 1024, 4, move |x, y| !((x0..x0 + side).contains(&x) && (y0..y0 + side).contains(&y)))
    };
    // Inside one pixel of 16×16 samples, and about a corner of four.
    assert!(all(&hole(514, 514, 5)).is_covered, "5×5 are 25");
    assert!(!all(&hole(514, 514, 6)).is_covered, "6×6 are 36");
    assert!(all(&hole(509, 509, 6)).is_covered, "but 9 in each of four");
}

#[test]
fn the_depth_estimation_buffer_keeps_the_farthest() {
    let mut buffer = DepthBuffer::default();
    buffer.clear([64, 64], 4);
    let write = |buffer: &mut DepthBuffer, r: PixelRect, depth: f32| {
        let touched = buffer.touched(r);
        buffer.write(touched, 1.0 / depth);
    };
    write(&mut buffer, rect([0, 40], [0, 20]), 10.0);
    write(&mut buffer, rect([30, 64], [10, 64]), 20.0);
    // A nearer one makes no entry nearer.
    write(&mut buffer, rect([0, 64], [0, 32]), 5.0);
    let row = |y: u32| [0, 1, 2, 3].map(|x| (1.0 / buffer.held([x, y])).round());
    assert_eq!([row(0), row(1)], [[10.0, 20.0, 20.0, 20.0]; 2]);
    // Nothing touches the first column below: nothing is nearer than anything there.
    assert_eq!([row(2), row(3)], [[0.0, 20.0, 20.0, 20.0]; 2]);
    let behind = |r: PixelRect, depth: f32| buffer.test(buffer.touched(r), 1.0 / depth).is_behind;
    assert!(behind(rect([0, 16], [0, 16]), 12.0), "behind the entry that it touches");
    assert!(!behind(rect([0, 20], [0, 16]), 12.0), "it touches one that reaches to 20");
    assert!(!behind(rect([0, 16], [0, 16]), 10.0), "as deep is not behind");
    assert!(behind(rect([0, 16], [32, 64]), 0.1), "where no occluder is, overlap decides");
}

#[test]
fn the_limit_follows_what_is_culled_and_what_occluders_cost() {
    let next = |culled: u32, occluders: u32| {
        let mut budget = Budget::first::<Solid>(1000, 100_000);
        let work = Work { in_view: 10_000, culled, occluders, tests: 10 };
        budget.adapt::<Solid>(work, 100_000).limit
    };
    // Shares of what is in view that are culled, and that are occluders.
    assert_eq!(next(4000, 1000), [1000, 1250], "few culled, with few occluders");
    assert_eq!(next(9000, 3000), [1000, 800], "many, with more than it takes");
    assert_eq!(next(9000, 2000), [1000, 1000], "many");
    assert_eq!(next(4000, 3000), [1000, 1000], "few, but more would cost too much");
    // Between 500 and 5 %.
    let mut budget = Budget::first::<Solid>(0, 100_000);
    assert_eq!(budget.limit, 1000);
    let most = Work { in_view: 10_000, culled: 0, occluders: 1, tests: 0 };
    (0..20).for_each(|_| _ = budget.adapt::<Solid>(most, 100_000));
    assert_eq!(budget.limit, 5000);
}

#[test]
fn culling_is_turned_off_where_it_does_not_pay_and_tried_again() {
    let mut budget = Budget::first::<Solid>(0, 100_000);
    let poor = Work { in_view: 10_000, culled: 100, occluders: 1000, tests: 50 };
    for frame in 1..=3 {
        assert_eq!(budget.adapt::<Solid>(poor, 100_000).is_on, frame < 3, "frame {frame}");
    }
    for frame in 0..30 {
        assert!(!budget.is_on(), "frame {frame} of the pause");
        budget.pause(Work { in_view: 10_000, ..Work::default() });
    }
    assert!(budget.is_on(), "tried again");
    assert!(!budget.adapt::<Solid>(poor, 100_000).is_on, "one more loss is enough");
    // Another view: a third more is drawn.
    budget.pause(Work { in_view: 14_000, ..Work::default() });
    assert!(budget.is_on());
    let rich = Work { in_view: 14_000, culled: 12_000, occluders: 500, tests: 50 };
    assert!(budget.adapt::<Solid>(rich, 100_000).is_on);
    assert!(budget.adapt::<Solid>(poor, 100_000).is_on, "what paid counts");
}

/// The method on a scene, with what it keeps.
struct Tried<S: Faces> {
    scene: Arc<Scene<S>>,
    params: Params,
    index: Databases<S>,
    memory: Memory,
}

impl<S: Faces> Tried<S> {
    fn new(scene: Arc<Scene<S>>, params: Params) -> Self {
        let index = <OcclusionMaps as Method<S>>::build(&scene, &params, None, &Quiet);
        let index = index.expect("nothing saved").expect("not cancelled");
        Self { scene, params, index, memory: Memory::default() }
    }
    /// What is drawn, ascending; what was recorded; and the maps.
    fn cull(&mut self, view: &View<S>) -> (Vec<PrimId>, Recorder<Evidence<S>>, Maps<S>) {
        let Self { scene, params, index, memory } = self;
        let frame = Frame { index, scene: &**scene, view, params, limit: None };
        let (mut maps, mut list, mut film) = (Maps::default(), DrawList::default(), Recorder::new(1 << 20));
        State::<S, OcclusionMaps>::begin(&mut maps, &frame);
        OcclusionMaps::cull(&frame, memory, &mut maps, &mut list, &mut film);
        (list.ascending(), film, maps)
    }
}

/// One segment a leaf, and so many of them as occluders.
fn flat_params(occluder_budget: u32, depth: DepthKind) -> Params {
    Params {
        leaf_primitives: 1,
        adapts: false,
        occluder_size: 0,
        occluder_budget,
        depth,
        ..Params::default()
    }
}

/// A flatland scene of segments, each an object, seen from the origin along the second axis.
fn segments(ends: &[[f32; 4]]) -> (Arc<Scene<Flat>>, View<Flat>) {
    let points: Vec<Vec2> = ends.iter().flat_map(|e| [vec2(e[0], e[1]), vec2(e[2], e[3])]).collect();
    let prims = (0..ends.len() as u32).map(|k| [2 * k, 2 * k + 1]).collect();
    let scene = Scene::new(Parts::<Flat>::simple("segments", points, prims)).expect("valid");
    let fov = std::f32::consts::FRAC_PI_2;
    let eye = Eye { position: Vec2::ZERO, target: Vec2::Y, up: Vec2::Y, fov, near: 0.01, far: 100.0 };
    (Arc::new(scene), View { eye, width: 512, height: 1 })
}

/// A committed scene with its first view.
fn flat_file(name: &str) -> (Arc<Scene<Flat>>, View<Flat>) {
    let path = format!("{}/scenes2d/{name}.json", env!("CARGO_MANIFEST_DIR"));
    let scene = crate::scene::load(&path, &LoadOptions::default(), &Quiet).expect("a committed scene");
    let crate::scene::AnyScene::Flat(scene) = scene else { panic!("it is flat") };
    let view = scene.paths()[0].views[0];
    (scene, view)
}

fn ids(ids: &[u32]) -> Vec<PrimId> {
    ids.iter().copied().map(PrimId).collect()
}

/// Section 4.3: "occlusion maps represent the fusion of small and possibly disjoint occluders".
#[test]
fn two_walls_hide_together_what_neither_hides() {
    let (scene, mut view) = flat_file("fusion");
    view.width = 512;
    for depth in [DepthKind::Estimation, DepthKind::Samples] {
        let drawn = |walls: u32| Tried::new(scene.clone(), flat_params(walls, depth)).cull(&view).0;
        let (both, one) = (drawn(2), drawn(1));
        assert!((2..6).all(|p| !both.contains(&PrimId(p))), "{depth:?}: both hide the box, {both:?}");
        assert!((2..6).any(|p| one.contains(&PrimId(p))), "{depth:?}: one does not, {one:?}");
    }
}

/// Section 5.2.2 as printed would cull what is as deep as itself.
#[test]
fn a_flat_occluder_does_not_cull_itself() {
    let (scene, view) = segments(&[[-1.0, 5.0, 1.0, 5.0], [-20.0, 50.0, 20.0, 50.0]]);
    for depth in [DepthKind::Estimation, DepthKind::Samples, DepthKind::Plane] {
        let (drawn, ..) = Tried::new(scene.clone(), flat_params(1, depth)).cull(&view);
        assert_eq!(drawn, ids(&[0, 1]), "{depth:?}");
    }
}

/// Section 5.3.2 makes an occluder of a wall that crosses the Z plane: what of it lies beyond must not hide
/// what stands before it there.
#[test]
fn occluders_end_at_the_z_plane() {
    // The wall stands at depths 9.8 to 11.1 where the segment at 6.4 is seen, which is beyond Z = 6.
    let (scene, view) = segments(&[[-2.0, 2.0, 8.0, 12.0], [3.9, 6.4, 4.1, 6.4], [-3.0, 6.0, -3.2, 6.2]]);
    let mut tried = Tried::new(scene, flat_params(1, DepthKind::Plane));
    let (drawn, film, maps) = tried.cull(&view);
    let plane = film.notes.iter().find_map(|n| if let Evidence::Plane(z) = n { Some(*z) } else { None });
    assert_eq!(plane, Some(6.0), "the first leaf that does not fit sets it");
    assert!(drawn.contains(&PrimId(1)), "{drawn:?}");
    // The wall covers columns from slope −1 to 2/6, where it crosses the plane: 512 · (1 + 1/3) / 2 = 341.3.
    let covered =
        maps.opacity().samples()[0] - maps.opacity().cells(0).map(|c| maps.opacity().black(c)).sum::<u32>();
    assert_eq!(covered, 341);
}

/// Section 5.2.2: an occluder is as deep as its farthest corner, whatever of it is near.
#[test]
fn what_stands_before_the_far_end_of_a_wall_is_drawn() {
    let (scene, view) = segments(&[[-2.0, 2.0, 8.0, 12.0], [3.9, 6.4, 4.1, 6.4]]);
    for depth in [DepthKind::Estimation, DepthKind::Samples] {
        // The wall, which looks larger, and not the segment.
        let params = Params { selection: Selection::Size, ..flat_params(1, depth) };
        let (drawn, ..) = Tried::new(scene.clone(), params).cull(&view);
        assert_eq!(drawn, ids(&[0, 1]), "{depth:?}");
    }
}

/// One box a wall makes one depth for all of it; pieces are known better.
#[test]
fn a_wall_in_pieces_hides_more() {
    let wall = |pieces: u32| {
        let at = |k: u32| [-2.0 + 10.0 * k as f32 / pieces as f32, 2.0 + 10.0 * k as f32 / pieces as f32];
        let piece = |k: u32| [at(k)[0], at(k)[1], at(k + 1)[0], at(k + 1)[1]];
        let mut ends: Vec<[f32; 4]> = (0..pieces).map(piece).collect();
        // At slope −0.5, where the wall stands at depth 2.67.
        ends.push([-3.0, 6.0, -3.0, 6.5]);
        let (scene, view) = segments(&ends);
        let (drawn, ..) = Tried::new(scene, flat_params(pieces, DepthKind::Estimation)).cull(&view);
        drawn.contains(&PrimId(pieces))
    };
    assert!(wall(1), "the wall's farthest corner is at 12");
    assert!(!wall(4), "its piece ends at 4.5");
}

/// Of the nearest leaves those that fit: which become occluders.
fn taken<S: Faces>(tried: &mut Tried<S>, view: &View<S>) -> Vec<PrimId> {
    let (_, film, _) = tried.cull(view);
    let leaves = film.notes.iter().filter_map(|n| match n {
        Evidence::Chosen(c) if c.is_taken => Some(c.candidate.node),
        _ => None,
    });
    leaves.flat_map(|leaf| tried.index.tree().prims_below(leaf)).copied().collect()
}

/// Figure 5: the distance criterion takes what is near, and misses A and B, which are far and large.
#[test]
fn figure_5_of_the_paper() {
    let (scene, mut view) = flat_file("figure5");
    view.width = 512;
    // A and B, two segments each.
    let far: Vec<PrimId> = ids(&[120, 121, 122, 123]);
    for selection in [Selection::Distance, Selection::Size, Selection::Visible, Selection::Grid] {
        let params = Params { selection, ..flat_params(100, DepthKind::Samples) };
        let mut tried = Tried::new(scene.clone(), params);
        if selection == Selection::Visible {
            // What was seen is known after a frame, of occluders too, as these are tested by their samples.
            tried.cull(&view);
        }
        let taken = taken(&mut tried, &view);
        let has_far = far.iter().filter(|p| taken.contains(p)).count();
        assert!(taken.len() <= 100, "{selection:?}");
        if selection == Selection::Distance {
            assert_eq!((taken.len(), has_far), (100, 0), "A and B are missed, and leave a hole");
        } else {
            assert_eq!(has_far, 4, "{selection:?} takes A and B: {taken:?}");
        }
    }
}

/// Section 5.3.2: lists are made once, are the same when they are restored, and fit nothing else.
#[test]
fn saved_lists_are_those_that_were_made_and_fit_nothing_else() {
    let (scene, view) = flat_file("figure5");
    let params = Params { selection: Selection::Grid, grid: 7, ..flat_params(50, DepthKind::Samples) };
    let restore = |scene: &Arc<Scene<Flat>>, params: &Params, bytes: &[u8]| {
        <OcclusionMaps as Method<Flat>>::build(scene, params, Some(bytes), &Quiet)
    };
    let mut made = Tried::new(scene.clone(), params);
    let saved = crate::index::Hierarchy::<Flat>::save(&made.index).expect("there is something to save");
    let index = restore(&scene, &params, &saved).expect("it fits").expect("not cancelled");
    assert!(index.grid() == made.index.grid());
    assert_eq!(crate::index::Hierarchy::<Flat>::save(&index), Some(saved.clone()));
    let mut again = Tried { scene: scene.clone(), params, index, memory: Memory::default() };
    assert_eq!(made.cull(&view).0, again.cull(&view).0);
    // What a frame does with the lists does not matter to them.
    let later = Params { occluder_budget: 3, depth: DepthKind::Estimation, ..params };
    assert!(restore(&scene, &later, &saved).is_ok());
    let refused = |params: &Params, bytes: &[u8]| restore(&scene, params, bytes).err().expect("refused");
    let other = Params { grid: 8, ..params };
    assert!(refused(&other, &saved).starts_with("it was made with grid=7 leaf-primitives=1"));
    let without = Params { selection: Selection::Distance, ..params };
    assert_eq!(refused(&without, &saved), "only what selection=grid looks up is kept");
    assert_eq!(crate::index::Hierarchy::<Flat>::save(&Tried::new(scene.clone(), without).index), None);
    for at in (0..saved.len()).step_by(saved.len() / 60) {
        let mut bad = saved.clone();
        bad[at] ^= 4;
        assert!(!refused(&params, &bad).contains('\n'));
        assert!(!refused(&params, &saved[..at]).is_empty(), "cut at {at}");
    }
    let (elsewhere, _) = flat_file("holes");
    assert_eq!(restore(&elsewhere, &params, &saved).err().as_deref(), Some("it was made for another scene"));
}

/// What is culled through a hole that is ignored is presumed, and what is not so is proven.
#[test]
fn small_holes_are_presumed_not_proven() {
    // A wall with a gap of 3 of 512 samples, and something behind it that shows through.
    let (scene, view) = segments(&[
        [-5.0, 4.0, -0.01, 4.0],
        [0.01, 4.0, 5.0, 4.0],
        [-1.0, 8.0, 1.0, 8.0],
        [2.0, 8.0, 3.0, 8.0],
    ]);
    let with = |t: f32| {
        let params =
            Params { opacity_threshold: t, map_resolution: 64, ..flat_params(2, DepthKind::Estimation) };
        let (drawn, film, _) = Tried::new(scene.clone(), params).cull(&view);
        let verdicts: Vec<Verdict> =
            film.events.iter().filter_map(Event::verdict).filter(|v| *v != Verdict::Partial).collect();
        (drawn, verdicts)
    };
    let (drawn, verdicts) = with(1.0);
    assert_eq!(drawn, ids(&[0, 1, 2]), "what shows through the gap is drawn");
    assert!(!verdicts.contains(&Verdict::Presumed));
    let (drawn, verdicts) = with(0.5);
    assert_eq!(drawn, ids(&[0, 1]), "the gap is ignored");
    assert!(verdicts.contains(&Verdict::Presumed), "{verdicts:?}");
    assert!(<OcclusionMaps as Method<Flat>>::is_conservative(&Params::default()));
    let guessed = Params { opacity_threshold: 0.9, ..Params::default() };
    assert!(!<OcclusionMaps as Method<Flat>>::is_conservative(&guessed));
}

/// Section 5.3.1: a clock on the wall is no occluder, nor is what is small.
#[test]
fn the_database_leaves_out_what_is_small_and_what_is_redundant() {
    // Half a wall, a clock before it, something beside it, before it by more than 2 %, behind it, something
    // small, and the other half.
    let (scene, _) = segments(&[
        [-5.0, 0.0, 0.0, 0.0],
        [0.0, 0.05, 1.0, 0.05],
        [6.5, 0.05, 7.5, 0.05],
        [-2.0, 2.0, -1.0, 2.0],
        [2.0, -0.05, 3.0, -0.05],
        [20.0, 20.0, 20.01, 20.0],
        [0.0, 0.0, 5.0, 0.0],
    ]);
    let mut parts = (*scene).clone().into_parts();
    parts.faces = (1..6).map(|k| Face { corners: vec![2 * k, 2 * k + 1], prims: vec![PrimId(k)] }).collect();
    // The wall is in two pieces, neither of which is redundant for being on it.
    parts.faces.push(Face { corners: vec![0, 13], prims: ids(&[0, 6]) });
    let scene = Arc::new(Scene::new(parts).expect("valid"));
    let params = Params { occluder_size: 5, ..flat_params(10, DepthKind::Estimation) };
    let tried = Tried::new(scene, params);
    let counts = tried.index.counts();
    assert_eq!((counts.kept, counts.small, counts.redundant, counts.complex), (5, 1, 1, 0), "{counts:?}");
    let dropped = |p: u32| {
        let tree = tried.index.tree();
        let leaf = (0..tree.nodes().len() as u32)
            .map(crate::geometry::NodeId)
            .find(|&n| tree.nodes()[n.at()].is_leaf() && tree.prims_below(n) == [PrimId(p)]);
        !tried.index.has_occluders(leaf.expect("a leaf a segment"))
    };
    let all = [0, 1, 2, 3, 4, 5, 6].map(dropped);
    assert_eq!(all, [false, true, false, false, false, true, false]);
}

/// The exact forms over all of a building's path: nothing that is seen is left out, with any depth or choice.
#[test]
fn a_building_is_whole_with_every_depth_and_choice() {
    let crate::scene::AnyScene::Solid(scene) =
        crate::scene::load("generate:building?polygons=3000", &LoadOptions::default(), &Quiet).expect("made")
    else {
        panic!("a building is in space")
    };
    let path = &scene.paths()[0];
    for depth in [DepthKind::Estimation, DepthKind::Plane, DepthKind::Samples] {
        for selection in Selection::ALL.iter().copied() {
            let params =
                Params { depth, selection, occluder_budget: 300, adapts: false, ..Params::default() };
            let (mut tried, mut culled) = (Tried::new(scene.clone(), params), 0);
            for view in path.views.iter().step_by(40) {
                let view = View { width: 160, height: 120, ..*view };
                let (drawn, ..) = tried.cull(&view);
                let all = crate::raster::render(&scene, &view, scene.live());
                assert_eq!(crate::raster::render(&scene, &view, &drawn), all, "{depth:?}, {selection:?}");
                culled += scene.live().len() - drawn.len();
            }
            assert!(culled > scene.live().len(), "{depth:?}, {selection:?}: {culled} culled");
        }
    }
}

/// Candidates in order, as far as they can be within a limit; those that stay first.
fn within(mut all: Vec<Candidate>, limit: u32, key: impl Fn(&Candidate) -> (u8, f32)) -> Vec<Candidate> {
    all.sort_by(|a, b| {
        let (a_key, b_key) = (key(a), key(b));
        a_key.0.cmp(&b_key.0).then(a_key.1.total_cmp(&b_key.1)).then(a.node.cmp(&b.node))
    });
    let mut sum = 0;
    let end = all.iter().position(|c| {
        sum += c.polygons;
        sum as f32 > 1.25 * limit as f32
    });
    all.truncate(end.map_or(all.len(), |at| at + 1));
    all.sort_by_key(|c| !c.is_kept);
    all
}

/// As far as is looked, what is found is what all in order would be: with any choice, limit and memory.
fn chosen_in_order<S: Faces>(scene: &Arc<Scene<S>>, views: &[View<S>], dice: &mut Dice) -> usize {
    let params = Params { leaf_primitives: 4, occluder_size: 0, ..Params::default() };
    let Tried { index, .. } = Tried::new(scene.clone(), params);
    let nodes = index.tree().nodes();
    let mut taken = 0;
    for (round, view) in views.iter().enumerate() {
        let (frustum, projection) = (view.frustum(), view.projection());
        let mut flags = || (0..nodes.len()).map(|_| dice.below(3) == 0).collect::<Vec<_>>();
        let (occluders, drawn, seen) = (flags(), flags(), flags());
        let angles: Vec<f32> = seen.iter().map(|s| if *s { dice.between(0.0, 1.0) } else { 0.0 }).collect();
        let order = match round % 5 {
            4 => Order::Nearest,
            k => Order::By([Selection::Distance, Selection::Size, Selection::Visible, Selection::Grid][k]),
        };
        let known = Known { occluders: &occluders, drawn: &drawn, angles: &angles };
        let choosing =
            Choosing { index: &index, view, frustum: &frustum, projection: &projection, order, known };
        let key = |c: &Candidate| match order {
            Order::Nearest => (1, -nearest_depth(&projection, index.occluder_bounds(c.node), view.eye.near)),
            Order::By(Selection::Size) => (1, -c.size),
            Order::By(Selection::Visible) if drawn[c.node.at()] => (0, c.distance),
            Order::By(Selection::Grid) if c.angle > 0.0 => (0, -c.angle),
            Order::By(_) => (1, c.distance),
        };
        let limit = [0, 7, 50, 400, 1_000_000][dice.below(5) as usize];
        let mut last = (dice.below(2) == 0).then(|| dice.between(-1.0, 60.0));
        let found = choosing.candidates(limit, &mut last);
        assert_eq!(found, choosing.candidates(limit, &mut last));
        let all = choosing.candidates(1_000_000, &mut None);
        assert_eq!(all.len(), choosing.count() as usize);
        let is_in_view = |at: &usize| {
            index.has_occluders(NodeId(*at as u32))
                && nodes[*at].children().is_none()
                && !matches!(
                    frustum.test(&nodes[*at].bounds, Frustum::<S::Vector>::ALL),
                    FrustumTest::Outside(_)
                )
        };
        assert_eq!(all.len(), (0..nodes.len()).filter(is_in_view).count());
        assert_eq!(found, within(all, limit, key));
        taken += found.len();
    }
    taken
}

#[test]
fn occluders_are_chosen_in_order() {
    let mut dice = Dice::new(151);
    let crate::scene::AnyScene::Solid(scene) =
        crate::scene::load("generate:city?polygons=4000", &LoadOptions::default(), &Quiet).expect("made")
    else {
        panic!("a city is in space")
    };
    let views: Vec<View<Solid>> = scene.paths()[0].views.iter().copied().step_by(3).collect();
    let mut taken = chosen_in_order(&scene, &views, &mut dice);
    let (scene, view) = flat_file("forest");
    let views: Vec<View<Flat>> = (0..60)
        .map(|_| {
            let mut view = view;
            let bounds = scene.bounds();
            let mut at =
                || vec2(dice.between(bounds.min.x, bounds.max.x), dice.between(bounds.min.y, bounds.max.y));
            (view.eye.position, view.eye.target) = (at(), at());
            view
        })
        .collect();
    taken += chosen_in_order(&scene, &views, &mut dice);
    assert!(taken > 2_000, "{taken}");
}

/// What is counted of a frame is what it draws and leaves out, primitive by primitive.
#[test]
fn counts_of_a_frame_are_those_of_its_list() {
    let crate::scene::AnyScene::Solid(scene) =
        crate::scene::load("generate:city?polygons=4000", &LoadOptions::default(), &Quiet).expect("made")
    else {
        panic!("a city is in space")
    };
    let settings = crate::method::Settings::of(&[("adapt", "false"), ("occluder-budget", "500")]);
    let mut mapper = Mapper::new(&scene, &settings, &Quiet).expect("fine").expect("not cancelled");
    let mut alone = 0;
    for view in scene.paths()[0].views.iter().step_by(20) {
        let (list, counted) = mapper.cull(view);
        let mut culled: Vec<PrimId> = mapper.culled().collect();
        assert_eq!(counted.hidden + counted.presumed, culled.len());
        assert_eq!(counted.in_view, culled.len() + list.prims.len());
        let occluders = mapper.occluders();
        alone += culled.iter().filter(|p| occluders.contains(p)).count();
        culled.extend(&list.prims);
        culled.sort_unstable();
        culled.dedup();
        assert_eq!(culled.len(), counted.in_view, "each once");
    }
    assert!(alone > 100, "{alone} of occluders alone");
}

/// What was drawn in one frame, and lies under a node that is culled in the next, is not first in the third.
#[test]
fn what_is_culled_as_a_whole_was_not_drawn() {
    let (scene, view) = flat_file("forest");
    let params = Params { selection: Selection::Visible, ..flat_params(100, DepthKind::Samples) };
    let mut tried = Tried::new(scene, params);
    tried.cull(&view);
    let before = tried.memory.drawn.iter().filter(|d| **d).count();
    let mut away = view;
    away.eye.target = view.eye.position * 2.0 - view.eye.target;
    let (drawn, ..) = tried.cull(&away);
    let after = tried.memory.drawn.iter().filter(|d| **d).count();
    assert!(
        before > 0 && after <= drawn.len(),
        "{before}, then {after} leaves of {} that are drawn",
        drawn.len()
    );
}

/// The table of Section 5.4's example: 25 of 16 × 16 samples.
#[test]
fn the_table_of_thresholds_is_that_of_section_5_4() {
    let scene = crate::scene::samples::soup::<Solid>(3, 50);
    let params = |t: f32| Params { opacity_threshold: t, map_resolution: 64, ..Params::default() };
    let view = View { width: 1024, height: 1024, ..crate::scene::framing_view(&scene.bounds(), 64, 64) };
    let rows = |t: f32| {
        let tried = Tried::new(scene.clone(), params(t));
        let Tried { scene, params, index, .. } = &tried;
        let frame = Frame { index, scene: &**scene, view: &view, params, limit: None };
        <OcclusionMaps as Shown<Solid>>::derived(&frame).expect("a table")
    };
    let table = rows(0.902_343_75);
    let words = |row: usize| table.rows[row].iter().map(String::as_str).collect::<Vec<_>>();
    assert_eq!(words(1), ["0", "64 × 64", "256", "0.9023"]);
    assert_eq!(words(2), ["1", "32 × 32", "1024", "0.9756"]);
    assert_eq!(words(3), ["2", "16 × 16", "4096", "0.9939"]);
    assert!(table.note.contains("n = 25:") && table.note.contains("(3 + O(k)) / 4"), "{}", table.note);
    assert!(table.rows.iter().all(|row| row.len() == table.rows[0].len()));
    // With a threshold of 1 no sample may be black; one of 256 may at 0.9961.
    let exact = rows(1.0);
    assert!(exact.note.contains("n = 0:") && exact.note.contains("0.9961"), "{}", exact.note);
    assert!(exact.rows[1..].iter().all(|row| row[3] == "1.0000"));
}

/// In space an entry of the depth estimation buffer is a face at its depth.
#[test]
fn the_depth_estimation_buffer_is_a_relief_before_the_eye() {
    let crate::scene::AnyScene::Solid(scene) =
        crate::scene::load("generate:building?polygons=3000", &LoadOptions::default(), &Quiet).expect("made")
    else {
        panic!("a building is in space")
    };
    let view = View { width: 160, height: 120, ..scene.paths()[0].views[0] };
    let pairs = [("depth", "estimation"), ("adapt", "false"), ("occluder-budget", "300")];
    let entry = <Solid as crate::culling::Methods>::method("occlusion-maps").expect("a method");
    let run = entry.ready(&scene, &crate::method::Settings::of(&pairs), &Quiet).expect("fine");
    let film = run.expect("not cancelled").record(&view, usize::MAX).film;
    let mut to = Drawing::default();
    film.explain(film.events().len(), &mut to);
    let mut depths = Vec::new();
    for item in to.items.iter().filter(|i| i.role == crate::drawing::Role::Evidence) {
        let crate::drawing::Mark::Area(corners) = &item.mark else { continue };
        let of = |p: glam::Vec3| (p - view.eye.position).dot(view.eye.forward());
        let depth = of(corners[0]);
        assert!(corners.iter().all(|p| (of(*p) - depth).abs() < 1e-3 * depth), "it faces the eye");
        depths.push(depth);
    }
    // Those that the notes wrote.
    let written = crate::method::notes::<Solid, OcclusionMaps>(&*film).filter_map(|(_, note)| match note {
        Evidence::Written(_, _, farthest) => Some(1.0 / farthest),
        _ => None,
    });
    let written: Vec<f32> = written.collect();
    assert!(!depths.is_empty(), "there is a relief");
    assert!(depths.iter().all(|d| written.iter().any(|w| (w - d).abs() < 1e-3 * d)), "{depths:?}");
    let occluders = to.items.iter().filter(|i| i.role == crate::drawing::Role::Occluder);
    assert!(occluders.count() > 100, "occluders are black, triangle by triangle");
}
