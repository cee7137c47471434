//! URIs of images and buffers: data, or files. Exporters write them in many ways that are none by the standard.

use crate::scene::gltf::printable;
use data_url::DataUrl;
use percent_encoding::percent_decode_str;
use std::path::{Path, PathBuf};

/// Whether a URI holds its data.
pub fn is_data(uri: &str) -> bool {
    scheme(uri).is_some_and(|(scheme, _)| scheme.eq_ignore_ascii_case("data"))
}

/// The data of a `data:` URI.
pub fn data_of(uri: &str) -> Result<Vec<u8>, String> {
    let url = DataUrl::process(uri).map_err(|e| format!("a broken data URI ({e:?})"))?;
    url.decode_to_vec().map(|(bytes, _)| bytes).map_err(|e| format!("a broken data URI ({e})"))
}

/// A file that a URI names, beside the scene or from the root of the file system.
pub struct Place {
    /// As it must be written, percent-decoded.
    decoded: String,
    /// As it stands there.
    literal: String,
}

impl Place {
    /// Takes a URI apart; an error says why it names no file.
    pub fn of(uri: &str) -> Result<Self, String> {
        let path = match scheme(uri) {
            Some((scheme, rest)) if scheme.eq_ignore_ascii_case("file") => local(rest)?,
            Some((scheme, rest)) if rest.starts_with("//") => {
                return Err(format!(
                    "it is on the network ({}://), and gonio reads local files only",
                    printable(scheme)
                ));
            }
            _ => uri,
        };
        let decoded = percent_decode_str(path).decode_utf8().map_err(|_| "its URI is not UTF-8")?;
        Ok(Self { decoded: decoded.into_owned(), literal: path.into() })
    }

    /// The file in `folder`: as the standard has it, else as it is written, else with slashes for backslashes. Where there
    /// is none of them, the first.
    pub fn find(&self, folder: &Path) -> PathBuf {
        let slashes = |path: &str| path.replace('\\', "/");
        let names =
            [self.decoded.clone(), self.literal.clone(), slashes(&self.decoded), slashes(&self.literal)];
        let mut paths = names.into_iter().map(|name| folder.join(name));
        let first = paths.next().unwrap_or_default();
        if first.is_file() { first } else { paths.find(|path| path.is_file()).unwrap_or(first) }
    }
}

/// What stands behind `file:`, without the name of this computer.
fn local(rest: &str) -> Result<&str, String> {
    let path = match rest.strip_prefix("//") {
        None => rest,
        Some(rest) => {
            let (host, _) = rest.split_once('/').ok_or("its file: URI names no file")?;
            if !host.is_empty() && !host.eq_ignore_ascii_case("localhost") {
                let host = printable(host);
                return Err(format!("it is on the computer {host}, and gonio reads local files only"));
            }
            &rest[host.len()..]
        }
    };
    // file:///C:/textures/x.png
    let is_drive = |path: &str| path.as_bytes().get(2) == Some(&b':') && path.starts_with('/');
    Ok(if cfg!(windows) && is_drive(path) { &path[1..] } else { path })
}

/// The scheme of a URI, and what stands behind it. One letter is a drive of Windows.
fn scheme(uri: &str) -> Option<(&str, &str)> {
    let (scheme, rest) = uri.trim_start().split_once(':')?;
    let fits = |c: char| c.is_ascii_alphanumeric() || "+-.".contains(c);
    (scheme.len() > 1 && scheme.chars().all(fits)).then_some((scheme, rest))
}
