//! The simulated machine: who deals what to whom, what its operations cost, and what its units did.

use crate::drawing::Subject;
use crate::geometry::NodeId;
use crate::method::evidence::integer;
use crate::method::{Field, Knob, Knobs, Tally, Value, words};

words! {
    /// How structures go to processors: three ways of Section 4.1, and one that is not the paper's.
    pub(super) enum Distribution {
        /// Structures in turn, so that near ones go to different processors, each of which then queries
        /// several of its own at once.
        Hybrid = "hybrid",
        /// Structures in turn, each by itself: the paper's implementation (Section 5.1).
        Structure = "structure",
        /// Every processor gets a part of every structure.
        Primitive = "primitive",
        /// Whole parts of the scene go to one processor: what the hybrid avoids.
        Subtree = "subtree",
    }
}

words! {
    /// How regions go to renderers (Section 5.1).
    pub(super) enum Allocation {
        /// Every region has its renderer all the time.
        Static = "static",
        /// A renderer holds one region at a time: the busiest of the last frame first, then the next when it
        /// is free.
        Dynamic = "dynamic",
    }
}

words! {
    /// What stands for a structure when it is queried.
    pub(super) enum Volume {
        /// Its box, of which the triangles of the faces are sent (Section 5.1).
        Faces = "faces",
        /// The sphere around it: one quadratic expression instead of the sides of twelve triangles (Section
        /// 5.3).
        Sphere = "sphere",
    }
}

/// Triangles of a box, which a processor transforms to query it.
const BOX_PRIMS: usize = 12;

/// The machine and what its operations cost, in ticks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Machine {
    pub processors: u32,
    pub renderers: u32,
    pub distribution: Distribution,
    pub allocation: Allocation,
    pub query: Volume,
    /// A processor goes on with other structures while it waits for answers (Section 5.3).
    pub overlap: bool,
    /// A processor asks for the farthest depth of each region once and rejects by it alone (Section 5.3).
    pub farthest_first: bool,
    /// Ticks to transform a primitive.
    pub transform: u32,
    /// Ticks to rasterize one in a region.
    pub rasterize: u32,
    /// Ticks to answer for a box.
    pub answer: u32,
    /// Ticks of a message.
    pub message: u32,
}

impl Default for Machine {
    fn default() -> Self {
        Self {
            // Fewer than on Pixel-Planes 5 (Section 5: "several dozen" processors, "10-20" renderers): each
            // has a row in the timeline.
            processors: 4,
            renderers: 4,
            // Section 4.1: "the best approach is probably a hybrid". Section 5.1: since all regions have to
            // be available at once, static allocation is "the only solution".
            distribution: Distribution::default(),
            allocation: Allocation::default(),
            // Section 5.1: "the triangles composing the bounding box".
            query: Volume::default(),
            // Section 5.3: to go on while answers are on their way, and the greatest depth of a region.
            overlap: true,
            farthest_first: true,
            // The paper gives no costs. By its Section 5 a processor transforms one primitive at a time and a
            // renderer rasterizes one at all pixels of a region at once, and by 5.3 an answer may be long on
            // its way: hence their order.
            transform: 10,
            rasterize: 2,
            answer: 4,
            message: 20,
        }
    }
}

