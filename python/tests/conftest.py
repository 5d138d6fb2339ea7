"""Settings that the tests share."""

import os
import secrets

import pytest

# Windows open on no screen, and Ray reports to nobody.
os.environ.setdefault("SDL_VIDEODRIVER", "dummy")
os.environ.setdefault("RAY_USAGE_STATS_ENABLED", "0")
# Ray starts its workers with a nice value of 15, which stalls the tests on a busy machine.
os.environ.setdefault("RAY_worker_niceness", "0")
# Ray reads this when it is imported. Only processes with this token can join the test's cluster.
os.environ.setdefault("RAY_AUTH_MODE", "token")
os.environ.setdefault("RAY_AUTH_TOKEN", secrets.token_hex(32))


def pytest_addoption(parser):
    parser.addoption(
        "--run-heavy", action="store_true", help="also run tests that need RLlib, torch and minutes"
    )


def pytest_collection_modifyitems(config, items):
    if config.getoption("--run-heavy"):
        return
    for item in items:
        if "heavy" in item.keywords:
            item.add_marker(pytest.mark.skip(reason="heavy: --run-heavy runs it"))
