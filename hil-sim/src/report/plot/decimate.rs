//! Fewer points for a line, without losing what it shows.

/// Thins a line to about `most` points: the extremes of each of `most / 2`
/// buckets, and both ends. Gaps (not finite) stay gaps.
#[must_use]
pub fn decimate(points: &[[f64; 2]], most: usize) -> Vec<[f64; 2]> {
    if points.len() <= most.max(4) {
        return points.to_vec();
    }
    let size = points.len().div_ceil(most.max(4) / 2);
    let mut kept = vec![points[0]];
    for bucket in points[1..points.len() - 1].chunks(size) {
        let finite = bucket.iter().filter(|p| p[1].is_finite());
        let low = finite.clone().min_by(|a, b| a[1].total_cmp(&b[1]));
        let high = finite.max_by(|a, b| a[1].total_cmp(&b[1]));
        match (low, high) {
            (Some(&low), Some(&high)) if low[1] == high[1] => kept.push(low),
            (Some(&low), Some(&high)) if low[0] <= high[0] => kept.extend([low, high]),
            (Some(&low), Some(&high)) => kept.extend([high, low]),
            _ => kept.push([bucket[0][0], f64::NAN]),
        }
    }
    kept.push(points[points.len() - 1]);
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thinning_keeps_ends_and_peaks() {
        let mut points: Vec<_> = (0..20_000)
            .map(|k| [f64::from(k) * 2e-3, (f64::from(k) * 1e-3).sin()])
            .collect();
        points[12_345][1] = 7.0;
        points[12_346][1] = -9.0;
        let kept = decimate(&points, 1500);
        assert!(kept.len() <= 1502, "{}", kept.len());
        assert!(kept.contains(&points[12_345]) && kept.contains(&points[12_346]));
        assert_eq!(kept.first(), points.first());
        assert_eq!(kept.last(), points.last());
        assert!(kept.windows(2).all(|pair| pair[0][0] < pair[1][0]));
    }

    #[test]
    fn gaps_stay_gaps() {
        let points: Vec<_> = (0..9000)
            .map(|k| [f64::from(k), if k < 4000 { f64::NAN } else { 1.0 }])
            .collect();
        let kept = decimate(&points, 100);
        assert!(kept.iter().any(|p| p[1].is_nan()) && kept.iter().any(|p| p[1] == 1.0));
    }
}