impl Machine {
    /// Declares who there is and who gets what.
    pub fn unit_knobs(&mut self, knobs: &mut dyn Knobs) {
        let five = "Georges 1995, Section 5.1";
        let processors =
            Knob::new("processors", "", "graphics processors of the simulated parallel machine", five);
        knobs.integer(processors, 1..=256, &mut self.processors);
        let renderers = Knob::new(
            "renderers",
            "",
            "renderers of the simulated machine, which share the screen's regions of 128 × 128 pixels",
            five,
        );
        knobs.integer(renderers, 1..=256, &mut self.renderers);
        let distribution = Knob::new(
            "distribution",
            "",
            "what a processor of the simulated machine gets: structures in turn, of which it queries several \
             at once (hybrid), structures in turn (structure), a part of every structure (primitive), or, \
             not in the paper, whole parts of the scene (subtree)",
            "Georges 1995, Section 4.1",
        );
        knobs.words(distribution, &mut self.distribution);
        let allocation = Knob::new(
            "allocation",
            "",
            "static: every region has its renderer all the time; dynamic: a renderer holds one region, the \
             busiest first, and takes the next when it is free",
            five,
        );
        knobs.words(allocation, &mut self.allocation);
        let source = "Georges 1995, Section 5.3";
        let query = Knob::new(
            "query",
            "",
            "how a structure is asked for: by the triangles of its box, or by the sphere around it, which is \
             one expression",
            source,
        );
        knobs.words(query, &mut self.query);
        let overlap = Knob::new(
            "overlap-queries",
            "",
            "a simulated processor goes on while it waits for answers",
            source,
        );
        knobs.switch(overlap, &mut self.overlap);
        let shortcut = Knob::new(
            "farthest-shortcut",
            "",
            "a simulated processor asks for the farthest depth of each region and first compares boxes with \
             these",
            source,
        );
        knobs.switch(shortcut, &mut self.farthest_first);
    }
    /// Declares what operations cost.
    pub fn cost_knobs(&mut self, knobs: &mut dyn Knobs) {
        // Drawing costs by the primitive: Section 4.2 takes the time to render any of them as "roughly
        // constant". Work takes a tick at least, so that a unit never begins two jobs in one tick; a message
        // may take none.
        let mut ticks = |name, meaning, least, value| {
            knobs.integer(
                Knob::new(name, "ticks", meaning, "Georges 1995, Section 4.2"),
                least..=10_000,
                value,
            );
        };
        ticks("transform-cost", "simulated time to transform a primitive", 1, &mut self.transform);
        ticks(
            "rasterize-cost",
            "simulated time to rasterize a primitive in a region",
            1,
            &mut self.rasterize,
        );
        ticks("answer-cost", "simulated time in which a renderer answers for a box", 1, &mut self.answer);
        let message = "simulated time of a message between a processor and a renderer";
        ticks("message-cost", message, 0, &mut self.message);
    }
}

impl Machine {
    /// Ticks in which a processor transforms what stands for a structure.
    pub fn volume_cost(&self) -> u32 {
        match self.query {
            Volume::Faces => ticks(self.transform, BOX_PRIMS),
            Volume::Sphere => self.transform,
        }
    }
}

/// Ticks of some operations, as many as fit.
pub(super) fn ticks(each: u32, count: usize) -> u32 {
    // What does not fit costs the most there is: wrapped around, it would cost little.
    each.saturating_mul(u32::try_from(count).unwrap_or(u32::MAX))
}

/// A unit of the machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Unit {
    Processor(u16),
    Renderer(u16),
}

/// What a unit did.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Job {
    /// A processor transformed a structure from its visible list.
    DrawVisible,
    /// A processor transformed a structure that an answer let through.
    DrawFound,
    /// A processor transformed the box of a structure from its invisible list, to query it.
    Ask,
    /// The same of one from its visible list, to check it against the finished image.
    Recheck,
    /// A processor asked all renderers for the farthest depths.
    AskFarthest,
    /// A processor had nothing to do but wait for replies.
    Wait,
    /// A renderer rasterized a structure's part in a region.
    Rasterize,
    /// A renderer answered for a box.
    Answer,
    /// A renderer found the farthest depths of the regions it holds.
    Farthest,
}

/// A stretch of work.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Worked {
    pub unit: Unit,
    pub job: Job,
    /// First tick and the one past the last.
    pub from: u32,
    pub to: u32,
    /// The structure's cube; the root where the work is of no one structure.
    pub node: NodeId,
    /// The region, for renderers that draw or answer.
    pub region: u32,
    /// Primitives, structures that are queried at once, whether a renderer saw any pixel left on, or regions
    /// whose farthest depths it found.
    pub count: u32,
}

impl Unit {
    /// Its name on the timeline.
    pub fn name(self) -> String {
        match self {
            Self::Processor(p) => format!("processor {p}"),
            Self::Renderer(r) => format!("renderer {r}"),
        }
    }
}

