//! Memory that a long job leaves free inside the process.

/// Gives the memory that is free back to the system. The allocator of glibc keeps what other
/// threads than the first one freed: after a trade of nine combinations with lavapipe that were 85
/// MB of 285. Takes a few milliseconds, so it belongs to the end of a job, on the job's thread.
/// Elsewhere than on Linux with glibc it does nothing.
pub fn give_back() {
    #[cfg(all(target_os = "linux", target_env = "gnu"))]
    #[allow(
        unsafe_code,
        reason = "malloc_trim has no safe form; it takes no pointer, any thread may call it, and it touches nothing in use"
    )]
    // SAFETY: malloc_trim releases only pages without allocations, under the allocator's own locks.
    unsafe {
        libc::malloc_trim(0);
    }
}

#[cfg(all(test, target_os = "linux", target_env = "gnu"))]
mod tests {
    use super::*;

    /// Memory of this process that does not come from files, in bytes.
    fn resident() -> u64 {
        let status = std::fs::read_to_string("/proc/self/status").expect("Linux tells");
        let line = status
            .lines()
            .find_map(|line| line.strip_prefix("RssAnon:"))
            .expect("its anonymous memory");
        line.trim()
            .trim_end_matches("kB")
            .trim()
            .parse::<u64>()
            .expect("a number")
            * 1024
    }

    #[test]
    fn what_a_job_freed_between_blocks_that_stay_goes_back() {
        const BLOCK: usize = 1 << 16;
        const FREED: u64 = 256 << 20;
        let job = || {
            let blocks: Vec<Vec<u8>> = (0..FREED as usize / BLOCK)
                .map(|_| vec![1; BLOCK])
                .collect();
            // One block in 256 stays, so that the allocator cannot simply shrink its heap.
            blocks.into_iter().step_by(256).collect::<Vec<_>>()
        };
        let (stays, before, after) = std::thread::spawn(move || {
            let stays = job();
            let before = resident();
            give_back();
            (stays, before, resident())
        })
        .join()
        .expect("the job ends");
        assert!(
            stays
                .iter()
                .all(|block| block.iter().all(|&byte| byte == 1))
        );
        // Other tests of this process allocate meanwhile.
        assert!(
            after + FREED / 2 < before,
            "{before} bytes before, {after} after"
        );
    }
}
