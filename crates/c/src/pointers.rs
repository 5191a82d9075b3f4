//! From pointers of C to references: the only places that read or write through them.

#![expect(unsafe_code, reason = "the argument is at the head of this crate")]

use std::mem::MaybeUninit;

use crate::status::Failure;

/// Fails if a pointer is null or not aligned, naming it by the name of its argument.
fn check<T>(pointer: *const T, name: &'static str) -> Result<(), Failure> {
    if pointer.is_null() {
        return Err(Failure::Null { name });
    }
    if !pointer.is_aligned() {
        let alignment = align_of::<T>();
        return Err(Failure::Unaligned { name, alignment });
    }
    Ok(())
}

/// Returns what an argument points to.
///
/// # Safety
///
/// Unless it is null or not aligned, the pointer leads to a value that lives as long as `'a` and is not changed meanwhile.
pub(crate) unsafe fn read<'a, T>(pointer: *const T, name: &'static str) -> Result<&'a T, Failure> {
    check(pointer, name)?;
    // SAFETY: the pointer is neither null nor unaligned, and the rest is the caller's guarantee.
    Ok(unsafe { &*pointer })
}

/// Returns the place that an argument points to, for a value that the call will write.
///
/// # Safety
///
/// Unless it is null or not aligned, the pointer leads to memory for a `T` that nothing else uses during `'a`.
pub(crate) unsafe fn write<'a, T>(
    pointer: *mut T,
    name: &'static str,
) -> Result<&'a mut MaybeUninit<T>, Failure> {
    check(pointer, name)?;
    // SAFETY: the pointer is neither null nor unaligned, the rest is the caller's guarantee, and `MaybeUninit` asks for no value.
    Ok(unsafe { &mut *pointer.cast::<MaybeUninit<T>>() })
}

/// Returns the buffer of `capacity` values that an argument points to; with a capacity of 0 the pointer may be null.
///
/// # Safety
///
/// Unless it is null or not aligned, the pointer leads to memory for `capacity` values that nothing else uses during `'a`.
pub(crate) unsafe fn buffer<'a, T>(
    pointer: *mut T,
    capacity: usize,
    name: &'static str,
) -> Result<&'a mut [MaybeUninit<T>], Failure> {
    // The pointer to no values is not looked at.
    if capacity == 0 {
        return Ok(&mut []);
    }
    check(pointer, name)?;

    // No buffer is longer than half of the addresses: a larger number can only be wrong, and a slice must not have it.
    let most = isize::MAX as usize / size_of::<T>();
    if capacity > most {
        return Err(Failure::Capacity { capacity, most });
    }
    // SAFETY: the pointer is neither null nor unaligned, the length fits a slice, and the rest is the caller's guarantee.
    Ok(unsafe { std::slice::from_raw_parts_mut(pointer.cast(), capacity) })
}

/// Frees what the caller gives back.
///
/// # Safety
///
/// The pointer is not null, is from `Box::into_raw`, and is not used any longer.
pub(crate) unsafe fn free<T>(pointer: *mut T) {
    // SAFETY: this is the caller's guarantee.
    drop(unsafe { Box::from_raw(pointer) });
}
