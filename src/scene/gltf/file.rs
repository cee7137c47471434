//! The file: its JSON, and where the bytes of its images lie.

use crate::base::error::{Error, Result};
use crate::scene::gltf::printable;
use crate::scene::gltf::root::{Root, look_up};
use crate::scene::gltf::texels::Texels;
use crate::scene::gltf::uri::{Place, data_of, is_data};
use rayon::prelude::*;
use serde_json::Value;
use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};
use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};
use std::sync::{Arc, OnceLock};

/// The largest encoded image that is read: more than any texture of a real scene, less than what
/// would starve the machine if a scene pointed elsewhere by malice or mistake.
const MAX_IMAGE_BYTES: u64 = 1 << 28;

/// The longest JSON that is read. With data URIs it may hold a whole scene.
const MAX_JSON_BYTES: u64 = 1 << 28;

/// An open glTF file.
pub struct GltfFile {
    path: PathBuf,
    /// The JSON, parsed; nothing in it has been validated.
    pub root: Root,
    /// Where the binary chunk of a GLB lies: offset and length.
    chunk: Option<(u64, u64)>,
    /// The bytes of buffers that are data URIs, decoded when the first image in one is read.
    buffers: Vec<OnceLock<Result<Vec<u8>, String>>>,
}

/// Decoded images, by index; what cannot be read says why.
pub type Images = BTreeMap<usize, Arc<Result<Texels, String>>>;

/// Where the encoded bytes of an image lie.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Location<'a> {
    Uri(&'a str),
    View { buffer: usize, offset: u64, length: u64 },
}

impl GltfFile {
    /// Reads the JSON of a `.gltf` or `.glb`, told apart by the first bytes. The second result is what is odd about it.
    pub fn open(path: &Path) -> Result<(Self, Vec<String>)> {
        let refuse = |why: String| Error::input(format!("{}: {why}", path.display()));
        let mut file = File::open(path).map_err(Error::io("read", path))?;
        let mut magic = Vec::new();
        file.by_ref().take(4).read_to_end(&mut magic).map_err(Error::io("read", path))?;
        let mut json = Vec::new();
        let mut chunk = None;
        if magic == b"glTF" {
            (json, chunk) = read_glb(&mut file)
                .map_err(Error::io("read", path))?
                .map_err(|why| refuse(format!("{why}; copy or export the file again")))?;
        } else {
            json.append(&mut magic);
            file.take(MAX_JSON_BYTES + 1).read_to_end(&mut json).map_err(Error::io("read", path))?;
        }
        if json.len() as u64 > MAX_JSON_BYTES {
            let most = MAX_JSON_BYTES >> 20;
            return Err(refuse(format!(
                "its JSON is longer than {most} MiB; put its buffers into files or a .glb"
            )));
        }
        let text = String::from_utf8_lossy(&json);
        let mut warnings = Vec::new();
        if let Cow::Owned(_) = text {
            warnings.push("its JSON is not UTF-8: other bytes are read as \u{fffd}".into());
        }
        // Some exporters begin with a byte order mark, or pad the chunk with NUL.
        let text = text.strip_prefix('\u{feff}').unwrap_or(&text).trim_end_matches('\0');
        let root = Root::parse(text)
            .map_err(|e| refuse(format!("not glTF 2.0: {e}; copy or export the file again")))?;
        let version = &root.asset["version"];
        if !version.as_str().is_some_and(|version| version.starts_with("2.")) {
            let version = printable(&version.to_string());
            let remedy = "gonio reads glTF 2: export the file again as that";
            return Err(refuse(format!("asset.version is {version}; {remedy}")));
        }
        let buffers = root.buffers.iter().map(|_| OnceLock::new()).collect();
        Ok((Self { path: path.to_owned(), root, chunk, buffers }, warnings))
    }

