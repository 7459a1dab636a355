//! Delaunay triangulation in space, microseconds a point.
//!
//! `cargo bench --bench delaunay`. One thread. Random points in a cube; centers of the cells of an octree
//! that is refined toward a wavy surface, jittered and exact; and points on a sphere, where no grid helps.
//! Every result has a hash. Before them, milliseconds in which a triangle across all cells is assigned to
//! those that it meets.

use cullscope::geometry::{CellId, Solid};
use cullscope::index::Delaunay;
use cullscope::index::tessellation::{Fineness, SimplexCells, Tessellation, Tried, vertex_octree};
use cullscope::measure::timing::{median, timed};
use cullscope::scene::{Parts, Scene};
use glam::Vec3;
use rand_pcg::Pcg32;
use rand_pcg::rand_core::Rng;

const SIZES: [usize; 3] = [10_000, 60_000, 200_000];
const ROUNDS: usize = 5;

struct Random(Pcg32);

impl Random {
    fn unit(&mut self) -> f32 {
        (self.0.next_u32() >> 8) as f32 / (1u32 << 24) as f32
    }
    fn point(&mut self) -> Vec3 {
        Vec3::new(self.unit(), self.unit(), self.unit())
    }
}

/// Centers and sizes of the leaves of an octree over the unit cube: cells that a wavy surface may cross are
/// divided, level by level, until there are enough.
fn octree(count: usize) -> Vec<(Vec3, f32)> {
    let mut leaves = vec![(Vec3::splat(0.5), 1.0f32)];
    loop {
        let mut next = Vec::new();
        for (at, &(center, size)) in leaves.iter().enumerate() {
            if next.len() + leaves.len() - at >= count {
                next.extend_from_slice(&leaves[at..]);
                next.truncate(count);
                return next;
            }
            let height = 0.5 + 0.2 * (center.x * 9.0).sin() * (center.z * 7.0).cos();
            if (center.y - height).abs() < size {
                let child = |i: u32| {
                    center
                        + (Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32) - 0.5)
                            * (0.5 * size)
                };
                next.extend((0..8).map(|i| (child(i), 0.5 * size)));
            } else {
                next.push((center, size));
            }
        }
        leaves = next;
    }
}

fn main() {
    across(&mut Random(Pcg32::new(3, 4)));
    let mut random = Random(Pcg32::new(1, 2));
    for size in SIZES {
        let octree = octree(size);
        let sets: [(&str, Vec<Vec3>); 4] = [
            ("random", (0..size).map(|_| random.point()).collect()),
            (
                "jittered octree centers",
                octree.iter().map(|(c, s)| *c + (random.point() - 0.5) * (0.1 * s)).collect(),
            ),
            ("exact octree centers", octree.iter().map(|(c, _)| *c).collect()),
            ("on a sphere", (0..size).map(|_| (random.point() - 0.5).normalize()).collect()),
        ];
        for (name, points) in sets {
            let build = || Delaunay::new(points.clone(), || false).expect("not cancelled");
            let built = build();
            let hash = built
                .tetrahedra()
                .iter()
                .flat_map(|t| t.vertices)
                .fold(0u64, |h, v| h.rotate_left(7) ^ u64::from(v));
            let ms = median((0..ROUNDS).map(|_| timed(build).1).collect());
            let cells = built.tetrahedra().len() as f64 / size as f64;
            println!(
                "{size} {name}: {:.2} µs a point, {cells:.2} tetrahedra a point, hash {hash:016x}",
                ms * 1e3 / size as f64
            );
        }
    }
}

/// Triangles that are assigned.
const ACROSS: usize = 200;

/// Large triangles, from one side of a cube to the other, among the cells of 20,000 tiny ones.
fn across(random: &mut Random) {
    let tiny = |r: &mut Random| {
        let at = r.point();
        [at, at + (r.point() - 0.5) * 0.004, at + (r.point() - 0.5) * 0.004]
    };
    let points: Vec<Vec3> = (0..20_000).flat_map(|_| tiny(random)).collect();
    let prims = (0..points.len() as u32 / 3).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    let scene = Scene::<Solid>::new(Parts::simple("tiny", points, prims)).expect("a scene");
    let large = |r: &mut Random| {
        let inside = |p: Vec3| p * 0.96 + 0.02;
        let [a, b, c] = [(); 3].map(|()| r.point());
        [a.with_x(0.0), b.with_x(1.0), c.with_y(c.y.round())].map(inside)
    };
    let triangles: Vec<[Vec3; 3]> = (0..ACROSS).map(|_| large(random)).collect();
    for leaf_share in [0.05, 0.02] {
        let fineness = Fineness { leaf_share, ..Fineness::default() };
        let boxes = vertex_octree(&scene, fineness, || false).expect("not cancelled");
        let cells = SimplexCells::<Solid>::of_centers(&boxes, 1, &|| false).expect("not cancelled");
        let (mut tried, mut met) = (Tried::default(), Vec::new());
        let mut assign = || {
            met.clear();
            triangles.iter().for_each(|t| cells.meeting(t, CellId(0), &mut tried, &mut met));
        };
        let ms = median((0..ROUNDS).map(|_| timed(&mut assign).1).collect()) / ACROSS as f64;
        let hash = met.iter().fold(0u64, |h, c| h.rotate_left(7) ^ u64::from(c.0));
        println!(
            "across {} tetrahedra: {ms:.3} ms a triangle, {} met by each, hash {hash:016x}",
            cells.count(),
            met.len() / ACROSS
        );
    }
}
