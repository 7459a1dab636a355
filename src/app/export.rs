//! The picture on screen as a figure file: the Observer's window on paper, with legend and caption, in the
//! print theme. Every file carries the session, so that opening it brings everything back.

use glam::Vec2;

use super::session::{Session, SessionError, write_file};
use super::shown::{LookIn, Theme};
use super::state::State;
use crate::drawing::words::count;
use crate::drawing::{Drawing, Mark, Pixels, Role, Subject};
use crate::figure::page::{Entry, Swatch};
use crate::figure::{self, Page, Panel, Paper, Picture, page, panels};
use crate::geometry::{Aabb, Either};
use crate::render::{self, Format};

/// Width of the picture, points: two columns of a paper, 17.5 cm.
pub const WIDTH_PT: f32 = 490.0;
/// Longest figure file that is searched for a session, bytes.
const LIMIT_BYTES: u64 = 256 << 20;

impl State {
    /// The present picture as a page; `aspect` is that of the Observer's window, width over height. `pixels`
    /// are the Observer's picture of space, whose surfaces hide each other as they do on screen; its labels
    /// are written over it. Without a graphics card space is drawn as vectors, sorted by depth.
    pub fn figure(&self, aspect: f32, pixels: Option<Pixels>) -> Option<Drawing> {
        let (stage, look) = (self.staged()?, self.look());
        let scene = stage.scene();
        let aspect = aspect.clamp(0.2, 5.0);
        let marks;
        let picture = match (self.stage.as_ref()?, pixels) {
            (Either::Flat(s), _) => {
                let film = s.recorded.as_ref()?;
                let half = Vec2::new(self.observer.distance * aspect, self.observer.distance);
                let center = Vec2::new(self.observer.pivot[0], self.observer.pivot[1]);
                let world = figure::world(&*film.film, &film.stamps, self.step, &look);
                marks = page::legend(&world);
                Picture::Flat(world, Aabb { min: center - half, max: center + half })
            }
            (Either::Solid(s), pixels) => {
                let film = s.recorded.as_ref()?;
                let view = self.observer.view(1200, (1200.0 / aspect) as u32);
                let mut world = figure::world(&*film.film, &film.stamps, self.step, &look);
                marks = page::legend(&world);
                match pixels {
                    Some(pixels) => {
                        world.items.retain(|i| matches!(i.mark, Mark::Text { .. }));
                        Picture::Over(pixels, world, view)
                    }
                    None => Picture::Space(world, view),
                }
            }
        };
        let label = format!("step {} of {}", count(self.step), count(self.len()));
        let content = panels(WIDTH_PT, 1, &[Panel { label, picture }]);
        let film = stage.film()?.reel;
        let card = film.card();
        let caption = format!(
            "{}, {}: {} {}s; {}. {}",
            card.name,
            scene.name(),
            count(scene.live_count()),
            scene.prim_name(),
            self.conditions(),
            self.sentence()
        );
        let page = Page {
            paper: Paper::TwoColumns,
            title: card.name.to_owned(),
            legend: self.entries(marks),
            caption,
        };
        Some(page.compose(&content))
    }

    /// The legend of the screen, then what else the picture shows.
    fn entries(&self, marks: Vec<Entry>) -> Vec<Entry> {
        let area = |(role, label)| Entry { role, label, swatch: Swatch::Area };
        let mut entries: Vec<Entry> = self.legend().into_iter().map(area).collect();
        for entry in &mut entries {
            // In flatland as lines, as the picture has them.
            if let Some(mark) = marks.iter().find(|m| m.role == entry.role) {
                entry.swatch = mark.swatch;
            }
        }
        let is_marked = |role| marks.iter().any(|m| m.role == role);
        entries.retain(|e| match e.role {
            Role::Current => self.current_subject() != Subject::None,
            Role::Selected => self.selection != Subject::None,
            role => is_marked(role) || !matches!(role, Role::Partial | Role::Occluder),
        });
        entries.extend(marks.into_iter().filter(|m| matches!(m.role, Role::Eye | Role::Evidence)));
        entries
    }

    /// What of the parameters and of the way to look the picture depends on, in a caption's words.
    fn conditions(&self) -> String {
        let knobs = self.film().map_or(&[][..], |f| f.reel.knobs()).iter();
        let set = knobs.filter(|(k, _)| self.settings.0.contains_key(k.name));
        let mut said: Vec<String> = set.map(|(k, v)| format!("{} {v}", k.name)).collect();
        said.push(
            if said.is_empty() { "all parameters at their defaults" } else { "the rest by default" }.into(),
        );
        if let Some((frame, count)) = self.staged().and_then(|s| s.frame_of_motion()) {
            said.push(format!("frame {} of {count} of what moves", frame + 1));
        }
        said.extend(match self.shown.look_in {
            _ if matches!(self.stage, Some(Either::Flat(_))) => None,
            LookIn::Off => None,
            LookIn::Cut => Some("cut at the Eye's height".into()),
            LookIn::Faces => Some("without faces that turn their back".into()),
        });
        said.join(", ")
    }

    /// Writes the picture on screen into [`State::folder`], and reports where.
    pub fn export(&mut self, format: Format, aspect: f32, pixels: Option<Pixels>) {
        let Some(drawing) = self.figure(aspect, pixels) else {
            return self.fail("There is nothing to export yet.");
        };
        let scene = self.staged().map_or("figure", |s| s.scene().name()).replace(['/', '\\', ' '], "-");
        let path = self.path_of(&format!("{scene}-{}-step-{}.{}", self.method, self.step, format.name()));
        let recipe = self.session_in(Some(&path)).text();
        let bytes = render::export(&drawing, format, Theme::Print, &recipe);
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
