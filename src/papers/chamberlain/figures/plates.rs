//! Plates 1 to 4, and what Section 5.1 says of the order of drawing: images with and without cubes.

use std::sync::Arc;

use glam::vec3;
use rand_pcg::Pcg32;
use rand_pcg::rand_core::Rng;

use crate::drawing::words::grouped;
use crate::drawing::{Drawing, Pixels, Role};
use crate::figure::tools::{Maker, TWO_COLUMNS_PT, WIDTH_PT, view};
use crate::figure::{Panel, Paper, Picture, panels};
use crate::geometry::{MaterialId, Solid, View};
use crate::method::{DrawList, Run};
use crate::papers::keys::COLOR_CUBES;
use crate::papers::paper::Figure;
use crate::raster::{Canvas, Light, Options, SEEN, Target, averaged, flip_map, render, shade_differences};
use crate::scene::{AnyScene, LoadOptions, Material, Parts, Quiet, Scene, SceneError, load};

/// Plate 1.
pub const TREE: Figure = Figure {
    name: "chamberlain-plate-1",
    former: None,
    summary: "A tree at four distances: as geometry and with color cubes",
    make: tree,
};
/// Plate 2.
pub const MOLECULE: Figure = Figure {
    name: "chamberlain-plate-2",
    former: None,
    summary: "A molecule at four distances: as geometry and with color cubes",
    make: molecule,
};
/// Plate 3.
pub const ISLAND: Figure = Figure {
    name: "chamberlain-plate-3",
    former: None,
    summary: "An island with trees: as geometry and with color cubes",
    make: island,
};
/// Plate 4.
pub const BUST: Figure = Figure {
    name: "chamberlain-plate-4",
    former: None,
    summary: "A bust from 45°: its surface torn by cubes, and whole where cubes that tear are refused",
    make: bust,
};
/// Section 5.1.
pub const ORDER: Figure = Figure {
    name: "chamberlain-order",
    former: None,
    summary: "Geometry within translucent cubes, drawn in exact order and cell by cell",
    make: order,
};

fn solid(source: &str) -> Result<Arc<Scene<Solid>>, SceneError> {
    match load(source, &LoadOptions::default(), &Quiet)? {
        AnyScene::Solid(scene) => Ok(scene),
        AnyScene::Flat(_) => unreachable!("the generated scenes are in space"),
    }
}

/// The geometry of a whole scene, in the light of cubes.
fn geometry(scene: &Scene<Solid>) -> DrawList<Solid> {
    DrawList { prims: scene.live().to_vec(), light: Light::Fixed, ..DrawList::default() }
}

/// The image of a list by 2×2 samples a pixel (Section 5), their mean in linear light.
fn image(maker: &Maker<'_>, scene: &Scene<Solid>, view: &View<Solid>, list: &DrawList<Solid>) -> Pixels {
    let fine = View { width: 2 * view.width, height: 2 * view.height, ..*view };
    let samples = list.paint(scene, &fine, &Options::default(), (maker.tint)(Role::Paper));
    let rgba = averaged(&samples, fine.width as usize, [2, 2]);
    Pixels { width: view.width, height: view.height, rgba: rgba.into() }
}

/// The middle of a picture, a part of its sides.
fn middle(of: &Pixels, share: f32) -> Pixels {
    let side = |whole: u32| ((whole as f32 * share) as u32).clamp(1, whole);
    let (width, height) = (side(of.width), side(of.height));
    let (left, top) = ((of.width - width) / 2, (of.height - height) / 2);
    let row = |y: u32| {
        let from = 4 * ((top + y) * of.width + left) as usize;
        &of.rgba[from..from + 4 * width as usize]
    };
    let rgba: Vec<u8> = (0..height).flat_map(row).copied().collect();
    Pixels { width, height, rgba: rgba.into() }
}

fn panel(label: impl Into<String>, pixels: Pixels) -> Panel {
    Panel { label: label.into(), picture: Picture::Pixels(pixels) }
}

