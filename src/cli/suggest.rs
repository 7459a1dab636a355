//! "Did you mean": the nearest known word.

/// A line of help for a word that is not known: the nearest known one, if one is near, and all of them.
pub(super) fn help(word: &str, known: &[&str], what: &str) -> String {
    let all = known.join(", ");
    match nearest(word, known) {
        Some(near) => format!("did you mean `{near}`? {what}: {all}"),
        None => format!("{what}: {all}"),
    }
}

/// The known word with the fewest edits, if those are at most a third of the word, or one that it begins or
/// ends.
pub(super) fn nearest<'a>(word: &str, known: &[&'a str]) -> Option<&'a str> {
    let word = word.to_lowercase();
    let scored = known.iter().map(|k| (edits(&word, &k.to_lowercase()), *k));
    let near =
        scored.min().filter(|(edits, k)| *edits <= word.chars().count().max(k.chars().count()).div_ceil(3));
    near.map(|(_, k)| k).or_else(|| {
        known.iter().copied().find(|k| word.len() >= 3 && (k.starts_with(&word) || k.ends_with(&word)))
    })
}

/// Insertions, deletions, replacements and swaps of neighbors that turn `a` into `b` (Damerau 1964,
/// <https://doi.org/10.1145/363958.363994>; each place edited once). O(|a| · |b|), words cut at 64 letters.
fn edits(a: &str, b: &str) -> usize {
    let (a, b): (Vec<char>, Vec<char>) = (a.chars().take(64).collect(), b.chars().take(64).collect());
    let mut rows = vec![vec![0usize; b.len() + 1]; a.len() + 1];
    for i in 0..=a.len() {
        for j in 0..=b.len() {
            if i == 0 || j == 0 {
                rows[i][j] = i + j;
                continue;
            }
            let replaced = rows[i - 1][j - 1] + usize::from(a[i - 1] != b[j - 1]);
            let mut best = replaced.min(rows[i - 1][j] + 1).min(rows[i][j - 1] + 1);
            if i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                best = best.min(rows[i - 2][j - 2] + 1);
            }
            rows[i][j] = best;
        }
    }
    rows[a.len()][b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slips_find_their_word() {
        let known = ["z-buffer", "frustum", "centroid"];
        assert_eq!(nearest("frustrum", &known), Some("frustum"));
        assert_eq!(nearest("FURSTUM", &known), Some("frustum"));
        assert_eq!(nearest("zbuffer", &known), Some("z-buffer"));
        assert_eq!(nearest("buffer", &known), Some("z-buffer"));
        assert_eq!(nearest("raytrace", &known), None);
        assert_eq!(nearest("", &known), None);
        assert_eq!(edits("ab", "ba"), 1);
    }
}
