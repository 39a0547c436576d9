//! Changes of a file that know nothing of what it means but where its lines and numbers are.

use std::ops::Range;

use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use super::telling::{NUMBERS_IN_TEXT, one_of};

/// Bytes that mean something to some reader.
const TELLING: &[u8] = b"0123456789-+.,;:=\t\n\r \"'#[]{}_\\exyzINnaf\0\xff\xef\x80";
/// The longest span that is moved (chosen: a few lines; longer ones make large files).
const LONGEST_SPAN: usize = 200;

/// `valid` with one to four changes, some of which bring in a part of one of `others`.
pub fn mutated(valid: &[u8], others: &[&[u8]], random: &mut ChaCha8Rng) -> Vec<u8> {
    let mut bytes = valid.to_vec();
    for _ in 0..random.random_range(1..=4) {
        change(&mut bytes, others, random);
    }
    bytes
}

fn change(bytes: &mut Vec<u8>, others: &[&[u8]], random: &mut ChaCha8Rng) {
    let place = random.random_range(0..=bytes.len());
    let byte = if random.random() { random.random() } else { TELLING[random.random_range(0..TELLING.len())] };
    match random.random_range(0..24) {
        0..=4 if place < bytes.len() => bytes[place] = byte,
        5..=6 if place < bytes.len() => bytes[place] ^= 1 << random.random_range(0..8),
        7..=8 => bytes.insert(place, byte),
        9..=10 if place < bytes.len() => drop(bytes.remove(place)),
        11 => bytes.truncate(place.max(bytes.len() / 2)),
        12 => drop(bytes.drain(span(bytes, random))),
        13 => move_span(bytes.clone().as_slice(), bytes, random),
        14..=15 if !others.is_empty() => move_span(one_of(others, random), bytes, random),
        16..=17 => drop(bytes.drain(line(bytes, place))),
        18 => {
            let line = bytes[line(bytes, place)].to_vec();
            bytes.splice(place..place, line);
        }
        _ => {
            let number = number_from(bytes, place);
            bytes.splice(number, one_of(&NUMBERS_IN_TEXT, random).bytes());
        }
    }
}

/// Puts some span of `source` into `bytes` somewhere.
fn move_span(source: &[u8], bytes: &mut Vec<u8>, random: &mut ChaCha8Rng) {
    let place = random.random_range(0..=bytes.len());
    bytes.splice(place..place, source[span(source, random)].iter().copied());
}

fn span(bytes: &[u8], random: &mut ChaCha8Rng) -> Range<usize> {
    let start = random.random_range(0..=bytes.len());
    start..(start + random.random_range(0..=LONGEST_SPAN)).min(bytes.len())
}

/// The line that holds `place`, with its end.
fn line(bytes: &[u8], place: usize) -> Range<usize> {
    let start = bytes[..place].iter().rposition(|&b| b == b'\n').map_or(0, |end| end + 1);
    let end = bytes[place..].iter().position(|&b| b == b'\n').map_or(bytes.len(), |end| place + end + 1);
    start..end
}

/// The first number at `place` or behind it; an empty range where there is none.
fn number_from(bytes: &[u8], place: usize) -> Range<usize> {
    let is_part = |b: &u8| b.is_ascii_digit() || b"+-.".contains(b);
    let start =
        bytes[place..].iter().position(u8::is_ascii_digit).map_or(bytes.len(), |digits| place + digits);
    let before = bytes[..start].iter().rev().take_while(|b| is_part(b)).count();
    let behind = bytes[start..].iter().take_while(|b| is_part(b) || b.eq_ignore_ascii_case(&b'e')).count();
    start - before..start + behind
}
