//! What is on screen as a figure file: any of its pictures on paper, with legend and caption. The window and
//! the command line write the same bytes. Every file carries the session, so that opening it brings
//! everything back, and the command that makes it again.

use std::path::Path;

use glam::Vec2;

use super::plate::{Export, Made, PAPERS, Picture, word};
use super::session::{Session, SessionError, write_file};
use super::shown::{LookIn, Theme};
use super::stage::Staged;
use super::state::State;
use super::surfaces::Ask;
use crate::drawing::words::count;
use crate::drawing::{Drawing, Role, Subject};
use crate::figure::page::{Entry, Swatch};
use crate::figure::{self, Page, Panel, Paper, page, panels};
use crate::geometry::{Aabb, Either};
use crate::method::departs;
use crate::raster::DepthScale;
use crate::render::{self, Format, SvgOptions};

/// Pixels an inch of pictures of space.
const DPI: f32 = 300.0;
/// Longest figure file that is searched for a session, bytes.
const LIMIT_BYTES: u64 = 256 << 20;
/// Shapes of pictures, width over height.
const LEAST_ASPECT: f32 = 0.65;
const MOST_ASPECT: f32 = 5.0;
/// The shape of pictures of space that nobody gave one.
const COMMON_ASPECT: f32 = 4.0 / 3.0;
/// Room for the label below a picture, points.
const LABEL_PT: f32 = 17.0;
/// Pictures of methods are not enlarged beyond this.
const MOST_ENLARGED: f32 = 1.6;

impl State {
    /// What can be made a figure of, by word.
    pub fn pictures(&self) -> Vec<(Picture, String)> {
        let own = self.film().map_or(&[][..], |f| f.reel.pictures());
        let own = own.iter().enumerate().map(|(i, name)| (Picture::Own(i), word(name)));
        let shared = [(Picture::Observer, "observer"), (Picture::Eye, "eye"), (Picture::Code, "pseudocode")];
        shared.into_iter().map(|(picture, name)| (picture, name.to_owned())).chain(own).collect()
    }

    /// The picture that the window's export shows.
    pub fn exported(&self) -> Picture {
        match self.export_of {
            Picture::Own(_) => {
                let count = self.film().map_or(0, |f| f.reel.pictures().len());
                Picture::Own(self.own_picture.min(count.saturating_sub(1)))
            }
            picture => picture,
        }
    }

    /// The shape that suits the Observer's picture, width over height.
    pub fn fitting_aspect(&self) -> f32 {
        match &self.stage {
            Some(Either::Flat(s)) => {
                let size = s.framed(Subject::None).size();
                (size.x / size.y.max(1e-6)).clamp(0.75, 2.5)
            }
            _ => COMMON_ASPECT,
        }
    }

    /// The figure as a page, and its alternative text as its description; `None` before there is a film, and
    /// of a picture that the method does not have.
    pub fn figure(&self, export: &Export) -> Option<Drawing> {
        let stage = self.staged()?;
        let reel = stage.film()?.reel;
        let card = reel.card();
        let aspect = export.aspect.clamp(LEAST_ASPECT, MOST_ASPECT);
        let mut page = Page {
            paper: export.paper,
            title: card.name.to_owned(),
            legend: Vec::new(),
            caption: self.caption(export.picture)?,
        };
        let (mut content, entries) = self.content(export, aspect, page.room_pt())?;
        page.legend = entries;
        let room = page.room_pt();
        // The legend takes room that only a slide, or a high picture, has not.
        if content.size_pt.y > room.y {
            content = self.content(export, aspect, room)?.0;
        }
        let legend: Vec<&str> = page.legend.iter().map(|e| e.label.as_str()).collect();
        let of = if legend.is_empty() { String::new() } else { format!(" Shown: {}.", legend.join("; ")) };
        content.description = page.caption.clone() + &of;
        Some(page.compose(&content))
    }

