//! Result files that are either whole or absent: written under another name in
//! the same folder and renamed when complete.

use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use cell::invalid::Invalid;

/// A file on its way. Dropped without [`Draft::commit`], it leaves nothing.
pub struct Draft {
    target: PathBuf,
    draft: PathBuf,
    file: BufWriter<File>,
}

impl Draft {
    /// Starts `name` in `folder`.
    ///
    /// # Errors
    /// The folder cannot be written.
    pub fn create(folder: &Path, name: &str) -> Result<Self, Invalid> {
        let draft = folder.join(format!(".{name}.partial"));
        let file = File::create(&draft).map_err(|error| unwritable(folder, &error))?;
        Ok(Self {
            target: folder.join(name),
            draft,
            file: BufWriter::with_capacity(1 << 16, file),
        })
    }

    /// Gives the file its name.
    ///
    /// # Errors
    /// Whatever could not be written; then the draft is removed.
    pub fn commit(mut self) -> io::Result<()> {
        self.file.flush()?;
        fs::rename(&self.draft, &self.target)
    }
}

impl Write for Draft {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.file.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

impl Drop for Draft {
    fn drop(&mut self) {
        // After a commit the draft is gone already.
        let _ = fs::remove_file(&self.draft);
    }
}

/// Makes the output folder and its parents.
///
/// # Errors
/// It cannot be made.
pub fn prepare(folder: &Path) -> Result<(), Invalid> {
    fs::create_dir_all(folder).map_err(|error| unwritable(folder, &error))
}

/// Writes a whole file.
///
/// # Errors
/// The folder cannot be written.
pub fn write(folder: &Path, name: &str, text: &str) -> Result<(), Invalid> {
    let mut draft = Draft::create(folder, name)?;
    let written = draft
        .write_all(text.as_bytes())
        .and_then(|()| draft.commit());
    written.map_err(|error| unwritable(folder, &error))
}

fn unwritable(folder: &Path, error: &io::Error) -> Invalid {
    Invalid::new(
        "output folder",
        folder.display(),
        format_args!("a folder that can be written ({error})"),
    )
}
