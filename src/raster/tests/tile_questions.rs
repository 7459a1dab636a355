//! Questions one by one: what is heard of them, and groups that are drawn one after the other.

use std::sync::Arc;

use super::tiles::{ROUNDS, drawn, flat_box, flat_mixed, flat_view, image, mixed, owns_nothing, random_box};
use super::tiles::{flat_size, random_view, sizes, straight_line};
use super::*;
use crate::geometry::ObjectId;
use crate::geometry::{Aabb, Footprint, Vector, project_box};
use crate::scene::{Motion, Pose};

/// Keeps what it hears.
#[derive(Default)]
struct Heard {
    reads: Vec<Read>,
    refreshed: Vec<PyramidCell>,
}

impl Hears for Heard {
    const LISTENS: bool = true;
    fn reads(&mut self, read: Read) {
        self.reads.push(read);
    }
    fn refreshes(&mut self, cell: PyramidCell) {
        self.refreshed.push(cell);
    }
}

struct Deaf;

impl Hears for Deaf {
    const LISTENS: bool = false;
    fn reads(&mut self, _: Read) {
        unreachable!("nobody listens");
    }
    fn refreshes(&mut self, _: PyramidCell) {}
}

fn ends<V: Vector>(bounds: &Aabb<V>) -> [[f32; 3]; 2] {
    let widen = |v: V| [0, 1, 2].map(|a| if a < V::AXES { v.get(a) } else { 0.0 });
    [widen(bounds.min), widen(bounds.max)]
}

/// How many questions were answered, and how: visible, hidden, and with tiles that were looked at closer.
#[derive(Debug, Default)]
struct Counted {
    visible: usize,
    hidden: usize,
    closer: usize,
    blocks: usize,
    /// Tiles of which something at a depth shows at a part of the pixels.
    partly_open: usize,
}

/// Whoever listens changes nothing; what changes is what is heard; the last read is the answer; and what is
/// hidden owns no pixel.
fn ask<S: Drawable>(
    dice: &mut Dice,
    [own, more]: [Aabb<S::Vector>; 2],
    view: &View<S>,
    tiles: &mut Tiles,
    truth: &Target,
    counted: &mut Counted,
) {
    let whole = if dice.below(3) == 0 { own.union(more) } else { own };
    let projection = view.projection();
    let place = |b: &Aabb<S::Vector>| {
        project_box(&projection, b, view.eye.near, view.eye.far, view.width, view.height)
    };
    let (Footprint::Seen(image), Footprint::Seen(all)) = (place(&own), place(&whole)) else { return };
    let exact = dice.below(3) > 0;
    let boxes = (dice.below(4) > 0).then(|| [ends(&own), ends(&whole)]);
    let question = Question { pixels: image.pixels, nearest: all.nearest, boxes, exact };
    let (mut before, mut other, mut heard) = (tiles.clone(), tiles.clone(), Heard::default());
    let is_hidden = tiles.hides(question, Isa::best(), &mut heard);
    assert_eq!(other.hides(question, Isa::Portable, &mut Deaf), is_hidden, "who listens decides nothing");
    assert!(other == *tiles, "nor changes anything");
    heard.refreshed.iter().for_each(|&cell| before.refresh(cell, Isa::best()));
    assert!(before == *tiles, "what changes is heard: {:?}", heard.refreshed);
    for read in &heard.reads {
        assert_eq!(read.outcome == Outcome::Behind, read.nearest < read.held, "{read:?}");
        assert!(!read.cell.pixels(view.width, view.height).intersection(image.pixels).is_empty(), "{read:?}");
    }
    let shown = heard.reads.iter().position(|r| r.outcome == Outcome::Shows);
    assert_eq!(shown, (!is_hidden).then(|| heard.reads.len().wrapping_sub(1)), "{:?}", heard.reads);
    let is_tile = |c: &&PyramidCell| c.level == PyramidCell::TILE;
    counted.closer += heard.refreshed.iter().filter(is_tile).count();
    counted.blocks += heard.refreshed.iter().filter(|c| !is_tile(c)).count();
    if is_hidden {
        counted.hidden += 1;
        // Of the whole what is drawn where the box itself is.
        if whole == own {
            owns_nothing(dice, &own, view, truth);
        }
    } else {
        counted.visible += 1;
    }
}

