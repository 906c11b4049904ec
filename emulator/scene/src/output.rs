//! Files that appear whole or not at all: written beside their place, then renamed.

use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;
use thiserror::Error;

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
        let file = BufWriter::with_capacity(1 << 16, temporary_in(directory)?);
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
    builder.prefix(".roughxel-");
    #[cfg(unix)]
    {
        // Temporary files are private by default; this one becomes an ordinary file, so the umask decides.
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    if !directory.is_dir() {
        return Err(io::Error::new(io::ErrorKind::NotFound, format!("no directory {}", directory.display())));
    }
    // The kind alone: the name of the temporary file would puzzle whoever gave another one.
    builder.tempfile_in(directory).map_err(|refused| io::Error::from(refused.kind()))
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
