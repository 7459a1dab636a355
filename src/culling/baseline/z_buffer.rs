//! `z-buffer`: everything is drawn and the depth buffer decides.
//!
//! Catmull 1974 (the z-buffer). Nothing is culled but, by a parameter, back faces. It is the reference for
//! images and the upper end of every chart's cost. Cost: O(n).

use std::sync::Arc;

use super::explain::Evidence;
use crate::drawing::Drawing;
use crate::geometry::Space;
use crate::index::Whole;
use crate::method::evidence::{Facing, prim_faces_away};
use crate::method::{
    Card, CodeLine, DrawList, Event, Frame, Knobs, Method, Moment, Observer, Shown, Verdict, backface_knob,
    keeps_nothing,
};
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

/// Lines that the run reaches.
mod line {
    use super::CODE;
    use crate::method::line;
    pub const SKIP: u8 = line(CODE, "Draw:3");
    pub const DRAW: u8 = line(CODE, "Draw:4");
}

impl<S: Space> Method<S> for ZBuffer {
    type Params = Params;
    type Index = Whole<S>;
    // Every primitive is decided by itself: nothing is kept from frame to frame, and a film needs no state.
    type Memory = ();
    type State = ();
    type Note = Evidence<S>;
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
    fn build(
        scene: &Arc<Scene<S>>,
        _: &Params,
        saved: Option<&[u8]>,
        _: &dyn Progress,
    ) -> Result<Option<Whole<S>>, String> {
        // Bytes that are passed here were saved for another method: refused, so that the mistake shows.
        keeps_nothing(saved)?;
        Ok(Some(Whole::new(scene.clone())))
    }
    fn cull<O: Observer<Evidence<S>>>(
        frame: &Frame<'_, S, Self>,
        (): &mut (),
        (): &mut (),
        out: &mut DrawList<S>,
        watch: &mut O,
    ) {
        let Frame { scene, view, params, .. } = *frame;
        watch.event(Event::FrameBegan);
        // No node is entered: there is but one, and its verdict would hold for all or none.
        watch.stage("draw");
        // Without a test there is no evidence: what is drawn is drawn because it is there.
        // By ascending id and not by depth: the z-buffer needs no order.
        for &prim in scene.live() {
            if params.backface_culling && prim_faces_away(scene, view.eye.position, prim) {
                watch.event(Event::Line(line::SKIP));
                watch.note(move || Evidence::Facing(Facing::of(prim)));
                // Facing away counts as outside in every method, and the truth leaves such primitives out
                // too.
                watch.event(Event::DecidedPrim(prim, Verdict::Outside));
            } else {
                watch.event(Event::Line(line::DRAW));
                out.prims.push(prim);
                watch.event(Event::DecidedPrim(prim, Verdict::Visible));
            }
        }
    }
}

impl<S: Space> Shown<S> for ZBuffer {
    fn explain(moment: &Moment<'_, S, Self>, to: &mut Drawing<S::Vector>) {
        if let Some(note) = moment.note {
            note.draw(moment.frame.scene, moment.frame.view, to);
        }
    }
}
