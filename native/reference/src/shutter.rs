//! What moves while the shutter is open.

use lisle_core::Yarns;
use lisle_core::sampling::{Use, pair};
use lisle_core::scene::{Object, Scene, SceneError, between};

use crate::Error;

/// A scene at even steps over the time that the shutter is open.
pub(crate) struct Shutter {
    steps: Vec<Scene>,
    /// Whether yarns or objects move, not only the camera.
    moves_objects: bool,
}

fn same_rest(a: &Yarns, b: &Yarns) -> bool {
    std::ptr::eq(a.strands().lengths(), b.strands().lengths()) && std::ptr::eq(a.strands().radii(), b.strands().radii())
}

impl Shutter {
    /// Checks steps; there must be one.
    pub fn new(steps: &[Scene]) -> Result<Self, Error> {
        let invalid = |what: String, reason: String| Err(Error::Scene(SceneError::Input { what, reason }));
        let Some(first) = steps.first() else {
            return invalid("time steps".into(), "there are none".into());
        };
        let mut moves_objects = false;
        for (number, step) in steps.iter().enumerate() {
            step.validate()?;
            if step.objects.len() != first.objects.len() {
                let (here, there) = (first.objects.len(), step.objects.len());
                return invalid(
                    format!("time step {number}"),
                    format!("{there} objects, expected {here} as at the first"),
                );
            }
            for (a, b) in first.objects.iter().zip(&step.objects) {
                if !same_rest(&a.yarns, &b.yarns) {
                    return invalid(
                        format!("time step {number}, object \"{}\"", a.name),
                        "its yarns have another rest shape than at the first: make them with with_points".into(),
                    );
                }
                let is_still =
                    std::ptr::eq(a.yarns.points(), b.yarns.points()) && a.world_from_object == b.world_from_object;
                moves_objects |= !is_still;
            }
        }
        Ok(Self { steps: steps.to_vec(), moves_objects })
    }

    /// All of them.
    pub fn steps(&self) -> &[Scene] {
        &self.steps
    }

    /// Whether anything moves at all.
    pub fn is_moving(&self) -> bool {
        self.steps.len() > 1
    }

    /// Whether yarns or objects move, not only the camera.
    pub fn moves_objects(&self) -> bool {
        self.moves_objects
    }

    /// The scene at the time of a sample, the middle for the first: those that the renderer's have. Yarns, objects and camera move evenly
    /// between steps; all else is as at the first.
    pub fn at(&self, sample: u32, seed: u32) -> Result<Scene, Error> {
        let last = self.steps.len() - 1;
        if last == 0 {
            return Ok(self.steps[0].clone());
        }
        let place = pair(sample, seed, Use::Time)[0] * last as f64;
        let step = (place as usize).min(last - 1);
        let (a, b, share) = (&self.steps[step], &self.steps[step + 1], place - step as f64);
        let objects = a.objects.iter().zip(&b.objects).map(|(a, b)| object_between(a, b, share));
        let objects = objects.collect::<Result<_, _>>()?;
        Ok(Scene { objects, camera: a.camera.between(&b.camera, share), ..self.steps[0].clone() })
    }
}

fn object_between(a: &Object, b: &Object, share: f64) -> Result<Object, Error> {
    let world_from_object = between(&a.world_from_object, &b.world_from_object, share);
    let mut object = Object { world_from_object, ..a.clone() };
    if !std::ptr::eq(a.yarns.points(), b.yarns.points()) {
        let mix = |(a, b): (&[f32; 3], &[f32; 3])| [0, 1, 2].map(|c| a[c] + (b[c] - a[c]) * share as f32);
        let points: Vec<[f32; 3]> = a.yarns.points().iter().zip(b.yarns.points()).map(mix).collect();
        let moved = a.yarns.with_points(&points).map_err(|error| {
            Error::Scene(SceneError::Input { what: format!("object \"{}\"", a.name), reason: error.to_string() })
        })?;
        object.yarns = std::sync::Arc::new(moved);
    }
    Ok(object)
}
