//! Whether a JPEG is whole. Decoders fill what is missing with grey, or with what came before, and say nothing; so the
//! entropy-coded data are walked through here, code by code, without an inverse transform: every block must be there, every
//! code must be one of the tables', and every segment must end where its data do (ITU-T T.81, Annexes B, F and G).
//!
//! JPEG has no checksums: changed bits that are codes of as many blocks as before leave no trace.

use crate::scene::gltf::texels::check_size;
use std::array::from_fn;

pub const MAGIC: &[u8] = b"\xFF\xD8";

const EARLY: &str = "its data end early";
const NO_CODE: &str = "its data are corrupted";

/// Walks through the file; an error is what is wrong.
pub fn check(bytes: &[u8]) -> Result<(), String> {
    let mut walk = Walk { rest: &bytes[MAGIC.len()..], ..Walk::default() };
    loop {
        let marker = walk.marker()?;
        if marker == EOI {
            return walk.end();
        }
        let segment = walk.segment()?;
        match marker {
            0xC0..=0xC2 => walk.frame(marker == 0xC2, segment)?,
            0xC4 => walk.huffman_tables(segment)?,
            0xC3 | 0xC5..=0xCF => return Err("JPEG is not decoded where it is lossless or arithmetic".into()),
            0xDA => walk.scan(segment)?,
            0xDB => walk.quantisers(segment)?,
            0xDD => walk.restart = usize::from(short(segment, 0)?),
            0xE0..=0xEF | 0xFE => {}
            _ => return Err(format!("it has an unknown segment, FF{marker:02X}")),
        }
    }
}

const EOI: u8 = 0xD9;

/// Encoders make some ten of them; a file that is made to keep its readers busy has more.
const MAX_SCANS: usize = 100;

#[derive(Default)]
struct Walk<'a> {
    rest: &'a [u8],
    components: Vec<JpegComponent>,
    progressive: bool,
    /// The size in texels.
    size: [usize; 2],
    /// [DC, AC]
    tables: [[Option<Codes>; 4]; 2],
    /// The step of DC of each quantiser.
    steps: [i32; 4],
    /// The number of units between restart markers; 0: there are none.
    restart: usize,
    scans: usize,
}

#[derive(Clone)]
struct JpegComponent {
    id: u8,
    /// How many blocks it has in a unit of all components.
    sampling: [usize; 2],
    quantiser: usize,
    /// The lowest bit of each coefficient that is there.
    low: [u8; 64],
    /// The coefficients of each block that are not 0, where later scans refine them.
    nonzero: Vec<u64>,
}

/// What is not there yet.
const MISSING: u8 = u8::MAX;