fn number(count: usize) -> String {
    grouped(count as f64, 0)
}

/// What a list draws.
fn counted(list: &DrawList<Solid>) -> String {
    format!("{} cubes, {} triangles", number(list.stand_ins.len()), number(list.prims.len()))
}

/// A model seen from the four distances of Table 2.
struct Distances {
    scene: Arc<Scene<Solid>>,
    views: Vec<View<Solid>>,
    lists: Vec<DrawList<Solid>>,
}

/// Distances in radii, as the path has them.
const RADII: [f32; 4] = [1.75, 3.5, 7.0, 14.0];

impl Distances {
    fn new(maker: &Maker<'_>, source: &str) -> Result<Self, SceneError> {
        let scene = solid(source)?;
        let paths = scene.paths();
        let views = paths.iter().find(|p| p.name == "distances").map(|p| p.views.clone()).unwrap_or_default();
        let mut run = maker.ready(&scene, COLOR_CUBES, &[]);
        let lists = views.iter().map(|view| run.cull(view)).collect();
        Ok(Self { scene, views, lists })
    }
    /// Geometry above, cubes below that, and the middle of those enlarged.
    fn draw(&self, maker: &Maker<'_>) -> Drawing {
        let scene = &*self.scene;
        let whole = geometry(scene);
        let above =
            self.views.iter().zip(RADII).map(|(view, radii)| {
                panel(format!("geometry, d = {radii}"), image(maker, scene, view, &whole))
            });
        let all = || self.views.iter().zip(&self.lists);
        let cubes: Vec<Pixels> = all().map(|(view, list)| image(maker, scene, view, list)).collect();
        let below = cubes.iter().zip(&self.lists).map(|(pixels, list)| panel(counted(list), pixels.clone()));
        // From a distance of one radius what is seen is wider than the image.
        let enlarged = cubes.iter().zip(RADII).map(|(pixels, radii)| {
            panel(format!("cubes enlarged, d = {radii}"), middle(pixels, (1.75 / radii).min(1.0)))
        });
        let parts: Vec<Panel> = above.chain(below).chain(enlarged).collect();
        panels(WIDTH_PT, 4, &parts)
    }
}

/// Plate 1.
fn tree(maker: &Maker<'_>) -> Result<Drawing, SceneError> {
    let shown = Distances::new(maker, "generate:tree")?;
    let caption = format!(
        "A generated tree of {} triangles, 30° about the vertical, from d = 1.75, 3.5, 7 and 14 radii; 124 × \
         124 pixels of 2 × 2 samples. Above as geometry, below with color cubes of at most a pixel, and the \
         middle of these enlarged. Where too little would be drawn as cubes to pay for the visit, all is \
         drawn as geometry. The paper's tree has as many triangles.",
        number(shown.scene.live().len())
    );
    let title = "Chamberlain et al. 1996, Plate 1: a tree at four distances";
    Ok(maker.page(Paper::TwoColumns, title, Vec::new(), caption, &shown.draw(maker)))
}

/// Plate 2.
fn molecule(maker: &Maker<'_>) -> Result<Drawing, SceneError> {
    let shown = Distances::new(maker, "generate:molecule?atoms=60")?;
    let caption = format!(
        "A generated molecule of 60 atoms, balls of 800 triangles each, {} in all, 25° from an axis; \
         distances and rows as in Plate 1. The paper's molecule has 6,534 atoms.",
        number(shown.scene.live().len())
    );
    let title = "Chamberlain et al. 1996, Plate 2: a molecule at four distances";
    Ok(maker.page(Paper::TwoColumns, title, Vec::new(), caption, &shown.draw(maker)))
}

