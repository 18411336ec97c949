//! The reference beside Mitsuba 3 with its hair model, on the same fibers: means agree within the standard errors of both.
//!
//! The model is that of [Chiang2016], here after the paper; Mitsuba's pictures are in `mitsuba/hair.txt`, made by `tests/python/mitsuba_hair.py`. Light is
//! scattered once, twice, and any number of times. Directions are drawn by the model's own lobes: drawn evenly, their weights are up to 70 at each
//! scattering, and means of many scatterings lie below the truth nearly always, by more than their estimated errors.

mod support;

use std::f64::consts::{PI, TAU};
use std::ops::ControlFlow;
use std::sync::Arc;

use glam::{DMat4, DVec3, Vec3};
use lisle_core::sampling::Random;
use lisle_core::scene::{Camera, Scene};
use lisle_core::yarn::Yarn;
use lisle_core::{Curves, Yarns};
use lisle_reference::fibers::{Options, fibers};
use lisle_reference::{NearField, Reference, Settings};
use rayon::prelude::*;
use support::{lambert, object, scene, sun};

/// Hair of [Chiang2016] without tilted scales, of one absorption for all colours.
#[derive(Clone, Copy)]
struct Hair {
    longitudinal_roughness: f64,
    azimuthal_roughness: f64,
    /// Per radius.
    absorption: f64,
    eta: f64,
    /// Paths with up to so many crossings of the fiber have a lobe of their own about where a smooth fiber would send them.
    lobes: u32,
}

const HAIR: Hair = Hair { longitudinal_roughness: 0.3, azimuthal_roughness: 0.3, absorption: 0.3, eta: 1.55, lobes: 3 };

/// e^−x I₀(x), from the integral (1/π) ∫ e^(x (cos t − 1)) dt over [0, π]: of a periodic function, so that even steps converge at once.
fn scaled_bessel(x: f64) -> f64 {
    let steps = 64 + (4.0 * x.sqrt()) as u32;
    let at = |k: u32| (x * ((PI * (f64::from(k) + 0.5) / f64::from(steps)).cos() - 1.0)).exp();
    (0..steps).map(at).sum::<f64>() / f64::from(steps)
}

/// Longitudinal distribution of variance `v` [dEon2011]: (1 / (2 v sinh(1/v))) e^(−sin θ_i sin θ_o / v) I₀(cos θ_i cos θ_o / v).
fn longitudinal(sines: [f64; 2], cosines: [f64; 2], v: f64) -> f64 {
    let bessel = cosines[0] * cosines[1] / v;
    // sinh(1/v) = e^(1/v) (1 − e^(−2/v)) / 2; all exponents together are at most 0.
    let exponent = -sines[0] * sines[1] / v + bessel - 1.0 / v;
    exponent.exp() * scaled_bessel(bessel) / (v * (1.0 - (-2.0 / v).exp()))
}

/// Logistic distribution of scale `s` about 0, cut off at ±π.
fn azimuthal(angle: f64, s: f64) -> f64 {
    let angle = (angle + PI).rem_euclid(TAU) - PI;
    let tail = (-angle.abs() / s).exp();
    let within = |x: f64| 1.0 / (1.0 + (-x / s).exp());
    tail / (s * (1.0 + tail).powi(2)) / (within(PI) - within(-PI))
}

/// Fresnel reflectance of unpolarized light.
fn reflectance(cosine: f64, eta: f64) -> f64 {
    let inside = (1.0 - (1.0 - cosine * cosine) / (eta * eta)).sqrt();
    let (s, p) = ((cosine - eta * inside) / (cosine + eta * inside), (eta * cosine - inside) / (eta * cosine + inside));
    0.5 * (s * s + p * p)
}

/// Directions on a circle about the fiber's axis by a lobe: variance of the longitudes, and where its azimuths are about, if anywhere.
struct Lobe {
    /// Share of the light that leaves by it.
    attenuation: f64,
    variance: f64,
    azimuth: Option<f64>,
}

impl Hair {
    /// Scale of the logistic distribution, [Chiang2016 Eq. 8].
    fn scale(&self) -> f64 {
        let n = self.azimuthal_roughness;
        (PI / 8.0).sqrt() * (0.265 * n + 1.194 * n * n + 5.372 * n.powi(22))
    }