impl<'a> Walk<'a> {
    fn take(&mut self, count: usize) -> Result<&'a [u8], String> {
        let (taken, rest) = self.rest.split_at_checked(count).ok_or(EARLY)?;
        self.rest = rest;
        Ok(taken)
    }

    fn marker(&mut self) -> Result<u8, String> {
        if self.take(1)? != [0xFF] {
            return Err("there are other bytes between its segments".into());
        }
        loop {
            match self.take(1)?[0] {
                0xFF => {}
                code => return Ok(code),
            }
        }
    }

    fn segment(&mut self) -> Result<&'a [u8], String> {
        let length = short(self.take(2)?, 0)?;
        self.take(usize::from(length).checked_sub(2).ok_or("it has a segment of no length")?)
    }

    fn frame(&mut self, progressive: bool, segment: &[u8]) -> Result<(), String> {
        let broken = "its frame is broken";
        let [8, _, _, _, _, count, rest @ ..] = segment else { return Err(broken.into()) };
        self.size = [usize::from(short(segment, 3)?), usize::from(short(segment, 1)?)];
        self.progressive = progressive;
        let components = rest.chunks_exact(3).map(|c| JpegComponent {
            id: c[0],
            sampling: [c[1] >> 4, c[1] & 15].map(usize::from),
            quantiser: usize::from(c[2] & 3),
            low: [MISSING; 64],
            nonzero: Vec::new(),
        });
        let again = !std::mem::replace(&mut self.components, components.collect()).is_empty();
        let sampled = self.components.iter().all(|c| c.sampling.iter().all(|s| (1..=4).contains(s)));
        let fits = rest.len() == 3 * usize::from(*count) && (1..=4).contains(count);
        if again || !sampled || !fits || self.size.contains(&0) {
            return Err(broken.into());
        }
        check_size(self.size.map(|side| side as u32))?;
        // A block has at least one bit.
        let units: usize = self.units().iter().product();
        let blocks = |component: &JpegComponent| units * component.sampling.iter().product::<usize>();
        if self.components.iter().map(blocks).sum::<usize>() > 8 * self.rest.len() {
            return Err(EARLY.into());
        }
        Ok(())
    }

    /// The largest sampling factor along each axis.
    fn sampling(&self) -> [usize; 2] {
        from_fn(|axis| self.components.iter().map(|c| c.sampling[axis]).max().unwrap_or(1))
    }

    /// How many units of all components there are along each axis.
    fn units(&self) -> [usize; 2] {
        let sampling = self.sampling();
        from_fn(|axis| self.size[axis].div_ceil(8 * sampling[axis]))
    }

    fn quantisers(&mut self, mut segment: &[u8]) -> Result<(), String> {
        while let [head, rest @ ..] = segment {
            let length = if head >> 4 == 0 { 64 } else { 128 };
            let steps = rest.get(..length).ok_or("its quantisers are cut short")?;
            let step = if length == 64 { u16::from(steps[0]) } else { short(steps, 0)? };
            self.steps[usize::from(head & 3)] = step.into();
            segment = &rest[length..];
        }
        Ok(())
    }

    fn huffman_tables(&mut self, mut segment: &[u8]) -> Result<(), String> {
        while let [head, rest @ ..] = segment {
            let short = "its code tables are cut short";
            let (counts, rest) = rest.split_at_checked(16).ok_or(short)?;
            let count = counts.iter().map(|&count| usize::from(count)).sum();
            let (symbols, rest) = rest.split_at_checked(count).ok_or(short)?;
            let codes = Codes::new(counts, symbols).ok_or("its code tables are corrupted")?;
            self.tables[usize::from(head >> 4 & 1)][usize::from(head & 3)] = Some(codes);
            segment = rest;
        }
        Ok(())
    }

    /// A scan: its header, and the entropy-coded data behind it.
    fn scan(&mut self, header: &[u8]) -> Result<(), String> {
        let broken = "the header of a scan is broken";
        let count = usize::from(*header.first().ok_or(broken)?);
        let (chosen, tail) = header[1..].split_at_checked(2 * count).ok_or(broken)?;
        let &[first, last, bits] = tail else { return Err(broken.into()) };
        let scan = SpectralBand {
            first: usize::from(first),
            last: usize::from(last),
            high: bits >> 4,
            low: bits & 15,
        };
        if scan.first > scan.last || scan.last > 63 || !(1..=4).contains(&count) || scan.low > 13 {
            return Err(broken.into());
        }
        self.scans += 1;
        if self.scans > MAX_SCANS {
            return Err(format!("it has more than {MAX_SCANS} scans"));
        }
        let units = self.units();
        let largest = self.sampling();
        let mut parts = Vec::new();
        for choice in chosen.chunks_exact(2) {
            let found = self.components.iter().position(|component| component.id == choice[0]);
            let component = found.ok_or("a scan is of a component that it does not have")?;
            parts.push((component, [choice[1] >> 4 & 3, choice[1] & 3].map(usize::from)));
        }
        for &(component, _) in &parts {
            let component = &mut self.components[component];
            component.low[scan.first..=scan.last].fill(scan.low);
            if self.progressive {
                let [width, height] = from_fn(|axis| units[axis] * component.sampling[axis]);
                component.nonzero.resize(width * height, 0);
            }
        }
        let alone = parts.len() == 1;
        let grid = match alone {
            false => units,
            true => {
                let own = self.components[parts[0].0].sampling;
                from_fn(|axis| (self.size[axis] * own[axis]).div_ceil(largest[axis]).div_ceil(8))
            }
        };
        let mut bits = Bits::new(self.rest);
        let mut state = State::default();
        for unit in 0..grid[0] * grid[1] {
            if self.restart > 0 && unit > 0 && unit % self.restart == 0 {
                self.rest = bits.end(&state)?;
                let expected = 0xD0 + ((unit / self.restart - 1) % 8) as u8;
                if self.marker()? != expected {
                    return Err("a restart marker of it is missing".into());
                }
                (bits, state) = (Bits::new(self.rest), State::default());
            }
            let at = [unit % grid[0], unit / grid[0]];
            for &(index, [dc, ac]) in &parts {
                let component = &mut self.components[index];
                let blocks = if alone { [1, 1] } else { component.sampling };
                let stride = units[0] * component.sampling[0];
                let tables = [self.tables[0][dc].as_ref(), self.tables[1][ac].as_ref()];
                for k in 0..blocks[0] * blocks[1] {
                    let [x, y] = [at[0] * blocks[0] + k % blocks[0], at[1] * blocks[1] + k / blocks[0]];
                    let mut block = Block { bits: &mut bits, state: &mut state, tables, band: &scan };
                    if scan.first == 0 {
                        block.dc(index, self.steps[component.quantiser])?;
                    }
                    if !self.progressive {
                        block.sequential()?;
                    } else if scan.first > 0 {
                        let nonzero = component.nonzero.get_mut(y * stride + x).ok_or(broken)?;
                        if scan.high == 0 { block.first(nonzero)? } else { block.refine(nonzero)? }
                    }
                }
            }
        }
        self.rest = bits.end(&state)?;
        Ok(())
    }

    /// The end of the file: every bit of every coefficient must have been there.
    fn end(&self) -> Result<(), String> {
        let whole = |component: &JpegComponent| component.low == [0; 64];
        if self.components.is_empty() || !self.components.iter().all(whole) {
            return Err("scans of it are missing".into());
        }
        Ok(())
    }
}

