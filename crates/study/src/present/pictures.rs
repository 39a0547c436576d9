//! The snowballs before and after.

use std::collections::BTreeMap;

use crate::figure::snowballs::{self, Snapshot, Snowball, Snowballs};
use crate::frames::{Frame, Frames};
use crate::measure::Ruler;
use crate::results::CaseResult;
use crate::spec::scene::ColliderSpec;
use crate::view::outline;

use super::{Findings, Titled, drawn};

/// Width of the figures [pixels]: 30,000 particles in each of four columns stay legible.
const WIDTH: u32 = 1800;

/// One frame, ready to be drawn.
struct Drawn {
    positions: Vec<[f64; 2]>,
    fragments: Vec<Option<u32>>,
    ln_ratio: Vec<f64>,
    count: usize,
    largest_share: f64,
    obstacles: Vec<Vec<[f64; 2]>>,
}

struct Ball {
    label: String,
    spacing: f64,
    before: Drawn,
    after: Drawn,
    end: f64,
}

/// For each named picture the first block of its arms: fragments, and ln J_P.
pub fn snowballs(findings: Findings) -> anyhow::Result<Vec<Titled>> {
    let spec = &findings.archive.study.spec;
    let mut pictures: BTreeMap<&str, Vec<Ball>> = BTreeMap::new();
    for arm in &spec.arm {
        let first = findings
            .results
            .iter()
            .find(|r| r.case.arm == arm.id && r.case.scene.dimension == 2 && r.record.was_built());
        if let (Some(name), Some(result)) = (&arm.picture, first) {
            pictures.entry(name).or_default().push(ball(findings, result)?);
        }
    }
    let mut figures = Vec::new();
    for (name, balls) in pictures {
        let time = balls.first().map_or(0.0, |ball| ball.end);
        let after = format!("{time:.1} R/v after contact");
        let columns: Vec<Snowball> = balls.iter().map(Ball::column).collect();
        let figure = Snowballs { title: "", balls: &columns, rows: ["before", &after], width: WIDTH };
        let words = capitalised(&name.replace('-', " "));
        let counts: Vec<String> = balls
            .iter()
            .map(|b| {
                format!(
                    "{}: {} fragments, largest {:.0} %",
                    b.label,
                    b.after.count,
                    100.0 * b.after.largest_share
                )
            })
            .collect();
        let counts = counts.join("; ");
        if let Some(drawing) = drawn(snowballs::fragments(&figure))? {
            figures.push(Titled {
                name: format!("{name}-fragments"),
                title: format!("{words}: fragments"),
                caption: "The first block of each arm before and after the impact, every particle in the colour of its fragment, dust in grey.".into(),
                alternative: format!("Snowballs before and {after}. After: {counts}."),
                drawing,
            });
        }
        if let Some(drawing) = drawn(snowballs::plastic_volume(&figure))? {
            figures.push(Titled {
                name: format!("{name}-plastic-volume"),
                title: format!("{words}: plastic volume ratio"),
                caption: "The same particles coloured by ln J_P: blue where snow is compacted and hard, orange where it has opened and softened.".into(),
                alternative: format!("Snowballs before and {after}, coloured by plastic volume ratio: compacted at the foot, opened along the cracks."),
                drawing,
            });
        }
    }
    Ok(figures)
}

/// A title begins with a capital.
fn capitalised(words: &str) -> String {
    let mut letters = words.chars();
    letters.next().map_or(String::new(), |first| first.to_uppercase().chain(letters).collect())
}

fn ball(findings: Findings, result: &CaseResult) -> anyhow::Result<Ball> {
    let frames: Frames<2> = findings.archive.store.case(&result.key).read_frames()?;
    let ruler = Ruler::new(&findings.archive.study.measure, &result.case.scene, &result.record);
    let empty = Frame { time: 0.0, positions: Vec::new(), plastic_ratios: Vec::new() };
    let (before, after) = (frames.frames.first().unwrap_or(&empty), frames.frames.last().unwrap_or(&empty));
    let (made, colliders) = (&result.record.made, &result.case.scene.collider);
    Ok(Ball {
        label: findings.archive.study.label(&result.case.arm),
        spacing: (made.filled_volume / made.particles.max(1) as f64).sqrt(),
        before: Drawn::of(&frames, before, &ruler, colliders)?,
        after: Drawn::of(&frames, after, &ruler, colliders)?,
        end: (after.time - result.record.contact_time.unwrap_or(0.0)) / result.record.time_unit,
    })
}

impl Ball {
    fn column(&self) -> Snowball<'_> {
        Snowball {
            arm: &self.label,
            spacing: self.spacing,
            before: self.before.snapshot(),
            after: self.after.snapshot(),
        }
    }
}

impl Drawn {
    fn of(
        frames: &Frames<2>,
        frame: &Frame<2>,
        ruler: &Ruler,
        colliders: &[ColliderSpec],
    ) -> anyhow::Result<Self> {
        let analysis = ruler.fragments(&frame.points(), &frames.masses)?;
        let heavy = analysis.count(ruler.least_mass) as u32;
        let origin = frames.origin;
        Ok(Drawn {
            positions: frame.points().iter().map(|x| [x[0] + origin[0], x[1] + origin[1]]).collect(),
            fragments: analysis.labels().iter().map(|&rank| (rank < heavy).then_some(rank)).collect(),
            ln_ratio: frame.plastic_ratios.iter().map(|&j| libm::log(f64::from(j))).collect(),
            count: heavy as usize,
            largest_share: analysis.largest_share(),
            obstacles: colliders.iter().map(|collider| outline(collider, frame.time)).collect(),
        })
    }

    fn snapshot(&self) -> Snapshot<'_> {
        Snapshot {
            positions: &self.positions,
            fragments: &self.fragments,
            ln_plastic_volume_ratio: &self.ln_ratio,
            count: self.count,
            largest_share: self.largest_share,
            obstacles: &self.obstacles,
        }
    }
}
