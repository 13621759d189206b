//! Texts that people name: regular files, of a size that a person could have written.

use std::io::{self, Read};
use std::path::Path;

/// Most bytes of a text.
pub const MOST: u64 = 1 << 20;

/// Whether a person who wrote this meant a file, not a name.
#[must_use]
pub fn is_path(name: &str) -> bool {
    name.contains(std::path::MAIN_SEPARATOR) || Path::new(name).extension().is_some()
}

/// The text of a regular file. A pipe or a device is none: it may never end, or never
/// begin.
///
/// # Errors
/// It cannot be read, is no regular file, too long, or not UTF-8.
pub fn text(path: &Path) -> io::Result<String> {
    if !std::fs::metadata(path)?.is_file() {
        return Err(io::Error::other("not a regular file"));
    }
    text_of(std::fs::File::open(path)?)
}

/// The text that comes from `source` until its end.
///
/// # Errors
/// Those of the source; too long, or not UTF-8.
pub fn text_of(source: impl Read) -> io::Result<String> {
    let mut text = Vec::new();
    source.take(MOST + 1).read_to_end(&mut text)?;
    if text.len() as u64 > MOST {
        let why = format!("more than {} KiB", MOST >> 10);
        return Err(io::Error::other(why));
    }
    String::from_utf8(text).map_err(|_| io::Error::other("not UTF-8"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_does_not_end_is_no_text() {
        let error = text_of(io::repeat(b' ')).expect_err("endless");
        assert_eq!(error.to_string(), "more than 1024 KiB");
        let exact = vec![b' '; MOST as usize];
        assert_eq!(text_of(&*exact).expect("a text").len(), exact.len());
        assert!(text_of(&b"\xff"[..]).is_err());
    }

    #[cfg(unix)]
    #[test]
    fn devices_are_no_texts() {
        let error = text(Path::new("/dev/zero")).expect_err("a device");
        assert_eq!(error.to_string(), "not a regular file");
    }
}