    /// A picture as large as the room, and its legend.
    fn content(&self, export: &Export, aspect: f32, room: Vec2) -> Option<(Drawing, Vec<Entry>)> {
        let label = format!("step {} of {}", count(self.step), count(self.len()));
        match export.picture {
            Picture::Observer => {
                let width = room.x.min((room.y - LABEL_PT) * aspect).max(60.0);
                let (picture, marks) = self.observed(export, aspect, width)?;
                Some((panels(width, 1, &[Panel { label, picture }]), self.entries(marks)))
            }
            Picture::Eye => self.seen(export, room, label),
            Picture::Code => {
                let drawing = self.listed(room.x)?;
                let shrunk = (room.y / drawing.size_pt.y.max(1.0)).min(1.0);
                let drawing = drawing.scaled(shrunk);
                let entries = self.entries_of(&drawing);
                Some((drawing, entries))
            }
            Picture::Own(which) => {
                let reel = self.film()?.reel;
                reel.pictures().get(which)?;
                let mut drawing = reel.picture(self.step, which, self.depths);
                let free = room / drawing.size_pt.max(Vec2::ONE);
                drawing = drawing.scaled(free.min_element().min(MOST_ENLARGED));
                // Roles have meanings of their own there, which it tells itself.
                Some((drawing, Vec::new()))
            }
        }
    }

    /// The Observer's picture, and the roles of its marks.
    fn observed(&self, export: &Export, aspect: f32, width: f32) -> Option<(figure::Picture, Vec<Entry>)> {
        let look = self.look();
        Some(match self.stage.as_ref()? {
            Either::Flat(s) => {
                let half = Vec2::new(self.observer.distance * aspect, self.observer.distance);
                let center = Vec2::new(self.observer.pivot[0], self.observer.pivot[1]);
                let world = s.world(self.step, &look)?;
                let marks = page::legend(&world);
                (figure::Picture::Flat(world, Aabb { min: center - half, max: center + half }), marks)
            }
            Either::Solid(s) => {
                let film = s.recorded.as_ref()?;
                let world = figure::world(&*film.film, &film.stamps, self.step, &look);
                let size = Vec2::new(width, width / aspect) * DPI / 72.0;
                let view = self.observer.view(size.x.round() as u32, size.y.round() as u32);
                if export.is_vector {
                    let (faces, over) = s.faces(&view, &self.ask(export, false))?;
                    // Without an order there is no figure, rather than one without surfaces.
                    figure::solved(&faces, &view, Vec2::ZERO, Vec2::ONE)?;
                    return Some((figure::Picture::Solved(faces, over, view), page::legend(&world)));
                }
                let (pixels, over) = s.surfaces(&view, &self.ask(export, false))?;
                (figure::Picture::Over(pixels, over, view), page::legend(&world))
            }
        })
    }

    pub(super) fn ask(&self, export: &Export, is_eye: bool) -> Ask {
        Ask {
            step: self.step,
            look: self.look(),
            shown: self.shown,
            is_eye,
            theme: export.theme,
            pixels_per_point: DPI / 72.0,
        }
    }

