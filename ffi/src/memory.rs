//! The checks that turn pointers from C into slices and records. Every raw pointer of a caller
//! passes here.

use std::alloc::Layout;
use std::ffi::c_char;
use std::fmt::{self, Display, Write};
use std::slice;

use jcas_core::config::text::Counter;
use jcas_core::{Error, Printable};

use crate::status::{
    Fault, JCAS_ERROR_ALIGNMENT, JCAS_ERROR_INTERNAL, JCAS_ERROR_LENGTH, JCAS_ERROR_NULL,
    JCAS_ERROR_STRUCT_SIZE,
};

/// A type for which every bit pattern is a valid value.
///
/// # Safety
/// Implement it only for such types.
pub(crate) unsafe trait Plain: Copy {}
// SAFETY: integers and floats.
unsafe impl Plain for u8 {}
// SAFETY: as above.
unsafe impl Plain for u32 {}
// SAFETY: as above.
unsafe impl Plain for u64 {}
// SAFETY: as above.
unsafe impl Plain for usize {}
// SAFETY: as above.
unsafe impl Plain for f32 {}
// SAFETY: as above.
unsafe impl Plain for f64 {}

/// A struct of the header whose first field is its own size.
///
/// # Safety
/// Implement it only for `repr(C)` structs whose first field is that `u32`.
pub(crate) unsafe trait Record: Plain {
    /// The size that its first field must name.
    const SIZE: u32 = size_of::<Self>() as u32;
}

fn check<T>(pointer: *const T) -> Result<(), Fault> {
    if pointer.is_null() {
        Err(Fault::Status(JCAS_ERROR_NULL))
    } else if !pointer.is_aligned() {
        Err(Fault::Status(JCAS_ERROR_ALIGNMENT))
    } else {
        Ok(())
    }
}

fn check_count(what: &'static str, got: usize, expected: usize) -> Result<(), Fault> {
    if got == expected {
        return Ok(());
    }
    Err(Fault::Kernel(Error::Length {
        what,
        expected,
        got,
    }))
}

/// The address range of a buffer.
#[derive(Clone, Copy)]
pub(crate) struct Span {
    name: &'static str,
    begin: usize,
    end: usize,
}

/// Checks that no two buffers of a call overlap.
pub(crate) fn check_apart(spans: &[Span]) -> Result<(), Fault> {
    for (index, a) in spans.iter().enumerate() {
        for b in &spans[..index] {
            if a.begin < b.end && b.begin < a.end {
                return Err(Fault::Overlap(a.name, b.name));
            }
        }
    }
    Ok(())
}

/// A buffer of the caller that has passed its own checks. It becomes a slice after the checks of
/// all buffers of the call.
pub(crate) struct Buffer<T> {
    pointer: *mut T,
    count: usize,
    pub(crate) span: Span,
}

impl<T: Plain> Buffer<T> {
    /// Checks a required buffer of exactly `expected` elements.
    pub(crate) fn new(
        name: &'static str,
        pointer: *const T,
        count: usize,
        expected: usize,
    ) -> Result<Self, Fault> {
        check(pointer)?;
        check_count(name, count, expected)?;
        let begin = pointer.addr();
        let end = begin.saturating_add(count.saturating_mul(size_of::<T>()));
        Ok(Self {
            pointer: pointer.cast_mut(),
            count,
            span: Span { name, begin, end },
        })
    }

    /// Checks an optional buffer as [`Buffer::new`] does; null with a count of 0 is none.
    pub(crate) fn optional(
        name: &'static str,
        pointer: *const T,
        count: usize,
        expected: usize,
    ) -> Result<Self, Fault> {
        if pointer.is_null() && count == 0 {
            let (begin, end) = (0, 0);
            return Ok(Self {
                pointer: std::ptr::dangling_mut(),
                count,
                span: Span { name, begin, end },
            });
        }
        Self::new(name, pointer, count, expected)
    }

    /// Returns the elements to read.
    ///
    /// # Safety
    /// The pointer was invalid only by being null or misaligned. Otherwise the elements can be
    /// read, and stay as they are for as long as the slice lives.
    pub(crate) unsafe fn read<'a>(&self) -> &'a [T] {
        // SAFETY: not null, aligned, and readable by the caller's promise. The count comes from a
        // validated model, so that the bytes fit an isize.
        unsafe { slice::from_raw_parts(self.pointer, self.count) }
    }

