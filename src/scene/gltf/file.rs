//! The file: its JSON, and where the bytes of its images lie.

use crate::base::error::{Error, Result};
use crate::scene::gltf::texels::Texels;
use ::gltf::json::Root;
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};
use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

/// The largest encoded image that is read: more than any texture of a real scene, less than what
/// would starve the machine if a scene pointed elsewhere by malice or mistake.
const MAX_IMAGE_BYTES: u64 = 1 << 28;

/// An open glTF file.
pub struct GltfFile {
    path: PathBuf,
    /// The JSON, parsed; nothing in it has been validated.
    pub root: Root,
    /// Where the binary chunk of a GLB lies: offset and length.
    chunk: Option<(u64, u64)>,
}

impl GltfFile {
    /// Reads the JSON of a `.gltf` or `.glb`, told apart by the first bytes.
    pub fn open(path: &Path) -> Result<Self> {
        let mut file = File::open(path).map_err(Error::io("read", path))?;
        let mut magic = Vec::new();
        file.by_ref().take(4).read_to_end(&mut magic).map_err(Error::io("read", path))?;
        let mut json = Vec::new();
        let mut chunk = None;
        if magic == b"glTF" {
            (json, chunk) = read_glb(&mut file).map_err(Error::io("read", path))?.map_err(|why| {
                Error::input(format!("{}: {why}; copy or export the file again", path.display()))
            })?;
        } else {
            json.append(&mut magic);
            file.read_to_end(&mut json).map_err(Error::io("read", path))?;
        }
        let root = Root::from_slice(&json).map_err(|e| {
            Error::input(format!("{}: not glTF 2.0: {e}; copy or export the file again", path.display()))
        })?;
        let version = &root.asset.version;
        if !version.starts_with("2.") {
            let version = crate::scene::gltf::printable(version);
            return Err(Error::input(format!(
                "{}: asset.version is {version:?}; gonio reads glTF 2: export the file again as that",
                path.display()
            )));
        }
        Ok(Self { path: path.to_owned(), root, chunk })
    }

    /// Decodes these images, each once, on all cores; an image that cannot be read gives the reason.
    pub fn texels(&self, images: BTreeSet<usize>) -> BTreeMap<usize, Result<Texels, String>> {
        images.into_par_iter().map(|i| (i, self.image(i).and_then(|bytes| Texels::decode(&bytes)))).collect()
    }

    /// What a person calls an image: its file, else its name, else its place.
    pub fn image_label(&self, index: usize) -> String {
        let image = self.root.images.get(index);
        let uri = image.and_then(|i| i.uri.as_deref()).filter(|uri| !uri.starts_with("data:"));
        let label = uri.or_else(|| image.and_then(|i| i.name.as_deref()));
        label.map_or_else(|| format!("images[{index}]"), crate::scene::gltf::printable)
    }

    /// The encoded bytes of an image.
    fn image(&self, index: usize) -> Result<Vec<u8>, String> {
        let image = self.root.images.get(index).ok_or("it does not exist")?;
        if let Some(uri) = &image.uri {
            return self.resource(uri, 0, None);
        }
        let view = image.buffer_view.ok_or("it has neither a uri nor a bufferView")?.value();
        let view = self.root.buffer_views.get(view).ok_or(format!("there is no bufferViews[{view}]"))?;
        let (offset, length) = (view.byte_offset.unwrap_or_default().0, view.byte_length.0);
        let index = view.buffer.value();
        let buffer = self.root.buffers.get(index).ok_or(format!("there is no buffers[{index}]"))?;
        match (&buffer.uri, self.chunk) {
            (Some(uri), _) => self.resource(uri, offset, Some(length)),
            (None, Some((start, size))) if index == 0 => {
                let inside = offset.checked_add(length).is_some_and(|end| end <= size);
                inside.then_some(()).ok_or("it lies beyond the end of the binary chunk")?;
                read_range(&self.path, start + offset, Some(length))
            }
            (None, _) => Err(format!("buffers[{index}] has no data")),
        }
    }

