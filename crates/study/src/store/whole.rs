//! Files that are whole or not there, and that know when they have been changed.

use std::io::{self, BufWriter, Write};
use std::path::Path;

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::value::RawValue;

use super::StoreError;

/// Bytes of a BLAKE3 hash.
const HASH: usize = 32;

/// Writes a file beside its place, flushes it to the disk and moves it there: whoever looks sees the whole file or none.
///
/// # Errors
/// [`StoreError::Io`].
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<(), StoreError> {
    write_whole_with(path, |file| file.write_all(bytes))
}

/// As [`write_whole`], what `write` writes.
///
/// # Errors
/// [`StoreError::Io`].
pub fn write_whole_with(
    path: &Path,
    write: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<(), StoreError> {
    let written = std::fs::create_dir_all(folder_of(path)).and_then(|()| put_whole(path, write));
    written.map_err(|source| StoreError::Io { path: path.into(), source })
}

fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// As [`write_whole_with`], for files that are no results: their folder has to be there.
///
/// # Errors
/// The disk's.
pub fn put_whole(path: &Path, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
    let folder = folder_of(path);
    // Readable as any file the user makes: the umask takes from 0666 what it forbids.
    let mode = std::os::unix::fs::PermissionsExt::from_mode(0o666);
    let file = tempfile::Builder::new().prefix(TEMPORARY).permissions(mode).tempfile_in(folder)?;
    let mut writer = BufWriter::new(file);
    write(&mut writer)?;
    let file = writer.into_inner().map_err(io::IntoInnerError::into_error)?;
    file.as_file().sync_all()?;
    file.persist(path).map_err(|error| error.error)?;
    std::fs::File::open(folder)?.sync_all()
}

/// How the names of files begin that are not yet whole: what is left of them where a runner was killed may be deleted.
const TEMPORARY: &str = ".unfinished-";

/// Writes a file that follows from the case alone: where it is there already it must have the same bytes, and stays.
///
/// # Errors
/// [`StoreError::Differs`] where it has others; [`StoreError::Io`].
pub fn write_once(path: &Path, bytes: &[u8], is_sound: impl FnOnce(&[u8]) -> bool) -> Result<(), StoreError> {
    match read_whole(path)? {
        Some(found) if found == bytes => Ok(()),
        Some(found) if is_sound(&found) => {
            let second = path.with_extension("second");
            write_whole(&second, bytes)?;
            Err(StoreError::Differs { path: path.into(), second })
        }
        _ => write_whole(path, bytes),
    }
}

/// The bytes of a file; `None` where it is not there.
///
/// # Errors
/// [`StoreError::Io`].
pub fn read_whole(path: &Path) -> Result<Option<Vec<u8>>, StoreError> {
    match std::fs::read(path) {
        Ok(bytes) => Ok(Some(bytes)),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(None),
        Err(source) => Err(StoreError::Io { path: path.into(), source }),
    }
}

/// Deletes what writers have left in a folder who were killed: nobody else may be writing to it now.
///
/// # Errors
/// [`StoreError::Io`].
pub fn sweep(folder: &Path) -> Result<(), StoreError> {
    let failed = |source| StoreError::Io { path: folder.into(), source };
    for entry in std::fs::read_dir(folder).map_err(failed)? {
        let path = entry.map_err(failed)?.path();
        if is_temporary(&path) {
            remove(&path)?;
        }
    }
    Ok(())
}

/// Whether a file has the name of one that is not yet whole.
pub fn is_temporary(path: &Path) -> bool {
    path.file_name().is_some_and(|name| name.to_string_lossy().starts_with(TEMPORARY))
}

/// Deletes a file that may not be there.
///
/// # Errors
/// [`StoreError::Io`].
pub fn remove(path: &Path) -> Result<(), StoreError> {
    match std::fs::remove_file(path) {
        Err(source) if source.kind() != io::ErrorKind::NotFound => {
            Err(StoreError::Io { path: path.into(), source })
        }
        _ => Ok(()),
    }
}

/// JSON with a hash of its content beside it.
#[derive(Deserialize)]
struct Sealed<'a> {
    blake3: &'a str,
    #[serde(borrow)]
    content: &'a RawValue,
}

/// The hash of what belongs to `owner`: the same content under another name has another one.
fn hash_for(owner: &str, content: &[u8]) -> blake3::Hash {
    blake3::Hasher::new().update(owner.as_bytes()).update(b"\n").update(content).finalize()
}

