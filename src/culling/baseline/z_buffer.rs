//! `z-buffer`: everything is drawn and the depth buffer decides.
//!
//! Catmull 1974 (the z-buffer). Nothing is culled but, if asked, back faces. It is the reference for
//! images and the upper end of every chart's cost. Cost: O(n).

use std::sync::Arc;

use super::explain::Evidence;
use crate::drawing::Drawing;
use crate::geometry::{Space, View};
use crate::index::Whole;
use crate::method::evidence::{Facing, prim_faces_away};
use crate::method::{Card, CodeLine, DrawList, Event, Knobs, Method, Observer, Verdict, backface_knob};
use crate::scene::{Progress, Scene};

/// The method.
pub struct ZBuffer;

/// Parameters of [`ZBuffer`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Params {
    backface_culling: bool,
}

const CODE: &[CodeLine] = &[
    CodeLine { label: "Draw:1", text: "for each polygon p of the scene" },
    CodeLine { label: "Draw:2", text: "  if p faces away from the eye" },
    CodeLine { label: "Draw:3", text: "    skip p" },
    CodeLine { label: "Draw:4", text: "  else draw p" },
];

impl<S: Space> Method<S> for ZBuffer {
    type Params = Params;
    type Index = Whole<S>;
    type Memory = ();
    type Note = Evidence<S>;
    type Dense = ();
    const CARD: Card = Card {
        key: "z-buffer",
        name: "Plain z-buffer",
        summary: "Draws every polygon and lets the depth buffer decide, pixel by pixel; culls nothing.",
        paper: "Catmull. A Subdivision Algorithm for Computer Display of Curved Surfaces. PhD thesis, \
                University of Utah, 1974.",
        doi: "",
        conservative: true,
        code: CODE,
    };

    fn knobs(params: &mut Params, knobs: &mut dyn Knobs) {
        backface_knob(knobs, &mut params.backface_culling);
    }
    fn build(scene: &Arc<Scene<S>>, _: &Params, _: &dyn Progress) -> Option<Whole<S>> {
        Some(Whole::new(scene.clone()))
    }
    fn cull<O: Observer<Evidence<S>>>(
        _: &Whole<S>,
        scene: &Scene<S>,
        view: &View<S>,
        params: &Params,
        (): &mut (),
        out: &mut DrawList,
        watch: &mut O,
    ) {
        watch.event(Event::FrameBegan);
        for &prim in scene.live() {
            if params.backface_culling && prim_faces_away(scene, view.eye.position, prim) {
                watch.event(Event::Line(2));
                watch.note(move || Evidence::Facing(Facing::of(scene, view, prim)));
                watch.event(Event::DecidedPrim(prim, Verdict::Outside));
            } else {
                watch.event(Event::Line(3));
                out.prims.push(prim);
                watch.event(Event::DecidedPrim(prim, Verdict::Visible));
            }
        }
    }
    fn dense(_: &Scene<S>, _: &View<S>) {}
    fn apply((): &mut (), _: &Scene<S>, _: &Evidence<S>) {}
    fn explain(
        (): &(),
        scene: &Scene<S>,
        _: &Whole<S>,
        view: &View<S>,
        note: Option<&Evidence<S>>,
        to: &mut Drawing<S::Vector>,
    ) {
        if let Some(note) = note {
            note.draw(scene, view, to);
        }
    }
}
