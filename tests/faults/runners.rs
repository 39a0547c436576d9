//! Runners that are killed, stopped, doubled, or told another time.

use std::path::PathBuf;
use std::process::{Child, Command, Output};
use std::time::Duration;

use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use crate::lab::{Lab, RUN, SKIPPED, said};

/// Waits for a random part of an undisturbed run.
fn wait(lab: &Lab, random: &mut ChaCha8Rng) {
    std::thread::sleep(lab.undisturbed().mul_f64(random.random_range(0.0..1.0)));
}

/// SIGKILL at a random moment.
pub fn killed(lab: &mut Lab, random: &mut ChaCha8Rng) -> Result<(), String> {
    let mut run = lab.begin();
    wait(lab, random);
    run.kill().expect("it can be killed");
    let output = run.wait_with_output().expect("it has ended");
    match output.status.code() {
        None => Ok(()),
        // It was done before.
        Some(3) => lab.ended(),
        Some(code) => Err(format!("ended with {code} before it was killed: {}", said(&output))),
    }
}

/// SIGTERM at a random moment.
pub fn terminated(lab: &mut Lab, random: &mut ChaCha8Rng) -> Result<(), String> {
    stopped_by("TERM", lab, random)
}

/// SIGINT at a random moment.
pub fn interrupted(lab: &mut Lab, random: &mut ChaCha8Rng) -> Result<(), String> {
    stopped_by("INT", lab, random)
}

fn stopped_by(signal: &str, lab: &mut Lab, random: &mut ChaCha8Rng) -> Result<(), String> {
    let run = lab.begin();
    // Before it has asked for signals it dies of them, as any program.
    std::thread::sleep(Duration::from_millis(30));
    wait(lab, random);
    send(signal, &run);
    let output = run.wait_with_output().expect("it has ended");
    let said = said(&output);
    match output.status.code() {
        Some(4) if said.contains("the same command goes on") => Ok(()),
        Some(3) => lab.ended(),
        // On a busy machine it may not have come that far.
        None if !said.contains("to run") => Ok(()),
        code => Err(format!("SIG{signal} ends it with {code:?}: {said}")),
    }
}

fn send(signal: &str, to: &Child) {
    let sent = Command::new("kill").args([&format!("-{signal}"), &to.id().to_string()]).output();
    sent.expect("signals can be sent");
}

/// Two runners on one study; one is killed, the other has to do all.
pub fn one_of_two_killed(lab: &mut Lab, random: &mut ChaCha8Rng) -> Result<(), String> {
    let mut first = lab.begin();
    let second = lab.begin();
    wait(lab, random);
    first.kill().expect("it can be killed");
    first.wait().expect("it has ended");
    ended_with(3, &second.wait_with_output().expect("it has ended"))?;
    lab.ended()
}

/// A run that is told a time years away, killed, and gone on with at the right time.
pub fn with_another_clock(lab: &mut Lab, random: &mut ChaCha8Rng) -> Result<(), String> {
    let years = random.random_range(-30..30_i32);
    let library = faketime().ok_or(format!("{SKIPPED} `faketime` is not installed"))?;
    let mut command = lab.command(RUN);
    // Time that only grows does so whatever is done to the clock of the day.
    command
        .env("LD_PRELOAD", library)
        .env("FAKETIME", format!("{years:+}y"))
        .env("FAKETIME_DONT_FAKE_MONOTONIC", "1");
    let mut run = command.spawn().map_err(|error| error.to_string())?;
    wait(lab, random);
    run.kill().expect("it can be killed");
    run.wait().expect("it has ended");
    lab.finish()
}

/// The library that tells a program another time. Its command would stand between the program and the signals.
fn faketime() -> Option<PathBuf> {
    let folders = std::fs::read_dir("/usr/lib").ok()?.filter_map(|entry| Some(entry.ok()?.path()));
    let mut libraries = folders.map(|folder| folder.join("faketime/libfaketime.so.1"));
    libraries.find(|library| library.is_file())
}

/// Whether a command ended with the exit code it should.
pub fn ended_with(code: i32, output: &Output) -> Result<(), String> {
    match output.status.code() {
        Some(found) if found == code => Ok(()),
        found => Err(format!("ended with {found:?} instead of {code}: {}", said(output))),
    }
}
