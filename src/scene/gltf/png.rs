//! Whether a PNG is whole: its chunks carry checksums, up to the last one. Decoders pass over broken chunks that they call
//! ancillary, among them the one with the alpha of a palette.

pub const MAGIC: &[u8] = b"\x89PNG\r\n\x1A\n";

/// Reads all chunks; an error is what is wrong.
pub fn check(bytes: &[u8]) -> Result<(), String> {
    let mut rest = &bytes[MAGIC.len()..];
    loop {
        let chunk = || {
            let length = usize::try_from(word(rest, 0)?).ok()?;
            let body = rest.get(4..length.checked_add(8)?)?;
            Some((body, word(rest, length + 8)?))
        };
        let (body, checksum) = chunk().ok_or("the file ends early")?;
        if crc32fast::hash(body) != checksum {
            return Err(format!("its chunk {} is corrupted", body[..4].escape_ascii()));
        }
        if body.starts_with(b"IEND") {
            return Ok(());
        }
        rest = &rest[body.len() + 8..];
    }
}

fn word(bytes: &[u8], at: usize) -> Option<u32> {
    Some(u32::from_be_bytes(bytes.get(at..at.checked_add(4)?)?.try_into().ok()?))
}
