//! What stands in for occluders covers nothing that they do not, and is not much less.

use glam::{Quat, Vec2, Vec3, vec2, vec3};

use super::*;
use crate::geometry::dice::Dice;
use crate::geometry::{Eye, Flat, ObjectId, Solid};
use crate::index::KdTree;
use crate::raster::{Target, render};
use crate::scene::Quiet;

/// A scene of one leaf, with what stands in for it, and where that is.
struct Tried<S: Space> {
    scene: Scene<S>,
    made: Option<StandIns<S>>,
    leaf: NodeId,
}

fn tried<S: Drawable>(kind: Kind, parts: Parts<S>, surfaces: Surfaces, detail: f32) -> Tried<S> {
    let scene = Scene::new(parts).expect("valid");
    let boxes = scene.live().iter().map(|&p| (p, scene.prim_bounds(p)));
    let tree = KdTree::build(boxes, 1, || false).expect("not cancelled");
    let leaves = Leaves { scene: &scene, tree: &tree, occluders: &[true] };
    let made = StandIns::new(kind, &leaves, surfaces, detail, &Quiet);
    Tried { scene, made, leaf: NodeId(0) }
}

fn view(position: Vec3, target: Vec3, width: u32) -> View<Solid> {
    let eye = Eye { position, target, up: Vec3::Y, fov: 1.0, near: 0.01, far: 1e5 };
    View { eye, width, height: width * 3 / 4 }
}

/// Samples that stand-ins cover, and of these those that what they stand for leaves open, or covers farther.
fn differences(tried: &Tried<Solid>, view: &View<Solid>) -> (usize, usize) {
    let made = tried.made.as_ref().expect("something stands in");
    let old = render(&tried.scene, view, tried.scene.live());
    let new = render(made.scene(), view, made.prims(tried.leaf));
    let covered: Vec<usize> = (0..new.item.len()).filter(|&at| new.item[at] != Target::NONE).collect();
    let shows = |at: &&usize| {
        old.item[**at] == Target::NONE || f64::from(new.depth[**at]) > f64::from(old.depth[**at]) * 1.0002
    };
    (covered.len(), covered.iter().filter(shows).count())
}

/// A flat grid of cells of two triangles each, turned.
fn plate(cells: u32, turn: Quat) -> Parts<Solid> {
    let row = cells + 1;
    let points: Vec<Vec3> =
        (0..row * row).map(|k| turn * vec3((k % row) as f32, 0.0, (k / row) as f32)).collect();
    let cell = |k: u32| {
        let at = k / cells * row + k % cells;
        [[at, at + row, at + 1], [at + 1, at + row, at + row + 1]]
    };
    let prims: Vec<[u32; 3]> = (0..cells * cells).flat_map(cell).collect();
    Parts::simple("plate", points, prims)
}

#[test]
fn a_plate_is_cut_into_fewer_triangles_with_the_same_image() {
    let both = Surfaces::default();
    let tried = tried(Kind::Merged, plate(4, Quat::IDENTITY), both, 0.0);
    let made = tried.made.as_ref().expect("made");
    // 9 of 25 points lie inside: 16 corners are 14 triangles.
    assert_eq!((tried.scene.live().len(), made.prims(tried.leaf).len()), (32, 14));
    let (mut dice, mut same, mut refused, mut turned) = (Dice::new(6), 0, 0, 0);
    for round in 0..3000 {
        // Near and far, and every other one nearly edge-on.
        let away = 10.0_f32.powf(dice.between(0.3, 3.5));
        let mut from = dice.point(1.0).normalize() * away;
        from.y *= [1.0, 1e-3][round % 2];
        let view = view(vec3(2.0, 0.0, 2.0) + from, vec3(2.0, 0.0, 2.0), 64);
        let (covered, wrong) = differences(&tried, &view);
        if made.may_stand_in(tried.leaf, &view, &view.projection()) {
            assert_eq!(wrong, 0, "round {round}");
            // And about all that they do: of those that turn over some cover more.
            let old = render(&tried.scene, &view, tried.scene.live());
            let most = old.item.iter().filter(|item| **item != Target::NONE).count();
            assert!(covered + 2 >= most, "round {round}: {covered} of {most}");
            same += usize::from(covered > 0);
        } else {
            refused += 1;
            turned += wrong;
        }
    }
    assert!(same > 200 && refused > 20, "{same} shown, {refused} refused");
    assert!(turned > 0, "it was refused for a reason");
}

