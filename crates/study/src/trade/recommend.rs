//! The cheapest setting that is close enough.

use std::path::Path;

use anyhow::Context;
use serde::Serialize;
use thiserror::Error;
use toml::{Table, Value};

use super::impacts::cells_across;
use super::settings::KEYS;
use crate::spec::SceneSpec;
use crate::template::Record;

/// A row of `settings.csv`.
#[derive(Clone, Debug, Serialize)]
pub struct Setting {
    /// The arm.
    pub arm: String,
    /// Cells across the body, where it is narrowest.
    pub cells_across: f64,
    /// Particles to a cell.
    pub particles_per_cell: f64,
    /// Its other keys of `numerics`.
    pub numerics: Table,
    /// Wall time of the study's first scene on one thread [s].
    pub seconds: f64,
    /// E at the Mach number `mach`, geometric mean over scenes.
    pub error: f64,
    /// Lower 95 % limit of E in another scene.
    pub error_lower: f64,
    /// Upper 95 % limit of E in another scene, and the error of the reference itself on top.
    pub error_bound: f64,
    /// Mach number of the impact for which errors are told: impact speed over wave speed.
    pub mach: f64,
    /// The least and the greatest Mach number that errors were learnt at.
    pub machs: [f64; 2],
    /// Greatest 90 % limit of |d| of fragments [SD], where it was measured.
    pub spread: Option<f64>,
    /// Scenes held out, and those of them with E below the upper limit.
    pub held_out: [u64; 2],
}

/// What a setting must keep.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Wanted {
    /// Greatest E.
    pub error: Option<f64>,
    /// Greatest |d| of fragments [SD].
    pub spread: Option<f64>,
}

/// Names of settings that are known to serve.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum Preset {
    /// To see what a scene does.
    Preview,
    /// To show it.
    Balanced,
    /// To measure it.
    Reference,
}

impl Preset {
    /// What it keeps (chosen: half of the deformation, a quarter, a tenth).
    pub fn wanted(self) -> Wanted {
        match self {
            Preset::Preview => Wanted { error: Some(0.5), spread: None },
            Preset::Balanced => Wanted { error: Some(0.25), spread: None },
            Preset::Reference => Wanted { error: Some(0.1), spread: None },
        }
    }
}

/// Which wish keeps from a cheaper setting.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Binding {
    /// The error.
    Error,
    /// What becomes of fragments.
    Fragments,
    /// Neither: it is the cheapest of all.
    Neither,
}

/// Nothing is good enough.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum Refusal {
    /// No setting has so small an error.
    #[error(
        "no setting is known to keep E below {wanted} at an impact of Mach {mach:.2}; the closest, `{arm}`, keeps it below {least:.3} (slower impacts \
         press in fewer cells, of which a grid is off by as much)"
    )]
    Error {
        /// What was wanted.
        wanted: f64,
        /// Mach number of the impact.
        mach: f64,
        /// The closest there is.
        arm: String,
        /// Its bound.
        least: f64,
    },
    /// No setting that is close enough leaves fragments alone.
    #[error(
        "no setting with so small an error is known to keep |d| of fragments below {wanted}; {known} settings have been tried on fragments, the best of them keeps it below {least:.2}"
    )]
    Fragments {
        /// What was wanted.
        wanted: f64,
        /// Settings of which it is known.
        known: usize,
        /// The least bound.
        least: f64,
    },
}

impl Setting {
    /// Reads rows of `settings.csv`; those without an error are left out.
    ///
    /// # Errors
    /// A row that is none of such a table.
    pub fn read(rows: &[Record]) -> anyhow::Result<Vec<Setting>> {
        let has_error = |row: &&Record| row.get("error_bound").is_some_and(|text| !text.is_empty());
        rows.iter().filter(has_error).map(Setting::of).collect()
    }

    fn of(row: &Record) -> anyhow::Result<Setting> {
        let text = |column: &str| row.get(column).with_context(|| format!("no column `{column}`"));
        let number = |column: &str| -> anyhow::Result<f64> {
            let text = text(column)?;
            text.parse().with_context(|| format!("`{column}` is \"{text}\", no number"))
        };
        let numerics: Table = toml::from_str(&format!("numerics = {}", text("numerics")?))?;
        let Some(Value::Table(numerics)) = numerics.get("numerics").cloned() else {
            anyhow::bail!("`numerics` is no table")
        };
        Ok(Setting {
            arm: text("arm")?.clone(),
            cells_across: number("cells_across")?,
            particles_per_cell: number("particles_per_cell")?,
            numerics,
            seconds: number("seconds")?,
            error: number("error")?,
            error_lower: number("error_lower")?,
            error_bound: number("error_bound")?,
            mach: number("mach")?,
            machs: [number("mach_least")?, number("mach_greatest")?],
            spread: number("spread").ok(),
            held_out: [number("held_out")? as u64, number("held_out_below")? as u64],
        })
    }

