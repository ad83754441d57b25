//! Contact sheets: pictures of one size in a grid, with a title above and a caption below each.

use noto_sans_mono_bitmap::{FontWeight, RasterHeight, get_raster, get_raster_width};

/// Pixels between pictures, and around all of them.
const GAP: usize = 8;

const TEXT: RasterHeight = RasterHeight::Size16;
const WEIGHT: FontWeight = FontWeight::Regular;

/// Height of a line of text, pixels.
const LINE: usize = 22;

const GROUND: [u8; 4] = [24, 25, 28, 255];
const INK: [u8; 4] = [220, 222, 226, 255];

/// What a character that the font lacks looks like.
const UNKNOWN: char = '?';

/// A picture with its caption.
pub struct Picture {
    pub caption: String,
    /// sRGB with alpha, row by row.
    pub color: Vec<[u8; 4]>,
}

/// A sheet under construction.
pub struct ContactSheet {
    columns: usize,
    /// Of each picture, pixels.
    cell: [usize; 2],
    size: [usize; 2],
    color: Vec<[u8; 4]>,
}

/// Width and height of a sheet for `count` pictures of `cell` pixels, before anything is allocated.
pub fn size_of(columns: usize, count: usize, cell: [u32; 2]) -> [u64; 2] {
    let (gap, line, columns) = (GAP as u64, LINE as u64, columns.max(1) as u64);
    let [width, height] = cell.map(u64::from);
    [
        gap + columns * (width + gap),
        line + (count as u64).div_ceil(columns) * (height + line + gap) + gap,
    ]
}

impl ContactSheet {
    /// An empty sheet for `count` pictures of `cell` pixels.
    pub fn new(title: &str, columns: usize, count: usize, cell: [u32; 2]) -> Self {
        let [width, height] = size_of(columns, count, cell).map(|side| side as usize);
        let (columns, cell) = (columns.max(1), cell.map(|side| side as usize));
        let mut sheet = Self {
            columns,
            cell,
            size: [width, height],
            color: vec![GROUND; width * height],
        };
        sheet.write(title, [GAP, 3], width - 2 * GAP);
        sheet
    }

    /// The size in pixels.
    pub fn size(&self) -> [u32; 2] {
        self.size.map(|side| side as u32)
    }

    pub fn color(&self) -> &[[u8; 4]] {
        &self.color
    }

    /// Upper left corner of the picture with this index, pixels.
    pub fn corner(&self, index: usize) -> [usize; 2] {
        let [column, row] = [index % self.columns, index / self.columns];
        [
            GAP + column * (self.cell[0] + GAP),
            LINE + GAP + row * (self.cell[1] + LINE + GAP),
        ]
    }

    /// Puts a picture in its place.
    pub fn put(&mut self, index: usize, picture: &Picture) {
        let [left, top] = self.corner(index);
        let [width, height] = self.cell;
        for (y, row) in picture.color.chunks(width.max(1)).take(height).enumerate() {
            let at = (top + y) * self.size[0] + left;
            for (to, from) in self.color[at..at + row.len()].iter_mut().zip(row) {
                *to = over(*to, *from);
            }
        }
        self.write(&picture.caption, [left, top + height + 2], width);
    }

    /// Writes a line of text, cut off with two dots where it does not fit into `width` pixels.
    fn write(&mut self, text: &str, [left, top]: [usize; 2], width: usize) {
        let advance = get_raster_width(WEIGHT, TEXT);
        let most = width / advance;
        let mut letters: Vec<char> = text.chars().collect();
        if letters.len() > most {
            letters.truncate(most.saturating_sub(2));
            letters.extend(std::iter::repeat_n('.', 2.min(most)));
        }
        for (at, letter) in letters.into_iter().enumerate() {
            let Some(glyph) =
                get_raster(letter, WEIGHT, TEXT).or_else(|| get_raster(UNKNOWN, WEIGHT, TEXT))
            else {
                continue;
            };
            for (y, row) in glyph.rows().enumerate() {
                for (x, strength) in row.iter().enumerate() {
                    let to = (top + y) * self.size[0] + left + at * advance + x;
                    if let Some(pixel) = self.color.get_mut(to) {
                        *pixel = over(*pixel, [INK[0], INK[1], INK[2], *strength]);
                    }
                }
            }
        }
    }
}

