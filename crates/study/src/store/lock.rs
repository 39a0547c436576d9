//! Locks: a case is run by one runner at a time, and nothing is cleared away under a study in use. They are the system's own (flock): whoever
//! dies holds none. Where a file system has no locks, the first result wins and a second must be byte-equal.

use std::fs::{File, OpenOptions, TryLockError};
use std::io;
use std::path::Path;

use super::StoreError;

/// A lock, held until it is dropped.
#[derive(Debug)]
pub struct Lock {
    file: Option<File>,
}

/// How a lock is held.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Hold {
    /// Beside others that share it.
    Shared,
    /// Alone.
    Alone,
}

impl Lock {
    /// Takes the lock at `path`; `None` where somebody else has it.
    ///
    /// # Errors
    /// [`StoreError::Io`], where the file cannot be made.
    pub fn take(path: &Path, hold: Hold) -> Result<Option<Self>, StoreError> {
        let failed = |source| StoreError::Io { path: path.into(), source };
        if let Some(folder) = path.parent() {
            std::fs::create_dir_all(folder).map_err(failed)?;
        }
        // Read and write: where locks are those of ranges of bytes, as on NFS, a shared one takes the right to read and one alone that to write.
        let file = OpenOptions::new()
            .create(true)
            .truncate(false)
            .read(true)
            .write(true)
            .open(path)
            .map_err(failed)?;
        let taken = match hold {
            Hold::Shared => file.try_lock_shared(),
            Hold::Alone => file.try_lock(),
        };
        match taken {
            Ok(()) => Ok(Some(Lock { file: Some(file) })),
            Err(TryLockError::WouldBlock) => Ok(None),
            Err(TryLockError::Error(error)) if has_no_locks(&error) => Ok(Some(Lock { file: None })),
            Err(TryLockError::Error(error)) => Err(failed(error)),
        }
    }

    /// Whether it keeps others out: not where the file system has no locks.
    pub fn is_held_here(&self) -> bool {
        self.file.is_some()
    }

    /// Whether somebody holds the lock at `path` alone.
    pub fn is_held(path: &Path) -> bool {
        File::open(path).is_ok_and(|file| matches!(file.try_lock_shared(), Err(TryLockError::WouldBlock)))
    }
}

impl Drop for Lock {
    /// Closing is not enough: a program that is being started has a copy of all open files for a moment, and the copy would hold the lock.
    fn drop(&mut self) {
        if let Some(file) = &self.file {
            // Where this fails, closing is what is left.
            drop(file.unlock());
        }
    }
}

fn has_no_locks(error: &io::Error) -> bool {
    // chosen: ENOLCK of Linux, which has no kind of its own.
    const NO_LOCKS: i32 = 37;
    error.kind() == io::ErrorKind::Unsupported || error.raw_os_error() == Some(NO_LOCKS)
}

#[cfg(test)]
mod tests {
    use std::io::{Read, Seek, Write};

    use super::*;

    /// On NFS a shared lock of a file that is open for writing alone is refused (EBADF): here the right to read is looked at itself.
    #[test]
    fn a_lock_has_the_rights_that_network_file_systems_want() {
        let folder = tempfile::tempdir().expect("a folder for the test");
        for hold in [Hold::Shared, Hold::Alone] {
            let lock = Lock::take(&folder.path().join("lock"), hold).expect("the folder can be written");
            let lock = lock.expect("free");
            let mut file = lock.file.as_ref().expect("the system has locks");
            file.write_all(b"x").and_then(|()| file.rewind()).expect("it can be written");
            assert_eq!(file.read(&mut [0; 2]).expect("it can be read"), 1);
        }
    }

    #[test]
    fn one_holds_a_lock_alone_and_many_share_it() {
        let folder = tempfile::tempdir().expect("a folder for the test");
        let path = folder.path().join("deep/lock");
        let take = |hold| Lock::take(&path, hold).expect("the folder can be written");
        let alone = take(Hold::Alone).expect("free");
        assert!(take(Hold::Alone).is_none() && take(Hold::Shared).is_none() && Lock::is_held(&path));
        drop(alone);
        assert!(!Lock::is_held(&path));
        let shared = [take(Hold::Shared), take(Hold::Shared)];
        assert!(shared.iter().all(Option::is_some) && take(Hold::Alone).is_none());
    }
}
