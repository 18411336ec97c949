//! Yarn kinds and materials as the shaders read them, with all their tables in one buffer.

use std::ops::ControlFlow;
use std::sync::Arc;

use glam::{DVec3, Vec4};
use lisle_core::scattering::{Material, ScatteringTables, highlight_scale};
use lisle_core::yarn::{FiberTable, Variate, Yarn};
use lisle_precompute::{CoreFiber, HOLE, Tables, Transport, TransportStore};

use crate::{Object, Scene, layout};

/// Two values in [−1, 1] as WGSL's `unpack2x16snorm` reads them.
fn pack_snorm([low, high]: [f32; 2]) -> u32 {
    let code = |value: f32| u32::from((value.clamp(-1.0, 1.0) * 32767.0).round() as i16 as u16);
    code(low) | (code(high) << 16)
}

/// A colour of values ≥ 0 in three mantissas of 9 bits and one exponent, as `shared_exponent` in `shaders/math/pack.wgsl` reads it.
fn pack_shared_exponent(color: [f32; 3]) -> u32 {
    const BIAS: i32 = 15;
    const MOST: f32 = 65408.0;
    let color = color.map(|c| c.clamp(0.0, MOST));
    let most = color.iter().copied().fold(0.0, f32::max);
    // The exponent with which the largest mantissa, rounded, fits into 9 bits.
    let mut exponent = (most.max(f32::MIN_POSITIVE).log2().floor() as i32 + 1).max(-BIAS);
    if (most / 2.0_f32.powi(exponent - 9)).round() > 511.0 {
        exponent += 1;
    }
    let code = |c: f32| (c / 2.0_f32.powi(exponent - 9)).round() as u32;
    code(color[0]) | (code(color[1]) << 9) | (code(color[2]) << 18) | (((exponent + BIAS) as u32) << 27)
}

/// Tables one after the other, of which the first so many words are elsewhere.
#[derive(Default)]
pub(crate) struct Words {
    pub first: u32,
    pub rest: Vec<u32>,
}

impl Words {
    fn append(&mut self, values: impl IntoIterator<Item = f32>) -> u32 {
        self.append_words(values.into_iter().map(f32::to_bits))
    }

    fn append_words(&mut self, words: impl IntoIterator<Item = u32>) -> u32 {
        let place = self.end();
        self.rest.extend(words);
        place
    }

    pub fn end(&self) -> u32 {
        self.first + self.rest.len() as u32
    }
}

/// A kind of yarn as the shaders read it: 25 MiB, mostly of its core texture.
pub(crate) struct YarnTables {
    words: Words,
    /// Its offsets are from the first of these words.
    kind: layout::Yarn,
}

