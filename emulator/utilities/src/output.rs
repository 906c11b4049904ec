//! Files that appear whole or not at all: written beside their place, then renamed.
//!
//! A file on its way is locked by who writes it, and the system ends a lock with its process: one that nobody has locked was left by
//! a process that is gone.

use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;
use thiserror::Error;

/// How the names of files on their way begin and end, with [`RANDOM_CHARACTERS`] between.
const PREFIX: &str = ".roughxel-";
const SUFFIX: &str = ".tmp";
const RANDOM_CHARACTERS: usize = 6;

/// A file on its way to `path`; nothing is at `path` before [`OutputFile::commit`], and dropping leaves no trace.
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
    /// Opens a file beside `path`. Symbolic links are followed, so that the file behind them is replaced.
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
        // Larger pieces, as the words of vectors are, go past it.
        let file = BufWriter::with_capacity(1 << 15, temporary_in(directory)?);
        Ok(Self { target: Target::Beside { file, path } })
    }

    /// Whether [`OutputFile::create`] would succeed now; leaves no trace, and does not open what is no regular file, for that may
    /// be a pipe that waits.
    pub fn check(path: &Path) -> io::Result<()> {
        match fs::metadata(path) {
            Ok(metadata) if !metadata.is_file() && !metadata.is_dir() => Ok(()),
            _ => Self::create(path).map(drop),
        }
    }

    /// Takes room for so many bytes in all, where the system has that: what is too much is said before it is made, and writing takes less time.
    ///
    /// Errors: there is not so much room, or no file may be so large.
    pub fn reserve(&self, bytes: u64) -> io::Result<()> {
        #[cfg(target_os = "linux")]
        if let Target::Beside { file, .. } = &self.target {
            use rustix::fs::{FallocateFlags, fallocate};
            use rustix::io::Errno;
            let reserved = fallocate(file.get_ref().as_file(), FallocateFlags::KEEP_SIZE, 0, bytes);
            // Not every file system can.
            if let Err(error @ (Errno::NOSPC | Errno::DQUOT | Errno::FBIG)) = reserved {
                return Err(error.into());
            }
        }
        Ok(())
    }

    /// Flushes and puts the file in its place.
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

/// Whether files can be written below a directory that may still have to be made; leaves no trace.
pub fn check_directory(directory: &Path) -> io::Result<()> {
    let there = |ancestor: &&Path| ancestor.as_os_str().is_empty() || ancestor.exists();
    temporary_in(directory.ancestors().find(there).unwrap_or(directory)).map(drop)
}

/// A file that is gone when it is dropped, in a directory; the empty path is the current one.
fn temporary_in(directory: &Path) -> io::Result<NamedTempFile> {
    let directory = if directory.as_os_str().is_empty() { Path::new(".") } else { directory };
    let mut builder = tempfile::Builder::new();
    builder.prefix(PREFIX).suffix(SUFFIX).rand_bytes(RANDOM_CHARACTERS);
    #[cfg(unix)]
    {
        // Temporary files are private by default; this one becomes an ordinary file, so the umask decides.
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    if !directory.is_dir() {
        return Err(io::Error::new(io::ErrorKind::NotFound, format!("no directory {}", directory.display())));
    }
    loop {
        // The kind alone: the name of the temporary file would puzzle whoever gave another one.
        let file = builder.tempfile_in(directory).map_err(|refused| io::Error::from(refused.kind()))?;
        // Where files cannot be locked nothing is taken for left behind either.
        let locked = file.as_file().lock().is_ok();
        // Between the two it was nobody's, and may have been removed.
        if !locked || file.path().exists() {
            return Ok(file);
        }
    }
}

/// Files that were removed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Removed {
    /// How many.
    pub files: u64,
    /// Their size together.
    pub bytes: u64,
}

/// Removes the files in `directory` that were on their way when their process was killed: those with the names of [`OutputFile`]
/// that no process has locked. What cannot be read, locked or removed stays, as does everything where files cannot be locked.
pub fn remove_abandoned(directory: &Path) -> Removed {
    let directory = if directory.as_os_str().is_empty() { Path::new(".") } else { directory };
    let entries = fs::read_dir(directory).into_iter().flatten().flatten();
    let removed = entries.filter_map(|entry| {
        let name = entry.file_name();
        let random = name.to_str()?.strip_prefix(PREFIX)?.strip_suffix(SUFFIX)?;
        let is_ours = random.len() == RANDOM_CHARACTERS && random.bytes().all(|c| c.is_ascii_alphanumeric());
        // Of the entry itself: a link is none of ours, and to open a pipe is to wait.
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
    /// The file.
    pub path: PathBuf,
    /// Why.
    pub source: io::Error,
}

/// Writes files, each a path below `directory` and its content, in this order. Directories are made as needed.
///
/// Errors: the first file that cannot be written; those before it stay.
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
        // What is reserved and not written is no part of the file.
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
        // As a killed process leaves it: nobody has it open.
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