    /// Returns the elements to write.
    ///
    /// # Safety
    /// The conditions of [`Buffer::read`] hold. The elements can be written, and [`check_apart`]
    /// has checked every buffer of the call.
    pub(crate) unsafe fn write<'a>(&self) -> &'a mut [T] {
        // SAFETY: as in `read`; no other buffer of the call has these elements.
        unsafe { slice::from_raw_parts_mut(self.pointer, self.count) }
    }
}

/// Checks a caller's buffer of exactly `expected` elements and returns them to read.
///
/// # Safety
/// `pointer` is invalid only by being null or misaligned. Otherwise `count` elements can be read
/// there and do not change while the slice lives.
pub(crate) unsafe fn input<'a, T: Plain>(
    pointer: *const T,
    count: usize,
    expected: usize,
) -> Result<&'a [T], Fault> {
    check(pointer)?;
    check_count("a buffer", count, expected)?;
    // SAFETY: not null, aligned, and readable for `count` elements by the caller's promise.
    // `expected` comes from a validated model, so the bytes fit an isize.
    Ok(unsafe { slice::from_raw_parts(pointer, count) })
}

/// Checks a caller's buffer of exactly `expected` elements and returns them to write.
///
/// # Safety
/// As [`input`], and the elements can be written and belong to no other buffer of the call.
pub(crate) unsafe fn output<'a, T: Plain>(
    pointer: *mut T,
    count: usize,
    expected: usize,
) -> Result<&'a mut [T], Fault> {
    check(pointer)?;
    check_count("a buffer", count, expected)?;
    // SAFETY: as in `input`; exclusive by the caller's promise.
    Ok(unsafe { slice::from_raw_parts_mut(pointer, count) })
}

/// Returns a caller's bytes of any length and alignment.
///
/// # Safety
/// `length` bytes can be read at a pointer that is not null.
pub(crate) unsafe fn bytes<'a>(pointer: *const u8, length: usize) -> Result<&'a [u8], Fault> {
    check(pointer)?;
    if length > isize::MAX as usize {
        return Err(Fault::Status(JCAS_ERROR_LENGTH));
    }
    // SAFETY: not null, readable by the caller's promise, no longer than an object can be.
    Ok(unsafe { slice::from_raw_parts(pointer, length) })
}

/// Checks a place for a scalar or a handle.
///
/// # Safety
/// A pointer that is neither null nor misaligned can be written and belongs to nothing else.
pub(crate) unsafe fn place<'a, T>(pointer: *mut T) -> Result<Place<'a, T>, Fault> {
    check(pointer)?;
    Ok(Place(pointer, std::marker::PhantomData))
}

/// A checked place of the caller that is written at most once, at the end of a call. It may be
/// uninitialised, so no reference to it is made.
pub(crate) struct Place<'a, T>(*mut T, std::marker::PhantomData<&'a mut T>);

impl<T> Place<'_, T> {
    pub(crate) fn put(self, value: T) {
        // SAFETY: `place` and `record` checked the pointer, the caller promised the memory.
        unsafe { self.0.write(value) }
    }
}

/// Writes the size and alignment of a block, whose layout is computed after the check of both
/// places.
///
/// # Safety
/// As [`place`], for both.
pub(crate) unsafe fn put_layout(
    size: *mut usize,
    alignment: *mut usize,
    layout: impl FnOnce() -> Result<Layout, Fault>,
) -> Result<(), Fault> {
    // SAFETY: the caller's promises, passed on.
    let (size, alignment) = unsafe { (place(size)?, place(alignment)?) };
    let layout = layout()?;
    size.put(layout.size());
    alignment.put(layout.align());
    Ok(())
}

/// Checks a place for a record whose caller has set `struct_size`.
///
/// # Safety
/// As [`place`], and the first four bytes can be read.
pub(crate) unsafe fn record<'a, T: Record>(pointer: *mut T) -> Result<Place<'a, T>, Fault> {
    check(pointer)?;
    // SAFETY: a record begins with a `u32`, which the caller has set.
    let size = unsafe { pointer.cast::<u32>().read() };
    if size == T::SIZE {
        Ok(Place(pointer, std::marker::PhantomData))
    } else {
        Err(Fault::Status(JCAS_ERROR_STRUCT_SIZE))
    }
}

