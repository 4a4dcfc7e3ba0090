//! Files that are there whole or not at all.

use std::fs::File;
use std::io;
use std::path::Path;

/// Fills a temporary file beside `path` and renames it to `path`, so that no reader ever sees half
/// of it, and an old file stays if something fails.
///
/// # Errors
/// If the folder does not exist or may not be written to, `path` is a folder, or `fill` fails.
pub fn write(path: &Path, fill: impl FnOnce(&mut File) -> io::Result<()>) -> io::Result<()> {
    // A link keeps being one: what it points to is replaced.
    let path = &path.canonicalize().unwrap_or_else(|_| path.to_owned());
    // Never replace a device such as /dev/null.
    if path.metadata().is_ok_and(|m| !m.is_file() && !m.is_dir()) {
        return fill(&mut File::options().write(true).open(path)?);
    }
    let folder = folder_of(path);
    if path.is_dir() {
        return Err(io::Error::from(io::ErrorKind::IsADirectory));
    }
    let (prefix, suffix) = temporary(path);
    let mut builder = tempfile::Builder::new();
    builder.prefix(&prefix).suffix(suffix);
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // Temporary files are private by default; less what umask takes, these are not.
        builder.permissions(std::fs::Permissions::from_mode(0o666));
    }
    let mut file = builder.tempfile_in(folder).map_err(without_path)?;
    fill(file.as_file_mut())?;
    // Else a power cut soon after the renaming may leave an empty file under the name.
    file.as_file().sync_all()?;
    file.persist(path).map_err(|e| e.error)?;
    Ok(())
}

/// Removes temporary files that killed writers of `path` left beside it. A writer that is still at
/// work then fails, and the file stays as it is.
pub fn remove_leftovers(path: &Path) {
    let path = &path.canonicalize().unwrap_or_else(|_| path.to_owned());
    let (prefix, suffix) = temporary(path);
    for entry in folder_of(path).read_dir().into_iter().flatten().flatten() {
        let name = entry.file_name();
        let name = name.to_string_lossy();
        if name.starts_with(&prefix) && name.ends_with(suffix) {
            // What cannot be removed does no harm.
            let _ = std::fs::remove_file(entry.path());
        }
    }
}

/// How the names of temporary files for `path` begin and end.
fn temporary(path: &Path) -> (String, &'static str) {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    (format!(".{name}."), ".partial")
}

fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}

/// tempfile adds the path of its temporary file to errors, which would only confuse.
fn without_path(error: io::Error) -> io::Error {
    match error.to_string().split_once(" at path ") {
        Some((plain, _)) => io::Error::new(error.kind(), plain),
        None => error,
    }
}