    /// Of light that leaves towards `wo`: R, TT, TRT, and what is reflected inside three times and more, evenly about the fiber.
    fn lobes(&self, wo: DVec3) -> [Lobe; 4] {
        let (sin_o, cos_o) = (wo.z, (1.0 - wo.z * wo.z).max(0.0).sqrt());
        // Roughness to variance, [Chiang2016 Eq. 7].
        let m = self.longitudinal_roughness;
        let v = (0.726 * m + 0.812 * m * m + 3.7 * m.powi(20)).powi(2);
        // Where on the width: the viewer's azimuth from the normal; and refracted, with the index in the section [Marschner2003].
        let gamma = wo.y.atan2(wo.x);
        let section_eta = (self.eta * self.eta - sin_o * sin_o).sqrt() / cos_o.max(1e-9);
        let gamma_t = (gamma.sin() / section_eta).clamp(-1.0, 1.0).asin();
        let cos_t = (1.0 - (sin_o / self.eta).powi(2)).sqrt();
        let transmittance = (-self.absorption * 2.0 * gamma_t.cos() / cos_t).exp();
        let fresnel = reflectance(cos_o * gamma.cos().max(0.0), self.eta);
        let mut attenuation = fresnel;
        let mut lobe = |crossings: u32, variance: f64| {
            let turns = f64::from(crossings);
            // A smooth fiber would send it there.
            let smooth = gamma + 2.0 * turns * gamma_t - 2.0 * gamma + turns * PI;
            let found = Lobe { attenuation, variance, azimuth: (crossings < self.lobes).then_some(smooth) };
            attenuation = match crossings {
                0 => (1.0 - fresnel).powi(2) * transmittance,
                _ => attenuation * fresnel * transmittance,
            };
            found
        };
        let [r, tt, trt] = [lobe(0, v), lobe(1, 0.25 * v), lobe(2, 4.0 * v)];
        let rest =
            Lobe { attenuation: attenuation / (1.0 - fresnel * transmittance), variance: 4.0 * v, azimuth: None };
        [r, tt, trt, rest]
    }
}

impl NearField for Hair {
    fn evaluate(&self, wo: DVec3, wi: DVec3) -> DVec3 {
        let cosine = |w: DVec3| (1.0 - w.z * w.z).max(0.0).sqrt();
        let (sines, cosines) = ([wo.z, wi.z], [cosine(wo), cosine(wi)]);
        let azimuth = wi.y.atan2(wi.x);
        let of_lobe = |lobe: Lobe| {
            let around = lobe.azimuth.map_or(1.0 / TAU, |about| azimuthal(azimuth - about, self.scale()));
            lobe.attenuation * longitudinal(sines, cosines, lobe.variance) * around
        };
        DVec3::splat(self.lobes(wo).into_iter().map(of_lobe).sum())
    }

    /// By the lobes themselves, so that all directions have the same weight: the longitude after [dEon2011], the azimuth by the inverse of the
    /// logistic distribution.
    fn sample(&self, wo: DVec3, random: &mut Random) -> DVec3 {
        let lobes = self.lobes(wo);
        let mut choice = random.unit() * lobes.iter().map(|lobe| lobe.attenuation).sum::<f64>();
        let chosen = lobes.iter().find(|lobe| {
            choice -= lobe.attenuation;
            choice < 0.0
        });
        let Lobe { variance, azimuth, .. } = chosen.unwrap_or(&lobes[3]);
        let [u, turn] = random.pair();
        let cos_o = (1.0 - wo.z * wo.z).max(0.0).sqrt();
        let height = (1.0 + variance * (u + (1.0 - u) * (-2.0 / variance).exp()).ln()).clamp(-1.0, 1.0);
        let sine = (-height * wo.z + (1.0 - height * height).sqrt() * (TAU * turn).cos() * cos_o).clamp(-1.0, 1.0);
        let place = random.unit();
        let angle = azimuth.map_or(TAU * place, |about| {
            let s = self.scale();
            let least = 1.0 / (1.0 + (PI / s).exp());
            let share = least + (1.0 - 2.0 * least) * place;
            about + s * (share / (1.0 - share)).ln()
        });
        let cosine = (1.0 - sine * sine).sqrt();
        DVec3::new(cosine * angle.cos(), cosine * angle.sin(), sine)
    }