impl YarnTables {
    pub fn new(yarn: &Yarn, tables: &Tables) -> Self {
        let mut words = Words::default();
        let fibers = FiberTable::new(yarn);
        let rows = (0..fibers.radius.len()).flat_map(|fiber| fibers.packed(fiber));
        let fiber_table = words.append_words(rows);
        let core = &tables.core_fiber;
        let core_slope = core.texels.iter().flat_map(|t| [t[2].abs(), t[3].abs()]).fold(f32::MIN_POSITIVE, f32::max);
        let core_table = words.append_words(core.texels.iter().flat_map(|[height, offset, dh, dv]| {
            [pack_snorm([0.5 * height, *offset]), pack_snorm([dh / core_slope, dv / core_slope])]
        }));
        let core_heights = words.append_words(packed_heights(core, yarn.fibers_per_ply));
        let shadow_table = words.append(tables.self_shadow.optical_depth.iter().copied());
        let extinction_table = words.append(tables.self_shadow.extinction.iter().copied());
        let seen_sky_table = words.append(tables.self_shadow.seen_sky.iter().copied());
        let occlusion_table = words.append(tables.occlusion.visibility.iter().copied());

        let outer = yarn.outer_radius();
        let (loop_chance, hair_chance) = yarn.flyaway_chances();
        let fly = &yarn.flyaways;
        let scaled = |v: Variate, by: f64| [(v.mean / by) as f32, (v.deviation / by) as f32];
        let axis = yarn.mean_axis();
        let [loop_radius_mean, loop_radius_deviation] = scaled(fly.loop_r_max, axis);
        let [tip_min_mean, tip_min_deviation] = scaled(fly.hair_r_min, axis);
        let [tip_span_mean, tip_span_deviation] = scaled(fly.hair_r_span, axis);
        let [width_mean, width_deviation] = scaled(fly.hair_z_span, yarn.migration_period());
        let [turns_mean, turns_deviation] = scaled(fly.hair_theta_span, std::f64::consts::TAU);
        let kind = layout::Yarn {
            plies: yarn.plies,
            fibers: yarn.fibers_per_ply,
            flyaway_fibers: yarn.flyaway_fibers(),
            core_layers: core.layers as u32,
            ply_distance: (yarn.ply_distance() / outer) as f32,
            ellipse_short: (yarn.ellipse_short / outer) as f32,
            ellipse_long: (yarn.ellipse_long / outer) as f32,
            fiber_radius: (yarn.fiber_radius / outer) as f32,
            ply_sign: yarn.ply_twist.signum() as f32,
            fiber_sign: yarn.fiber_twist.signum() as f32,
            r_min: yarn.r_min as f32,
            loop_chance: loop_chance as f32,
            hair_chance: hair_chance as f32,
            loop_radius_mean,
            loop_radius_deviation,
            tip_min_mean,
            tip_min_deviation,
            tip_span_mean,
            tip_span_deviation,
            width_mean,
            width_deviation,
            turns_mean,
            turns_deviation,
            fiber_table,
            core_table,
            core_length: core.length as u32,
            core_width: core.width as u32,
            core_half_width: core.half_width[0],
            shadow_table,
            shadow_slices: tables.self_shadow.slices as u32,
            shadow_size: tables.self_shadow.size as u32,
            shadow_extent: tables.self_shadow.extent,
            occlusion_cubic: Vec4::from(tables.occlusion.cubic),
            occlusion_table,
            occlusion_size: tables.occlusion.size as u32,
            occlusion_extent: tables.occlusion.extent,
            bound: bound(yarn) as f32,
            core_views: core.views as u32,
            core_turns: core.turns as u32,
            core_slope,
            extinction_table,
            seen_sky_table,
            seen_sky_size: tables.self_shadow.seen_sky_size as u32,
            tube_radius: tables.self_shadow.tube_radius,
            core_heights,
            core_slants: core.slants as u32,
            core_slant_step: core.slant_step,
            core_widening: core.half_width[1],
            ..Default::default()
        };
        words.rest.shrink_to_fit();
        Self { words, kind }
    }
}

/// Bits of a fiber's place beside a core texture's height: CORE_PLACE_BITS of shaders/passes/core_line.wgsl.
pub(crate) const CORE_PLACE_BITS: u32 = 5;

/// A core texture's height with the place of its fiber among those of its layer that are not in the next one, 16 bits.
fn pack_height(height: f32, place: f64) -> u32 {
    let last = |bits: u32| f64::from((1_u32 << bits) - 1);
    let height = (f64::from(0.25 * height + 0.5).clamp(0.0, 1.0) * last(16 - CORE_PLACE_BITS)).round();
    // The last one is for fibers of the next layer.
    let last_place = last(CORE_PLACE_BITS);
    let place = if place < 1.0 { (place * last_place).round().min(last_place - 1.0) } else { last_place };
    (height as u32) << CORE_PLACE_BITS | place as u32
}

/// Heights and places: of a texel, and in the upper half of the same place in the next layer, or of a hole.
fn packed_heights(core: &CoreFiber, fibers: u32) -> impl Iterator<Item = u32> {
    let (of_layer, layers) = (core.length * core.width, core.layers as f64);
    let packed = move |texel: usize| {
        let layer = (texel / of_layer % core.layers) as f64;
        let rank = f64::from(core.ranks[texel]) / f64::from(fibers);
        pack_height(core.texels[texel][0], (rank * layers * layers - layer * layer) / (2.0 * layer + 1.0))
    };
    (0..core.texels.len()).map(move |texel| {
        let is_last = texel / of_layer % core.layers + 1 == core.layers;
        let behind = if is_last { pack_height(HOLE, 1.0) } else { packed(texel + of_layer) };
        packed(texel) | behind << 16
    })
}

