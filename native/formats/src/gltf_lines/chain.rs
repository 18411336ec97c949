//! Single lines chained into strips.

/// A run of vertices along joined lines.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Strip {
    /// Vertices in order; a closed strip does not repeat its first.
    pub vertices: Vec<u32>,
    /// Whether the last vertex is joined to the first.
    pub closed: bool,
}

/// Chains lines that share vertices: strips run through every vertex that exactly two lines share, end at all others,
/// and close where they meet no other. Every line is used once; lines from a vertex to itself are dropped. Strips come
/// in the order of their first lines, and run in the direction of most of them. All vertices are below `vertex_count`.
pub(super) fn chain(lines: &[[u32; 2]], vertex_count: usize) -> Vec<Strip> {
    // The lines at each vertex, as ranges of one list.
    let lines: Vec<[u32; 2]> = lines.iter().copied().filter(|[a, b]| a != b).collect();
    let mut first = vec![0_u32; vertex_count + 1];
    for &vertex in lines.iter().flatten() {
        first[vertex as usize + 1] += 1;
    }
    for vertex in 0..vertex_count {
        first[vertex + 1] += first[vertex];
    }
    let mut filled = first.clone();
    let mut at_vertex = vec![0_u32; 2 * lines.len()];
    for (line, ends) in lines.iter().enumerate() {
        for &vertex in ends {
            at_vertex[filled[vertex as usize] as usize] = line as u32;
            filled[vertex as usize] += 1;
        }
    }
    let lines_at = |vertex: u32| &at_vertex[first[vertex as usize] as usize..first[vertex as usize + 1] as usize];

    let mut used = vec![false; lines.len()];
    let mut strips: Vec<(usize, Strip)> = Vec::new();
    let mut walk = |line: usize, start: u32, used: &mut [bool]| {
        let (mut vertices, mut current, mut lowest) = (vec![start], line, line);
        let (mut along, mut against) = (0, 0);
        loop {
            used[current] = true;
            lowest = lowest.min(current);
            let [a, b] = lines[current];
            let from = vertices[vertices.len() - 1];
            let to = if from == a { b } else { a };
            if from == a {
                along += 1
            } else {
                against += 1
            }
            let next = match lines_at(to) {
                [x, y] if to != start => Some(x ^ y ^ current as u32),
                _ => None,
            };
            let closed = to == start && lines_at(to).len() == 2;
            if !closed {
                vertices.push(to);
            }
            match next {
                Some(line) if !used[line as usize] => current = line as usize,
                _ => {
                    if against > along {
                        vertices.reverse();
                    }
                    strips.push((lowest, Strip { vertices, closed }));
                    return;
                }
            }
        }
    };
    // Open strips from their ends, then what is left: loops.
    for (line, ends) in lines.iter().enumerate() {
        if let Some(&end) = ends.iter().find(|&&vertex| lines_at(vertex).len() != 2)
            && !used[line]
        {
            walk(line, end, &mut used);
        }
    }
    for (line, ends) in lines.iter().enumerate() {
        if !used[line] {
            walk(line, ends[0], &mut used);
        }
    }
    strips.sort_by_key(|(lowest, _)| *lowest);
    strips.into_iter().map(|(_, strip)| strip).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn open(vertices: &[u32]) -> Strip {
        Strip { vertices: vertices.to_vec(), closed: false }
    }

    #[test]
    fn lines_chain_in_their_own_direction() {
        assert_eq!(chain(&[[0, 1], [1, 2], [2, 3]], 4), [open(&[0, 1, 2, 3])]);
        assert_eq!(chain(&[[2, 3], [1, 2], [0, 1]], 4), [open(&[0, 1, 2, 3])]);
        assert_eq!(chain(&[[0, 1], [2, 1], [2, 3], [3, 4]], 5), [open(&[0, 1, 2, 3, 4])]);
        assert_eq!(chain(&[[0, 1], [2, 3]], 4), [open(&[0, 1]), open(&[2, 3])]);
    }

    #[test]
    fn loops_close_and_junctions_end_strips() {
        assert_eq!(chain(&[[0, 1], [1, 2], [2, 0]], 3), [Strip { vertices: vec![0, 1, 2], closed: true }]);
        assert_eq!(chain(&[[0, 1], [1, 2], [1, 3]], 4), [open(&[0, 1]), open(&[1, 2]), open(&[1, 3])]);
        // A loop with a tail: it begins and ends at the junction.
        assert_eq!(chain(&[[0, 1], [1, 2], [2, 3], [3, 1]], 4), [open(&[0, 1]), open(&[1, 2, 3, 1])]);
    }

    #[test]
    fn points_and_double_lines_do_no_harm() {
        assert_eq!(chain(&[[0, 0], [0, 1]], 2), [open(&[0, 1])]);
        assert_eq!(chain(&[[0, 1], [1, 0]], 2), [Strip { vertices: vec![0, 1], closed: true }]);
        assert_eq!(chain(&[], 0), []);
    }

    #[test]
    fn every_line_is_used_exactly_once() {
        // Pseudo-random graphs, of every density.
        let mut state = 1_u64;
        let mut random = |below: u32| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            ((state >> 33) % u64::from(below)) as u32
        };
        for round in 0..300 {
            let vertices = 2 + round % 20;
            let mut lines: Vec<[u32; 2]> =
                (0..random(30)).map(|_| [random(vertices), random(vertices)]).filter(|[a, b]| a != b).collect();
            let mut found: Vec<[u32; 2]> = Vec::new();
            for Strip { mut vertices, closed } in chain(&lines, vertices as usize) {
                if closed {
                    vertices.push(vertices[0]);
                }
                found.extend(vertices.windows(2).map(|pair| [pair[0], pair[1]]));
            }
            for line in lines.iter_mut().chain(&mut found) {
                line.sort_unstable();
            }
            lines.sort_unstable();
            found.sort_unstable();
            assert_eq!(lines, found);
        }
    }
}
