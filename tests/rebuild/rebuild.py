"""Rebuilds recorded episodes from docs/model.md and a trace's configuration, seed and actions.

    python3 tests/rebuild/rebuild.py TRACE...

Every whole number, set and cell has to equal the trace's. Reals may differ by rounding (1e-9), the
twelve components of the reward included. The script takes nothing from the kernel: each function is
a sentence of the page.

Two fields of a trace are not rebuilt: `observation_hash` and `state_hash` are hashes of bits. The
first needs the kernel's order of roundings, the second the layout of its memory. The page promises
neither. `jcas trace verify` and `jcas_trace_verify` check both.
"""

import json
import math
import sys

MASK = 0xFFFFFFFF
DETECT, CARBON, SOC, HOTSPOT, SHUFFLE, FALSE_ALARM, START_CELL = 1, 2, 3, 4, 5, 8, 9


def philox(counter, key):
    """Philox4x32-10 (Salmon et al., SC 2011)."""
    c, k = list(counter), list(key)
    for _ in range(10):
        low, high = c[0] * 0xD2511F53, c[2] * 0xCD9E8D57
        c = [high >> 32 ^ c[1] ^ k[0], high & MASK, low >> 32 ^ c[3] ^ k[1], low & MASK]
        k = [k[0] + 0x9E3779B9 & MASK, k[1] + 0xBB67AE85 & MASK]
    return c


def half_up(x):
    return math.floor(x + 0.5)


