//! Typed indices. Every one is a 0-based position in the table that its name says.

macro_rules! id {
    ($(#[$doc:meta])* $name:ident) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
        pub struct $name(pub u32);
        impl $name {
            /// The id as a table position.
            #[inline]
            pub fn at(self) -> usize {
                self.0 as usize
            }
        }
        impl std::fmt::Display for $name {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                self.0.fmt(f)
            }
        }
    };
}
id!(
    /// A primitive of a scene: a triangle in space, a segment in flatland. Counts in file order;
    /// a dropped primitive keeps its id.
    PrimId
);
id!(
    /// A node of a spatial index. The root is 0.
    NodeId
);
id!(
    /// A cell of a tessellation.
    CellId
);
id!(
    /// An object of a scene.
    ObjectId
);
id!(
    /// A material of a scene.
    MaterialId
);
