//! Pictures of light around a scene in the format of Radiance (`.hdr`): red, green and blue bytes
//! that share an exponent, in lines that may be run-length encoded.
//!
//! Lines are summed up as they are read, so that a large picture takes the memory of a small one.

use glam::DVec3;

use crate::legible::legible_name;

/// Most pixels of a file across and down.
pub const MAX_SIZE: [usize; 2] = [8192, 4096];
/// Most bytes of a file.
pub const MAX_BYTES: u64 = 160 << 20;
/// Most cells that pixels are summed up in, across and down.
const MAX_CELLS: [usize; 2] = [1024, 512];
/// Most bytes before the first line of pixels.
const MAX_HEAD: usize = 64 << 10;
/// Most light of a channel: what a word of a [`Panorama`](super::panorama::Panorama) holds.
pub const BRIGHTEST: f64 = 65_408.0;

/// The light that comes from every direction: its longitude grows from left to right, its height
/// falls from top to bottom, and the middle of the picture is towards -z.
#[derive(Clone, Debug)]
pub struct LightPicture {
    /// Cells across and down, each at least 1.
    pub size: [usize; 2],
    /// Linear RGB of every cell, each 0 to [`BRIGHTEST`]; row by row from the top.
    pub light: Vec<DVec3>,
    /// Pixels of the file that are brighter than [`BRIGHTEST`], which they count as.
    pub clamped: u64,
}

/// Reads a file.
///
/// # Errors
/// Completes a sentence that begins with the file: it is no such picture, cut off, or too large.
pub fn read(bytes: &[u8]) -> Result<LightPicture, String> {
    let mut input = bytes;
    let head = head(&mut input)?;
    let [width, height] = head.size;
    let size = [width.min(MAX_CELLS[0]), height.min(MAX_CELLS[1])];
    let mut sums = vec![(DVec3::ZERO, 0.0); size[0] * size[1]];
    let (mut row, mut clamped) = (vec![[0; 4]; width], 0);
    for y in 0..height {
        read_row(&mut input, &mut row).map_err(|fault| match fault {
            RowFault::End => format!(
                "is cut off in line {y} of its {height} lines of pixels; copy the whole file"
            ),
            RowFault::Garbled => format!(
                "is garbled in line {y} of its {height} lines of pixels; save it again as Radiance .hdr"
            ),
        })?;
        // The nearer to a pole, the less of all directions a pixel is.
        let weight = libm::sin(std::f64::consts::PI * (y as f64 + 0.5) / height as f64);
        let cells = &mut sums[y * size[1] / height * size[0]..][..size[0]];
        for (x, pixel) in row.iter().enumerate() {
            let light = light_of(*pixel) * head.brightness;
            clamped += u64::from(light.max_element() > BRIGHTEST);
            let (sum, weights) = &mut cells[x * size[0] / width];
            *sum += light.min(DVec3::splat(BRIGHTEST)) * weight;
            *weights += weight;
        }
    }
    let light = |(sum, weights): (DVec3, f64)| (sum / weights).min(DVec3::splat(BRIGHTEST));
    Ok(LightPicture {
        size,
        light: sums.into_iter().map(light).collect(),
        clamped,
    })
}

/// What a file says before its pixels.
struct Head {
    /// Pixels across and down, each at least 1.
    size: [usize; 2],
    /// What the numbers of pixels are multiplied with.
    brightness: f64,
}

fn head(input: &mut &[u8]) -> Result<Head, String> {
    const NOT_OURS: &str = "is no Radiance picture; save it as .hdr (32-bit_rle_rgbe)";
    let mut left = MAX_HEAD;
    let mut line = || {
        let end = input.iter().take(left).position(|byte| *byte == b'\n');
        let (line, rest) =
            input.split_at(end.ok_or("has no end of its head; save it again as .hdr")?);
        (*input, left) = (&rest[1..], left - line.len() - 1);
        Ok::<_, String>(String::from_utf8_lossy(line).trim_end().to_owned())
    };
    if !line().is_ok_and(|first| first.starts_with("#?")) {
        return Err(NOT_OURS.into());
    }
    let mut brightness = 1.0;
    loop {
        let line = line()?;
        if line.is_empty() {
            break;
        }
        match line
            .split_once('=')
            .map(|(key, value)| (key.trim(), value.trim()))
        {
            Some(("FORMAT", "32-bit_rle_rgbe")) => {}
            Some(("FORMAT", _)) => {
                return Err("holds no red, green and blue; save it as 32-bit_rle_rgbe".into());
            }
            Some(("EXPOSURE", value)) => {
                let exposure: f64 = value.parse().unwrap_or(f64::NAN);
                brightness /= exposure;
            }
            _ => {}
        }
    }
    if !(1e-30..=1e30).contains(&brightness) {
        return Err("has an exposure that is no number above 0; set EXPOSURE=1".into());
    }
    let line = line()?;
    let words: Vec<&str> = line.split_whitespace().collect();
    let ["-Y", height, "+X", width] = words[..] else {
        return Err("has no size, or its lines do not go from left to right and from top to bottom; save it upright (-Y height +X width)".into());
    };
    let size = [width, height].map(|side| side.parse().unwrap_or(0));
    let [most_width, most_height] = MAX_SIZE;
    if size.contains(&0) || size[0] > most_width || size[1] > most_height {
        let [width, height] = [width, height].map(|side| legible_name(side, 20));
        return Err(format!(
            "has {width} x {height} pixels; allowed: 1 x 1 to {most_width} x {most_height}"
        ));
    }
    Ok(Head { size, brightness })
}

