//! Things of either space, for code that has not asked which.

/// A thing of flatland or a thing of space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Either<F, S> {
    /// Of flatland.
    Flat(F),
    /// Of space.
    Solid(S),
}

/// Evaluates one expression on a thing of either space; `Either(…)` around the expression keeps the answer in
/// its space.
macro_rules! each {
    ($either:expr, $it:pat => Either($body:expr)) => {
        match $either {
            $crate::geometry::Either::Flat($it) => $crate::geometry::Either::Flat($body),
            $crate::geometry::Either::Solid($it) => $crate::geometry::Either::Solid($body),
        }
    };
    ($either:expr, $it:pat => $body:expr) => {
        match $either {
            $crate::geometry::Either::Flat($it) => $body,
            $crate::geometry::Either::Solid($it) => $body,
        }
    };
}
pub(crate) use each;
