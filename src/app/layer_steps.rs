//! Playing a film by layers. They are ranked on the worker when someone first asks, and kept with the film.

use super::command::Action;
use super::layers::{InLayer, Layers, ToLayer};
use super::stage::Recorded;
use super::state::State;
use super::worker::Job;
use crate::drawing::words::count;
use crate::geometry::{Either, Space};

impl State {
    /// Goes to the next layer or to the one before; the first time, once the layers are ranked.
    pub(super) fn go_layer(&mut self, action: Action) {
        let Some(film) = self.film() else { return };
        let Some(layers) = film.layers else { return self.rank_layers(action) };
        let is_next = action == Action::NextLayer;
        match if is_next { layers.next(self.step) } else { layers.previous(self.step) } {
            Some(step) => self.go_to(step),
            None if layers.is_empty() => self.tell("This film draws nothing that the Eye could see."),
            None if is_next => self.tell("Nothing of a deeper layer is drawn after this step."),
            None => self.tell("No layer begins before this step."),
        }
    }

    fn rank_layers(&mut self, action: Action) {
        if self.busy().is_some() {
            return self.tell("Layers can be ranked once the work that is waited for is done.");
        }
        let film = match &self.stage {
            Some(Either::Flat(stage)) => stage.recorded.as_ref().map(|r| Either::Flat(to_layer(r))),
            Some(Either::Solid(stage)) => stage.recorded.as_ref().map(|r| Either::Solid(to_layer(r))),
            None => None,
        };
        if let Some(film) = film {
            self.worker.ask("Layers", Job::Layer { film, action });
        }
    }

    pub(super) fn take_layers(&mut self, layers: Result<Layers, String>, action: Action) {
        match (&mut self.stage, layers) {
            (_, Err(text)) => self.fail(text),
            (Some(Either::Flat(stage)), Ok(layers)) => keep(&mut stage.recorded, layers),
            (Some(Either::Solid(stage)), Ok(layers)) => keep(&mut stage.recorded, layers),
            (None, Ok(_)) => {}
        }
        if self.film().is_some_and(|film| film.layers.is_some()) {
            self.go_layer(action);
        }
        self.run_commands();
    }

    /// How far the film has come in the layers before its Eye, once they are ranked: in a sentence.
    pub fn layer_sentence(&self) -> Option<String> {
        let InLayer { layer, of, prims, drawn } = self.film()?.layers?.at(self.step);
        if layer == 0 {
            return Some(format!("Of {} layers none is begun.", count(of as usize)));
        }
        let prim = self.staged()?.scene().prim_name();
        let s = if prims == 1 { "" } else { "s" };
        let place = match layer {
            1 => "visible".into(),
            2 => "behind at least 1 other".into(),
            _ => format!("behind at least {} others", count(layer as usize - 1)),
        };
        let (prims, drawn) = (count(prims), count(drawn));
        Some(format!("Layer {layer} of {of}: {prims} {prim}{s} {place}, {drawn} drawn."))
    }
}

fn to_layer<S: Space>(recorded: &Recorded<S>) -> ToLayer<S> {
    ToLayer { film: recorded.film.clone(), stamps: recorded.stamps.clone() }
}

fn keep<S: Space>(recorded: &mut Option<Recorded<S>>, layers: Layers) {
    if let Some(recorded) = recorded {
        recorded.layers = Some(layers);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::Command;
    use crate::geometry::PrimId;
    use crate::method::Verdict;

    /// Seen from the eye, 1 hides 2, and 2 hides 0; 3 stands beside them and farthest away.
    const WALLS: &str = r#"{
        "segments": [[-0.2, 3, 0.2, 3], [-1, 0, 1, 0], [-0.5, 1.5, 0.5, 1.5], [3, 6, 4, 6]],
        "fov_degrees": 60,
        "eyes": [[0, -5, 0, 1]]
    }"#;

    fn walls(name: &str, method: &str) -> State {
        let file = std::env::temp_dir().join(format!("cullscope-{name}-{}.json", std::process::id()));
        std::fs::write(&file, WALLS).expect("a file of our own");
        let mut state = State::new();
        state.method = method.into();
        state.settings.0.extend((method == "centroid").then(|| ("budget".into(), "100%".into())));
        state.apply(Command::Open(file.to_string_lossy().into_owned()));
        state.block_until_idle();
        std::fs::remove_file(&file).expect("a file of our own");
        state
    }

    fn go(state: &mut State, action: Action) -> (Option<PrimId>, String) {
        state.apply(action);
        state.block_until_idle();
        let drawn = match state.current_subject() {
            crate::drawing::Subject::Prim(prim) => Some(prim),
            _ => None,
        };
        (drawn, state.layer_sentence().unwrap_or_default())
    }

    #[test]
    fn a_film_is_played_by_the_layers_before_its_eye() {
        // By centroids: 1, 2, 0, 3.
        let mut state = walls("layers", "centroid");
        assert_eq!(state.layer_sentence(), None, "nothing is ranked before it is asked for");
        let steps = [
            (1, "Layer 1 of 3: 2 segments visible, 1 drawn."),
            (2, "Layer 2 of 3: 1 segment behind at least 1 other, 1 drawn."),
            (0, "Layer 3 of 3: 1 segment behind at least 2 others, 1 drawn."),
        ];
        for (prim, text) in steps {
            let got = go(&mut state, Action::NextLayer);
            assert_eq!(got, (Some(PrimId(prim)), text.into()));
            assert_eq!(state.events()[state.step - 1].verdict(), Some(Verdict::Visible));
        }
        let at = state.step;
        go(&mut state, Action::NextLayer);
        assert_eq!(state.step, at);
        assert!(
            state.notices.iter().any(|n| n.text == "Nothing of a deeper layer is drawn after this step.")
        );
        state.apply(Action::Last);
        for (prim, text) in steps.into_iter().rev() {
            assert_eq!(go(&mut state, Action::PreviousLayer), (Some(PrimId(prim)), text.into()));
        }
        state.apply(Action::First);
        assert_eq!(state.layer_sentence().as_deref(), Some("Of 3 layers none is begun."));

        // Another film has to be ranked again.
        state.apply(Command::Method("z-buffer".into()));
        state.block_until_idle();
        assert_eq!(state.layer_sentence(), None);
        // It draws by number, so the deepest layer comes first and none begins after it.
        let (prim, text) = go(&mut state, Action::NextLayer);
        assert_eq!((prim, &text[..12]), (Some(PrimId(0)), "Layer 3 of 3"));
        assert_eq!(go(&mut state, Action::NextLayer), (prim, text));
    }

    #[test]
    fn whoever_waits_for_a_film_is_told_and_the_work_goes_on() {
        let mut state = walls("busy-layers", "centroid");
        state.apply(Command::Method("z-buffer".into()));
        assert!(state.busy().is_some());
        state.apply(Action::NextLayer);
        assert!(state.notices.iter().any(|n| n.text.contains("once the work")), "{:?}", state.notices);
        state.block_until_idle();
        assert_eq!(state.film().map(|f| f.reel.card().key), Some("z-buffer"));
        assert_eq!(state.step, 0);
    }
}
