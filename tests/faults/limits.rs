//! Disks and memory that are not enough.

use std::path::PathBuf;
use std::process::Command;

use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use crate::lab::{Lab, SKIPPED, said};
use crate::runners::ended_with;

/// A file system in memory where the results go, which is gone when this is dropped.
struct SmallDisk {
    path: PathBuf,
}

impl SmallDisk {
    fn mount(lab: &Lab, kilobytes: u64) -> Result<Self, String> {
        let path = lab.desk.path("results");
        if path.exists() {
            std::fs::remove_dir_all(&path).map_err(|error| error.to_string())?;
        }
        std::fs::create_dir_all(&path).map_err(|error| error.to_string())?;
        let disk = SmallDisk { path };
        match mount(&["-t", "tmpfs", "-o", &format!("size={kilobytes}k"), "tmpfs"], &disk.path) {
            Ok(()) => Ok(disk),
            Err(error) => {
                std::mem::forget(disk);
                Err(format!("{SKIPPED} no file system can be mounted: {error}"))
            }
        }
    }

    fn remount(&self, options: &str) -> Result<(), String> {
        mount(&["-o", &format!("remount,{options}")], &self.path)
    }
}

impl Drop for SmallDisk {
    fn drop(&mut self) {
        // The results stay where they are wanted, on the disk below.
        let _ = Command::new("umount").arg("-l").arg(&self.path).output();
    }
}

fn mount(arguments: &[&str], path: &PathBuf) -> Result<(), String> {
    let output =
        Command::new("mount").args(arguments).arg(path).output().map_err(|error| error.to_string())?;
    if output.status.success() { Ok(()) } else { Err(said(&output)) }
}

/// A disk that is full at some moment, and larger the next time.
pub fn disk_full(lab: &mut Lab, random: &mut ChaCha8Rng) -> Result<(), String> {
    let disk = SmallDisk::mount(lab, random.random_range(8..1200))?;
    let run = lab.command(crate::lab::RUN).output().map_err(|error| error.to_string())?;
    let told = said(&run);
    if run.status.code() == Some(0) || told.contains("panicked") {
        return Err(format!("on a full disk it ends with {:?}: {told}", run.status));
    }
    let has_said = told.contains("check space and permissions") && told.contains("No space left");
    if !has_said {
        // It was large enough: everything is on it.
        ended_with(3, &run)?;
        let plan = lab.command("plan study.toml --no-trials").output().map_err(|error| error.to_string())?;
        if !said(&plan).contains(": 5 finished, 0 to run") {
            return Err(format!("nobody said that the disk is full: {told}\n{}", said(&plan)));
        }
    }
    disk.remount("size=64m")?;
    finish_on(lab, disk)
}

/// A folder that cannot be written, and can the next time.
pub fn read_only(lab: &mut Lab, random: &mut ChaCha8Rng) -> Result<(), String> {
    let disk = SmallDisk::mount(lab, 65536)?;
    if random.random_range(0..2) == 0 {
        let words = format!("{} --stop-after 100ms", crate::lab::RUN);
        lab.command(&words).output().map_err(|error| error.to_string())?;
    }
    disk.remount("ro")?;
    let run = lab.command(crate::lab::RUN).output().map_err(|error| error.to_string())?;
    let told = said(&run);
    if ![Some(2), Some(3)].contains(&run.status.code()) || !told.contains("check space and permissions") {
        return Err(format!("where nothing can be written it ends with {:?}: {told}", run.status));
    }
    disk.remount("rw")?;
    finish_on(lab, disk)
}

/// Runs to the end on the disk, and takes the results off it to look at them.
fn finish_on(lab: &mut Lab, disk: SmallDisk) -> Result<(), String> {
    ended_with(3, &lab.command(crate::lab::RUN).output().map_err(|error| error.to_string())?)?;
    let saved = lab.desk.path("saved");
    let copied = Command::new("cp").arg("-a").arg(&disk.path).arg(&saved).output();
    copied.map_err(|error| error.to_string())?;
    let path = disk.path.clone();
    drop(disk);
    std::fs::remove_dir(&path)
        .and_then(|()| std::fs::rename(&saved, &path))
        .map_err(|error| error.to_string())?;
    lab.ended()
}

/// A limit to the program's memory: it refuses to begin, or dies of it; without the limit it goes on.
pub fn memory_short(lab: &mut Lab, random: &mut ChaCha8Rng) -> Result<(), String> {
    let kilobytes = random.random_range(15_000..160_000);
    let mut command = Command::new("sh");
    let line = format!("ulimit -v {kilobytes} && exec \"$0\" {}", crate::lab::RUN);
    command.args(["-c", &line, env!("CARGO_BIN_EXE_snowlab")]).current_dir(lab.desk.folder.path());
    let output = command.output().map_err(|error| error.to_string())?;
    let told = said(&output);
    match output.status.code() {
        Some(3) => lab.ended(),
        Some(2) if told.contains("are free") => lab.finish(),
        // Killed: the next run goes on.
        None => lab.finish(),
        // The system refused the program's own pages, or its threads.
        Some(127) if told.contains("loading shared libraries") => lab.finish(),
        Some(101) if told.contains("Resource temporarily unavailable") => lab.finish(),
        code => Err(format!("with {kilobytes} kB it ends with {code:?}: {told}")),
    }
}
