//! Where and with what a measurement was made.

use std::process::Command;

#[derive(Clone, Debug)]
pub struct Machine {
    /// The CPU's model.
    pub cpu: String,
    pub cores: usize,
    /// The fast engine's, unless a row narrows it.
    pub instructions: &'static str,
    /// Processes that wanted to run, averaged over the minute before; on an idle machine 0.
    pub load: String,
    /// With a + where files differ from it.
    pub commit: String,
    pub rustc: String,
}

impl Machine {
    pub fn here() -> Self {
        let cpus = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
        let model = cpus.lines().find_map(|line| line.strip_prefix("model name")?.split_once(": "));
        let load = std::fs::read_to_string("/proc/loadavg").unwrap_or_default();
        let commit = output("git", &["rev-parse", "--short=10", "HEAD"]);
        let changed = Command::new("git").args(["diff", "--quiet", "HEAD", "--", "."]).status();
        let mark = if changed.is_ok_and(|status| status.success()) { "" } else { "+" };
        let rustc = std::env::var("RUSTC").unwrap_or_else(|_| "rustc".into());
        Machine {
            cpu: model.map_or("unknown".into(), |(_, model)| model.to_owned()),
            cores: std::thread::available_parallelism().map_or(1, |cores| cores.get()),
            instructions: instructions(),
            load: load.split(' ').next().filter(|load| !load.is_empty()).unwrap_or("unknown").to_owned(),
            commit: format!("{commit}{mark}"),
            rustc: output(&rustc, &["--version"]),
        }
    }
}

/// The first line that a command prints.
fn output(program: &str, arguments: &[&str]) -> String {
    let output = Command::new(program).args(arguments).output().ok().filter(|output| output.status.success());
    let text = output.and_then(|output| String::from_utf8(output.stdout).ok());
    text.as_deref().and_then(|text| text.lines().next()).unwrap_or("unknown").to_owned()
}

#[cfg(target_arch = "x86_64")]
fn instructions() -> &'static str {
    let wide = is_x86_feature_detected!("avx512f")
        && is_x86_feature_detected!("avx512dq")
        && is_x86_feature_detected!("avx512vl")
        && is_x86_feature_detected!("avx512bw");
    let narrowed = std::env::var_os("SNOWLAB_INSTRUCTIONS").is_some_and(|value| value == "avx2");
    match is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma") {
        true if wide && !narrowed => "avx512",
        true => "avx2",
        false => "none",
    }
}

#[cfg(not(target_arch = "x86_64"))]
fn instructions() -> &'static str {
    "none"
}
