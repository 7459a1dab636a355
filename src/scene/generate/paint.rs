//! The palette of the city: materials by number, after those of the furniture.

use super::furniture;

/// Materials of the streets and of the outside of houses; they follow those of the furniture.
pub(super) const MATERIALS: &[(&str, [f32; 3])] = &[
    ("asphalt", [0.16, 0.16, 0.17]),
    ("pavement", [0.42, 0.41, 0.39]),
    ("grass", [0.22, 0.34, 0.14]),
    ("window frame", [0.80, 0.79, 0.75]),
    ("glass", [0.10, 0.15, 0.20]),
    ("flat roof", [0.30, 0.29, 0.28]),
    ("bark", [0.20, 0.14, 0.09]),
    ("facade cream", [0.76, 0.68, 0.50]),
    ("facade ochre", [0.66, 0.47, 0.24]),
    ("facade brick", [0.46, 0.20, 0.14]),
    ("facade gray", [0.50, 0.51, 0.52]),
    ("facade blue", [0.36, 0.46, 0.56]),
    ("facade rose", [0.66, 0.42, 0.38]),
    ("facade olive", [0.42, 0.45, 0.28]),
    ("roof tiles", [0.40, 0.15, 0.09]),
    ("roof slate", [0.17, 0.19, 0.23]),
    ("roof brown", [0.26, 0.16, 0.11]),
    ("door green", [0.07, 0.22, 0.14]),
    ("door red", [0.35, 0.06, 0.05]),
    ("door brown", [0.22, 0.11, 0.05]),
    ("car red", [0.55, 0.07, 0.06]),
    ("car silver", [0.58, 0.60, 0.62]),
    ("car blue", [0.08, 0.16, 0.40]),
];
const FIRST: u32 = furniture::MATERIALS.len() as u32;
pub(super) const ASPHALT: u32 = FIRST;
pub(super) const PAVEMENT: u32 = FIRST + 1;
pub(super) const GRASS: u32 = FIRST + 2;
pub(super) const FRAME: u32 = FIRST + 3;
pub(super) const GLASS: u32 = FIRST + 4;
pub(super) const FLAT_ROOF: u32 = FIRST + 5;
pub(super) const BARK: u32 = FIRST + 6;
pub(super) const FACADE: u32 = FIRST + 7;
pub(super) const FACADES: u32 = 7;
pub(super) const ROOF: u32 = FIRST + 14;
pub(super) const ROOFS: u32 = 3;
pub(super) const DOOR: u32 = FIRST + 17;
pub(super) const DOORS: u32 = 3;
pub(super) const CAR: u32 = FIRST + 20;
pub(super) const CARS: u32 = 3;