impl Worked {
    pub(super) fn subject(&self) -> Subject {
        match self.job {
            // Of no one structure: the node is a placeholder.
            Job::Wait | Job::AskFarthest | Job::Farthest => Subject::None,
            _ => Subject::Node(self.node),
        }
    }
    pub(super) fn tally(&self, tally: &mut Tally) {
        let (busy, ticks) = match self.job {
            Job::DrawVisible | Job::DrawFound => ("structures_drawn", "ticks_transforming"),
            Job::Ask => ("boxes_transformed", "ticks_asking"),
            Job::Recheck => ("boxes_rechecked", "ticks_rechecking"),
            Job::AskFarthest | Job::Farthest => ("farthest_depths_jobs", "ticks_for_farthest_depths"),
            Job::Wait => ("waits", "ticks_waiting"),
            Job::Rasterize => ("rasterizations", "ticks_rasterizing"),
            Job::Answer => ("answers", "ticks_answering"),
        };
        tally.add(busy, 1);
        tally.add(ticks, (self.to - self.from).into());
        // The frame lasts until the last unit is done, whichever that is.
        tally.at_least("ticks_of_frame", self.to.into());
    }
    pub(super) fn kind(&self) -> &'static str {
        match self.job {
            Job::DrawVisible => "VisibleDrawn",
            Job::DrawFound => "FoundDrawn",
            Job::Ask => "BoxTransformed",
            Job::Recheck => "BoxRechecked",
            Job::AskFarthest => "FarthestAsked",
            Job::Wait => "Waited",
            Job::Rasterize => "RegionRasterized",
            Job::Answer => "RegionAnswered",
            Job::Farthest => "FarthestFound",
        }
    }
    pub(super) fn fields(&self) -> Vec<Field> {
        let of = match self.subject() {
            Subject::Node(node) => Some(integer("node", node.0)),
            _ => None,
        };
        // Only renderers have regions; while waiting nothing is counted.
        let region = match self.job {
            Job::Rasterize | Job::Answer => Some(integer("region", self.region)),
            _ => None,
        };
        let count = match self.job {
            Job::DrawVisible | Job::DrawFound | Job::Rasterize => Some(integer("prims", self.count)),
            Job::Ask => Some(integer("structures", self.count)),
            Job::Farthest => Some(integer("regions", self.count)),
            Job::Answer => Some(Field { name: "seen", value: Value::Switch(self.count > 0) }),
            Job::Recheck | Job::AskFarthest | Job::Wait => None,
        };
        let mut fields = vec![Field { name: "unit", value: Value::Word(self.unit.name()) }];
        fields.extend(of);
        // Ticks, not seconds: the paper gives no costs, so only proportions mean anything.
        fields.extend([integer("from_ticks", self.from), integer("to_ticks", self.to)]);
        fields.extend(region.into_iter().chain(count));
        fields
    }
    pub(super) fn sentence(&self) -> String {
        let (who, node, count, region) = (self.unit.name(), self.node, self.count, self.region);
        let prims = if count == 1 { "1 primitive".to_owned() } else { format!("{count} primitives") };
        let what = match self.job {
            Job::DrawVisible => {
                format!("transforms and sends out node {node}, which is on its visible list: {prims}")
            }
            Job::DrawFound => {
                format!("transforms and sends out node {node}, which may be seen: {prims}")
            }
            // Section 4.1: a processor "can recombine its own allotment into a tree hierarchy".
            Job::Ask if count > 1 => {
                format!("transforms the box of node {node}, to query {count} of its structures at once")
            }
            Job::Ask => format!("transforms the box of node {node}, to query it"),
            Job::Recheck => {
                format!("transforms the box of node {node}, to check it against the finished image")
            }
            Job::AskFarthest => "asks all renderers for the farthest depths of their regions".into(),
            Job::Farthest if count == 0 => "holds no region, so it has no farthest depth".into(),
            Job::Farthest if count == 1 => "finds the farthest depth of its region".into(),
            Job::Farthest => format!("finds the farthest depth of each of its {count} regions"),
            Job::Wait => "waits for replies".into(),
            Job::Rasterize => format!("rasterizes {prims} of node {node} in region {region}"),
            // Section 5: the flag "called the 'All Enables Off', or AEO bit".
            Job::Answer if count == 0 => format!(
                "answers for the box of node {node} in region {region}: all enables off, nothing of it shows"
            ),
            Job::Answer => {
                format!("answers for the box of node {node} in region {region}: some pixel of it shows")
            }
        };
        format!("Ticks {} to {}: {who} {what}.", self.from, self.to)
    }
}
