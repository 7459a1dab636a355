//! `generate:city`: streets of a city with furnished houses.
//!
//! After the city that Coorg and Teller (1997, Section 4) walked through at street level: blocks of houses
//! that stand wall to wall around yards, whose large plain walls hide the rest of the city and all that
//! stands inside. The number of triangles is met as in the building: finer pieces, and then the last of them
//! left off. Cost: O(polygons).

use glam::DVec3;
use rand_pcg::Pcg32;

use super::blocks::{CURB, Cell, City, House, Roof, STOREY};
use super::furniture::{self as piece, Piece};
use super::plan::signed;
use super::shapes::{Frame, Sink, block, circle};
use super::stand::{Inside, Spot};
use super::walk::{EYE, Manner, figure_8};
use super::{
    Generator, GeneratorParam, LoadOptions, Part, Parts, Progress, SceneError, Values, detail_for, house,
    paint, street,
};
use crate::geometry::{Solid, ViewPath};
use crate::scene::Report;
use crate::scene::assemble::assemble;

pub(super) const GENERATOR: Generator = Generator {
    name: "city",
    meaning: "streets of a city whose houses are furnished, for walks at street level; after the city of \
              Coorg and Teller 1997",
    params: &[
        GeneratorParam {
            name: "polygons",
            default: 109_000,
            min: 1_000,
            max: 8_000_000,
            meaning: "triangles, met within 2 percent",
        },
        GeneratorParam {
            name: "seed",
            default: 1,
            min: 0,
            max: u32::MAX as u64,
            meaning: "chooses streets, houses and furniture",
        },
        GeneratorParam {
            name: "blocks",
            default: 0,
            min: 0,
            max: 2_000,
            meaning: "blocks of about ten houses, at least 2; 0 chooses them by the number of polygons (12 \
                      for 109,000)",
        },
        GeneratorParam {
            name: "flight",
            default: 0,
            min: 0,
            max: 1,
            meaning: "1: its path is a flight around it, high enough to see all of it, as in Klosowski and \
                      Silva 2000, Figure 10, not a walk",
        },
    ],
    make,
};

fn make(
    values: &Values,
    source: &str,
    options: &LoadOptions,
    progress: &dyn Progress,
) -> Result<Parts<Solid>, SceneError> {
    let (polygons, seed) = (values.get("polygons"), values.get("seed"));
    let blocks = match values.get("blocks") {
        // As many again as the pieces of one gets finer: both grow with the square root.
        0 => (12.0 * (polygons as f64 / 109_000.0).sqrt() + 0.5) as u64,
        given => given,
    };
    let city = City::new(blocks, seed);
    let mut bare = Sink::counting();
    structure(&mut bare, &city);
    if bare.triangles > polygons {
        let why = format!(
            "the walls and streets of {blocks} blocks alone are {} polygons: give more polygons or fewer \
             blocks",
            bare.triangles
        );
        return Err(SceneError::Format { path: source.to_owned(), why });
    }
    let detail =
        detail_for(polygons, source, progress, |sink, detail| furnish(sink, &city, seed, detail, polygons))?;
    progress.report(0.3, "furnishing");
    let mut sink = Sink::keeping(&[piece::MATERIALS, paint::MATERIALS].concat());
    furnish(&mut sink, &city, seed, detail, polygons);
    let rest = Part { whole: progress, start: 0.5, length: 0.5 };
    let is_flight = values.get("flight") == 1;
    let name = if is_flight { "city from above" } else { "city" };
    let mut parts = assemble(sink.into_mesh(), name, source, options, Report::default(), &rest)?;
    let path = if is_flight { flight(&city, parts.origin) } else { walk(&city, parts.origin) };
    parts.paths.push(path);
    Ok(parts)
}