    fn pdf(&self, wo: DVec3, wi: DVec3) -> f64 {
        let all: f64 = self.lobes(wo).iter().map(|lobe| lobe.attenuation).sum();
        self.evaluate(wo, wi).x / all
    }
}

/// Mitsuba's pictures, and what they are of.
struct Fixture {
    size: [u32; 2],
    block: u32,
    camera: Camera,
    yarns: Arc<Yarns>,
    /// By name: mean and standard error of each block.
    pictures: Vec<(String, Vec<[f64; 2]>)>,
}

impl Fixture {
    fn read() -> Self {
        let mut lines = include_str!("mitsuba/hair.txt").lines().filter(|line| !line.starts_with('#'));
        let mut row = |name: &str| -> Vec<f64> {
            let line = lines.next().expect("a line");
            let (found, numbers) = line.split_once(' ').expect("a name");
            assert_eq!(found, name);
            numbers.split(' ').map(|number| number.parse().expect("a number")).collect()
        };
        let size = row("size");
        let matrix = |rows: Vec<f64>| DMat4::from_cols_slice(&rows).transpose();
        let camera = Camera {
            world_from_camera: matrix(row("world_from_camera")),
            clip_from_camera: matrix(row("clip_from_camera")),
            lens: None,
        };
        let radius = row("yarn_radius")[0];
        let curves = (0..3).map(|_| {
            let points = row("curve");
            points.as_chunks::<3>().0.iter().map(|p| p.map(|c| c as f32)).collect()
        });
        let yarns = Yarns::new(Curves::catmull_rom(curves.collect(), false), Some(radius as f32)).expect("yarns");
        let pictures = ["direct", "two", "all"].map(|name| (name.to_owned(), row(name).as_chunks().0.to_vec()));
        Self {
            size: [size[0] as u32, size[1] as u32],
            block: size[2] as u32,
            camera,
            yarns: Arc::new(yarns),
            pictures: pictures.to_vec(),
        }
    }

    /// The viewpoint moved on the picture by parts of a pixel: pixels of a box filter, as Mitsuba's.
    fn moved(&self, shift: [f64; 2]) -> Camera {
        let [x, y] = [0, 1].map(|axis| 2.0 * (shift[axis] - 0.5) / f64::from(self.size[axis]));
        let mut moved = DMat4::IDENTITY;
        (moved.w_axis.x, moved.w_axis.y) = (x, y);
        Camera { clip_from_camera: moved * self.camera.clip_from_camera, ..self.camera }
    }

    fn yarn() -> Yarn {
        let mut yarn = Yarn::preset("silk-1").expect("preset");
        yarn.fibers_per_ply = 12;
        yarn.fiber_radius = 0.004;
        yarn.flyaways.loop_density = 0.0;
        yarn.flyaways.hair_density = 0.0;
        yarn
    }

    /// Blocks in which no fiber ends: ends are round here, and holes in Mitsuba's curves.
    fn without_ends(&self) -> Vec<bool> {
        let made = fibers(self.yarns.strands(), &Self::yarn(), &Options::default(), &mut |_| ControlFlow::Continue(()));
        let made = made.expect("fibers");
        let clip_from_world = self.camera.clip_from_camera * self.camera.world_from_camera.inverse();
        let columns = self.size[0] / self.block;
        let mut free = vec![true; (columns * (self.size[1] / self.block)) as usize];
        let ends =
            (0..made.len()).flat_map(|chain| [made.chain(chain)[0], made.chain(chain)[made.chain(chain).len() - 1]]);
        for [x, y, z, radius] in ends {
            let reach = 2.0 * f64::from(radius);
            for offset in [DVec3::X, DVec3::NEG_X, DVec3::Z, DVec3::NEG_Z] {
                let at = clip_from_world.project_point3(Vec3::new(x, y, z).as_dvec3() + offset * reach);
                let place = [0.5 + 0.5 * at.x, 0.5 - 0.5 * at.y];
                let [column, row] = [0, 1].map(|c| (place[c] * f64::from(self.size[c] / self.block)) as u32);
                free[(row * columns + column) as usize] = false;
            }
        }
        free
    }

