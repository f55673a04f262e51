//! Long signals as short paths that look the same.

/// Deviation in pixels that nobody sees.
const TOLERANCE: f64 = 0.15;

/// The points of a line, in pixels, reduced to those that show: of each pixel column the first, lowest, highest and last
/// point, and of those only the ones further than 0.15 pixels from the line through the others. x must ascend.
pub(super) fn reduce(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let mut columns: Vec<[f64; 2]> = Vec::new();
    for column in points.chunk_by(|a, b| a[0].floor() == b[0].floor()) {
        let by_height = |i: &usize, j: &usize| column[*i][1].total_cmp(&column[*j][1]);
        let all = 0..column.len();
        let mut kept = [Some(0), all.clone().min_by(by_height), all.clone().max_by(by_height), all.last()];
        kept.sort_unstable();
        let mut before = None;
        for index in kept.into_iter().flatten() {
            if before != Some(index) {
                columns.push(column[index]);
                before = Some(index);
            }
        }
    }
    simplify(&columns)
}

/// Ramer (1972), Douglas and Peucker (1973): drops points that lie close to the line without them.
fn simplify(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    if points.len() < 3 {
        return points.to_vec();
    }
    let mut keep = vec![false; points.len()];
    keep[0] = true;
    keep[points.len() - 1] = true;
    let mut spans = vec![(0, points.len() - 1)];
    while let Some((first, last)) = spans.pop() {
        let furthest = (first + 1..last)
            .map(|index| (index, distance(points[index], points[first], points[last])))
            .max_by(|a, b| a.1.total_cmp(&b.1));
        if let Some((index, _)) = furthest.filter(|(_, distance)| *distance > TOLERANCE) {
            keep[index] = true;
            spans.extend([(first, index), (index, last)]);
        }
    }
    points.iter().zip(keep).filter(|(_, keep)| *keep).map(|(point, _)| *point).collect()
}

/// Distance of `p` from the segment `a`..`b`.
fn distance(p: [f64; 2], a: [f64; 2], b: [f64; 2]) -> f64 {
    let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
    let length = dx * dx + dy * dy;
    let along = if length > 0.0 { ((p[0] - a[0]) * dx + (p[1] - a[1]) * dy) / length } else { 0.0 };
    let along = along.clamp(0.0, 1.0);
    (p[0] - a[0] - along * dx).hypot(p[1] - a[1] - along * dy)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_straight_line_needs_two_points() {
        let line: Vec<[f64; 2]> = (0..1000).map(|k| [f64::from(k) * 0.3, f64::from(k) * 0.1]).collect();
        assert_eq!(reduce(&line), [line[0], line[999]]);
    }

    #[test]
    fn a_single_spike_survives() {
        let mut line: Vec<[f64; 2]> = (0..10_000).map(|k| [f64::from(k) * 0.01, 0.0]).collect();
        line[4321][1] = 7.0;
        let reduced = reduce(&line);
        assert!(reduced.contains(&line[4321]), "{reduced:?}");
        assert!(reduced.len() <= 7, "{reduced:?}");
    }

    #[test]
    fn a_curve_stays_within_the_tolerance() {
        let curve: Vec<[f64; 2]> =
            (0..5000).map(|k| f64::from(k) * 0.08).map(|x| [x, 60.0 * (x / 20.0).sin()]).collect();
        let reduced = reduce(&curve);
        assert!(reduced.len() < 600, "{}", reduced.len());
        for point in &curve {
            let nearest = reduced.windows(2).map(|leg| distance(*point, leg[0], leg[1])).fold(f64::INFINITY, f64::min);
            // Within a pixel column points may move by its width times the slope as well.
            assert!(nearest < 2.0 * TOLERANCE, "{point:?} {nearest}");
        }
    }

    #[test]
    fn short_lines_stay_as_they_are() {
        assert!(reduce(&[]).is_empty());
        assert_eq!(reduce(&[[1.0, 2.0]]), [[1.0, 2.0]]);
    }
}
