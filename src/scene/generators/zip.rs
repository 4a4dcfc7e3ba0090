//! Triangles between two rows of points that need not have the same number.

/// Fills the strip between two rows with `a` and `b` segments of even length: calls `emit` with
/// `a + b` triangles as `[(row, point); 3]`, where row is 0 for the `a` row and 1 for the `b` row
/// and points are numbered from 0 to `a` or `b`. All are wound the same way. `shift` moves the rows
/// against each other, in halves of their own segments: it must be the same for both or the strip
/// must be a ring.
pub(super) fn zip(
    a: usize,
    b: usize,
    shift: [usize; 2],
    mut emit: impl FnMut([(usize, usize); 3]),
) {
    let (mut i, mut k) = (0, 0);
    while i < a || k < b {
        // Which row's next point comes first: (2(i + 1) + shift) / 2a against (2(k + 1) + shift) / 2b.
        let first = k == b || i < a && (2 * i + 2 + shift[0]) * b <= (2 * k + 2 + shift[1]) * a;
        if first {
            emit([(0, i), (0, i + 1), (1, k)]);
            i += 1;
        } else {
            emit([(0, i), (1, k + 1), (1, k)]);
            k += 1;
        }
    }
}
