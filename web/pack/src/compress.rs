//! Compressed copies for servers to send: gzip for all browsers, brotli for those of the last ten years.

use std::io::Write;
use std::path::Path;

use flate2::Compression;
use flate2::write::GzEncoder;

use crate::names;
use crate::page::File;

/// A file with its compressed copies, which are missing if they would not be smaller.
#[derive(Debug)]
pub struct Packed {
    /// The file without compression.
    pub file: File,
    /// The copy by gzip.
    pub gzip: Option<Vec<u8>>,
    /// The copy by brotli.
    pub brotli: Option<Vec<u8>>,
}

impl Packed {
    /// Returns the bytes that travel to a browser that understands gzip.
    pub fn gzip_len(&self) -> usize {
        self.gzip.as_ref().unwrap_or(&self.file.bytes).len()
    }

    /// Returns the bytes that travel to a browser that understands brotli.
    pub fn brotli_len(&self) -> usize {
        self.brotli.as_ref().unwrap_or(&self.file.bytes).len()
    }
}

/// Returns how many bytes a text has: uncompressed, by gzip, by brotli.
pub fn sizes(text: &[u8]) -> [usize; 3] {
    [text.len(), gzip(text).len(), brotli(text).len()]
}

/// Compresses files. Copies by brotli in `earlier`, from an earlier run, are reused if they decompress to the same
/// bytes; gzip is fast enough to be run again.
pub fn all(files: Vec<File>, earlier: &Path) -> Vec<Packed> {
    let packed = files.into_iter().map(|file| {
        // Some files get no copies: the format of pictures, for one, is compressed already.
        let gets_copies = names::is_compressed(&file.path);
        let smaller = |copy: Vec<u8>| (copy.len() < file.bytes.len()).then_some(copy);
        let by_gzip = gets_copies.then(|| gzip(&file.bytes)).and_then(smaller);
        let by_brotli = gets_copies
            .then(|| {
                let earlier_copy = earlier.join(format!("{}.br", file.path));
                kept(&earlier_copy, &file.bytes).unwrap_or_else(|| brotli(&file.bytes))
            })
            .and_then(smaller);
        Packed {
            file,
            gzip: by_gzip,
            brotli: by_brotli,
        }
    });
    packed.collect()
}

/// Returns the copy of an earlier run. Compressing the module takes half a minute, reading a copy a moment.
fn kept(copy: &Path, bytes: &[u8]) -> Option<Vec<u8>> {
    let compressed = std::fs::read(copy).ok()?;
    let mut plain = Vec::with_capacity(bytes.len());
    brotli::BrotliDecompress(&mut compressed.as_slice(), &mut plain).ok()?;
    (plain == bytes).then_some(compressed)
}

fn gzip(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::best());
    let written = encoder.write_all(bytes).and_then(|()| encoder.finish());
    written.expect("memory can be written to")
}

/// Returns about how many bytes a text has by brotli: a little more than [`sizes`] says, in a hundredth of the time.
pub fn quick_len(bytes: &[u8]) -> usize {
    brotli_at(5, bytes).len()
}

fn brotli(bytes: &[u8]) -> Vec<u8> {
    brotli_at(11, bytes)
}

/// Compresses by brotli; 11 is the highest quality.
fn brotli_at(quality: i32, bytes: &[u8]) -> Vec<u8> {
    let parameters = brotli::enc::BrotliEncoderParams {
        quality,
        // The largest window that browsers accept.
        lgwin: 24,
        size_hint: bytes.len(),
        ..Default::default()
    };
    let mut compressed = Vec::new();
    brotli::BrotliCompress(&mut &bytes[..], &mut compressed, &parameters)
        .expect("memory can be written to");
    compressed
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Read;

    fn file(path: &str, bytes: Vec<u8>) -> File {
        File {
            path: path.to_owned(),
            bytes,
            to_start: true,
            hashed: true,
        }
    }

    #[test]
    fn copies_give_the_file_back() {
        let bytes = b"one sample, two samples, three samples; ".repeat(100);
        let folder = tempfile::tempdir().unwrap();
        let packed = all(vec![file("a.js", bytes.clone())], folder.path());
        let (gzip, brotli) = (packed[0].gzip.as_ref(), packed[0].brotli.as_ref());
        let (gzip, brotli) = (gzip.unwrap(), brotli.unwrap());
        assert!(brotli.len() < gzip.len() && gzip.len() < bytes.len() / 10);
        assert_eq!(packed[0].gzip_len(), gzip.len());
        let mut plain = Vec::new();
        flate2::read::GzDecoder::new(&gzip[..])
            .read_to_end(&mut plain)
            .unwrap();
        assert_eq!(plain, bytes);
        plain.clear();
        brotli::BrotliDecompress(&mut &brotli[..], &mut plain).unwrap();
        assert_eq!(plain, bytes);
    }

    #[test]
    fn an_earlier_copy_serves_only_its_own_bytes() {
        let folder = tempfile::tempdir().unwrap();
        let copy = folder.path().join("a.js.br");
        let bytes = b"many words, many words, many words".to_vec();
        // Compressed with other settings, so that the reused copy can be recognised.
        let parameters = brotli::enc::BrotliEncoderParams {
            quality: 1,
            ..Default::default()
        };
        let mut other = Vec::new();
        brotli::BrotliCompress(&mut &bytes[..], &mut other, &parameters).unwrap();
        std::fs::write(&copy, &other).unwrap();
        assert_eq!(kept(&copy, &bytes), Some(other.clone()));
        assert_eq!(kept(&copy, b"other words"), None);
        std::fs::write(&copy, &other[..other.len() / 2]).unwrap();
        assert_eq!(kept(&copy, &bytes), None);
    }

    #[test]
    fn what_would_not_be_smaller_has_no_copy() {
        let folder = tempfile::tempdir().unwrap();
        let files = vec![file("a.js", b"x".to_vec()), file("a.png", vec![0; 1000])];
        for packed in all(files, folder.path()) {
            assert!(packed.gzip.is_none() && packed.brotli.is_none());
            assert_eq!(packed.brotli_len(), packed.file.bytes.len());
        }
    }
}
