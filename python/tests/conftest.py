"""Settings that the tests share."""

import os

# Windows open on no screen, and Ray reports to nobody.
os.environ.setdefault("SDL_VIDEODRIVER", "dummy")
os.environ.setdefault("RAY_USAGE_STATS_ENABLED", "0")
