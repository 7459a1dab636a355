//! Tessellations of both spaces and all three kinds against brute force.

use std::sync::Arc;

use super::{
    Assignment, BoxCells, Cellular, Exit, Fineness, SimplexCells, Tessellation, vertex_kd_tree, vertex_octree,
};
use crate::geometry::dice::Dice;
use crate::geometry::{Aabb, CellId, Flat, PrimId, Solid, Space, Vector};
use crate::scene::{Quiet, Scene, samples};

const FINE: Fineness = Fineness { leaf_share: 0.07, leaf_vertices: 3 };

fn octree<S: Cellular>(scene: &Scene<S>) -> BoxCells<S::Vector> {
    vertex_octree(scene, FINE, || false).expect("not cancelled")
}
fn simplices<S: Cellular>(scene: &Scene<S>, seed: u32) -> SimplexCells<S> {
    SimplexCells::of_centers(&octree(scene), seed, &|| false).expect("not cancelled")
}

/// Each kind for a scene, with a name.
fn kinds<S: Cellular>(scene: &Scene<S>) -> [(&'static str, Box<dyn Tessellation<S>>); 3] {
    let kd_tree = vertex_kd_tree(scene, FINE, || false).expect("not cancelled");
    [
        ("octree", Box::new(octree(scene))),
        ("Delaunay", Box::new(simplices(scene, 1))),
        ("kD-tree", Box::new(kd_tree)),
    ]
}

fn each(
    mut flat: impl FnMut(&Scene<Flat>, &str, &dyn Tessellation<Flat>),
    mut solid: impl FnMut(&Scene<Solid>, &str, &dyn Tessellation<Solid>),
) {
    for seed in 0..4 {
        let scene = samples::soup::<Flat>(seed, 120);
        kinds(&scene).iter().for_each(|(name, cells)| flat(&scene, name, &**cells));
        let scene = samples::soup::<Solid>(seed, 60);
        kinds(&scene).iter().for_each(|(name, cells)| solid(&scene, name, &**cells));
    }
}

fn all(count: usize) -> impl Iterator<Item = CellId> {
    (0..count as u32).map(CellId)
}

/// A point of the whole scene.
fn point_of<S: Space>(scene: &Scene<S>, dice: &mut Dice) -> S::Vector {
    let (center, size) = (scene.bounds().center(), scene.bounds().size());
    S::Vector::from_fn(|a| center.get(a) + size.get(a) * dice.signed(0.5))
}

fn tiles<S: Cellular>(scene: &Scene<S>, name: &str, cells: &dyn Tessellation<S>) {
    assert!(cells.count() > 20, "{name}: {}", cells.count());
    let mut dice = Dice::new(1);
    for _ in 0..60 {
        let point = point_of(scene, &mut dice);
        let holding: Vec<_> = all(cells.count()).filter(|c| cells.contains(*c, point)).collect();
        assert_eq!(holding.len(), 1, "{name}: no point at random lies on a boundary");
        assert_eq!(cells.locate(point, CellId(dice.below(cells.count() as u32))), Some(holding[0]), "{name}");
    }
    assert_eq!(cells.locate(scene.bounds().max + scene.bounds().size(), CellId(0)), None, "{name}");
    for cell in all(cells.count()) {
        assert!(
            cells.contains(cell, cells.center(cell)) && cells.bounds(cell).contains(cells.center(cell)),
            "{name}"
        );
        let ends = cells.edges(cell).into_iter().flatten();
        assert_eq!(Aabb::of(ends), cells.bounds(cell), "{name}: the edges span the cell");
    }
}

#[test]
fn cells_tile_the_region_and_points_are_found() {
    each(tiles, tiles);
}

fn has_neighbors<S: Cellular>(_: &Scene<S>, name: &str, cells: &dyn Tessellation<S>) {
    let mut uneven = 0;
    for cell in all(cells.count()) {
        let around = cells.neighbors(cell);
        assert!(!around.is_empty() && around.windows(2).all(|w| w[0].cell < w[1].cell), "{name}");
        for there in around {
            let back = cells
                .neighbors(there.cell)
                .iter()
                .find(|n| n.cell == cell)
                .expect("neighbors know each other");
            assert!((back.normal + there.normal).length() < 1e-4, "{name}");
            assert!((there.normal.length() - 1.0).abs() < 1e-5 && there.cell != cell);
            let across = cells.center(there.cell) - cells.center(cell);
            assert!(across.dot(there.normal) > 0.0, "{name}: the normal points to the neighbor");
            uneven += usize::from(cells.bounds(cell).diagonal() > 1.5 * cells.bounds(there.cell).diagonal());
        }
    }
    assert!(uneven > 10, "{name}: {uneven} neighbors of another level");
}

#[test]
fn neighbors_know_each_other_across_levels() {
    each(has_neighbors, has_neighbors);
}

/// Boxes that share more than an edge, by comparing every pair.
fn all_box_neighbors<S: Cellular>(scene: &Scene<S>, name: &str, cells: &dyn Tessellation<S>) {
    if name == "Delaunay" {
        return;
    }
    let mut volume = 0.0;
    for c in all(cells.count()) {
        let b = cells.bounds(c);
        volume += (0..S::Vector::AXES).map(|a| f64::from(b.size().get(a))).product::<f64>();
        let touches = |n: &CellId| {
            let o = cells.bounds(*n);
            let shared = (0..S::Vector::AXES)
                .filter(|a| b.min.get(*a).max(o.min.get(*a)) < b.max.get(*a).min(o.max.get(*a)))
                .count();
            *n != c && b.touches(&o) && shared == S::Vector::AXES - 1
        };
        let want: Vec<CellId> = all(cells.count()).filter(touches).collect();
        assert_eq!(cells.neighbors(c).iter().map(|n| n.cell).collect::<Vec<_>>(), want, "{name}");
    }
    let region = super::region(scene).size().get(0);
    let whole = f64::from(region).powi(S::Vector::AXES as i32);
    assert!((volume - whole).abs() < 1e-4 * whole, "{name}: {volume} of {whole}");
}

#[test]
fn box_cells_have_all_their_neighbors_and_fill_the_region() {
    each(all_box_neighbors, all_box_neighbors);
}

#[test]
fn simplices_share_whole_faces_and_fill_the_region() {
    fn check<S: Cellular>(scene: &Scene<S>, factor: f64) {
        let cells = simplices(scene, 3);
        let mut volume = 0.0;
        for (c, simplex) in cells.tables().1.iter().enumerate() {
            let corners = cells.corners(CellId(c as u32));
            volume += S::side(&corners[..S::CORNERS], corners[S::CORNERS]) / factor;
            for (n, other) in cells.tables().1.iter().enumerate() {
                let common = (0..=S::CORNERS)
                    .filter(|i| other.vertices[..=S::CORNERS].contains(&simplex.vertices[*i]))
                    .count();
                let known =
                    Tessellation::<S>::neighbors(&cells, CellId(c as u32)).iter().any(|x| x.cell.at() == n);
                assert_eq!(known, c != n && common == S::CORNERS);
            }
        }
        let whole = f64::from(super::region(scene).size().get(0)).powi(S::CORNERS as i32);
        assert!((volume - whole).abs() < 1e-4 * whole, "{volume} of {whole}");
    }
    check(&samples::soup::<Flat>(2, 120), 2.0);
    check(&samples::soup::<Solid>(2, 40), 6.0);
}

/// The way from a cell's center to a point leaves through one face, and right behind it lies the neighbor
/// that is named.
fn is_left<S: Cellular>(scene: &Scene<S>, name: &str, cells: &dyn Tessellation<S>) {
    let mut dice = Dice::new(5);
    let mut left = 0;
    for _ in 0..400 {
        let (cell, point) = (CellId(dice.below(cells.count() as u32)), point_of(scene, &mut dice));
        let exit = cells.exit(cell, point);
        let (center, way) = (cells.center(cell), point - cells.center(cell));
        // Where it leaves, by halving.
        let (mut inside, mut outside) = (0.0f32, 1.0f32);
        if cells.contains(cell, point) {
            assert_eq!(exit, Exit::Ends, "{name}: there is nothing to leave");
            continue;
        }
        while outside - inside > 1e-6 {
            let middle = 0.5 * (inside + outside);
            *if cells.contains(cell, center + way * middle) { &mut inside } else { &mut outside } = middle;
        }
        let behind =
            cells.locate(center + way * (outside + 1e-5), cell).expect("the way stays in the region");
        if cells.neighbors(cell).iter().any(|n| n.cell == behind) {
            assert_eq!(exit, Exit::Into(behind), "{name}");
            left += 1;
        }
    }
    assert!(left > 250, "{name}: {left}");
    let beyond = scene.bounds().center() + scene.bounds().size() * 100.0;
    assert!(
        all(cells.count()).any(|c| cells.exit(c, beyond) == Exit::Out),
        "{name}: a way leads out of the region"
    );
}

#[test]
fn a_cell_is_left_into_the_neighbor_behind_its_face() {
    each(is_left, is_left);
}

fn is_assigned<S: Cellular>(
    scene: &Scene<S>,
    name: &str,
    cells: &dyn Tessellation<S>,
    meets: &dyn Fn(&[S::Vector], CellId) -> bool,
) {
    let made = Assignment::new(scene, cells, &Quiet).expect("not cancelled");
    let mut references = 0;
    for cell in all(cells.count()) {
        let mut held: Vec<PrimId> = made.own(cell).to_vec();
        held.extend(made.shared(cell).iter().map(|s| made.all_shared()[*s as usize]));
        assert_eq!(held.len(), made.held(cell) as usize);
        references += held.len();
        held.sort_unstable();
        let want = |p: &PrimId| meets(&scene.prim_points(*p).collect::<Vec<_>>(), cell);
        assert_eq!(held, scene.live().iter().copied().filter(want).collect::<Vec<_>>(), "{name}");
    }
    assert_eq!((references, made.all().len()), (made.references(), scene.live().len()), "{name}");
    assert_eq!(all(cells.count()).map(|c| made.held(c)).max(), Some(made.most()));
    assert!(references > scene.live().len() * 5 / 4, "{name}: many are shared");
    let tables = made.tables();
    assert_eq!(Assignment::of_tables(tables.clone(), cells.count(), scene), Some(made));
    for table in 0..4 {
        for at in [0, tables[table].len() / 2, tables[table].len() - 1] {
            let mut bad = tables.clone();
            bad[table][at] = u32::MAX;
            assert_eq!(Assignment::of_tables(bad, cells.count(), scene), None, "table {table} at {at}");
        }
    }
}

#[test]
fn primitives_are_assigned_to_the_cells_they_meet() {
    fn check<S: Cellular>(scene: Arc<Scene<S>>) {
        let (boxes, cells) = (octree(&scene), simplices(&scene, 4));
        is_assigned(&scene, "octree", &boxes, &|p, c| S::meets_box(p, &Tessellation::<S>::bounds(&boxes, c)));
        let kd_tree = vertex_kd_tree(&scene, FINE, || false).expect("not cancelled");
        is_assigned(&scene, "kD-tree", &kd_tree, &|p, c| {
            S::meets_box(p, &Tessellation::<S>::bounds(&kd_tree, c))
        });
        is_assigned(&scene, "Delaunay", &cells, &|p, c| S::meets_simplex(p, &cells.corners(c)));
    }
    (0..3).for_each(|seed| check(samples::soup::<Flat>(seed, 120)));
    (0..3).for_each(|seed| check(samples::soup::<Solid>(seed, 60)));
}

#[test]
fn what_spans_many_cells_is_assigned_by_corners_as_by_the_plain_test() {
    fn check<S: Cellular>(seed: u64, n: u32, many: usize) {
        let mut parts = Arc::unwrap_or_clone(samples::soup::<S>(seed, n)).into_parts();
        // Some reach across the whole scene.
        let mut dice = Dice::new(seed);
        for prim in parts.prims.iter().flatten().take(40) {
            for &corner in prim.as_ref() {
                parts.points[corner as usize] = dice.vector(10.0);
            }
        }
        let scene = Arc::new(Scene::new(parts).expect("a scene"));
        let fine = Fineness { leaf_share: 0.01, ..FINE };
        let boxes = vertex_octree(&scene, fine, || false).expect("not cancelled");
        let cells = SimplexCells::<S>::of_centers(&boxes, 4, &|| false).expect("not cancelled");
        is_assigned(&scene, "large", &cells, &|p, c| S::meets_simplex(p, &cells.corners(c)));
        let made = Assignment::new(&scene, &cells, &Quiet).expect("not cancelled");
        let holds = |cell: &CellId, prim: PrimId| {
            made.shared(*cell).iter().any(|shared| made.all_shared()[*shared as usize] == prim)
        };
        let met = |prim: &PrimId| all(cells.count()).filter(|cell| holds(cell, *prim)).count();
        let most = scene.live().iter().take(40).map(met).max();
        assert!(most.is_some_and(|met| met > many), "some meet many cells: {most:?}");
    }
    (0..3).for_each(|seed| check::<Flat>(seed, 2000, 64));
    (0..3).for_each(|seed| check::<Solid>(seed, 600, 200));
}

#[test]
fn no_leaf_is_divided_below_the_share() {
    let scene = samples::soup::<Solid>(9, 3000);
    for (share, levels) in [(0.05, 5), (0.3, 2), (1.1, 0)] {
        let cells = vertex_octree(&scene, Fineness { leaf_share: share, leaf_vertices: 0 }, || false)
            .expect("not cancelled");
        let whole = super::region(&*scene).size().get(0);
        let least = all(Tessellation::<Solid>::count(&cells))
            .map(|c| Tessellation::<Solid>::bounds(&cells, c).size().get(0))
            .fold(whole, f32::min);
        assert!(
            (whole / least - f32::exp2(levels as f32)).abs() < 0.01 * whole / least,
            "{share}: {whole} to {least}"
        );
    }
}

#[test]
fn seeds_decide_where_centers_move() {
    let scene = samples::soup::<Solid>(1, 60);
    let [a, b, c] = [1, 1, 2].map(|seed| simplices(&scene, seed));
    assert_eq!(a.tables(), b.tables());
    assert_ne!(a.tables().0, c.tables().0);
}

#[test]
fn a_scene_of_one_place_has_cells_too() {
    use crate::scene::Parts;
    for place in [0.0, 1e-30, 5.0, -3e7] {
        let p = glam::Vec3::splat(place);
        let scene =
            Scene::<Solid>::new(Parts::simple("point", vec![p, p, p], vec![[0, 1, 2]])).expect("a scene");
        for (name, cells) in kinds(&scene) {
            let made = Assignment::new(&scene, &*cells, &Quiet).expect("not cancelled");
            assert!(made.references() > 0 && cells.locate(p, CellId(0)).is_some(), "{name} at {place}");
        }
        let q = glam::Vec2::splat(place);
        let scene = Scene::<Flat>::new(Parts::simple("point", vec![q, q], vec![[0, 1]])).expect("a scene");
        for (name, cells) in kinds(&scene) {
            let made = Assignment::new(&scene, &*cells, &Quiet).expect("not cancelled");
            assert!(made.references() > 0 && cells.locate(q, CellId(0)).is_some(), "{name} at {place}");
        }
    }
}

#[test]
fn tables_make_the_same_cells_and_damaged_ones_none() {
    fn check<S: Cellular>(scene: &Scene<S>) {
        let boxes = octree(scene);
        let (region, nodes) = boxes.tables();
        let again = BoxCells::of_tables(region, &nodes).expect("sound");
        assert_eq!(again.tables(), boxes.tables());
        assert_eq!(again.adjacency.neighbors, boxes.adjacency.neighbors);
        assert!(BoxCells::of_tables(region, &nodes[1..]).is_none());
        let mut bad = nodes.clone();
        bad[0].1 = f32::NAN;
        assert!(BoxCells::of_tables(region, &bad).is_none());

        let cells = simplices(scene, 1);
        let (points, list) = cells.tables();
        let again = SimplexCells::<S>::of_tables(points.to_vec(), list.to_vec()).expect("sound");
        assert_eq!(
            (again.tables(), &again.adjacency.neighbors),
            (cells.tables(), &cells.adjacency.neighbors)
        );
        for (at, number) in [(0, u32::MAX - 1), (1, list[3].vertices[0]), (2, 0)] {
            let mut bad = list.to_vec();
            bad[3].vertices[at] = number;
            assert!(SimplexCells::<S>::of_tables(points.to_vec(), bad).is_none());
            let mut bad = list.to_vec();
            bad[3].neighbors[at] = number.min(list.len() as u32 + 1);
            if bad != list {
                assert!(SimplexCells::<S>::of_tables(points.to_vec(), bad).is_none());
            }
        }
    }
    check(&*samples::soup::<Flat>(1, 120));
    check(&*samples::soup::<Solid>(1, 60));
}

#[test]
fn cells_that_were_tried_are_those_of_this_primitive() {
    let mut tried = super::Tried::default();
    tried.begin(3);
    tried.add(CellId(1));
    assert!(tried.has(CellId(1)) && !tried.has(CellId(0)));
    tried.begin(3);
    assert!(!tried.has(CellId(1)), "another primitive");
    tried.number = u32::MAX;
    tried.add(CellId(2));
    tried.begin(3);
    assert!(!all(3).any(|cell| tried.has(cell)), "numbers begin anew");
}
