//! Coverage by name, after the Cryptomatte specification of J. Friedman and A. C. Jones, Psyop (version 1.2.0): names are hashed with
//! MurmurHash3 to 32 bits that are read as a float, and a pixel has pairs of id and coverage by falling coverage.

/// Pairs that a pixel is delivered with.
pub const LEVELS: usize = 6;

/// Objects that are told apart while a pixel is drawn: those that it shows first. Parts of one object in several materials are several.
pub(crate) const SLOTS: usize = 10;

/// MurmurHash3_x86_32 of a name, seed 0 (A. Appleby).
pub fn hash(name: &str) -> u32 {
    let scramble = |k: u32| k.wrapping_mul(0xcc9e_2d51).rotate_left(15).wrapping_mul(0x1b87_3593);
    let bytes = name.as_bytes();
    let (blocks, rest) = bytes.as_chunks::<4>();
    let mut h = 0_u32;
    for block in blocks {
        h = (h ^ scramble(u32::from_le_bytes(*block))).rotate_left(13).wrapping_mul(5).wrapping_add(0xe654_6b64);
    }
    if !rest.is_empty() {
        h ^= scramble(rest.iter().rev().fold(0, |k, byte| (k << 8) | u32::from(*byte)));
    }
    h ^= bytes.len() as u32;
    h = (h ^ (h >> 16)).wrapping_mul(0x85eb_ca6b);
    h = (h ^ (h >> 13)).wrapping_mul(0xc2b2_ae35);
    h ^ (h >> 16)
}

/// The float of a hash: neither zero, nor denormal, infinite or none at all.
pub fn id(hash: u32) -> f32 {
    let exponent = ((hash >> 23) & 0xff).clamp(1, 254);
    f32::from_bits((hash & 0x807f_ffff) | (exponent << 23))
}

/// Pairs of id and coverage of one pixel, from ids and the samples that showed them, which may repeat.
pub(crate) fn ranks(found: impl Iterator<Item = (f32, u32)>, samples: u32) -> [f32; 2 * LEVELS] {
    let mut counts: Vec<(f32, u32)> = Vec::with_capacity(SLOTS);
    for (id, count) in found {
        match counts.iter_mut().find(|(known, _)| known.to_bits() == id.to_bits()) {
            Some((_, sum)) => *sum += count,
            None => counts.push((id, count)),
        }
    }
    // Equal shares by id, so that the order of drawing does not show.
    counts.sort_by(|a, b| b.1.cmp(&a.1).then(a.0.total_cmp(&b.0)));
    let mut pairs = [0.0; 2 * LEVELS];
    for (pair, (id, count)) in pairs.as_chunks_mut::<2>().0.iter_mut().zip(counts) {
        *pair = [id, count as f32 / samples as f32];
    }
    pairs
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hashes_are_murmurs() {
        // Published values of MurmurHash3_x86_32 with seed 0.
        for (name, expected) in [
            ("", 0),
            ("test", 0xba6b_d213),
            ("Hello, world!", 0xc036_3e43),
            ("The quick brown fox jumps over the lazy dog", 0x2e4f_f723),
        ] {
            assert_eq!(hash(name), expected, "{name}");
        }
    }

    #[test]
    fn ids_are_finite_normal_numbers() {
        for hash in [0, 1, 0x7f80_0000, 0xff80_0001, 0x8000_0000, u32::MAX, 0x1234_5678] {
            assert!(id(hash).is_normal(), "{hash:x}");
        }
        assert_eq!(id(0x1234_5678).to_bits(), 0x1234_5678);
    }

    #[test]
    fn ranks_fall_and_parts_of_one_name_add_up() {
        let pairs = ranks([(1.0, 2), (3.0, 5), (1.0, 4), (-2.0, 5)].into_iter(), 16);
        assert_eq!(pairs[..6], [1.0, 0.375, -2.0, 0.3125, 3.0, 0.3125]);
        assert_eq!(pairs[6..], [0.0; 6]);
    }
}
