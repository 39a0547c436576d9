//! `frames.snowlab`: what is written is read, and what is broken is refused.

use std::path::Path;

use snowlab_study::export::{Snapshot, csv_text};
use snowlab_study::film::{FILM, Film, FilmWriter, Source};

use super::desk::{Desk, SCENE as FLAT};
use super::{FRAMES, SCENE};

/// Particles that are no round numbers, in both dimensions.
fn snapshot(dimension: usize) -> Snapshot {
    let flat = dimension == 2;
    let third = |value: f64| if flat { 0.0 } else { value };
    let matrix = |along: f64| {
        let full = [1.5, 0.25, third(0.125), -0.5, 0.75, third(2.0), third(3.0), third(-1.0), 1.25];
        if flat { [1.5, 0.25, 0.0, -0.5, 0.75, 0.0, 0.0, 0.0, along] } else { full }
    };
    let stress = |zz: f64| [4.0, 0.5, third(0.25), 0.5, -2.0, third(8.0), third(0.25), third(8.0), zz];
    Snapshot {
        dimension,
        time: 0.1,
        spacing: Some(0.02),
        ids: vec![7, 3],
        positions: vec![[100.5, 2.25, third(-3.0)], [101.0, 2.5, third(-3.5)]],
        velocities: Some(vec![[1.0, -2.0, third(0.5)]; 2]),
        masses: Some(vec![0.1, 0.3]),
        volumes: Some(vec![1e-3, 3e-3]),
        plastic_ratios: Some(vec![1.0, 0.875]),
        deformations: Some(vec![matrix(1.0); 2]),
        stresses: Some(vec![stress(0.625); 2]),
        fragments: None,
    }
}

fn written(path: &Path, frames: &[Snapshot]) {
    let mut film = FilmWriter::begin(path, &frames[0], "a scene").unwrap();
    frames.iter().for_each(|frame| film.add(frame).unwrap());
}

#[test]
fn what_is_written_is_read() {
    for dimension in [2, 3] {
        let desk = Desk::new();
        let path = desk.path(FILM);
        let first = snapshot(dimension);
        let mut second = Snapshot { time: 0.2, ..first.clone() };
        second.positions[0][1] = 7.75;
        written(&path, &[first.clone(), second.clone()]);
        let mut film = Film::open(&path).unwrap();
        assert_eq!((film.frames(), film.header().scene.as_str()), (2, "a scene"));
        // All its numbers are in single precision already.
        assert_eq!(film.snapshot(1).unwrap(), second);
        assert_eq!(film.snapshot(0).unwrap(), first, "frames are read in any order");
    }
}

/// Cut anywhere, it is read up to its last whole frame or refused; changed anywhere in its header, it is refused or read, and never a panic or a file's length of memory.
#[test]
fn a_broken_film_is_refused_or_read_as_far_as_it_goes() {
    let desk = Desk::new();
    let path = desk.path(FILM);
    let frame = snapshot(3);
    written(&path, &[frame.clone(), frame.clone(), frame]);
    let bytes = std::fs::read(&path).unwrap();
    let start = bytes.len() - 3 * (8 + 2 * 22 * 4);
    for length in 0..bytes.len() {
        std::fs::write(&path, &bytes[..length]).unwrap();
        match Film::open(&path) {
            Ok(film) => assert_eq!(film.frames(), (length - start) / (8 + 2 * 22 * 4)),
            Err(error) => {
                assert!(length < start, "{length}: {error}");
                assert!(error.to_string().contains(FILM), "{error}");
            }
        }
    }
    for byte in 0..start {
        for value in [0, b'9', b'"', 0xff] {
            let mut changed = bytes.clone();
            changed[byte] = value;
            std::fs::write(&path, &changed).unwrap();
            if let Ok(mut film) = Film::open(&path) {
                (0..film.frames()).for_each(|frame| drop(film.snapshot(frame).unwrap()));
            }
        }
    }
}

/// A film has what the CSV of the same run has, in single precision.
#[test]
fn a_film_of_a_run_is_its_csv_in_single_precision() {
    for scene in [SCENE, FLAT] {
        let desk = Desk::with(&[("scene.toml", scene)]);
        desk.expect(0, "simulate scene.toml --out run --export csv");
        let mut film = Source::open(&desk.path("run")).unwrap();
        assert_eq!(film.scene().unwrap().numerics.spacing, if scene == SCENE { 0.02 } else { 0.05 });
        for number in 0..film.frames() {
            let (found, expected) =
                (csv_text(&film.snapshot(number).unwrap()), desk.read(&format!("run/frame-{number:05}.csv")));
            assert_eq!(found.lines().next(), expected.lines().next());
            for (found, expected) in found.lines().zip(expected.lines()).skip(1) {
                for (a, b) in found.split(',').zip(expected.split(',')) {
                    let (a, b): (f64, f64) = (a.parse().unwrap(), b.parse().unwrap());
                    assert!((a - b).abs() <= 1e-7 * b.abs().max(1.0), "{a} and {b}");
                }
            }
            assert_eq!(found.lines().count(), expected.lines().count());
        }
    }
}

/// Frames of a study's case are converted; a second run in the same folder leaves nothing of the first.
#[test]
fn cases_are_converted_and_old_files_go() {
    let desk =
        Desk::with(&[("scene.toml", SCENE), ("study.toml", &super::desk::study("[[arm]]\nid = \"one\"\n"))]);
    desk.expect(0, "run study.toml");
    let cases = std::fs::read_dir(desk.path("results/tiny/cases")).unwrap();
    let key = cases.map(|case| case.unwrap().file_name().into_string().unwrap()).min().unwrap();
    desk.expect(0, &format!("convert results/tiny/cases/{key} --out vtk --export vtp,xyz --frame 1"));
    let made: Vec<_> = desk.files("vtk").into_keys().map(|name| name.display().to_string()).collect();
    assert_eq!(made, ["frame-00001.vtp", "frame-00001.xyz", "frames.pvd"]);

    desk.expect(0, "simulate scene.toml --out run --export ply,csv,vtp");
    desk.write("run/mine.txt", "kept");
    desk.expect(0, "simulate scene.toml --out run --export none");
    let left: Vec<_> = desk.files("run").into_keys().map(|name| name.display().to_string()).collect();
    assert_eq!(left, [FILM, "history.csv", "mine.txt"]);
    assert_eq!(Source::open(&desk.path("run")).unwrap().frames(), FRAMES);
}
