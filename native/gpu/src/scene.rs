//! How a scene is drawn: plain data, checked when a frame begins.

use lisle_core::scene::Shading;

use crate::frame::MOST_SKY_VIEWS;
use crate::shader::Model;

use crate::{Aov, Filter};

/// Which ambient occlusion [WuYuksel2018 §4.2].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Occlusion {
    /// Cubic in the distance from the yarn centre.
    #[default]
    Distance,
    /// Precomputed over the yarn's section.
    Table,
}

/// How it is drawn.
#[derive(Clone, Debug)]
pub struct Settings {
    /// Pixels of the whole frame.
    pub size: [u32; 2],
    /// Part of the frame to draw: left, top, width, height in pixels, from the top left; `None` for all.
    pub region: Option<[u32; 4]>,
    /// Jittered samples per pixel, ≥ 1; the most, if one of the next two stops earlier.
    pub samples: u32,
    /// Stops when the picture's noise is down to this, from 16 samples on; 0 for never. Noise is estimated from the two halves of the
    /// samples so far: half their difference, relative to the square root of the colour, as root of the mean square over all pixels that show
    /// anything. Each tile of the picture stops by itself.
    pub noise_threshold: f32,
    /// Stops when so many seconds have passed, after one sample at least; `None` for never. The picture then depends on the machine's speed.
    pub time_limit_s: Option<f64>,
    /// Shading model.
    pub shading: Shading,
    /// Photons by which light scattered more than once is precomputed for each yarn and material, with physical shading; 0 leaves it out.
    pub transport_photons: u32,
    /// Occlusion method.
    pub occlusion: Occlusion,
    /// Fibers thinner than this many pixels are merged, omega_LoD of [WuYuksel2018 Eq. 4]; 0 draws every fiber.
    pub lod_pixels: f32,
    /// Leaves the background transparent, otherwise it is the ambient radiance.
    pub transparent: bool,
    /// Shape of the pixel filter.
    pub filter: Filter,
    /// Its width, pixels; 0 for a point sample at the centre of each pixel.
    pub filter_width: f32,
    /// Times as many texels along each side of the tables of self-shadow and occlusion, 1 to 4: to tell what their own are to blame for.
    pub table_resolution: u32,
    /// Directions in which sky and other yarns are seen, over all samples at least, 1 to 8: with few samples, each takes several, so that a
    /// picture never hangs on one or two.
    pub sky_directions: u32,
    /// Texels along one side of a shadow map.
    pub shadow_resolution: u32,
    /// Seeds the sample sequence.
    pub seed: u32,
    /// The number of the first sample in its sequence: a picture of samples 0 to 7 and one of 8 to 15 make, each with half the weight, one
    /// of 0 to 15. (With fewer than `sky_directions` they take more of these each.) Sample 0 is taken at the pixel's centre, through the lens's centre.
    pub first_sample: u32,
    /// Further passes to draw, into [`crate::Image::aovs`].
    pub aovs: Vec<Aov>,
}

impl Settings {
    /// Photons that are used.
    pub(crate) fn photons(&self) -> u32 {
        if self.shading == Shading::Physical { self.transport_photons } else { 0 }
    }

    pub(crate) fn model(&self) -> Model {
        match self.shading {
            Shading::Simple => Model::Simple,
            Shading::Physical if self.photons() == 0 => Model::Physical,
            Shading::Physical => Model::Multiple,
        }
    }
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            size: [1280, 960],
            region: None,
            samples: 16,
            noise_threshold: 0.0,
            time_limit_s: None,
            shading: Shading::Physical,
            transport_photons: 500_000,
            occlusion: Occlusion::Distance,
            lod_pixels: 1.0,
            transparent: true,
            filter: Filter::default(),
            filter_width: 1.5,
            table_resolution: 1,
            sky_directions: MOST_SKY_VIEWS,
            shadow_resolution: 2048,
            seed: 0,
            first_sample: 0,
            aovs: Vec::new(),
        }
    }
}
