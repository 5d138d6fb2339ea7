//! Files of bounded size, read whole.

use std::fs::{self, File};
use std::io::{self, BufRead, BufReader, ErrorKind, Read};
use std::path::Path;

/// The most bytes of a configuration, a card, a table, a plan or a manifest.
pub const TEXT_BYTES_MAX: u64 = 1 << 28;
/// The most bytes of a policy's weights.
pub const WEIGHTS_BYTES_MAX: u64 = 1 << 30;
/// The most bytes of a trace.
pub const TRACE_BYTES_MAX: u64 = 1 << 32;

/// Opens a regular file. A pipe or a device, which may have no end, is refused before it is opened,
/// since opening a pipe waits for its other end.
///
/// # Errors
/// The file cannot be opened, is not regular, or has more than `bytes_max` bytes.
pub fn open(path: &Path, bytes_max: u64) -> io::Result<impl BufRead> {
    check(&fs::metadata(path)?, bytes_max)?;
    let file = File::open(path)?;
    // Another file may have taken the name since.
    check(&file.metadata()?, bytes_max)?;
    Ok(BufReader::new(file.take(bytes_max)))
}

fn check(found: &fs::Metadata, bytes_max: u64) -> io::Result<()> {
    if !found.is_file() {
        let kind = match found.is_dir() {
            true => ErrorKind::IsADirectory,
            false => ErrorKind::InvalidInput,
        };
        return Err(io::Error::new(kind, "must be a regular file"));
    }
    if found.len() > bytes_max {
        let message = format!("has {} bytes: must have at most {bytes_max}", found.len());
        return Err(io::Error::new(ErrorKind::FileTooLarge, message));
    }
    Ok(())
}

/// Reads a regular file.
///
/// # Errors
/// As [`open`].
pub fn read(path: &Path, bytes_max: u64) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    open(path, bytes_max)?.read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// Reads a regular file of text.
///
/// # Errors
/// As [`open`], and [`ErrorKind::InvalidData`] where the file is not UTF-8.
pub fn read_text(path: &Path, bytes_max: u64) -> io::Result<String> {
    let mut text = String::new();
    open(path, bytes_max)?.read_to_string(&mut text)?;
    Ok(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_file_is_refused_by_its_size() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("text");
        fs::write(&path, "abc").unwrap();
        assert_eq!(read_text(&path, 3).unwrap(), "abc");
        let refused = read(&path, 2).unwrap_err().to_string();
        assert_eq!(refused, "has 3 bytes: must have at most 2");
        assert!(read(folder.path(), 9).is_err());
    }

    #[cfg(unix)]
    #[test]
    fn a_device_and_a_pipe_are_refused_at_once() {
        let folder = tempfile::tempdir().unwrap();
        let device = folder.path().join("device");
        std::os::unix::fs::symlink("/dev/zero", &device).unwrap();
        let pipe = folder.path().join("pipe");
        let made = std::process::Command::new("mkfifo").arg(&pipe).status();
        assert!(made.unwrap().success());
        for path in [device, pipe] {
            let refused = read(&path, 9).unwrap_err().to_string();
            assert_eq!(refused, "must be a regular file", "{}", path.display());
        }
    }
}
