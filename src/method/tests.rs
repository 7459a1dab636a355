//! Films of a method with large state: any path to a step gives the same picture.

use std::sync::Arc;

use super::*;
use crate::drawing::{Drawing, Layer, Role, Subject};
use crate::geometry::{Flat, PrimId};
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
    fn subject(&self) -> Subject {
        Subject::Prim(self.0)
    }
    fn fields(&self, _: &Context<'_, Flat>) -> Vec<Field> {
        vec![Field { name: "prim", value: Value::Integer(self.0.0.into()) }]
    }
    fn sentence(&self, _: &Context<'_, Flat>) -> String {
        format!("{} came.", self.0)
    }
}

impl Method<Flat> for Remember {
    type Params = ();
    type Index = Whole<Flat>;
    type Memory = ();
    type State = Vec<u32>;
    type Note = Came;
    const CARD: Card = Card {
        key: "remember",
        name: "Remember",
        summary: "",
        paper: "",
        doi: "",
        conservative: true,
        code: &[],
        stands: &[],
        departures: &[],
    };

    fn knobs((): &mut (), _: &mut dyn Knobs) {}
    fn build(
        scene: &Arc<Scene<Flat>>,
        (): &(),
        saved: Option<&[u8]>,
        _: &dyn Progress,
    ) -> Result<Option<Whole<Flat>>, String> {
        keeps_nothing(saved)?;
        Ok(Some(Whole::new(scene.clone())))
    }
    fn cull<O: Observer<Came>>(
        frame: &Frame<'_, Flat, Self>,
        (): &mut (),
        list: &mut Vec<u32>,
        out: &mut DrawList<Flat>,
        watch: &mut O,
    ) {
        for &prim in frame.scene.live() {
            State::<Flat, Self>::apply(list, frame.scene, &Came(prim));
            watch.note(|| Came(prim));
            out.prims.push(PrimId(list[list.len() - 1]));
            watch.event(Event::DecidedPrim(prim, Verdict::Visible));
        }
    }
}

impl State<Flat, Remember> for Vec<u32> {
    const KEYFRAME_NOTES: usize = 64;
    fn begin(&mut self, _: &Frame<'_, Flat, Remember>) {
        self.clear();
    }
    fn apply(&mut self, _: &Scene<Flat>, Came(prim): &Came) {
        self.push(prim.0);
    }
}

impl Shown<Flat> for Remember {
    fn explain(moment: &Moment<'_, Flat, Self>, to: &mut Drawing<glam::Vec2>) {
        for &p in moment.state {
            let points = moment.frame.scene.prim_points(PrimId(p)).collect::<Vec<_>>();
            to.line(Layer::Evidence, Role::Evidence, Subject::Prim(PrimId(p)), points);
        }
        to.title = format!("{:?}", moment.note.map(|n| n.0));
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
