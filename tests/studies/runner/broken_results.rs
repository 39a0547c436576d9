//! Results that cannot be read or written: one message, each cause once.

use super::{ARMS, Desk, study};

#[test]
fn each_cause_is_told_once() {
    let desk = Desk::with(&[("study.toml", &study(ARMS))]);
    desk.expect(0, "run study.toml --jobs 2");
    let frames = desk.files("results").into_keys().filter(|path| path.ends_with("frames.bin"));
    frames.for_each(|path| std::fs::remove_file(desk.path("results").join(path)).unwrap());
    let printed = desk.expect(2, "report study.toml");
    let told = "frames.bin: it is missing; `snowlab run --repair`";
    assert_eq!(printed.matches(told).count(), 1, "{printed}");

    desk.write("blocked", "a file where the folder of results should be");
    let printed = desk.expect(2, "run study.toml --out blocked/deep --jobs 1");
    let line =
        printed.lines().find(|line| line.starts_with("snowlab: blocked/deep/tiny/lock: ")).expect(&printed);
    assert!(line.contains("check space and permissions"), "{line}");
    assert_eq!(line.matches("os error").count(), 1, "{line}");
}