    /// The legend of the screen, then what else the picture shows.
    pub(super) fn entries(&self, marks: Vec<Entry>) -> Vec<Entry> {
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

    /// The roles that the pseudocode shows, in the words of the screen's legend.
    fn entries_of(&self, drawing: &Drawing) -> Vec<Entry> {
        let words = self.legend();
        let mut entries = page::legend(drawing);
        entries.retain_mut(|entry| {
            let word = words.iter().find(|(role, _)| *role == entry.role);
            word.inspect(|(_, label)| entry.label.clone_from(label)).is_some()
        });
        entries
    }

    /// Method, scene, view, what is not by default, the step, and where the method departs from its paper.
    fn caption(&self, picture: Picture) -> Option<String> {
        let stage = self.staged()?;
        let reel = stage.film()?.reel;
        let (card, scene) = (reel.card(), stage.scene());
        let mut said = vec![view_in_words(stage)];
        if let Some((frame, count)) = stage.frame_of_motion() {
            said.push(format!("frame {} of {count} of what moves", frame + 1));
        }
        said.extend(stage.changed().into_iter().map(|(name, value)| format!("{name} {value}")));
        said.extend(match self.shown.look_in {
            _ if picture != Picture::Observer || matches!(self.stage, Some(Either::Flat(_))) => None,
            LookIn::Off => None,
            LookIn::Cut => Some("cut at the Eye's height".into()),
            LookIn::Faces => Some("without faces that turn their back".into()),
        });
        let what = match picture {
            Picture::Observer => String::new(),
            Picture::Eye => "What the Eye sees. ".into(),
            Picture::Code => "Pseudocode; gray are lines that this frame never comes to. ".into(),
            Picture::Own(which) => {
                let depths = match self.depths {
                    DepthScale::Logarithmic => String::new(),
                    scale => format!(", depths {}", scale.name()),
                };
                format!("{}{depths}. ", crate::drawing::words::capitalized(reel.pictures().get(which)?))
            }
        };
        let sentence = self.sentence();
        let stop = if sentence.ends_with(['.', '!', '?']) { "" } else { "." };
        Some(format!(
            "{what}{}, {}: {} {}s; {}. Step {} of {}: {sentence}{stop}{}",
            card.name,
            scene.name(),
            count(scene.live_count()),
            scene.prim_name(),
            said.join(", "),
            count(self.step),
            count(self.len()),
            departs(card.key, &card.departing(|d| d.holds(reel.knobs())))
        ))
    }

    /// The file's bytes; `file` is where it will lie.
    ///
    /// # Errors
    /// Why there is no such figure, in a line.
    pub fn figure_file(&self, export: &Export, format: Format, file: &str) -> Result<Vec<u8>, String> {
        let recipe = Session { figure: Some(self.made(export, format, file)), ..self.session_in(Some(file)) };
        self.figure_with(export, format, &recipe.text())
    }

    /// The same with the text that it carries.
    ///
    /// # Errors
    /// Why there is no such figure, in a line.
    pub fn figure_with(&self, export: &Export, format: Format, recipe: &str) -> Result<Vec<u8>, String> {
        if let Some(Either::Solid(stage)) = self.stage.as_ref().filter(|_| export.is_vector) {
            stage.refuse_vectors()?;
        }
        let drawing = self.figure(export).ok_or(if export.is_vector {
            "surfaces pierce each other too often for vectors; leave them as pixels"
        } else {
            "there is nothing to make a figure of yet"
        })?;
        if format == Format::Svg {
            let options = SvgOptions { outline_text: export.outline_text, metadata: Some(recipe) };
            return Ok(render::svg(&drawing, export.theme, &options).into_bytes());
        }
        render::export(&drawing, format, export.theme, recipe).map_err(|e| e.to_string())
    }

    /// The name of a figure's file, without its ending; the step has at least so many digits.
    pub fn figure_name(&self, export: &Export, digits: usize) -> String {
        let scene = self.staged().map_or("figure", |s| s.scene().name()).replace(['/', '\\', ' '], "-");
        let picture = match export.picture {
            Picture::Observer => String::new(),
            picture => format!("-{}", self.picture_word(picture)),
        };
        format!("{scene}-{}-step-{:0digits$}{picture}", self.method, self.step)
    }

    fn picture_word(&self, picture: Picture) -> String {
        self.pictures().into_iter().find(|(p, _)| *p == picture).map_or_else(String::new, |(_, word)| word)
    }

    /// How a figure is made, for its file.
    fn made(&self, export: &Export, format: Format, file: &str) -> Made {
        let folder = Path::new(file).parent().unwrap_or(Path::new(""));
        Made {
            command: self.command(export, format, folder),
            picture: self.picture_word(export.picture),
            paper: export.paper_word().into(),
            theme: export.theme.name().into(),
            text: export.text_word().into(),
            aspect: export.aspect,
            vectors: export.is_vector,
        }
    }

    /// The figure that a file says how to make, of what is on stage.
    ///
    /// # Errors
    /// A word that is not known, in a line.
    pub fn export_like(&self, made: &Made) -> Result<Export, String> {
        let unknown = |what: &str, word: &str| format!("there is no {what} `{word}`");
        let picture = self.pictures().into_iter().find(|(_, word)| *word == made.picture);
        let paper = PAPERS.iter().find(|(word, _)| *word == made.paper);
        let theme = Theme::ALL.into_iter().find(|t| t.name() == made.theme);
        Ok(Export {
            picture: picture.ok_or_else(|| unknown("picture", &made.picture))?.0,
            paper: paper.ok_or_else(|| unknown("size of figures", &made.paper))?.1,
            theme: theme.ok_or_else(|| unknown("theme", &made.theme))?,
            outline_text: made.text == "paths",
            aspect: made.aspect,
            is_vector: made.vectors,
        })
    }

    /// The figure that the window's export makes.
    pub fn export_like_window(&self, aspect: f32) -> Export {
        let (paper, theme) = (Paper::TwoColumns, Theme::Print);
        let is_vector = self.exports_vectors;
        Export { picture: self.exported(), paper, theme, outline_text: false, aspect, is_vector }
    }

    /// Writes the picture on screen into [`State::folder`], and reports where; `aspect` is that of the
    /// Observer's window, width over height.
    pub fn export(&mut self, format: Format, aspect: f32) {
        if self.film().is_none() {
            return self.fail("There is nothing to export yet.");
        }
        let export = self.export_like_window(aspect);
        let path = self.free_path(&self.figure_name(&export, 1), format.name());
        let bytes = self.figure_file(&export, format, &path);
        match bytes.and_then(|b| write_file(&path, &b).map_err(|e| e.to_string())) {
            Ok(()) => self.tell(format!("The figure was written to {path}.")),
            Err(error) => self.fail(error),
        }
    }

    /// A path where nothing is yet: other views of a step have the same name.
    fn free_path(&self, name: &str, extension: &str) -> String {
        let first = self.path_of(&format!("{name}.{extension}"));
        let more = (2..1000).map(|i| self.path_of(&format!("{name}-{i}.{extension}")));
        std::iter::once(first.clone()).chain(more).find(|p| !Path::new(p).exists()).unwrap_or(first)
    }
}

fn view_in_words(stage: &dyn Staged) -> String {
    let (path, frame) = stage.place();
    match stage.paths().get(path) {
        Some((name, views)) if *views > 1 && !stage.is_eye_moved() => {
            format!("view {} of {} of path {name}", count(frame + 1), count(*views))
        }
        _ => stage.eye_words(),
    }
}

/// Whether a path may be a figure of ours, by its name.
pub(super) fn is_figure(source: &str) -> bool {
    let lower = source.to_lowercase();
    [".svg", ".pdf", ".png"].iter().any(|e| lower.ends_with(e))
}

/// The session that a figure file carries.
pub(super) fn session_in(path: &str) -> Result<Session, SessionError> {
    match recipe_in(path)? {
        Some((text, _)) => Session::parse(&text, path),
        None => Err(SessionError::NoSession { path: path.into() }),
    }
}

/// The text that a figure file carries, and all of the file; `None` if it carries none.
///
/// # Errors
/// If it cannot be read, or is longer than any figure.
pub fn recipe_in(path: &str) -> Result<Option<(String, Vec<u8>)>, SessionError> {
    let io = |why| SessionError::Io { path: path.into(), why };
    let meta = std::fs::metadata(path).map_err(io)?;
    if !meta.is_file() || meta.len() > LIMIT_BYTES {
        return Err(SessionError::TooLong { path: path.into() });
    }
    let bytes = std::fs::read(path).map_err(io)?;
    Ok(render::recipe(&bytes).map(|text| (text, bytes)))
}