/// One buffer of tables and the offsets into it.
#[derive(Default)]
pub(crate) struct TableBuffer {
    pub words: Words,
    pub yarns: Vec<layout::Yarn>,
    pub materials: Vec<layout::Material>,
}

impl TableBuffer {
    pub fn add_yarn(&mut self, yarn: &YarnTables) {
        let first = self.words.append_words(yarn.words.rest.iter().copied());
        let kind = &yarn.kind;
        self.yarns.push(layout::Yarn {
            fiber_table: first + kind.fiber_table,
            core_table: first + kind.core_table,
            core_heights: first + kind.core_heights,
            shadow_table: first + kind.shadow_table,
            extinction_table: first + kind.extinction_table,
            seen_sky_table: first + kind.seen_sky_table,
            occlusion_table: first + kind.occlusion_table,
            ..*kind
        });
    }

    /// Offset of a transport table: albedo, where light enters, then the three tables of [`Transport`].
    pub fn add_transport(&mut self, transport: &Transport) -> u32 {
        let albedo = transport.albedo.as_vec3().to_array();
        // As half the width of an even distribution.
        let entry = [transport.entry.share, transport.entry.spread * 3.0_f64.sqrt()].map(|x| x as f32);
        let first = self.words.append(albedo.into_iter().chain(entry));
        self.words.append_words(
            transport
                .sides
                .iter()
                .chain(&transport.radiance)
                .chain(&transport.ambient)
                .map(|c| pack_shared_exponent(*c)),
        );
        first
    }

    pub fn add_material(&mut self, material: &Material, tables: &ScatteringTables) {
        let columns = [
            tables.root_integral_r,
            tables.root_integral_tt,
            tables.ambient_reflect,
            tables.ambient_reflect_grazing,
            tables.ambient_transmit,
        ];
        let table_size = columns[0].len() as u32;
        let table = self.words.append(columns.iter().flatten().map(|x| *x as f32));
        let color = |c: DVec3| c.as_vec3();
        self.materials.push(layout::Material {
            color_r: color(material.color_r),
            beta_r: material.beta_r_rad as f32,
            color_tt: color(material.color_tt),
            beta_tt: material.beta_tt_rad as f32,
            diffuse: color(material.diffuse),
            diffuse_weight: material.diffuse_weight as f32,
            specular: color(material.specular),
            specular_beta: material.specular_beta_rad as f32,
            gamma_tt: material.gamma_tt_rad as f32,
            azimuthal_tt: tables.azimuthal_tt as f32,
            highlight_scale: highlight_scale(material.specular_beta_rad) as f32,
            table,
            table_size,
            ..Default::default()
        });
    }
}

/// Distance from the yarn centre that no fiber leaves, in outer radii: the stand-in for a normal variate is within ±3 deviations.
pub(crate) fn bound(yarn: &Yarn) -> f64 {
    let fly = &yarn.flyaways;
    let most = |v: Variate| v.mean + 3.0 * v.deviation;
    let relative = (most(fly.loop_r_max)).max(most(fly.hair_r_min) + most(fly.hair_r_span)) / yarn.mean_axis();
    let ply =
        yarn.ellipse_long.max(yarn.ellipse_short) * if yarn.flyaway_fibers() > 0 { relative.max(1.0) } else { 1.0 };
    (yarn.ply_distance() + ply + yarn.fiber_radius) / yarn.outer_radius()
}

/// What was computed, the most recently used last.
struct Recent<K, V>(Vec<(K, Arc<V>)>);

impl<K, V> Default for Recent<K, V> {
    fn default() -> Self {
        Self(Vec::new())
    }
}

impl<K: PartialEq, V> Recent<K, V> {
    fn find(&mut self, key: &K) -> Option<Arc<V>> {
        let place = self.0.iter().position(|(known, _)| known == key)?;
        self.0[place..].rotate_left(1);
        self.0.last().map(|(_, value)| Arc::clone(value))
    }

