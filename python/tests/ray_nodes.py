"""A Ray cluster of two nodes on loopback, for tests."""

import contextlib
import re
import socket
import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path

NODE_SECONDS = 90


@dataclass
class Nodes:
    """The address of the head, and the process of the node that joined it."""

    address: str
    joined: subprocess.Popen


@contextlib.contextmanager
def two_nodes(folder, processors=1):
    """Start a head and a second node that joins it by address."""
    address = f"127.0.0.1:{free_port()}"
    host, port = address.split(":")
    with contextlib.ExitStack() as running:

        def node(name, *options):
            log = folder / f"{name}.log"
            process = start_node(log, processors, *options)
            running.callback(lambda: (process.terminate(), process.wait(30)))
            return process, log

        _, log = node(
            "head", "--head", "--port", port, "--node-ip-address", host,
            "--include-dashboard", "false",
        )  # fmt: skip
        wait_for(lambda: listening(host, int(port)), NODE_SECONDS, "the head node", log)
        joined, log = node("joined", "--address", address, "--node-ip-address", "127.0.0.2")
        wait_for(lambda: alive(address) == 2, NODE_SECONDS, "the second node", log)
        yield Nodes(address, joined)


def start_node(log, processors, *options):
    """Start a Ray node as a foreground process, which ends when it is terminated."""
    ray = Path(sys.executable).with_name("ray")
    command = [
        str(ray), "start", "--block", "--num-cpus", str(processors),
        "--object-store-memory", "100000000", "--disable-usage-stats", *options,
    ]  # fmt: skip
    return subprocess.Popen(command, stdout=log.open("w"), stderr=subprocess.STDOUT)


def alive(address):
    """Count the nodes that a cluster's head reports as active."""
    status = subprocess.run(
        [Path(sys.executable).with_name("ray"), "status", "--address", address],
        capture_output=True,
        text=True,
    ).stdout
    active = status.partition("Active:")[2].partition("Pending:")[0]
    return len(re.findall(r"^ \d+ node_", active, re.MULTILINE))


def wait_for(condition, seconds, what, log=None):
    deadline = time.monotonic() + seconds
    while time.monotonic() < deadline:
        if condition():
            return
        time.sleep(0.5)
    raise AssertionError(
        f"{what} took more than {seconds} s" + (f":\n{log.read_text()[-2000:]}" if log else "")
    )


def listening(host, port):
    with socket.socket() as probe:
        return probe.connect_ex((host, port)) == 0


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]
