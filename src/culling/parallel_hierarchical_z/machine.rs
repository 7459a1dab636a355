//! The simulated machine: who deals what to whom, what its operations cost, and what its units did.

use crate::drawing::Subject;
use crate::geometry::NodeId;
use crate::method::evidence::integer;
use crate::method::{Field, Knob, Knobs, Tally, Value, words};

words! {
    /// How structures go to processors (Section 4.1).
    pub(super) enum Distribution {
        /// Structures are dealt finely, so that near ones go to different processors.
        Hybrid = "hybrid",
        /// Whole parts of the scene go to one processor.
        Structure = "structure",
        /// Every processor gets a part of every structure.
        Primitive = "primitive",
    }
}

words! {
    /// How regions go to renderers (Section 5.1).
    pub(super) enum Allocation {
        /// Every region has its renderer all the time.
        Static = "static",
        /// The busiest regions of the last frame first, the others when a renderer is free.
        Dynamic = "dynamic",
    }
}

/// The machine and what its operations cost, in ticks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Machine {
    pub processors: u32,
    pub renderers: u32,
    pub distribution: Distribution,
    pub allocation: Allocation,
    /// A processor goes on with other structures while it waits for answers (Section 5.3).
    pub overlap: bool,
    /// A processor reads the farthest depth of each region once and rejects by it alone (Section 5.3).
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
            "what a processor of the simulated machine gets: structures dealt finely (hybrid), whole parts \
             of the scene (structure), or a part of every structure (primitive)",
            "Georges 1995, Section 4.1",
        );
        knobs.words(distribution, &mut self.distribution);
        let allocation = Knob::new(
            "allocation",
            "",
            "static: every region has its renderer all the time; dynamic: the busiest regions first, the \
             others when a renderer is free",
            five,
        );
        knobs.words(allocation, &mut self.allocation);
        let source = "Georges 1995, Section 5.3";
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
            "a simulated processor first compares a box with the farthest depth of each region",
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
    /// A processor transformed a box and sent it out.
    Ask,
    /// A processor had nothing to do but wait for answers.
    Wait,
    /// A renderer rasterized a structure's part in a region.
    Rasterize,
    /// A renderer answered for a box.
    Answer,
}

/// A stretch of work.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Worked {
    pub unit: Unit,
    pub job: Job,
    /// First tick and the one past the last.
    pub from: u32,
    pub to: u32,
    /// The structure's cube; the root while waiting.
    pub node: NodeId,
    /// The region, for renderers.
    pub region: u32,
    /// Primitives, or whether the renderer saw any pixel left on.
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
        // A processor waits for no one structure: its node is a placeholder.
        if self.job == Job::Wait { Subject::None } else { Subject::Node(self.node) }
    }
    pub(super) fn tally(&self, tally: &mut Tally) {
        let (busy, ticks) = match self.job {
            Job::DrawVisible | Job::DrawFound => ("structures_drawn", "ticks_transforming"),
            Job::Ask => ("boxes_sent", "ticks_asking"),
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
            Job::Ask => "BoxSent",
            Job::Wait => "Waited",
            Job::Rasterize => "RegionRasterized",
            Job::Answer => "RegionAnswered",
        }
    }
    pub(super) fn fields(&self) -> Vec<Field> {
        vec![
            Field { name: "unit", value: Value::Word(self.unit.name()) },
            integer("node", self.node.0),
            // Ticks, not seconds: the paper gives no costs, so only proportions mean anything.
            integer("from_ticks", self.from),
            integer("to_ticks", self.to),
            // 0 for processors, which have no region.
            integer("region", self.region),
            integer("count", self.count),
        ]
    }
    pub(super) fn sentence(&self) -> String {
        let (who, node, count, region) = (self.unit.name(), self.node, self.count, self.region);
        let what = match self.job {
            Job::DrawVisible => format!(
                "transforms and sends out node {node}, which is on its visible list: {count} primitives"
            ),
            Job::DrawFound => {
                format!("transforms and sends out node {node}, which a renderer saw: {count} primitives")
            }
            // Section 4.1: a processor "can recombine its own allotment into a tree hierarchy".
            Job::Ask if count > 1 => {
                format!("asks for the box of node {node}, for {count} of its structures at once")
            }
            Job::Ask => format!("asks for the box of node {node}"),
            Job::Wait => "waits for answers".into(),
            Job::Rasterize => format!("rasterizes {count} primitives of node {node} in region {region}"),
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
