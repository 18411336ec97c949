//! Tables kept on disk from one session to the next.

use std::fs;
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use glam::DVec3;
use lisle_core::scattering::Material;
use lisle_core::yarn::Yarn;

use super::{Entry, Transport, TransportSize};

/// To be raised whenever the same key gives another table.
const VERSION: u32 = 6;

/// Files beyond this number go, those used longest ago first: about 300 MB.
const MOST_FILES: usize = 200;

const EXTENSION: &str = "transport";

/// A folder of tables, each a file named by a hash of what it was made from. It is only ever a shortcut: whatever cannot be read is computed again.
///
/// A file holds its key, a table as little-endian `f32`, and a checksum.
#[derive(Clone, Debug)]
pub struct TransportStore {
    folder: PathBuf,
}

/// 64-bit FNV-1a [Fowler2019].
fn hash(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3))
}

/// All that decides a table. `Debug` prints numbers so that they read back to the same bits.
fn key(yarn: &Yarn, material: &Material, photons: u32) -> String {
    format!("{VERSION} {:?} {photons} {yarn:?} {material:?}", TransportSize::ALL)
}

impl TransportStore {
    /// A store in that folder, which is made when the first table is kept.
    pub fn new(folder: impl Into<PathBuf>) -> Self {
        Self { folder: folder.into() }
    }

    fn path(&self, key: &str) -> PathBuf {
        self.folder.join(format!("{:016x}.{EXTENSION}", hash(key.as_bytes())))
    }

    /// The table of that key, if there is a whole one.
    pub fn load(&self, yarn: &Yarn, material: &Material, photons: u32) -> Option<Transport> {
        let key = key(yarn, material, photons);
        let mut file = fs::File::open(self.path(&key)).ok()?;
        let mut bytes = Vec::new();
        file.read_to_end(&mut bytes).ok()?;
        // Its age is that of its last use. That a folder cannot be written is no reason not to read it.
        let _ = file.set_modified(SystemTime::now());
        let (content, checksum) = bytes.split_last_chunk::<8>()?;
        let values = content.strip_prefix(key.as_bytes())?;
        (hash(content) == u64::from_le_bytes(*checksum)).then(|| transport(values))?
    }

    /// Keeps a table; the file appears whole or not at all.
    ///
    /// # Errors
    /// Whatever the file system refuses.
    pub fn save(&self, yarn: &Yarn, material: &Material, photons: u32, transport: &Transport) -> io::Result<()> {
        fs::create_dir_all(&self.folder)?;
        let key = key(yarn, material, photons);
        let mut bytes = key.clone().into_bytes();
        bytes.extend(values(transport).flat_map(f32::to_le_bytes));
        bytes.extend(hash(&bytes).to_le_bytes());
        let mut file = tempfile::NamedTempFile::new_in(&self.folder)?;
        file.write_all(&bytes)?;
        file.persist(self.path(&key)).map_err(|error| error.error)?;
        self.prune(MOST_FILES)
    }

    fn prune(&self, most: usize) -> io::Result<()> {
        let is_table = |path: &Path| path.extension().is_some_and(|extension| extension == EXTENSION);
        let mut files: Vec<(SystemTime, PathBuf)> = fs::read_dir(&self.folder)?
            .filter_map(Result::ok)
            .filter(|entry| is_table(&entry.path()))
            .filter_map(|entry| Some((entry.metadata().ok()?.modified().ok()?, entry.path())))
            .collect();
        files.sort();
        for (_, path) in files.iter().rev().skip(most) {
            fs::remove_file(path)?;
        }
        Ok(())
    }
}

/// A table's numbers, in the order of its fields. All in single precision, as the renderer has them.
fn values(transport: &Transport) -> impl Iterator<Item = f32> {
    let Transport { radiance, ambient, sides, albedo, entry } = transport;
    let tables = radiance.iter().chain(ambient).chain(sides).copied();
    tables.chain([albedo.as_vec3().to_array()]).flatten().chain([entry.share as f32, entry.spread as f32])
}

