//! What is run: motions, placements and the series of them.

use snowlab_solver::{KernelKind, Transfer};

use super::solutions::{StandingWaves, Vortex};
use crate::verify::evidence::Effort;
use crate::verify::scenes::{DENSITY, KERNELS, TRANSFERS, YOUNG, kernel_name, transfer_name};

/// A = 0.05 m (strains to A pi = 16 %), c = sqrt(E / rho_0).
pub fn waves() -> StandingWaves {
    StandingWaves { amplitude: 0.05, speed: (YOUNG / DENSITY).sqrt() }
}

/// A = 0.15 rad within 0.1 s; chosen: a shear wave crosses the ring and comes back within the period.
pub const VORTEX: Vortex = Vortex { angle: 0.15, period: 0.1, middle: 1.0 };

/// The step for which FLIP's share is 0.95 [s]; chosen: the default step of the coarser grids, so that FLIP is compared with the
/// affine transfers where it is little damped.
pub const LIGHT: f64 = 1e-3;
/// The same as the studies have it (docs/experiment.md) [s].
const STUDIES: f64 = 1e-5;
/// Placements drawn where chance decides (chosen: enough to tell their spread).
const SEEDS: u64 = 3;

/// Where particles begin.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Placement {
    Lattice,
    Jittered,
    Random,
}

impl Placement {
    fn name(self) -> &'static str {
        match self {
            Placement::Lattice => "lattice",
            Placement::Jittered => "jittered",
            Placement::Random => "random",
        }
    }
}

/// What moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Motion {
    Waves2,
    Waves3,
    Vortex,
}

impl Motion {
    pub fn name(self) -> &'static str {
        match self {
            Motion::Waves2 => "waves 2D",
            Motion::Waves3 => "waves 3D",
            Motion::Vortex => "vortex",
        }
    }
}

/// One series: everything but the grid.
#[derive(Clone, Copy, Debug)]
pub struct Series {
    pub motion: Motion,
    pub kernel: KernelKind,
    pub transfer: Transfer,
    pub placement: Placement,
    /// Whether in f32.
    pub single: bool,
    /// Whether walls reflect, or set the nodes' normal velocity to zero.
    pub mirrored: bool,
    /// Particles per cell and axis.
    pub per_axis: usize,
    /// Step over the default.
    pub step: f64,
    /// The step for which FLIP's share is 0.95 [s].
    pub reference_step: f64,
}

impl Series {
    /// On a lattice with particles enough that the quadrature's error lies below the grid's; in 3D, as many as can be afforded.
    pub fn of(motion: Motion, kernel: KernelKind, transfer: Transfer) -> Self {
        Series {
            motion,
            kernel,
            transfer,
            placement: Placement::Lattice,
            single: false,
            mirrored: true,
            per_axis: match (motion, kernel) {
                (Motion::Waves3, _) => 2,
                (Motion::Waves2, KernelKind::Quadratic) => 8,
                _ => 4,
            },
            step: 1.0,
            reference_step: LIGHT,
        }
    }

    pub fn name(&self) -> String {
        let walls = if self.motion == Motion::Vortex || self.mirrored { "" } else { ", zeroed walls" };
        let precision = if self.single { ", f32" } else { "" };
        format!(
            "{}, {} {}, {}, {} per cell{precision}{walls}",
            self.motion.name(),
            kernel_name(self.kernel),
            self.transfer_name(),
            self.placement_name(),
            self.per_cell()
        )
    }

    /// `flip`, `flip of the studies`, `apic` or `mls`.
    pub fn transfer_name(&self) -> &'static str {
        match self.transfer {
            Transfer::Flip(_) if self.reference_step == STUDIES => "flip of the studies",
            other => transfer_name(other),
        }
    }

    pub fn placement_name(&self) -> &'static str {
        if self.motion == Motion::Vortex { "rings" } else { self.placement.name() }
    }

    /// Particles per cell.
    pub fn per_cell(&self) -> usize {
        self.per_axis.pow(if self.motion == Motion::Waves3 { 3 } else { 2 })
    }

    /// Seeds of the placements it is run with.
    pub fn seeds(&self) -> std::ops::RangeInclusive<u64> {
        1..=if self.placement == Placement::Lattice { 1 } else { SEEDS }
    }
}

/// The series that are refined.
pub fn refined(effort: Effort) -> Vec<Series> {
    let mut all = Vec::new();
    for kernel in KERNELS {
        for transfer in TRANSFERS {
            all.push(Series::of(Motion::Waves2, kernel, transfer));
            all.push(Series::of(Motion::Vortex, kernel, transfer));
            all.push(Series::of(Motion::Waves3, kernel, transfer));
        }
    }
    // With 4 particles per cell, as the studies have.
    for transfer in TRANSFERS {
        let few = |motion, kernel| Series { per_axis: 2, ..Series::of(motion, kernel, transfer) };
        let waves = few(Motion::Waves2, KernelKind::Cubic);
        let vortex = few(Motion::Vortex, KernelKind::Cubic);
        let quadratic = few(Motion::Waves2, KernelKind::Quadratic);
        all.extend([waves, vortex, quadratic, Series { per_axis: 4, ..quadratic }]);
        for placement in [Placement::Jittered, Placement::Random] {
            all.push(Series { placement, ..waves });
        }
        all.push(Series { mirrored: false, ..waves });
        all.push(Series { single: true, ..waves });
        if matches!(transfer, Transfer::Flip(_)) {
            all.extend([waves, vortex].map(|series| Series { reference_step: STUDIES, ..series }));
        }
    }
    if effort == Effort::Quick {
        all.retain(|series| series.kernel == KernelKind::Cubic && series.motion != Motion::Waves3);
    }
    all
}

/// On one grid, with its cells per metre: shorter steps, and ever more particles, where the error no longer falls with the grid.
pub fn on_one_grid(effort: Effort) -> Vec<(Series, usize)> {
    let (crowds, cells): (&[usize], usize) = effort.choose((&[2, 4], 32), (&[2, 4, 8], 64));
    let few = |motion, transfer| Series { per_axis: 2, ..Series::of(motion, KernelKind::Cubic, transfer) };
    let mut cases = Vec::new();
    for motion in [Motion::Waves2, Motion::Vortex] {
        for transfer in TRANSFERS {
            cases.extend([1.0, 0.5, 0.25].map(|step| (Series { step, ..few(motion, transfer) }, cells)));
        }
    }
    let waves = few(Motion::Waves2, Transfer::Mls);
    let quadratic = Series { kernel: KernelKind::Quadratic, ..waves };
    for series in [
        waves,
        Series { placement: Placement::Random, ..waves },
        quadratic,
        Series { transfer: Transfer::Apic, ..quadratic },
        Series { motion: Motion::Vortex, ..waves },
        Series { motion: Motion::Vortex, ..quadratic },
    ] {
        cases.extend(crowds.iter().map(|&per_axis| (Series { per_axis, ..series }, cells)));
    }
    cases
}

/// Cells to the metre.
pub fn grids(series: &Series, effort: Effort) -> &'static [usize] {
    match (series.motion, effort) {
        (Motion::Waves3, _) => &[4, 8, 16, 32],
        // What 64 particles per cell cost.
        (Motion::Waves2, _) if series.per_axis == 8 => &[8, 16, 32, 64],
        (Motion::Waves2, Effort::Quick) => &[8, 16, 32, 64],
        (Motion::Waves2, Effort::Full) => &[8, 16, 32, 64, 128],
        (Motion::Vortex, Effort::Quick) => &[8, 16, 32],
        (Motion::Vortex, Effort::Full) => &[8, 16, 32, 64],
    }
}
