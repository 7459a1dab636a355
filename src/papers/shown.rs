//! What a paper shows, and what of it is ours: the entries of the gallery, as data.

/// A figure, plate or table of a paper, and what stands for it here.
pub struct Shown {
    /// What the paper calls it, with its number: `Figure 4`, `Plate 1`.
    pub number: &'static str,
    /// What it shows, in a line.
    pub what: &'static str,
    /// What is ours of it; nothing where `instead` says why.
    pub ours: &'static [Ours],
    /// What of it cannot be had, and what takes its place; empty where nothing is missing.
    pub instead: &'static str,
}

/// Something of ours that stands for a figure or a table.
pub enum Ours {
    /// The built-in figure of this name.
    Figure(&'static str),
    /// The table of this name.
    Table(&'static str),
    /// A figure of a step of a run.
    Own(Own),
}

/// A figure of one's own: a step of a run as the explorer shows it, made by the command line.
pub struct Own {
    /// Its kebab-case name in the gallery; also the name of its file there.
    pub name: &'static str,
    /// The scene: a file of the repository or a generator.
    pub scene: &'static str,
    /// The key of the method.
    pub method: &'static str,
    /// More words of the command; it makes one figure.
    pub more: &'static [&'static str],
}

impl Own {
    /// The words of the command, the program's name first; none needs quotes in a shell.
    pub fn words(&self) -> Vec<&'static str> {
        let first = ["cullscope", "figure", "--scene", self.scene, "--method", self.method];
        [&first, self.more].concat()
    }
}