/// The pixels of a tile at which something shows are those at which it is not behind the image.
fn opens_where_the_image_does<S: Drawable>(
    dice: &mut Dice,
    view: &View<S>,
    tiles: &Tiles,
    truth: &Target,
    counted: &mut Counted,
) {
    for _ in 0..12 {
        let [x, y] = tiles.size(PyramidCell::TILE).map(|n| dice.below(n));
        let tile = PyramidCell { level: PyramidCell::TILE, x: x as u16, y: y as u16 };
        let PixelRect { x0, x1, y0, y1 } = tile.pixels(view.width, view.height);
        let at = |x: u32, y: u32| truth.depth[(y * view.width + x) as usize];
        // As deep as one of its pixels, or a little nearer or farther.
        let depth = at(x0 + dice.below(x1 - x0), y0 + dice.below(y1 - y0));
        let nearest = depth * [1.0, 1.0 - f32::EPSILON, 1.0 + f32::EPSILON, 0.9, 1.2][dice.below(5) as usize];
        // What comes no nearer than the far plane is not asked for.
        let nearest = nearest.max(1.0 / view.eye.far);
        let (mut among, mut want) = (0, 0);
        for (x, y) in (y0..y1).flat_map(|y| (x0..x1).map(move |x| (x, y))) {
            let bit = u32::from(dice.below(4) > 0) << ((y - y0) * 8 + x - x0);
            among |= bit;
            want |= if nearest >= at(x, y) { bit } else { 0 };
        }
        let [open, may] = tiles.open_bounds(tile, nearest, among);
        assert_eq!([open & want, may & want], [open, want], "{tile:?} at {nearest}: bounds");
        for isa in [Isa::best(), Isa::Portable] {
            let mut tiles = tiles.clone();
            assert_eq!(tiles.open(tile, nearest, among, isa), want, "{tile:?} at {nearest}, {isa:?}");
        }
        counted.partly_open += usize::from(want != 0 && want != among);
    }
}

/// The groups of a scene one after the other, with questions between them, which see what is drawn so far.
fn by_groups<S: Drawable>(
    scene: &Scene<S>,
    view: &View<S>,
    dice: &mut Dice,
    mut boxes: impl FnMut(&mut Dice) -> [Aabb<S::Vector>; 2],
    counted: &mut Counted,
) {
    let groups: Vec<&[PrimId]> = scene.live().chunks(60).collect();
    let clusters = Clusters::new(scene, ONE_SIDED, groups.iter().copied());
    let mut tiles = Tiles::default();
    tiles.clear(view, true);
    let (mut target, mut fates) = (Target::new(view), Vec::new());
    let options = Options { surfaces: ONE_SIDED, ..Options::default() };
    for (number, group) in groups.iter().enumerate() {
        // Some without the clusters that are hidden, which changes no pixel.
        let (how, first) = (How { one_sided: true, skipped: &[], tested: dice.below(2) == 0 }, fates.len());
        tiles.draw_groups(&clusters, &[(number, how)], Isa::best(), &mut fates);
        for &(prim, fate) in &fates[first..] {
            // One that is seen edge-on faces neither way, and is told to face away.
            let is_told = fate == if how.tested { Fate::Hidden } else { Fate::Away };
            assert!(!scene.faces_away(prim, view.eye.position) || is_told, "{prim:?} was {fate:?}");
        }
        S::draw(&mut target, scene, view, group, &options);
        for _ in 0..12 {
            let boxes = boxes(dice);
            ask(dice, boxes, view, &mut tiles, &target, counted);
        }
        opens_where_the_image_does(dice, view, &tiles, &target, counted);
    }
    assert_eq!(tiles.depths(Isa::best()), target.depth, "as the image");
    // What shows in the end may have shown when it was drawn, and what faces away was never drawn.
    let shows = visible(&target);
    for (prim, fate) in fates {
        let shows = shows.binary_search(&prim).is_ok();
        assert!(!shows || fate == Fate::Shown, "{prim:?} shows, and was {fate:?}");
    }
}

