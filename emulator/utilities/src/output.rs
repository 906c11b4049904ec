//! Files that appear whole or not at all: written next to their place, then renamed.
//!
//! The writer locks its temporary file, and the system ends a lock with its process. A temporary file without a lock was therefore left by a process
//! that is gone.

use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;
use thiserror::Error;

/// Start of the names of temporary files; [`RANDOM_CHARACTERS`] random characters and [`SUFFIX`] follow.
const PREFIX: &str = ".roughxel-";
const SUFFIX: &str = ".tmp";
const RANDOM_CHARACTERS: usize = 6;

/// A temporary file for `path`. Nothing is at `path` before [`OutputFile::commit`], and dropping leaves no trace.
///
/// A path that exists and is no regular file (a pipe, a device) is written to directly.
#[derive(Debug)]
pub struct OutputFile {
    target: Target,
}

#[derive(Debug)]
enum Target {
    Beside { file: BufWriter<NamedTempFile>, path: PathBuf },
    Direct(BufWriter<File>),
}

impl OutputFile {
    /// Opens a temporary file next to `path`. Symbolic links are followed, so the file that they name is replaced.
    ///
    /// Errors: the directory is missing or not writable, or `path` is a directory.
    pub fn create(path: &Path) -> io::Result<Self> {
        let path = match fs::metadata(path) {
            Ok(metadata) if metadata.is_file() => fs::canonicalize(path)?,
            Ok(metadata) if metadata.is_dir() => return Err(io::ErrorKind::IsADirectory.into()),
            Ok(_) => {
                let file = File::options().write(true).open(path)?;
                return Ok(Self { target: Target::Direct(BufWriter::new(file)) });
            }
            Err(_) => path.to_path_buf(),
        };
        let directory = path.parent().ok_or(io::ErrorKind::InvalidInput)?;
        // Larger pieces, such as the words of vectors, bypass the buffer.
        let file = BufWriter::with_capacity(1 << 15, temporary_in(directory)?);
        Ok(Self { target: Target::Beside { file, path } })
    }

    /// Checks that [`OutputFile::create`] would succeed now. It leaves no trace. It does not open a file that is not regular, for that may be a pipe
    /// that waits.
    pub fn check(path: &Path) -> io::Result<()> {
        match fs::metadata(path) {
            Ok(metadata) if !metadata.is_file() && !metadata.is_dir() => Ok(()),
            _ => Self::create(path).map(drop),
        }
    }

    /// Reserves room for `bytes` bytes in all, if the system can. A file that is too large is then refused before it is made, and writing takes less
    /// time.
    ///
    /// Errors: there is not so much room, or no file may be so large.
    pub fn reserve(&self, bytes: u64) -> io::Result<()> {
        #[cfg(target_os = "linux")]
        if let Target::Beside { file, .. } = &self.target {
            use rustix::fs::{FallocateFlags, fallocate};
            use rustix::io::Errno;
            let reserved = fallocate(file.get_ref().as_file(), FallocateFlags::KEEP_SIZE, 0, bytes);
            // Not every file system can reserve room.
            if let Err(error @ (Errno::NOSPC | Errno::DQUOT | Errno::FBIG)) = reserved {
                return Err(error.into());
            }
        }
        Ok(())
    }

    /// Flushes the file and puts it in its place.
    pub fn commit(self) -> io::Result<()> {
        match self.target {
            Target::Beside { file, path } => {
                let file = file.into_inner().map_err(io::IntoInnerError::into_error)?;
                file.persist(path).map(drop).map_err(io::Error::from)
            }
            Target::Direct(mut file) => file.flush(),
        }
    }
}

impl Write for OutputFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match &mut self.target {
            Target::Beside { file, .. } => file.write(bytes),
            Target::Direct(file) => file.write(bytes),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        match &mut self.target {
            Target::Beside { file, .. } => file.flush(),
            Target::Direct(file) => file.flush(),
        }
    }
}

/// Checks that files can be written below a directory that may not exist yet; leaves no trace.
pub fn check_directory(directory: &Path) -> io::Result<()> {
    let there = |ancestor: &&Path| ancestor.as_os_str().is_empty() || ancestor.exists();
    temporary_in(directory.ancestors().find(there).unwrap_or(directory)).map(drop)
}

