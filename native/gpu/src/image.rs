use crate::Aov;

/// A rendered picture. Row 0 is the top one; arrays hold `size[0] × size[1]` pixels.
#[derive(Clone, Debug)]
pub struct Image {
    /// Width and height of the drawn region.
    pub size: [u32; 2],
    /// Scene-linear Rec.709 radiance, premultiplied by alpha.
    pub combined: Vec<[f32; 4]>,
    /// Distance along the view axis of the sample at the pixel's centre; [`Image::EMPTY_DEPTH`] where it met nothing.
    pub depth: Vec<f32>,
    /// Mean surface normal, world space; zero where nothing is.
    pub normal: Vec<[f32; 3]>,
    /// Mean fiber tangent, world space, towards growing length coordinates.
    pub tangent: Vec<[f32; 3]>,
    /// Object id at the pixel's centre, 0 where nothing is.
    pub object_id: Vec<u32>,
    /// Passes that were asked for, in that order: [`Aov::channels`] values for each pixel.
    pub aovs: Vec<(Aov, Vec<f32>)>,
    /// What it took.
    pub statistics: Statistics,
}

impl Image {
    /// Depth of an empty pixel.
    pub const EMPTY_DEPTH: f32 = 1e10;
}

/// Work done for a picture.
#[derive(Clone, Debug, Default)]
pub struct Statistics {
    /// Samples of each pixel; the fewest, if tiles stopped by themselves.
    pub samples: u32,
    /// Adapter that drew it.
    pub adapter: String,
    /// Segments of yarn in the scene, instances counted each.
    pub segments: u64,
    /// (segment, fiber) pairs drawn per sample, over all tiles.
    pub fiber_segments: u64,
    /// Lines that these are drawn with; loops and hairs may take a few more.
    pub fiber_lines: u64,
    /// Bytes of GPU memory of control points and all that belongs to each of them.
    pub knot_bytes: u64,
    /// Bytes of all GPU buffers.
    pub gpu_bytes: u64,
    /// Milliseconds of GPU time per pass, all samples together; empty if the adapter has no timestamps.
    pub passes: Vec<(String, f64)>,
    /// Bytes of control-point data written for this picture: moving data alone if the yarns were known.
    pub uploaded_bytes: u64,
}
