//! Files: texts that are read, and output that is complete or absent.

use std::fs;
use std::io::{BufWriter, Write};
use std::path::Path;

use jcas_core::Printable;
use jcas_episode::files::{self, TEXT_BYTES_MAX};

use crate::error::CliError;

/// Reads a text.
///
/// # Errors
/// The file cannot be read, is not regular, is too long, or is not UTF-8.
pub fn read_text(path: &Path) -> Result<String, CliError> {
    files::read_text(path, TEXT_BYTES_MAX).map_err(|error| match error.kind() {
        std::io::ErrorKind::InvalidData => CliError::file(path, "is not UTF-8 text"),
        _ => CliError::Io(path.to_owned(), error),
    })
}

/// Reads the bytes of a text.
///
/// # Errors
/// As [`read_text`].
pub fn read_bytes(path: &Path) -> Result<Vec<u8>, CliError> {
    files::read(path, TEXT_BYTES_MAX).map_err(CliError::io(path))
}

/// Writes a file under a temporary name in its folder and renames it. A reader, a crash or a full
/// disk therefore never leaves a partial file under the final name.
pub fn write_atomically<T>(
    path: &Path,
    write: impl FnOnce(&mut dyn Write) -> Result<T, CliError>,
) -> Result<T, CliError> {
    let folder = match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    let mut builder = tempfile::Builder::new();
    builder.prefix(".jcas-").suffix(".part");
    // A temporary file is private to the user by default; results are as open as the umask allows.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    let file = builder.tempfile_in(folder).map_err(CliError::io(path))?;
    let mut out = BufWriter::new(file);
    let result = write(&mut out)?;
    let file = out
        .into_inner()
        .map_err(|error| CliError::Io(path.to_owned(), error.into_error()))?;
    file.persist(path)
        .map_err(|error| CliError::Io(path.to_owned(), error.error))?;
    Ok(result)
}

/// Writes bytes as a complete file.
pub fn write_bytes(path: &Path, bytes: &[u8]) -> Result<(), CliError> {
    write_atomically(path, |out| out.write_all(bytes).map_err(CliError::io(path)))
}

/// Creates a folder with its parents, and checks before hours of work that it is writable.
pub fn prepare_folder(path: &Path) -> Result<(), CliError> {
    fs::create_dir_all(path).map_err(CliError::io(path))?;
    tempfile::tempfile_in(path).map_err(CliError::io(path))?;
    Ok(())
}

/// Prints lines to standard output. A closed pipe (`| head`) is no error. What could steer a
/// terminal is escaped, since names and fields of files are printed, too.
pub fn print(text: &str) -> Result<(), CliError> {
    print_raw(lines(text).as_bytes())
}

/// Prints bytes for another program to standard output.
pub fn print_raw(bytes: &[u8]) -> Result<(), CliError> {
    let mut out = std::io::stdout().lock();
    match out.write_all(bytes).and_then(|()| out.flush()) {
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => {
            Err(CliError::Io("standard output".into(), error))
        }
        _ => Ok(()),
    }
}

/// A text with each line as a terminal may show it.
pub fn lines(text: &str) -> String {
    let shown = text
        .split_inclusive('\n')
        .map(|line| match line.strip_suffix('\n') {
            Some(line) => format!("{}\n", Printable(line)),
            None => Printable(line).to_string(),
        });
    shown.collect()
}

/// A value as indented JSON, with the end of its last line.
pub fn json(value: &impl serde::Serialize) -> Result<String, CliError> {
    let text = serde_json::to_string_pretty(value).map_err(CliError::input)?;
    Ok(text + "\n")
}

/// Prints a value as indented JSON, with the escapes of JSON for what could steer a terminal.
pub fn print_json(value: &impl serde::Serialize) -> Result<(), CliError> {
    let mut text = String::new();
    for c in json(value)?.chars() {
        if c < '\u{7f}' || Printable(c).to_string().starts_with(c) {
            text.push(c);
        } else {
            let mut units = [0; 2];
            for unit in c.encode_utf16(&mut units) {
                text += &format!("\\u{unit:04x}");
            }
        }
    }
    print(&text)
}
