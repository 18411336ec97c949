use std::sync::Arc;

use glam::{DMat4, Vec3};

use super::{Labels, SceneError};

/// Triangles, object space.
#[derive(Debug, PartialEq)]
pub struct Triangles {
    positions: Vec<[f32; 3]>,
    triangles: Vec<[u32; 3]>,
    normals: Option<Vec<[[f32; 3]; 3]>>,
    uvs: Option<Vec<[[f32; 2]; 3]>>,
}

impl Triangles {
    /// Corners by their places in `positions`; `normals` at the three corners of each triangle, of any length, or flat shading without.
    ///
    /// # Errors
    /// [`SceneError`] for a corner that does not exist, a position or a normal that is not finite, and normals that are not as many.
    pub fn new(
        positions: Vec<[f32; 3]>,
        triangles: Vec<[u32; 3]>,
        normals: Option<Vec<[[f32; 3]; 3]>>,
    ) -> Result<Self, SceneError> {
        let invalid = |reason: String| Err(SceneError::input("mesh", reason));
        let is_finite = |v: &[f32; 3]| v.iter().all(|c| c.is_finite());
        if let Some(place) = positions.iter().position(|p| !is_finite(p)) {
            return invalid(format!("position {place} is {:?}", positions[place]));
        }
        if let Some(place) = triangles.iter().position(|t| t.iter().any(|corner| *corner as usize >= positions.len())) {
            let (corners, count) = (triangles[place], positions.len());
            return invalid(format!("triangle {place} is {corners:?}, but there are {count} positions"));
        }
        if let Some(normals) = &normals {
            if normals.len() != triangles.len() {
                return invalid(format!("{} triangles with normals for {}", triangles.len(), normals.len()));
            }
            if let Some(place) = normals.iter().position(|corners| !corners.iter().all(is_finite)) {
                return invalid(format!("the normals of triangle {place} are {:?}", normals[place]));
            }
        }
        Ok(Self { positions, triangles, normals, uvs: None })
    }

    /// The same with places on a [`Texture`] at the three corners of each triangle.
    ///
    /// # Errors
    /// [`SceneError`] for places that are not as many, or not finite.
    pub fn with_uvs(self, uvs: Vec<[[f32; 2]; 3]>) -> Result<Self, SceneError> {
        let invalid = |reason: String| Err(SceneError::input("mesh", reason));
        if uvs.len() != self.triangles.len() {
            return invalid(format!("{} triangles with UV coordinates for {}", self.triangles.len(), uvs.len()));
        }
        if let Some(place) = uvs.iter().position(|corners| !corners.as_flattened().iter().all(|c| c.is_finite())) {
            return invalid(format!("the UV coordinates of triangle {place} are {:?}", uvs[place]));
        }
        Ok(Self { uvs: Some(uvs), ..self })
    }

    /// All positions.
    pub fn positions(&self) -> &[[f32; 3]] {
        &self.positions
    }

    /// Corners by their places among the positions.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// At the corners of each triangle; `None` if it is flat.
    pub fn normals(&self) -> Option<&[[[f32; 3]; 3]]> {
        self.normals.as_deref()
    }

    /// Likewise, places on a texture.
    pub fn uvs(&self) -> Option<&[[[f32; 2]; 3]]> {
        self.uvs.as_deref()
    }
}

/// A picture of colours on a surface, repeated endlessly. The first texel's corner lies at (0, 0), the last one's at (1, 1); between the middles
/// of texels it is interpolated.
#[derive(Debug, PartialEq)]
pub struct Texture {
    size: [u32; 2],
    texels: Vec<u32>,
}

impl Texture {
    /// Width, height, and sRGB codes (IEC 61966-2-1) row by row from the bottom, red in the lowest byte; the highest one is left out.
    ///
    /// # Errors
    /// [`SceneError`] for a size that does not fit.
    pub fn new(size: [u32; 2], texels: Vec<u32>) -> Result<Self, SceneError> {
        let [width, height] = size;
        if width == 0 || height == 0 || texels.len() as u64 != u64::from(width) * u64::from(height) {
            return Err(SceneError::input("texture", format!("{} texels are not {width}×{height}", texels.len())));
        }
        Ok(Self { size, texels })
    }