#[test]
fn what_is_not_exactly_flat_or_in_one_piece_stays() {
    // Turned, corners are rounded off the plane.
    let mut bent = plate(4, Quat::IDENTITY);
    bent.points[12].y = 1e-6;
    let count = |parts| {
        let tried = tried(Kind::Merged, parts, Surfaces::default(), 0.0);
        tried.made.map_or(0, |made| made.prims(tried.leaf).len())
    };
    // About the dent six triangles stay, and what is left has two borders.
    assert_eq!(count(bent), 32, "a dent may hold something");
    let mut pierced = plate(4, Quat::IDENTITY);
    // Two borders.
    (pierced.prims[10], pierced.prims[11]) = (None, None);
    assert_eq!(count(pierced), 30);
}

#[test]
fn segments_that_go_on_straight_become_one() {
    let points = [[0.0, 0.0], [1.0, 1.0], [2.0, 2.0], [4.0, 4.0], [4.0, 5.0], [9.0, 9.0], [8.0, 8.0]];
    let points = points.iter().map(|&[x, y]| vec2(x, y)).collect();
    // Three that do, one askew, and one that goes back.
    let prims = vec![[0, 1], [1, 2], [2, 3], [3, 4], [5, 6]];
    let tried = tried(Kind::Merged, Parts::<Flat>::simple("chain", points, prims), Surfaces::default(), 0.0);
    let made = tried.made.expect("made");
    let ends: Vec<Vec<Vec2>> =
        made.prims(tried.leaf).iter().map(|&p| made.scene().prim_points(p).collect()).collect();
    assert_eq!(ends.len(), 3);
    assert!(ends.contains(&vec![vec2(0.0, 0.0), vec2(4.0, 4.0)]), "{ends:?}");
}

#[test]
fn the_largest_are_a_subset_that_covers_most() {
    let mut dice = Dice::new(8);
    let points: Vec<Vec3> = (0..90).map(|k| dice.point(1.0) * [0.1, 1.0, 3.0][k / 3 % 3]).collect();
    let prims = (0..30).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect();
    let tried = tried(Kind::Largest, Parts::<Solid>::simple("soup", points, prims), Surfaces::default(), 0.0);
    let made = tried.made.as_ref().expect("made");
    let area = |scene: &Scene<Solid>, prims: &[PrimId]| -> f32 {
        prims.iter().map(|&p| scene.normal(p).length()).sum()
    };
    let (all, some) = (area(&tried.scene, tried.scene.live()), area(made.scene(), made.prims(tried.leaf)));
    assert!(some >= 0.75 * all && made.prims(tried.leaf).len() < 20, "{some} of {all}");
    for _ in 0..50 {
        let view = view(dice.point(1.0).normalize() * 9.0, Vec3::ZERO, 64);
        let (covered, wrong) = differences(&tried, &view);
        assert!(covered > 0 && wrong == 0);
    }
}

/// An outline, counter-clockwise, pulled up along y, as a closed part: sides, then lower and upper ends.
fn prism(outline: &[Vec2], ends: &[[u32; 3]], height: f32, turn: Quat) -> Parts<Solid> {
    let n = outline.len() as u32;
    let raised = |y: f32| outline.iter().map(move |p| turn * vec3(p.x, y, -p.y));
    let points: Vec<Vec3> = raised(0.0).chain(raised(height)).collect();
    let mut prims = Vec::new();
    for k in 0..n {
        let next = (k + 1) % n;
        prims.extend([[k, next, n + next], [k, n + next, n + k]]);
    }
    prims.extend(ends.iter().map(|&[a, b, c]| [a, c, b]));
    prims.extend(ends.iter().map(|t| t.map(|k| n + k)));
    Parts::simple("prism", points, prims)
}

