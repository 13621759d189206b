//! Result files of a run: whole, of one run, and all there or none of them.
//!
//! A [`Folder`] belongs to one run at a time. Its files are written under names that
//! nobody else has and renamed together in the end, the judgement last.

use std::fs::{self, File, TryLockError};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use cell::invalid::Invalid;
use tempfile::{Builder, NamedTempFile, TempPath};

/// An output folder, and the files that are ready to appear in it. Dropped without
/// [`Folder::publish`], it leaves none of them.
pub struct Folder {
    path: PathBuf,
    ready: Vec<(TempPath, PathBuf)>,
    /// The folder itself, locked; none where the file system locks no folders.
    _lock: Option<File>,
}

impl Folder {
    /// Makes the folder and its parents and keeps other runs out of it.
    ///
    /// # Errors
    /// It cannot be made, or another run writes to it.
    pub fn claim(path: &Path) -> Result<Self, Invalid> {
        prepare(path)?;
        let lock = File::open(path).ok();
        if let Some(Err(TryLockError::WouldBlock)) = lock.as_ref().map(File::try_lock) {
            let allowed = "a folder that no other run is writing to";
            return Err(Invalid::new("output folder", path.display(), allowed));
        }
        Ok(Self {
            path: path.to_path_buf(),
            ready: Vec::new(),
            _lock: lock,
        })
    }

    /// Where it is.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Starts the file `name`; folders in it are made.
    ///
    /// # Errors
    /// The folder cannot be written.
    pub fn draft(&self, name: impl AsRef<Path>) -> Result<Draft, Invalid> {
        let target = self.path.join(name);
        let folder = target.parent().unwrap_or(&self.path);
        prepare(folder)?;
        let name = target.file_name().unwrap_or_default().display();
        let prefix = format!(".{name}.");
        let mut builder = Builder::new();
        builder.prefix(&prefix).suffix(".partial");
        // As of any other file: what the umask leaves of it.
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
        let file = builder.tempfile_in(folder);
        let file = file.map_err(|error| unwritable(folder, &error))?;
        Ok(Draft {
            file: BufWriter::with_capacity(1 << 16, file),
            target,
        })
    }

    /// Takes a draft that is complete.
    ///
    /// # Errors
    /// The disk.
    pub fn keep(&mut self, draft: Draft) -> Result<(), Invalid> {
        let file = draft.file.into_inner();
        let file = file.map_err(|error| unwritable(&self.path, error.error()))?;
        self.ready.push((file.into_temp_path(), draft.target));
        Ok(())
    }

    /// Takes a whole file.
    ///
    /// # Errors
    /// The folder cannot be written.
    pub fn add(&mut self, name: impl AsRef<Path>, text: &str) -> Result<(), Invalid> {
        let mut draft = self.draft(name)?;
        let written = draft.write_all(text.as_bytes());
        written.map_err(|error| unwritable(&self.path, &error))?;
        self.keep(draft)
    }

    /// Gives all files their names, in the order in which they came. The last one is the
    /// judgement: an old one goes first, so that it never stands beside files of this run.
    ///
    /// # Errors
    /// The disk, or a folder that stands where a file should.
    pub fn publish(self) -> Result<(), Invalid> {
        let named = || {
            if let Some((_, judgement)) = self.ready.last()
                && judgement.try_exists()?
            {
                fs::remove_file(judgement)?;
            }
            for (draft, target) in self.ready {
                draft.persist(target)?;
            }
            Ok(())
        };
        named().map_err(|error| unwritable(&self.path, &error))
    }
}

/// A file on its way.
pub struct Draft {
    file: BufWriter<NamedTempFile>,
    target: PathBuf,
}

impl Write for Draft {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.file.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

fn prepare(folder: &Path) -> Result<(), Invalid> {
    fs::create_dir_all(folder).map_err(|error| unwritable(folder, &error))
}

fn unwritable(folder: &Path, error: &io::Error) -> Invalid {
    Invalid::new(
        "output folder",
        folder.display(),
        format_args!("a folder that can be written ({error})"),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).expect("readable");
        let name = |entry: io::Result<fs::DirEntry>| entry.expect("an entry").file_name();
        let mut names: Vec<_> = entries
            .map(|entry| name(entry).to_string_lossy().into_owned())
            .collect();
        names.sort();
        names
    }

    #[test]
    fn files_appear_together_or_not_at_all() {
        let parent = tempfile::tempdir().expect("a temporary folder");
        let path = parent.path().join("out");
        let mut folder = Folder::claim(&path).expect("a folder");
        folder.add("figures/a.svg", "new").expect("a file");
        folder.add("summary.json", "new").expect("a file");
        assert!(!path.join("summary.json").exists());
        drop(folder);
        assert_eq!(names(&path), ["figures"]);
        assert!(names(&path.join("figures")).is_empty());

        let mut folder = Folder::claim(&path).expect("a folder");
        folder.add("figures/a.svg", "new").expect("a file");
        folder.add("summary.json", "new").expect("a file");
        folder.publish().expect("written");
        assert_eq!(names(&path), ["figures", "summary.json"]);
    }

    /// What cannot be completed does not keep the judgement of an older run.
    #[test]
    fn an_old_judgement_does_not_stand_beside_new_files() {
        let parent = tempfile::tempdir().expect("a temporary folder");
        fs::write(parent.path().join("summary.json"), "old").expect("a file");
        fs::create_dir_all(parent.path().join("trace.csv/in-the-way")).expect("a folder");
        let mut folder = Folder::claim(parent.path()).expect("a folder");
        folder.add("report.html", "new").expect("a file");
        folder.add("trace.csv", "new").expect("a file");
        folder.add("summary.json", "new").expect("a file");
        let error = folder.publish().expect_err("in the way").to_string();
        assert!(error.contains("output folder"), "{error}");
        assert_eq!(names(parent.path()), ["report.html", "trace.csv"]);
    }

    #[test]
    fn a_folder_belongs_to_one_run() {
        let parent = tempfile::tempdir().expect("a temporary folder");
        let first = Folder::claim(parent.path()).expect("a folder");
        let second = Folder::claim(parent.path()).err().expect("taken");
        assert!(second.to_string().contains("no other run"), "{second}");
        drop(first);
        assert!(Folder::claim(parent.path()).is_ok());
    }

    /// Links that lie where drafts might be, or where files will be, lead nowhere.
    #[cfg(unix)]
    #[test]
    fn links_are_not_followed() {
        use std::os::unix::fs::{MetadataExt, symlink};
        let parent = tempfile::tempdir().expect("a temporary folder");
        let victim = parent.path().join("victim");
        fs::write(&victim, "precious").expect("a file");
        let out = parent.path().join("out");
        fs::create_dir(&out).expect("a folder");
        for name in [".trace.csv.partial", "trace.csv", "summary.json"] {
            symlink(&victim, out.join(name)).expect("a link");
        }
        let mut folder = Folder::claim(&out).expect("a folder");
        folder.add("trace.csv", "new").expect("a file");
        folder.add("summary.json", "new").expect("a file");
        folder.publish().expect("written");
        assert_eq!(fs::read_to_string(&victim).expect("a file"), "precious");
        let trace = fs::symlink_metadata(out.join("trace.csv")).expect("a file");
        let plain = fs::metadata(&victim).expect("a file");
        assert!(trace.is_file() && trace.mode() == plain.mode());
    }
}
