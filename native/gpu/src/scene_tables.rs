//! Tables of a scene's yarns and materials on the GPU.

use std::sync::Arc;

use lisle_core::scattering::Material;
use lisle_core::yarn::Yarn;
use lisle_precompute::Transport;

use crate::Error;
use crate::arrays::array;
use crate::device::Gpu;
use crate::tables::{SceneTransport, TableBuffer, TableCache};
use crate::word_texture::WordTexture;

/// What they are of.
#[derive(Clone, PartialEq)]
pub(crate) struct Kinds {
    pub yarns: Vec<Arc<Yarn>>,
    pub materials: Vec<Arc<Material>>,
    /// [`crate::Settings::table_resolution`].
    pub table_resolution: u32,
}

impl Kinds {
    fn same_yarns(&self, other: &Self) -> bool {
        self.yarns == other.yarns && self.table_resolution == other.table_resolution
    }
}

/// A table of multiple scattering, the kind of yarn and the material that it is for, and its offset.
struct UploadedTransport {
    table: Arc<Transport>,
    yarn: u32,
    material: u32,
    offset: u32,
}

impl UploadedTransport {
    fn of(transport: &SceneTransport, kinds: &Kinds) -> Self {
        let SceneTransport { yarn, material, table } = transport;
        Self {
            table: Arc::clone(table),
            yarn: position(&kinds.yarns, yarn),
            material: position(&kinds.materials, material),
            offset: 0,
        }
    }

    fn is_same(&self, other: &Self) -> bool {
        (self.yarn, self.material) == (other.yarn, other.material) && Arc::ptr_eq(&self.table, &other.table)
    }
}

/// The tables, those of yarns first: they are much larger, and stay where light alone is another.
pub(crate) struct SceneTables {
    kinds: Kinds,
    transports: Vec<UploadedTransport>,
    yarn_words: u32,
    pub words: WordTexture<u32>,
    /// Another buffer wherever the yarns' tables are made anew.
    pub yarns: wgpu::Buffer,
    pub materials: wgpu::Buffer,
}

impl SceneTables {
    /// Brings them up to date, reusing what `kept` already holds.
    pub fn update(
        gpu: &Gpu,
        kept: Option<Self>,
        kinds: Kinds,
        transports: &[SceneTransport],
        cache: &mut TableCache,
    ) -> Result<Self, Error> {
        let mut transports: Vec<_> = transports.iter().map(|of| UploadedTransport::of(of, &kinds)).collect();
        let mut kept = kept.filter(|kept| kept.kinds.same_yarns(&kinds));
        let has_all = |kept: &Self| {
            kept.kinds == kinds
                && kept.transports.len() == transports.len()
                && kept.transports.iter().zip(&transports).all(|(a, b)| a.is_same(b))
        };
        if let Some(kept) = kept.take_if(|kept| has_all(kept)) {
            return Ok(kept);
        }
        let mut add_light = |tables: &mut TableBuffer, cache: &mut TableCache| {
            kinds.materials.iter().for_each(|material| tables.add_material(material, &cache.scattering(material)));
            transports.iter_mut().for_each(|transport| transport.offset = tables.add_transport(&transport.table));
        };
        let mut tables = TableBuffer::default();
        if let Some(kept) = kept {
            tables.words.first = kept.yarn_words;
            add_light(&mut tables, cache);
            if u64::from(tables.words.end()) <= kept.words.texels() {
                kept.words.write(gpu, kept.yarn_words, &tables.words.rest);
                let materials = array(gpu, "materials", &tables.materials)?;
                return Ok(Self { kinds, transports, materials, ..kept });
            }
            tables = TableBuffer::default();
        }
        kinds.yarns.iter().for_each(|yarn| tables.add_yarn(&cache.yarn(yarn, kinds.table_resolution)));
        let yarn_words = tables.words.end();
        add_light(&mut tables, cache);
        Ok(Self {
            kinds,
            transports,
            yarn_words,
            words: WordTexture::new(gpu, "tables of yarns and materials", &tables.words.rest)?,
            yarns: array(gpu, "yarn kinds", &tables.yarns)?,
            materials: array(gpu, "materials", &tables.materials)?,
        })
    }

    /// Offset of the table of multiple scattering for a kind of yarn and a material, by number; 0 if there is none.
    pub fn transport(&self, yarn: u32, material: u32) -> u32 {
        let of = self.transports.iter().find(|t| (t.yarn, t.material) == (yarn, material));
        of.map_or(0, |transport| transport.offset)
    }

    pub fn bytes(&self) -> u64 {
        self.yarns.size() + self.materials.size() + self.words.bytes()
    }
}

fn position<T: PartialEq>(list: &[Arc<T>], item: &Arc<T>) -> u32 {
    let found = list.iter().position(|known| Arc::ptr_eq(known, item) || **known == **item);
    found.expect("every object's yarn and material was interned") as u32
}
