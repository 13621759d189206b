//! Floating-point operations that each part of a cycle needs, as closed formulas.
//!
//! One operation is one addition, subtraction, multiplication, division or square
//! root; signs, comparisons, selections and copies are free. The arm has right-angled
//! twists and no lengths a, as the LWR; zeros of its inertia tables are not used.

/// Joints.
const N: u64 = 7;

/// Links with a length d between their joints, and the joints behind each, which the
/// sums over pairs of joints cross: joints 3 and 5 of the LWR.
const OFFSET_LINKS: u64 = 2;
const OFFSET_CROSSINGS: u64 = (N - 3) + (N - 5);

/// A task level: link that carries its point, rows.
type Level = (u64, u64);

/// The parts as in the table, with their formula.
pub const FORMULAS: [(&str, &str); 10] = [
    ("kinematics", "n (S + 33) + 18 k"),
    (
        "dynamics",
        "n (19 + 82 + 3 + 35) + 68 (n - 1) + 20 k + 38 n (n - 1) / 2 + 8 k' + n (n^2 - 1) / 3 + n (n - 1) / 2 + 2 n + 2 n (2 n - 1)",
    ),
    ("observer", "n (E + 8) + 1"),
    (
        "task rows",
        "per level 30 + l (6 + 10 r) + r (2 l - 1) + 2 r (2 r + 1)",
    ),
    (
        "hierarchy",
        "m n^2 + sum over k < m of 2 (n - k) + 7 + 4 (n - k) (m - 1 - k)",
    ),
    ("motion", "2 n^2 + 2 R + n + m^2"),
    ("command", "n (2 m - 1) + m + m^2 + 3 n (2 n - 1) + 5 n"),
    ("demand", "3 n^2 + 3 R + m + 2 n"),
    ("limits", "0"),
    ("observer input", "n (2 n - 1) + 2 n"),
];

/// What the letters of [`FORMULAS`] mean.
pub const LEGEND: &str = "n = 7 joints, m task rows in levels of r rows on link l, \
k = 2 links with a length d, k' = 6 of them crossed by the pairs of joints; \
S = 46 (f64) or 34 (f32) for a sine and cosine, E = 34 or 22 for an exponential; \
R = 4 m n - 2 m (m - 1), the m reflections of a vector.";

/// Levels of an experiment.
fn levels(job: &str) -> &'static [Level] {
    match job {
        "two-level" => &[(7, 3)],
        _ => &[(7, 3), (5, 2)],
    }
}

/// Operations of the part `name` in the controller of `job`; None for a part that is
/// not known.
pub fn of(name: &str, job: &str, precision: &str) -> Option<u64> {
    let (n, levels) = (N, levels(job));
    let m: u64 = levels.iter().map(|(_, rows)| rows).sum();
    let (sine_cosine, exponential) = if precision == "f64" {
        (46, 34)
    } else {
        (34, 22)
    };
    let product = n * (2 * n - 1);
    let pairs = n * (n - 1) / 2;
    let reflections = 4 * m * n - 2 * m * m.saturating_sub(1);
    Some(match name {
        "kinematics" => n * (sine_cosine + 33) + 18 * OFFSET_LINKS,
        "dynamics" => {
            let chain = n * (19 + 82 + 3 + 35) + 68 * (n - 1) + 20 * OFFSET_LINKS;
            let columns = 38 * pairs + 8 * OFFSET_CROSSINGS;
            let cholesky = n * (n * n - 1) / 3 + pairs + 2 * n;
            chain + columns + cholesky + 2 * product
        }
        "observer" => n * (exponential + 8) + 1,
        "task rows" => {
            let level =
                |&(l, r): &Level| 30 + l * (6 + 10 * r) + r * (2 * l - 1) + 2 * r * (2 * r + 1);
            levels.iter().map(level).sum()
        }
        "hierarchy" => {
            let row = |k: u64| 2 * (n - k) + 7 + 4 * (n - k) * (m - 1 - k);
            m * n * n + (0..m).map(row).sum::<u64>()
        }
        "motion" => 2 * n * n + 2 * reflections + n + m * m,
        "command" => n * (2 * m - 1) + m + m * m + 3 * product + 5 * n,
        "demand" => 3 * n * n + 3 * reflections + m + 2 * n,
        "limits" => 0,
        "observer input" => product + 2 * n,
        _ => return None,
    })
}

/// All parts together.
pub fn total(job: &str, precision: &str) -> u64 {
    let parts = FORMULAS.iter();
    parts.filter_map(|(name, _)| of(name, job, precision)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_factorisations_have_their_known_counts() {
        // Three rows by hand: 3 x 49, reflections 14 + 12 + 10 + 21, applied 4 x (14 + 6).
        assert_eq!(of("hierarchy", "two-level", "f64"), Some(147 + 57 + 80));
        // 7^3 / 3 to leading order.
        assert_eq!(N * (N * N - 1) / 3, 112);
        assert_eq!(of("a part", "two-level", "f64"), None);
    }

    #[test]
    fn single_precision_needs_fewer() {
        for job in ["two-level", "case-1"] {
            assert!(total(job, "f32") < total(job, "f64"));
            assert!((4_500..6_500).contains(&total(job, "f64")));
        }
        assert!(total("two-level", "f64") < total("case-1", "f64"));
    }
}
