//! Memory that is made beforehand.

/// A vector of so many copies of a value, in huge pages (of 2 MiB) if the system gives them: with all memory of
/// the process in small ones a trace took 1.0 to 1.1 times as long. What the vector needs is written, so no page is missing later.
pub fn room<T: Clone>(value: T, len: usize) -> Vec<T> {
    let mut room = empty(len);
    room.resize(len, value);
    room
}

/// As [`room`], of values that are made one by one.
pub(crate) fn room_with<T>(make: impl FnMut() -> T, len: usize) -> Vec<T> {
    let mut room = empty(len);
    room.resize_with(len, make);
    room
}

fn empty<T>(len: usize) -> Vec<T> {
    let room = Vec::with_capacity(len);
    #[cfg(all(target_os = "linux", not(miri)))]
    ask_for_huge_pages(room.as_ptr() as usize, len * size_of::<T>());
    room
}

/// Asks for what whole huge pages there are in a piece of memory; it is no matter if there are none.
#[cfg(all(target_os = "linux", not(miri)))]
fn ask_for_huge_pages(start: usize, bytes: usize) {
    const HUGE: usize = 2 << 20;
    let from = start.next_multiple_of(HUGE);
    let to = (start + bytes) / HUGE * HUGE;
    if from < to {
        // SAFETY: advice on memory of our own, which changes nothing that is in it.
        unsafe { libc::madvise(from as *mut libc::c_void, to - from, libc::MADV_HUGEPAGE) };
    }
}

#[cfg(test)]
mod tests {
    #[test]
    fn there_is_room_of_any_size() {
        for len in [0, 1, 1000, (5 << 20) + 3] {
            let room = super::room([7u32, 8], len);
            assert!(room.len() == len && room.iter().all(|pair| *pair == [7, 8]));
        }
        assert_eq!(super::room((), 3).len(), 3);
    }
}