    fn keep(&mut self, key: K, value: V) -> Arc<V> {
        let value = Arc::new(value);
        self.0.push((key, Arc::clone(&value)));
        value
    }

    /// Keeps so many.
    fn forget(&mut self, most: usize) {
        self.0.drain(..self.0.len().saturating_sub(most));
    }
}

/// Multiple scattering for a kind of yarn and a material of a scene.
pub(crate) struct SceneTransport {
    pub yarn: Arc<Yarn>,
    pub material: Arc<Material>,
    pub table: Arc<Transport>,
}

/// What a table of multiple scattering is made from, and with how many photons.
type TransportKey = (Yarn, Material, u32);

/// Tables of fewer photons are drafts, made sooner than a folder would have room for one of every material that a user tries.
const LEAST_KEPT_PHOTONS: u32 = 50_000;

/// Precomputed tables of recent yarns and materials, so that going back to one costs none of them.
#[derive(Default)]
pub(crate) struct TableCache {
    yarns: Recent<(Yarn, u32), YarnTables>,
    /// By what they hang on: widths of lobes.
    scattering: Recent<[f64; 3], ScatteringTables>,
    transports: Recent<TransportKey, Transport>,
    pub store: Option<TransportStore>,
}

impl TableCache {
    /// `resolution`: [`crate::Settings::table_resolution`].
    pub fn yarn(&mut self, yarn: &Yarn, resolution: u32) -> Arc<YarnTables> {
        let key = (yarn.clone(), resolution);
        self.yarns.find(&key).unwrap_or_else(|| {
            let tables = YarnTables::new(yarn, &Tables::new(yarn, resolution as usize));
            self.yarns.keep(key, tables)
        })
    }

    pub fn scattering(&mut self, material: &Material) -> Arc<ScatteringTables> {
        let key = [material.beta_r_rad, material.beta_tt_rad, material.gamma_tt_rad];
        self.scattering.find(&key).unwrap_or_else(|| self.scattering.keep(key, ScatteringTables::new(material)))
    }

    /// Keeps what was used last: as much as a scene of so many needs, and for whoever tries one after the other, or has several views, at least
    /// eight kinds of yarn, 25 MiB each, and 16 tables of multiple scattering, 1.5 MiB each, of which drafts have their own.
    pub fn forget(&mut self, yarns: usize, materials: usize, transports: usize) {
        self.yarns.forget(yarns.max(8));
        self.scattering.forget(materials.max(16));
        self.transports.forget((2 * transports).max(16));
    }

    /// A table that was made before, in this session or another.
    fn known_transport(&mut self, key: &TransportKey) -> Option<Arc<Transport>> {
        self.transports.find(key).or_else(|| {
            let kept = self.store.as_ref()?.load(&key.0, &key.1, key.2)?;
            Some(self.transports.keep(key.clone(), kept))
        })
    }

