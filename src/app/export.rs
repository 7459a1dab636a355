//! The picture on screen as a figure file: the Observer's window on paper, with legend and caption, in the
//! print theme. Every file carries the session, so that opening it brings everything back.

use glam::Vec2;

use super::session::{Session, SessionError, write_file};
use super::shown::Theme;
use super::state::State;
use crate::drawing::{Drawing, Pixels};
use crate::figure::{self, Page, Panel, Paper, Picture, page, panels};
use crate::geometry::{Aabb, Either};
use crate::render::{self, Format};

/// Width of the picture, points: two columns of a paper, 17.5 cm.
const WIDTH_PT: f32 = 490.0;
/// Scenes of space with up to this many triangles become vectors; larger ones need pixels.
pub const VECTOR_PRIMS: usize = 5000;
/// Longest figure file that is searched for a session, bytes.
const LIMIT_BYTES: u64 = 256 << 20;

impl State {
    /// The present picture as a page; `aspect` is that of the Observer's window, width over height. `pixels`
    /// are the Observer's picture of a scene that is too large for vectors.
    pub fn figure(&self, aspect: f32, pixels: Option<Pixels>) -> Option<Drawing> {
        let (stage, look) = (self.staged()?, self.look());
        let scene = stage.scene();
        let aspect = aspect.clamp(0.2, 5.0);
        let picture = match (self.stage.as_ref()?, pixels) {
            (_, Some(pixels)) => Picture::Pixels(pixels),
            (Either::Flat(s), None) => {
                let film = s.recorded.as_ref()?;
                let half = Vec2::new(self.observer.distance * aspect, self.observer.distance);
                let center = Vec2::new(self.observer.pivot[0], self.observer.pivot[1]);
                Picture::Flat(
                    figure::world(&*film.film, &film.stamps, self.step, &look),
                    Aabb { min: center - half, max: center + half },
                )
            }
            (Either::Solid(s), None) => {
                let film = s.recorded.as_ref()?;
                let view = self.observer.view(1200, (1200.0 / aspect) as u32);
                Picture::Space(figure::world(&*film.film, &film.stamps, self.step, &look), view)
            }
        };
        let label = format!("step {} of {}", self.step, self.len());
        let content = panels(WIDTH_PT, 1, &[Panel { label, picture }]);
        let film = stage.film()?.reel;
        let card = film.card();
        let knobs =
            film.knobs().iter().map(|(k, v)| format!("{} {v}", k.name)).collect::<Vec<_>>().join(", ");
        let caption = format!(
            "{}, {}: {} {}s; {knobs}. {}",
            card.name,
            scene.name(),
            scene.live_count(),
            scene.prim_name(),
            self.sentence()
        );
        let page = Page {
            paper: Paper::TwoColumns,
            title: card.name.to_owned(),
            legend: page::legend(&content),
            caption,
        };
        Some(page.compose(&content))
    }

    /// Writes the picture on screen into [`State::folder`], and reports where.
    pub fn export(&mut self, format: Format, aspect: f32, pixels: Option<Pixels>) {
        let Some(drawing) = self.figure(aspect, pixels) else {
            return self.fail("There is nothing to export yet.");
        };
        let recipe = self.session().text();
        let bytes = render::export(&drawing, format, Theme::Print, &recipe);
        let scene = self.staged().map_or("figure", |s| s.scene().name()).replace(['/', '\\', ' '], "-");
        let path = self.path_of(&format!("{scene}-{}-step-{}.{}", self.method, self.step, format.name()));
        match bytes.map_err(|e| e.to_string()).and_then(|b| write_file(&path, &b).map_err(|e| e.to_string()))
        {
            Ok(()) => self.tell(format!("The figure was written to {path}.")),
            Err(error) => self.fail(error),
        }
    }
}

/// Whether a path may be a figure of ours, by its name.
pub(super) fn is_figure(source: &str) -> bool {
    let lower = source.to_lowercase();
    [".svg", ".pdf", ".png"].iter().any(|e| lower.ends_with(e))
}

/// The session that a figure file carries.
pub(super) fn session_in(path: &str) -> Result<Session, SessionError> {
    let io = |why| SessionError::Io { path: path.into(), why };
    let meta = std::fs::metadata(path).map_err(io)?;
    if !meta.is_file() || meta.len() > LIMIT_BYTES {
        return Err(SessionError::TooLong { path: path.into() });
    }
    let bytes = std::fs::read(path).map_err(io)?;
    match render::recipe(&bytes) {
        Some(text) => Session::parse(&text, path),
        None => Err(SessionError::NoSession { path: path.into() }),
    }
}
