//! The tiles of a picture.

use crate::aov::Planes;
use crate::device::Gpu;

/// Most pixels of a tile.
const TILE_PIXELS: u64 = 1 << 22;

/// What a tile may measure.
#[derive(Clone, Copy, Debug)]
pub(super) struct TileLimits {
    /// Pixels, 2048 or more.
    pub pixels: u64,
    /// Along a side.
    pub side: u32,
}

impl TileLimits {
    /// So that one binding holds all planes, and a texture the tile.
    pub fn new(gpu: &Gpu, planes: &Planes) -> Self {
        let most = gpu.limits.max_storage_buffer_binding_size / (4 * u64::from(planes.count.max(1)));
        Self { pixels: most.clamp(2048, TILE_PIXELS), side: gpu.limits.max_texture_dimension_2d }
    }
}

/// Rectangles within limits that cover a region: left, top, width, height.
pub(super) fn tiles([left, top, width, height]: [u32; 4], limits: TileLimits) -> Vec<[u32; 4]> {
    let tile_width = width.min(2048).min(limits.side);
    let tile_height = height.min((limits.pixels / u64::from(tile_width)) as u32).min(limits.side);
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_cover_a_region_once() {
        const LIMITS: TileLimits = TileLimits { pixels: TILE_PIXELS, side: 16384 };
        for (region, limits) in [
            ([3, 5, 5000, 4100], LIMITS),
            ([0, 0, 10, 65536], LIMITS),
            ([7, 1, 300, 5000], TileLimits { pixels: 2048, side: 16384 }),
            ([1, 2, 700, 900], TileLimits { pixels: TILE_PIXELS, side: 256 }),
        ] {
            let [x0, y0, width, height] = region;
            let mut seen = vec![0_u8; width as usize * height as usize];
            for [left, top, w, h] in tiles(region, limits) {
                assert!(u64::from(w) * u64::from(h) <= limits.pixels && w.max(h) <= limits.side, "{w} × {h}");
                for y in top..top + h {
                    for x in left..left + w {
                        seen[((y - y0) * width + x - x0) as usize] += 1;
                    }
                }
            }
            assert!(seen.iter().all(|n| *n == 1), "{region:?}");
        }
    }
}
