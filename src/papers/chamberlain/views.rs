//! From where forests are seen, in the figure and in the table.

use crate::culling::color_cubes::Projected;
use crate::culling::color_cubes::forest::Stock;
use crate::geometry::{Eye, Vector, View};

/// From where a forest is seen.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Place {
    /// Between trees, at the same place whatever there is around it.
    Within,
    /// From above and aside, so far away that all of it is in view.
    Above,
}

impl Place {
    /// In words.
    pub fn name(self) -> &'static str {
        match self {
            Self::Within => "in the forest",
            Self::Above => "from above",
        }
    }
    /// The view of a square of `copies` × `copies` trees.
    pub fn view<S: Projected>(self, stock: &Stock<S>, copies: u32, [width, height]: [u32; 2]) -> View<S> {
        let (root, pitch) = (stock.root(), stock.pitch() as f32);
        // Along the ground: the first axis and the last one, of which flatland has no other.
        let (across, along) = (0, S::Vector::AXES - 1);
        let side = copies as f32 * pitch;
        let at = |right: f32, up: f32, back: f32| {
            S::Vector::from_fn(|a| match a {
                _ if a == across => root.center().get(a) + right,
                _ if a == along => root.center().get(a) + back,
                _ => root.min.get(a) + up,
            })
        };
        let (position, target) = match self {
            // Halfway between two rows, and aside of the way between two columns.
            Self::Within => (at(0.0, 0.16 * pitch, pitch), at(2.0 * pitch, 0.2 * pitch, -7.0 * pitch)),
            Self::Above => (at(0.45 * side, 0.7 * side, 1.2 * side), at(0.0, 0.5 * pitch, 0.0)),
        };
        let up = S::Vector::from_fn(|a| if a == 1 { 1.0 } else { 0.0 });
        let fov = 60f32.to_radians();
        let eye = Eye { position, target, up, fov, near: 0.005 * pitch, far: 1e4 * pitch };
        View { eye, width, height }
    }
}