    /// Means of blocks, of independent pictures.
    fn draw(&self, hair: Hair, bounces: Option<u32>, rounds: u32) -> Vec<Vec<f64>> {
        let yarn = Self::yarn();
        let light = sun(DVec3::new(0.5, 0.8, -1.0), 3.0);
        let of_yarn = object(&self.yarns, &yarn, lambert(0.5));
        (0..rounds)
            .into_par_iter()
            .map(|round| {
                const SAMPLES: u32 = 8;
                let mut random = Random::new(round, 0, 0);
                let scene = Scene {
                    ambient: Vec3::splat(0.4),
                    ..scene(of_yarn.clone(), vec![light], 0.0, self.moved(random.pair()))
                };
                let settings = Settings {
                    size: self.size,
                    samples: SAMPLES,
                    seed: round,
                    bounces,
                    transparent: false,
                    filter_width: 0.0,
                    chord_error: 0.01,
                    ..Settings::default()
                };
                let go_on = || ControlFlow::Continue(());
                let reference = Reference::new(&scene, &settings, &mut { go_on }).expect("a scene");
                let reference = reference.with_near_field(Arc::new(hair));
                let mut film = reference.film();
                reference.render(&mut film, &mut |_| ControlFlow::Continue(())).expect("a picture");
                self.blocks(&film.image().combined)
            })
            .collect()
    }

    fn blocks(&self, pixels: &[[f32; 4]]) -> Vec<f64> {
        let ([width, height], side) = (self.size.map(|s| s as usize), self.block as usize);
        let mean = |left: usize, top: usize| {
            let rows = (top..top + side).flat_map(|y| &pixels[y * width + left..][..side]);
            rows.map(|color| f64::from(color[0])).sum::<f64>() / (side * side) as f64
        };
        let tops = (0..height).step_by(side);
        tops.flat_map(|top| (0..width).step_by(side).map(move |left| mean(left, top))).collect()
    }

    /// Differences of block means in standard errors, where anything is uncertain.
    fn deviations(&self, name: &str, rounds: &[Vec<f64>]) -> Vec<f64> {
        let (_, expected) = self.pictures.iter().find(|(found, _)| found == name).expect("a picture");
        let n = rounds.len() as f64;
        let of_block = |(block, [mean, error]): (usize, &[f64; 2])| {
            let found = rounds.iter().map(|round| round[block]).sum::<f64>() / n;
            let variance = rounds.iter().map(|round| (round[block] - found).powi(2)).sum::<f64>() / (n * (n - 1.0));
            let error = (variance + error * error).sqrt();
            (error > 1e-4).then_some((found - mean) / error)
        };
        let free = self.without_ends();
        expected.iter().enumerate().filter(|(block, _)| free[*block]).filter_map(of_block).collect()
    }
}

/// The sum of squares over all blocks, and of all together, in standard errors.
fn judge(deviations: &[f64]) -> [f64; 2] {
    let squares = deviations.iter().map(|z| z * z).sum::<f64>();
    [squares, deviations.iter().sum::<f64>().abs() / (deviations.len() as f64).sqrt()]
}

/// What chance exceeds once in a thousand comparisons: χ² of thirteen blocks, and one normal number.
const BOUNDS: [f64; 2] = [34.5, 3.29];

#[test]
fn hair_is_as_bright_as_mitsubas() {
    let fixture = Fixture::read();
    for (name, bounces, rounds) in [("direct", Some(1), 200), ("two", Some(2), 100), ("all", None, 100)] {
        let deviations = fixture.deviations(name, &fixture.draw(HAIR, bounces, rounds));
        let found = judge(&deviations);
        println!("{name}: {} blocks, squares {:.2}, all {:.2}", deviations.len(), found[0], found[1]);
        assert_eq!(deviations.len(), 13);
        assert!(found[0] < BOUNDS[0] && found[1] < BOUNDS[1], "{name}: {found:?}");
    }
}