#[test]
fn questions_are_heard_whole() {
    let (mut dice, mut counted) = (Dice::new(81), Counted::default());
    for round in 0..ROUNDS / 2 {
        let scene = mixed(&mut dice, 120);
        let (width, height) = sizes(round);
        let view = random_view(&mut dice, width, height);
        let boxes = |dice: &mut Dice| [random_box(dice), random_box(dice)];
        by_groups(&scene, &view, &mut dice, boxes, &mut counted);
    }
    let Counted { visible, hidden, closer, blocks, partly_open } = counted;
    assert!(visible > 500 && hidden > 500 && closer > 100 && blocks > 10, "{counted:?}");
    assert!(partly_open > 500, "{counted:?}");
}

#[test]
fn questions_of_flatland_are_heard_whole() {
    let (mut dice, mut counted) = (Dice::new(82), Counted::default());
    for round in 0..2 * ROUNDS {
        let (width, _) = flat_size(round);
        let scene = flat_mixed(&mut dice, 100, 1.0);
        let view = flat_view(&mut dice, width, 1.0);
        let boxes = |dice: &mut Dice| [flat_box(dice, 1.0), flat_box(dice, 1.0)];
        by_groups(&scene, &view, &mut dice, boxes, &mut counted);
    }
    let Counted { visible, hidden, closer, .. } = counted;
    assert!(visible > 500 && hidden > 500 && closer > 100, "{counted:?}");
}

/// Small groups, some of them, with what fills no vector left waiting in between. Returns how many were told
/// not to show.
fn gathered<S: Drawable>(scene: &Scene<S>, view: &View<S>, dice: &mut Dice) -> usize {
    let groups: Vec<&[PrimId]> = scene.live().chunks(7).collect();
    let clusters = Clusters::new(scene, ONE_SIDED, groups.iter().copied());
    let some: Vec<usize> = (0..groups.len()).filter(|_| dice.below(3) > 0).collect();
    let of = |isa: Isa| {
        let mut tiles = Tiles::default();
        tiles.clear(view, true);
        some.iter().for_each(|&group| tiles.gather(&clusters, group, true, isa));
        let mut shown: Vec<PrimId> = tiles.settle(&clusters, isa).collect();
        shown.sort_unstable();
        shown.dedup();
        (tiles, shown)
    };
    let (mut tiles, shown) = of(Isa::best());
    assert!(of(Isa::Portable) == (tiles.clone(), shown.clone()), "on every instruction set");
    let mut target = Target::new(view);
    let options = Options { surfaces: ONE_SIDED, ..Options::default() };
    some.iter().for_each(|&group| {
        let drawn: Vec<PrimId> = clusters.prims_of(group).collect();
        S::draw(&mut target, scene, view, &drawn, &options);
    });
    tiles.assert_claims(&target.depth);
    assert_eq!(tiles.depths(Isa::best()), target.depth, "as the image");
    let seen = visible(&target);
    assert!(seen.iter().all(|p| shown.binary_search(p).is_ok()), "{seen:?} are seen, {shown:?} may show");
    some.iter().flat_map(|&g| clusters.prims_of(g)).filter(|p| shown.binary_search(p).is_err()).count()
}

