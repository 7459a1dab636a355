//! The opacity thresholds of all levels (Zhang et al. 1997, Section 5.4), as a table beside the parameters.

use super::OcclusionMaps;
use super::maps::Maps;
use crate::culling::depth::Faces;
use crate::method::{Derived, Frame};
use crate::raster::Opacity;

/// The table for the image of a frame.
pub(super) fn table<S: Faces>(frame: &Frame<'_, S, OcclusionMaps>) -> Derived {
    let mut maps = Maps::<S>::default();
    maps.clear(frame.scene, frame.view, frame.params, frame.index);
    let opacity = maps.opacity();
    let ignored = frame.params.ignored(opacity);
    let axes = if S::CORNERS == 2 { 1 } else { 2 };
    let samples = |level: u8| samples(opacity, axes, level);
    // O_k = 1 − n/m_k: the share of a whole pixel that must be covered, if n samples of it may be black.
    let threshold = |n: u32, level: u8| 1.0 - f64::from(n) / samples(level) as f64;
    let head = ["level", "pixels", "samples each", "threshold"].map(String::from).to_vec();
    let row = |level: u8| {
        let [columns, rows] = opacity.size(level);
        let cells = [
            level.to_string(),
            format!("{columns} × {rows}"),
            samples(level).to_string(),
            format!("{:.4}", threshold(ignored, level)),
        ];
        cells.to_vec()
    };
    let children = 1 << axes;
    let law = format!("From level to level it follows that O(k+1) = ({} + O(k)) / {children}.", children - 1);
    let note = match ignored {
        0 if samples(0) == 1 => "A pixel of level 0 has one sample: there is nothing to ignore.".into(),
        0 => format!(
            "n = 0: a map pixel is opaque only if none of its samples is black. With {} a pixel of level 0 \
             the first is ignored at a threshold of {:.4}.",
            samples(0),
            threshold(1, 0)
        ),
        n => format!(
            "n = {n}: on every level a map pixel is opaque with at most {n} black samples, so the hierarchy \
             ignores nothing that level 0 does not. {law}"
        ),
    };
    Derived {
        knob: "opacity-threshold",
        title: "Thresholds by level, O(k) = 1 − n / samples",
        rows: std::iter::once(head).chain((0..opacity.levels()).map(row)).collect(),
        note,
    }
}

/// Samples of a whole pixel of a level; `axes`: of the image.
fn samples(opacity: &Opacity, axes: u32, level: u8) -> u64 {
    u64::from(opacity.whole()) << (axes * u32::from(level))
}