#[test]
fn other_hair_is_told_apart() {
    let fixture = Fixture::read();
    for (what, hair) in [
        ("longitudinal roughness", Hair { longitudinal_roughness: 0.6, ..HAIR }),
        ("azimuthal roughness", Hair { azimuthal_roughness: 0.6, ..HAIR }),
        ("absorption", Hair { absorption: 0.6, ..HAIR }),
        ("no azimuthal lobes", Hair { lobes: 0, ..HAIR }),
    ] {
        let found = judge(&fixture.deviations("direct", &fixture.draw(hair, Some(1), 100)));
        println!("{what}: squares {:.2}, all {:.2}", found[0], found[1]);
        assert!(found[0] > BOUNDS[0] || found[1] > BOUNDS[1], "{what}: {found:?}");
    }
    // In light of all orders a little more absorption is enough.
    let found = judge(&fixture.deviations("all", &fixture.draw(Hair { absorption: 0.32, ..HAIR }, None, 100)));
    println!("absorption of 0.32: {found:.2?}");
    assert!(found[0] > BOUNDS[0] || found[1] > BOUNDS[1], "{found:?}");
}

/// Means over drawn directions, divided by their density, are those over even ones.
#[test]
fn directions_are_drawn_with_their_density() {
    const AXES: [DVec3; 4] = [DVec3::X, DVec3::Y, DVec3::Z, DVec3::new(0.6, -0.8, 0.0)];
    const COUNT: u32 = 60_000;
    /// Means over draws, and the squares of their standard errors.
    fn means(mut draw: impl FnMut() -> (f64, DVec3)) -> [[f64; 2]; 4] {
        let n = f64::from(COUNT);
        let draws: Vec<_> = (0..COUNT).map(|_| draw()).collect();
        AXES.map(|axis| {
            let values = || draws.iter().map(|(weight, wi)| weight * (1.0 + wi.dot(axis)).powi(2));
            let mean = values().sum::<f64>() / n;
            [mean, values().map(|value| (value - mean).powi(2)).sum::<f64>() / (n * (n - 1.0))]
        })
    }
    let wo = DVec3::new(0.6, 0.5, 0.4).normalize();
    let mut random = Random::new(7, 8, 9);
    let even = means(|| {
        let wi = lisle_core::sampling::sphere(random.pair());
        (2.0 * TAU * HAIR.evaluate(wo, wi).x, wi)
    });
    let mut deviations = |drawn: Hair| {
        let by_lobes = means(|| {
            let wi = drawn.sample(wo, &mut random);
            (HAIR.evaluate(wo, wi).x / HAIR.pdf(wo, wi), wi)
        });
        std::array::from_fn(|axis| (by_lobes[axis][0] - even[axis][0]) / (by_lobes[axis][1] + even[axis][1]).sqrt())
    };
    let worst = |found: [f64; 4]| found.into_iter().fold(0.0, |most: f64, z| most.max(z.abs()));
    let found = deviations(HAIR);
    println!("{found:.2?}");
    assert!(worst(found) < 4.0, "{found:?}");
    for wrong in [
        Hair { longitudinal_roughness: 0.5, ..HAIR },
        Hair { azimuthal_roughness: 0.5, ..HAIR },
        Hair { absorption: 0.5, ..HAIR },
    ] {
        let found = deviations(wrong);
        println!("{found:.2?}");
        assert!(worst(found) > 6.0, "{found:?}");
    }
}

/// All light that a fiber without absorption takes in leaves it: ∫ f cos dω = 1 for each place on the width.
#[test]
fn hair_without_absorption_gives_back_all_light() {
    for (wo, absorption) in
        [([0.6, 0.5, 0.3], 0.0), ([1.0, 0.0, 0.0], 0.0), ([0.3, -0.6, -0.7], 0.0), ([0.6, 0.5, 0.3], 0.3)]
    {
        let wo = DVec3::from(wo).normalize();
        let mut random = Random::new(3, 4, 5);
        let hair = Hair { absorption, ..HAIR };
        let n = 200_000;
        let sum: f64 = (0..n).map(|_| hair.evaluate(wo, lisle_core::sampling::sphere(random.pair())).x).sum();
        let all = sum * 2.0 * TAU / f64::from(n);
        assert_eq!((all - 1.0).abs() < 0.02, absorption == 0.0, "{wo} {absorption}: {all}");
    }
}
