//! The frames of a run on disk: positions and plastic volume ratios, in f32, whole or not at all.
//!
//! Layout, little-endian: the 16 bytes `snowlab-frames-1`; u32 D, u32 frames, u64 particles; f64 x D origin [m]; f64 x particles
//! masses [kg]; then for each frame f64 time [s], f32 x D x particles positions less the origin [m], f32 x particles J_P.
//! In `frames.bin` the case's signature follows ([`crate::store::sign`]). Particles stand in the order of their ids.

use snowlab_solver::{Real, State, Vector};

const MAGIC: &[u8; 16] = b"snowlab-frames-1";

/// All frames of one run.
#[derive(Clone, Debug, PartialEq)]
pub struct Frames<const D: usize> {
    /// What positions count from [m].
    pub origin: Vector<f64, D>,
    /// Masses [kg].
    pub masses: Vec<f64>,
    /// The frames in the order of time.
    pub frames: Vec<Frame<D>>,
}

/// One frame. Measuring and drawing see the same f32 positions: resolved to 1e-7 of the scene's size.
#[derive(Clone, Debug, PartialEq)]
pub struct Frame<const D: usize> {
    /// Time [s].
    pub time: f64,
    /// Positions less the origin [m].
    pub positions: Vec<[f32; D]>,
    /// Plastic volume ratios.
    pub plastic_ratios: Vec<f32>,
}

impl<const D: usize> Frame<D> {
    /// The particles of `state` as a frame.
    pub fn of<T: Real>(state: &State<T, D>) -> Self {
        let order = state.by_id();
        let position = |p: usize| std::array::from_fn(|k| state.motion.position[p][k].as_f64() as f32);
        Frame {
            time: state.time,
            positions: order.iter().map(|&p| position(p)).collect(),
            plastic_ratios: order.iter().map(|&p| state.motion.plastic_ratio[p].as_f64() as f32).collect(),
        }
    }

    /// Positions in f64, less the frames' origin [m].
    pub fn points(&self) -> Vec<Vector<f64, D>> {
        self.positions.iter().map(|x| Vector::from_fn(|k, _| f64::from(x[k]))).collect()
    }
}

impl<const D: usize> Frames<D> {
    /// No frames yet of the particles of `state`.
    pub fn new<T: Real>(state: &State<T, D>) -> Self {
        let masses = state.by_id().into_iter().map(|p| state.constants.mass[p].as_f64()).collect();
        Frames { origin: state.origin, masses, frames: Vec::new() }
    }

    /// The bytes that are written.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut bytes = MAGIC.to_vec();
        bytes.extend((D as u32).to_le_bytes());
        bytes.extend((self.frames.len() as u32).to_le_bytes());
        bytes.extend((self.masses.len() as u64).to_le_bytes());
        self.origin.iter().chain(&self.masses).for_each(|value| bytes.extend(value.to_le_bytes()));
        for frame in &self.frames {
            bytes.extend(frame.time.to_le_bytes());
            let values = frame.positions.iter().flatten().chain(&frame.plastic_ratios);
            values.for_each(|value| bytes.extend(value.to_le_bytes()));
        }
        bytes
    }

    /// The frames of such bytes.
    ///
    /// # Errors
    /// In which way the bytes are of another dimension, cut short or changed.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, String> {
        let mut rest = bytes.strip_prefix(MAGIC).ok_or("it is not a file of frames of this version")?;
        let dimension = u32::from_le_bytes(take(&mut rest)?);
        if dimension as usize != D {
            return Err(format!("it has {dimension} dimensions, not {D}"));
        }
        let frames = u32::from_le_bytes(take(&mut rest)?) as usize;
        let particles = u64::from_le_bytes(take(&mut rest)?) as usize;
        let per_frame = particles.checked_mul(4 * (D + 1)).and_then(|b| b.checked_add(8));
        let expected =
            per_frame.and_then(|b| b.checked_mul(frames)).and_then(|b| b.checked_add(8 * (D + particles)));
        if expected != Some(rest.len()) {
            return Err("its length does not fit its header".into());
        }
        let mut origin = Vector::<f64, D>::zeros();
        for value in origin.iter_mut() {
            *value = f64::from_le_bytes(take(&mut rest)?);
        }
        let masses = (0..particles)
            .map(|_| Ok(f64::from_le_bytes(take(&mut rest)?)))
            .collect::<Result<_, String>>()?;
        let frames = (0..frames).map(|_| read_frame(&mut rest, particles)).collect::<Result<_, String>>()?;
        Ok(Frames { origin, masses, frames })
    }
}

fn read_frame<const D: usize>(rest: &mut &[u8], particles: usize) -> Result<Frame<D>, String> {
    let time = f64::from_le_bytes(take(rest)?);
    let mut positions = vec![[0.0; D]; particles];
    for value in positions.iter_mut().flatten() {
        *value = f32::from_le_bytes(take(rest)?);
    }
    let mut plastic_ratios = vec![0.0; particles];
    for value in &mut plastic_ratios {
        *value = f32::from_le_bytes(take(rest)?);
    }
    Ok(Frame { time, positions, plastic_ratios })
}

fn take<const N: usize>(rest: &mut &[u8]) -> Result<[u8; N], String> {
    let (head, tail) = rest.split_first_chunk::<N>().ok_or("it is cut short")?;
    *rest = tail;
    Ok(*head)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::store::{sign, verify};

    fn frames() -> Frames<2> {
        Frames {
            origin: Vector::<f64, 2>::new(1.0, -2.0),
            masses: vec![0.5, 0.25],
            frames: vec![Frame {
                time: 0.1,
                positions: vec![[1.0, 2.0], [3.0, 4.0]],
                plastic_ratios: vec![1.0, 0.5],
            }],
        }
    }

    #[test]
    fn what_is_written_is_read() {
        assert_eq!(Frames::from_bytes(&frames().to_bytes()).unwrap(), frames());
    }

    #[test]
    fn every_cut_and_every_flipped_bit_is_noticed() {
        let read = |bytes: &[u8]| verify("case", bytes).and_then(Frames::<2>::from_bytes);
        let bytes = sign("case", frames().to_bytes());
        assert_eq!(read(&bytes), Ok(frames()));
        for length in 0..bytes.len() {
            assert!(read(&bytes[..length]).is_err(), "cut to {length}");
        }
        for bit in 0..8 * bytes.len() {
            let mut changed = bytes.clone();
            changed[bit / 8] ^= 1 << (bit % 8);
            assert!(read(&changed).is_err(), "bit {bit}");
        }
        assert!(verify("other case", &bytes).is_err());
        assert!(Frames::<3>::from_bytes(&frames().to_bytes()).unwrap_err().contains("2 dimensions"));
    }
}
