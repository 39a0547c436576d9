//! Numerical choices of random scenes.

use std::fmt::{self, Display};

use proptest::prelude::*;

use super::scene::{MOST_STEPS, decades};

/// `[numerics]` of a scene.
#[derive(Clone, Debug)]
pub struct Numerics {
    /// h [m].
    pub spacing: f64,
    names: [(&'static str, &'static str); 6],
    switches: [(&'static str, bool); 3],
    flip_share: f64,
    /// A key with its number; none for the adaptive step as it is.
    step: Option<(&'static str, f64)>,
    /// An inline table.
    integrator: Option<String>,
}

/// All of them.
pub fn numerics() -> impl Strategy<Value = Numerics> {
    let share = prop_oneof![Just(0.0), Just(0.95), Just(1.0), 0.0..=1.0];
    let parts = (decades(-4.0, 1.0), names(), switches(), share, steps(), integrators());
    parts.prop_map(|(spacing, mut names, switches, flip_share, step, integrator)| {
        // With it particles move by the mean of the grid's velocities.
        if integrator.as_ref().is_some_and(|text| text.contains("trapezoidal")) {
            names[5].1 = "interpolated";
        }
        Numerics { spacing, names, switches, flip_share, step, integrator }
    })
}

fn one_of(names: &'static [&'static str]) -> impl Strategy<Value = &'static str> {
    proptest::sample::select(names)
}

fn names() -> impl Strategy<Value = [(&'static str, &'static str); 6]> {
    let names = (
        one_of(&["cubic", "quadratic"]),
        one_of(&["flip", "apic", "mls"]),
        one_of(&["fast", "reference"]),
        one_of(&["f64", "f32"]),
        one_of(&["uniform", "uniform", "density"]),
        one_of(&["interpolated", "interpolated", "blended"]),
    );
    names.prop_map(|(kernel, transfer, engine, precision, volume, advection)| {
        [
            ("kernel", kernel),
            ("transfer", transfer),
            ("engine", engine),
            ("precision", precision),
            ("rest_volume", volume),
            ("advection", advection),
        ]
    })
}

fn switches() -> impl Strategy<Value = [(&'static str, bool); 3]> {
    (prop::bool::weighted(0.8), any::<bool>(), any::<bool>()).prop_map(|(watchdog, budget, per_step)| {
        [("watchdog", watchdog), ("energy_budget", budget), ("flip_per_step", per_step)]
    })
}

fn steps() -> impl Strategy<Value = Option<(&'static str, f64)>> {
    prop_oneof![
        2 => Just(None),
        1 => decades(-9.0, 0.0).prop_map(|dt| Some(("fixed_step", dt))),
        1 => decades(-2.0, 2.0).prop_map(|courant| Some(("wave_courant", courant))),
    ]
}

fn integrators() -> impl Strategy<Value = Option<String>> {
    let beta = (0.0..=1.0f64).prop_map(|beta| format!("kind = \"semi-implicit\", beta = {beta:?}"));
    let kind = prop_oneof![beta, Just("kind = \"trapezoidal\"".to_string())];
    let solve = (kind, one_of(&["minres", "conjugate-residuals"]), decades(-12.0, -0.1), any::<bool>());
    let implicit = solve.prop_map(|(kind, method, tolerance, definite)| {
        Some(format!("{{ {kind}, method = \"{method}\", tolerance = {tolerance:?}, definite = {definite}, max_iterations = 10 }}"))
    });
    prop_oneof![3 => Just(None), 1 => implicit]
}

impl Display for Numerics {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "[numerics]\nspacing = {:?}\nflip_share = {:?}", self.spacing, self.flip_share)?;
        self.names.iter().try_for_each(|(key, name)| writeln!(f, "{key} = \"{name}\""))?;
        self.switches.iter().try_for_each(|(key, on)| writeln!(f, "{key} = {on}"))?;
        self.step.map_or(Ok(()), |(key, number)| writeln!(f, "{key} = {number:?}"))?;
        self.integrator.as_ref().map_or(Ok(()), |integrator| writeln!(f, "integrator = {integrator}"))?;
        writeln!(f, "max_steps = {MOST_STEPS}")
    }
}
