use lisle_core::scene::Shading;

use crate::Error;

/// How a reference picture is made.
#[derive(Clone, Debug)]
pub struct Settings {
    /// Pixels of the whole frame.
    pub size: [u32; 2],
    /// Part of the frame to draw: left, top, width, height in pixels, from the top left; `None` for all.
    pub region: Option<[u32; 4]>,
    /// Independent paths per pixel, ≥ 1.
    pub samples: u32,
    /// Seed of all random numbers.
    pub seed: u32,
    /// Most times that light is scattered on its way, ≥ 1: 1 is what the renderer draws. `None` for as often as it likes, by Russian roulette.
    pub bounces: Option<u32>,
    /// Shading model.
    pub shading: Shading,
    /// Leaves the background transparent, otherwise it is the ambient radiance.
    pub transparent: bool,
    /// Width of the Blackman–Harris pixel filter, pixels; 0 for a point sample at the centre of each pixel.
    pub filter_width: f32,
    /// How far a chord may depart from its fiber, radii of the fiber, 0.001 to 10.
    pub chord_error: f64,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            size: [1280, 960],
            region: None,
            samples: 64,
            seed: 0,
            bounces: None,
            shading: Shading::Physical,
            transparent: true,
            filter_width: 1.5,
            chord_error: 0.25,
        }
    }
}

/// Most pixels of one picture: with its sums, 17 GiB of memory.
const MOST_PIXELS: u64 = 1 << 27;

impl Settings {
    /// Checks every setting; the region to draw.
    pub(crate) fn check(&self) -> Result<[u32; 4], Error> {
        let invalid = |what: &'static str, reason: String| Err(Error::Input { what, reason });
        let [width, height] = self.size;
        if width == 0 || height == 0 || width > 65536 || height > 65536 {
            return invalid("size", format!("{width}×{height}: expected 1 to 65536 pixels each"));
        }
        let region = self.region.unwrap_or([0, 0, width, height]);
        let [left, top, w, h] = region;
        if w == 0 || h == 0 || left.saturating_add(w) > width || top.saturating_add(h) > height {
            return invalid("region", format!("{w}×{h} at ({left}, {top}) is not inside of {width}×{height} pixels"));
        }
        if u64::from(w) * u64::from(h) > MOST_PIXELS {
            return invalid("region", format!("{w}×{h} pixels are more than {MOST_PIXELS}: draw them in parts"));
        }
        if self.samples == 0 {
            return invalid("samples", "0: expected at least 1".into());
        }
        if self.bounces == Some(0) {
            return invalid("bounces", "0: expected at least 1".into());
        }
        if !(0.0..=100.0).contains(&self.filter_width) {
            return invalid("filter_width", format!("{}: expected 0 to 100 pixels", self.filter_width));
        }
        Ok(region)
    }
}