/// A color over an opaque one, as alpha says.
fn over(below: [u8; 4], [r, g, b, alpha]: [u8; 4]) -> [u8; 4] {
    let mix = |below: u8, above: u8| {
        let (below, above, alpha) = (u32::from(below), u32::from(above), u32::from(alpha));
        ((above * alpha + below * (255 - alpha) + 127) / 255) as u8
    };
    [mix(below[0], r), mix(below[1], g), mix(below[2], b), 255]
}

#[cfg(test)]
mod tests {
    use super::*;

    const RED: [u8; 4] = [200, 10, 10, 255];

    /// Pixels of the sheet that are neither ground nor red, in a box of rows.
    fn ink(sheet: &ContactSheet, rows: std::ops::Range<usize>) -> usize {
        let width = sheet.size[0];
        sheet.color[rows.start * width..rows.end * width]
            .iter()
            .filter(|color| **color != GROUND && **color != RED)
            .count()
    }

    #[test]
    fn every_picture_lies_in_its_place_and_has_its_caption() {
        let mut sheet = ContactSheet::new("facet", 3, 5, [40, 30]);
        assert_eq!(sheet.size(), [8 + 3 * 48, 22 + 2 * 60 + 8]);
        for index in 0..5 {
            sheet.put(
                index,
                &Picture {
                    caption: format!("{index}"),
                    color: vec![RED; 40 * 30],
                },
            );
        }
        let width = sheet.size[0];
        for index in 0..5 {
            let [x, y] = sheet.corner(index);
            let is_red = |x: usize, y: usize| sheet.color[y * width + x] == RED;
            assert!(
                is_red(x, y) && is_red(x + 39, y + 29) && !is_red(x + 40, y) && !is_red(x, y + 30),
                "{index}"
            );
            assert!(
                ink(&sheet, y + 30..y + 30 + LINE) > 10,
                "{index} has no caption"
            );
        }
        assert_eq!(
            sheet.color.iter().filter(|color| **color == RED).count(),
            5 * 40 * 30
        );
        assert!(ink(&sheet, 0..LINE) > 20, "the title is missing");
    }

    #[test]
    fn a_long_caption_is_cut_off_and_what_the_font_lacks_is_a_question_mark() {
        let mut long = ContactSheet::new("", 1, 1, [40, 8]);
        long.put(
            0,
            &Picture {
                caption: "a much too long caption".into(),
                color: vec![RED; 40 * 8],
            },
        );
        let right = long.size[0] - GAP;
        assert!((0..long.size[1]).all(|y| {
            long.color[y * long.size[0] + right..(y + 1) * long.size[0]]
                .iter()
                .all(|c| *c == GROUND)
        }));
        let written = |caption: &str| {
            let mut sheet = ContactSheet::new("", 1, 1, [40, 8]);
            sheet.put(
                0,
                &Picture {
                    caption: caption.into(),
                    color: vec![RED; 40 * 8],
                },
            );
            sheet.color
        };
        assert!(written("\u{1F600}") == written("?") && written("a") != written("?"));
    }

    #[test]
    fn the_size_of_a_sheet_is_known_before_it_is_made() {
        assert_eq!(
            ContactSheet::new("", 3, 5, [40, 30]).size().map(u64::from),
            size_of(3, 5, [40, 30])
        );
        let largest = size_of(32, 1024, [16_384; 2]);
        assert!(largest.iter().all(|side| *side > 500_000), "{largest:?}");
    }

    #[test]
    fn transparent_pictures_lie_on_the_ground() {
        assert_eq!(over(GROUND, [255, 255, 255, 0]), GROUND);
        assert_eq!(over(GROUND, [1, 2, 3, 255]), [1, 2, 3, 255]);
    }
}
