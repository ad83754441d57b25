//! Files by path. A page has none: there the files that a person gives it lie in memory, and a
//! `Keeper` takes what is written.

#[cfg(not(target_arch = "wasm32"))]
pub use native::*;
#[cfg(target_arch = "wasm32")]
pub use page::*;

#[cfg(not(target_arch = "wasm32"))]
mod native {
    use std::{
        ffi::OsString,
        io,
        path::{Path, PathBuf},
    };
    pub use std::{
        fs::{File, create_dir_all as create_folder, read, read_to_string},
        path::absolute,
    };

    /// Most names of a folder that are looked through.
    const MOST_NAMES: usize = 4096;

    /// Opens a file to be read.
    pub fn open(path: &Path) -> io::Result<File> {
        File::open(path)
    }

    /// The size of a regular file, bytes; none if something else has the name. Nothing is opened,
    /// so that a pipe does not wait.
    pub fn size_of(path: &Path) -> io::Result<Option<u64>> {
        let about = std::fs::metadata(path)?;
        Ok(about.is_file().then_some(about.len()))
    }

    /// Is there a file or a folder?
    pub fn exists(path: &Path) -> bool {
        path.exists()
    }

    /// The names in a folder, as many as anyone would look through; none where it cannot be read.
    pub fn names_in(folder: &Path) -> Option<Vec<OsString>> {
        let entries = std::fs::read_dir(folder).ok()?.take(MOST_NAMES);
        Some(entries.flatten().map(|entry| entry.file_name()).collect())
    }

    /// Where a path leads to through symbolic links.
    pub fn canonical(path: &Path) -> io::Result<PathBuf> {
        path.canonicalize()
    }
}

#[cfg(target_arch = "wasm32")]
mod page {
    use std::{
        collections::BTreeMap,
        ffi::OsString,
        io::{self, Cursor, ErrorKind, Read, Seek, SeekFrom},
        path::{Path, PathBuf},
        sync::{
            Arc, Mutex, MutexGuard, OnceLock, PoisonError,
            atomic::{AtomicU64, Ordering},
        },
    };

    static FILES: Mutex<BTreeMap<PathBuf, Arc<[u8]>>> = Mutex::new(BTreeMap::new());
    static GIVEN: AtomicU64 = AtomicU64::new(0);
    static KEEPER: OnceLock<Keeper> = OnceLock::new();

    /// What becomes of a file that is written: the page downloads it, or keeps it in the browser.
    pub type Keeper = fn(&Path, &[u8]) -> io::Result<()>;

    fn files() -> MutexGuard<'static, BTreeMap<PathBuf, Arc<[u8]>>> {
        FILES.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// From now on files that are written go to `keeper`; only the first call counts.
    pub fn keep_with(keeper: Keeper) {
        KEEPER.get_or_init(|| keeper);
    }

    /// Puts a file into memory.
    pub fn put(path: &Path, bytes: &[u8]) {
        GIVEN.fetch_add(1, Ordering::Relaxed);
        files().insert(path.to_owned(), bytes.into());
    }

    /// How often a file was put into memory.
    pub fn puts() -> u64 {
        GIVEN.load(Ordering::Relaxed)
    }

    /// The files in a folder and below, by path.
    pub fn below(folder: &Path) -> Vec<(PathBuf, Arc<[u8]>)> {
        let files = files();
        let inside = files.iter().filter(|(path, _)| path.starts_with(folder));
        inside
            .map(|(path, bytes)| (path.clone(), bytes.clone()))
            .collect()
    }

    /// Writes a file: to memory, and to the keeper.
    ///
    /// # Errors
    /// The keeper's; then memory is unchanged.
    pub fn write(path: &Path, bytes: &[u8]) -> io::Result<()> {
        KEEPER.get().map_or(Ok(()), |keeper| keeper(path, bytes))?;
        files().insert(path.to_owned(), bytes.into());
        Ok(())
    }

    /// Forgets the files in a folder and below.
    pub fn remove(folder: &Path) {
        files().retain(|path, _| !path.starts_with(folder));
    }

    fn read_kept(path: &Path) -> io::Result<Arc<[u8]>> {
        let found = files().get(path).cloned();
        found.ok_or_else(|| io::Error::new(ErrorKind::NotFound, "the page has no such file"))
    }

    /// A file that is read.
    #[derive(Clone)]
    pub struct File(Arc<Mutex<Cursor<Arc<[u8]>>>>);

    impl File {
        fn cursor(&self) -> MutexGuard<'_, Cursor<Arc<[u8]>>> {
            self.0.lock().unwrap_or_else(PoisonError::into_inner)
        }
    }

    impl Read for &File {
        fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
            self.cursor().read(bytes)
        }
    }

    impl Read for File {
        fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
            self.cursor().read(bytes)
        }
    }

    impl Seek for &File {
        fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
            self.cursor().seek(to)
        }
    }

    pub fn open(path: &Path) -> io::Result<File> {
        Ok(File(Arc::new(Mutex::new(Cursor::new(read_kept(path)?)))))
    }

    pub fn size_of(path: &Path) -> io::Result<Option<u64>> {
        Ok(Some(read_kept(path)?.len() as u64))
    }

    pub fn exists(path: &Path) -> bool {
        files().contains_key(path)
    }

    /// A page looks up what it was given by its whole path.
    pub fn names_in(folder: &Path) -> Option<Vec<OsString>> {
        let files = files();
        let inside = files
            .keys()
            .filter_map(|path| path.strip_prefix(folder).ok());
        Some(
            inside
                .filter_map(|path| Some(path.iter().next()?.to_owned()))
                .collect(),
        )
    }

    pub fn canonical(path: &Path) -> io::Result<PathBuf> {
        Ok(path.to_owned())
    }

    /// The standard library has none here, not even of an absolute path.
    pub fn absolute(path: impl AsRef<Path>) -> io::Result<PathBuf> {
        Ok(Path::new("/").join(path))
    }

    pub fn read(path: &Path) -> io::Result<Vec<u8>> {
        Ok(read_kept(path)?.to_vec())
    }

    pub fn read_to_string(path: &Path) -> io::Result<String> {
        String::from_utf8(read(path)?)
            .map_err(|_| io::Error::new(ErrorKind::InvalidData, "it is not UTF-8 text"))
    }

    /// Folders need not be made.
    pub fn create_folder(_: &Path) -> io::Result<()> {
        Ok(())
    }
}
