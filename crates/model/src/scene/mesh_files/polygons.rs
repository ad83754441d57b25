//! Polygons: cuts one into triangles, ear by ear. The time grows with the square of the corners,
//! whatever the polygon looks like.

use glam::{DVec2, DVec3};

use crate::work::{Canceled, checkpoint};

/// Most corners of a polygon that is not convex.
pub const MOST_CORNERS: usize = 16_384;

/// Appends the triangles of a polygon to `triangles`, as indices of its corners, which are finite.
/// False where it has too many corners.
pub fn cut(corners: &[DVec3], triangles: &mut Vec<[u32; 3]>) -> Result<bool, Canceled> {
    let count = corners.len() as u32;
    let fan = |triangles: &mut Vec<_>| triangles.extend((2..count).map(|i| [0, i - 1, i]));
    if count <= 3 {
        fan(triangles);
        return Ok(true);
    }
    let flat = flattened(corners);
    if is_convex(&flat) {
        fan(triangles);
        return Ok(true);
    }
    if corners.len() > MOST_CORNERS {
        return Ok(false);
    }
    Clipping::of(&flat).run(triangles)?;
    Ok(true)
}

/// The polygon without the axis that it faces most, such that it is counter-clockwise.
fn flattened(corners: &[DVec3]) -> Vec<DVec2> {
    let origin = corners[0];
    let pairs = corners.windows(2);
    let normal: DVec3 = pairs
        .map(|pair| (pair[0] - origin).cross(pair[1] - origin))
        .sum();
    let size = normal.abs();
    let axis = (0..3).fold(0, |most, axis| match size[axis] > size[most] {
        true => axis,
        false => most,
    });
    let [mut u, mut v] = [(axis + 1) % 3, (axis + 2) % 3];
    if normal[axis] < 0.0 {
        (u, v) = (v, u);
    }
    let place = |corner: &DVec3| DVec2::new(corner[u], corner[v]);
    corners.iter().map(place).collect()
}

/// Twice the area of a triangle; positive where it is counter-clockwise.
fn turn(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    (b - a).perp_dot(c - a)
}

/// Does it turn left everywhere, and around only once?
fn is_convex(corners: &[DVec2]) -> bool {
    let count = corners.len();
    let at = |i: usize| corners[i % count];
    let turns_left = (0..count).all(|i| turn(at(i), at(i + 1), at(i + 2)) >= 0.0);
    let rises = |i: usize| at(i + 1).y > at(i).y || at(i + 1).y == at(i).y && at(i + 1).x > at(i).x;
    let peaks = (0..count).filter(|&i| rises(i) && !rises(i + 1)).count();
    turns_left && peaks <= 1
}

/// What may not lie in an ear. Where corners touch or edges cross, the strictest rule may leave no
/// ear.
#[derive(Clone, Copy, PartialEq, PartialOrd)]
enum Rule {
    /// No corner in it or on its edges.
    NoneTouches,
    /// No corner in it.
    NoneInside,
    Anything,
}

/// A polygon whose ears are cut off.
struct Clipping<'a> {
    corners: &'a [DVec2],
    previous: Vec<u32>,
    next: Vec<u32>,
    is_ear: Vec<bool>,
    rule: Rule,
}

impl<'a> Clipping<'a> {
    fn of(corners: &'a [DVec2]) -> Self {
        let count = corners.len() as u32;
        Self {
            corners,
            previous: (0..count).map(|i| (i + count - 1) % count).collect(),
            next: (0..count).map(|i| (i + 1) % count).collect(),
            is_ear: vec![false; corners.len()],
            rule: Rule::NoneTouches,
        }
    }

    fn run(mut self, triangles: &mut Vec<[u32; 3]>) -> Result<(), Canceled> {
        let mut left = self.corners.len();
        let mut at = 0;
        self.find_ears(at)?;
        let (checkpoint, mut missed) = (checkpoint(), 0);
        while left > 3 {
            if self.is_ear[at as usize] {
                checkpoint.pass()?;
                let [before, after] = [self.previous[at as usize], self.next[at as usize]];
                triangles.push([before, at, after]);
                self.next[before as usize] = after;
                self.previous[after as usize] = before;
                self.is_ear[before as usize] = self.is_now_ear(before);
                self.is_ear[after as usize] = self.is_now_ear(after);
                (left, missed) = (left - 1, 0);
                // Taking every other corner makes no slivers of a round outline.
                at = self.next[after as usize];
                continue;
            }
            (at, missed) = (self.next[at as usize], missed + 1);
            if missed >= left {
                self.rule = match self.rule {
                    Rule::NoneTouches => Rule::NoneInside,
                    Rule::NoneInside => Rule::Anything,
                    Rule::Anything => break,
                };
                self.find_ears(at)?;
                missed = 0;
            }
        }
        // What is left is a triangle, or has no area.
        let mut second = self.next[at as usize];
        for _ in 2..left {
            let third = self.next[second as usize];
            triangles.push([at, second, third]);
            second = third;
        }
        Ok(())
    }

    /// Finds the ears among the corners that are left, of which `start` is one.
    fn find_ears(&mut self, start: u32) -> Result<(), Canceled> {
        let (checkpoint, mut at) = (checkpoint(), start);
        loop {
            checkpoint.pass()?;
            self.is_ear[at as usize] = self.is_now_ear(at);
            at = self.next[at as usize];
            if at == start {
                return Ok(());
            }
        }
    }

    fn triangle(&self, corner: u32) -> [DVec2; 3] {
        let corner = corner as usize;
        [
            self.previous[corner] as usize,
            corner,
            self.next[corner] as usize,
        ]
        .map(|i| self.corners[i])
    }

    fn is_now_ear(&self, corner: u32) -> bool {
        let [a, b, c] = self.triangle(corner);
        if turn(a, b, c) <= 0.0 {
            return false;
        }
        let is_free = |p: DVec2| {
            let least = turn(a, b, p).min(turn(b, c, p)).min(turn(c, a, p));
            match self.rule {
                Rule::NoneTouches => least < 0.0 || p == a || p == b || p == c,
                Rule::NoneInside => least <= 0.0,
                Rule::Anything => true,
            }
        };
        let [first, end] = [self.next[corner as usize], self.previous[corner as usize]];
        let mut other = self.next[first as usize];
        while other != end {
            if !is_free(self.corners[other as usize]) {
                return false;
            }
            other = self.next[other as usize];
        }
        true
    }
}
