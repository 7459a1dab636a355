//! The nodes of a glTF file: which of them are shown, and where each stands at rest (glTF 2.0, section 3.5).

use glam::{DMat4, DQuat, DVec3};

use super::file::{Gltf, Index, Node};
use crate::scene::{Progress, Report, SceneError};

/// Translation, rotation and scale of a node.
#[derive(Clone, Copy)]
pub(super) struct Stand {
    pub(super) translation: DVec3,
    pub(super) rotation: DQuat,
    pub(super) scale: DVec3,
}

impl Stand {
    pub(super) fn of(node: &Node) -> Self {
        if let Some(matrix) = &node.matrix {
            let (scale, rotation, translation) =
                DMat4::from_cols_array(matrix).to_scale_rotation_translation();
            return Self { translation, rotation, scale };
        }
        Self {
            translation: node.translation.as_ref().map_or(DVec3::ZERO, |t| DVec3::from_array(**t)),
            rotation: node.rotation.as_ref().map_or(DQuat::IDENTITY, |r| turn(**r)),
            scale: node.scale.as_ref().map_or(DVec3::ONE, |s| DVec3::from_array(**s)),
        }
    }

    pub(super) fn matrix(&self) -> DMat4 {
        DMat4::from_scale_rotation_translation(self.scale, self.rotation, self.translation)
    }
}

/// A rotation of unit length; none for a quaternion that is no rotation.
pub(super) fn turn(quaternion: [f64; 4]) -> DQuat {
    let turn = DQuat::from_array(quaternion);
    let usable = turn.is_finite() && turn.length_squared() > 0.0;
    if usable { turn.normalize() } else { DQuat::IDENTITY }
}

/// Transform of a node relative to its parent, at rest.
pub(super) fn local(node: &Node) -> DMat4 {
    match &node.matrix {
        Some(matrix) => DMat4::from_cols_array(matrix),
        None if node.translation.is_none() && node.rotation.is_none() && node.scale.is_none() => {
            DMat4::IDENTITY
        }
        None => Stand::of(node).matrix(),
    }
}

/// The roots of the scene that is loaded: the default one, else the first, else every node without a parent.
pub(super) fn roots(gltf: &Gltf, wanted: Option<usize>, report: &mut Report) -> Result<Vec<Index>, String> {
    let count = gltf.scenes.len();
    if let Some(scene) = wanted.filter(|s| *s >= count) {
        return Err(format!("it has no scene {scene}, but only {count} (the first is 0)"));
    }
    let default = gltf.scene.map(|s| s as usize);
    if let Some(scene) = default.filter(|s| *s >= count && count > 0) {
        report.note(format!("its default scene {scene} is not there; the first of {count} is loaded"));
    }
    let chosen = wanted.or(default.filter(|s| *s < count)).unwrap_or(0);
    let Some(scene) = gltf.scenes.get(chosen) else {
        let mut child = vec![false; gltf.nodes.len()];
        gltf.nodes.iter().flat_map(|n| &n.children).for_each(|c| {
            if let Some(child) = child.get_mut(*c as usize) {
                *child = true;
            }
        });
        return Ok((0..child.len() as Index).filter(|n| !child[*n as usize]).collect());
    };
    if count > 1 {
        let name = scene.name.as_deref().map_or(String::new(), |n| format!(" `{}`", super::file::short(n)));
        report.note(format!(
            "scene {chosen}{name} of {count} is loaded; `?scene=NUMBER` after the file's name chooses another"
        ));
    }
    Ok(scene.nodes.clone())
}

/// Where the nodes stand, and which are shown.
pub(super) struct Tree {
    /// Parents before their children: the nodes of the scene first, then all others.
    pub(super) order: Vec<Index>,
    pub(super) parents: Vec<Option<Index>>,
    /// In the scene, and not hidden with it or a node above it.
    pub(super) shown: Vec<bool>,
    /// World transforms at rest.
    pub(super) worlds: Vec<DMat4>,
    /// Nodes with a mesh or a camera that are hidden.
    pub(super) hidden: usize,
}

impl Tree {
    /// Walks the nodes depth first, without recursion: first below `roots`, then what else there is, where
    /// joints may stand.
    pub(super) fn walk(
        gltf: &Gltf,
        roots: &[Index],
        source: &str,
        progress: &dyn Progress,
    ) -> Result<Self, SceneError> {
        let count = gltf.nodes.len();
        let mut tree = Self {
            order: Vec::with_capacity(count),
            parents: vec![None; count],
            shown: vec![false; count],
            worlds: vec![DMat4::IDENTITY; count],
            hidden: 0,
        };
        let mut seen = vec![false; count];
        tree.below(gltf, roots, &mut seen, Some(source), progress)?;
        let mut child = vec![false; count];
        let children = gltf.nodes.iter().flat_map(|n| &n.children).filter(|c| (**c as usize) < count);
        children.for_each(|c| child[*c as usize] = true);
        let others: Vec<Index> =
            (0..count as Index).filter(|n| !seen[*n as usize] && !child[*n as usize]).collect();
        if tree.below(gltf, &others, &mut seen, None, progress).is_err() {
            return Err(SceneError::Cancelled(source.to_owned()));
        }
        Ok(tree)
    }

    /// Walks what is below `roots`. What belongs to the scene of the file `source` is shown and must be a
    /// tree; of what does not, nodes that were seen before are passed over.
    fn below(
        &mut self,
        gltf: &Gltf,
        roots: &[Index],
        seen: &mut [bool],
        source: Option<&str>,
        progress: &dyn Progress,
    ) -> Result<(), SceneError> {
        let fail = |why: String| SceneError::Format { path: source.unwrap_or_default().to_owned(), why };
        let mut stack: Vec<(Index, Option<Index>, bool)> =
            roots.iter().rev().map(|n| (*n, None, source.is_some())).collect();
        while let Some((index, parent, shown)) = stack.pop() {
            let at = index as usize;
            let Some(node) = gltf.nodes.get(at) else {
                if source.is_none() {
                    continue;
                }
                let count = gltf.nodes.len();
                return Err(fail(format!("its tree names node {index}, but there are only {count}")));
            };
            if std::mem::replace(&mut seen[at], true) {
                if source.is_none() {
                    continue;
                }
                return Err(fail(format!("node {index} is in the tree twice")));
            }
            if self.order.len() % 4_096 == 4_095 {
                progress.report(0.0, "reading nodes");
                if progress.cancelled() {
                    return Err(SceneError::Cancelled(source.unwrap_or_default().to_owned()));
                }
            }
            let visible =
                node.extensions.as_ref().and_then(|e| e.visibility.as_ref()).is_none_or(|v| v.visible);
            let above = parent.map_or(DMat4::IDENTITY, |p| self.worlds[p as usize]);
            self.order.push(index);
            self.parents[at] = parent;
            self.worlds[at] = above * local(node);
            self.shown[at] = shown && visible;
            if source.is_some() && !self.shown[at] && (node.mesh.is_some() || node.camera.is_some()) {
                self.hidden += 1;
            }
            stack.extend(node.children.iter().rev().map(|c| (*c, Some(index), shown && visible)));
        }
        Ok(())
    }
}
