//! The tiles of a picture.

use crate::aov::Planes;
use crate::device::Gpu;

/// Most pixels of a tile.
const TILE_PIXELS: u64 = 1 << 22;

/// Rectangles of at most so many pixels, 2048 or more, that cover a region: left, top, width, height.
pub(super) fn tiles([left, top, width, height]: [u32; 4], most: u64) -> Vec<[u32; 4]> {
    let tile_width = width.min(2048);
    let tile_height = height.min((most / u64::from(tile_width)) as u32);
    let mut tiles = Vec::new();
    for y in (0..height).step_by(tile_height as usize) {
        for x in (0..width).step_by(tile_width as usize) {
            tiles.push([left + x, top + y, tile_width.min(width - x), tile_height.min(height - y)]);
        }
    }
    tiles
}

/// Width and height that hold any of some tiles.
pub(super) fn most_of(tiles: &[[u32; 4]]) -> [u32; 2] {
    tiles.iter().fold([1, 1], |[width, height], [_, _, w, h]| [width.max(*w), height.max(*h)])
}

/// Most pixels of a tile, so that one binding holds all planes.
pub(super) fn tile_pixels(gpu: &Gpu, planes: &Planes) -> u64 {
    let most = gpu.limits.max_storage_buffer_binding_size / (4 * u64::from(planes.count.max(1)));
    most.clamp(2048, TILE_PIXELS)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_cover_a_region_once() {
        let region = [3, 5, 5000, 4100];
        let mut seen = vec![0_u8; 5000 * 4100];
        for [left, top, width, height] in tiles(region, TILE_PIXELS) {
            assert!(u64::from(width) * u64::from(height) <= TILE_PIXELS);
            for y in top..top + height {
                for x in left..left + width {
                    seen[((y - 5) * 5000 + x - 3) as usize] += 1;
                }
            }
        }
        assert!(seen.iter().all(|n| *n == 1));
    }
}
