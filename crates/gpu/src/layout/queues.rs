//! The queues of triangles that wait for the clip, medium, large and tile kernels: the capacity of
//! each, and what a frame demanded.

use super::{glass::FIRST_LAYERS, records::CounterRecord};
use crate::{frame::Counters, scene::Scene, shader::key::KernelKey};

/// Entries that fit each queue.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Capacities {
    pub clip: u32,
    pub clipped_triangles: u32,
    pub medium: u32,
    pub large: u32,
    pub tiles: u32,
    /// Layers of glass.
    pub glass: u32,
}

impl Capacities {
    /// Room for an entry everywhere: no binding may be empty.
    pub fn at_least_one(self) -> Self {
        let Self {
            clip,
            clipped_triangles,
            medium,
            large,
            tiles,
            glass,
        } = self;
        let [clip, clipped_triangles, medium, large, tiles, glass] =
            [clip, clipped_triangles, medium, large, tiles, glass].map(|capacity| capacity.max(1));
        Self {
            clip,
            clipped_triangles,
            medium,
            large,
            tiles,
            glass,
        }
    }

    /// Grows every queue that the demand exceeded, by powers of two; true if anything grew.
    pub fn grow(&mut self, demand: &CounterRecord) -> bool {
        let pairs = [
            (&mut self.clip, demand.clip),
            (&mut self.clipped_triangles, demand.clipped_triangles),
            (&mut self.medium, demand.medium),
            (&mut self.large, demand.large),
            (&mut self.tiles, demand.tiles),
        ];
        let mut grew = false;
        for (capacity, demand) in pairs {
            if demand > *capacity {
                *capacity = demand.checked_next_power_of_two().unwrap_or(u32::MAX);
                grew = true;
            }
        }
        grew
    }
}

/// Capacities of the queues that this key's passes have; 0 where a pass is left out.
pub fn recorded_capacities(key: &KernelKey, all: &Capacities) -> Capacities {
    let kept = |is_there: bool, capacity: u32| if is_there { capacity } else { 0 };
    Capacities {
        clip: kept(key.paths.has_clipping, all.clip),
        clipped_triangles: kept(key.paths.has_clipping, all.clipped_triangles),
        medium: kept(key.paths.has_medium, all.medium),
        large: kept(key.paths.has_large, all.large),
        tiles: kept(key.paths.has_large, all.tiles),
        glass: kept(key.has_glass(), all.glass),
    }
}

/// Room for an ordinary picture of the scene; demand beyond it grows the queues and draws again.
pub fn first_capacities(scene: &Scene) -> Capacities {
    let triangles = scene.triangle_count().min(u64::from(u32::MAX)) as u32;
    let room = |most: u32| triangles.clamp(16, most).next_power_of_two();
    Capacities {
        clip: room(4096),
        clipped_triangles: 2 * room(4096),
        medium: room(65_536),
        large: room(16_384),
        tiles: 16 * room(4096),
        glass: FIRST_LAYERS,
    }
}

impl CounterRecord {
    /// As the rest of the program counts; `overflow` is demand beyond `capacities`.
    pub fn counters(&self, capacities: &Capacities) -> Counters {
        let beyond = [
            self.clip.saturating_sub(capacities.clip),
            self.clipped_triangles
                .saturating_sub(capacities.clipped_triangles),
            self.medium.saturating_sub(capacities.medium),
            self.large.saturating_sub(capacities.large),
            self.tiles.saturating_sub(capacities.tiles),
        ];
        Counters {
            rejected_nonfinite: self.rejected_nonfinite,
            rejected_range: self.rejected_range,
            degenerate: self.degenerate,
            clipped: self.clip,
            flipped_clips: self.flipped_clips,
            overflow: beyond.iter().fold(0, |sum: u32, b| sum.saturating_add(*b)),
            depth_without_id: self.depth_without_id,
            full_pixels: self.full_pixels,
            dropped: self.dropped,
        }
    }
}