fn transport(bytes: &[u8]) -> Option<Transport> {
    let (numbers, rest) = bytes.as_chunks::<4>();
    let (colors, rest_numbers) = numbers.as_chunks::<3>();
    let [share, spread] = *rest_numbers else { return None };
    let [share, spread] = [share, spread].map(|number| f64::from(f32::from_le_bytes(number)));
    let mut colors = colors.iter().map(|color| color.map(f32::from_le_bytes));
    let size = TransportSize::ALL;
    let per_light = size.cells() / size.light_longitudes;
    let mut take = |count: usize| -> Vec<[f32; 3]> { colors.by_ref().take(count).collect() };
    let (radiance, ambient, sides, last) = (take(size.cells()), take(per_light), take(size.sides), take(2));
    let is_whole = rest.is_empty() && sides.len() == size.sides;
    let [albedo] = *last.as_slice() else { return None };
    let (albedo, entry) = (DVec3::from(albedo.map(f64::from)), Entry { share, spread });
    is_whole.then_some(Transport { radiance, ambient, sides, albedo, entry })
}

#[cfg(test)]
mod tests {
    use std::ops::ControlFlow;

    use super::*;

    fn table(yarn: &Yarn, material: &Material) -> Transport {
        match Transport::new(yarn, material, 2_000, &mut || ControlFlow::Continue(())) {
            ControlFlow::Continue(transport) => transport,
            ControlFlow::Break(()) => unreachable!("nobody stopped it"),
        }
    }

    fn subject() -> (Yarn, Material) {
        (Yarn::preset("silk-2").expect("preset"), Material::preset("rayon-1").expect("preset"))
    }

    #[test]
    fn a_table_comes_back_as_it_was_and_for_its_own_key_alone() {
        let folder = tempfile::tempdir().expect("temporary folder");
        let store = TransportStore::new(folder.path().join("made when needed"));
        let (yarn, material) = subject();
        assert!(store.load(&yarn, &material, 2_000).is_none());
        let made = table(&yarn, &material);
        store.save(&yarn, &material, 2_000, &made).expect("saved");
        let kept = store.load(&yarn, &material, 2_000).expect("kept");
        assert_eq!((&kept.radiance, &kept.ambient, &kept.sides), (&made.radiance, &made.ambient, &made.sides));
        assert_eq!(kept.albedo.as_vec3(), made.albedo.as_vec3());
        assert_eq!(
            [kept.entry.share, kept.entry.spread].map(|x| x as f32),
            [made.entry.share, made.entry.spread].map(|x| x as f32)
        );
        assert!(store.load(&yarn, &material, 3_000).is_none(), "other photons");
        let other = Material { beta_r_rad: material.beta_r_rad * (1.0 + 1e-15), ..material };
        assert!(store.load(&yarn, &other, 2_000).is_none(), "another material");
        let other = Yarn { ply_twist: -yarn.ply_twist, ..yarn };
        assert!(store.load(&other, &material, 2_000).is_none(), "another yarn");
    }

    #[test]
    fn a_damaged_file_is_no_table() {
        let folder = tempfile::tempdir().expect("temporary folder");
        let store = TransportStore::new(folder.path());
        let (yarn, material) = subject();
        store.save(&yarn, &material, 2_000, &table(&yarn, &material)).expect("saved");
        let path = store.path(&key(&yarn, &material, 2_000));
        let whole = fs::read(&path).expect("file");
        let mut flipped = whole.clone();
        flipped[whole.len() / 2] ^= 1;
        for damaged in [&whole[..whole.len() - 4], &whole[..10], &[], flipped.as_slice()] {
            fs::write(&path, damaged).expect("written");
            assert!(store.load(&yarn, &material, 2_000).is_none(), "{} bytes", damaged.len());
        }
        fs::write(&path, &whole).expect("written");
        assert!(store.load(&yarn, &material, 2_000).is_some());
    }

    #[test]
    fn a_store_that_cannot_be_written_says_so_and_the_oldest_files_go() {
        let folder = tempfile::tempdir().expect("temporary folder");
        let file = folder.path().join("a file");
        fs::write(&file, "").expect("written");
        let (yarn, material) = subject();
        let made = table(&yarn, &material);
        assert!(TransportStore::new(&file).save(&yarn, &material, 2_000, &made).is_err());
        let store = TransportStore::new(folder.path().join("store"));
        for photons in 0..3 {
            store.save(&yarn, &material, photons, &made).expect("saved");
            let used = SystemTime::UNIX_EPOCH + std::time::Duration::from_secs(u64::from(photons));
            let path = store.path(&key(&yarn, &material, photons));
            fs::File::options().append(true).open(path).and_then(|file| file.set_modified(used)).expect("dated");
        }
        store.prune(2).expect("pruned");
        let kept = [0, 1, 2].map(|photons| store.path(&key(&yarn, &material, photons)).exists());
        assert_eq!(kept, [false, true, true]);
    }
}