    /// Decodes these images, each once, on all cores; an image that cannot be read gives the reason.
    pub fn texels(&self, images: BTreeSet<usize>) -> Images {
        let located = images.into_iter().map(|image| (image, self.locate(image)));
        let located: BTreeMap<_, _> = located.collect();
        // Several images may be of the same bytes.
        let different: BTreeSet<_> = located.values().flatten().copied().collect();
        let decode = |location| Arc::new(self.bytes(location).and_then(|bytes| Texels::decode(&bytes)));
        let decoded: BTreeMap<_, _> =
            different.into_par_iter().map(|location| (location, decode(location))).collect();
        let found = |location: Result<Location, String>| match location {
            Ok(location) => decoded[&location].clone(),
            Err(why) => Arc::new(Err(why)),
        };
        located.into_iter().map(|(image, location)| (image, found(location))).collect()
    }

    /// What a person calls an image: its file, else its name, else its place.
    pub fn image_label(&self, index: usize) -> String {
        let image = self.root.images.get(index).unwrap_or(&Value::Null);
        let uri = image["uri"].as_str().filter(|uri| !is_data(uri));
        let label = uri.or(image["name"].as_str());
        label.map_or_else(|| format!("images[{index}]"), brief)
    }

    fn locate(&self, image: usize) -> Result<Location<'_>, String> {
        let image = self.root.images.get(image).ok_or("it does not exist")?;
        if let Some(uri) = image["uri"].as_str() {
            return Ok(Location::Uri(uri));
        }
        if image["bufferView"].is_null() {
            return Err("it has neither a uri nor a bufferView".into());
        }
        let (index, view) = look_up(&self.root.buffer_views, &image["bufferView"], "bufferViews")?;
        let (buffer, _) = look_up(&self.root.buffers, &view["buffer"], "buffers")?;
        let number = |key: &str, default| match &view[key] {
            Value::Null => Ok(default),
            given => given.as_u64().ok_or(format!("bufferViews[{index}].{key} is no whole number")),
        };
        let length = number("byteLength", 0)?;
        if length == 0 {
            return Err(format!("bufferViews[{index}] has no byteLength"));
        }
        Ok(Location::View { buffer, offset: number("byteOffset", 0)?, length })
    }

    /// The encoded bytes of an image.
    fn bytes(&self, location: Location) -> Result<Cow<'_, [u8]>, String> {
        let (buffer, offset, length) = match location {
            Location::Uri(uri) if is_data(uri) => return data_of(uri).map(Cow::Owned),
            Location::Uri(uri) => return self.read_file(uri, 0, None).map(Cow::Owned),
            Location::View { buffer, offset, length } => (buffer, offset, length),
        };
        let beyond = "it lies beyond the end of its buffer";
        match (self.root.buffers[buffer]["uri"].as_str(), self.chunk) {
            (Some(uri), _) if is_data(uri) => {
                let bytes =
                    self.buffers[buffer].get_or_init(|| data_of(uri)).as_ref().map_err(Clone::clone)?;
                let [start, length] = [offset, length].map(|n| usize::try_from(n).unwrap_or(usize::MAX));
                let end = start.checked_add(length).ok_or(beyond)?;
                bytes.get(start..end).map(Cow::Borrowed).ok_or_else(|| beyond.into())
            }
            (Some(uri), _) => self.read_file(uri, offset, Some(length)).map(Cow::Owned),
            (None, Some((start, size))) if buffer == 0 => {
                let inside = offset.checked_add(length).is_some_and(|end| end <= size);
                inside.then_some(()).ok_or("it lies beyond the end of the binary chunk")?;
                read_range(&self.path, start + offset, Some(length)).map(Cow::Owned)
            }
            (None, _) => Err(format!("buffers[{buffer}] has no data")),
        }
    }

    /// The bytes of a file that a URI names, from `offset`; `length` None: to the end.
    fn read_file(&self, uri: &str, offset: u64, length: Option<u64>) -> Result<Vec<u8>, String> {
        let place = Place::of(uri)?;
        read_range(&place.find(self.path.parent().unwrap_or(Path::new(""))), offset, length)
    }
}

/// A name for a message: printable, and no more than its beginning.
fn brief(text: &str) -> String {
    const MOST: usize = 120;
    let label: String = printable(text).chars().take(MOST).collect();
    if text.chars().count() > MOST { format!("{label}…") } else { label }
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
                file.by_ref().take(length.min(MAX_JSON_BYTES + 1)).read_to_end(&mut bytes)?;
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
