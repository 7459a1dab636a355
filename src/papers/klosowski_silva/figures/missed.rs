//! Figures 13 and 14: the images of three orders with a budget of a tenth, and which of their pixels are
//! wrong.

use std::sync::Arc;

use super::room::{FRAME, room};
use crate::drawing::{Drawing, Pixels, Role};
use crate::figure::tools::{Maker, TWO_COLUMNS_PT, entry};
use crate::figure::{Panel, Paper, Picture, Swatch, panels};
use crate::geometry::{PrimId, Solid, View};
use crate::papers::keys::{CENTROID, LAYERED_PROJECTION};
use crate::raster::{render, shade, srgb_bytes};
use crate::scene::{Scene, SceneError, Surfaces};
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

/// The room as the Eye sees it.
struct Exact {
    scene: Arc<Scene<Solid>>,
    view: View<Solid>,
    /// What is behind the room, linear.
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
    fn new(paper: [f32; 3]) -> Result<Self, SceneError> {
        let scene = room()?;
        let view = View { width: SIDE, height: SIDE, ..scene.paths()[0].views[FRAME] };
        let one_sided = Surfaces { one_sided: true, ..Surfaces::default() };
        let mut truth = Truth::new(&*scene, one_sided, 1, paper);
        let visible = truth.look(&*scene, &view);
        let image = shade(truth.image(), &*scene, &view, paper);
        Ok(Self { scene, view, paper, visible, image })
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

/// Figures 13 and 14.
pub fn images(maker: &Maker<'_>) -> Result<Drawing, SceneError> {
    let tint = maker.tint;
    let exact = Exact::new(tint(Role::Paper))?;
    let [right, wrong] = [Role::Paper, Role::Wrong].map(|role| srgb_bytes(tint(role)));
    let picture = |rgba: Vec<u8>| Picture::Pixels(Pixels { width: SIDE, height: SIDE, rgba: rgba.into() });
    let (mut upper, mut lower) = (Vec::new(), Vec::new());
    for (name, method, settings) in ORDERS {
        let drawn = exact.drawn(maker, method, settings);
        let (found, share) = (drawn.found_percent, drawn.wrong_percent());
        let missed = drawn.right.iter().flat_map(|&is_right| if is_right { right } else { wrong }).collect();
        upper.push(Panel {
            label: format!("{name}: {found:.0} % of what is visible"),
            picture: picture(drawn.image),
        });
        lower.push(Panel {
            label: format!("{name}: {share:.1} % of the pixels wrong"),
            picture: picture(missed),
        });
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_polygons_are_many_pixels() {
        let exact = Exact::new([1.0; 3]).expect("a scene");
        let [centroid, octree, delaunay] =
            ORDERS.map(|(_, method, settings)| exact.drawn(&Maker::gray(), method, settings));
        for cells in [&octree, &delaunay] {
            assert!((cells.found_percent - centroid.found_percent).abs() < 8.0, "about as many triangles");
        }
        assert!(octree.wrong_percent() * 1.4 < centroid.wrong_percent(), "and fewer wrong pixels");
        assert!(delaunay.wrong_percent() * 3.0 < centroid.wrong_percent(), "far fewer");
    }
}
