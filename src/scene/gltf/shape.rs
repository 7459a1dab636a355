//! Primitives of meshes as points and triangles: morphed by their default weights, colored by their points,
//! unpacked where they are compressed (glTF 2.0, section 3.7).

use glam::DVec3;

use super::codec::{self, Unpacked};
use super::data::{Data, components};
use super::file::{Gltf, Index, Primitive, attribute};
use super::lost::{Lost, Sentence};
use super::skin::Influences;

/// A primitive in the coordinates of its mesh.
pub(super) struct Shape {
    pub(super) points: Vec<DVec3>,
    pub(super) triangles: Vec<[u32; 3]>,
    pub(super) material: Option<Index>,
    /// Linear color and alpha at each point; empty if it has none.
    pub(super) colors: Vec<[f64; 4]>,
    /// What its points follow, if that was asked for and is there.
    pub(super) influences: Influences,
}

/// Reads one primitive.
pub(super) struct Reader<'a> {
    pub(super) gltf: &'a Gltf,
    pub(super) data: &'a Data<'a>,
    /// Weights of the morph targets.
    pub(super) weights: &'a [f64],
    pub(super) skinned: bool,
    /// Most points and most corners that may come.
    pub(super) most: usize,
}

const LINES: Sentence =
    ["1 primitive of points or lines left out", "# primitives of points or lines left out"];
const NO_POSITIONS: Sentence =
    ["1 primitive without positions left out", "# primitives without positions left out"];
const SPARE: Sentence = [
    "1 primitive ends with corners that make no triangle",
    "# primitives end with corners that make no triangle",
];
const UNTINTED: Sentence = [
    "1 primitive with colors at points that cannot be read",
    "# primitives with colors at points that cannot be read",
];

const TRIANGLES: u32 = 4;
const STRIP: u32 = 5;
const FAN: u32 = 6;

impl Reader<'_> {
    /// The primitive, unless it is of a kind that is left out.
    pub(super) fn read(&self, at: (usize, usize), lost: &mut Lost) -> Result<Option<Shape>, String> {
        let primitive = &self.gltf.meshes[at.0].primitives[at.1];
        let mesh = || self.gltf.mesh_name(at.0);
        let mode = primitive.mode.unwrap_or(TRIANGLES);
        if !(TRIANGLES..=FAN).contains(&mode) {
            lost.add(LINES, at, mesh);
            return Ok(None);
        }
        let Some(position) = attribute(&primitive.attributes, "POSITION")? else {
            lost.add(NO_POSITIONS, at, mesh);
            return Ok(None);
        };
        let unpacked = self.unpack(primitive, position)?;
        let from = Source { primitive, unpacked, data: self.data };
        self.check_counts(primitive, position, from.unpacked.is_some())?;
        let mut points = from.vectors::<3>("POSITION", position)?;
        self.morph(primitive, &mut points)?;
        let count = points.len();
        let corners: Vec<u32> = match (&from.unpacked, primitive.indices) {
            (Some(unpacked), _) => unpacked.corners().collect(),
            (None, Some(indices)) => self.data.whole::<1>(indices)?.into_flattened(),
            (None, None) => (0..count as u32).collect(),
        };
        let mode = if from.unpacked.is_some() { TRIANGLES } else { mode };
        if mode == TRIANGLES && !corners.len().is_multiple_of(3) {
            lost.add(SPARE, at, mesh);
        }
        let triangles = triangles(mode, corners);
        let colors = self.colors(&from, count).unwrap_or_else(|_| {
            lost.add(UNTINTED, at, mesh);
            Vec::new()
        });
        let influences = if self.skinned { self.influences(&from, count)? } else { Vec::new() };
        let points = points.into_iter().map(DVec3::from_array).collect();
        Ok(Some(Shape { points, triangles, material: primitive.material, colors, influences }))
    }

    /// Draco data, where that is all there is: an accessor with a view holds the same unpacked.
    fn unpack(&self, primitive: &Primitive, position: Index) -> Result<Option<Unpacked>, String> {
        let Some(draco) = &primitive.extensions.draco else { return Ok(None) };
        if self.data.accessor(position)?.buffer_view.is_some() {
            return Ok(None);
        }
        self.data.view(draco.buffer_view, |bytes| codec::draco(bytes, self.most)).map(Some)
    }

    /// Counts are compared before anything is read.
    fn check_counts(&self, primitive: &Primitive, position: Index, unpacked: bool) -> Result<(), String> {
        let points = self.data.accessor(position)?.count;
        let corners = match primitive.indices {
            Some(indices) if !unpacked => self.data.accessor(indices)?.count,
            _ => points,
        };
        if points.max(corners) > self.most {
            return Err(format!("its instances come to over {} points or corners", self.most));
        }
        Ok(())
    }

    /// Adds what the morph targets of a weight other than zero add (3.7.2.2).
    fn morph(&self, primitive: &Primitive, points: &mut [[f64; 3]]) -> Result<(), String> {
        for (target, weight) in primitive.targets.iter().zip(self.weights).filter(|(_, w)| **w != 0.0) {
            let Some(accessor) = attribute(target, "POSITION")? else { continue };
            if self.data.accessor(accessor)?.count != points.len() {
                return Err("a morph target has another number of points".into());
            }
            for (point, offset) in points.iter_mut().zip(self.data.vectors::<3>(accessor)?) {
                *point = std::array::from_fn(|k| point[k] + weight * offset[k]);
            }
        }
        Ok(())
    }

    /// The colors at the points.
    fn colors(&self, from: &Source, count: usize) -> Result<Vec<[f64; 4]>, String> {
        let Some(accessor) = attribute(&from.primitive.attributes, "COLOR_0")? else { return Ok(Vec::new()) };
        let shape = self.data.accessor(accessor)?;
        if from.unpacked.is_none() && shape.count != count {
            return Err("it has another number of colors than of points".into());
        }
        let colors: Vec<[f64; 4]> = match components(shape) {
            4 => from.vectors::<4>("COLOR_0", accessor)?,
            _ => {
                from.vectors::<3>("COLOR_0", accessor)?.into_iter().map(|[r, g, b]| [r, g, b, 1.0]).collect()
            }
        };
        if colors.len() != count {
            return Err("it has another number of colors than of points".into());
        }
        Ok(colors)
    }

    /// Every set of joints with its weights.
    fn influences(&self, from: &Source, count: usize) -> Result<Influences, String> {
        let mut sets = Vec::new();
        loop {
            let names = ["JOINTS", "WEIGHTS"].map(|n| format!("{n}_{}", sets.len()));
            let [joints, weights] = &names;
            let attributes = &from.primitive.attributes;
            let (Some(j), Some(w)) = (attribute(attributes, joints)?, attribute(attributes, weights)?) else {
                return Ok(sets);
            };
            let same = |index| Ok::<_, String>(self.data.accessor(index)?.count == count);
            if from.unpacked.is_none() && !(same(j)? && same(w)?) {
                return Err(format!("{joints} and {weights} are not as many as its {count} points"));
            }
            let set = (from.whole(joints, j)?, from.vectors::<4>(weights, w)?);
            if set.0.len() != count || set.1.len() != count {
                return Err(format!("{joints} and {weights} are not as many as its {count} points"));
            }
            sets.push(set);
        }
    }
}

