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
    let folder = match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    if path.is_dir() {
        return Err(io::Error::from(io::ErrorKind::IsADirectory));
    }
    let mut builder = tempfile::Builder::new();
    builder.prefix(".dacrt-");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // Temporary files are private by default; less what umask takes, these are not.
        builder.permissions(std::fs::Permissions::from_mode(0o666));
    }
    // tempfile adds the path of its temporary file to errors, which would only confuse.
    let plain = |e: io::Error| match e.raw_os_error().or_else(|| raw_cause(&e)) {
        Some(code) => io::Error::from_raw_os_error(code),
        None => e,
    };
    let mut file = builder.tempfile_in(folder).map_err(plain)?;
    fill(file.as_file_mut())?;
    file.persist(path).map_err(|e| plain(e.error))?;
    Ok(())
}

/// The operating system's code of an error that wraps another one.
fn raw_cause(error: &io::Error) -> Option<i32> {
    let mut cause: Option<&(dyn std::error::Error + 'static)> = error
        .get_ref()
        .map(|e| e as &(dyn std::error::Error + 'static));
    while let Some(e) = cause {
        if let Some(code) = e
            .downcast_ref::<io::Error>()
            .and_then(io::Error::raw_os_error)
        {
            return Some(code);
        }
        cause = e.source();
    }
    None
}
