//! Files to read: regular ones only, and text without its byte order mark.

use std::fs::{self, File};
use std::io;
use std::path::Path;

/// Opens a file to read.
///
/// Errors: those of the system, or that it is no regular file. The kind is checked before the file is opened, for opening a pipe waits for its
/// writer.
pub fn open_file(path: &Path) -> io::Result<File> {
    let kind = fs::metadata(path)?.file_type();
    if !kind.is_file() {
        let what = if kind.is_dir() { "a directory" } else { "a pipe or a device" };
        return Err(io::Error::new(io::ErrorKind::InvalidInput, format!("it is no regular file but {what}")));
    }
    File::open(path)
}

/// Text without the byte order mark that some editors put at its start.
pub fn without_mark(text: &str) -> &str {
    text.strip_prefix('\u{feff}').unwrap_or(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_regular_files_are_opened() {
        let folder = tempfile::tempdir().unwrap();
        let directory = open_file(folder.path()).unwrap_err().to_string();
        assert_eq!(directory, "it is no regular file but a directory");
        assert_eq!(open_file(&folder.path().join("none")).unwrap_err().kind(), io::ErrorKind::NotFound);
        let file = folder.path().join("file");
        fs::write(&file, "").unwrap();
        assert!(open_file(&file).is_ok());
        #[cfg(unix)]
        assert_eq!(
            open_file(Path::new("/dev/null")).unwrap_err().to_string(),
            "it is no regular file but a pipe or a device"
        );
    }
}