fn block(size: Vec3, turn: Quat) -> Parts<Solid> {
    let outline = [[0.0, 0.0], [size.x, 0.0], [size.x, size.z], [0.0, size.z]].map(|[x, y]| vec2(x, y));
    prism(&outline, &[[0, 1, 2], [0, 2, 3]], size.y, turn)
}

/// Two walls that meet at a corner.
fn angle(turn: Quat) -> Parts<Solid> {
    let outline = [[0.0, 0.0], [6.0, 0.0], [6.0, 0.4], [0.4, 0.4], [0.4, 5.0], [0.0, 5.0]];
    let ends = [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 5]];
    prism(&outline.map(|[x, y]| vec2(x, y)), &ends, 3.0, turn)
}

/// A round column.
fn column(sides: u32, turn: Quat) -> Parts<Solid> {
    let at = |k: u32| Vec2::from_angle(std::f32::consts::TAU * k as f32 / sides as f32);
    let ends: Vec<[u32; 3]> = (2..sides).map(|k| [0, k - 1, k]).collect();
    prism(&(0..sides).map(at).collect::<Vec<_>>(), &ends, 3.0, turn)
}

#[test]
fn boxes_inside_show_nowhere() {
    let mut dice = Dice::new(11);
    let (mut covered, mut used, mut refused) = (0, 0, 0);
    for round in 0..60 {
        let turn = match round % 3 {
            0 => Quat::IDENTITY,
            1 => Quat::from_rotation_y(dice.between(0.0, 6.0)),
            _ => Quat::from_axis_angle(dice.point(1.0).normalize(), dice.between(0.0, 3.0)),
        };
        let parts = match round / 3 % 4 {
            0 => block(vec3(4.0, 3.0, 0.3), turn),
            1 => angle(turn),
            2 => column(5 + round as u32, turn),
            _ => block(vec3(2.0, 2.0, 2.0), turn),
        };
        let surfaces = Surfaces { one_sided: round % 2 == 1, ..Surfaces::default() };
        let tried = tried(Kind::Inner, parts, surfaces, 0.05);
        if tried.made.is_none() {
            continue;
        }
        let middle = tried.scene.bounds().center();
        for _ in 0..60 {
            let away = 10.0_f32.powf(dice.between(0.7, 3.0));
            let view = view(middle + dice.point(1.0).normalize() * away, middle, 160);
            let made = tried.made.as_ref().expect("made");
            if !made.may_stand_in(tried.leaf, &view, &view.projection()) {
                refused += 1;
                continue;
            }
            let (here, wrong) = differences(&tried, &view);
            assert_eq!(wrong, 0, "round {round}, {away} away");
            (covered, used) = (covered + here, used + 1);
        }
    }
    assert!(covered > 200_000 && used > 1000 && refused > 100, "{covered}, {used}, {refused}");
}

