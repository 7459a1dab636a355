//! Objects that the person does not want to see: they are only not shown, and culling goes on as before.

use std::collections::BTreeSet;

use super::command::Action;
use super::stage::Stage;
use super::state::State;
use crate::drawing::words::count;
use crate::drawing::{Drawing, Layer, Subject};
use crate::figure::{self, Look};
use crate::geometry::{ObjectId, PrimId, Space, each};

impl<S: Space> Stage<S> {
    /// Whether a primitive is shown in pictures of the scene.
    pub fn shows(&self, prim: PrimId) -> bool {
        self.unshown.is_empty() || !self.unshown.contains(&self.scene.object_of(prim))
    }
    /// The live primitives that are shown.
    pub fn shown_prims(&self) -> Vec<PrimId> {
        self.scene.live().iter().copied().filter(|&prim| self.shows(prim)).collect()
    }
    /// The marks of a step in the world, without those of primitives that are not shown; `None` without a
    /// film.
    pub fn world(&self, step: usize, look: &Look) -> Option<Drawing<S::Vector>> {
        let recorded = self.recorded.as_ref()?;
        let mut world = figure::world(&*recorded.film, &recorded.stamps, step, look);
        world.items.retain(|item| match item.subject {
            Subject::Prim(prim) if item.layer == Layer::Scene => self.shows(prim),
            _ => true,
        });
        Some(world)
    }
    /// Shows all objects but these.
    pub(super) fn show_without(&mut self, unshown: BTreeSet<ObjectId>) {
        if unshown != self.unshown {
            self.unshown = unshown;
            self.shown_serial += 1;
        }
    }
}

impl State {
    /// The objects that are not shown.
    pub fn unshown(&self) -> BTreeSet<ObjectId> {
        self.stage.as_ref().map_or_else(BTreeSet::new, |stage| each!(stage, s => s.unshown.clone()))
    }
    /// How many objects are not shown, in words; `None` if all are.
    pub fn unshown_words(&self) -> Option<String> {
        let n = self.unshown().len();
        let plural = if n == 1 { "" } else { "s" };
        (n > 0).then(|| format!("{} object{plural} not shown, culled as before", count(n)))
    }
    /// The object that is selected, or that of the selected primitive.
    pub(super) fn selected_object(&self) -> Option<ObjectId> {
        let scene = self.staged()?.scene();
        match self.selection {
            Subject::Object(object) => Some(object),
            Subject::Prim(prim) if scene.has_prim(prim) => Some(scene.object_of(prim)),
            _ => None,
        }
    }
    /// Shows all objects but these.
    pub(super) fn show_without(&mut self, unshown: BTreeSet<ObjectId>) {
        if let Some(stage) = &mut self.stage {
            let count = stage.get().scene().object_count();
            let unshown = unshown.into_iter().filter(|object| object.at() < count).collect();
            each!(stage, s => s.show_without(unshown));
        }
    }
    /// Shows an object, or no longer.
    pub(super) fn flip_shown(&mut self, object: ObjectId) {
        let mut unshown = self.unshown();
        if !unshown.remove(&object) {
            unshown.insert(object);
        }
        self.show_without(unshown);
    }
    /// Carries out what is about objects that are shown; returns whether the action was.
    pub(super) fn show_objects(&mut self, action: Action) -> bool {
        let all = self.staged().map_or(0, |s| s.scene().object_count()) as u32;
        match (action, self.selected_object()) {
            (Action::HideObject, Some(object)) => self.flip_shown(object),
            (Action::IsolateObject, Some(object)) => {
                self.show_without((0..all).map(ObjectId).filter(|&other| other != object).collect());
            }
            (Action::ShowObjects, _) => self.show_without(BTreeSet::new()),
            _ => return false,
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::super::command::Command;
    use super::super::session::Session;
    use super::*;
    use crate::geometry::Either;

    /// What is not shown is in no picture, and nothing that was culled changes.
    #[test]
    fn an_object_that_is_hidden_is_only_not_shown() {
        let mut state = State::new();
        state.apply(Command::Open("freedoom_e1m1".into()));
        state.block_until_idle();
        state.apply(Action::Last);
        let film = state.film().map(|film| film.serial);
        let result = state.result();
        let Some(Either::Flat(stage)) = &state.stage else { panic!("flatland") };
        let (prim, key) =
            (stage.image().iter().find_map(|c| c.opaque).expect("something").0, stage.pose_key());
        state.apply(Command::Select(Subject::Prim(prim)));
        state.apply(Action::HideObject);
        let object = state.selected_object().expect("an object");
        assert_eq!(state.unshown().into_iter().collect::<Vec<_>>(), [object]);
        let Some(Either::Flat(stage)) = &state.stage else { panic!("flatland") };
        let is_of_it = |p: PrimId| stage.scene.object_of(p) == object;
        assert!(stage.image().iter().filter_map(|c| c.opaque).all(|(p, _)| !is_of_it(p)));
        let world = stage.world(state.step, &Look { selected: Subject::None, ..state.look() });
        let shown = world.expect("a film").items;
        assert!(
            shown
                .iter()
                .all(|i| !matches!(i.subject, Subject::Prim(p) if i.layer == Layer::Scene && is_of_it(p)))
        );
        let at = stage.scene.prim_points(prim).fold(glam::Vec2::ZERO, |sum, p| sum + p * 0.5);
        assert_ne!(stage.pick(at, 1e-3, state.step), Subject::Prim(prim));
        assert_ne!(stage.pose_key(), key, "pictures are made anew");
        assert_eq!(
            (state.film().map(|film| film.serial), state.result()),
            (film, result),
            "culled as before"
        );
        assert!(state.legend().iter().any(|(_, text)| text.starts_with("1 object not shown")));
        // A session keeps it.
        let session = Session::parse(&state.session().text(), "test").expect("its own text");
        let mut other = State::new();
        other.restore(session, None);
        other.block_until_idle();
        assert_eq!(other.unshown(), state.unshown());
        // Alone, and back.
        state.apply(Action::IsolateObject);
        let all = state.staged().map_or(0, |s| s.scene().object_count());
        assert!(state.unshown().len() == all - 1 && !state.unshown().contains(&object));
        state.apply(Action::ShowObjects);
        assert!(state.unshown().is_empty() && state.legend().iter().all(|(_, text)| !text.contains("shown")));
    }
}
