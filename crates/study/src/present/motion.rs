//! A ball of each arm through time: the same instants for all, at one scale, for a slider to go through.

use rayon::prelude::*;

use crate::figure::moment::{Moment, View, bounds, moment};
use crate::figure::style::{self, DUST, Ink};
use crate::frames::{Frame, Frames};
use crate::measure::{Ruler, SeriesRow};
use crate::report::{ReportMotion, ReportPicture, ReportStrip};
use crate::results::CaseResult;
use crate::spec::scene::{ColliderSpec, SolidSpec, TimeUnit};
use crate::tables::{groups, usable};

use super::Findings;
use super::obstacles::outline;
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
/// Lightness of the particles furthest from the eye over that of the nearest, in pictures of space (chosen: depth is seen, colours are still told apart).
const FAR: f64 = 0.45;

/// The case that shows an arm.
struct Film<'a> {
    name: String,
    case: &'a CaseResult,
    /// What there is of each frame.
    series: &'a [SeriesRow],
}

/// A frame, ready to be painted.
struct Still {
    positions: Vec<[f64; 2]>,
    inks: Vec<Ink>,
    /// Positions of particles in fragments.
    heavy: Vec<[f64; 2]>,
    obstacles: Vec<Vec<[f64; 2]>>,
    count: usize,
    largest_share: f64,
}

/// Boxes round what is seen of an arm, and outlines of its obstacles [m].
type Seen = (Vec<[[f64; 2]; 2]>, Vec<Vec<[f64; 2]>>);

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
    let seen: Vec<Seen> = films
        .par_iter()
        .zip(&chosen)
        .map(|(film, chosen)| {
            let stills = film.stills(findings, chosen)?;
            let obstacles = stills.iter().flat_map(|still| still.obstacles.clone()).collect();
            Ok((stills.iter().filter_map(Still::bounds).collect(), obstacles))
        })
        .collect::<anyhow::Result<_>>()?;
    let (boxes, obstacles): (Vec<_>, Vec<_>) = seen.into_iter().unzip();
    let least = NARROWEST * films.iter().map(Film::spacing).fold(0.0, f64::max);
    let Some(view) = View::of(&boxes.concat(), &obstacles.concat(), least) else {
        return Ok(ReportMotion { note: NOTHING.into(), ..ReportMotion::default() });
    };
    let strips = films
        .par_iter()
        .zip(&chosen)
        .map(|(film, chosen)| film.strip(findings, chosen, &view))
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
        note += " Balls in space are seen along the last axis, the nearest particles in front and brightest.";
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

    /// The pictures of the chosen frames, each once.
    fn strip(&self, findings: Findings, chosen: &[usize], view: &View) -> anyhow::Result<ReportStrip> {
        let spacing = self.spacing();
        let frames = distinct(chosen);
        let mut pictures = Vec::new();
        for (&frame, still) in frames.iter().zip(self.stills(findings, chosen)?) {
            let Still { positions, inks, obstacles, count, largest_share, .. } = &still;
            let drawing = moment(&Moment { positions, inks, spacing, obstacles }, view, WIDTH)?;
            let noun = if *count == 1 { "fragment" } else { "fragments" };
            let (when, time, share) = (self.when(frame), self.clock(frame), 100.0 * largest_share);
            pictures.push(ReportPicture {
                png: drawing.paint().indexed_png(COLOURS),
                caption: format!("{time}, {count} {noun}, largest {share:.0}\u{a0}%"),
                alternative: format!(
                    "{}, {when}: {count} {noun}, the largest with {share:.0} % of the mass.",
                    self.name
                ),
            });
        }
        let place = |frame: &usize| frames.binary_search(frame).expect("each chosen frame is among them");
        Ok(ReportStrip { name: self.name.clone(), pictures, shown: chosen.iter().map(place).collect() })
    }

    /// Each of the chosen frames once, in the order of time.
    fn stills(&self, findings: Findings, chosen: &[usize]) -> anyhow::Result<Vec<Still>> {
        match self.case.case.scene.dimension {
            3 => self.stills_in::<3>(findings, chosen),
            _ => self.stills_in::<2>(findings, chosen),
        }
    }

    fn stills_in<const D: usize>(&self, findings: Findings, chosen: &[usize]) -> anyhow::Result<Vec<Still>> {
        let frames: Frames<D> = findings.archive.store.case(&self.case.key).read_frames()?;
        let ruler = Ruler::new(&findings.archive.study.measure, &self.case.case.scene, &self.case.record);
        let colliders = &self.case.case.scene.collider;
        let of = |&frame: &usize| Still::of(&frames, &frames.frames[frame], &ruler, colliders);
        distinct(chosen).iter().map(of).collect()
    }
}