/// The coefficients and bits of a scan.
struct SpectralBand {
    first: usize,
    last: usize,
    high: u8,
    low: u8,
}

/// What the blocks of a segment carry on.
#[derive(Default)]
struct State {
    /// DC of each component's last block.
    dc: [i32; 4],
    /// The number of blocks without further coefficients.
    empty: u32,
}

/// One block of a component.
struct Block<'s, 'a> {
    bits: &'s mut Bits<'a>,
    state: &'s mut State,
    tables: [Option<&'s Codes>; 2],
    band: &'s SpectralBand,
}

impl Block<'_, '_> {
    fn dc(&mut self, component: usize, step: i32) -> Result<(), String> {
        if self.band.high > 0 {
            return self.bits.take(1).map(|_| ());
        }
        let size = self.bits.code(self.tables[0])?;
        // A difference of 8-bit DCs has 11 bits at most.
        if size > 11 {
            return Err(NO_CODE.into());
        }
        let raw = self.bits.take(size.into())? as i32;
        let negative = size > 0 && raw < 1 << (size - 1);
        let dc = &mut self.state.dc[component];
        *dc += if negative { raw + 1 - (1 << size) } else { raw };
        // 8-bit texels have DCs from −1024 to 1016; encoders that sharpen go a little beyond, and quantisers round.
        let step = step << self.band.low;
        let [dc, step] = [i64::from(*dc), i64::from(step)];
        if (dc * step).abs() > 1280 + 2 * step { Err(NO_CODE.into()) } else { Ok(()) }
    }

    /// AC of a block that comes at once.
    fn sequential(&mut self) -> Result<(), String> {
        let mut k = 1;
        while k < 64 {
            let (run, size) = self.run()?;
            match (run, size) {
                (0, 0) => break,
                (15, 0) => k += 16,
                (_, 0) => return Err(NO_CODE.into()),
                _ => k += run + 1,
            }
            if k > 64 {
                return Err(NO_CODE.into());
            }
            self.bits.take(size as u32)?;
        }
        Ok(())
    }

    /// The high bits of a band's coefficients.
    fn first(&mut self, nonzero: &mut u64) -> Result<(), String> {
        if self.state.empty > 0 {
            self.state.empty -= 1;
            return Ok(());
        }
        let mut k = self.band.first;
        while k <= self.band.last {
            let (run, size) = self.run()?;
            match (run, size) {
                (15, 0) => k += 16,
                (_, 0) => {
                    self.state.empty = (1 << run) + self.bits.take(run as u32)? - 1;
                    break;
                }
                _ => {
                    k += run;
                    self.bits.take(size as u32)?;
                    if k <= self.band.last {
                        *nonzero |= 1 << k;
                    }
                    k += 1;
                }
            }
            if k > self.band.last + 1 {
                return Err(NO_CODE.into());
            }
        }
        Ok(())
    }