/// Checks a place for a record whose size is a separate argument.
///
/// # Safety
/// As [`place`].
pub(crate) unsafe fn sized_record<'a, T: Record>(
    pointer: *mut T,
    struct_size: usize,
) -> Result<Place<'a, T>, Fault> {
    check(pointer)?;
    if struct_size == T::SIZE as usize {
        Ok(Place(pointer, std::marker::PhantomData))
    } else {
        Err(Fault::Status(JCAS_ERROR_STRUCT_SIZE))
    }
}

/// Reads a record of the caller by value.
///
/// # Safety
/// The first four bytes can be read, and as many as they say.
pub(crate) unsafe fn read_record<T: Record>(pointer: *const T) -> Result<T, Fault> {
    // SAFETY: passed on; nothing is written through the place.
    unsafe { record(pointer.cast_mut()) }?;
    // SAFETY: aligned, and readable for its whole size, which the caller has named.
    Ok(unsafe { pointer.read() })
}

/// A reason that can be written as text. A plain text avoids the formatting machinery.
pub(crate) trait Text {
    fn write_to(&self, out: &mut impl Write) -> fmt::Result;
}

impl Text for str {
    fn write_to(&self, out: &mut impl Write) -> fmt::Result {
        out.write_str(self)
    }
}

/// A displayable value as a reason, in which text from input is escaped.
pub(crate) struct Message<T>(pub(crate) T);

impl<T: Display> Text for Message<T> {
    fn write_to(&self, out: &mut impl Write) -> fmt::Result {
        write!(out, "{}", Printable(&self.0))
    }
}

/// Writes a message as a C string, truncated to the buffer. A null buffer receives nothing.
///
/// # Safety
/// `capacity` bytes can be written at a pointer that is not null.
pub(crate) unsafe fn message<T: Text + ?Sized>(text: &T, buffer: *mut c_char, capacity: usize) {
    if buffer.is_null() || capacity == 0 {
        return;
    }
    let mut cut = Cut {
        buffer,
        room: capacity - 1,
        written: 0,
    };
    // An error here only means that the text was truncated.
    let _cut = text.write_to(&mut cut);
    // SAFETY: at most `capacity` - 1 bytes were written.
    let terminator = unsafe { buffer.add(cut.written) };
    // SAFETY: as above.
    unsafe { terminator.write(0) };
}

/// A writer of whole characters into a caller's buffer until it is full.
struct Cut {
    buffer: *mut c_char,
    room: usize,
    written: usize,
}

impl Write for Cut {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        let mut end = text.len().min(self.room - self.written);
        while !text.is_char_boundary(end) {
            end -= 1;
        }
        // SAFETY: within the caller's buffer, whose room is counted here.
        let to = unsafe { self.buffer.add(self.written) };
        // SAFETY: as above; a str is no buffer of the caller.
        unsafe { to.copy_from_nonoverlapping(text.as_ptr().cast(), end) };
        self.written += end;
        if end == text.len() {
            Ok(())
        } else {
            self.room = self.written;
            Err(fmt::Error)
        }
    }
}

/// A refusal as text, which is empty without a refusal.
pub(crate) struct Words(pub(crate) Option<Fault>);

impl Text for Words {
    fn write_to(&self, out: &mut impl Write) -> fmt::Result {
        self.0.map_or(Ok(()), |fault| write!(out, "{fault}"))
    }
}

/// Writes the length of a text and, into a buffer that fits it, the text with a terminating zero.
/// If the buffer is too short, only the length is written.
///
/// # Safety
/// `capacity` bytes can be written at `buffer` if it is not null; `length` as for [`place`].
pub(crate) unsafe fn text_out<T: Text + ?Sized>(
    text: &T,
    buffer: *mut c_char,
    capacity: usize,
    length: *mut usize,
) -> Result<(), Fault> {
    // SAFETY: the caller's promises, passed on.
    let length = unsafe { place(length) }?;
    if buffer.is_null() && capacity != 0 {
        return Err(Fault::Status(JCAS_ERROR_NULL));
    }
    let mut counter = Counter::default();
    let counted = text.write_to(&mut counter);
    counted.map_err(|_| Fault::Status(JCAS_ERROR_INTERNAL))?;
    length.put(counter.0);
    if buffer.is_null() {
        return Ok(());
    }
    check_fits(counter.0, capacity)?;
    // SAFETY: passed on; the whole text fits.
    unsafe { message(text, buffer, capacity) };
    Ok(())
}

const fn check_fits(len: usize, capacity: usize) -> Result<(), Fault> {
    if capacity > len {
        Ok(())
    } else {
        Err(Fault::Status(JCAS_ERROR_LENGTH))
    }
}
