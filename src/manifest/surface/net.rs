//! As few triangles as a surface over a square grid can do with, without gaps between them.

/// A vertex by its column and row.
type Vertex = [usize; 2];

/// The triangles of a grid of `count` columns and rows of quads, a power of two, by the indices of their
/// vertices row by row. A triangle is halved in the middle of its longest edge where `error` of that
/// edge's ends and its middle is above 1, or that of an edge within it: W. S. Evans,
/// D. G. Kirkpatrick & G. Townsend, "Right-triangulated irregular networks", *Algorithmica* 30 (2001)
/// 264. Going down the rows, all of them go round the same way as (0, 0), (0, 1), (1, 0).
pub fn triangles(count: usize, error: impl Fn([usize; 3]) -> f64) -> Vec<[usize; 3]> {
    let index = |[column, row]: Vertex| row * (count + 1) + column;
    let roots = [
        [[0, 0], [count, count], [count, 0]],
        [[count, count], [0, 0], [0, count]],
    ];
    let mut levels = vec![roots.to_vec()];
    while let Some(last) = levels.last() {
        let halves: Vec<[Vertex; 3]> = last.iter().copied().filter_map(halves).flatten().collect();
        if halves.is_empty() {
            break;
        }
        levels.push(halves);
    }
    // From the smallest, so that whoever shares an edge halves it too.
    let mut errors = vec![0.0; (count + 1) * (count + 1)];
    for [a, b, c] in levels.iter().rev().flatten().copied() {
        let Some(m) = middle(a, b) else {
            continue;
        };
        let within = [middle(a, c), middle(b, c)].into_iter().flatten();
        let within = within.map(|edge| errors[index(edge)]);
        let own = error([index(a), index(b), index(m)]);
        let worst = within.fold(own, f64::max);
        let known: &mut f64 = &mut errors[index(m)];
        *known = known.max(worst);
    }
    let mut open = roots.to_vec();
    let mut found = Vec::new();
    while let Some(triangle) = open.pop() {
        let [a, b, _] = triangle;
        let splits = middle(a, b).is_some_and(|m| errors[index(m)] > 1.0);
        match halves(triangle).filter(|_| splits) {
            Some(halves) => open.extend(halves),
            None => found.push(triangle.map(index)),
        }
    }
    found
}

/// The two halves of a triangle whose right angle is at its last vertex; none of the smallest.
fn halves([a, b, c]: [Vertex; 3]) -> Option<[[Vertex; 3]; 2]> {
    let m = middle(a, b)?;
    Some([[c, a, m], [b, c, m]])
}

/// The vertex half way between two, where there is one.
fn middle([i, j]: Vertex, [k, l]: Vertex) -> Option<Vertex> {
    let is_vertex = (i + k).is_multiple_of(2) && (j + l).is_multiple_of(2);
    is_vertex.then_some([(i + k) / 2, (j + l) / 2])
}

#[cfg(test)]
mod tests {
    use std::collections::HashMap;

    use super::*;

    const COUNT: usize = 16;

    /// Every edge is shared by two triangles that go along it in opposite ways, or lies on the rim.
    fn is_closed(triangles: &[[usize; 3]]) -> bool {
        let mut edges: HashMap<(usize, usize), i32> = HashMap::new();
        for [a, b, c] in triangles {
            for (from, to) in [(a, b), (b, c), (c, a)] {
                *edges.entry((*from.min(to), *from.max(to))).or_default() +=
                    if from < to { 1 } else { -1 };
            }
        }
        let at = |index: usize| [index % (COUNT + 1), index / (COUNT + 1)];
        edges
            .iter()
            .filter(|(_, sum)| **sum != 0)
            .all(|((a, b), _)| {
                let on = |axis: usize, value: usize| [*a, *b].iter().all(|i| at(*i)[axis] == value);
                on(0, 0) || on(0, COUNT) || on(1, 0) || on(1, COUNT)
            })
    }

    fn area(triangles: &[[usize; 3]]) -> i64 {
        let at = |index: usize| [index % (COUNT + 1), index / (COUNT + 1)].map(|v| v as i64);
        let twice = triangles.iter().map(|t| {
            let [a, b, c] = t.map(at);
            let area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
            // As (0, 0), (0, 1), (1, 0).
            assert!(area < 0, "{t:?}");
            -area
        });
        twice.sum::<i64>()
    }

    #[test]
    fn what_is_flat_has_two_triangles_and_what_is_rough_all() {
        assert_eq!(triangles(COUNT, |_| 0.0).len(), 2);
        let all = triangles(COUNT, |_| 2.0);
        assert_eq!(all.len(), 2 * COUNT * COUNT);
        assert!(is_closed(&all));
        assert_eq!(area(&all), 2 * (COUNT * COUNT) as i64);
    }

    #[test]
    fn a_rough_place_opens_no_gap() {
        for rough in [0, 20, 37, 144, 200, 288] {
            let some = triangles(COUNT, |[_, _, m]| if m == rough { 2.0 } else { 0.0 });
            assert!(some.len() < COUNT * COUNT && is_closed(&some), "{rough}");
            assert_eq!(area(&some), 2 * (COUNT * COUNT) as i64);
        }
        // A triangle less is seen as a gap.
        let gap = triangles(COUNT, |[_, _, m]| if m == 37 { 2.0 } else { 0.0 });
        assert!(!is_closed(&gap[1..]));
    }
}
