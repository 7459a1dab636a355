//! Elapsed times, and paired interleaved comparison.
//!
//! On a shared machine the same code, timed one run after another, reads as ×0.89 to ×1.50 of itself.
//! So two ways are timed in turn, A B A B …, each round gives one ratio, and the median of the ratios
//! is the result: whatever slows a round slows both of its halves. Times are wall clock, in milliseconds.

use std::time::Instant;

/// Milliseconds since it was started.
#[derive(Clone, Copy, Debug)]
pub struct Stopwatch(Instant);

impl Stopwatch {
    /// Starts now.
    pub fn start() -> Self {
        Self(Instant::now())
    }
    /// Milliseconds since the start.
    pub fn elapsed_ms(&self) -> f64 {
        self.0.elapsed().as_secs_f64() * 1e3
    }
}

/// What the work returned, and how many milliseconds it took.
pub fn timed<T>(work: impl FnOnce() -> T) -> (T, f64) {
    let watch = Stopwatch::start();
    let result = std::hint::black_box(work());
    (result, watch.elapsed_ms())
}

/// Two ways to do the same work, compared.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Paired {
    /// Median time of the first way.
    pub a_ms: f64,
    /// Median time of the second way.
    pub b_ms: f64,
    /// Median over the rounds of second / first.
    pub ratio: f64,
    /// Quartiles of those ratios.
    pub spread: [f64; 2],
    /// Rounds timed.
    pub rounds: usize,
}

/// Times `a` and `b` in turn, `rounds ≥ 1` times after one round that is thrown away. Which of the two
/// goes first alternates, so that neither always finds the caches of the other.
pub fn paired(rounds: usize, mut a: impl FnMut(), mut b: impl FnMut()) -> Paired {
    let mut one = |round: usize| {
        if round.is_multiple_of(2) {
            let a_ms = timed(&mut a).1;
            (a_ms, timed(&mut b).1)
        } else {
            let b_ms = timed(&mut b).1;
            (timed(&mut a).1, b_ms)
        }
    };
    one(0);
    let times: Vec<(f64, f64)> = (0..rounds.max(1)).map(&mut one).collect();
    let sorted = |of: fn(&(f64, f64)) -> f64| {
        let mut list: Vec<f64> = times.iter().map(of).collect();
        list.sort_unstable_by(f64::total_cmp);
        list
    };
    let ratios = sorted(|t| t.1 / t.0.max(1e-9));
    Paired {
        a_ms: quantile(&sorted(|t| t.0), 0.5),
        b_ms: quantile(&sorted(|t| t.1), 0.5),
        ratio: quantile(&ratios, 0.5),
        spread: [quantile(&ratios, 0.25), quantile(&ratios, 0.75)],
        rounds: times.len(),
    }
}

/// The middle one of some values; 0 if there are none.
pub fn median(mut values: Vec<f64>) -> f64 {
    values.sort_unstable_by(f64::total_cmp);
    quantile(&values, 0.5)
}

/// The value below which a share of an ascending list lies, interpolated; 0 for an empty one.
pub fn quantile(ascending: &[f64], share: f64) -> f64 {
    let Some(last) = ascending.len().checked_sub(1) else { return 0.0 };
    let at = share * last as f64;
    let (low, high) = (ascending[at.floor() as usize], ascending[at.ceil() as usize]);
    low + (high - low) * at.fract()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_interpolate() {
        assert_eq!(quantile(&[1.0, 2.0, 4.0], 0.5), 2.0);
        assert_eq!(quantile(&[1.0, 2.0], 0.5), 1.5);
        assert_eq!(quantile(&[3.0], 0.75), 3.0);
        assert_eq!(quantile(&[], 0.5), 0.0);
    }

    #[test]
    fn rounds_are_interleaved_and_alternate() {
        let order = std::cell::RefCell::new(String::new());
        let paired = paired(3, || order.borrow_mut().push('a'), || order.borrow_mut().push('b'));
        assert_eq!(*order.borrow(), "ababbaab");
        assert_eq!(paired.rounds, 3);
    }
}
