//! Drawings one after the other as an animated GIF: one palette for all frames, and of each frame only what has changed.

use std::collections::HashMap;

use super::drawing::Drawing;
use super::raster::Image;

/// Colours of the palette beside the one that lets the frame before be seen.
const COLOURS: usize = 255;
/// Bits a channel that colours are told apart by while they are counted (chosen: steps of 8 in 256 are not seen).
const BITS: u32 = 5;

/// A GIF that repeats for ever; each frame stands for `delay` hundredths of a second, the last for `rest`. All drawings have the size of the first.
/// Same drawings, same bytes.
///
/// # Errors
/// Drawings larger than a GIF may be, 65535 pixels.
pub fn gif(drawings: &[Drawing], delay: u16, rest: u16) -> Result<Vec<u8>, gif::EncodingError> {
    let Some(first) = drawings.first() else { return Ok(Vec::new()) };
    let images: Vec<Image> = drawings.iter().map(Drawing::paint).collect();
    let palette = Palette::of(&images);
    let [width, height] = [first.width, first.height].map(|side| u16::try_from(side).unwrap_or(u16::MAX));
    let mut bytes = Vec::new();
    let mut encoder = gif::Encoder::new(&mut bytes, width, height, &palette.bytes())?;
    encoder.set_repeat(gif::Repeat::Infinite)?;
    let mut before: Option<Vec<u8>> = None;
    for (number, image) in images.iter().enumerate() {
        let indices = palette.indices(image);
        let mut frame = changed(&indices, before.as_deref(), [image.width, image.height]);
        frame.delay = if number + 1 == images.len() { rest } else { delay };
        encoder.write_frame(&frame)?;
        before = Some(indices);
    }
    drop(encoder);
    Ok(bytes)
}

/// The box of what differs from the frame before; in it, what does not is transparent.
fn changed(now: &[u8], before: Option<&[u8]>, [width, height]: [usize; 2]) -> gif::Frame<'static> {
    let differs = |k: usize| before.is_none_or(|before| before[k] != now[k]);
    let mut bounds: Option<[usize; 4]> = None;
    for k in (0..now.len()).filter(|&k| differs(k)) {
        let (x, y) = (k % width, k / width);
        let [left, top, right, bottom] = bounds.get_or_insert([x, y, x, y]);
        (*left, *right) = ((*left).min(x), (*right).max(x));
        (*top, *bottom) = ((*top).min(y), (*bottom).max(y));
    }
    // A frame without pixels is none: the first stays.
    let [left, top, right, bottom] = bounds.unwrap_or([0; 4]);
    let rows = top..=bottom.min(height - 1);
    let pixel = |k: usize| if differs(k) { now[k] } else { COLOURS as u8 };
    let buffer: Vec<u8> = rows.flat_map(|y| (left..=right).map(move |x| y * width + x)).map(pixel).collect();
    gif::Frame {
        left: left as u16,
        top: top as u16,
        width: (right - left + 1) as u16,
        height: (bottom - top + 1) as u16,
        transparent: Some(COLOURS as u8),
        dispose: gif::DisposalMethod::Keep,
        buffer: buffer.into(),
        ..gif::Frame::default()
    }
}

/// The colours of all frames, and for each coarse colour the nearest of them.
struct Palette {
    colours: Vec<[u8; 3]>,
    nearest: HashMap<u32, u8>,
}

/// A colour without the bits that are not told apart.
fn coarse(rgb: [u8; 3]) -> u32 {
    rgb.iter().fold(0, |code, channel| (code << BITS) | u32::from(channel >> (8 - BITS)))
}

/// Square of the distance of two colours.
fn distance(a: [u8; 3], b: [u8; 3]) -> u64 {
    (0..3).map(|k| u64::from(a[k].abs_diff(b[k])).pow(2)).sum()
}

/// One colour after the other, each time that of which most is lost without it: how often it is seen times its squared distance from those chosen before.
/// So a small piece in a colour of its own keeps it. `seen` begins with the most frequent.
fn chosen(seen: &[(usize, [u8; 3], u32)]) -> Vec<[u8; 3]> {
    let mut losses = vec![u64::MAX; seen.len()];
    let mut colours: Vec<[u8; 3]> = Vec::new();
    while colours.len() < COLOURS {
        let lost = |n: &usize| (seen[*n].0 as u64).saturating_mul(losses[*n]);
        let Some(most) = (0..seen.len()).filter(|n| losses[*n] > 0).max_by_key(|n| (lost(n), usize::MAX - n))
        else {
            break;
        };
        colours.push(seen[most].1);
        for (loss, (_, rgb, _)) in losses.iter_mut().zip(seen) {
            *loss = (*loss).min(distance(*rgb, seen[most].1));
        }
    }
    colours
}