/// Plate 3.
fn island(maker: &Maker<'_>) -> Result<Drawing, SceneError> {
    let scene = solid("generate:terrain-island?polygons=400000")?;
    // From over the shore.
    let view = view(vec3(0.0, 70.0, 220.0), vec3(0.0, 5.0, 0.0), 50.0, [264, 198]);
    let mut run = maker.ready(&scene, COLOR_CUBES, &[]);
    let list = run.cull(&view);
    let parts = [
        panel(
            format!("geometry: {} triangles", number(scene.live().len())),
            image(maker, &scene, &view, &geometry(&scene)),
        ),
        panel(counted(&list), image(maker, &scene, &view, &list)),
    ];
    let caption = format!(
        "A generated island of {} triangles, nearly all of them of its trees, from over its shore; {} × {} \
         pixels of 2 × 2 samples. Left its geometry; right the ground and what is near as geometry, trees \
         farther off as color cubes of at most a pixel. The paper's island has 3.6 million triangles.",
        number(scene.live().len()),
        view.width,
        view.height
    );
    let title = "Chamberlain et al. 1996, Plate 3: an island";
    Ok(maker.page(Paper::TwoColumns, title, Vec::new(), caption, &panels(TWO_COLUMNS_PT, 2, &parts)))
}

/// How much of the background shows through where the geometry hides it, in pixels, and how many of these
/// there are.
fn torn(scene: &Scene<Solid>, view: &View<Solid>, list: &DrawList<Solid>) -> (f32, usize) {
    let whole = render(scene, view, scene.live());
    let (mut drawn, mut canvas) = (Target::default(), Canvas::default());
    list.draw((&mut drawn, &mut canvas), scene, view, &Options::default());
    canvas.clear(view);
    canvas.composite(&list.stand_ins, &drawn, view, &Options::default());
    let hidden = whole.item.iter().zip(&drawn.item).zip(canvas.samples());
    let through = hidden.filter(|((whole, _), _)| **whole != Target::NONE);
    through.fold((0.0, 0), |(sum, count), ((_, drawn), [.., left])| {
        (sum + if *drawn == Target::NONE { left } else { 0.0 }, count + 1)
    })
}

/// The bust of the plate, and how far it is seen from, in radii.
const BUST_SCENE: &str = "generate:bust?polygons=20000";
const BUST_SIZE: [u32; 2] = [200, 200];
/// Cubes are large, so that they are seen; and the surface has no back, which would hide the background where
/// its front is torn.
const LARGE: [(&str, &str); 2] = [("pixel-threshold", "8"), ("backface-culling", "true")];
const BOUND: &str = "0.5";

fn with_bound() -> [(&'static str, &'static str); 3] {
    [LARGE[0], LARGE[1], ("error-bound", BOUND)]
}

/// The view of the plate: from 45°, so near that it fills the image.
fn bust_view(scene: &Scene<Solid>) -> View<Solid> {
    let path = scene.paths().iter().find(|p| p.name == "distances").unwrap_or(&scene.paths()[0]);
    let [width, height] = BUST_SIZE;
    // From 3.5 radii.
    let mut view = View { width, height, ..path.views[1.min(path.views.len() - 1)] };
    view.eye.fov *= 0.5;
    view
}

/// Plate 4.
fn bust(maker: &Maker<'_>) -> Result<Drawing, SceneError> {
    let scene = solid(BUST_SCENE)?;
    let view = bust_view(&scene);
    let draw = |run: &mut Box<dyn Run<Solid>>| run.cull(&view);
    let torn_list = draw(&mut maker.ready(&scene, COLOR_CUBES, &LARGE));
    let bound_list = draw(&mut maker.ready(&scene, COLOR_CUBES, &with_bound()));
    let (shown, whole) = torn(&scene, &view, &torn_list);
    let (shown_bound, _) = torn(&scene, &view, &bound_list);
    let images = [&geometry(&scene), &torn_list, &bound_list].map(|l| image(maker, &scene, &view, l));
    let [labels, enlarged] = [
        [
            format!("geometry: {} triangles", number(scene.live().len())),
            counted(&torn_list),
            counted(&bound_list),
        ],
        ["geometry, enlarged", "cubes, enlarged", "with error-bound, enlarged"].map(String::from),
    ];
    let above = labels.into_iter().zip(images.clone());
    let below = enlarged.into_iter().zip(images.iter().map(|pixels| middle(pixels, 0.35)));
    let parts: Vec<Panel> = above.chain(below).map(|(label, pixels)| panel(label, pixels)).collect();
    let caption = format!(
        "A generated bust from 45° between two axes, {} × {} pixels of 2 × 2 samples. In the middle with \
         color cubes of at most 8 pixels, so that they are seen: the background shows through the surface, \
         {:.1} % of what it hides of it. Right with an error-bound of {BOUND} pixels: a cell whose cube is \
         too wrong from between the axes is drawn as geometry; {:.1} % shows.",
        view.width,
        view.height,
        100.0 * shown / whole as f32,
        100.0 * shown_bound / whole as f32
    );
    let title = "Chamberlain et al. 1996, Plate 4: a torn surface";
    Ok(maker.page(Paper::TwoColumns, title, Vec::new(), caption, &panels(TWO_COLUMNS_PT, 3, &parts)))
}

