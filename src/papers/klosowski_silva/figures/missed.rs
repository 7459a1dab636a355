//! Figures 10, 11, 13 and 14: images with a budget of a tenth, and which of their pixels are wrong: of three
//! orders in a room, and of a city and cars beside what is visible of them.

use std::sync::Arc;

use super::room::{FRAME, room};
use crate::drawing::words::count;
use crate::drawing::{Drawing, Pixels, Role};
use crate::figure::tools::{Maker, TWO_COLUMNS_PT, entry};
use crate::figure::{Panel, Paper, Picture, Swatch, panels};
use crate::geometry::{PrimId, Solid, View};
use crate::papers::keys::{CENTROID, LAYERED_PROJECTION};
use crate::raster::{render, shade, srgb_bytes};
use crate::scene::{AnyScene, LoadOptions, Quiet, Scene, SceneError, Surfaces, load};
use crate::truth::{Truth, missing};

/// Side of an image, pixels.
const SIDE: u32 = 240;
/// An order of drawing: its name, the method, and its settings.
type Order = (&'static str, &'static str, &'static [(&'static str, &'static str)]);
const ORDERS: [Order; 3] = [
    ("centroid", CENTROID, &[("budget", "10%")]),
    ("octree", LAYERED_PROJECTION, &[("budget", "10%"), ("tessellation", "octree"), ("rules", "paper")]),
    ("Delaunay", LAYERED_PROJECTION, &[("budget", "10%"), ("tessellation", "delaunay"), ("rules", "paper")]),
];
/// As in all runs of the paper (Section 5).
const ONE_SIDED: (&str, &str) = ("backface-culling", "true");

/// A scene as the Eye sees it.
struct Exact {
    scene: Arc<Scene<Solid>>,
    view: View<Solid>,
    /// What is behind the scene, linear.
    paper: [f32; 3],
    visible: Vec<PrimId>,
    image: Vec<u8>,
}

/// What an order draws of it.
struct Drawn {
    image: Vec<u8>,
    /// Of each pixel, whether it is right.
    right: Vec<bool>,
    /// Visible triangles that were drawn, per cent of the visible ones.
    found_percent: f64,
}

impl Exact {
    fn new(scene: Arc<Scene<Solid>>, frame: usize, paper: [f32; 3]) -> Self {
        let view = View { width: SIDE, height: SIDE, ..scene.paths()[0].views[frame] };
        let one_sided = Surfaces { one_sided: true, ..Surfaces::default() };
        let mut truth = Truth::new(&*scene, one_sided, 1, paper);
        let visible = truth.look(&*scene, &view);
        let image = shade(truth.image(), &*scene, &view, paper);
        Self { scene, view, paper, visible, image }
    }
    fn drawn(&self, maker: &Maker<'_>, method: &str, settings: &[(&str, &str)]) -> Drawn {
        let settings = [settings, &[ONE_SIDED]].concat();
        let drawn = maker.ready(&self.scene, method, &settings).cull(&self.view).prims;
        let target = render(&*self.scene, &self.view, &drawn);
        let image = shade(&target, &*self.scene, &self.view, self.paper);
        let right = self.image.chunks_exact(4).zip(image.chunks_exact(4)).map(|(a, b)| a == b).collect();
        let (all, missed) =
            (self.visible.len(), missing(&self.visible, &drawn, self.scene.prim_count()).len());
        Drawn { image, right, found_percent: 100.0 * (all - missed) as f64 / all as f64 }
    }
}

impl Drawn {
    fn wrong_percent(&self) -> f64 {
        100.0 * self.right.iter().filter(|right| !**right).count() as f64 / self.right.len() as f64
    }
}

fn panel(label: String, rgba: Vec<u8>) -> Panel {
    let picture = Picture::Pixels(Pixels { width: SIDE, height: SIDE, rgba: rgba.into() });
    Panel { label, picture }
}

/// Figures 13 and 14.
pub fn images(maker: &Maker<'_>) -> Result<Drawing, SceneError> {
    let tint = maker.tint;
    let exact = Exact::new(room()?, FRAME, tint(Role::Paper));
    let [right, wrong] = [Role::Paper, Role::Wrong].map(|role| srgb_bytes(tint(role)));
    let (mut upper, mut lower) = (Vec::new(), Vec::new());
    for (name, method, settings) in ORDERS {
        let drawn = exact.drawn(maker, method, settings);
        let (found, share) = (drawn.found_percent, drawn.wrong_percent());
        let missed = drawn.right.iter().flat_map(|&is_right| if is_right { right } else { wrong }).collect();
        upper.push(panel(format!("{name}: {found:.0} % of what is visible"), drawn.image));
        lower.push(panel(format!("{name}: {share:.1} % of the pixels wrong"), missed));
    }
    upper.extend(lower);
    let content = panels(TWO_COLUMNS_PT, 3, &upper);
    let legend = vec![entry(Role::Wrong, Swatch::Area, "wrong pixel; white ones are right")];
    let caption = format!(
        "A seminar room of {} triangles with a budget of 10 %: above what each order draws (nothing where it \
         is white), below where that differs from the image of the whole room, in which {} triangles are \
         visible. Centroid: nearest first; octree and Delaunay: prioritized layers over these cells. The \
         centroid order finds many triangles, those of near chairs, and misses large ones far away: few \
         polygons, many pixels. Frame {FRAME} of the flight, {SIDE} × {SIDE} pixels.",
        exact.scene.live().len(),
        exact.visible.len()
    );
    let title = "What a tenth of the triangles shows, and what it misses";
    Ok(maker.page(Paper::TwoColumns, title, legend, caption, &content))
}

/// All that is visible of a scene beside what a tenth of its triangles shows, by Delaunay cells.
fn beside(maker: &Maker<'_>, source: &str, frame: usize, of: &str) -> Result<Drawing, SceneError> {
    let AnyScene::Solid(scene) = load(source, &LoadOptions::default(), &Quiet)? else {
        unreachable!("{source} is in space");
    };
    let exact = Exact::new(scene, frame, (maker.tint)(Role::Paper));
    let tenth = |rules: &str, name: &str| {
        let drawn = exact.drawn(maker, LAYERED_PROJECTION, &[("budget", "10%"), ("rules", rules)]);
        let (found, wrong) = (drawn.found_percent, drawn.wrong_percent());
        panel(format!("{name}: {found:.0} % found, {wrong:.1} % wrong"), drawn.image)
    };
    let [paper, ours] = [tenth("paper", "the paper's rules"), tenth("ours", "our rules")];
    let all = panel(format!("all {} visible triangles", count(exact.visible.len())), exact.image);
    let content = panels(TWO_COLUMNS_PT, 3, &[all, paper, ours]);
    let caption = format!(
        "{of}, {} triangles: all that is visible, and what is drawn when the traversal is stopped at a \
         tenth, with how many of the visible triangles are found and of the pixels are wrong. What it takes \
         to be behind other things is missing. Cells: Delaunay. Frame {frame} of the flight, {SIDE} × {SIDE} \
         pixels. Frame by frame, with as many triangles as in the paper, and with times: the table \
         klosowski-silva-frames.",
        count(exact.scene.live().len())
    );
    let title = "What is visible, and what a tenth of the triangles shows of it";
    Ok(maker.page(Paper::TwoColumns, title, vec![], caption, &content))
}

/// Figure 10, its images.
pub fn city(maker: &Maker<'_>) -> Result<Drawing, SceneError> {
    beside(maker, "generate:city?polygons=60000&flight=1", 40, "A generated city from above")
}

/// Figure 11, its images.
pub fn cars(maker: &Maker<'_>) -> Result<Drawing, SceneError> {
    beside(maker, "generate:cars?polygons=100000", 40, "Five generated cars with engines")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_polygons_are_many_pixels() {
        let exact = Exact::new(room().expect("a scene"), FRAME, [1.0; 3]);
        let [centroid, octree, delaunay] =
            ORDERS.map(|(_, method, settings)| exact.drawn(&Maker::gray(), method, settings));
        for cells in [&octree, &delaunay] {
            assert!((cells.found_percent - centroid.found_percent).abs() < 8.0, "about as many triangles");
        }
        assert!(octree.wrong_percent() * 1.4 < centroid.wrong_percent(), "and fewer wrong pixels");
        assert!(delaunay.wrong_percent() * 3.0 < centroid.wrong_percent(), "far fewer");
    }
}
