#!/usr/bin/env bash
# Coverage-guided fuzzing of what comes from outside: each target for a while, two at a time.
#
#   fuzz.sh           5 seconds a target; .github/workflows/fuzz.yml takes longer
#   fuzz.sh SECONDS   that long; inputs that reach new code stay in FUZZ_CORPUS, if it is set
set -euo pipefail

seconds=${1:-5}
tools=$CARGO_TARGET_DIR/tools
[[ -x $tools/bin/cargo-fuzz ]] || cargo install --quiet --locked cargo-fuzz@0.13.2 --root "$tools"
export PATH=$tools/bin:$PATH
# Coverage and sanitizers are unstable options of the compiler.
export RUSTC_BOOTSTRAP=1

built=$CARGO_TARGET_DIR/fuzz
cargo fuzz build --release --target-dir "$built" 2>&1 | tail -n 1

found=$(mktemp -d)
trap 'rm -rf "$found"' EXIT
target() {
    local name=$1 log=$found/$1.log longest=4096
    # A policy is read with its weights.
    [[ $name != policy ]] || longest=140000
    [[ $name != trace ]] || longest=65536
    [[ $name != plan ]] || longest=16384
    local folders=("${FUZZ_CORPUS:-$found}/$name" "fuzz/corpus/$name")
    mkdir -p "${folders[0]}"
    [[ $name != policy ]] || folders+=(policies/mission)
    if ! "$built"/*/release/"$name" -max_total_time="$seconds" -max_len=$longest -timeout=20 \
        -artifact_prefix="$built/" -print_final_stats=1 "${folders[@]}" >"$log" 2>&1; then
        tail -n 40 "$log" >&2
        return 1
    fi
    printf '%-10s %s\n' "$name" "$(grep -o 'DONE.*corp: [0-9]*' "$log"), $(
        sed -n 's/stat::number_of_executed_units: *//p' "$log") executions"
}
export -f target
export found built seconds
cargo fuzz list | xargs -P 2 -I NAME bash -euo pipefail -c "target NAME"