#[test]
fn boxes_fill_what_is_closed() {
    let boxes = |parts: Parts<Solid>, one_sided: bool| -> Vec<Aabb<Vec3>> {
        let tried = tried(Kind::Inner, parts, Surfaces { one_sided, ..Surfaces::default() }, 0.0);
        let of = |made: &StandIns<Solid>| {
            let prims = made.prims(tried.leaf);
            let points =
                |some: &[PrimId]| some.iter().flat_map(|&p| made.scene().prim_points(p)).collect::<Vec<_>>();
            prims.chunks(12).map(|some| Aabb::of(points(some))).collect()
        };
        tried.made.as_ref().map_or(Vec::new(), of)
    };
    // A wall: one box, smaller by an eighth of its thickness.
    let wall = || block(vec3(4.0, 3.0, 0.4), Quat::IDENTITY);
    let [made] = boxes(wall(), true)[..] else { panic!("one box") };
    assert!((made.min - vec3(0.05, 0.05, -0.35)).length() < 1e-5, "{made:?}");
    assert!((made.max - vec3(3.95, 2.95, -0.05)).length() < 1e-5, "{made:?}");
    // Of two walls each goes through to the corner.
    let both = boxes(angle(Quat::IDENTITY), true);
    assert_eq!(both.len(), 2, "{both:?}");
    assert!(both[0].touches(&both[1]), "no slit between {both:?}");
    // Turned inside out it has no front outside; with a triangle missing it is not closed.
    let mut reversed = wall();
    reversed.prims.iter_mut().flatten().for_each(|t| t.swap(1, 2));
    assert!(boxes(reversed.clone(), true).is_empty());
    assert_eq!(boxes(reversed, false).len(), 1);
    let mut open = wall();
    open.prims[3] = None;
    assert!(boxes(open, false).is_empty());
    // What moves has none.
    let mut moving = wall();
    let pose = crate::scene::Pose { rotation: [0.0, 0.0, 0.0, 1.0], translation: [0.0; 3] };
    moving.objects[0].motion = Some(vec![pose].into());
    assert!(boxes(moving, false).is_empty());
}

#[test]
fn boxes_of_flatland_lie_in_closed_outlines() {
    // A square, and an open one; rays run along walls.
    let square = [[0.0, 0.0], [0.0, 4.0], [4.0, 4.0], [4.0, 0.0]].map(|[x, y]| vec2(x, y));
    let open = square.map(|p| p + vec2(9.0, 0.0));
    let points = square.into_iter().chain(open).collect();
    let prims = vec![[0, 1], [1, 2], [2, 3], [3, 0], [4, 5], [5, 6], [6, 7]];
    let parts = Parts::<Flat>::simple("outlines", points, prims);
    let tried = tried(Kind::Inner, parts, Surfaces { one_sided: true, ..Surfaces::default() }, 0.0);
    let made = tried.made.expect("made");
    assert_eq!(made.prims(tried.leaf).len(), 4);
    let bounds = made.bounds(tried.leaf);
    assert!((bounds.min - Vec2::splat(0.0625)).length() < 1e-6 && bounds.max.x < 4.0, "{bounds:?}");
    for &p in made.prims(tried.leaf) {
        assert!(made.scene().faces_away(p, vec2(2.0, 2.0)), "fronts are outside");
    }
}

#[test]
fn clustering_does_not_preserve() {
    // A wall of two panes with a narrow gap, which their neighboring corners close.
    let mut parts = plate(1, Quat::IDENTITY);
    let other: Vec<Vec3> = parts.points.iter().map(|p| *p + vec3(1.1, 0.0, 0.0)).collect();
    parts.points.extend(other);
    let second = parts.prims.clone().into_iter().flatten().map(|t| Some(t.map(|c| c + 4)));
    parts.prims.extend(second);
    parts.prim_object = vec![ObjectId(0); 4];
    parts.prim_material = vec![MaterialId(0); 4];
    let tried = tried(Kind::Clustered, parts, Surfaces::default(), 0.25);
    let made = tried.made.as_ref().expect("made");
    assert_eq!(made.prims(tried.leaf).len(), 4);
    let (covered, wrong) = differences(&tried, &view(vec3(1.05, 3.0, 0.5), vec3(1.05, 0.0, 0.51), 256));
    assert!(wrong > 50 && wrong < covered / 2, "{wrong} of {covered}");
    // What collapses is gone.
    let tiny = self::tried(Kind::Clustered, plate(3, Quat::IDENTITY), Surfaces::default(), 50.0);
    assert!(tiny.made.is_none());
}
