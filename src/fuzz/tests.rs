//! Mutated files, by a seeded chance. The long test runs each parser in a process of its own with 1 GiB of address space.

use super::*;
use crate::base::timings::Stopwatch;
use std::env;
use std::process::Command;

/// Says to the child which parser it is for.
const PARSER: &str = "GONIO_FUZZ_PARSER";
/// 1 GiB of address space, in KiB.
const SPACE: u64 = 1 << 20;

#[test]
fn every_seed_is_read_and_all_are_small() {
    let folder = tempfile::tempdir().unwrap();
    Parser::prepare(folder.path()).unwrap();
    let mut bytes = 0;
    for parser in PARSERS {
        let seeds = (parser.seeds)();
        assert!(!seeds.is_empty(), "{}", parser.name);
        for (k, seed) in seeds.iter().enumerate() {
            bytes += seed.len();
            // The buffer of the demo and the picture of the other scene are not there: a scene has warnings for them.
            parser.run(folder.path(), seed).unwrap_or_else(|error| panic!("{} {k}: {error}", parser.name));
        }
    }
    assert!(bytes < 100_000, "{bytes} bytes of seeds");
}

#[test]
fn a_few_mutated_files_are_read_or_refused() {
    for parser in PARSERS {
        mutate(parser, 100);
    }
}

/// 10⁷ inputs a parser, or `GONIO_MUTATIONS`; `GONIO_FUZZ` names one parser alone.
#[test]
#[ignore = "minutes to hours; scripts/test.sh --long"]
fn ten_million_mutated_files_are_read_or_refused() {
    if let Ok(name) = env::var(PARSER) {
        return mutate(Parser::find(&name).unwrap(), count());
    }
    let only = env::var("GONIO_FUZZ").ok();
    let mut failed = Vec::new();
    for parser in PARSERS.iter().filter(|parser| only.as_ref().is_none_or(|only| only == parser.name)) {
        let start = Stopwatch::start();
        let test = "fuzz::tests::ten_million_mutated_files_are_read_or_refused";
        let line = format!("ulimit -v {SPACE}; exec \"$0\" {test} --exact --ignored --nocapture");
        let mut child = Command::new("sh");
        let child = child.args(["-c", &line]).arg(env::current_exe().unwrap()).env(PARSER, parser.name);
        let output = child.output().unwrap();
        let (seconds, n) = (start.seconds(), count());
        println!("{:7} {n} inputs, {:.0} a second: {}", parser.name, n as f64 / seconds, output.status);
        if !output.status.success() {
            let text = [output.stdout, output.stderr].concat();
            failed.push(format!("{}: {}\n{}", parser.name, output.status, String::from_utf8_lossy(&text)));
        }
    }
    assert!(failed.is_empty(), "{}", failed.join("\n"));
}

fn count() -> u64 {
    env::var("GONIO_MUTATIONS").map_or(10_000_000, |count| count.parse().unwrap())
}

/// Runs a parser on mutated seeds. Where one panics or aborts, the file stays.
fn mutate(parser: &Parser, count: u64) {
    let memory = Path::new("/dev/shm");
    let folder = if memory.is_dir() { tempfile::tempdir_in(memory) } else { tempfile::tempdir() }.unwrap();
    let folder = folder.keep();
    Parser::prepare(&folder).unwrap();
    let seeds = (parser.seeds)();
    let mut refused = 0;
    for k in 0..count {
        let mut chance = Chance(k.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ 0x5851_f42d_4c95_7f2d);
        let seed = chance.below(seeds.len());
        let other = &seeds[chance.below(seeds.len())];
        let bytes = chance.change(&seeds[seed], other);
        refused += u64::from(parser.run(&folder, &bytes).is_err());
    }
    assert!(0 < refused && refused < count, "{}: {refused} of {count} refused", parser.name);
    fs::remove_dir_all(folder).unwrap();
}

/// SplitMix64 (Steele, Lea & Flood 2014).
struct Chance(u64);

impl Chance {
    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    fn below(&mut self, n: usize) -> usize {
        (self.bits() % n.max(1) as u64) as usize
    }

    /// Some places changed: bits, bytes, numbers of 1, 2, 4 and 8 bytes and in digits, parts lost, repeated or of another file.
    fn change(&mut self, bytes: &[u8], other: &[u8]) -> Vec<u8> {
        const WORDS: [&[u8]; 12] = [
            b"-1",
            b"0",
            b"2147483648",
            b"18446744073709551616",
            b"1e999",
            b"nan",
            b"null",
            b"\"\"",
            b"[]",
            b"{}",
            b"((",
            b"\xff\xfe",
        ];
        const EXTREMES: [u64; 8] =
            [0, 1, 0x7f, 0xff, 0x7fff_ffff, 0xffff_ffff, 0x7fff_ffff_ffff_ffff, u64::MAX];
        let mut bytes = bytes.to_vec();
        for _ in 0..=self.below(4) {
            let at = self.below(bytes.len());
            let length = self.below(16).min(bytes.len() - at);
            match self.below(9) {
                0 if at < bytes.len() => bytes[at] ^= 1 << self.below(8),
                1 if at < bytes.len() => bytes[at] = self.below(256) as u8,
                2 => drop(bytes.drain(at..at + length)),
                3 => {
                    let part = bytes[at..at + length].repeat(1 + self.below(20));
                    drop(bytes.splice(at..at, part));
                }
                4 => {
                    let number = EXTREMES[self.below(EXTREMES.len())].wrapping_sub(self.below(3) as u64);
                    let (big, size) = (self.below(2) == 0, 1 << self.below(4));
                    let number = if big {
                        number.to_be_bytes()[8 - size..].to_vec()
                    } else {
                        number.to_le_bytes()[..size].to_vec()
                    };
                    let size = size.min(bytes.len() - at);
                    bytes[at..at + size].copy_from_slice(&number[..size]);
                }
                5 => bytes.truncate(at.max(bytes.len() - bytes.len() / 4)),
                6 => {
                    let from = self.below(other.len());
                    let part = &other[from..(from + 4 * length).min(other.len())];
                    drop(bytes.splice(at..at + length, part.iter().copied()));
                }
                _ => {
                    // A number, if there is one from here on.
                    let start = bytes[at..].iter().position(u8::is_ascii_digit).map_or(at, |k| at + k);
                    let digits = bytes[start..].iter().take_while(|b| b.is_ascii_digit()).count();
                    let word = WORDS[self.below(WORDS.len())];
                    drop(bytes.splice(start..start + digits, word.iter().copied()));
                }
            }
        }
        bytes
    }
}