#[test]
fn what_waits_is_drawn_in_the_end() {
    let (mut dice, mut hidden) = (Dice::new(84), 0);
    for round in 0..ROUNDS {
        let scene = mixed(&mut dice, 150);
        let (width, height) = sizes(round);
        let view = random_view(&mut dice, width, height);
        hidden += gathered(&scene, &view, &mut dice);
    }
    assert!(hidden > 500, "{hidden} do not show");
    for round in 0..2 * ROUNDS {
        let (width, _) = flat_size(round);
        let scene = flat_mixed(&mut dice, 100, 1.0);
        let view = flat_view(&mut dice, width, 1.0);
        gathered(&scene, &view, &mut dice);
    }
}

/// The same with a third of it still, and the rest in two objects that come from far away and turn and go:
/// what is known of where they were at first, and of how they faced, says nothing of where they are.
fn moving<S: Space>(dice: &mut Dice, scene: Scene<S>) -> Scene<S> {
    let mut parts = scene.into_parts();
    let pose = |dice: &mut Dice, far: f32| {
        let (angle, axis) = (dice.between(-3.0, 3.0), glam::Vec3::new(0.0, 0.0, 1.0));
        let axis =
            if S::CORNERS == 2 { axis } else { (axis + Vec3::Y * dice.between(-1.0, 1.0)).normalize() };
        let translation = [dice.between(-2.0, 2.0) + far, dice.between(-2.0, 2.0) + far, 0.0];
        Pose { rotation: glam::Quat::from_axis_angle(axis, angle).to_array(), translation }
    };
    parts.objects.resize(3, parts.objects[0].clone());
    for object in &mut parts.objects[1..] {
        object.motion = Some([90.0, 0.0, 0.0, 0.0].map(|far| pose(dice, far)).into());
    }
    for object in &mut parts.prim_object {
        *object = ObjectId(dice.below(3));
    }
    Scene::new(parts).expect("valid")
}

/// How many primitives showed.
fn follows<S: Drawable>(scene: Scene<S>, view: &View<S>, surfaces: Surfaces) -> usize {
    let mut motion = Motion::new(&Arc::new(scene));
    let rest = motion.at(0);
    // Groups that hold some of each object, then one for each of them.
    let of =
        |object| rest.live().iter().copied().filter(|&p| rest.object_of(p) == ObjectId(object)).collect();
    let objects: [Vec<PrimId>; 3] = [0, 1, 2].map(of);
    let mixed: Vec<&[PrimId]> = rest.live().chunks(40).collect();
    let (mut of_some, mut of_one) = (
        Clusters::new(&rest, surfaces, mixed),
        Clusters::new(&rest, surfaces, objects.iter().map(Vec::as_slice)),
    );
    let mut shown = 0;
    for frame in [2, 1, 3] {
        let scene = motion.at(frame);
        let truth = image(&scene, view, surfaces);
        for clusters in [&mut of_some, &mut of_one] {
            clusters.follow(&scene);
            let mut tiles = Tiles::default();
            tiles.clear(view, true);
            tiles.draw(clusters, surfaces.one_sided, Isa::best());
            tiles.assert_claims(&truth.depth);
            assert_eq!(tiles.depths(Isa::best()), truth.depth, "frame {frame}");
        }
        shown += visible(&truth).len();
    }
    shown
}

/// Clusters that follow a motion draw the image of the scene as it is then.
#[test]
fn clusters_follow_what_moves() {
    let (mut dice, mut shown) = (Dice::new(85), [0; 2]);
    for round in 0..ROUNDS {
        let surfaces = if round % 2 == 0 { ONE_SIDED } else { BOTH_SIDES };
        let scene = mixed(&mut dice, 150);
        let scene = moving(&mut dice, scene);
        let (width, height) = sizes(round);
        shown[0] += follows(scene, &random_view(&mut dice, width, height), surfaces);
        let scene = flat_mixed(&mut dice, 60, 1.0);
        let scene = moving(&mut dice, scene);
        shown[1] += follows(scene, &flat_view(&mut dice, flat_size(round).0, 1.0), surfaces);
    }
    assert!(shown.iter().all(|n| *n > 100), "{shown:?} showed");
}

