//! Images as PNG files: with all their colours, or smaller with few. Without a time stamp: same image, same bytes.

use std::collections::BTreeMap;

use super::drawing::Drawing;
use super::raster::Image;

impl Drawing {
    /// The figure as a PNG file; see [`Image::png`].
    pub fn png(&self) -> Vec<u8> {
        self.paint().png()
    }
}

impl Image {
    /// The image as a PNG file, eight bits a channel.
    pub fn png(&self) -> Vec<u8> {
        let kind = Kind { colour: png::ColorType::Rgb, depth: png::BitDepth::Eight, palette: Vec::new() };
        self.encode(kind, &self.pixels)
    }

    /// The image as a PNG file with a palette of at most `most` colours (2 to 256). An image of no more keeps its own; of others, each pixel takes
    /// the colour of more than half of those alike, or else their mean, so that what is flat keeps its colour from picture to picture. To find those alike, boxes of colours are cut in two at their mean, across the axis along which they vary most, beginning with the
    /// box that varies most (Heckbert 1982, with variances in place of extents as in Wan, Wong & Prusinkiewicz 1988). A colour weighs as the square root of its
    /// pixels (chosen: a small piece keeps its colour beside a large one, and a colour bar its shades).
    pub fn indexed_png(&self, most: usize) -> Vec<u8> {
        let most = most.clamp(2, 256);
        let pixels = || self.pixels.chunks_exact(3).map(|p| [p[0], p[1], p[2]]);
        let mut counts: BTreeMap<[u8; 3], u32> = BTreeMap::new();
        pixels().for_each(|colour| *counts.entry(colour).or_default() += 1);
        let mut boxes = vec![Colours::of(counts.into_iter().collect())];
        while boxes.len() < most {
            let widest = (0..boxes.len()).max_by(|a, b| boxes[*a].variation.total_cmp(&boxes[*b].variation));
            let Some(widest) = widest.filter(|index| boxes[*index].variation > 0.0) else { break };
            let (low, high) = boxes.swap_remove(widest).halves();
            boxes.extend([low, high]);
        }
        let mut index_of = BTreeMap::new();
        for (index, colours) in boxes.iter().enumerate() {
            index_of.extend(colours.counts.iter().map(|(colour, _)| (*colour, index as u8)));
        }
        let indices: Vec<u8> = pixels().map(|colour| index_of[&colour]).collect();
        let palette = boxes.iter().flat_map(Colours::shown).collect();
        let colour = png::ColorType::Indexed;
        if boxes.len() > 16 {
            return self.encode(Kind { colour, depth: png::BitDepth::Eight, palette }, &indices);
        }
        // Two pixels a byte, the left one in the upper half; a row begins with a byte of its own (PNG specification, 7.2).
        let packed: Vec<u8> = indices
            .chunks_exact(self.width)
            .flat_map(|row| row.chunks(2).map(|pair| (pair[0] << 4) | pair.get(1).copied().unwrap_or(0)))
            .collect();
        self.encode(Kind { colour, depth: png::BitDepth::Four, palette }, &packed)
    }

    fn encode(&self, kind: Kind, data: &[u8]) -> Vec<u8> {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, self.width as u32, self.height as u32);
        encoder.set_color(kind.colour);
        encoder.set_depth(kind.depth);
        if !kind.palette.is_empty() {
            encoder.set_palette(kind.palette);
        }
        encoder.set_compression(png::Compression::Balanced);
        // Flat areas and text pack best without a filter (measured: 10 to 30 % below the adaptive ones).
        encoder.set_filter(png::Filter::NoFilter);
        let written = encoder.write_header().and_then(|mut writer| {
            writer.write_image_data(data)?;
            writer.finish()
        });
        written.expect("writing to memory fails only for a size of zero, which an image never has");
        bytes
    }
}

/// How pixels are written.
struct Kind {
    colour: png::ColorType,
    depth: png::BitDepth,
    /// Red, green and blue of each index; empty without a palette.
    palette: Vec<u8>,
}

/// Colours that become one, with the number of pixels of each.
struct Colours {
    counts: Vec<([u8; 3], u32)>,
    mean: [f64; 3],
    /// The channel that varies most.
    axis: usize,
    /// Weighted sum of the squared distance of that channel from its mean; 0 for one colour.
    variation: f64,
}

impl Colours {
    fn of(counts: Vec<([u8; 3], u32)>) -> Self {
        let weight = |count: &u32| f64::from(*count).sqrt();
        let total: f64 = counts.iter().map(|(_, count)| weight(count)).sum();
        let sum = |value: &dyn Fn(&[u8; 3]) -> f64| -> f64 {
            counts.iter().map(|(colour, count)| value(colour) * weight(count)).sum()
        };
        let mean = [0, 1, 2].map(|k| sum(&|colour| f64::from(colour[k])) / total);
        let spread = [0, 1, 2].map(|k| sum(&|colour| (f64::from(colour[k]) - mean[k]).powi(2)));
        let axis = (0..3).max_by(|a, b| spread[*a].total_cmp(&spread[*b])).unwrap_or(0);
        let variation = if counts.len() > 1 { spread[axis] } else { 0.0 };
        Colours { counts, mean, axis, variation }
    }

