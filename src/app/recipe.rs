//! The command that makes a figure again.

use std::path::Path;

use super::camera::ObserverCamera;
use super::command::Action;
use super::open::named_from;
use super::plate::{Export, Form, Picture};
use super::recall::{numbers_spoken, spoken_subject};
use super::shown::{LookIn, Surface};
use super::state::State;
use crate::drawing::Subject;
use crate::raster::DepthScale;
use crate::render::Format;

impl State {
    /// The command line that makes a figure's file again in its folder: where its views came from elsewhere,
    /// from itself.
    pub(super) fn command(&self, export: &Export, format: Format, file: &Path) -> String {
        let Some(stage) = self.staged() else { return String::new() };
        let folder = file.parent().unwrap_or(Path::new(""));
        if !stage.is_path_of_scene() {
            let name = file.file_name().unwrap_or_default().to_string_lossy();
            return format!("cullscope figure --scene {} --format {}", quoted(&name), format.name());
        }
        let scene = named_from(stage.scene().source(), Some(folder));
        let mut words: Vec<String> = ["cullscope", "figure", "--scene"].map(String::from).to_vec();
        words.extend([quoted(&scene), "--method".into(), self.method.clone()]);
        for (name, value) in &self.settings.0 {
            words.extend(["--set".into(), quoted(&format!("{name}={value}"))]);
        }
        let (path, frame) = stage.place();
        for spoken in ((path, frame) != (0, 0))
            .then(|| format!("frame:{path}:{frame}"))
            .into_iter()
            .chain(self.spoken_look(export))
        {
            words.extend(["--do".into(), spoken]);
        }
        if stage.is_eye_moved() {
            words.push(stage.eye_text());
        }
        words.extend(match export.steps {
            Some(steps) => ["--steps".into(), steps.to_string()],
            None => ["--step".into(), self.step.to_string()],
        });
        words.extend(["--picture".into(), self.picture_words(export)]);
        if export.steps.is_some() || export.shown().len() > 1 {
            words.extend(["--as", export.form.word()].map(String::from));
        }
        if let Form::Animation(rate) = export.form {
            words.extend(["--rate".into(), rate.to_string()]);
        }
        words.extend(["--paper".into(), export.paper.word()]);
        words.extend(["--theme", export.theme.name()].map(String::from));
        let aspect = self.aspect_of(export);
        if aspect != self.fitting_aspect() {
            words.extend(["--aspect".into(), aspect.to_string()]);
        }
        if export.is_vector {
            words.push("--vectors".into());
        }
        if export.outline_text {
            words.extend(["--text", "paths"].map(String::from));
        }
        words.extend(["--format", format.name()].map(String::from));
        words.join(" ")
    }

    /// The commands of the explorer that lead from what it begins with to what is shown.
    fn spoken_look(&self, export: &Export) -> Vec<String> {
        let shown = &self.shown;
        let toggles = [
            (shown.prims, Action::ShowPrims),
            (shown.nodes, Action::ShowNodes),
            (shown.eye, Action::ShowEye),
            (shown.evidence, Action::ShowEvidence),
            (shown.surface == Surface::Solid, Action::CycleSurface),
            (shown.surface != Surface::Translucent, Action::CycleSurface),
            (shown.look_in == LookIn::Off, Action::CycleLookIn),
            (shown.look_in != LookIn::Faces, Action::CycleLookIn),
        ];
        let off = toggles.into_iter().filter(|(is_usual, _)| !is_usual);
        let mut spoken: Vec<String> = off.map(|(_, action)| action.info().name.to_owned()).collect();
        spoken.extend(match self.selection {
            Subject::None => None,
            Subject::Eye => Some(Action::SelectEye.info().name.to_owned()),
            subject => spoken_subject(subject).map(|thing| format!("select:{thing}")),
        });
        let hidden = self.unshown();
        if !hidden.is_empty() {
            spoken.push(format!("hide:{}", numbers_spoken(hidden.into_iter().map(|object| object.0))));
        }
        if self.depths != DepthScale::default() {
            spoken.push(format!("depths:{}", self.depths.name()));
        }
        // That of a figure of another one is the one that is shown.
        if self.own_picture > 0 && !matches!(export.shown(), [Picture::Own(_)]) {
            let shown = self.pictures().into_iter().find(|(p, _)| *p == Picture::Own(self.own_picture));
            spoken.extend(shown.map(|(_, word)| format!("picture:{word}")));
        }
        if self.observer != self.framing(self.aspect_of(export)) {
            spoken.push(format!("observe:{}", self.observer.numbers()));
        }
        spoken
    }

    /// The Observer who has everything in sight, in a picture of this shape.
    pub fn framing(&self, aspect: f32) -> ObserverCamera {
        use crate::geometry::Either;
        let mut camera = ObserverCamera::default();
        match &self.stage {
            Some(Either::Flat(s)) => {
                camera.frame_flat(&s.framed(Subject::None), &s.posed().bounds(), aspect);
            }
            Some(Either::Solid(s)) => {
                camera.frame_solid(&s.framed(Subject::None), &s.posed().bounds(), aspect);
            }
            None => {}
        }
        camera
    }
}

/// A word for a shell.
fn quoted(word: &str) -> String {
    let is_plain = |c: char| c.is_alphanumeric() || "-_./:=,+%@".contains(c);
    if !word.is_empty() && word.chars().all(is_plain) {
        return word.to_owned();
    }
    format!("'{}'", word.replace('\'', "'\\''"))
}