    /// One further bit of a band's coefficients.
    fn refine(&mut self, nonzero: &mut u64) -> Result<(), String> {
        let old = *nonzero;
        let mut k = self.band.first;
        while self.state.empty == 0 && k <= self.band.last {
            let (mut run, size) = self.run()?;
            match size {
                0 if run < 15 => {
                    self.state.empty = (1 << run) + self.bits.take(run as u32)?;
                    break;
                }
                0 | 1 => self.bits.take(size as u32)?,
                _ => return Err(NO_CODE.into()),
            };
            while k <= self.band.last {
                if old >> k & 1 == 1 {
                    self.bits.take(1)?;
                } else if run == 0 {
                    break;
                } else {
                    run -= 1;
                }
                k += 1;
            }
            if k > self.band.last {
                return Err(NO_CODE.into());
            }
            *nonzero |= (size as u64) << k;
            k += 1;
        }
        if self.state.empty > 0 {
            let rest = (k..=self.band.last).filter(|k| old >> k & 1 == 1).count();
            (0..rest).try_for_each(|_| self.bits.take(1).map(|_| ()))?;
            self.state.empty -= 1;
        }
        Ok(())
    }

    /// A code of AC: how many zeros there are, and how many bits the coefficient behind them has.
    fn run(&mut self) -> Result<(usize, usize), String> {
        let code = self.bits.code(self.tables[1])?;
        let (run, size) = (usize::from(code >> 4), usize::from(code & 15));
        // A coefficient of 8-bit texels has 10 bits at most.
        if size > 10 { Err(NO_CODE.into()) } else { Ok((run, size)) }
    }
}

/// A table of codes: by the next 16 bits, how many of them are the code, and what it means.
struct Codes(Vec<(u8, u8)>);

impl Codes {
    fn new(counts: &[u8], symbols: &[u8]) -> Option<Self> {
        let mut table = vec![(0, 0); 1 << 16];
        let (mut next, mut symbols) = (0, symbols.iter());
        for (length, &count) in (1_u8..).zip(counts) {
            for _ in 0..count {
                let width = 1 << (16 - length);
                table.get_mut(next..next + width)?.fill((length, *symbols.next()?));
                next += width;
            }
        }
        Some(Self(table))
    }
}

/// Entropy-coded bits up to the next marker.
struct Bits<'a> {
    rest: &'a [u8],
    /// Bits that were read and not used, from the highest on.
    buffer: u64,
    count: u32,
}

impl<'a> Bits<'a> {
    fn new(rest: &'a [u8]) -> Self {
        Self { rest, buffer: 0, count: 0 }
    }

    fn fill(&mut self) {
        while self.count <= 56 {
            let (byte, length) = match self.rest {
                [0xFF, 0, ..] => (0xFF, 2),
                [0xFF, ..] | [] => break,
                [byte, ..] => (*byte, 1),
            };
            self.buffer |= u64::from(byte) << (56 - self.count);
            self.count += 8;
            self.rest = &self.rest[length..];
        }
    }

    fn drop(&mut self, count: u32) -> Result<(), String> {
        self.count = self.count.checked_sub(count).ok_or(EARLY)?;
        self.buffer <<= count;
        Ok(())
    }

    /// The next bits, 16 at most.
    fn take(&mut self, count: u32) -> Result<u32, String> {
        if count == 0 {
            return Ok(0);
        }
        if self.count < count {
            self.fill();
        }
        let bits = (self.buffer >> (64 - count)) as u32;
        self.drop(count)?;
        Ok(bits)
    }

    fn code(&mut self, codes: Option<&Codes>) -> Result<u8, String> {
        let codes = codes.ok_or("it has no table for its codes")?;
        if self.count < 16 {
            self.fill();
        }
        let (length, symbol) = codes.0[(self.buffer >> 48) as usize];
        match length {
            0 if self.count < 16 => Err(EARLY.into()),
            0 => Err(NO_CODE.into()),
            length => self.drop(length.into()).map(|()| symbol),
        }
    }

    /// The end of a segment: less than a byte is left before the marker. Returns what follows.
    fn end(mut self, state: &State) -> Result<&'a [u8], String> {
        self.fill();
        if self.count >= 8 || state.empty > 0 {
            return Err("its data are corrupted: there are more of them than texels".into());
        }
        Ok(self.rest)
    }
}

fn short(bytes: &[u8], at: usize) -> Result<u16, String> {
    let pair = bytes.get(at..at + 2).and_then(|pair| pair.try_into().ok());
    pair.map(u16::from_be_bytes).ok_or_else(|| "a segment of it is cut short".into())
}
