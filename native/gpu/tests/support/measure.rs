//! Numbers from pictures.

use glam::DVec3;
use lisle_gpu::{Aov, Image};

/// Whether two pictures have the same bits in every pass.
pub fn identical(a: &Image, b: &Image) -> bool {
    difference(a, b).is_none()
}

/// The first pass and pixel in which two pictures differ by a bit.
pub fn difference(a: &Image, b: &Image) -> Option<String> {
    fn first<const N: usize>(name: &str, a: &[[f32; N]], b: &[[f32; N]]) -> Option<String> {
        let bits = |v: &[f32; N]| v.map(f32::to_bits);
        let at = a.iter().zip(b).position(|(a, b)| bits(a) != bits(b))?;
        let count = a.iter().zip(b).filter(|(a, b)| bits(a) != bits(b)).count();
        Some(format!("{name}: {count} of {} pixels, first {at}: {:?}, {:?}", a.len(), a[at], b[at]))
    }
    if a.size != b.size {
        return Some(format!("size: {:?}, {:?}", a.size, b.size));
    }
    let depth = |image: &Image| image.depth.iter().map(|d| [*d]).collect::<Vec<_>>();
    let object = |image: &Image| image.object_id.iter().map(|d| [f32::from_bits(*d)]).collect::<Vec<_>>();
    first("combined", &a.combined, &b.combined)
        .or_else(|| first("depth", &depth(a), &depth(b)))
        .or_else(|| first("normal", &a.normal, &b.normal))
        .or_else(|| first("tangent", &a.tangent, &b.tangent))
        .or_else(|| first("object id", &object(a), &object(b)))
        .or_else(|| {
            type Pass = (Aov, Vec<f32>);
            let differ = |((kind, a), (other, b)): (&Pass, &Pass)| {
                let bits = |values: &[f32]| values.iter().map(|v| v.to_bits()).collect::<Vec<_>>();
                (kind != other || bits(a) != bits(b)).then(|| kind.name().to_owned())
            };
            a.aovs.iter().zip(&b.aovs).find_map(differ)
        })
}

/// The part of a picture that a region (left, top, width, height) covers.
pub fn crop(image: &Image, [left, top, width, height]: [u32; 4]) -> Image {
    fn cut<T: Copy>(values: &[T], stride: u32, [left, top, width, height]: [u32; 4]) -> Vec<T> {
        (top..top + height)
            .flat_map(|y| (left..left + width).map(move |x| (y * stride + x) as usize))
            .map(|i| values[i])
            .collect()
    }
    let (region, stride) = ([left, top, width, height], image.size[0]);
    Image {
        size: [width, height],
        combined: cut(&image.combined, stride, region),
        depth: cut(&image.depth, stride, region),
        normal: cut(&image.normal, stride, region),
        tangent: cut(&image.tangent, stride, region),
        object_id: cut(&image.object_id, stride, region),
        aovs: image
            .aovs
            .iter()
            .map(|(aov, values)| {
                let pixels: Vec<&[f32]> = values.chunks_exact(aov.channels()).collect();
                (*aov, cut(&pixels, stride, region).concat())
            })
            .collect(),
        statistics: image.statistics.clone(),
    }
}

/// Covered area, pixels.
pub fn area(image: &Image) -> f64 {
    image.combined.iter().map(|c| f64::from(c[3])).sum()
}

/// Mean colour over the covered area.
pub fn mean_color(image: &Image) -> DVec3 {
    let sum: DVec3 = image.combined.iter().map(|c| DVec3::new(c[0].into(), c[1].into(), c[2].into())).sum();
    sum / area(image).max(1e-12)
}

/// Mean of the three channels over the covered area.
pub fn brightness(image: &Image) -> f64 {
    mean_color(image).element_sum() / 3.0
}

/// Samples that are not finite in any pass.
pub fn not_finite(image: &Image) -> usize {
    let count = |values: &mut dyn Iterator<Item = f32>| values.filter(|v| !v.is_finite()).count();
    count(&mut image.combined.iter().flatten().copied())
        + count(&mut image.depth.iter().copied())
        + count(&mut image.normal.iter().flatten().copied())
        + count(&mut image.tangent.iter().flatten().copied())
}