/// A value of the case `owner` as JSON under seal: `{"blake3": hash of the owner, a line's end and the content's text, "content": ...}`.
pub fn seal(owner: &str, value: &impl Serialize) -> Vec<u8> {
    let content = serde_json::to_string_pretty(value).expect("results are plain data");
    let hash = hash_for(owner, content.as_bytes()).to_hex();
    format!("{{\n\"blake3\": \"{hash}\",\n\"content\": {content}\n}}\n").into_bytes()
}

/// The value under a seal.
///
/// # Errors
/// In which way the bytes are not what was written.
pub fn unseal<V: DeserializeOwned>(owner: &str, bytes: &[u8]) -> Result<V, String> {
    let sealed: Sealed =
        serde_json::from_slice(bytes).map_err(|error| format!("it is cut short or changed ({error})"))?;
    let content = sealed.content.get();
    if hash_for(owner, content.as_bytes()).to_hex().as_str() != sealed.blake3 {
        return Err(OTHER_HASH.into());
    }
    serde_json::from_str(content).map_err(|error| format!("it is of another version ({error})"))
}

/// Passes on what is written and hashes it.
pub struct Hashing<'a> {
    to: &'a mut dyn Write,
    hasher: blake3::Hasher,
    failure: Option<io::Error>,
}

const OTHER_HASH: &str = "its checksum does not fit its content and its case";

/// `content` of the case `owner`, with its hash behind it.
pub fn sign(owner: &str, mut content: Vec<u8>) -> Vec<u8> {
    let hash = hash_for(owner, &content);
    content.extend(hash.as_bytes());
    content
}

impl<'a> Hashing<'a> {
    /// Nothing is written yet of what belongs to the case `owner`.
    pub fn new(owner: &str, to: &'a mut dyn Write) -> Self {
        let mut hasher = blake3::Hasher::new();
        hasher.update(owner.as_bytes()).update(b"\n");
        Hashing { to, hasher, failure: None }
    }

    /// Why the disk last said no, where whoever writes does not pass that on.
    pub fn failure(self) -> Option<io::Error> {
        self.failure
    }

    /// Writes the hash of all before.
    ///
    /// # Errors
    /// The disk's.
    pub fn finish(self) -> io::Result<()> {
        self.to.write_all(self.hasher.finalize().as_bytes())
    }
}

impl Write for Hashing<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match self.to.write(bytes) {
            Ok(written) => {
                self.hasher.update(&bytes[..written]);
                Ok(written)
            }
            Err(error) => {
                self.failure = error.raw_os_error().map(io::Error::from_raw_os_error);
                Err(error)
            }
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        self.to.flush()
    }
}

/// The content of a file that ends with its hash, as [`sign`] and [`Hashing`] write it for the case `owner`.
///
/// # Errors
/// A file that is cut short, changed, or of another case.
pub fn verify<'a>(owner: &str, bytes: &'a [u8]) -> Result<&'a [u8], String> {
    let body = bytes.len().checked_sub(HASH).ok_or("it is cut short")?;
    let (body, hash) = bytes.split_at(body);
    if hash_for(owner, body).as_bytes() != hash {
        return Err(OTHER_HASH.into());
    }
    Ok(body)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_seal_notices_every_cut_and_every_changed_bit_of_the_content() {
        let value = vec![1.5, -2.0e-9];
        let bytes = seal("a", &value);
        assert!(unseal::<Vec<f64>>("b", &bytes).is_err(), "of another case");
        assert_eq!(unseal::<Vec<f64>>("a", &bytes), Ok(value.clone()));
        // The last two bytes close the line and the file.
        for length in 0..bytes.len() - 2 {
            assert!(unseal::<Vec<f64>>("a", &bytes[..length]).is_err(), "cut to {length}");
        }
        for bit in 0..8 * bytes.len() {
            let mut changed = bytes.clone();
            changed[bit / 8] ^= 1 << (bit % 8);
            // White space between the parts means nothing: what is accepted is what was written.
            assert!(
                unseal::<Vec<f64>>("a", &changed).is_ok_and(|v| v == value)
                    || unseal::<Vec<f64>>("a", &changed).is_err()
            );
        }
    }

    #[test]
    fn a_second_result_must_be_the_first() {
        let folder = tempfile::tempdir().expect("a folder for the test");
        let path = folder.path().join("run.json");
        write_once(&path, b"one", |_| true).expect("the first");
        write_once(&path, b"one", |_| true).expect("the same");
        let error = write_once(&path, b"two", |_| true).expect_err("another").to_string();
        assert!(error.contains("other bytes"), "{error}");
        assert_eq!(read_whole(&path).expect("readable"), Some(b"one".to_vec()), "the first stays");
        write_once(&path, b"two", |_| false).expect("what is damaged is written anew");
        assert_eq!(read_whole(&path).expect("readable"), Some(b"two".to_vec()));
    }
}
