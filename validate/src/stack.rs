//! How much stack a piece of work comes to use.

use std::io;
use std::ptr::null_mut;

/// More than any work here needs.
const SIZE: usize = 8 << 20;
/// What an untouched byte of the stack is.
const UNTOUCHED: u8 = 0xa5;

/// Bytes of stack that the work uses on a thread of its own, beyond what the thread has used before, to within
/// the length of the longest run of bytes that the work leaves as they were.
///
/// The thread fills the free part of its stack with a pattern, works, and looks how far down the pattern is
/// gone.
///
/// # Errors
/// If the operating system does not say where the stack is.
pub fn bytes(work: impl FnOnce() + Send) -> io::Result<usize> {
    std::thread::scope(|scope| {
        let thread = std::thread::Builder::new().stack_size(SIZE);
        let measured = thread.spawn_scoped(scope, || measure(work))?;
        measured.join().expect("the work does not panic")
    })
}

/// Room below the caller that its own calls may use.
const MARGIN: usize = 4096;

#[inline(never)]
fn measure(work: impl FnOnce()) -> io::Result<usize> {
    let here = 0_u8;
    let top = (&raw const here as usize) - MARGIN;
    let bottom = lowest()?;
    // SAFETY: all of it is of this thread's stack, below every frame that is alive: those of `lowest` are
    // gone, and that of `write_bytes` fits into the margin.
    unsafe { std::ptr::write_bytes(bottom as *mut u8, UNTOUCHED, top - bottom) };
    work();
    // SAFETY: likewise; what the work left there are bytes.
    let is_untouched = |at: &usize| unsafe { (*at as *const u8).read_volatile() == UNTOUCHED };
    let untouched = (bottom..top).take_while(is_untouched).count();
    Ok((top - bottom - untouched) + if untouched == top - bottom { 0 } else { MARGIN })
}

/// Where the stack of this thread ends, above its guard.
fn lowest() -> io::Result<usize> {
    let ok = |code| match code {
        0 => Ok(()),
        code => Err(io::Error::from_raw_os_error(code)),
    };
    let (mut address, mut size, mut guard) = (null_mut(), 0, 0);
    // SAFETY: the attributes are filled in by the first call, read, and given back.
    unsafe {
        let mut attributes = std::mem::zeroed();
        ok(libc::pthread_getattr_np(
            libc::pthread_self(),
            &mut attributes,
        ))?;
        let stack = ok(libc::pthread_attr_getstack(
            &attributes,
            &mut address,
            &mut size,
        ));
        let guarded = ok(libc::pthread_attr_getguardsize(&attributes, &mut guard));
        libc::pthread_attr_destroy(&mut attributes);
        stack.and(guarded)?;
    }
    Ok(address as usize + guard)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::hint::black_box;

    #[inline(never)]
    fn descend(levels: usize) -> u8 {
        let frame = black_box([levels as u8; 1024]);
        match levels {
            0 => frame[0],
            _ => descend(levels - 1).wrapping_add(black_box(frame)[levels % 1024]),
        }
    }

    #[test]
    fn a_deeper_recursion_uses_more() {
        let of = |levels| {
            let work = || {
                black_box(descend(levels));
            };
            bytes(work).unwrap()
        };
        let (few, many) = (of(10), of(110));
        assert!((10 << 10..64 << 10).contains(&few), "{few}");
        assert!(
            (100 << 10..400 << 10).contains(&(many - few)),
            "{few} {many}"
        );
    }

    #[test]
    fn next_to_nothing_uses_a_few_kib() {
        let bytes = bytes(|| ()).unwrap();
        assert!(bytes <= 2 * MARGIN, "{bytes}");
    }
}
