//! A ball of each arm through time: the same instants for all, at one scale, for a slider to go through.

use rayon::prelude::*;

use crate::figure::moment::{View, moment};
use crate::frames::{Frame, Frames};
use crate::measure::{Ruler, SeriesRow};
use crate::report::{ReportMotion, ReportPicture, ReportStrip};
use crate::results::CaseResult;
use crate::spec::scene::TimeUnit;
use crate::tables::{groups, usable};
use crate::view::{Instant, Seen, Viewpoint};

use super::Findings;
use super::page::name;

/// Arms shown at most (chosen: three rows of four on a wide screen, and a page of about 3 MB).
const MOST_ARMS: usize = 12;
/// Instants at most (chosen: one each R/v where a run ends 20 R/v after contact, beside the ball before).
const MOST_STEPS: usize = 22;
/// Width of a picture [pixels] (chosen: sharp on a phone, where it is shown 330 px wide, and small on disk).
const WIDTH: u32 = 440;
/// Least width of what is seen over the spacing of the particles (chosen: a lone particle is a dot).
const NARROWEST: f64 = 20.0;
/// Colours of a picture (chosen: those of fragments and dust, each with three lighter ones at its edges).
const COLOURS: usize = 32;

/// The case that shows an arm.
struct Film<'a> {
    name: String,
    case: &'a CaseResult,
    /// What there is of each frame.
    series: &'a [SeriesRow],
}

/// The first usable case of each arm through time.
///
/// # Errors
/// Frames that cannot be read.
pub(super) fn motion(findings: Findings) -> anyhow::Result<ReportMotion> {
    let all: Vec<Film> =
        groups(findings.results).into_iter().filter_map(|group| Film::of(findings, &group)).collect();
    let floor = &findings.archive.study.spec.noise_floor;
    let (unbroken, others): (Vec<Film>, Vec<Film>) =
        all.into_iter().partition(|film| floor.contains(&film.case.case.arm));
    // What cannot break bounces out of a picture that shows the others well.
    let (all, left_out) = if others.is_empty() { (unbroken, 0) } else { (others, unbroken.len()) };
    let films = &all[..all.len().min(MOST_ARMS)];
    let Some(densest) = films.iter().rev().max_by_key(|film| film.series.len()) else {
        return Ok(ReportMotion { note: NOTHING.into(), ..ReportMotion::default() });
    };
    let frames = evenly(densest.series.len());
    let times: Vec<f64> = frames.iter().map(|&frame| densest.time(frame)).collect();
    let chosen: Vec<Vec<usize>> = films.iter().map(|film| film.nearest(&times)).collect();
    let viewpoint = films[0].viewpoint(findings)?;
    let seen: Vec<Vec<Seen>> = films
        .par_iter()
        .zip(&chosen)
        .map(|(film, chosen)| film.seen(findings, chosen, viewpoint.as_ref()))
        .collect::<anyhow::Result<_>>()?;
    let boxes: Vec<_> = seen.iter().flatten().filter_map(|seen| seen.bounds).collect();
    let obstacles: Vec<_> = seen.iter().flatten().flat_map(|seen| seen.obstacles.clone()).collect();
    let least = NARROWEST * films.iter().map(Film::spacing).fold(0.0, f64::max);
    let Some(view) = View::of(&boxes, &obstacles, least) else {
        return Ok(ReportMotion { note: NOTHING.into(), ..ReportMotion::default() });
    };
    let strips = films
        .par_iter()
        .zip(&chosen)
        .zip(&seen)
        .map(|((film, chosen), seen)| film.strip(chosen, seen, &view))
        .collect::<anyhow::Result<_>>()?;
    let steps = frames.iter().map(|&frame| densest.when(frame)).collect();
    Ok(ReportMotion { note: note(films, all.len(), left_out), steps, strips })
}

/// What is said where no case can be shown.
const NOTHING: &str = "No case can be shown: none ended well and passed the gate.";

/// What the pictures show, and what they leave out.
fn note(films: &[Film], all: usize, left_out: usize) -> String {
    let mut note = String::from(
        "One ball of each arm, that of its first usable block, at one scale and at the same instants; where a run ended earlier, its last frame stays. Every particle has the colour of its fragment at that instant, \
         from the heaviest: blue, orange, green, red, light blue, pink, black, and again from the first; dust is grey. Times count from contact, where there is any.",
    );
    if films.iter().any(|film| film.case.case.scene.dimension == 3) {
        note +=
            " Balls in space are seen from before the walls, the nearest particles in front and brightest.";
    }
    if all > films.len() {
        note += &format!(" The first {} of {all} arms are shown.", films.len());
    }
    if left_out > 0 {
        note += &format!(" Left out: {left_out} arms of the noise floor, which nothing breaks.");
    }
    note
}

/// At most [`MOST_STEPS`] of `count` frames, the first and the last among them, evenly.
fn evenly(count: usize) -> Vec<usize> {
    let steps = count.min(MOST_STEPS);
    let last = steps.saturating_sub(1).max(1);
    (0..steps).map(|step| (step * (count - 1) + last / 2) / last).collect()
}

