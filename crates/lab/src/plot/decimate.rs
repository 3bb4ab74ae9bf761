//! Fewer points for the same picture: the extremes of every pixel column stay.

/// Series up to this many points are drawn as they are.
const KEEP: usize = 1000;

/// A point in pixels.
pub(super) type Point = (f64, f64);

/// Splits points at the missing ones and thins each long series to about [`KEEP`] points.
///
/// A gap narrower than a column of a thinned series cannot be seen and is not kept.
pub(super) fn runs(points: &[Point]) -> Vec<Vec<Point>> {
    let usable = |p: &Point| p.0.is_finite() && p.1.is_finite();
    if points.len() <= KEEP {
        let parts = points.split(|p| !usable(p)).filter(|run| !run.is_empty());
        return parts.map(<[Point]>::to_vec).collect();
    }
    let column = columns(points);
    let mut out: Vec<Vec<Point>> = Vec::new();
    let (mut bucket, mut last, mut gap) = (Vec::new(), None, true);
    for (i, p) in points.iter().enumerate() {
        if !usable(p) {
            gap = true;
            continue;
        }
        let now = Some(column(i, *p));
        if now != last {
            flush(&mut out, &mut bucket);
            if gap {
                out.push(Vec::new());
            }
        }
        (last, gap) = (now, false);
        bucket.push(*p);
    }
    flush(&mut out, &mut bucket);
    out
}

/// What tells the column of a point: its place along x, or its index when the curve turns back.
fn columns(points: &[Point]) -> impl Fn(usize, Point) -> i64 {
    let known: Vec<f64> = points.iter().map(|p| p.0).filter(|x| x.is_finite()).collect();
    let ordered = known.is_sorted();
    let first = known.first().copied().unwrap_or(0.0);
    let wide = known.last().map_or(1.0, |x| x - first) / 245.0;
    let each = points.len().div_ceil(245);
    #[expect(clippy::cast_possible_truncation, reason = "a column number is small")]
    move |i, p| {
        if ordered && wide > 0.0 {
            ((p.0 - first) / wide) as i64
        } else {
            i64::try_from(i / each).unwrap_or(0)
        }
    }
}

/// Moves the extremes of a column, in their order, to the end of the last run.
fn flush(out: &mut [Vec<Point>], bucket: &mut Vec<Point>) {
    let (Some(run), false) = (out.last_mut(), bucket.is_empty()) else {
        bucket.clear();
        return;
    };
    let by = |key: fn(&Point) -> f64| {
        let order = move |a: &(usize, &Point), b: &(usize, &Point)| key(a.1).total_cmp(&key(b.1));
        let low = bucket.iter().enumerate().min_by(order).map_or(0, |(i, _)| i);
        let high = bucket.iter().enumerate().max_by(order).map_or(0, |(i, _)| i);
        [low, high]
    };
    let ([left, right], [low, high]) = (by(|p| p.0), by(|p| p.1));
    let mut kept = [left, right, low, high];
    kept.sort_unstable();
    let mut before = None;
    for i in kept {
        if before != Some(i) {
            run.extend(bucket.get(i));
        }
        before = Some(i);
    }
    bucket.clear();
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wave(n: u32) -> Vec<Point> {
        (0..n).map(|i| (f64::from(i) * 700.0 / f64::from(n), f64::from(i * 7 % 13))).collect()
    }

    #[test]
    fn peaks_survive_thinning() {
        let mut points = wave(100_000);
        if let Some(p) = points.get_mut(54_321) {
            p.1 = 99.0;
        }
        if let Some(p) = points.get_mut(12_345) {
            p.1 = -99.0;
        }
        let thin = runs(&points);
        assert_eq!(thin.len(), 1);
        assert!(thin.iter().map(Vec::len).sum::<usize>() <= KEEP);
        for peak in [99.0, -99.0] {
            assert!(thin.iter().flatten().any(|p| (p.1 - peak).abs() < 1e-9));
        }
        assert_eq!(thin.first().and_then(|r| r.first()), points.first());
        assert_eq!(thin.last().and_then(|r| r.last()), points.last());
    }

    #[test]
    fn a_closed_curve_keeps_its_corners() {
        let mut points = wave(5000);
        points.extend(wave(5000).into_iter().rev());
        let thin = runs(&points);
        assert!(thin.iter().map(Vec::len).sum::<usize>() <= KEEP);
        assert!(thin.iter().flatten().any(|p| p.0 > 699.8));
    }

    #[test]
    fn missing_points_break_the_line() {
        let run = runs(&[(0.0, 1.0), (1.0, f64::NAN), (2.0, 3.0), (f64::INFINITY, 1.0)]);
        assert_eq!(run, [vec![(0.0, 1.0)], vec![(2.0, 3.0)]]);
        let mut points = wave(4000);
        points.iter_mut().skip(1000).take(500).for_each(|p| p.1 = f64::NAN);
        assert_eq!(runs(&points).len(), 2);
        assert!(runs(&[]).is_empty());
    }
}