    /// The tables of a scene's yarns and materials. `step` is told how many steps are done, of how many that there are to do for those not known.
    pub fn transports(
        &mut self,
        scene: &Scene,
        photons: u32,
        step: &mut dyn FnMut(u32, u32) -> ControlFlow<()>,
    ) -> ControlFlow<(), Vec<SceneTransport>> {
        let mut wanted: Vec<(&Arc<Yarn>, &Arc<Material>)> = Vec::new();
        // A hole in the picture has no light.
        for Object { yarn, material, .. } in scene.objects.iter().filter(|object| !object.is_holdout) {
            if !wanted.contains(&(yarn, material)) {
                wanted.push((yarn, material));
            }
        }
        let known: Vec<_> = wanted
            .iter()
            .map(|(yarn, material)| self.known_transport(&((***yarn).clone(), ***material, photons)))
            .collect();
        let unknown = known.iter().filter(|table| table.is_none()).count() as u32;
        let (mut done, total) = (0, unknown * Transport::batches(photons));
        let mut tables = Vec::with_capacity(wanted.len());
        for ((yarn, material), known) in wanted.into_iter().zip(known) {
            let table = match known {
                Some(table) => table,
                None => {
                    let made = Transport::new(yarn, material, photons, &mut || {
                        done += 1;
                        step(done, total)
                    })?;
                    if let Some(store) = self.store.as_ref().filter(|_| photons >= LEAST_KEPT_PHOTONS) {
                        // A folder that cannot be written costs the next session time, this one nothing.
                        let _ = store.save(yarn, material, photons, &made);
                    }
                    self.transports.keep(((**yarn).clone(), **material, photons), made)
                }
            };
            tables.push(SceneTransport { yarn: Arc::clone(yarn), material: Arc::clone(material), table });
        }
        ControlFlow::Continue(tables)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_used_last_is_kept() {
        let mut recent = Recent::default();
        for key in 0..4 {
            recent.keep(key, 10 * key);
        }
        assert_eq!(recent.find(&1).as_deref(), Some(&10));
        recent.forget(2);
        assert_eq!([0, 1, 2, 3].map(|key| recent.find(&key).is_some()), [false, true, false, true]);
        recent.forget(5);
        assert_eq!(recent.0.len(), 2);
    }

    fn unpack(word: u32) -> [f32; 3] {
        let scale = 2.0_f32.powi((word >> 27) as i32 - 24);
        [0, 9, 18].map(|shift| ((word >> shift) & 511) as f32 * scale)
    }

    #[test]
    fn colors_keep_nine_bits_of_their_greatest_channel() {
        for color in
            [[0.0; 3], [1.0, 0.5, 0.25], [0.999, 1e-3, 0.3], [511.7, 3.0, 200.0], [6e4, 1.0, 0.0], [3e-5, 2e-5, 0.0]]
        {
            let most = color.iter().copied().fold(2.0_f32.powi(-15), f32::max);
            for (a, b) in color.iter().zip(unpack(pack_shared_exponent(color))) {
                assert!((a - b).abs() <= most / 511.0, "{color:?}: {b}");
            }
        }
    }

    #[test]
    fn heights_and_places_are_those_of_the_core_texture() {
        let mut buffer = TableBuffer::default();
        let yarns = ["cotton-1", "silk-2"].map(|name| Yarn::preset(name).expect("preset"));
        let tables = yarns.each_ref().map(|yarn| Tables::new(yarn, 1));
        for (yarn, tables) in yarns.iter().zip(&tables) {
            buffer.add_yarn(&YarnTables::new(yarn, tables));
        }
        for ((kind, tables), yarn) in buffer.yarns.iter().zip(&tables).zip(&yarns) {
            let core = &tables.core_fiber;
            let words = &buffer.words.rest;
            let word = |texel: usize| words[kind.core_heights as usize + texel];
            let stored = |texel: usize| word(texel) & 0xffff;
            let height = |texel: usize| f64::from(stored(texel) >> CORE_PLACE_BITS) / 2047.0 * 4.0 - 2.0;
            assert!((0..core.texels.len()).all(|k| (height(k) - f64::from(core.texels[k][0])).abs() < 0.001));
            assert!((0..core.texels.len()).any(|k| (height(k) - f64::from(core.texels[0][0])).abs() > 0.1));
            // Behind each is what the next layer has there, and a hole behind the last.
            let of_layer = core.length * core.width;
            let behind = |k: usize| {
                let is_last = k / of_layer % core.layers == core.layers - 1;
                if is_last { 31 } else { stored(k + of_layer) }
            };
            assert!((0..core.texels.len()).all(|k| word(k) >> 16 == behind(k)));
            // Layer 2 has the fibers from 4/25 on, layer 3 those from 9/25.
            for k in 2 * of_layer..3 * of_layer {
                let rank = f64::from(core.ranks[k]);
                let share = (rank / f64::from(yarn.fibers_per_ply) - 4.0 / 25.0) / (5.0 / 25.0);
                let place = f64::from(stored(k) & 31) / 31.0;
                assert!((share < 1.0 && (place - share).abs() <= 1.0 / 31.0) || (share >= 1.0 && place == 1.0));
            }
        }
    }
}