    /// The bytes behind a URI, from `offset`; `length` None: to the end.
    fn resource(&self, uri: &str, offset: u64, length: Option<u64>) -> Result<Vec<u8>, String> {
        if uri.starts_with("data:") {
            let url = data_url::DataUrl::process(uri).map_err(|e| format!("a broken data URI ({e:?})"))?;
            let (bytes, _) = url.decode_to_vec().map_err(|e| format!("a broken data URI ({e})"))?;
            let start = usize::try_from(offset).unwrap_or(usize::MAX);
            let rest = bytes.get(start..).unwrap_or_default();
            let length = length.map_or(rest.len(), |n| usize::try_from(n).unwrap_or(usize::MAX));
            return Ok(rest.get(..length).ok_or("it lies beyond the end of its buffer")?.to_vec());
        }
        if let Some((scheme, _)) = uri.split_once("://") {
            return Err(format!(
                "it is on the network ({}://), and gonio reads local files only",
                crate::scene::gltf::printable(scheme)
            ));
        }
        let decoded = percent_encoding::percent_decode_str(uri).decode_utf8();
        let relative = decoded.map_err(|_| "its URI is not UTF-8")?;
        let folder = self.path.parent().unwrap_or(Path::new(""));
        read_range(&folder.join(&*relative), offset, length)
    }
}

/// The JSON chunk of a GLB, and where its binary chunk lies; the file stands behind the magic bytes.
/// The outer result is the operating system's, the inner one says how the GLB is broken.
#[allow(clippy::type_complexity)] // one caller
fn read_glb(file: &mut File) -> std::io::Result<Result<(Vec<u8>, Option<(u64, u64)>), String>> {
    const JSON: u32 = u32::from_le_bytes(*b"JSON");
    const BIN: u32 = u32::from_le_bytes(*b"BIN\0");
    let size = file.metadata()?.len();
    let Some([version, length]) = read_words(file)? else {
        return Ok(Err("the GLB header is cut short".into()));
    };
    if version != 2 {
        return Ok(Err(format!("GLB version {version}; gonio reads version 2")));
    }
    if u64::from(length) > size {
        return Ok(Err(format!("the GLB is cut short: it should have {length} bytes and has {size}")));
    }
    let mut json = None;
    let mut at = 12;
    // The JSON comes first, then perhaps the binary chunk; readers ignore other chunks.
    while let Some([length, kind]) = read_words(file)? {
        let (start, length) = (at + 8, u64::from(length));
        at = start + length;
        if at > size {
            return Ok(Err(format!("the GLB is cut short: a chunk should end at byte {at} of {size}")));
        }
        match (kind, json.take()) {
            (JSON, None) => {
                let mut bytes = Vec::new();
                file.by_ref().take(length).read_to_end(&mut bytes)?;
                json = Some(bytes);
            }
            (_, None) => return Ok(Err("the GLB does not begin with a JSON chunk".into())),
            (BIN, Some(json)) => return Ok(Ok((json, Some((start, length))))),
            (_, some) => json = some,
        }
        file.seek(SeekFrom::Start(at))?;
    }
    Ok(json.map(|json| (json, None)).ok_or("the GLB has no JSON chunk".into()))
}

/// Two little-endian words; `None` at the end of the file.
fn read_words(file: &mut File) -> std::io::Result<Option<[u32; 2]>> {
    let mut bytes = Vec::new();
    file.by_ref().take(8).read_to_end(&mut bytes)?;
    let word = |at: usize| Some(u32::from_le_bytes(bytes.get(at..at + 4)?.try_into().ok()?));
    Ok(word(0).zip(word(4)).map(|(first, second)| [first, second]))
}

/// Bytes of a file; `length` None: to its end.
fn read_range(path: &Path, offset: u64, length: Option<u64>) -> Result<Vec<u8>, String> {
    let read = || -> std::io::Result<Result<Vec<u8>, String>> {
        // A device or a pipe could be read for ever.
        if !std::fs::metadata(path)?.is_file() {
            return Ok(Err("it is not a file".into()));
        }
        let mut file = File::open(path)?;
        file.seek(SeekFrom::Start(offset))?;
        let mut bytes = Vec::new();
        file.take(length.unwrap_or(u64::MAX).min(MAX_IMAGE_BYTES + 1)).read_to_end(&mut bytes)?;
        if bytes.len() as u64 > MAX_IMAGE_BYTES {
            return Ok(Err(format!("it is larger than {} MiB", MAX_IMAGE_BYTES >> 20)));
        }
        match length {
            Some(length) if length > bytes.len() as u64 => {
                Ok(Err("it lies beyond the end of its buffer".into()))
            }
            _ => Ok(Ok(bytes)),
        }
    };
    read().map_err(|e| format!("cannot be read ({e})"))?
}
