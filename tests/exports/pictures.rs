//! `render` and `animate`: what they draw, and what they say where they cannot.

use super::desk::{ARMS, Desk, SCENE as FLAT, study};
use super::readers::{is_needed, python};
use super::{FRAMES, SCENE};

fn pixels(bytes: &[u8]) -> (usize, usize, Vec<u8>) {
    let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
    let mut buffer = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut buffer).unwrap();
    assert_eq!(info.color_type, png::ColorType::Rgb);
    (info.width as usize, info.height as usize, buffer)
}

#[test]
fn without_mitsuba_it_says_what_to_install() {
    let desk = Desk::with(&[("scene.toml", SCENE)]);
    desk.expect(0, "simulate scene.toml --out run --export none");
    for python in ["/nowhere/python3", "/bin/false"] {
        let printed = desk.expect(2, &format!("render run --out pictures --python {python}"));
        let words = format!("`{python} -m pip install mitsuba==3.9.1` installs it");
        assert!(printed.contains(&words) && printed.lines().count() == 1, "{printed}");
        assert!(!desk.path("pictures").exists());
    }
}

#[test]
fn snow_is_bright_on_a_dark_floor_and_the_same_for_the_same_seed() {
    let Some(python) = python() else {
        assert!(!is_needed(), "Mitsuba cannot be installed");
        println!("SKIPPED: Mitsuba cannot be installed");
        return;
    };
    let desk = Desk::with(&[("scene.toml", SCENE), ("flat.toml", FLAT)]);
    desk.expect(0, "simulate scene.toml --out run --export none");
    let draw = |out: &str, seed: u32| {
        let line = format!("render run --out {out} --frame 0 --seed {seed} --python {}", python.display());
        desk.expect(0, &line);
        std::fs::read(desk.path(&format!("{out}/run-00000.png"))).unwrap()
    };
    let [one, again, other] = [("one", 1), ("again", 1), ("other", 2)].map(|(out, seed)| draw(out, seed));
    assert!(one == again, "the same seed gives the same picture");
    assert!(one != other, "another seed gives other noise");
    let (width, height, pixels) = pixels(&one);
    assert_eq!((width, height), (480, 360));
    let mean = |columns: std::ops::Range<usize>, rows: std::ops::Range<usize>| {
        let all = rows.flat_map(|y| columns.clone().map(move |x| 3 * (y * width + x)));
        let (sum, count) = all.fold((0.0, 0.0), |(s, n), k| (s + f64::from(pixels[k + 1]), n + 1.0));
        sum / count
    };
    let floor = mean(0..width, height - 20..height);
    // The picture is framed so that the ball of the first frame is in it.
    let brightest = (0..12)
        .flat_map(|i| (0..9).map(move |j| (i, j)))
        .map(|(i, j)| mean(40 * i..40 * i + 40, 40 * j..40 * j + 40))
        .fold(0.0, f64::max);
    assert!(floor < 140.0 && brightest > 170.0, "floor {floor}, snow {brightest}");

    desk.expect(0, "simulate flat.toml --out flat --export none");
    let printed = desk.expect(2, &format!("render flat --out p --python {}", python.display()));
    assert!(printed.contains("need three dimensions"), "{printed}");
    let printed = desk.expect(2, &format!("render run --out p --frame 99 --python {}", python.display()));
    assert!(printed.contains(&format!("has {FRAMES} frames")), "{printed}");
}

#[test]
fn runs_are_drawn_side_by_side() {
    let picture = ARMS.replace("id = \"random\"", "id = \"random\"\npicture = \"both\"");
    let picture = picture.replace("id = \"lattice\"", "id = \"lattice\"\npicture = \"both\"");
    let desk =
        Desk::with(&[("study.toml", &study(&picture)), ("bare.toml", &study(ARMS)), ("scene.toml", SCENE)]);
    desk.expect(2, "animate study.toml -o both.gif");
    desk.expect(0, "run study.toml");
    let told = desk.expect(0, "animate study.toml -o both.gif --width 400");
    let decode = |name: &str| {
        let bytes = std::fs::read(desk.path(name)).unwrap();
        let mut decoder = gif::DecodeOptions::new().read_info(&bytes[..]).unwrap();
        let size = (decoder.width(), decoder.height());
        let mut frames = 0;
        while decoder.read_next_frame().unwrap().is_some() {
            frames += 1;
        }
        (size.0, frames)
    };
    let (width, frames) = decode("both.gif");
    assert_eq!(width, 400);
    assert!((3..=4).contains(&frames) && told.contains(&format!("{frames} frames")), "{told}");

    desk.expect(0, "simulate scene.toml --out run --export none");
    desk.expect(0, "animate run -o space.gif");
    assert_eq!(decode("space.gif"), (800, FRAMES));
    assert!(desk.expect(2, "animate bare.toml -o no.gif").contains("no arm has a `picture`"));
    assert!(desk.expect(2, "animate study.toml --arms none -o no.gif").contains("no arm `none`"));
    desk.write("points.csv", "x,y\n0,0\n");
    assert!(desk.expect(2, "animate points.csv -o no.gif").contains("give `--link`"));
}
