//! The orders in which primitives are drawn, at the paper's budgets, ready to run.

use std::sync::Arc;

use crate::drawing::Role;
use crate::measure::columns::{self, column};
use crate::measure::experiment::World;
use crate::measure::harness::{part, restore_or_build, settings};
use crate::measure::{Cell, Column, ExperimentError, Setup};
use crate::method::Run;
use crate::papers::keys::{CENTROID, LAYERED_PROJECTION};
use crate::scene::{Progress, Scene};

/// The paper's budgets, per cent.
pub const BUDGETS: [f64; 4] = [1.0, 2.0, 5.0, 10.0];

/// Columns that several tables have.
pub const FRAME: Column = column(columns::FRAME, "frame", "", 0);
pub const ORDER: Column = column("order", "order", "", 0);
pub const RULES: Column = column("rules", "rules", "", 0);
pub const BUDGET: Column = column("budget_percent", "budget", "%", 0);

/// An order in which primitives are drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Way {
    pub label: &'static str,
    /// Cells of the method and its rules; none for the baseline.
    pub method: Option<[&'static str; 2]>,
    pub role: Role,
}

/// The paper's rules and ours.
pub const PAPERS: &str = "paper";
pub const OURS: &str = "ours";

/// A way of the method.
pub const fn way(label: &'static str, cells: &'static str, rules: &'static str, role: Role) -> Way {
    Way { label, method: Some([cells, rules]), role }
}

pub const PAPERS_DELAUNAY: Way = way("Delaunay", "delaunay", PAPERS, Role::Approximated);
pub const PAPERS_OCTREE: Way = way("octree", "octree", PAPERS, Role::Undecided);
pub const DELAUNAY: Way = way("Delaunay", "delaunay", OURS, Role::Visible);
pub const OCTREE: Way = way("octree", "octree", OURS, Role::Hidden);
pub const KD_TREE: Way = way("kD-tree", "kd-tree", OURS, Role::Partial);
pub const BY_CENTROID: Way = Way { label: "centroid", method: None, role: Role::Outside };

impl Way {
    /// What it says under [`ORDER`] and [`RULES`].
    pub fn cells(&self) -> [Cell; 2] {
        [self.label.into(), self.method.map(|[_, rules]| rules).into()]
    }
    /// Its name in charts.
    pub fn name(&self) -> String {
        match self.method {
            Some([_, PAPERS]) => format!("{}, paper's rules", self.label),
            _ => self.label.to_owned(),
        }
    }
}

/// How many primitives may be drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Most {
    /// As the settings say.
    AsSet,
    Percent(f64),
}

pub type Runs<S> = Vec<Box<dyn Run<S>>>;

/// A way that is ready to run, once for each budget; what takes long is built once.
pub fn ready<S: World>(
    scene: &Arc<Scene<S>>,
    setup: &Setup,
    way: Way,
    budgets: &[Most],
    progress: &dyn Progress,
) -> Result<Runs<S>, ExperimentError> {
    let key = if way.method.is_some() { LAYERED_PROJECTION } else { CENTROID };
    let mut runs: Runs<S> = Vec::new();
    let mut saved = None;
    for (i, budget) in budgets.iter().enumerate() {
        let rest = part(progress, if i == 0 { 0.0 } else { 0.9 }, if i == 0 { 0.9 } else { 1.0 });
        let percent = if let Most::Percent(percent) = budget { Some(format!("{percent}%")) } else { None };
        let on_top: Vec<(&str, &str)> = way
            .method
            .into_iter()
            .flat_map(|[cells, rules]| [("tessellation", cells), ("rules", rules)])
            .chain(percent.as_deref().map(|percent| ("budget", percent)))
            .collect();
        let settings = settings::<S>(key, setup, &on_top)?;
        let run = restore_or_build(scene, key, &settings, saved.as_deref(), &rest)?;
        saved = saved.or_else(|| run.hierarchy().save());
        runs.push(run);
    }
    Ok(runs)
}