    /// Width and height.
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// Row by row from the bottom.
    pub fn texels(&self) -> &[u32] {
        &self.texels
    }
}

/// What the camera sees of a mesh. All kinds hide what is behind them and cast shadows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum MeshKind {
    /// A matt surface of one colour.
    #[default]
    Shaded,
    /// Only the shadows on it, as coverage.
    ShadowCatcher,
    /// A hole in the picture.
    Holdout,
}

/// Triangles at a place.
#[derive(Clone, Debug)]
pub struct Mesh {
    /// Name for messages.
    pub name: String,
    /// Number delivered in the object-id pass.
    pub id: u32,
    /// For passes.
    pub labels: Labels,
    /// The surface.
    pub triangles: Arc<Triangles>,
    /// Share of the light that it gives back, scene-linear, 0 to 1.
    pub base_color: Vec3,
    /// That share by place, in its stead; needs triangles with UV coordinates. The path tracer takes `base_color` alone.
    pub texture: Option<Arc<Texture>>,
    /// What is seen of it.
    pub kind: MeshKind,
    /// Object to world.
    pub world_from_object: DMat4,
}

impl Mesh {
    pub(super) fn validate(&self) -> Result<(), SceneError> {
        let invalid = |reason: String| Err(SceneError::input(format!("mesh \"{}\"", self.name), reason));
        if !self.world_from_object.is_finite() {
            return invalid("its transform is not finite".into());
        }
        if !(self.base_color.is_finite()
            && self.base_color.min_element() >= 0.0
            && self.base_color.max_element() <= 1.0)
        {
            return invalid(format!("a base colour of {} is not from 0 to 1", self.base_color));
        }
        if self.texture.is_some() && self.triangles.uvs().is_none() {
            return invalid("its texture needs UV coordinates".into());
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refused(result: Result<(), SceneError>, expected: &str) {
        let message = result.expect_err("a refusal").to_string();
        assert!(message.contains(expected), "{message}");
    }

    #[test]
    fn what_is_no_mesh_is_refused() {
        let corners = || vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        let new = |positions, triangles, normals| Triangles::new(positions, triangles, normals).map(|_| ());
        new(corners(), vec![[0, 1, 2]], None).expect("a triangle");
        refused(new(corners(), vec![[0, 1, 2], [0, 1, 3]], None), "triangle 1 is [0, 1, 3], but there are 3");
        refused(new(vec![[0.0, f32::NAN, 0.0]], vec![], None), "position 0");
        refused(new(corners(), vec![[0, 1, 2]], Some(vec![])), "normals for 0");
        refused(new(corners(), vec![[0, 1, 2]], Some(vec![[[f32::INFINITY; 3]; 3]])), "normals of triangle 0");
        let good = Mesh {
            name: "Floor".into(),
            id: 1,
            labels: Labels::default(),
            triangles: Arc::new(Triangles::new(corners(), vec![[0, 1, 2]], None).expect("a triangle")),
            base_color: Vec3::ONE,
            texture: None,
            kind: MeshKind::Shaded,
            world_from_object: DMat4::IDENTITY,
        };
        good.validate().expect("valid");
        let texture = |size, texels| Texture::new(size, texels).map(Arc::new);
        refused(texture([2, 1], vec![0]).map(|_| ()), "1 texels are not 2×1");
        let texture = texture([1, 1], vec![0]).ok();
        refused(Mesh { texture: texture.clone(), ..good.clone() }.validate(), "texture needs UV");
        let with = |uvs| Triangles::new(corners(), vec![[0, 1, 2]], None).expect("a triangle").with_uvs(uvs);
        refused(with(vec![]).map(|_| ()), "UV coordinates for 0");
        refused(with(vec![[[f32::NAN; 2]; 3]]).map(|_| ()), "UV coordinates of triangle 0");
        let triangles = Arc::new(with(vec![[[0.0; 2]; 3]]).expect("with UV coordinates"));
        Mesh { texture, triangles, ..good.clone() }.validate().expect("valid");
        refused(Mesh { base_color: Vec3::splat(1.5), ..good.clone() }.validate(), "mesh \"Floor\": a base colour");
        refused(Mesh { world_from_object: DMat4::IDENTITY * f64::NAN, ..good }.validate(), "transform");
    }
}