impl<'a> Film<'a> {
    /// The first usable case of an arm.
    fn of(findings: Findings, group: &[&'a CaseResult]) -> Option<Self> {
        let case = group.iter().copied().find(|result| usable(result))?;
        let series = &case.metrics.as_ref()?.series;
        (!series.is_empty()).then(|| Film { name: name(findings, case), case, series })
    }

    /// Time of a frame since contact, or since the start without one, in the unit of the output.
    fn time(&self, frame: usize) -> f64 {
        let from = self.case.record.contact_time.unwrap_or(0.0);
        (self.series[frame].time - from) / self.case.record.time_unit
    }

    /// Unit of the output's times, and digits after the point that tell frames apart.
    fn unit(&self) -> (&'static str, usize) {
        match self.case.case.scene.output.time_unit {
            TimeUnit::Crossing => ("R/v", 1),
            TimeUnit::Second => ("s", 3),
        }
    }

    /// The time of a frame in words.
    fn when(&self, frame: usize) -> String {
        let ((unit, digits), time) = (self.unit(), self.time(frame));
        let (of, side) = match self.case.record.contact_time {
            None => (time, "after the start"),
            Some(_) if time < 0.0 => (-time, "before contact"),
            Some(_) => (time, "after contact"),
        };
        format!("{of:.digits$} {unit} {side}")
    }

    /// The time of a frame in signs.
    fn clock(&self, frame: usize) -> String {
        let ((unit, digits), time) = (self.unit(), self.time(frame));
        format!("t = {time:.digits$} {unit}").replace('-', "\u{2212}")
    }

    /// Mean spacing of the particles at rest [m].
    fn spacing(&self) -> f64 {
        let made = &self.case.record.made;
        let volume = made.filled_volume / made.particles.max(1) as f64;
        libm::pow(volume, 1.0 / self.case.case.scene.dimension as f64)
    }

    /// For each time the frame that is nearest to it; for the first time the first one.
    fn nearest(&self, times: &[f64]) -> Vec<usize> {
        let nearest = |time: f64| {
            let distance = |frame: &usize| (self.time(*frame) - time).abs();
            (0..self.series.len()).min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(0)
        };
        let first = (!times.is_empty()).then_some(0);
        first.into_iter().chain(times.iter().skip(1).map(|time| nearest(*time))).collect()
    }

    /// The pictures of what is seen of the chosen frames, each once.
    fn strip(&self, chosen: &[usize], seen: &[Seen], view: &View) -> anyhow::Result<ReportStrip> {
        let frames = distinct(chosen);
        let mut pictures = Vec::new();
        for (&frame, seen) in frames.iter().zip(seen) {
            let drawing = moment(&seen.moment(), view, WIDTH)?;
            pictures.push(ReportPicture {
                png: drawing.paint().indexed_png(COLOURS),
                caption: format!("{}, {}", self.clock(frame), seen.words()),
                alternative: format!("{}, {}: {} of the mass.", self.name, self.when(frame), seen.words()),
            });
        }
        let place = |frame: &usize| frames.binary_search(frame).expect("each chosen frame is among them");
        Ok(ReportStrip { name: self.name.clone(), pictures, shown: chosen.iter().map(place).collect() })
    }

    /// From where a run in space is looked at; none in the plane.
    fn viewpoint(&self, findings: Findings) -> anyhow::Result<Option<Viewpoint>> {
        let scene = &self.case.case.scene;
        if scene.dimension != 3 {
            return Ok(None);
        }
        let frames: Frames<3> = findings.archive.store.case(&self.case.key).read_frames()?;
        let ends: Vec<_> = [frames.frames.first(), frames.frames.last()]
            .into_iter()
            .flatten()
            .map(|frame| in_world(&frames, frame))
            .collect();
        let ends: Vec<_> = ends.iter().map(Vec::as_slice).collect();
        Ok(Some(Viewpoint::of(Some(scene), &ends)))
    }

    /// What is seen of each of the chosen frames once, in the order of time.
    fn seen(
        &self,
        findings: Findings,
        chosen: &[usize],
        viewpoint: Option<&Viewpoint>,
    ) -> anyhow::Result<Vec<Seen>> {
        match self.case.case.scene.dimension {
            3 => self.seen_in::<3>(findings, chosen, viewpoint),
            _ => self.seen_in::<2>(findings, chosen, viewpoint),
        }
    }

    fn seen_in<const D: usize>(
        &self,
        findings: Findings,
        chosen: &[usize],
        viewpoint: Option<&Viewpoint>,
    ) -> anyhow::Result<Vec<Seen>> {
        let frames: Frames<D> = findings.archive.store.case(&self.case.key).read_frames()?;
        let scene = &self.case.case.scene;
        let ruler = Ruler::new(&findings.archive.study.measure, scene, &self.case.record);
        let of = |&frame: &usize| {
            let frame = &frames.frames[frame];
            let fragments = ruler.fragments(&frame.points(), &frames.masses)?;
            let instant = Instant {
                time: frame.time,
                positions: &in_world(&frames, frame),
                spacing: self.spacing(),
                fragments: &fragments,
                least_mass: ruler.least_mass,
                colliders: &scene.collider,
            };
            Ok(Seen::of(&instant, viewpoint))
        };
        distinct(chosen).iter().map(of).collect()
    }
}

/// Positions of a frame [m]; the last of a plane is 0.
fn in_world<const D: usize>(frames: &Frames<D>, frame: &Frame<D>) -> Vec<[f64; 3]> {
    let at =
        |x: &[f32; D]| std::array::from_fn(|k| if k < D { f64::from(x[k]) + frames.origin[k] } else { 0.0 });
    frame.positions.iter().map(at).collect()
}

fn distinct(chosen: &[usize]) -> Vec<usize> {
    let all: std::collections::BTreeSet<usize> = chosen.iter().copied().collect();
    all.into_iter().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_frames_are_all_taken_and_many_evenly() {
        assert_eq!(evenly(0), Vec::<usize>::new());
        assert_eq!(evenly(1), [0]);
        assert_eq!(evenly(3), [0, 1, 2]);
        let taken = evenly(43);
        assert_eq!((taken.len(), taken[0], taken[21]), (22, 0, 42));
        assert!(taken.windows(2).all(|pair| pair[1] - pair[0] == 2), "{taken:?}");
    }
}
