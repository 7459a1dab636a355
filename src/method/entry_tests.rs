//! Films of a method with large state: any path to a step gives the same picture.

use std::sync::Arc;

use super::entry::Of;
use super::*;
use crate::drawing::{Drawing, Layer, Role, Subject};
use crate::geometry::{Flat, PrimId, View};
use crate::index::Whole;
use crate::scene::{Progress, Quiet, Scene, framing_view, samples};

/// Remembers every primitive in the order in which it came: its large state is the list so far.
struct Remember;

#[derive(Clone, Copy)]
struct Came(PrimId);

impl Tallied for Came {
    fn tally(&self, tally: &mut Tally) {
        tally.add("came", 1);
    }
}

impl Note<Flat> for Came {
    fn kind(&self) -> &'static str {
        "Came"
    }
    fn fields(&self) -> Vec<Field> {
        vec![Field { name: "prim", value: Value::Integer(self.0.0.into()) }]
    }
    fn sentence(&self, _: &Scene<Flat>) -> String {
        format!("{} came.", self.0)
    }
}

impl Method<Flat> for Remember {
    type Params = ();
    type Index = Whole<Flat>;
    type Memory = ();
    type Note = Came;
    type Dense = Vec<u32>;
    const CARD: Card = Card {
        key: "remember",
        name: "Remember",
        summary: "",
        paper: "",
        doi: "",
        conservative: true,
        code: &[],
    };

    fn knobs((): &mut (), _: &mut dyn Knobs) {}
    fn build(scene: &Arc<Scene<Flat>>, (): &(), _: &dyn Progress) -> Option<Whole<Flat>> {
        Some(Whole::new(scene.clone()))
    }
    fn cull<O: Observer<Came>>(
        _: &Whole<Flat>,
        scene: &Scene<Flat>,
        view: &View<Flat>,
        (): &(),
        (): &mut (),
        out: &mut DrawList,
        watch: &mut O,
    ) {
        let mut dense = Self::dense(scene, view);
        for &prim in scene.live() {
            Self::apply(&mut dense, scene, &Came(prim));
            watch.note(|| Came(prim));
            out.prims.push(PrimId(dense[dense.len() - 1]));
            watch.event(Event::DecidedPrim(prim, Verdict::Visible));
        }
    }
    fn dense(_: &Scene<Flat>, _: &View<Flat>) -> Vec<u32> {
        Vec::new()
    }
    fn apply(dense: &mut Vec<u32>, _: &Scene<Flat>, Came(prim): &Came) {
        dense.push(prim.0);
    }
    fn explain(
        dense: &Vec<u32>,
        scene: &Scene<Flat>,
        _: &Whole<Flat>,
        _: &View<Flat>,
        note: Option<&Came>,
        to: &mut Drawing<glam::Vec2>,
    ) {
        for &p in dense {
            to.line(
                Layer::Evidence,
                Role::Evidence,
                Subject::Prim(PrimId(p)),
                scene.prim_points(PrimId(p)).collect::<Vec<_>>(),
            );
        }
        to.title = format!("{:?}", note.map(|n| n.0));
    }
}

#[test]
fn keyframes_do_not_change_any_step_whatever_the_order() {
    let scene = samples::soup::<Flat>(1, 300);
    let view = framing_view::<Flat>(&scene.bounds(), 32, 1);
    let film = || {
        let mut run =
            Of::<Remember>::NEW.ready(&scene, &Settings::default(), &Quiet).expect("ok").expect("ok");
        run.record(&view, usize::MAX).film
    };
    let draw = |film: &dyn Film<Flat>, step| {
        let mut to = Drawing::default();
        film.explain(step, &mut to);
        to
    };
    let (forwards, backwards, jumping) = (film(), film(), film());
    let steps = forwards.events().len();
    let want: Vec<_> = (0..=steps).map(|s| draw(&*forwards, s)).collect();
    for step in (0..=steps).rev() {
        assert_eq!(draw(&*backwards, step), want[step], "backwards to {step}");
    }
    for step in (0..=steps).map(|i| i * 7919 % (steps + 1)) {
        assert_eq!(draw(&*jumping, step), want[step], "jumping to {step}");
    }
    for (step, drawing) in want.iter().enumerate() {
        assert_eq!(drawing.items.len(), step.div_ceil(2), "one primitive a note at step {step}");
    }
}
