# Settings that every section shares. Sourced, not run.

# Where builds go, and what the sections make besides.
export CARGO_TARGET_DIR=${CARGO_TARGET_DIR:-$PWD/target}

# Once-through builds: no incremental state, and only the line numbers of debug information.
export CARGO_INCREMENTAL=0
export CARGO_PROFILE_DEV_DEBUG=line-tables-only
export CARGO_TERM_COLOR=${CARGO_TERM_COLOR:-never}

# A machine may have the very toolchain that rust-toolchain.toml asks for under the name `stable`
# only.
channel=$(sed -n 's/^channel = "\(.*\)"$/\1/p' rust-toolchain.toml)
if ! rustup toolchain list | grep -q "^$channel-" &&
    [[ $(rustc +stable --version 2>/dev/null) == "rustc $channel "* ]]; then
    export RUSTUP_TOOLCHAIN=stable
fi
unset channel
