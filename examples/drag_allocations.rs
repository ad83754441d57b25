//! Heap allocations of a frame while a slider is dragged: those of the renderer and those of wgpu
//! below it.
//!
//! `cargo run --release --no-default-features --example drag_allocations [FRAMES]`; with `--sites`
//! also the functions of rasterlab in which one frame allocates.

#![allow(
    unsafe_code,
    reason = "a global allocator is unsafe to implement; this one adds a count to the system's"
)]

use std::{
    alloc::{GlobalAlloc, Layout, System},
    backtrace::Backtrace,
    cell::{Cell, RefCell},
    collections::BTreeMap,
    sync::atomic::{AtomicU64, Ordering},
};

use anyhow::Context;
use pollster::FutureExt as _;
use rasterlab::{
    gpu::{Gpu, Renderer, device::AdapterChoice},
    preset_file::{self, Folders},
};

struct Counting;

static ALLOCATIONS: AtomicU64 = AtomicU64::new(0);

thread_local! {
    /// Whether stacks are kept. Keeping one allocates, too.
    static KEEPS: Cell<bool> = const { Cell::new(false) };
    static STACKS: RefCell<Vec<String>> = const { RefCell::new(Vec::new()) };
}

fn count() {
    ALLOCATIONS.fetch_add(1, Ordering::Relaxed);
    if KEEPS
        .try_with(|keeps| keeps.replace(false))
        .unwrap_or(false)
    {
        let stack = Backtrace::force_capture().to_string();
        STACKS.with_borrow_mut(|stacks| stacks.push(stack));
        KEEPS.set(true);
    }
}

// SAFETY: every call goes to the system's allocator as it is.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count();
        // SAFETY: the caller keeps the contract of `alloc`.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, at: *mut u8, layout: Layout) {
        // SAFETY: the caller keeps the contract of `dealloc`.
        unsafe { System.dealloc(at, layout) }
    }

    unsafe fn realloc(&self, at: *mut u8, layout: Layout, bytes: usize) -> *mut u8 {
        count();
        // SAFETY: the caller keeps the contract of `realloc`.
        unsafe { System.realloc(at, layout, bytes) }
    }
}

#[global_allocator]
static COUNTING: Counting = Counting;

/// The innermost function of rasterlab, and whether wgpu allocates for it.
fn site(stack: &str) -> (String, bool) {
    let mut of_wgpu = false;
    for line in stack.lines().map(str::trim) {
        let name = line.split_once(": ").map_or("", |(_, name)| name);
        if name.contains("wgpu") || name.contains("naga") {
            of_wgpu = true;
        }
        if name.contains("rasterlab::") {
            return (name.to_owned(), of_wgpu);
        }
    }
    ("the example".into(), of_wgpu)
}

fn main() -> anyhow::Result<()> {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let shows_sites = args.iter().any(|arg| arg == "--sites");
    let frames: usize = args
        .iter()
        .find(|arg| !arg.starts_with("--"))
        .map_or(Ok(50), |text| text.parse())
        .context("FRAMES is a number")?;
    let gpu = Gpu::open(&AdapterChoice::Any).block_on()?;
    println!("{}", gpu.summary.name);
    let mut renderer = Renderer::new(gpu.clone());
    let preset = preset_file::open("facet", &Folders::default())?.preset;
    let scene = preset_file::load_scene(&preset, None)?;
    renderer.set_scene(&scene).block_on()?;
    let moments = preset.moments(&scene, [640, 360]);
    let (view, stack) = moments.last().context("a preset shows a moment")?;
    let mut stack = stack.clone();
    let facet = stack
        .0
        .iter()
        .position(|enabled| enabled.effect.name == "facet")
        .context("the preset has facets")?;
    let field = stack.0[facet]
        .effect
        .fields
        .iter()
        .find(|field| field.name == "amount")
        .context("facets have an amount")?;
    let word = field.offset / 4;

    let mut before = gpu.prepared.so_far();
    let [mut draws, mut finishes, mut explains, mut ours] = [0, 0, 0, 0];
    let mut sites: BTreeMap<(bool, String), u64> = BTreeMap::new();
    let warm_up = 10;
    for frame in 0..warm_up + frames {
        stack.0[facet].words[word] =
            (0.2 + 0.6 * frame as f32 / (warm_up + frames) as f32).to_bits();
        let start = ALLOCATIONS.load(Ordering::Relaxed);
        let is_last = frame + 1 == warm_up + frames;
        KEEPS.set(is_last);
        renderer.draw(view, &stack, &preset.accuracy).block_on()?;
        let drawn = ALLOCATIONS.load(Ordering::Relaxed);
        renderer.finish().block_on()?;
        let finished = ALLOCATIONS.load(Ordering::Relaxed);
        renderer.explained();
        KEEPS.set(false);
        let explained = ALLOCATIONS.load(Ordering::Relaxed);
        if frame < warm_up {
            before = gpu.prepared.so_far();
        } else if !is_last {
            draws += drawn - start;
            finishes += finished - drawn;
            explains += explained - finished;
        }
        if is_last {
            for stack in STACKS.take() {
                let (name, of_wgpu) = site(&stack);
                ours += u64::from(!of_wgpu);
                *sites.entry((of_wgpu, name)).or_default() += 1;
            }
        }
    }
    let mean = |count: u64| count as f64 / (frames - 1).max(1) as f64;
    println!(
        "allocations a frame: draw {:.1}, finish {:.1}, explain {:.1}",
        mean(draws),
        mean(finishes),
        mean(explains)
    );
    println!(
        "of one frame on this thread: {ours} of rasterlab, {} of wgpu",
        sites.values().sum::<u64>() - ours
    );
    println!(
        "prepared in {frames} frames: {}",
        if gpu.prepared.so_far() == before {
            "nothing"
        } else {
            "something"
        }
    );
    if shows_sites {
        let mut sites: Vec<_> = sites.into_iter().collect();
        sites.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
        sites.iter().for_each(|((of_wgpu, name), count)| {
            println!(
                "{count:5} {} {name}",
                if *of_wgpu { "wgpu" } else { "ours" }
            )
        });
    }
    Ok(())
}
