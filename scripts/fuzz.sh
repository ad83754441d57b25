#!/bin/sh
# Looks for hostile input with libFuzzer: sh scripts/fuzz.sh HOURS [TARGET...]
# Needs the stable toolchain and a C++ compiler. Each target runs ten minutes at a time, in turn, and begins with fuzz/corpus and what earlier
# runs found worth keeping (target/fuzz/corpus). Input that a target failed on goes to fuzz/found/TARGET and ends the script:
# cargo run --release -p rasterlab-fuzz -- inputs FILE runs it again.
set -eu
cd "$(dirname "$0")/.."
hours=${1:?"sh scripts/fuzz.sh HOURS [TARGET...]"}
shift
[ $# -gt 0 ] || set -- $(ls fuzz/corpus)
end=$(awk -v now="$(date +%s)" -v hours="$hours" 'BEGIN { printf "%d", now + 3600 * hours }')

host=$(rustc -vV | sed -n 's/^host: //p')
build=${CARGO_TARGET_DIR:-target}/fuzz
# Counters at every edge and comparison, and the checks that a release leaves out. Build scripts and macros stay as they are: --target.
RUSTFLAGS="-Cpasses=sancov-module -Cllvm-args=-sanitizer-coverage-level=4 -Cllvm-args=-sanitizer-coverage-inline-8bit-counters \
-Cllvm-args=-sanitizer-coverage-pc-table -Cllvm-args=-sanitizer-coverage-trace-compares -Coverflow-checks=yes -Cdebug-assertions=yes" \
    cargo build --release --package rasterlab-fuzz --bin rasterlab-fuzz-coverage --no-default-features --features coverage \
    --target "$host" --target-dir "$build"

while :; do
    for target; do
        left=$((end - $(date +%s)))
        [ "$left" -gt 0 ] || exit 0
        mkdir -p "$build/corpus/$target" "fuzz/found/$target"
        echo "=== $target, $((left / 60)) minutes left of all"
        # What is kept of effect files stays in memory, so a process does not run for hours.
        RASTERLAB_FUZZ=$target "$build/$host/release/rasterlab-fuzz-coverage" "$build/corpus/$target" "fuzz/corpus/$target" \
            -artifact_prefix="fuzz/found/$target/" -max_total_time="$((left < 600 ? left : 600))" -max_len=65536 -timeout=100 \
            -rss_limit_mb=4096 -print_final_stats=1 -verbosity=0
    done
done