fn distinct(chosen: &[usize]) -> Vec<usize> {
    let all: std::collections::BTreeSet<usize> = chosen.iter().copied().collect();
    all.into_iter().collect()
}

impl Still {
    /// Corners of the box round its fragments, or round its dust where there is nothing else [m].
    fn bounds(&self) -> Option<[[f64; 2]; 2]> {
        bounds(if self.heavy.is_empty() { &self.positions } else { &self.heavy })
    }

    fn of<const D: usize>(
        frames: &Frames<D>,
        frame: &Frame<D>,
        ruler: &Ruler,
        colliders: &[ColliderSpec],
    ) -> anyhow::Result<Self> {
        let analysis = ruler.fragments(&frame.points(), &frames.masses)?;
        let count = analysis.count(ruler.least_mass);
        let ranks: Vec<Option<usize>> =
            analysis.labels().iter().map(|&rank| Some(rank as usize).filter(|rank| *rank < count)).collect();
        let at = |p: usize| [0, 1].map(|k| f64::from(frame.positions[p][k]) + frames.origin[k]);
        let mut order: Vec<usize> = (0..ranks.len()).collect();
        let depths: Vec<f32> =
            if D == 3 { frame.positions.iter().map(|x| x[D - 1]).collect() } else { Vec::new() };
        if D == 3 {
            order.sort_by(|a, b| depths[*a].total_cmp(&depths[*b]));
        } else {
            // Dust first, then from the heaviest fragment to the lightest, so that small pieces are seen.
            order.sort_by_key(|&p| ranks[p].map_or(0, |rank| rank + 1));
        }
        let ends = depths.iter().fold([f32::MAX, f32::MIN], |[a, b], d| [a.min(*d), b.max(*d)]);
        let ink = |p: usize| {
            let ink = ranks[p].map_or(DUST, style::category);
            if D == 3 {
                shaded(ink, f64::from(depths[p] - ends[0]) / f64::from(ends[1] - ends[0]))
            } else {
                ink
            }
        };
        let heavy = (0..ranks.len()).filter(|p| ranks[*p].is_some()).map(at).collect();
        let drawn = colliders.iter().filter(|collider| is_seen_from_its_side(collider));
        Ok(Still {
            positions: order.iter().map(|&p| at(p)).collect(),
            inks: order.iter().map(|&p| ink(p)).collect(),
            heavy,
            obstacles: drawn.map(|collider| outline(collider, frame.time)).collect(),
            count,
            largest_share: analysis.largest_share(),
        })
    }
}

/// The colour of a particle at `nearness` from 0, the furthest, to 1.
fn shaded(ink: Ink, nearness: f64) -> Ink {
    let light = if nearness.is_finite() { FAR + (1.0 - FAR) * nearness } else { 1.0 };
    Ink { rgb: ink.rgb.map(|channel| (f64::from(channel) * light).round() as u8), ..ink }
}

/// Whether an obstacle has an outline in the picture: a half-space in space that turns its face to the eye would cover all of it.
fn is_seen_from_its_side(collider: &ColliderSpec) -> bool {
    match &collider.shape {
        SolidSpec::HalfSpace { normal, .. } => normal.get(2).is_none_or(|depth| *depth == 0.0),
        _ => true,
    }
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

    #[test]
    fn what_is_near_is_bright() {
        let ink = Ink::hex(0xc86400);
        assert_eq!(shaded(ink, 1.0), ink);
        assert_eq!(shaded(ink, 0.0).rgb, [90, 45, 0]);
        assert_eq!(shaded(ink, f64::NAN), ink, "all at one depth");
    }
}
