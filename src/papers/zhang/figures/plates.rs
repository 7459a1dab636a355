//! Figures 11 to 13: the models of the paper's measurements, or what they are likened to, from above.

use super::counts;
use super::notes::occluder_prims;
use super::space::{Shot, kept, plate, roles, seen};
use crate::drawing::words::grouped;
use crate::drawing::{Drawing, Role};
use crate::figure::tools::{Maker, TWO_COLUMNS_PT, entry};
use crate::figure::{Entry, Panel, Paper, Picture, Swatch, panels};
use crate::geometry::Solid;
use crate::method::Film;
use crate::scene::SceneError;

/// A model.
struct Model {
    title: &'static str,
    shot: Shot<'static>,
    /// What begins so high over the lowest point is left out of the plate, m.
    cut: f32,
    /// What is shown, for the caption.
    words: &'static str,
    /// What the paper says of its own.
    paper: &'static str,
}

const CITY: Model = Model {
    title: "Zhang et al. 1997, Figure 11: a city",
    shot: Shot {
        source: "generate:city?polygons=60000&seed=7",
        path: "figure 8",
        frame: 235,
        size: [256, 256],
        angle: 1.0,
        settings: &[("adapt", "false"), ("occluder-budget", "2000"), ("depth", "samples")],
    },
    cut: 1.2,
    words: "A generated city from behind and above the Eye; roofs and upper floors are left out, so that \
            walls and furniture are seen; ground and floors are gray, whatever became of them.",
    paper: "The paper's city has 312,524 polygons, and its frames are about five times faster.",
};
const SWARM: Model = Model {
    title: "Zhang et al. 1997, Figure 12: bodies that move",
    shot: Shot {
        source: "generate:swarm?polygons=60000",
        path: "views",
        frame: 0,
        size: [256, 256],
        angle: 1.0,
        settings: &[
            ("adapt", "false"),
            ("occluder-budget", "3000"),
            ("depth", "samples"),
            ("occluder-size", "0"),
        ],
    },
    cut: f32::INFINITY,
    words: "A generated swarm of animals and teapots from behind and above the Eye, in the first frame of \
            its motion.",
    paper: "The paper's dinosaurs and teapots have 986,800 polygons, and its frames are about five times \
            faster.",
};
const ROOM: Model = Model {
    title: "Zhang et al. 1997, Figure 13: a machine room",
    shot: Shot {
        source: "generate:machine-room?polygons=40000",
        path: "flight",
        frame: 200,
        size: [256, 256],
        angle: 1.0,
        settings: &[("adapt", "false"), ("occluder-budget", "1500"), ("depth", "samples")],
    },
    cut: 1.6,
    words: "A generated machine room from behind and above the Eye; what begins above 1.6 m is left out, \
            and the floor is gray, whatever became of it.",
    paper: "The paper's auxiliary machine room has 632,252 polygons, and its frames are about twice as fast.",
};

/// The legend of plates.
pub fn legend() -> Vec<Entry> {
    vec![
        entry(Role::Occluder, Swatch::Area, "occluder"),
        entry(Role::Visible, Swatch::Area, "kept: drawn"),
        entry(Role::Hidden, Swatch::Area, "culled: hidden"),
        entry(Role::Outside, Swatch::Area, "culled: outside the view"),
        entry(Role::Eye, Swatch::Line, "the Eye and its view"),
    ]
}

impl Model {
    fn draw(&self, maker: &Maker<'_>) -> Result<Drawing, SceneError> {
        let film = self.shot.film(maker)?;
        let [drawn, hidden, ..] = counts(&*film);
        let label = format!("of {} triangles in view {} are drawn", number(drawn + hidden), number(drawn));
        let from_above = plate(maker.tint, &*film, &roles(&*film), self.cut, [480, 480], label);
        let pixels = seen(maker.tint, &*film, &kept(&*film));
        let image = Panel { label: "what the Eye sees".into(), picture: Picture::Pixels(pixels) };
        let content = panels(TWO_COLUMNS_PT, 2, &[from_above, image]);
        Ok(maker.page(Paper::TwoColumns, self.title, legend(), self.caption(&*film), &content))
    }
    fn caption(&self, film: &dyn Film<Solid>) -> String {
        let [drawn, hidden, ..] = counts(film);
        let in_view = drawn + hidden;
        format!(
            "{} Of its {} triangles {} are in view. {} of them are occluders; {} are drawn and {} culled, \
             {:.1} %: {:.1} times fewer are drawn than with view-frustum culling alone. The image is the \
             same, pixel by pixel. {}",
            self.words,
            number(film.scene().live().len()),
            number(in_view),
            number(occluder_prims(film) as usize),
            number(drawn),
            number(hidden),
            100.0 * hidden as f64 / in_view as f64,
            in_view as f64 / drawn as f64,
            self.paper
        )
    }
}

fn number(count: usize) -> String {
    grouped(count as f64, 0)
}

/// Figure 11.
pub fn city(maker: &Maker<'_>) -> Result<Drawing, SceneError> {
    CITY.draw(maker)
}
/// Figure 12.
pub fn swarm(maker: &Maker<'_>) -> Result<Drawing, SceneError> {
    SWARM.draw(maker)
}
/// Figure 13.
pub fn room(maker: &Maker<'_>) -> Result<Drawing, SceneError> {
    ROOM.draw(maker)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::raster::render;

    #[test]
    fn what_is_drawn_is_the_whole_image_and_much_less() {
        for (model, least) in [(CITY, 60.0), (SWARM, 20.0), (ROOM, 40.0)] {
            let film = model.shot.film(&Maker::gray()).expect("a scene");
            let (scene, view) = (film.scene(), film.view());
            let image = |prims: &[crate::geometry::PrimId]| render(&**scene, view, prims);
            assert_eq!(image(&kept(&*film)), image(scene.live()), "{}", model.title);
            let [drawn, hidden, presumed, _] = counts(&*film);
            assert_eq!(presumed, 0, "{}", model.title);
            let share = 100.0 * hidden as f64 / (drawn + hidden) as f64;
            assert!(share > least, "{}: {share} % culled", model.title);
            let few = f64::from(occluder_prims(&*film)) / (drawn + hidden) as f64;
            assert!(few < 0.35, "{}: {few} of what is in view are occluders", model.title);
        }
    }
}
