// A fleet that looks ahead. Before each step it forks the simulation and tries each hotspot as a
// common target for a few steps. It then flies to the one with the best return.
//
// With jcas installed and PKG_CONFIG_PATH set, as docs/c.md says:
//
//     libdir=$(pkg-config --variable=libdir jcas)
//     c++ -std=c++17 fleet.cpp $(pkg-config --cflags --libs jcas) -Wl,-rpath,"$libdir" && ./a.out
#include <jcas.hpp>

#include <cstdio>
#include <vector>

namespace {

constexpr int LOOK_AHEAD_STEPS = 12;

float toward(std::uint32_t x, std::uint32_t y, const jcas_hotspot &target)
{
    if (x != target.x)
        return x < target.x ? JCAS_MOVE_RIGHT : JCAS_MOVE_LEFT;
    if (y != target.y)
        return y < target.y ? JCAS_MOVE_UP : JCAS_MOVE_DOWN;
    return JCAS_MOVE_STAY;
}

std::vector<float> gather(const jcas::sim &sim, const jcas_hotspot &target)
{
    std::vector<float> actions;
    for (const jcas_uav &uav : sim.uavs()) {
        actions.push_back(toward(uav.x, uav.y, target));
        actions.push_back(1.0f);
    }
    return actions;
}

// Returns the return of flying toward one target from the present state, in a fork.
double expected_return(const jcas::sim &sim, jcas::sim &fork, const jcas_hotspot &target)
{
    fork.fork_from(sim).check();
    double total = 0;
    for (int step = 0; step < LOOK_AHEAD_STEPS; step++) {
        jcas_outcome outcome = fork.step(gather(fork, target)).take();
        total += outcome.reward;
        if (outcome.terminated || outcome.truncated)
            break;
    }
    return total;
}

} // namespace

int main()
{
    auto config = jcas::configuration_from_toml("uav_count = 12\nhotspot_count = 4\n");
    if (!config) {
        std::fprintf(stderr, "%s\n", config.message().c_str());
        return 1;
    }
    jcas::model model = jcas::model::create(*config).take();
    jcas::sim sim = jcas::sim::create(model).take();
    jcas::sim fork = jcas::sim::create(model).take();
    sim.reset(3).check();

    for (jcas_outcome outcome{}; !outcome.terminated && !outcome.truncated;) {
        std::vector<float> best_actions;
        double best_return = -1e9;
        for (const jcas_hotspot &hotspot : sim.hotspots()) {
            if (hotspot.confirmed)
                continue;
            double expected = expected_return(sim, fork, hotspot);
            if (expected > best_return) {
                best_return = expected;
                best_actions = gather(sim, hotspot);
            }
        }
        if (best_actions.empty()) // All are confirmed: meet at the first and share knowledge.
            best_actions = gather(sim, sim.hotspots().front());
        outcome = sim.step(best_actions).take();
    }

    jcas_metrics metrics = sim.metrics();
    std::printf("%s in %u steps: %u hotspots confirmed, return %.2f, %.3f kWh, %.4f kg CO2\n",
                metrics.terminated ? "complete" : "not complete", metrics.steps, metrics.confirmed,
                metrics.return_sum, metrics.energy_kwh, metrics.co2_kg);
    return metrics.terminated ? 0 : 1;
}
