//! Machine with an operating system, whose C library has the way out. The standard library would take minutes of compiling for every target.

use core::ffi::c_void;
use core::fmt;
use core::panic::PanicInfo;

mod c {
    use core::ffi::c_void;

    unsafe extern "C" {
        pub(super) fn write(file: i32, bytes: *const c_void, count: usize) -> isize;
        pub(super) safe fn exit(code: i32) -> !;
    }
}

/// Standard output.
#[derive(Debug)]
pub struct Output;

impl fmt::Write for Output {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        let mut bytes = text.as_bytes();
        while !bytes.is_empty() {
            // SAFETY: the bytes are those of the slice.
            let written = unsafe { c::write(1, bytes.as_ptr().cast::<c_void>(), bytes.len()) };
            bytes = usize::try_from(written).ok().and_then(|count| bytes.get(count..)).ok_or(fmt::Error)?;
        }
        Ok(())
    }
}

/// Prints a line on the standard output.
#[macro_export]
macro_rules! line {
    ($($text:tt)*) => {{
        use core::fmt::Write as _;
        let _ = writeln!($crate::libc::Output, $($text)*);
    }};
}
pub use crate::line as println;

/// Ends the program.
pub fn exit(code: i32) -> ! {
    c::exit(code)
}

#[panic_handler]
fn panic(info: &PanicInfo<'_>) -> ! {
    println!("{info}");
    exit(101)
}