class Mission:
    def __init__(self, header):
        self.c = c = header["config"]
        self.seed = int(header["seed"], 16)
        self.n, self.m = c["uav_count"], c["hotspot_count"]
        self.w, self.h = c["grid_width"], c["grid_height"]
        self.depots = [tuple(cell) for cell in c.get("depots", [])] or [(self.w // 2, self.h // 2)]
        kwh = lambda x: half_up(x * 3.6e12)
        self.capacity = kwh(c["battery_capacity_kwh"])
        self.rtb = kwh(c["rtb_threshold_kwh"])
        self.charge = half_up(c["charge_power_kw"] * 1e9 * c["step_duration_s"])
        self.move, self.hover = kwh(c["move_energy_kwh"]), kwh(c["hover_energy_kwh"])
        self.sense, self.comm = kwh(c["sense_energy_kwh"]), kwh(c["comm_energy_kwh"])
        self.grid_share_ppb = half_up((1 - c["renewable_share"]) * 1e9)
        self.reset()

    # Draws.

    def block(self, step, uav, index, purpose):
        return philox((step, uav, index, purpose), (self.seed & MASK, self.seed >> 32))

    def bits64(self, step, uav, index, purpose):
        words = self.block(step, uav, index, purpose)
        return words[0] | words[1] << 32

    def below(self, bits, count):
        return bits * count >> 64

    def intensity(self, t):
        low = half_up(self.c["carbon_intensity_min_kg_per_kwh"] * 1e6)
        high = half_up(self.c["carbon_intensity_max_kg_per_kwh"] * 1e6)
        return low + self.below(self.bits64(t, 0, 0, CARBON), high - low + 1)

    def place_hotspots(self):
        free = [(x, y) for y in range(self.h) for x in range(self.w) if (x, y) not in self.depots]
        chosen = []
        for k in range(self.m):
            top = len(free) - self.m + k
            rank = self.below(self.bits64(0, 0, k, HOTSPOT), top + 1)
            chosen.append(top if rank in chosen else rank)
        for k in range(self.m - 1, 0, -1):
            other = self.below(self.bits64(0, 0, k, SHUFFLE), k + 1)
            chosen[k], chosen[other] = chosen[other], chosen[k]
        return [free[rank] for rank in chosen]

    def initial_charge(self, i):
        unit = (self.bits64(0, i, 0, SOC) >> 11) * 2.0**-53
        low, high = self.c["initial_soc_min"], self.c["initial_soc_max"]
        return min(half_up((low + (high - low) * unit) * self.capacity), self.capacity)

    def start(self, i):
        if self.c.get("start_cells", "depot") == "depot":
            return self.depots[0]
        index = self.below(self.bits64(0, i, 0, START_CELL), self.w * self.h)
        return (index % self.w, index // self.w)

    def reset(self):
        self.t = 0
        self.hotspots = self.place_hotspots()
        self.cells = [self.start(i) for i in range(self.n)]
        self.battery = [self.initial_charge(i) for i in range(self.n)]
        self.density = [self.c["pilot_density_min"]] * self.n
        self.grounded = [charge == 0 for charge in self.battery]
        self.returning = [False] * self.n
        self.knows = [set() for _ in range(self.n)]
        self.confirmed, self.informed = set(), set()
        self.over_episode = self.c.get("quorum_window", "step") == "episode"
        self.remembered, self.remembered_alarms = [[set() for _ in range(self.n)] for _ in range(2)]
        self.alarms, self.falsely = [[] for _ in range(self.n)], set()
        self.sightings, self.reported = [[{} for _ in range(self.n)] for _ in range(2)]
        self.co2 = 0
        self.coming = self.intensity(0)
        self.visited = set(self.cells)
        self.link_up()
        self.goal, self.charging = self.potentials()

    # Radio.

    def range_m(self, a, b):
        least = self.c.get("range_min_m", self.c["cell_size_m"] / 2)
        return max(least, self.c["cell_size_m"] * math.hypot(a[0] - b[0], a[1] - b[1]))

    def threshold_db(self):
        c = self.c
        if "detection_threshold_db" in c:
            return c["detection_threshold_db"]
        if "sensing_range_m" in c:
            return self.sensing_snr_db(c["sensing_range_m"])
        p = c["detection_probability"]
        a = math.log(0.62 / c["false_alarm_probability"])
        b = math.log(p / (1 - p))
        return (6.2 + 4.54 / math.sqrt(1.44)) * math.log10(a + 0.12 * a * b + 1.7 * b)

    def sensing_snr_db(self, r):
        c = self.c
        wavelength = 299_792_458 / c["carrier_frequency_hz"]
        resolution = c.get("range_resolution_m", 299_792_458 / (2 * c["bandwidth_hz"]))
        return (
            c["transmit_power_dbm"] + c["transmit_gain_dbi"] + c["receive_gain_dbi"]
            + 20 * math.log10(wavelength) + c["radar_cross_section_dbsm"]
            - 30 * math.log10(4 * math.pi)
            - 40 * math.log10(r) - c["sensing_noise_dbm"] + c["processing_gain_db"]
            - 10 * math.log10(1 + resolution / r)
        )

    def detects(self, i, j):
        c = self.c
        change_db = -c["comm_load_penalty_db"] * (1 - self.density[i])
        if c.get("pilot_gain") == "coherent":
            change_db += 10 * math.log10(self.density[i] / c["pilot_density_max"])
        p = self.p_d(self.range_m(self.cells[i], self.hotspots[j]), change_db)
        return self.block(self.t, i, j // 4, DETECT)[j % 4] < math.floor(2**32 * p)

    def p_d(self, range_m, change_db):
        c = self.c
        if c.get("detection_curve") == "table":
            change_db += c["comm_load_penalty_db"] * (1 - c["pilot_density_max"])
            logit = self.table_logit(range_m) + c["logistic_slope_per_db"] * change_db
            return 1 / (1 + math.exp(-logit))
        snr_db = self.sensing_snr_db(range_m) + change_db
        if c.get("detection_curve") == "swerling1":
            return c["false_alarm_probability"] ** (1 / (1 + 10 ** (snr_db / 10)))
        exponent = -c["logistic_slope_per_db"] * (snr_db - self.threshold_db())
        return 1 / (1 + math.exp(exponent)) if exponent < 300 else 0

    def table_logit(self, range_m):
        points = [(r, math.log(p / (1 - p))) for r, p in self.c["detection_table"]]
        held = min(max(range_m, points[0][0]), points[-1][0])
        for (r0, logit0), (r1, logit1) in zip(points, points[1:]):
            if r0 <= held <= r1:
                return logit0 + (logit1 - logit0) * (held - r0) / (r1 - r0)
        return points[0][1]

    # False alarms.

    def footprint_m(self):
        c = self.c
        if "sensing_footprint_m" in c:
            return c["sensing_footprint_m"]
        if "detection_threshold_db" not in c and "sensing_range_m" in c:
            return c["sensing_range_m"]
        load_db = c["comm_load_penalty_db"] * (1 - c["pilot_density_max"])
        even = lambda r: self.p_d(r, -load_db) >= 0.5
        low, high = 0.0, c["cell_size_m"] * math.hypot(self.w - 1, self.h - 1)
        if even(high):
            return high
        for _ in range(100):
            middle = (low + high) / 2
            low, high = (middle, high) if even(middle) else (low, middle)
        return low

    def false_alarms(self, i):
        p, (x, y) = self.c["false_alarm_per_cell"], self.cells[i]
        reach = (self.footprint_m() / self.c["cell_size_m"]) ** 2
        grid = [(x2, y2) for y2 in range(self.h) for x2 in range(self.w)]
        footprint = [(x2, y2) for x2, y2 in grid if (x2 - x) ** 2 + (y2 - y) ** 2 <= reach]
        size, at_most, count = len(footprint), 0.0, 0
        word = self.block(self.t, i, 0, FALSE_ALARM)[0]
        for k in range(min(8, size)):
            at_most += math.comb(size, k) * p**k * (1 - p) ** (size - k)
            count += word >= math.floor(2**32 * at_most)
        ranks = []
        for k in range(count):
            top = size - count + k
            rank = self.below(self.bits64(self.t, i, 1 + k, FALSE_ALARM), top + 1)
            ranks.append(top if rank in ranks else rank)
        return [footprint[rank] for rank in ranks if footprint[rank] not in self.hotspots]

    def raise_alarms(self, senses):
        if self.c.get("false_alarm_per_cell", 0) == 0:
            return 0
        self.alarms = [self.false_alarms(i) if senses[i] else [] for i in range(self.n)]
        for kept, alarms in zip(self.remembered_alarms, self.alarms):
            if not self.over_episode:
                kept.clear()
            kept.update(alarms)
        seen = [cell for kept in self.remembered_alarms for cell in kept]
        new = {cell for cell in seen if seen.count(cell) >= self.c["quorum"]} - self.falsely
        self.falsely |= new
        return len(new)

    # Reports: counts of sightings by cell, and the highest level of one UAV that a UAV knows of.

    def report(self, hits):
        levels = self.c.get("report_levels", 0)
        for i, (own, known) in enumerate(zip(self.sightings, self.reported)):
            for cell in [self.hotspots[j] for j in hits[i]] + self.alarms[i]:
                own[cell] = own.get(cell, 0) + 1
                if levels > 0:
                    known[cell] = max(known.get(cell, 0), min(own[cell], levels))

    def spread_reports(self):
        for _ in range(self.n):
            old = [dict(known) for known in self.reported]
            for i, known in enumerate(self.reported):
                for k in self.links[i]:
                    for cell, level in old[k].items():
                        known[cell] = max(known.get(cell, 0), level)
            if old == self.reported:
                return

    def reports(self):
        levels = range(1, self.c["report_levels"] + 1)
        by_row = lambda cell: (cell[1], cell[0])
        known_at = lambda known, level: [cell for cell in known if known[cell] >= level]
        of = lambda known: [
            [list(cell) for cell in sorted(known_at(known, level), key=by_row)] for level in levels
        ]
        return [of(known) for known in self.reported]

    def throughput(self, i, k):
        c = self.c
        loss = 20 * math.log10(4 * math.pi * c["carrier_frequency_hz"] / 299_792_458)
        range_m = self.range_m(self.cells[i], self.cells[k])
        loss += 10 * c["path_loss_exponent"] * math.log10(range_m)
        radiated = c["transmit_power_dbm"] + c["transmit_gain_dbi"]
        snr = radiated + c["receive_gain_dbi"] - loss - c["comm_noise_dbm"]
        full = math.log2(1 + 10 ** (snr / 10)) / c["reference_spectral_efficiency"]
        return (1 - self.density[i]) * full

    def link_up(self):
        least = self.c["link_throughput_min"] - 1e-12
        fly = [i for i in range(self.n) if not self.grounded[i]]
        self.links = [set() for _ in range(self.n)]
        for i in fly:
            for k in fly:
                if i != k and min(self.throughput(i, k), self.throughput(k, i)) >= least:
                    self.links[i].add(k)
        means = [
            sum(self.throughput(i, k) for k in links) / len(links) if links else 0.0
            for i, links in enumerate(self.links)
        ]
        self.mean_throughput = sum(means) / self.n

    # The reward.

    def potentials(self):
        """Both potentials of a state that is not terminal."""
        c, span = self.c, self.w + self.h - 2
        left = [self.hotspots[j] for j in range(self.m) if j not in self.confirmed]
        near = lambda cell, targets: min(self.distance(cell, target) for target in targets)
        goal = 0.0
        if left:
            mean = sum(near(cell, left) for cell in self.cells) / self.n
            goal = -c["shaping_goal_weight"] * (
                (mean / span if span else 0.0) + c["shaping_unconfirmed_weight"] * len(left)
            )
        least = half_up(c["carbon_intensity_min_kg_per_kwh"] * 1e6)
        most = half_up(c["carbon_intensity_max_kg_per_kwh"] * 1e6)
        share = 1 - self.grid_share_ppb / 1e9
        clean = share + (1 - share) * (most - self.coming) / (most - least) if most > least else 1.0
        charging = sum(
            (1 - self.battery[i] / self.capacity)
            * (1 - (near(cell, self.depots) / span if span else 0.0))
            for i, cell in enumerate(self.cells)
        )
        return goal, c["shaping_charge_weight"] * charging / self.n * clean

    def rewarded(self, before, informed, confirmed, spent, emitted):
        """The components of this step's reward, from the previous state and this step."""
        c = self.c
        found, told = len(self.confirmed) - len(confirmed), len(self.informed) - len(informed)
        complete = len(self.informed) == len(self.confirmed) == self.m
        over = self.t == c["horizon_steps"]
        new = set(self.cells) - self.visited
        moved = [cell for cell, old in zip(self.cells, before) if cell != old]
        again = sum(cell in self.visited for cell in moved)
        self.visited |= new
        goal, charging = (0.0, 0.0) if complete else self.potentials()
        discount = c["shaping_discount"]
        shaping = discount * goal - self.goal, discount * charging - self.charging
        self.goal, self.charging = goal, charging
        spread = sum(sum(j in known for known in self.knows) / self.n for j in self.confirmed)
        spread = spread / len(self.confirmed) if self.confirmed else 0.0
        paid = told if c["inform_payment"] == "once" else len(self.informed)
        return {
            "detect": c["reward_detect"] * found
            + c.get("reward_false_confirmation", 0) * self.newly_false,
            "inform": c["reward_inform"] * paid,
            "complete": c["reward_complete"] * complete,
            "coverage": c["reward_coverage"] * len(new) / (self.w * self.h),
            "energy": -c["penalty_energy_per_kwh"] * spent / 3.6e12,
            "carbon": -c["penalty_carbon_per_kg"] * emitted / 1e12,
            "revisit": -c["penalty_revisit"] * again,
            "truncation": -c["penalty_truncation"] * over,
            "throughput": c["reward_throughput"] * self.mean_throughput,
            "spread": c["reward_spread"] * spread,
            "shaping_goal": shaping[0],
            "shaping_charge": shaping[1],
        }

    # The step.

    def distance(self, a, b):
        return abs(a[0] - b[0]) + abs(a[1] - b[1])

    def destination(self, i, u_dir):
        x, y = self.cells[i]
        if self.grounded[i]:
            return x, y
        if self.returning[i]:
            home = min(self.depots, key=lambda depot: self.distance((x, y), depot))
            if x != home[0]:
                return x + (1 if home[0] > x else -1), y
            return x, y + (home[1] > y) - (home[1] < y)
        u = max(-1.0, min(1.0, u_dir))
        up, down, left, right, stay = (0, 1), (0, -1), (-1, 0), (1, 0), (0, 0)
        order = {
            "udlrs": (up, down, left, right, stay),
            "symmetric": (up, left, stay, right, down),
        }[self.c.get("motion_map", "udlrs")]
        dx, dy = order[min(4, math.floor((u + 1) / 2 * 5))]
        x2, y2 = x + dx, y + dy
        return (x2, y2) if 0 <= x2 < self.w and 0 <= y2 < self.h else (x, y)

    def step(self, actions):
        c = self.c
        self.t += 1
        low, high = c["pilot_density_min"], c["pilot_density_max"]
        before, confirmed = list(self.cells), set(self.confirmed)
        informed, co2 = self.informed, self.co2
        for i, (u_dir, u_pilot) in enumerate(actions):
            u = max(-1.0, min(1.0, u_pilot))
            self.density[i] = max(low, min(high, low + (u + 1) / 2 * (high - low)))
            self.grounded[i] = self.battery[i] == 0
            self.returning[i] = 0 < self.battery[i] < self.rtb
            self.cells[i] = self.destination(i, u_dir)
        open_to = [set(range(self.m)) - (known & self.confirmed) for known in self.knows]
        senses = [not self.grounded[i] and len(open_to[i]) > 0 for i in range(self.n)]
        hits = [
            {j for j in open_to[i] if senses[i] and self.detects(i, j)} for i in range(self.n)
        ]
        counted = [kept | found for kept, found in zip(self.remembered, hits)]
        if self.over_episode:
            self.remembered = counted
        for j in range(self.m):
            if sum(j in found for found in counted) >= c["quorum"]:
                self.confirmed.add(j)
        learns_all = c.get("learned_detections", "confirmed") == "all"
        for i in range(self.n):
            self.knows[i] |= counted[i] if learns_all else counted[i] & self.confirmed
        self.newly_false = self.raise_alarms(senses)
        self.report(hits)
        self.link_up()
        self.spread()
        self.spread_reports()
        spent = self.spend(before, senses)
        self.informed = set.intersection(*self.knows)
        self.reward = self.rewarded(before, informed, confirmed, spent, self.co2 - co2)

    def spread(self):
        for _ in range(self.n):
            old = [set(known) for known in self.knows]
            for i in range(self.n):
                for k in self.links[i]:
                    self.knows[i] |= old[k]
            if old == self.knows:
                return

    def spend(self, before, senses):
        c, billed, spent = self.c, 0, 0
        for i in range(self.n):
            asked = 0
            if not self.grounded[i]:
                asked = self.move if self.cells[i] != before[i] else self.hover
                if senses[i]:
                    asked += half_up(self.sense / c["pilot_density_max"] * self.density[i])
                if self.links[i]:
                    asked += half_up(self.comm * (1 - self.density[i]))
            used = min(asked, self.battery[i])
            self.battery[i] -= used
            spent += used
            if self.cells[i] in self.depots:
                accepted = min(self.charge, self.capacity - self.battery[i])
                self.battery[i] += accepted
                billed += accepted if c["charge_billing"] == "accepted" else self.charge
        grid = (2 * billed * self.grid_share_ppb + 10**9) // (2 * 10**9)
        self.co2 += (2 * grid * self.coming + 3_600_000) // (2 * 3_600_000)
        self.billed, self.coming = self.coming, self.intensity(self.t)
        return spent


def same(what, ours, theirs):
    if ours != theirs:
        raise SystemExit(f"{what}: rebuilt {ours}, recorded {theirs}")


def near(what, ours, theirs):
    if abs(ours - theirs) > 1e-9 * max(1.0, abs(theirs)):
        raise SystemExit(f"{what}: rebuilt {ours}, recorded {theirs}")


def rebuild(path):
    """Replay one trace and compare every line."""
    with open(path, encoding="utf-8") as file:
        lines = [json.loads(line) for line in file]
    header, steps = lines[0], lines[1:-1]
    mission = Mission(header)
    cells = lambda values: [list(cell) for cell in values]
    flags = lambda values: [i for i, value in enumerate(values) if value]
    same(f"{path} hotspots", cells(mission.hotspots), header["hotspots"])
    same(f"{path} depots", cells(mission.depots), header["depots"])
    same(f"{path} starts", cells(mission.cells), header["initial"]["positions"])
    same(f"{path} charges", mission.battery, header["initial"]["battery_uj"])
    same(f"{path} intensity", mission.coming, header["initial"]["carbon_intensity_mg_per_kwh"])
    for step in steps:
        mission.step(step["actions"])
        at = f"{path} t = {mission.t}:"
        links = [[i, k] for i in range(mission.n) for k in sorted(mission.links[i]) if i < k]
        same(f"{at} t", mission.t, step["t"])
        same(f"{at} positions", cells(mission.cells), step["positions"])
        same(f"{at} battery_uj", mission.battery, step["battery_uj"])
        same(f"{at} grounded", flags(mission.grounded), step["grounded"])
        same(f"{at} returning", flags(mission.returning), step["returning"])
        same(f"{at} links", links, step["links"])
        same(f"{at} knowledge", [sorted(known) for known in mission.knows], step["knowledge"])
        same(f"{at} confirmed", sorted(mission.confirmed), step["confirmed"])
        same(f"{at} informed", sorted(mission.informed), step["informed"])
        if "false_alarms" in step:
            by_row = sorted(mission.falsely, key=lambda cell: (cell[1], cell[0]))
            alarms = [cells(raised) for raised in mission.alarms]
            same(f"{at} false_alarms", alarms, step["false_alarms"])
            same(f"{at} falsely_confirmed", cells(by_row), step["falsely_confirmed"])
        if "reports" in step:
            same(f"{at} reports", mission.reports(), step["reports"])
        same(f"{at} intensity", mission.billed, step["carbon_intensity_mg_per_kwh"])
        same(f"{at} co2_ng", mission.co2, step["co2_ng"])
        near(f"{at} throughput", mission.mean_throughput, step["throughput"])
        for name, value in step["reward"].items():
            near(f"{at} reward.{name}", mission.reward[name], value)
        for i, density in enumerate(step["pilot_density"]):
            near(f"{at} pilot density", mission.density[i], density)
    same(f"{path} steps", mission.t, lines[-1]["steps"])


if __name__ == "__main__":
    for trace in sys.argv[1:]:
        rebuild(trace)
        print(f"{trace}: rebuilt")
