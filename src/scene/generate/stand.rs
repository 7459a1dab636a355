//! Places to stand in a room: against its walls, in its middle. Shared by the rooms of all generators.

use glam::DVec3;

use super::shapes::Frame;

/// Where a piece stands in a room.
#[derive(Clone, Copy)]
pub(super) enum Spot {
    /// Against the wall on the right (as one comes in), this far from the door's wall, 0..1.
    Right(f64),
    /// Against the wall on the left.
    Left(f64),
    /// Against the wall opposite, this far across, −1..1.
    Back(f64),
    /// In the middle.
    Middle,
}

/// A rectangle of floor, as one comes in.
pub(super) struct Inside {
    pub(super) middle: DVec3,
    /// Going in; unit.
    pub(super) into: DVec3,
    /// To the right; unit.
    pub(super) right: DVec3,
    /// Half the extent along `into`, m.
    pub(super) deep: f64,
    /// Half the extent along `right`, m.
    pub(super) wide: f64,
    /// From the rectangle's border to where a piece may begin, m.
    pub(super) plaster: f64,
}

impl Inside {
    /// The frame of a spot: its back (local +z) to the wall.
    pub(super) fn frame(&self, spot: Spot) -> Frame {
        let depth_of = |t: f64| self.into * (self.deep * (2.0 * t - 1.0));
        match spot {
            Spot::Middle => Frame { origin: self.middle, right: self.right, away: self.into },
            Spot::Right(t) => self.against(self.right, self.wide, depth_of(t)),
            Spot::Left(t) => self.against(-self.right, self.wide, depth_of(t)),
            Spot::Back(t) => self.against(self.into, self.deep, self.right * (t * self.wide)),
        }
    }
    /// The frame at a wall that is `reach` away from the middle, moved `along` it.
    pub(super) fn against(&self, wall: DVec3, reach: f64, along: DVec3) -> Frame {
        Frame {
            origin: self.middle + wall * (reach - self.plaster) + along,
            right: DVec3::Y.cross(wall),
            away: wall,
        }
    }
}
