//! Where the watchdog goes back in time, nothing of what it discards is kept.

use std::path::Path;

use snowlab_solver::{Real, Simulation};
use snowlab_study::record::Outcome;
use snowlab_study::run::{Observer, Run, run_scene};
use snowlab_study::spec;

/// An elastic ball on its way into a floor, with a C_wave above what it stands (docs/stability.md: 1.06 at random).
fn scene(numerics: &str, interval: f64, end_from: &str) -> String {
    format!(
        r#"
[numerics]
spacing = 0.005
{numerics}
[[body]]
region = {{ kind = "ball", centre = [0.0, 0.0525], radius = 0.05 }}
placement = {{ kind = "random", count = 1200 }}
material = {{ kind = "elastic" }}
velocity = [0.0, -0.1]
[[collider]]
shape = {{ kind = "half-space", point = [0.0, 0.0], normal = [0.0, 1.0] }}
[output]
frame_interval = {interval}
end = 0.06
end_from = "{end_from}"
"#
    )
}

/// What happened, in the order it did.
#[derive(Default)]
struct Diary {
    /// Time after each step [s].
    now: f64,
    /// Times of frames [s].
    frames: Vec<f64>,
    /// How often time went back.
    returns: usize,
}

impl Diary {
    fn look(&mut self, time: f64) {
        if time < self.now {
            self.returns += 1;
            let kept = self.frames.last().copied().unwrap_or(0.0);
            assert!(kept <= time, "back to {time} s, beyond the frame kept at {kept} s");
        }
        self.now = time;
    }
}

/// Hears of steps only by the share of a run, so it takes the times from frames and the end from the test.
struct Witness {
    end: f64,
    diary: Diary,
}

impl Observer for Witness {
    fn progress(&mut self, share: f64, _steps: u64) {
        self.diary.look(share * self.end * (1.0 + 1e-12));
    }

    fn frame<T: Real, const D: usize>(&mut self, simulation: &Simulation<T, D>) {
        self.diary.frames.push(simulation.state().time);
    }
}

fn run(text: &str) -> (Run<2>, Diary) {
    let mut witness = Witness { end: 0.06, diary: Diary::default() };
    let run = run_scene::<2>(&spec::parse(text).unwrap(), Path::new("."), 1, &mut witness).unwrap();
    (run, witness.diary)
}

fn times(run: &Run<2>) -> Vec<f64> {
    run.frames.frames.iter().map(|frame| frame.time).collect()
}

/// Frames, history and the observer's frames are the same, in the order of time, and energy falls in them.
fn check_kept(run: &Run<2>, diary: &Diary) {
    let times = times(run);
    assert!(times.is_sorted_by(|a, b| a < b), "{times:?}");
    assert_eq!(times, diary.frames, "what an observer saw is what is kept");
    let rows = &run.record.history;
    assert_eq!(times, rows.iter().map(|row| row.time).collect::<Vec<_>>());
    assert!(rows.is_sorted_by(|a, b| a.steps < b.steps));
    for row in rows {
        let (now, start) = (row.kinetic + row.elastic, rows[0].kinetic);
        assert!(now < 1.02 * start, "{now} J of {start} J at {} s", row.time);
    }
}

#[test]
fn no_frame_of_a_discarded_state_is_kept() {
    for interval in [0.005, 0.03] {
        let (run, diary) = run(&scene("wave_courant = 1.35", interval, "start"));
        assert_eq!(run.record.outcome, Outcome::Ok);
        assert!(diary.returns > 0 && run.record.watchdog_restores > 0, "the watchdog must have gone back");
        check_kept(&run, &diary);
        assert_eq!(times(&run).len(), (0.06 / interval).round() as usize + 1);
        assert_eq!(run.record.end_time, 0.06);
    }
}

/// A contact in the discarded stretch is discarded with it: frames and end count from the one that counts.
#[test]
fn the_clock_forgets_a_discarded_contact() {
    let text = scene("wave_courant = 1.35", 0.03, "contact");
    let (run, _) = run(&text);
    assert!(run.record.watchdog_restores > 0);
    let contact = run.record.contact_time.unwrap();
    assert_eq!(times(&run), [0.0, contact + 0.03, contact + 0.06]);
    assert_eq!(run.record.end_time, contact + 0.06);
}

#[test]
fn a_run_that_stops_ends_in_its_last_state_kept_once() {
    // Refused at a frame, at a check on schedule, at the end, and for too many steps: on a frame, and between two.
    for (numerics, interval, reason) in [
        ("fixed_step = 3.1e-4", 0.0031, "energy-rise"),
        ("fixed_step = 3.1e-4", 0.05, "energy-rise"),
        ("fixed_step = 3.1e-4\nmax_steps = 4", 0.0031, "too-many-steps"),
        ("max_steps = 10", 0.05, "too-many-steps"),
    ] {
        let (run, diary) = run(&scene(numerics, interval, "start"));
        match &run.record.outcome {
            Outcome::Stopped { reason: found, .. } => assert_eq!(found, reason, "{numerics}"),
            other => panic!("{numerics}: {other:?}"),
        }
        check_kept(&run, &diary);
        assert_eq!(times(&run).last(), Some(&run.record.end_time), "{numerics}");
    }
}