    /// The colour that stands for all.
    fn shown(&self) -> [u8; 3] {
        let pixels: u32 = self.counts.iter().map(|(_, count)| count).sum();
        let common = self.counts.iter().find(|(_, count)| 2 * count > pixels);
        common.map_or(self.mean.map(|v| v.round() as u8), |(colour, _)| *colour)
    }

    /// Those below the mean and those above it; neither is empty where there are two colours, which differ along the axis.
    fn halves(self) -> (Self, Self) {
        let (axis, mean) = (self.axis, self.mean[self.axis]);
        let (low, high) = self.counts.into_iter().partition(|(colour, _)| f64::from(colour[axis]) <= mean);
        (Colours::of(low), Colours::of(high))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Size and pixels, red green blue, of a PNG file.
    fn read(bytes: &[u8]) -> (png::ColorType, usize, Vec<u8>) {
        let mut decoder = png::Decoder::new(std::io::Cursor::new(bytes));
        let kind = decoder.read_header_info().expect("a PNG file").color_type;
        decoder.set_transformations(png::Transformations::EXPAND);
        let mut reader = decoder.read_info().expect("a PNG file");
        let mut pixels = vec![0; reader.output_buffer_size().expect("it fits")];
        reader.next_frame(&mut pixels).expect("whole");
        let colours = reader.info().palette.as_ref().map_or(0, |palette| palette.len() / 3);
        (kind, colours, pixels)
    }

    /// 5 x 3 pixels, so that rows of half bytes end with a spare half.
    fn image(pixel: impl Fn(usize) -> [u8; 3]) -> Image {
        Image { width: 5, height: 3, pixels: (0..15).flat_map(pixel).collect() }
    }

    #[test]
    fn few_colours_are_kept_to_the_byte() {
        for colours in [1, 3, 15] {
            let image = image(|k| [(k % colours) as u8 * 17, 3, 200 - (k % colours) as u8]);
            let (kind, size, pixels) = read(&image.indexed_png(256));
            assert_eq!((kind, size), (png::ColorType::Indexed, colours));
            assert_eq!(pixels, image.pixels);
            assert_eq!(read(&image.png()), (png::ColorType::Rgb, 0, image.pixels.clone()));
        }
    }

    #[test]
    fn many_colours_become_the_means_of_those_alike() {
        let image = image(|k| if k < 7 { [k as u8, 0, 0] } else { [100 + k as u8, 0, 0] });
        let (_, size, pixels) = read(&image.indexed_png(2));
        assert_eq!(size, 2);
        let expected: Vec<u8> = (0..15).flat_map(|k| [if k < 7 { 3 } else { 111 }, 0, 0]).collect();
        assert_eq!(pixels, expected, "means of 0 to 6 and of 107 to 114, rounded");
    }

    #[test]
    fn what_is_flat_keeps_its_colour() {
        let image = image(|k| match k {
            0..10 => [200, 201, 202],
            10..12 => [190, 190, 190],
            _ => [0, 0, k as u8],
        });
        let (_, size, pixels) = read(&image.indexed_png(2));
        assert_eq!((size, &pixels[..36]), (2, &[200, 201, 202].repeat(12)[..]));
    }

    /// A thousand pixels of many blues leave a lone one its red.
    #[test]
    fn a_small_piece_keeps_its_colour() {
        let mut pixels: Vec<u8> =
            (0..1024_usize).flat_map(|k| [0, (k % 32) as u8, 180 + (k / 32) as u8]).collect();
        pixels[300..303].copy_from_slice(&[0xd5, 0x5e, 0]);
        let image = Image { width: 32, height: 32, pixels };
        let (_, size, read) = read(&image.indexed_png(16));
        assert_eq!((size, &read[300..303]), (16, &[0xd5, 0x5e, 0][..]));
    }

    #[test]
    fn a_palette_of_256_is_written_a_byte_a_pixel() {
        let pixels: Vec<u8> = (0..400_usize).flat_map(|k| [(k / 2) as u8, (k % 2) as u8 * 255, 9]).collect();
        let image = Image { width: 20, height: 20, pixels };
        let (_, size, read) = read(&image.indexed_png(256));
        assert_eq!(size, 256);
        let worst = image.pixels.iter().zip(&read).map(|(a, b)| a.abs_diff(*b)).max();
        assert!(worst <= Some(2), "{worst:?}");
    }
}
