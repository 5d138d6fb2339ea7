#!/usr/bin/env bash
# The Python package: built and installed from the clone into an environment of its own, linted,
# type-checked and tested. RLlib and sweeps on two Ray nodes, Stable-Baselines3, TorchRL, BenchMARL
# and the notebook follow.
# PyTorch and Ray are large (some 5 GB unpacked); uv fetches and unpacks them in under a minute. The
# registry has PyTorch with CUDA alone, which does not load without CUDA's libraries; its compiler,
# triton, can stay away.
set -euo pipefail

venv=$(realpath -m "${JCAS_VENV:-$CARGO_TARGET_DIR/venv}")
[[ -x $venv/bin/python ]] || python3 -m venv "$venv"
python=$venv/bin/python
"$python" -m pip install --quiet --disable-pip-version-check uv
uv() { "$venv/bin/uv" "$@"; }

# The README's command, by pip itself.
"$python" -m pip install --quiet --disable-pip-version-check ./python
overrides=$(mktemp)
echo 'triton; sys_platform == "never"' >"$overrides"
uv pip install --quiet --python "$python" --override "$overrides" \
    './python[test,rllib,sweep,sb3,benchmarl,notebook]'
rm "$overrides"

(
    cd python
    "$venv/bin/ruff" check . ../examples/*.py ../examples/{cluster,radar}
    "$venv/bin/ruff" format --check . ../examples/*.py ../examples/{cluster,radar}
    "$venv/bin/mypy"
)

export SDL_VIDEODRIVER=dummy RAY_USAGE_STATS_ENABLED=0 OMP_NUM_THREADS=1
# Sweeps run by the command, and its policies act the same here.
cargo build --locked --quiet --release --package jcas-cli
export JCAS_COMMAND=$CARGO_TARGET_DIR/release/jcas
"$python" -m pytest -q python/tests --run-heavy -n auto --dist loadfile

# The README's lines, as they stand.
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
sed -n '/^```python$/,/^```$/p' python/README.md | sed '/^```/d' >"$work/readme.py"
(cd "$work" && "$python" readme.py && test -s fleet.png && test -s episode.html)

# The source distribution has every crate that Cargo needs.
uv build --quiet --sdist --out-dir "$work" python
tar -xzf "$work"/jcas-*.tar.gz -C "$work"
cargo metadata --format-version 1 --manifest-path "$work"/jcas-*/kernel/Cargo.toml >/dev/null

"$python" examples/plan_by_forking.py
"$python" examples/torchrl_mappo.py --iterations 1 --missions 8 --steps 50 --uavs 3 --width 32
"$python" examples/stable_baselines3_ppo.py --steps 300 --missions 4 --uavs 3 --hotspots 1 \
    --episodes 5
"$python" examples/benchmarl_train.py --help >"$work/benchmarl_help.txt"
"$venv/bin/jupyter" execute examples/tour.ipynb
"$python" examples/radar/ofdm_radar.py --frames 100 --ranges-m 60 \
    --out "$work/p_d.csv" --figure "$work/p_d.png"
# Sionna is large and not installed here.
"$python" examples/radar/sionna_radar.py --help >"$work/sionna_help.txt"

# The FMU, in an importer that is not ours.
cargo xtask fmu --out "$work/jcas.fmu"
uv pip install --quiet --python "$python" 'fmpy>=0.3.32'
JCAS_FMU=$work/jcas.fmu "$python" -m pytest -q fmi/tests
"$python" examples/fmi/one_fleet_two_radars.py "$work/jcas.fmu" "$work/radars.png"
sed -n '/^```python$/,/^```$/p' docs/fmi.md | sed '/^```/d' >"$work/fmi.py"
"$python" "$work/fmi.py" "$work/jcas.fmu"