    /// The same with its errors at another impact. They go like 1 over the Mach number (`trade::impacts` says why), and no further down than at the
    /// greatest that is known: what is faster is crushed where it touches. Where nothing strikes anything they stay as they are.
    pub fn at(&self, mach: f64) -> Setting {
        let known = self.mach > 0.0 && mach > 0.0;
        let factor = if known { self.mach / mach.min(self.machs[1]) } else { 1.0 };
        let mach = if known { mach } else { self.mach };
        let [error, error_lower, error_bound] =
            [self.error, self.error_lower, self.error_bound].map(|error| error * factor);
        Setting { mach, error, error_lower, error_bound, ..self.clone() }
    }

    /// The scene with this setting: its spacing and the rest of its numerics, and as many particles of each body as there are then to a cell, where
    /// it has so many to a cell now; its meshes are in `folder`. A fixed step goes, since the setting says how long steps are; voids stay as they are.
    ///
    /// # Errors
    /// A scene whose extent or number of particles is not its own to set.
    pub fn apply(&self, scene: &SceneSpec, folder: &Path, particles_per_cell: f64) -> anyhow::Result<Table> {
        let finer = self.cells_across / cells_across(scene, folder);
        let factor = self.particles_per_cell / particles_per_cell * libm::pow(finer, scene.dimension as f64);
        let made = scene.on_grid(rounded(scene.numerics.spacing / finer), factor);
        let made = made.filter(|_| finer.is_finite()).context(
            "`body.N.placement`: particles of a file stay as they are; a setting needs a `region` and a `count`",
        )?;
        let mut table = Table::try_from(&made)?;
        let numerics =
            table.get_mut("numerics").and_then(Value::as_table_mut).context("a scene has numerics")?;
        for key in KEYS.into_iter().chain(["fixed_step"]) {
            numerics.remove(key);
        }
        numerics.extend(self.numerics.clone());
        Ok(table)
    }
}

/// To four digits, as a user would write it.
fn rounded(x: f64) -> f64 {
    format!("{x:.3e}").parse().unwrap_or(x)
}

/// The cheapest setting that keeps what is wanted, and what keeps from a cheaper one.
///
/// # Errors
/// [`Refusal`].
pub fn recommend(settings: &[Setting], wanted: Wanted) -> Result<(&Setting, Binding), Refusal> {
    let close = |setting: &&Setting| wanted.error.is_none_or(|most| setting.error_bound <= most);
    let alike = |setting: &&Setting| {
        wanted.spread.is_none_or(|most| setting.spread.is_some_and(|spread| spread <= most))
    };
    let cheapest = |kept: &dyn Fn(&&Setting) -> bool| {
        settings.iter().filter(kept).min_by(|a, b| a.seconds.total_cmp(&b.seconds))
    };
    let Some(found) = cheapest(&|setting| close(setting) && alike(setting)) else {
        let closest = settings.iter().min_by(|a, b| a.error_bound.total_cmp(&b.error_bound));
        return Err(match (wanted.error, closest) {
            (Some(error), Some(closest)) if closest.error_bound > error => Refusal::Error {
                wanted: error,
                mach: closest.mach,
                arm: closest.arm.clone(),
                least: closest.error_bound,
            },
            _ => {
                let known = || settings.iter().filter_map(|setting| setting.spread);
                Refusal::Fragments {
                    wanted: wanted.spread.unwrap_or(f64::NAN),
                    known: known().count(),
                    least: known().fold(f64::INFINITY, f64::min),
                }
            }
        });
    };
    let is_cheaper = |other: Option<&Setting>| other.is_some_and(|other| other.seconds < found.seconds);
    let binding = if is_cheaper(cheapest(&alike)) {
        Binding::Error
    } else if is_cheaper(cheapest(&close)) {
        Binding::Fragments
    } else {
        Binding::Neither
    };
    Ok((found, binding))
}
