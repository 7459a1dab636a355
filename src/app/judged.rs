//! The frame at hand beside the truth: what can be seen, what of it is missing, what is drawn for nothing,
//! and which share of the image is wrong.

use super::state::State;
use crate::drawing::words::{Room, count, short};
use crate::truth::Judgement;

impl State {
    /// How the film on stage did, at its end.
    pub fn judged(&self) -> Option<&Judgement> {
        self.film().map(|film| film.truth)
    }
    /// The same in a sentence, such as `43 of 100 segments are drawn; all 12 that can be seen are among
    /// them.`
    pub fn result(&self) -> Option<String> {
        let (judged, scene) = (self.judged()?, self.staged()?.scene());
        let drawn = format!(
            "{} of {} {}s are drawn",
            count(judged.drawn),
            count(scene.live_count()),
            scene.prim_name()
        );
        let [visible, missed] = [judged.visible.len(), judged.missed.len()].map(count);
        Some(if judged.missed.is_empty() && judged.wrong_pixels == 0 {
            format!("{drawn}; all {visible} that can be seen are among them.")
        } else {
            let wrong = short(100.0 * judged.wrong_pixel_ratio() as f32, Room::Row);
            format!(
                "{drawn}; {missed} of {visible} that can be seen are not, {wrong} % of the pixels are wrong."
            )
        })
    }
    /// The same as names and numbers.
    pub fn judged_rows(&self) -> Vec<(String, String)> {
        let Some(judged) = self.judged() else { return vec![] };
        let (visible, missed) = (judged.visible.len(), judged.missed.len());
        let needless = judged.drawn - (visible - missed);
        let percent = |ratio: f64| format!("{} %", short(100.0 * ratio as f32, Room::Row));
        let mut rows = vec![
            ("can be seen".to_owned(), count(visible)),
            ("missing".to_owned(), count(missed)),
            ("drawn".to_owned(), count(judged.drawn)),
            ("of it for nothing".to_owned(), count(needless)),
            ("wrong pixels".to_owned(), percent(judged.wrong_pixel_ratio())),
        ];
        if judged.wrong_pixels > 0 {
            rows.push(("mean FLIP".to_owned(), short(judged.flip_mean as f32, Room::Row)));
        }
        rows
    }
}

#[cfg(test)]
mod tests {
    use super::super::command::Command;
    use super::*;
    use crate::scene::failures;

    fn shown(source: &str, method: &str, pairs: &[(&str, &str)]) -> State {
        let mut state = State::new();
        state.apply(Command::Open(source.into()));
        state.block_until_idle();
        state.apply(Command::Method(method.into()));
        state.block_until_idle();
        for (name, value) in pairs {
            state.apply(Command::Set((*name).into(), (*value).into(), 0));
            state.block_until_idle();
        }
        state
    }
    fn row(state: &State, name: &str) -> String {
        let rows = state.judged_rows();
        rows.into_iter().find(|row| row.0 == name).map(|row| row.1).expect("a row")
    }

    /// What a frame says of itself is what the truth and the drawn primitives say, in both spaces.
    #[test]
    fn the_frame_is_told_from_the_truth() {
        for failure in failures().iter().filter(|f| ["pixel-holes", "leaves"].contains(&f.name)) {
            for source in
                [failure.source::<crate::geometry::Flat>(), failure.source::<crate::geometry::Solid>()]
            {
                let state = shown(&source, "frustum", &[]);
                let judged = state.judged().expect("a film");
                assert_eq!((judged.missed.len(), judged.wrong_pixels), (0, 0), "{source}");
                assert!(judged.drawn > judged.visible.len(), "{source}: frustum culling hides nothing");
                let needless = judged.drawn - judged.visible.len();
                assert_eq!(row(&state, "of it for nothing"), count(needless), "{source}");
                let result = state.result().expect("a result");
                assert!(result.ends_with("that can be seen are among them."), "{result}");

                let state = shown(&source, "centroid", &[("budget", "5%")]);
                let judged = state.judged().expect("a film");
                assert!(!judged.missed.is_empty() && judged.wrong_pixels > 0, "{source}");
                // Each of them is decided otherwise by the film, too.
                let film = state.film().expect("a film");
                let is_left_out = |prim: &crate::geometry::PrimId| {
                    let decided = film.stamps.prim_decision(*prim);
                    decided.is_none_or(|(_, verdict)| verdict != crate::method::Verdict::Visible)
                };
                assert!(judged.missed.iter().all(is_left_out), "{source}");
                assert_eq!(row(&state, "missing"), count(judged.missed.len()));
                assert!(state.result().expect("a result").contains("of the pixels are wrong"), "{source}");
            }
        }
    }

    /// The sentence of the last step says what came of it, no other one.
    #[test]
    fn the_end_says_what_came_of_it() {
        let mut state = shown("street", "frustum", &[]);
        let result = state.result().expect("a result");
        state.go_to(state.len());
        assert!(state.sentence().ends_with(&format!("The end: {result}")), "{}", state.sentence());
        state.go_to(state.len() - 1);
        assert!(!state.sentence().contains("The end"), "{}", state.sentence());
    }
}