/// Small triangles in a ball, and a board that reaches from its middle far out of it toward the eye: cells
/// that hold nothing but board are large, and they are the nearest.
fn cut_cloud() -> Result<Arc<Scene<Solid>>, SceneError> {
    const SPECKS: u32 = 40_000;
    let mut random = Pcg32::new(5, 1);
    // In a cube of side 2.
    let mut somewhere = || {
        let mut place = || (f64::from(random.next_u32()) / f64::from(u32::MAX) * 2.0 - 1.0) as f32;
        vec3(place(), place(), place())
    };
    let (mut points, mut prims) = (Vec::new(), Vec::new());
    while prims.len() < SPECKS as usize {
        let at = somewhere();
        if at.length() > 1.0 {
            continue;
        }
        let first = points.len() as u32;
        prims.push([first, first + 1, first + 2]);
        points.extend([at, at + 0.02 * somewhere(), at + 0.02 * somewhere()]);
    }
    let first = points.len() as u32;
    points.extend([[-0.7, -0.3], [0.7, -0.3], [0.7, 2.6], [-0.7, 2.6]].map(|[x, z]| vec3(x, 0.05 * z, z)));
    let mut parts = Parts::<Solid>::simple("cloud", points, prims);
    for corners in [[0, 1, 2], [0, 2, 3]] {
        parts.prims.push(Some(corners.map(|k| first + k)));
        parts.prim_object.push(parts.prim_object[0]);
        parts.prim_material.push(MaterialId(1));
    }
    parts.materials[0].color = [0.10, 0.30, 0.06];
    parts.materials.push(Material::new("board", [0.75, 0.20, 0.10]));
    Ok(Arc::new(Scene::new(parts)?))
}

/// Pixels of cells that are drawn as cubes in the figure about their order: large, to be looked at.
const ORDER_PX: &str = "8";

fn order_view() -> View<Solid> {
    view(vec3(1.2, 1.9, 4.4), vec3(0.0, 0.0, 0.4), 36.0, [160, 120])
}

fn ordered(maker: &Maker<'_>, scene: &Arc<Scene<Solid>>, order: &str) -> (DrawList<Solid>, Pixels) {
    let view = order_view();
    let settings = [("pixel-threshold", ORDER_PX), ("order", order)];
    let list = maker.ready(scene, COLOR_CUBES, &settings).cull(&view);
    let rgba = list.paint(scene, &view, &Options::default(), (maker.tint)(Role::Paper)).into();
    (list, Pixels { width: view.width, height: view.height, rgba })
}

