//! `z-buffer`: everything is drawn and the depth buffer decides.
//!
//! Catmull 1974 (the z-buffer). Nothing is culled but, by a parameter, back faces. It is the reference for
//! images and the upper end of every chart's cost. Cost: O(n).

use std::sync::Arc;

use super::explain::Evidence;
use crate::drawing::Drawing;
use crate::geometry::{NodeId, Space};
use crate::index::Whole;
use crate::method::evidence::Facing;
use crate::method::{
    Card, CodeLine, DrawList, Event, Frame, Knobs, Method, Moment, Observer, Shown, Verdict, keeps_nothing,
    surface_knobs,
};
use crate::scene::{Progress, Scene, Surfaces};

/// The method.
pub struct ZBuffer;

/// Parameters of [`ZBuffer`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Params {
    surfaces: Surfaces,
}

const CODE: &[CodeLine] = &[
    CodeLine::new("Draw:1", "for each polygon p of the scene"),
    CodeLine::new("Draw:2", "  if p faces away from the eye"),
    CodeLine::new("Draw:3", "    skip p"),
    CodeLine::new("Draw:4", "  draw p; the depth buffer decides"),
];

/// Lines that the run reaches.
mod line {
    use super::CODE;
    use crate::method::line;
    pub const EACH: u8 = line(CODE, "Draw:1");
    pub const FACING: u8 = line(CODE, "Draw:2");
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
        stands: &[
            ("NodeUntested", &["Draw:1"]),
            ("OrientationTested", &["Draw:2"]),
            ("PrimDecided faces-away", &["Draw:3"]),
            ("PrimDecided visible", &["Draw:4"]),
        ],
        departures: &[],
    };

    fn knobs(params: &mut Params, knobs: &mut dyn Knobs) {
        surface_knobs(knobs, &mut params.surfaces);
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
        watch.stage("draw");
        watch.event(Event::Line(line::EACH));
        // The one node holds the scene. It gets no verdict, which would hold for all or none.
        watch.event(Event::Entered(NodeId(0)));
        watch.note(|| Evidence::Untested(NodeId(0)));
        // By ascending id and not by depth: the z-buffer needs no order.
        for &prim in scene.live() {
            watch.event(Event::Line(line::EACH));
            let mut is_away = false;
            if params.surfaces.one_sided {
                watch.event(Event::Line(line::FACING));
                watch.note(move || Evidence::Facing(Facing::of(prim)));
                is_away = scene.faces_away(prim, view.eye.position);
            }
            if is_away {
                // The truth leaves such primitives out too.
                watch.event(Event::Line(line::SKIP));
                watch.event(Event::DecidedPrim(prim, Verdict::FacesAway));
            } else {
                watch.event(Event::Line(line::DRAW));
                out.prims.push(prim);
                watch.event(Event::DecidedPrim(prim, Verdict::Visible));
            }
        }
        watch.event(Event::Left(NodeId(0)));
    }
    fn has_line(params: &Params, line: u8) -> bool {
        params.surfaces.one_sided || ![line::FACING, line::SKIP].contains(&line)
    }
}

impl<S: Space> Shown<S> for ZBuffer {
    fn explain(moment: &Moment<'_, S, Self>, to: &mut Drawing<S::Vector>) {
        if let Some(note) = moment.note {
            note.draw(moment.frame.scene, moment.frame.view, to);
        }
    }
}