/// What all houses, or all sides of streets, get in a round.
enum Round {
    /// On each side of a block: how many along it, how far from the street's edge (to the houses), how far
    /// apart from an even distribution, and what.
    Street(&'static str, u32, f64, f64, Piece),
    /// Windows that face streets, or the others.
    Windows(bool),
    /// On each floor.
    Floor(&'static str, Spot, Piece),
    /// On roofs with a ridge.
    Chimney,
}

const ROUNDS: [Round; 21] = [
    Round::Windows(true),
    Round::Street("lamp post", 2, 0.5, 0.0, street::lamp_post),
    Round::Floor("lamp", Spot::Middle, piece::hanging_lamp),
    Round::Chimney,
    Round::Floor("table", Spot::Middle, street::table),
    Round::Street("tree", 3, 0.9, 0.2, street::tree),
    Round::Street("car", 1, -1.2, 0.8, street::car),
    Round::Floor("bed", Spot::Back(-0.5), street::bed),
    Round::Floor("wardrobe", Spot::Left(0.3), street::wardrobe),
    Round::Street("bench", 1, 0.9, 0.0, piece::bench),
    Round::Windows(false),
    Round::Floor("desk", Spot::Right(0.3), piece::desk),
    Round::Floor("sofa", Spot::Right(0.7), piece::bench),
    Round::Floor("picture", Spot::Left(0.6), piece::picture),
    Round::Floor("chair", Spot::Right(0.3), piece::chair),
    Round::Floor("plant", Spot::Back(0.8), piece::plant),
    Round::Floor("computer", Spot::Right(0.3), piece::computer),
    Round::Floor("shelf", Spot::Left(0.75), piece::shelf),
    Round::Floor("desk lamp", Spot::Right(0.3), piece::desk_lamp),
    Round::Floor("second shelf", Spot::Back(0.4), piece::shelf),
    Round::Floor("basket", Spot::Right(0.12), piece::basket),
];

/// Streets and walls first, then pieces in rounds through the whole city until the budget is met.
fn furnish(sink: &mut Sink, city: &City, seed: u64, detail: u32, budget: u64) {
    structure(sink, city);
    for (number, round) in ROUNDS.iter().enumerate() {
        let mut house = 0;
        for (k, cell) in city.cells.iter().enumerate().filter(|(_, c)| !c.meadow) {
            let rng = &mut Pcg32::new(seed.wrapping_mul(1_000_003).wrapping_add(k as u64), number as u64 + 2);
            if let Round::Street(name, count, from_edge, loose, draw) = round {
                (0..4).for_each(|side| {
                    along(sink, cell, side, (name, *count, *from_edge, *loose, *draw), detail, rng, budget, k)
                });
                continue;
            }
            for h in &cell.houses {
                let group = || format!("house_{house}");
                house_round(sink, h, round, detail, rng, budget, &group);
                house += 1;
            }
        }
        if sink.triangles >= budget {
            return;
        }
    }
}

fn house_round(
    sink: &mut Sink,
    h: &House,
    round: &Round,
    detail: u32,
    rng: &mut Pcg32,
    budget: u64,
    group: &impl Fn() -> String,
) {
    match round {
        Round::Windows(street) => {
            for storey in 0..h.storeys {
                for side in (0..4).filter(|k| h.street[*k] == *street) {
                    if sink.triangles < budget {
                        house::windows(sink, h, side, storey, detail, group);
                    }
                }
            }
        }
        Round::Floor(name, spot, draw) => {
            for storey in 0..h.storeys {
                if sink.triangles < budget {
                    sink.begin(|| (format!("{name}_{storey}"), group()));
                    draw(sink, &floor(h, storey).frame(*spot), detail, rng);
                }
            }
        }
        Round::Chimney if h.roof == Roof::Gabled && sink.triangles < budget => {
            sink.begin(|| ("chimney".into(), group()));
            sink.paint(paint::FACADE + 2);
            let mut frame = floor(h, 0).frame(Spot::Back(0.3 * signed(rng)));
            frame.origin.y = h.eaves();
            block(sink, &frame, [-0.35, 0.2, -2.0], [0.35, 3.4, -1.4]);
        }
        _ => {}
    }
}

/// The floor of a storey as one comes in from the street: the greatest rectangle around its middle that keeps
/// away from the walls.
fn floor(h: &House, storey: u32) -> Inside {
    let middle = h.ground.iter().sum::<DVec3>() * 0.25;
    let front = (0..4).find(|k| h.street[*k]).unwrap_or(0);
    let into = (middle - (h.ground[front] + h.ground[(front + 1) % 4]) * 0.5).normalize();
    let right = into.cross(DVec3::Y);
    let extent =
        |axis: DVec3| h.ground.iter().map(|c| (*c - middle).dot(axis).abs()).fold(f64::INFINITY, f64::min);
    let middle = middle.with_y(CURB + STOREY * f64::from(storey) + 0.01);
    Inside { middle, into, right, deep: extent(into), wide: extent(right), plaster: 0.2 }
}

/// Pieces along one side of a block, at the street's edge, their backs to the street.
#[expect(clippy::too_many_arguments, reason = "a row of a table, and where it stands")]
fn along(
    sink: &mut Sink,
    cell: &Cell,
    side: usize,
    (name, count, from_edge, loose, draw): (&str, u32, f64, f64, Piece),
    detail: u32,
    rng: &mut Pcg32,
    budget: u64,
    number: usize,
) {
    let (a, b) = (cell.ground[side], cell.ground[(side + 1) % 4]);
    let (ahead, outward) = ((b - a).normalize(), DVec3::Y.cross(b - a).normalize());
    let height = if from_edge > 0.0 { CURB } else { 0.0 };
    for k in 0..count {
        let t = (f64::from(k) + 0.5 + 0.5 * loose * signed(rng)) / f64::from(count);
        if sink.triangles < budget {
            sink.begin(|| (format!("{name}_{k}"), format!("street_{}", 4 * number + side)));
            let origin = (a.lerp(b, 0.1 + 0.8 * t) - outward * from_edge).with_y(height);
            draw(sink, &Frame { origin, right: ahead, away: outward }, detail, rng);
        }
    }
}

/// Ground, streets, and houses without what is in and on them.
fn structure(sink: &mut Sink, city: &City) {
    let [wide, deep] = city.blocks;
    for (k, cell) in city.cells.iter().enumerate() {
        let flat = cell.meadow;
        sink.begin(|| ((if flat { "meadow" } else { "pavement" }).into(), format!("block_{k}")));
        sink.paint(if cell.houses.is_empty() { paint::GRASS } else { paint::PAVEMENT });
        sink.face(&cell.ground.map(|c| c.with_y(if flat { 0.0 } else { CURB })), DVec3::Y);
        if !flat {
            sink.paint(paint::PAVEMENT);
            for side in 0..4 {
                let (a, b) = (cell.ground[side], cell.ground[(side + 1) % 4]);
                sink.face(&[a, b, b.with_y(CURB), a.with_y(CURB)], DVec3::Y.cross(b - a));
            }
        }
    }
    let mut road = 0;
    let mut pave = |sink: &mut Sink, name: &str, corners: [DVec3; 4]| {
        sink.begin(|| (name.to_owned(), format!("road_{road}")));
        sink.paint(paint::ASPHALT);
        sink.face(&corners, DVec3::Y);
        road += 1;
    };
    for i in 1..=wide + 1 {
        for j in 0..=deep + 1 {
            let (w, e) = (&city.cell(i - 1, j).ground, &city.cell(i, j).ground);
            pave(sink, "road", [w[1], e[0], e[3], w[2]]);
            if j > 0 {
                let (nw, ne) = (&city.cell(i - 1, j - 1).ground, &city.cell(i, j - 1).ground);
                pave(sink, "crossing", [nw[2], ne[3], e[0], w[1]]);
            }
        }
    }
    for j in 1..=deep + 1 {
        for i in 0..=wide + 1 {
            let (n, s) = (&city.cell(i, j - 1).ground, &city.cell(i, j).ground);
            pave(sink, "road", [n[3], n[2], s[1], s[0]]);
        }
    }
    for (k, h) in city.cells.iter().flat_map(|c| &c.houses).enumerate() {
        house::shell(sink, h, &|| format!("house_{k}"));
    }
}

/// Along the middles of the streets in the shape of an 8, once, corners rounded.
fn walk(city: &City, origin: DVec3) -> ViewPath<Solid> {
    let ([west, middle, east], [north, south]) = city.walked_lines();
    let turns = [
        (middle, north),
        (west, north),
        (west, south),
        (middle, south),
        (middle, north),
        (east, north),
        (east, south),
        (middle, south),
    ];
    let mut stops = Vec::new();
    for (k, &(i, j)) in turns.iter().enumerate() {
        let (to_i, to_j) = turns[(k + 1) % turns.len()];
        // All crossings up to the next turn: the streets bend there.
        let (mut i, mut j) = (i, j);
        while (i, j) != (to_i, to_j) {
            stops.push(city.node(i, j).with_y(EYE));
            (i, j) = (step(i, to_i), step(j, to_j));
        }
    }
    figure_8(&stops, &Manner { round: 3.0, ahead: 5.0, far: city.diagonal() }, origin)
}

/// Around the city and above it, its middle in sight: over the nearest roofs all others are seen, so what is
/// nearest is mostly the furniture of the nearest houses, which nobody sees.
fn flight(city: &City, origin: DVec3) -> ViewPath<Solid> {
    /// Height above the ground and distance from the middle, as shares of the city's diagonal.
    const HEIGHT: f64 = 0.3;
    const AWAY: f64 = 0.43;
    const STOPS: u32 = 16;
    /// The paper's.
    const VIEWS: u32 = 160;
    let [wide, deep] = city.blocks;
    let middle = (city.node(0, 0) + city.node(wide + 2, deep + 2)) * 0.5;
    let diagonal = city.diagonal();
    let stop = |k: u32| {
        let (cosine, sine) = circle(k, STOPS);
        let from = middle + DVec3::new(cosine, 0.0, sine) * (AWAY * diagonal);
        (from.with_y(HEIGHT * diagonal), middle.with_y(0.0))
    };
    let stops: Vec<(DVec3, DVec3)> = (0..=STOPS).map(stop).collect();
    super::walk::flight(&stops, VIEWS, 2.0 * diagonal, origin)
}

fn step(from: usize, to: usize) -> usize {
    if from < to { from + 1 } else { from - usize::from(from > to) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::generate::generate;
    use crate::scene::generate::walk::touched;
    use crate::scene::{Quiet, Scene};

    fn city(call: &str) -> Scene<Solid> {
        Scene::new(generate(call, &LoadOptions::default(), &Quiet).expect("a city")).expect("a scene")
    }

    #[test]
    fn any_budget_is_met_within_two_percent() {
        for call in [
            "polygons=1000",
            "polygons=2000",
            "polygons=5000",
            "polygons=20000&seed=7",
            "polygons=109000",
            "polygons=300000",
            "polygons=60000&blocks=2",
        ] {
            let scene = city(&format!("city?{call}"));
            let want: f64 =
                call["polygons=".len()..].split('&').next().and_then(|n| n.parse().ok()).expect("a number");
            let got = scene.prim_count() as f64;
            assert!((got - want).abs() < 0.02 * want + 100.0, "{call}: {got}");
            assert_eq!(scene.report().dropped_total(), 0, "{call}: {:?}", scene.report());
            assert!(scene.paths()[0].views.iter().all(|v| v.eye.fault().is_none()));
        }
    }

    #[test]
    fn the_same_seed_gives_the_same_city_and_another_one_another() {
        let hash = |call: &str| city(call).hash_hex();
        assert_eq!(hash("city?polygons=3000&seed=4"), hash("city?seed=4&polygons=3000"));
        assert_ne!(hash("city?polygons=3000&seed=4"), hash("city?polygons=3000&seed=5"));
        // Machines must agree, so the bits are written down.
        assert_eq!(
            hash("city?polygons=3000&seed=4"),
            "345fc4b78bf87e327ba9ea01500cda2ee093c31c1bfb3e6b65def078ba597b0a"
        );
    }

    #[test]
    fn the_walk_touches_nothing() {
        for (seed, blocks) in [(1, 0), (2, 0), (3, 2), (4, 7), (5, 12)] {
            let scene = city(&format!("city?polygons=30000&seed={seed}&blocks={blocks}"));
            assert_eq!(touched(&scene), None, "seed {seed}");
        }
    }

    #[test]
    fn a_flight_sees_all_of_the_city_from_outside() {
        let scene = city("city?polygons=20000&flight=1");
        assert_eq!(hash_of(&scene), hash_of(&city("city?polygons=20000")), "the same city");
        for view in &scene.paths()[0].views {
            assert!(view.eye.fault().is_none() && view.eye.position.y > scene.bounds().max.y);
            let seen = scene.live().iter().filter(|p| {
                let planes = crate::geometry::Frustum::<glam::Vec3>::ALL;
                let test = view.frustum().test(&scene.prim_bounds(**p), planes);
                !matches!(test, crate::geometry::FrustumTest::Outside(_))
            });
            assert!(seen.count() * 10 > scene.live().len() * 8, "{view:?}");
        }
    }

    /// What is in a scene, without its paths.
    fn hash_of(scene: &Scene<Solid>) -> (usize, u64) {
        let bits = scene.points().iter().flat_map(|p| p.to_array()).map(|v| u64::from(v.to_bits()));
        (scene.prim_count(), bits.fold(0, |sum, v| sum.rotate_left(5) ^ v))
    }

    /// Upright edges of walls that meet, in streets and between houses of different heights, are the same
    /// edge: then walls hide together what none hides alone. Left over are only corners of yards where three
    /// houses meet: edges of one wall, or of four where two houses touch above a lower one.
    #[test]
    fn walls_that_meet_share_their_edges() {
        let scene = city("city?polygons=20000&seed=2&blocks=12");
        let mut edges = std::collections::BTreeMap::<[u32; 2], u32>::new();
        for face in
            scene.faces().iter().filter(|f| scene.objects()[scene.object_of(f.prims[0]).at()].name == "walls")
        {
            let at = |k: usize| scene.points()[face.corners[k % face.corners.len()] as usize];
            // A wall drawn back from the street has a height that no other has.
            let drawn_back =
                (0..face.corners.len()).any(|k| ((at(k).y - 0.45) / 3.0).fract() > 0.9 && at(k).y > 1.0);
            for k in
                (0..face.corners.len()).filter(|k| !drawn_back && at(*k).with_y(0.0) == at(k + 1).with_y(0.0))
            {
                let mut edge = [face.corners[k], face.corners[(k + 1) % face.corners.len()]];
                edge.sort_unstable();
                *edges.entry(edge).or_default() += 1;
            }
        }
        let of = |count: u32| edges.values().filter(|c| **c == count).count();
        assert_eq!(of(1) + of(2) + of(4), edges.len(), "an edge of three walls");
        assert!(
            edges.len() > 300 && of(2) * 100 > edges.len() * 88,
            "{} single edges of {}",
            of(1),
            edges.len()
        );
    }

    #[test]
    fn blocks_that_do_not_fit_the_budget_are_refused() {
        let error = generate("city?polygons=1000&blocks=100", &LoadOptions::default(), &Quiet)
            .expect_err("too many blocks");
        assert!(error.to_string().contains("fewer blocks"), "{error}");
    }
}