/// A group of what is drawn already: nothing is drawn again, and nothing more is said of it.
#[test]
fn what_is_drawn_already_is_left_out() {
    let mut dice = Dice::new(83);
    for round in 0..10 {
        let scene = mixed(&mut dice, 100);
        let (width, height) = sizes(round);
        let view = random_view(&mut dice, width, height);
        let mut tiles = drawn(&scene, &view, ONE_SIDED, Isa::best());
        let before = tiles.clone();
        let clusters = Clusters::new(&scene, ONE_SIDED, [scene.live()]);
        let mut skipped = vec![true; scene.prim_count()];
        let (how, mut fates) = (How { one_sided: true, skipped: &skipped, tested: false }, Vec::new());
        tiles.draw_groups(&clusters, &[(0, how)], Isa::best(), &mut fates);
        assert!(fates.is_empty() && tiles == before, "round {round}");
        // One alone that is not: it may bring its other half along, of which nothing is said.
        let opaque = scene.live().iter().find(|&&p| !clusters.apart(0).contains(&p));
        let Some(&one) = opaque else { continue };
        skipped[one.at()] = false;
        let how = How { one_sided: true, skipped: &skipped, tested: false };
        tiles.draw_groups(&clusters, &[(0, how)], Isa::best(), &mut fates);
        assert_eq!(fates.iter().map(|f| f.0).collect::<Vec<_>>(), [one], "round {round}");
        assert_eq!(tiles.depths(Isa::best()), image(&scene, &view, ONE_SIDED).depth, "round {round}");
    }
}

/// Of two faces at one place, square to the line of sight, the one with the lower id shows, though it is
/// drawn last: whoever lists what shows is to list both.
#[test]
fn what_is_as_deep_as_what_is_drawn_may_show() {
    let view = straight_view(64, 0.05, 50.0);
    for half in [0.3, 2.0, 30.0] {
        let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
        let points =
            [corners, corners].concat().iter().map(|[x, y]| Vec3::new(x * half, y * half, -4.0)).collect();
        let prims = vec![[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7]];
        let scene: Scene<Solid> = scene_of(points, prims);
        let groups: [&[PrimId]; 2] = [&[PrimId(2), PrimId(3)], &[PrimId(0), PrimId(1)]];
        let clusters = Clusters::new(&scene, ONE_SIDED, groups);
        let (mut tiles, mut fates) = (Tiles::default(), Vec::new());
        tiles.clear(&view, false);
        let how = How { one_sided: true, skipped: &[], tested: false };
        (0..2).for_each(|group| tiles.draw_groups(&clusters, &[(group, how)], Isa::best(), &mut fates));
        assert!(fates.iter().all(|f| f.1 == Fate::Shown), "{half}: {fates:?}");
        assert_eq!(visible(&render(&scene, &view, scene.live())), [PrimId(0), PrimId(1)], "{half}");
    }
    // In flatland likewise.
    let wall = [Vec2::new(-9.0, -5.0), Vec2::new(9.0, -5.0)];
    let scene: Scene<Flat> = scene_of([wall, wall].concat(), vec![[0, 1], [2, 3]]);
    let clusters = Clusters::new(&scene, ONE_SIDED, [&[PrimId(1)][..], &[PrimId(0)]]);
    let (mut tiles, mut fates) = (Tiles::default(), Vec::new());
    tiles.clear(&straight_line(33), false);
    let how = How { one_sided: true, skipped: &[], tested: false };
    (0..2).for_each(|group| tiles.draw_groups(&clusters, &[(group, how)], Isa::best(), &mut fates));
    assert_eq!(fates, [(PrimId(1), Fate::Shown), (PrimId(0), Fate::Shown)]);
}
