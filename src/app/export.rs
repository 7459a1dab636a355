//! What is on screen as a figure file: any of its pictures on paper, with legend and caption. The window and
//! the command line write the same bytes. Every file carries the session, so that opening it brings
//! everything back, and the command that makes it again.

use std::path::Path;

use glam::Vec2;

use super::plate::{Export, Form, Made, Picture, RATE, word};
use super::session::{Session, SessionError, write_file};
use super::shown::{Dialog, LookIn, Theme};
use super::stage::Staged;
use super::state::State;
use super::surfaces::Ask;
use crate::drawing::words::count;
use crate::drawing::{Drawing, Role, Subject};
use crate::figure::page::{Entry, Swatch};
use crate::figure::{self, Panel, labelled, page, panels};
use crate::geometry::{Aabb, Either};
use crate::method::departs;
use crate::raster::DepthScale;
use crate::render::{self, Format};

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
/// No picture is narrower, points.
const LEAST_PT: f32 = 20.0;
/// Letters below this are hard to read on paper.
pub const SMALL_PT: f32 = 5.0;
/// Figures of fewer parts are made at once.
const LONG_PARTS: usize = 4;

impl State {
    /// What can be made a figure of, by word.
    pub fn pictures(&self) -> Vec<(Picture, String)> {
        let own = self.film().map_or(&[][..], |f| f.reel.pictures());
        let own = own.iter().enumerate().map(|(i, name)| (Picture::Own(i), word(name)));
        let shared = [(Picture::Observer, "observer"), (Picture::Eye, "eye"), (Picture::Code, "pseudocode")];
        let twin = matches!(self.stage, Some(Either::Solid(_))).then_some((Picture::Twin, "flatland-twin"));
        shared.into_iter().chain(twin).map(|(picture, name)| (picture, name.to_owned())).chain(own).collect()
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

    /// A picture as large as the room, with a label below it (or without, if it is empty), and its legend.
    pub(super) fn content(
        &self,
        export: &Export,
        picture: Picture,
        room: Vec2,
        label: &str,
    ) -> Option<(Drawing, Vec<Entry>)> {
        let below = |drawing: Drawing| if label.is_empty() { drawing } else { labelled(drawing, label) };
        let room = if label.is_empty() { room } else { room - Vec2::new(0.0, LABEL_PT) };
        match picture {
            Picture::Observer => {
                let aspect = self.aspect_of(export);
                let width = room.x.min(room.y * aspect).max(LEAST_PT);
                let (picture, marks) = self.observed(export, aspect, width)?;
                let panel = Panel { label: label.to_owned(), picture };
                Some((panels(width, 1, &[panel]), self.entries(marks)))
            }
            Picture::Eye => self.seen(export, room, label.to_owned()),
            Picture::Code => {
                let drawing = self.listed(room.x)?;
                let shrunk = (room.y / drawing.size_pt.y.max(1.0)).min(1.0);
                let drawing = drawing.scaled(shrunk);
                let entries = self.entries_of(&drawing);
                Some((below(drawing), entries))
            }
            // The run beside this one draws it.
            Picture::Twin => None,
            Picture::Own(which) => {
                let reel = self.film()?.reel;
                reel.pictures().get(which)?;
                let mut drawing = reel.picture(self.step, which, self.depths);
                let free = room / drawing.size_pt.max(Vec2::ONE);
                drawing = drawing.scaled(free.min_element().min(MOST_ENLARGED));
                // Roles have meanings of their own there, which it tells itself.
                Some((below(drawing), Vec::new()))
            }
        }
    }

    /// Width over height of the Observer's picture.
    pub(super) fn aspect_of(&self, export: &Export) -> f32 {
        export.aspect.unwrap_or_else(|| self.fitting_aspect()).clamp(LEAST_ASPECT, MOST_ASPECT)
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
                let size = Vec2::new(width, width / aspect) * export.dpi() / 72.0;
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
            pixels_per_point: export.dpi() / 72.0,
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

    /// Method, scene, view, what is not by default, the step (or what is said of several), and where the
    /// method departs from its paper.
    pub(super) fn caption(&self, pictures: &[Picture], steps: Option<&str>) -> Option<String> {
        let stage = self.staged()?;
        let reel = stage.film()?.reel;
        let (card, scene) = (reel.card(), stage.scene());
        let mut said = vec![view_in_words(stage)];
        if let Some((frame, count)) = stage.frame_of_motion() {
            said.push(format!("frame {} of {count} of what moves", frame + 1));
        }
        said.extend(stage.changed().into_iter().map(|(name, value)| format!("{name} {value}")));
        said.extend(match self.shown.look_in {
            _ if !pictures.contains(&Picture::Observer) || matches!(self.stage, Some(Either::Flat(_))) => {
                None
            }
            LookIn::Off => None,
            LookIn::Cut => Some("cut at the Eye's height".into()),
            LookIn::Faces => Some("without faces that turn their back".into()),
        });
        let gray = "gray are lines that this frame never comes to. ";
        let what = match *pictures {
            [Picture::Observer] => String::new(),
            [Picture::Eye] => "What the Eye sees. ".into(),
            [Picture::Code] => format!("Pseudocode; {gray}"),
            [Picture::Own(which)] => {
                let depths = match self.depths {
                    DepthScale::Logarithmic => String::new(),
                    scale => format!(", depths {}", scale.name()),
                };
                format!("{}{depths}. ", crate::drawing::words::capitalized(reel.pictures().get(which)?))
            }
            _ if pictures.contains(&Picture::Code) => format!("Of the pseudocode {gray}"),
            _ => String::new(),
        };
        let told = match steps {
            Some(steps) => format!("{steps} of {}.", count(self.len())),
            None => {
                let sentence = self.sentence();
                let stop = if sentence.ends_with(['.', '!', '?']) { "" } else { "." };
                format!("Step {} of {}: {sentence}{stop}", count(self.step), count(self.len()))
            }
        };
        Some(format!(
            "{what}{}, {}: {} {}s; {}. {told}{}",
            card.name,
            scene.name(),
            count(scene.live_count()),
            scene.prim_name(),
            said.join(", "),
            departs(card.key, &card.departing(|d| d.holds(reel.knobs())))
        ))
    }

    /// The text that a figure's file carries; `file` is where it will lie.
    pub fn recipe(&self, export: &Export, format: Format, file: &str) -> String {
        let figure = Some(self.made(export, format, file));
        let mut session = Session { figure, ..self.session_in(Some(file)) };
        // A figure of one picture is opened with it.
        if let [Picture::Own(which)] = export.shown() {
            session.shown.picture = self.own_word(*which);
        }
        session.text()
    }

    /// The bytes of a figure's file that carries a text.
    ///
    /// # Errors
    /// Why there is no such figure, in a line.
    pub fn figure_with(&mut self, export: &Export, format: Format, recipe: &str) -> Result<Vec<u8>, String> {
        let mut making = self.begin(export, format, recipe)?;
        loop {
            if let Some(bytes) = self.go_on(&mut making)? {
                return Ok(bytes);
            }
        }
    }

    /// The name of a figure's file, without its ending; the step has at least so many digits.
    pub fn figure_name(&self, export: &Export, digits: usize) -> String {
        let scene = self.staged().map_or("figure", |s| s.scene().name()).replace(['/', '\\', ' '], "-");
        let step = match export.steps {
            None => format!("step-{:0digits$}", self.step),
            Some(steps) => format!("steps-{}-{}", steps.from, steps.to),
        };
        let shown = export.shown().iter();
        let pictures: String = match export.shown() {
            [Picture::Observer] => String::new(),
            _ => shown.map(|picture| format!("-{}", self.picture_word(*picture))).collect(),
        };
        format!("{scene}-{}-{step}{pictures}", self.method)
    }

    fn picture_word(&self, picture: Picture) -> String {
        self.pictures().into_iter().find(|(p, _)| *p == picture).map_or_else(String::new, |(_, word)| word)
    }

    /// The words of a figure's pictures, with commas.
    pub(super) fn picture_words(&self, export: &Export) -> String {
        export.shown().iter().map(|picture| self.picture_word(*picture)).collect::<Vec<_>>().join(",")
    }

    /// How a figure is made, for its file.
    fn made(&self, export: &Export, format: Format, file: &str) -> Made {
        Made {
            command: self.command(export, format, Path::new(file)),
            picture: self.picture_words(export),
            steps: export.steps.map(|steps| steps.to_string()),
            form: export.steps.map(|_| export.form.word().into()),
            rate: if let Form::Animation(rate) = export.form { Some(rate) } else { None },
            paper: export.paper.word(),
            theme: export.theme.name().into(),
            text: export.text_word().into(),
            aspect: self.aspect_of(export),
            vectors: export.is_vector,
        }
    }

    /// The figure that a file says how to make, of what is on stage.
    ///
    /// # Errors
    /// A word that is not known, in a line.
    pub fn export_like(&self, made: &Made) -> Result<Export, String> {
        let unknown = |what: &str, word: &str| format!("there is no {what} `{word}`");
        let known = self.pictures();
        let picture = |word: &str| {
            let found = known.iter().find(|(_, name)| name == word);
            found.map(|(picture, _)| *picture).ok_or_else(|| unknown("picture", word))
        };
        let theme = Theme::ALL.into_iter().find(|t| t.name() == made.theme);
        let form = made.form.as_deref().unwrap_or_default();
        Ok(Export {
            pictures: made.picture.split(',').map(picture).collect::<Result<_, _>>()?,
            steps: made.steps.as_deref().map(str::parse).transpose()?,
            form: match form {
                "pages" => Form::Pages,
                "animation" => Form::Animation(made.rate.unwrap_or(RATE)),
                "" | "page" => Form::Page,
                word => return Err(unknown("form of figures", word)),
            },
            paper: made.paper.parse().map_err(|_| unknown("size of figures", &made.paper))?,
            theme: theme.ok_or_else(|| unknown("theme", &made.theme))?,
            outline_text: made.text == "paths",
            aspect: Some(made.aspect),
            is_vector: made.vectors,
        })
    }

    /// Writes the figure that is set up into [`State::folder`], and reports where; `aspect` is that of the
    /// Observer's window, width over height.
    pub fn export(&mut self, format: Format, aspect: f32) {
        let export =
            Export { aspect: Some(self.exporting.aspect.unwrap_or(aspect)), ..self.exporting.clone() };
        let path = self.free_path(&self.figure_name(&export, 1), format.name());
        self.export_to(&export, &path);
    }

    /// Writes a figure to a file, whose ending tells the format; what takes long goes on as the explorer is
    /// asked whether there is news.
    pub(super) fn export_to(&mut self, export: &Export, path: &str) {
        self.dialog = Dialog::None;
        if self.film().is_none() {
            return self.fail("There is nothing to export yet.");
        }
        let ending = Path::new(path).extension().map(|e| e.to_string_lossy().to_lowercase());
        let begun =
            ending.unwrap_or_default().parse::<Format>().map_err(|e| e.to_string()).and_then(|format| {
                let recipe = self.recipe(export, format, path);
                self.begin(export, format, &recipe)
            });
        match begun {
            Ok(making) => {
                let is_short = making.parts() < LONG_PARTS;
                self.making = Some((making, path.to_owned()));
                while is_short && self.making.is_some() {
                    self.make();
                }
            }
            Err(why) => self.fail(why),
        }
    }

    /// Goes on with the figure that is being made, by one part.
    pub(super) fn make(&mut self) {
        let Some((mut making, path)) = self.making.take() else { return };
        let written = match self.go_on(&mut making) {
            Ok(None) => {
                self.making = Some((making, path));
                return;
            }
            Ok(Some(bytes)) => write_file(&path, &bytes).map_err(|e| e.to_string()),
            Err(why) => Err(why),
        };
        match written {
            Ok(()) => {
                self.tell(format!("The figure was written to {path}."));
                let least = making.least_letters_pt();
                if least < SMALL_PT {
                    self.tell(format!("Its smallest letters are {least:.1} pt: a larger size suits it."));
                }
            }
            Err(why) => self.fail(why),
        }
    }

    /// Whether a figure is being made, which goes on whenever the explorer is asked whether there is news.
    pub fn is_making(&self) -> bool {
        self.making.is_some()
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