/// Section 5.1: translucent cubes and geometry that intersect.
fn order(maker: &Maker<'_>) -> Result<Drawing, SceneError> {
    let scene = cut_cloud()?;
    let [(list, exact), (_, paper)] = ["exact", "paper"].map(|order| ordered(maker, &scene, order));
    let map = flip_map(&exact.rgba, &paper.rgba, exact.width as usize, exact.height as usize);
    let seen = map.iter().filter(|d| f64::from(**d) > SEEN).count();
    let difference = Pixels { rgba: shade_differences(&map).into(), ..exact.clone() };
    let parts = [
        panel("geometry first, then cubes", exact),
        panel("the paper's: cell by cell, from the back", paper),
        panel("difference (FLIP; black: alike)", difference),
    ];
    let caption = format!(
        "A cloud of small triangles, most of them in {} cubes of at most {ORDER_PX} pixels, and a board that \
         reaches into it; the board and {} small triangles are drawn as geometry. Left all geometry comes \
         first, and cubes are tested against it: one right picture. In the middle cells are drawn from the \
         back to the front, and cubes write depths: the board comes with the first large cell that it \
         crosses, and where a cube came before it and has a nearer face, it is lost behind that translucent \
         face, so that what is farther shows in its place. {} of {} pixels differ so that it is seen.",
        number(list.stand_ins.len()),
        number(list.prims.len().saturating_sub(2)),
        number(seen),
        number(map.len())
    );
    let title = "Chamberlain et al. 1996, Section 5.1: cubes and geometry that intersect";
    Ok(maker.page(Paper::TwoColumns, title, Vec::new(), caption, &panels(TWO_COLUMNS_PT, 3, &parts)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_middle_is_cut_out() {
        let pixels = Pixels { width: 4, height: 2, rgba: (0..32).collect::<Vec<u8>>().into() };
        let cut = middle(&pixels, 0.5);
        assert_eq!((cut.width, cut.height, &*cut.rgba), (2, 1, &[4, 5, 6, 7, 8, 9, 10, 11][..]));
    }

    /// What tears is refused: less of the background shows, and more triangles are drawn.
    #[test]
    fn a_bust_is_torn_by_cubes_and_less_with_a_bound() {
        let (maker, scene) = (Maker::gray(), solid(BUST_SCENE).expect("a bust"));
        let view = bust_view(&scene);
        let of = |settings: &[(&str, &str)]| {
            let list = maker.ready(&scene, COLOR_CUBES, settings).cull(&view);
            (torn(&scene, &view, &list), list.prims.len())
        };
        let ((shown, whole), triangles) = of(&LARGE);
        let ((bound, _), more) = of(&with_bound());
        assert!(shown > 0.01 * whole as f32, "{shown} of {whole}");
        assert!(bound < 0.25 * shown && more > triangles, "{bound} after {shown}, {more} after {triangles}");
    }

    /// What is behind a translucent face shows in the exact picture and is lost in the paper's: the board's
    /// red, of which nothing comes in its place. Nothing differs where there is no cube.
    #[test]
    fn geometry_is_lost_behind_cubes_in_the_papers_order() {
        let (maker, scene) = (Maker::new(&|_| [1.0; 3]), cut_cloud().expect("a cloud"));
        let [(list, exact), (_, paper)] = ["exact", "paper"].map(|order| ordered(&maker, &scene, order));
        assert!(list.stand_ins.len() > 100 && list.prims.len() >= 2);
        let view = order_view();
        let mut canvas = Canvas::default();
        // Cubes alone, so that those behind geometry are among them.
        canvas.clear(&view);
        canvas.composite(&list.stand_ins, &render(&*scene, &view, &[]), &view, &Options::default());
        let both = exact.rgba.chunks_exact(4).zip(paper.rgba.chunks_exact(4));
        // Small triangles are green, and paper has no hue.
        let redness = |pixel: &[u8]| i32::from(pixel[0]) - i32::from(pixel[1]);
        let (mut lost, mut gained) = (0, 0);
        for ((exact, paper), [.., left]) in both.zip(canvas.samples()) {
            assert!(exact == paper || left < 1.0, "without a cube nothing differs");
            let [before, after] = [exact, paper].map(redness);
            lost += usize::from(before > 20 && after <= 0);
            gained += usize::from(before <= 0 && after > 20);
        }
        assert!(lost > 30 && gained == 0, "{lost} pixels have lost the board, {gained} show more of it");
    }
}