/// Temporary file in a directory, deleted when it is dropped. The empty path is the current directory.
fn temporary_in(directory: &Path) -> io::Result<NamedTempFile> {
    let directory = if directory.as_os_str().is_empty() { Path::new(".") } else { directory };
    let mut builder = tempfile::Builder::new();
    builder.prefix(PREFIX).suffix(SUFFIX).rand_bytes(RANDOM_CHARACTERS);
    #[cfg(unix)]
    {
        // Temporary files are private by default. This one becomes an ordinary file, so the umask decides.
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    if !directory.is_dir() {
        return Err(io::Error::new(io::ErrorKind::NotFound, format!("no directory {}", directory.display())));
    }
    loop {
        // The kind alone: the name of the temporary file would puzzle a user who gave a different name.
        let file = builder.tempfile_in(directory).map_err(|refused| io::Error::from(refused.kind()))?;
        // If files cannot be locked, none is taken for abandoned either.
        let locked = file.as_file().lock().is_ok();
        // Between creation and lock the file belonged to nobody, and may have been removed.
        if !locked || file.path().exists() {
            return Ok(file);
        }
    }
}

/// Files that were removed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Removed {
    /// Number of files.
    pub files: u64,
    /// Total size in bytes.
    pub bytes: u64,
}

/// Removes temporary files in `directory` whose process was killed: those with the names of [`OutputFile`] that no process has locked. A file that
/// cannot be read, locked or removed stays. All files stay if files cannot be locked.
pub fn remove_abandoned(directory: &Path) -> Removed {
    let directory = if directory.as_os_str().is_empty() { Path::new(".") } else { directory };
    let entries = fs::read_dir(directory).into_iter().flatten().flatten();
    let removed = entries.filter_map(|entry| {
        let name = entry.file_name();
        let random = name.to_str()?.strip_prefix(PREFIX)?.strip_suffix(SUFFIX)?;
        let is_ours = random.len() == RANDOM_CHARACTERS && random.bytes().all(|c| c.is_ascii_alphanumeric());
        // Metadata of the entry itself: a link is never ours, and opening a pipe would wait.
        let metadata = entry.metadata().ok().filter(|metadata| is_ours && metadata.is_file())?;
        let file = File::options().write(true).open(entry.path()).ok()?;
        file.try_lock().ok()?;
        fs::remove_file(entry.path()).ok()?;
        Some(metadata.len())
    });
    removed.fold(Removed::default(), |sum, bytes| Removed { files: sum.files + 1, bytes: sum.bytes + bytes })
}

/// A file or its directory cannot be written.
#[derive(Debug, Error)]
#[error("cannot write {}", path.display())]
pub struct WriteError {
    /// Path of the file.
    pub path: PathBuf,
    /// Cause of the failure.
    pub source: io::Error,
}

/// Writes files in this order, each a path below `directory` and its content. Missing directories are made.
///
/// Errors: the first file that cannot be written; the files before it stay.
pub fn write_files<P: AsRef<Path>, C: AsRef<[u8]>>(
    directory: &Path,
    files: impl IntoIterator<Item = (P, C)>,
) -> Result<(), WriteError> {
    for (name, content) in files {
        let path = directory.join(name);
        write_file(&path, content.as_ref()).map_err(|source| WriteError { path, source })?;
    }
    Ok(())
}

fn write_file(path: &Path, content: &[u8]) -> io::Result<()> {
    if let Some(directory) = path.parent() {
        fs::create_dir_all(directory)?;
    }
    let mut file = OutputFile::create(path)?;
    file.write_all(content)?;
    file.commit()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[cfg(target_os = "linux")]
    #[test]
    fn room_that_there_is_not_is_said_before_anything_is_written() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("result");
        let mut written = OutputFile::create(&path).unwrap();
        assert!(written.reserve(1 << 62).is_err());
        // Reserved bytes that are not written are no part of the file.
        written.reserve(1 << 16).unwrap();
        written.write_all(b"short").unwrap();
        written.commit().unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"short");
    }

    #[test]
    fn only_files_that_nobody_writes_any_more_are_removed() {
        let folder = tempfile::tempdir().unwrap();
        let name = |name: &str| folder.path().join(name);
        let mut written = OutputFile::create(&name("result")).unwrap();
        written.write_all(b"on its way").unwrap();
        // State that a killed process leaves: nobody has the file open.
        fs::write(name(".roughxel-a1B2c3.tmp"), "1234").unwrap();
        let others = [".roughxel-a1B2c.tmp", ".roughxel-a1B2c3", ".roughxel-a1 2c3.tmp", "x.roughxel-a1B2c3.tmp"];
        others.iter().for_each(|other| fs::write(name(other), "").unwrap());
        fs::create_dir(name(".roughxel-folder.tmp")).unwrap();
        #[cfg(unix)]
        std::os::unix::fs::symlink(name("result"), name(".roughxel-linked.tmp")).unwrap();

        assert_eq!(remove_abandoned(folder.path()), Removed { files: 1, bytes: 4 });
        assert_eq!(remove_abandoned(folder.path()), Removed::default());
        written.commit().unwrap();
        assert_eq!(fs::read(name("result")).unwrap(), b"on its way");
        assert!(others.iter().all(|other| name(other).exists()));
        assert!(name(".roughxel-folder.tmp").exists());
        assert_eq!(remove_abandoned(&name("nowhere")), Removed::default());
    }
}