/// Why a line of pixels cannot be read.
enum RowFault {
    /// The file ends before it does.
    End,
    Garbled,
}

fn take<'a>(input: &mut &'a [u8], count: usize) -> Result<&'a [u8], RowFault> {
    let (taken, rest) = input.split_at_checked(count).ok_or(RowFault::End)?;
    *input = rest;
    Ok(taken)
}

/// Reads one line of pixels: channel by channel with runs, or pixel by pixel with old runs.
fn read_row(input: &mut &[u8], row: &mut [[u8; 4]]) -> Result<(), RowFault> {
    let width = row.len();
    match *input {
        [2, 2, high, low, ..] if (8..0x8000).contains(&width) && *high < 128 => {
            if usize::from(u16::from_be_bytes([*high, *low])) != width {
                return Err(RowFault::Garbled);
            }
            take(input, 4)?;
            (0..4).try_for_each(|channel| read_channel(input, row, channel))
        }
        _ => read_pixels(input, row),
    }
}

fn read_channel(input: &mut &[u8], row: &mut [[u8; 4]], channel: usize) -> Result<(), RowFault> {
    let mut x = 0;
    while x < row.len() {
        let count = usize::from(take(input, 1)?[0]);
        let (is_run, count) = (count > 128, if count > 128 { count - 128 } else { count });
        let pixels = row
            .get_mut(x..x + count)
            .filter(|_| count > 0)
            .ok_or(RowFault::Garbled)?;
        let values = take(input, if is_run { 1 } else { count })?;
        for (pixel, value) in pixels.iter_mut().zip(values.iter().cycle()) {
            pixel[channel] = *value;
        }
        x += count;
    }
    Ok(())
}

fn read_pixels(input: &mut &[u8], row: &mut [[u8; 4]]) -> Result<(), RowFault> {
    let (mut x, mut shift) = (0, 0);
    while x < row.len() {
        let pixel = [0, 1, 2, 3].map(|_| 0u8);
        let pixel = take(input, 4)?.try_into().unwrap_or(pixel);
        let [1, 1, 1, count] = pixel else {
            row[x] = pixel;
            (x, shift) = (x + 1, 0);
            continue;
        };
        let before = x.checked_sub(1).ok_or(RowFault::Garbled)?;
        let count = usize::from(count)
            .checked_shl(shift)
            .filter(|_| shift <= 16);
        let end = count.map(|count| x + count).filter(|end| *end <= row.len());
        let end = end.ok_or(RowFault::Garbled)?;
        let repeated = row[before];
        row[x..end].fill(repeated);
        (x, shift) = (end, shift + 8);
    }
    Ok(())
}

/// Linear RGB of a pixel: a byte for each channel, and one for the exponent of all.
fn light_of([red, green, blue, exponent]: [u8; 4]) -> DVec3 {
    if exponent == 0 {
        return DVec3::ZERO;
    }
    // 2^(exponent − 136): 128 for zero, 8 for the bits of a byte.
    let scale = f64::from_bits((u64::from(exponent) + 1023 - 136) << 52);
    DVec3::new(red.into(), green.into(), blue.into()) * scale
}

/// A file with these pixels, row by row from the top, each linear RGB.
///
/// Lines are run-length encoded where the format allows it.
pub fn write(size: [usize; 2], light: &[DVec3]) -> Vec<u8> {
    let [width, height] = size;
    let head = format!("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {height} +X {width}\n");
    let mut bytes = head.into_bytes();
    for row in light.chunks(width.max(1)) {
        let row: Vec<[u8; 4]> = row.iter().map(|light| pixel_of(*light)).collect();
        if !(8..0x8000).contains(&width) {
            bytes.extend(row.iter().flatten());
            continue;
        }
        bytes.extend([2, 2, (width >> 8) as u8, width as u8]);
        for channel in 0..4 {
            let values: Vec<u8> = row.iter().map(|pixel| pixel[channel]).collect();
            write_channel(&mut bytes, &values);
        }
    }
    bytes
}

