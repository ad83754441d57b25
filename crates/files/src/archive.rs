//! ZIP archives in memory: a model with the files beside it, and what a person takes along.

use std::{
    io::{Read as _, Write as _},
    path::PathBuf,
};

use flate2::{Compression, bufread::DeflateDecoder, write::DeflateEncoder};
use rawzip::{CompressionMethod, ZipArchive, ZipArchiveWriter};

/// Most files of an archive that is read.
pub const MOST_FILES: usize = 4096;

/// Most bytes of all files of an archive that is read: 512 MiB.
pub const MOST_BYTES: u64 = 512 << 20;

/// The files of an archive, each with its path, which is relative; what would lead out of the archive
/// is left out of it.
///
/// # Errors
/// In one sentence: it is no archive or is damaged, a file is packed in another way than stored or
/// deflated, or there are more than [`MOST_FILES`] files or [`MOST_BYTES`] bytes.
pub fn read(bytes: &[u8]) -> Result<Vec<(PathBuf, Vec<u8>)>, String> {
    let damaged = |error: rawzip::Error| format!("it is no ZIP archive, or is damaged: {error}");
    let archive = ZipArchive::from_slice(bytes).map_err(damaged)?;
    let (mut entries, mut files) = (archive.entries(), Vec::new());
    let mut left = MOST_BYTES;
    while let Some(entry) = entries.next_entry().map_err(damaged)? {
        if entry.is_dir() {
            continue;
        }
        if files.len() == MOST_FILES {
            return Err(format!("it has more than {MOST_FILES} files"));
        }
        let path = entry.file_path().try_normalize().map_err(damaged)?;
        let path: &str = path.as_ref();
        let path = PathBuf::from(path);
        let packed = archive.get_entry(entry.wayfinder()).map_err(damaged)?;
        let mut file = Vec::new();
        let read = match entry.compression_method() {
            CompressionMethod::STORE => packed
                .verifying_reader(packed.data())
                .take(left + 1)
                .read_to_end(&mut file),
            CompressionMethod::DEFLATE => packed
                .verifying_reader(DeflateDecoder::new(packed.data()))
                .take(left + 1)
                .read_to_end(&mut file),
            _ => {
                let name = path.display();
                return Err(format!("{name} in it is neither stored nor deflated"));
            }
        };
        let read = read.map_err(|error| format!("{} in it is damaged: {error}", path.display()))?;
        left = left.checked_sub(read as u64).ok_or_else(|| {
            let most = MOST_BYTES >> 20;
            format!("its files have more than {most} MiB")
        })?;
        files.push((path, file));
    }
    Ok(files)
}

/// An archive of these files, deflated. Paths are relative, with `/` between their parts.
pub fn write<'a>(files: impl IntoIterator<Item = (&'a str, &'a [u8])>) -> Result<Vec<u8>, String> {
    let mut bytes = Vec::new();
    let mut archive = ZipArchiveWriter::new(&mut bytes);
    let packed = files.into_iter().try_for_each(|(path, file)| {
        let (mut entry, config) = archive
            .new_file(path)
            .compression_method(CompressionMethod::DEFLATE)
            .start()?;
        let deflate = DeflateEncoder::new(&mut entry, Compression::default());
        let mut writer = config.wrap(deflate);
        writer.write_all(file)?;
        let (deflate, descriptor) = writer.finish()?;
        deflate.finish()?;
        entry.finish(descriptor)?;
        Ok::<_, rawzip::Error>(())
    });
    packed
        .and_then(|()| archive.finish().map(drop))
        .map_err(|error| format!("the archive cannot be made: {error}"))?;
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_read_and_what_is_cut_or_leads_out_is_refused_in_one_sentence() {
        let files: [(&str, &[u8]); 2] = [("a/b.gltf", b"{}"), ("c.bin", &[7; 5000])];
        let packed = write(files).expect("an archive");
        let read_back = read(&packed).expect("it is one");
        let expected = files.map(|(path, file)| (PathBuf::from(path), file.to_vec()));
        assert_eq!(read_back, expected);
        for end in 0..packed.len() {
            let error = read(&packed[..end]).expect_err("it is cut");
            assert!(error.lines().count() == 1, "{error}");
        }
        let mut leads_out = packed.clone();
        for at in 0..packed.len() - 8 {
            if &packed[at..at + 8] == b"a/b.gltf" {
                leads_out[at..at + 8].copy_from_slice(b"../b.glt");
            }
        }
        for (path, _) in read(&leads_out).unwrap_or_default() {
            let inside = |part| matches!(part, std::path::Component::Normal(_));
            assert!(path.components().all(inside), "{}", path.display());
        }
    }

    #[test]
    fn a_damaged_file_is_not_taken() {
        let mut packed = write([("a.bin", &b"what it was"[..])]).expect("an archive");
        for at in 0..packed.len() {
            packed[at] ^= 1;
            let same = read(&packed)
                .ok()
                .is_none_or(|files| files.iter().all(|(_, file)| file == b"what it was"));
            assert!(same, "byte {at}");
            packed[at] ^= 1;
        }
    }
}