/// Where the attributes of a primitive come from.
struct Source<'a> {
    primitive: &'a Primitive,
    unpacked: Option<Unpacked>,
    data: &'a Data<'a>,
}

impl Source<'_> {
    fn packed(&self, name: &str) -> Option<(&Unpacked, u32)> {
        let id = self.primitive.extensions.draco.as_ref()?.attributes.get(name)?;
        Some((self.unpacked.as_ref()?, *id))
    }

    fn vectors<const W: usize>(&self, name: &str, accessor: Index) -> Result<Vec<[f64; W]>, String> {
        let Some((unpacked, id)) = self.packed(name) else { return self.data.vectors::<W>(accessor) };
        let shape = self.data.accessor(accessor)?;
        let most = match shape.component_type {
            5120 => 127.0,
            5121 => 255.0,
            5122 => 32767.0,
            5123 => 65535.0,
            _ => 1.0,
        };
        let mut all = unpacked.vectors::<W>(id)?;
        if shape.normalized {
            all.as_flattened_mut().iter_mut().for_each(|v| *v = (*v / most).max(-1.0));
        }
        Ok(all)
    }

    fn whole(&self, name: &str, accessor: Index) -> Result<Vec<[u32; 4]>, String> {
        let Some((unpacked, id)) = self.packed(name) else { return self.data.whole::<4>(accessor) };
        Ok(unpacked.vectors::<4>(id)?.into_iter().map(|v| v.map(|k| k as u32)).collect())
    }
}

/// The triangles that a list of corners stands for; every second one of a strip is turned over (3.7.2.1).
fn triangles(mode: u32, corners: Vec<u32>) -> Vec<[u32; 3]> {
    match mode {
        STRIP => {
            let turned = |(i, w): (usize, &[u32])| {
                if i % 2 == 0 { [w[0], w[1], w[2]] } else { [w[1], w[0], w[2]] }
            };
            corners.windows(3).enumerate().map(turned).collect()
        }
        FAN => corners.get(1..).unwrap_or(&[]).windows(2).map(|w| [corners[0], w[0], w[1]]).collect(),
        _ => corners.as_chunks::<3>().0.to_vec(),
    }
}
