//! Colours, sizes and number formats shared by all figures.
//!
//! Categories take the colours of Okabe & Ito (2008, "Color Universal Design"), which stay apart for the common
//! kinds of colour blindness; the light yellow is left out because it vanishes on white paper.

/// An opaque or translucent colour: sRGB bytes and a coverage in `0..=1`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ink {
    /// Red, green and blue, sRGB.
    pub rgb: [u8; 3],
    /// Opacity, 0 (nothing) to 1 (opaque).
    pub alpha: f32,
}

impl Ink {
    /// An opaque colour from `0xRRGGBB`.
    pub const fn hex(code: u32) -> Self {
        Self { rgb: [(code >> 16) as u8, (code >> 8) as u8, code as u8], alpha: 1.0 }
    }

    /// The same colour with another opacity.
    pub const fn with_alpha(self, alpha: f32) -> Self {
        Self { rgb: self.rgb, alpha }
    }
}

/// Paper.
pub const PAPER: Ink = Ink::hex(0xffffff);
/// Text and data drawn in black.
pub const TEXT: Ink = Ink::hex(0x1b2127);
/// Secondary text: tick labels, notes.
pub const MUTED: Ink = Ink::hex(0x56616c);
/// Axis lines and tick marks.
pub const AXIS: Ink = Ink::hex(0x7d8791);
/// Grid lines, drawn below the data.
pub const GRID: Ink = Ink::hex(0xe6e9ed);
/// Dust: particles in components too light to be called fragments.
pub const DUST: Ink = Ink::hex(0x8f969d);
/// Marks which are not about one arm: thresholds, the link used, the time of measurement.
pub const MARKER: Ink = Ink::hex(0x1b2127);

/// Seven of the eight colours of Okabe & Ito, in the order in which neighbours differ most in lightness.
pub const OKABE_ITO: [Ink; 7] = [
    Ink::hex(0x0072b2),
    Ink::hex(0xe69f00),
    Ink::hex(0x009e73),
    Ink::hex(0xd55e00),
    Ink::hex(0x56b4e9),
    Ink::hex(0xcc79a7),
    Ink::hex(0x33383d),
];

/// Colour of the `index`-th category; repeats after seven.
pub fn category(index: usize) -> Ink {
    OKABE_ITO[index % OKABE_ITO.len()]
}

/// The same hue, dark enough for text on paper (a contrast of at least about 4 to 1).
pub fn readable(ink: Ink) -> Ink {
    let [r, g, b] = ink.rgb.map(f64::from);
    let lightness = (0.2126 * r + 0.7152 * g + 0.0722 * b) / 255.0;
    let keep = (0.46 / lightness).min(1.0);
    Ink { rgb: [r, g, b].map(|v| (v * keep) as u8), alpha: ink.alpha }
}

/// Five stops of the diverging map for ln J_P: compacted snow blue, opened snow orange to brown, the centre a grey
/// blue, because white would vanish on paper (chosen: blue and orange are apart for every kind of colour blindness).
const DIVERGING: [[f64; 3]; 5] = [
    [8.0, 48.0, 107.0],
    [62.0, 140.0, 198.0],
    [190.0, 201.0, 211.0],
    [236.0, 134.0, 50.0],
    [125.0, 38.0, 5.0],
];

/// Diverging colour of `t` in `-1..=1` (clamped); 0 is the grey-blue centre. A value that is not a number is drawn
/// in [`DUST`].
pub fn diverging(t: f64) -> Ink {
    if !t.is_finite() {
        return DUST;
    }
    let place = (t.clamp(-1.0, 1.0) + 1.0) * 2.0;
    let lower = (place as usize).min(3);
    let share = place - lower as f64;
    let mix = |k: usize| {
        let [a, b] = [DIVERGING[lower][k], DIVERGING[lower + 1][k]];
        (a + share * (b - a) + 0.5) as u8
    };
    Ink { rgb: [mix(0), mix(1), mix(2)], alpha: 1.0 }
}

/// Size of figure titles [pixels per em].
pub const TITLE: f64 = 32.0;
/// Size of panel titles.
pub const HEADING: f64 = 26.0;
/// Size of axis labels and legends.
pub const LABEL: f64 = 24.0;
/// Size of tick labels and notes.
pub const TICK: f64 = 21.0;
/// The smallest size text may be shrunk to (chosen: 8 px when 1600 px are shown 800 px wide).
pub const SMALLEST: f64 = 16.0;
/// Width of a chart [pixels]; shown at half of it, it fits a page and a phone in landscape.
pub const CHART_WIDTH: u32 = 1600;
/// Margin round a figure [pixels].
pub const MARGIN: f64 = 28.0;

/// A number with at most `digits` digits after the point, without trailing zeros and with a true minus sign.
pub fn number(value: f64, digits: usize) -> String {
    let mut text = format!("{value:.digits$}");
    if text.contains('.') {
        text.truncate(text.trim_end_matches('0').trim_end_matches('.').len());
    }
    if text == "-0" {
        text.remove(0);
    }
    text.replace('-', "\u{2212}")
}
