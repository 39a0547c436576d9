//! Locks: a case is run by one runner at a time, and nothing is cleared away under a study in use. They are the system's own (flock): whoever
//! dies holds none. Where a file system has no locks, the first result wins and a second must be byte-equal.

use std::fs::{File, OpenOptions, TryLockError};
use std::io;
use std::path::Path;

use super::StoreError;

/// A lock, held until it is dropped.
#[derive(Debug)]
pub struct Lock {
    _file: Option<File>,
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
        let file = OpenOptions::new().create(true).truncate(false).write(true).open(path).map_err(failed)?;
        let taken = match hold {
            Hold::Shared => file.try_lock_shared(),
            Hold::Alone => file.try_lock(),
        };
        match taken {
            Ok(()) => Ok(Some(Lock { _file: Some(file) })),
            Err(TryLockError::WouldBlock) => Ok(None),
            Err(TryLockError::Error(error)) if has_no_locks(&error) => Ok(Some(Lock { _file: None })),
            Err(TryLockError::Error(error)) => Err(failed(error)),
        }
    }

    /// Whether somebody holds the lock at `path` alone.
    pub fn is_held(path: &Path) -> bool {
        File::open(path).is_ok_and(|file| matches!(file.try_lock_shared(), Err(TryLockError::WouldBlock)))
    }
}

fn has_no_locks(error: &io::Error) -> bool {
    // chosen: ENOLCK of Linux, which has no kind of its own.
    const NO_LOCKS: i32 = 37;
    error.kind() == io::ErrorKind::Unsupported || error.raw_os_error() == Some(NO_LOCKS)
}

#[cfg(test)]
mod tests {
    use super::*;

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