impl Palette {
    fn of(images: &[Image]) -> Self {
        // Of each coarse colour: how often, and the exact colour it is most often.
        let mut counts: HashMap<u32, HashMap<[u8; 3], usize>> = HashMap::new();
        for pixel in images.iter().flat_map(|image| image.pixels.chunks_exact(3)) {
            let rgb = [pixel[0], pixel[1], pixel[2]];
            *counts.entry(coarse(rgb)).or_default().entry(rgb).or_default() += 1;
        }
        let mut seen: Vec<(usize, [u8; 3], u32)> = counts
            .into_iter()
            .map(|(code, exact)| {
                let total = exact.values().sum();
                let most = exact.into_iter().max_by_key(|(rgb, count)| (*count, *rgb));
                (total, most.expect("a colour was seen").0, code)
            })
            .collect();
        seen.sort_unstable_by(|a, b| b.cmp(a));
        let colours = chosen(&seen);
        let nearest =
            |rgb: [u8; 3]| (0..colours.len()).min_by_key(|&n| distance(colours[n], rgb)).unwrap_or(0) as u8;
        let nearest = seen.iter().map(|(_, rgb, code)| (*code, nearest(*rgb))).collect();
        Palette { colours, nearest }
    }

    fn bytes(&self) -> Vec<u8> {
        let mut bytes = self.colours.concat();
        bytes.resize(3 * (COLOURS + 1), 0);
        bytes
    }

    fn indices(&self, image: &Image) -> Vec<u8> {
        image.pixels.chunks_exact(3).map(|p| self.nearest[&coarse([p[0], p[1], p[2]])]).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::super::drawing::Mark;
    use super::super::style::{Ink, OKABE_ITO};
    use super::*;

    fn square(x: f64, ink: Ink) -> Drawing {
        let points = vec![[x, 4.0], [x + 6.0, 4.0], [x + 6.0, 10.0], [x, 10.0]];
        Drawing { width: 40, height: 20, marks: vec![Mark::Polygon { points, ink }] }
    }

    /// Put together again by another decoder's rules, each frame has the colours of its drawing.
    #[test]
    fn frames_are_what_was_drawn() {
        let drawings = [square(3.0, OKABE_ITO[0]), square(20.0, OKABE_ITO[1]), square(20.0, OKABE_ITO[1])];
        let bytes = gif(&drawings, 8, 100).unwrap();
        let mut options = gif::DecodeOptions::new();
        options.set_color_output(gif::ColorOutput::RGBA);
        let mut decoder = options.read_info(&bytes[..]).unwrap();
        let mut canvas = vec![0_u8; 40 * 20 * 3];
        for (number, drawing) in drawings.iter().enumerate() {
            let frame = decoder.read_next_frame().unwrap().unwrap();
            assert_eq!(frame.delay, if number == 2 { 100 } else { 8 });
            assert!(number == 0 || frame.buffer.len() < 40 * 20 * 4, "only what has changed");
            let (left, top, width) = (frame.left as usize, frame.top as usize, frame.width as usize);
            for (k, pixel) in frame.buffer.chunks_exact(4).enumerate().filter(|(_, pixel)| pixel[3] > 0) {
                let at = 3 * ((top + k / width) * 40 + left + k % width);
                canvas[at..at + 3].copy_from_slice(&pixel[..3]);
            }
            assert!(canvas == drawing.paint().pixels, "frame {number}");
        }
        assert!(decoder.read_next_frame().unwrap().is_none());
        assert!(gif(&[], 8, 100).unwrap().is_empty());
    }

    /// A handful of pixels in a colour of its own beside thousands of shades of another.
    #[test]
    fn what_is_rare_and_different_keeps_its_colour() {
        let shades = (0..4000_usize).map(|k| [(k % 250) as u8, (k / 250 * 16) as u8, 0]);
        let mut pixels: Vec<u8> = shades.flat_map(|rgb| [rgb, rgb]).flatten().collect();
        pixels.extend([10, 20, 250].repeat(4));
        let image = Image { width: 8004, height: 1, pixels };
        let palette = Palette::of(std::slice::from_ref(&image));
        assert_eq!(palette.colours.len(), COLOURS);
        let indices = palette.indices(&image);
        assert_eq!(palette.colours[usize::from(indices[8003])], [10, 20, 250]);
    }
}