/// Three and more values that are the same as their number and one of them, others as they are.
fn write_channel(bytes: &mut Vec<u8>, values: &[u8]) {
    let mut plain: Vec<u8> = Vec::new();
    let end_plain = |bytes: &mut Vec<u8>, plain: &mut Vec<u8>| {
        for part in plain.chunks(128) {
            bytes.push(part.len() as u8);
            bytes.extend(part);
        }
        plain.clear();
    };
    let runs = values.chunk_by(|a, b| a == b);
    for run in runs.flat_map(|run| run.chunks(127)) {
        if run.len() < 3 {
            plain.extend(run);
        } else {
            end_plain(bytes, &mut plain);
            bytes.extend([128 + run.len() as u8, run[0]]);
        }
    }
    end_plain(bytes, &mut plain);
}

/// The pixel nearest to this light.
fn pixel_of(light: DVec3) -> [u8; 4] {
    let most = light.max_element();
    if most < 1e-30 {
        return [0; 4];
    }
    let (_, exponent) = libm::frexp(most * (256.0 / 255.5));
    let scale = f64::from_bits(((8 - exponent + 1023) as u64) << 52);
    let [red, green, blue] = (light * scale).round().to_array().map(|value| value as u8);
    [red, green, blue, (exponent + 128) as u8]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A picture whose light tells every pixel from others.
    fn picture(size: [usize; 2]) -> Vec<DVec3> {
        let light = |i: usize| DVec3::new(i as f64 + 0.5, 3.0, 0.25 * (i % 5) as f64) * 0.01;
        (0..size[0] * size[1]).map(light).collect()
    }

    #[test]
    fn light_is_read_as_it_was_written_within_half_of_the_last_bit() {
        for size in [[1, 1], [7, 3], [8, 2], [64, 32]] {
            let light = picture(size);
            let read = read(&write(size, &light)).expect("a whole file");
            assert_eq!((read.size, read.clamped), (size, 0));
            for (read, written) in read.light.iter().zip(&light) {
                let error = (*read - *written).abs().max_element();
                assert!(
                    error <= written.max_element() / 255.0,
                    "{read} for {written}"
                );
            }
        }
    }

    #[test]
    fn old_runs_exposures_and_pixels_that_are_too_bright_are_read() {
        let file = |head: &str, pixels: &[[u8; 4]]| {
            let head = format!("#?RGBE\n{head}\n-Y 1 +X 3\n");
            [head.as_bytes(), &pixels.concat()].concat()
        };
        let run = read(&file("EXPOSURE=2\n", &[[128, 64, 0, 129], [1, 1, 1, 2]])).expect("a run");
        assert_eq!(run.light, [DVec3::new(0.5, 0.25, 0.0); 3]);
        let bright = read(&file("", &[[128, 0, 0, 255], [0; 4], [0; 4]])).expect("a picture");
        assert_eq!((bright.light[0].x, bright.clamped), (BRIGHTEST, 1));
        // Cells whose sums are rounded up.
        for [width, height] in [[3000, 7], [2500, 1100]] {
            let head = format!("#?RGBE\n\n-Y {height} +X {width}\n");
            let pixels = [128, 128, 128, 255].repeat(width * height);
            let bright = read(&[head.as_bytes(), &pixels].concat()).expect("a picture");
            let most = bright.light.iter().map(|light| light.max_element());
            assert_eq!(most.fold(0.0, f64::max), BRIGHTEST, "{width} x {height}");
        }
        for pixels in [[[1, 1, 1, 2]; 3], [[9, 9, 9, 128], [1, 1, 1, 3], [0; 4]]] {
            let error = read(&file("", &pixels)).expect_err("runs of nothing, or too long");
            assert!(
                error.starts_with("is garbled in line 0 of its 1 "),
                "{error}"
            );
        }
    }

    #[test]
    fn hostile_files_are_refused_in_a_sentence_before_memory_is_taken() {
        let head = |text: &str| format!("#?RADIANCE\n{text}").into_bytes();
        let cases: [(Vec<u8>, &str); 10] = [
            (Vec::new(), "is no Radiance picture"),
            (b"\x89PNG\r\n\x1a\n\0\0".to_vec(), "is no Radiance picture"),
            (head("no end"), "has no end of its head"),
            (head(&"x\n".repeat(1 << 16)), "has no end of its head"),
            (
                head("FORMAT=32-bit_rle_xyze\n\n"),
                "holds no red, green and blue",
            ),
            (head("EXPOSURE=0\n\n-Y 1 +X 1\n"), "has an exposure"),
            (head("\n+Y 4 +X 4\n"), "has no size"),
            (head("\n-Y 100000 +X 4\n"), "has 4 x 100000 pixels"),
            (head("\n-Y \x1b[2J +X 4\n"), "has 4 x \\u{1b}[2J pixels"),
            (
                head("\n-Y 4096 +X 8192\n\x02\x02\x20\0"),
                "is cut off in line 0 of its 4096",
            ),
        ];
        for (bytes, said) in cases {
            let error = read(&bytes).expect_err(said);
            assert!(error.starts_with(said), "{error}");
        }
        let whole = write([64, 32], &picture([64, 32]));
        for length in 0..whole.len() {
            assert!(read(&whole[..length]).is_err(), "{length} bytes");
        }
    }
}
