"""RLlib on a Ray cluster of two nodes: training improves, and a killed env runner comes back."""

import json
import math
import os
import signal
import subprocess
import sys
import time

import pytest

from ray_nodes import two_nodes, wait_for

pytestmark = pytest.mark.heavy

# Small enough to learn within a minute: one of two UAVs has to go to the hotspot and stay there.
MISSION = {
    "grid_width": 5, "grid_height": 5, "uav_count": 2, "hotspot_count": 1, "quorum": 1,
    "horizon_steps": 20,
    "radar_cross_section_dbsm": 8, "reward_throughput": 0,
}  # fmt: skip
RECOVERY_SECONDS = 150
RUN_SECONDS = 240


@pytest.fixture(scope="module")
def cluster(tmp_path_factory):
    """A connection to two nodes on loopback, and their head's address."""
    pytest.importorskip("ray")
    import ray

    with two_nodes(tmp_path_factory.mktemp("ray")) as nodes:
        ray.init(address=nodes.address, logging_level="error")
        yield nodes.address
        ray.shutdown()


def where(algorithm):
    """Node and process of each env runner that answers."""

    def place(_):
        import ray

        return ray.get_runtime_context().get_node_id(), os.getpid()

    return algorithm.env_runner_group.foreach_env_runner(place, local_env_runner=False)


def test_an_iteration_without_samples_is_a_row():
    from jcas.rllib.training import iteration_row

    row = iteration_row(
        {"training_iteration": 3, "fault_tolerance": {"num_healthy_workers": 0}}, 1.0
    )
    assert row["iteration"] == 3 and row["env_runners"] == 0
    assert math.isnan(row["team_return"]) and math.isnan(row["entropy"])


def test_no_two_environments_of_any_runner_begin_the_same_episode():
    """Sixteen runners of four environments, and the run of the next seed, as RLlib seeds them."""
    pytest.importorskip("ray")
    from ray.rllib.env.env_context import EnvContext
    from ray.rllib.env.multi_agent_env_runner import MultiAgentEnvRunner
    from ray.rllib.env.vector.sync_vector_multi_agent_env import SyncVectorMultiAgentEnv

    import jcas
    from jcas.rllib import JcasMultiAgentEnv, ppo_config

    seeds = []
    for seed in (7, 8):
        config = ppo_config(jcas.Config(MISSION), env_runners=16, envs_per_runner=4, seed=seed)
        for runner in range(1, 17):
            context = EnvContext(config.env_config, runner, num_workers=16)
            envs = SyncVectorMultiAgentEnv([lambda c=context: JcasMultiAgentEnv(c)] * 4)
            envs.reset(seed=config.seed + runner)
            seeds += [env.unwrapped.sim.seed for env in envs.envs]
    assert len(seeds) == len(set(seeds)) == 2 * 16 * 4

    # What RLlib itself gives a runner is what this test assumes.
    runner = MultiAgentEnvRunner(config=config, worker_index=3, num_workers=16)
    runner.sample(num_timesteps=4, random_actions=True)
    own = [env.unwrapped.sim.seed for env in runner.env.envs]
    assert own == seeds[16 * 4 + 2 * 4 : 16 * 4 + 3 * 4]
    runner.stop()


def test_two_nodes_train_and_survive_a_killed_runner(cluster):
    import jcas
    from jcas.rllib import Hyperparameters, ppo_config
    from jcas.rllib.training import iteration_row

    settings = Hyperparameters(
        batch_steps=1500, minibatch_samples=500, epochs=10, learning_rate=2e-3, hidden=(64, 64)
    )
    algorithm = ppo_config(
        jcas.Config(MISSION), settings, env_runners=2, envs_per_runner=4, seed=1
    ).build_algo()
    try:
        places = where(algorithm)
        # A node has room for one runner, so each node has one.
        assert len(places) == 2 and len({node for node, _ in places}) == 2
        returns = [iteration_row(algorithm.train(), 0.0)["team_return"] for _ in range(3)]

        killed = places[0][1]
        os.kill(killed, signal.SIGKILL)
        lost, healthy, deadline = False, 2, time.monotonic() + RECOVERY_SECONDS
        while not (lost and healthy == 2) and time.monotonic() < deadline:
            row = iteration_row(algorithm.train(), 0.0)
            healthy = row["env_runners"]
            lost = lost or healthy == 1
            returns.append(row["team_return"])
        assert lost and healthy == 2
        after = where(algorithm)
        assert len({node for node, _ in after}) == 2 and killed not in [
            process for _, process in after
        ]

        # On a busy machine an iteration may end without samples.
        while len(measured := [value for value in returns if not math.isnan(value)]) < 14:
            returns.append(iteration_row(algorithm.train(), 0.0)["team_return"])
        assert sum(measured[-3:]) / 3 > sum(measured[:3]) / 3 + 1.0, returns
    finally:
        algorithm.stop()


