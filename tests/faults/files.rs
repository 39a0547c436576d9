//! Files that are changed on the disk.

use std::path::{Path, PathBuf};

use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use crate::lab::{Lab, said};
use crate::runners::ended_with;

/// Files whose content counts: under seal or with a checksum.
fn counts(path: &Path) -> bool {
    let name = path.file_name().and_then(|name| name.to_str()).unwrap_or_default();
    ["run.json", "frames.bin", "case.json", "manifest.json"].contains(&name)
        && path.to_string_lossy().contains("/cases/")
        || name.starts_with("metrics-")
}

/// A bit of a file of finished cases.
pub fn bit_flipped(lab: &mut Lab, random: &mut ChaCha8Rng) -> Result<(), String> {
    damaged(lab, random, |bytes, random| flip(bytes, random))
}

/// A file of finished cases.
pub fn cut_short(lab: &mut Lab, random: &mut ChaCha8Rng) -> Result<(), String> {
    damaged(lab, random, cut)
}

/// A bit of a checkpoint.
pub fn checkpoint_bit_flipped(lab: &mut Lab, random: &mut ChaCha8Rng) -> Result<(), String> {
    damaged_checkpoint(lab, random, |bytes, random| flip(bytes, random))
}

/// A checkpoint.
pub fn checkpoint_cut_short(lab: &mut Lab, random: &mut ChaCha8Rng) -> Result<(), String> {
    damaged_checkpoint(lab, random, cut)
}

type Damage = fn(&mut Vec<u8>, &mut ChaCha8Rng);

fn flip(bytes: &mut [u8], random: &mut ChaCha8Rng) {
    let place = random.random_range(0..bytes.len());
    bytes[place] ^= 1 << random.random_range(0..8);
}

fn cut(bytes: &mut Vec<u8>, random: &mut ChaCha8Rng) {
    // The line's end after a seal is not missed.
    bytes.truncate(random.random_range(0..bytes.len() - 1));
}

/// Damages a file of a study that is finished: `status` names it, `run --repair` makes it anew.
fn damaged(lab: &mut Lab, random: &mut ChaCha8Rng, damage: Damage) -> Result<(), String> {
    ended_with(3, &lab.command("run study.toml --jobs 2").output().map_err(|error| error.to_string())?)?;
    let files: Vec<PathBuf> = lab.results().into_iter().filter(|path| counts(path)).collect();
    let path = &files[random.random_range(0..files.len())];
    let mut bytes = std::fs::read(path).map_err(|error| error.to_string())?;
    damage(&mut bytes, random);
    std::fs::write(path, bytes).map_err(|error| error.to_string())?;
    // White space beside the content of a seal means nothing, and one that is changed is none the worse.
    if !is_sound(path) {
        told_damaged(lab, path)?;
    }
    lab.finish_by("run study.toml --jobs 2 --repair")
}

/// Whether `status` names the one file that is damaged, and the remedy.
fn told_damaged(lab: &Lab, path: &Path) -> Result<(), String> {
    let status = lab.command("status study.toml").output().map_err(|error| error.to_string())?;
    let said = said(&status);
    let name = path.file_name().and_then(|name| name.to_str()).unwrap_or_default();
    let is_told = said.contains("1 damaged") && said.contains(name) && said.contains("--repair");
    if is_told { Ok(()) } else { Err(format!("`status` does not tell that {name} is damaged: {said}")) }
}

/// Whether a file's content can still be had as it was.
fn is_sound(path: &Path) -> bool {
    let bytes = std::fs::read(path).unwrap_or_default();
    let case = path.parent().and_then(Path::file_name).and_then(|name| name.to_str()).unwrap_or_default();
    snowlab_study::store::unseal::<serde_json::Value>(case, &bytes).is_ok()
}

/// Damages the checkpoint of a case that was put away: the case begins anew, and says so.
fn damaged_checkpoint(lab: &mut Lab, random: &mut ChaCha8Rng, damage: Damage) -> Result<(), String> {
    let time = lab.undisturbed().mul_f64(random.random_range(0.2..0.7));
    let words = format!("run study.toml --jobs 2 --checkpoint-every 0s --stop-after {}ms", time.as_millis());
    let run = lab.command(&words).output().map_err(|error| error.to_string())?;
    if run.status.code() == Some(3) {
        return lab.ended();
    }
    ended_with(4, &run)?;
    let checkpoints: Vec<PathBuf> =
        lab.results().into_iter().filter(|path| path.ends_with("checkpoint.bin")).collect();
    let Some(path) = checkpoints.first() else { return lab.finish() };
    let mut bytes = std::fs::read(path).map_err(|error| error.to_string())?;
    damage(&mut bytes, random);
    std::fs::write(path, bytes).map_err(|error| error.to_string())?;
    let log = path.with_file_name("log.txt");
    ended_with(3, &lab.command("run study.toml --jobs 2").output().map_err(|error| error.to_string())?)?;
    let log = std::fs::read_to_string(log).map_err(|error| error.to_string())?;
    if !log.contains("begins anew, the checkpoint cannot be used") {
        return Err(format!("the log does not tell of the damaged checkpoint: {log}"));
    }
    lab.ended()
}

/// A whole file of one case in the place of another's: it has its checksum, but not this case's.
pub fn exchanged(lab: &mut Lab, random: &mut ChaCha8Rng) -> Result<(), String> {
    ended_with(3, &lab.command("run study.toml --jobs 2").output().map_err(|error| error.to_string())?)?;
    let names = ["run.json", "frames.bin", "case.json", "manifest.json"];
    let name = names[random.random_range(0..names.len())];
    let files: Vec<PathBuf> =
        lab.results().into_iter().filter(|path| path.ends_with(name) && counts(path)).collect();
    let first = random.random_range(0..files.len());
    let second = (first + 1) % files.len();
    std::fs::copy(&files[first], &files[second]).map_err(|error| error.to_string())?;
    told_damaged(lab, &files[second])?;
    lab.finish_by("run study.toml --jobs 2 --repair")
}
