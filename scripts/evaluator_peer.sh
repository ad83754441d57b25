#!/bin/sh
# Compares the evaluator of WGSL with that of the WESL compiler, an independent implementation.
set -e
cd "$(dirname "$0")/../tests/evaluator_peer"
CARGO_TARGET_DIR="${CARGO_TARGET_DIR:-../../target/evaluator_peer}" cargo test --release "$@"