def test_the_commands_train_on_the_cluster_and_evaluate(cluster, tmp_path):
    mission = [f"--set={name}={value}" for name, value in MISSION.items()]
    run = [sys.executable, "-m", "jcas.rllib"]
    out = tmp_path / "policy"
    train = subprocess.run(
        [*run, "train", *mission, "--address", cluster, "--out", out, "--steps", "1500", "--batch",
        "500",
         "--hidden", "32,32", "--runners", "1", "--epochs", "2"], capture_output=True, text=True,
    )  # fmt: skip
    assert train.returncode == 0, train.stderr[-3000:]
    assert sorted(os.listdir(out)) == [
        "checkpoint",
        "policy.json",
        "policy.safetensors",
        "progress.csv",
    ]
    assert len((out / "progress.csv").read_text().splitlines()) >= 4
    report = subprocess.run(
        [*run, "evaluate", out, "--episodes", "20", "--json"], capture_output=True, text=True
    )
    assert report.returncode == 0, report.stderr[-3000:]
    values = json.loads(report.stdout)
    assert report.stderr == ""
    changed = subprocess.run(
        [*run, "evaluate", out, "--episodes=2", "--set=quorum=2"], capture_output=True, text=True
    )
    assert "quorum = 2 (not 1)" in changed.stderr
    assert (values["episodes"], values["uavs"]) == (20, 2) and 0 <= values["success_rate"] <= 1
    refused = subprocess.run([*run, "evaluate", out, "--uavs", "7"], capture_output=True, text=True)
    assert refused.returncode == 2 and "uav_count = 7 (not 2)" in refused.stderr
    assert "the policy reads 18 fields where this mission has 33" in refused.stderr


def test_a_run_is_stopped_killed_and_gone_on_with(tmp_path, request):
    """Alone on this machine, as a newcomer trains."""
    pytest.importorskip("ray")
    out = tmp_path / "run"
    environment = {
        name: value for name, value in os.environ.items() if not name.startswith("RAY_AUTH")
    }
    environment["RAY_raylet_start_wait_time_s"] = str(RUN_SECONDS)
    mission = [f"--set={name}={value}" for name, value in MISSION.items()]
    train = [
        sys.executable, "-m", "jcas.rllib", "train", *mission, "--out", out, "--batch", "300",
        "--hidden", "16",
        "--runners", "1", "--epochs", "1", "--checkpoint-every", "1",
    ]  # fmt: skip

    def start(*options):
        process = subprocess.Popen(
            [*train, *options],
            env=environment,
            stderr=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        request.addfinalizer(process.kill)
        return process

    def rows():
        return (out / "progress.csv").read_text().splitlines()[1:]

    process = start("--steps", "1000000")
    wait_for((out / "checkpoint" / "run.json").is_file, RUN_SECONDS, "the first checkpoint")
    process.send_signal(signal.SIGINT)
    told = process.communicate(timeout=RUN_SECONDS)[1]
    assert process.returncode == 130 and "go on with --resume" in told, told[-2000:]
    stopped = len(rows())
    assert stopped >= 1 and (out / "policy.json").is_file()

    refused = start("--steps", "1000000")
    assert "--resume" in refused.communicate()[1] and refused.returncode == 2
    other = start("--resume", "--seed", "9", "--steps", "1000000")
    assert "seed: 1, not 9" in other.communicate()[1] and other.returncode == 2

    killed = start("--resume", "--steps", "1000000")
    wait_for(lambda: len(rows()) > stopped + 1, RUN_SECONDS, "going on")
    killed.kill()
    killed.communicate()
    kept = json.loads((out / "checkpoint" / "run.json").read_text())["last"]

    steps = kept["env_steps"] + 500
    last = start("--resume", "--steps", str(steps))
    told = last.communicate(timeout=RUN_SECONDS)[1]
    assert last.returncode == 0, told[-2000:]
    iterations = [int(row.split(",")[0]) for row in rows()]
    assert iterations == list(range(1, len(iterations) + 1)) and len(iterations) > kept["iteration"]
    card = json.loads((out / "policy.json").read_text())
    assert (
        card["last_iteration"]["env_steps"] >= steps
        and card["last_iteration"]["seconds"] > kept["seconds"]
    )
