// The C++ owners: their return values, their exceptions if requested, and their destructors.
#ifdef WITH_EXCEPTIONS
#define JCAS_EXCEPTIONS
#endif
#include <jcas.hpp>

#include <cmath>
#include <cstdio>
#include <cstdlib>

#define CHECK(condition)                                                                           \
    do {                                                                                           \
        if (!(condition)) {                                                                        \
            std::fprintf(stderr, "%s:%d: not so: %s\n", __FILE__, __LINE__, #condition);           \
            std::exit(1);                                                                          \
        }                                                                                          \
    } while (0)

static void refuse_configurations()
{
    auto wrong = jcas::configuration_from_toml("uav_count = 0");
    CHECK(!wrong && wrong.code() == JCAS_ERROR_CONFIG);
    CHECK(wrong.message() == "uav_count = 0: must be a whole number from 1 to 4096");
    CHECK(!jcas::preset("best") && jcas::preset("paper"));
    CHECK(!jcas::configuration_from_json("") &&
          jcas::configuration_from_json("{\"quorum\": 2}")->quorum == 2);
    jcas_config config = jcas::configuration();
    config.pilot_density_min = 0.9;
    auto model = jcas::model::create(config);
    CHECK(!model && model.message().find("pilot_density_min = 0.9") == 0);
#ifdef WITH_EXCEPTIONS
    bool thrown = false;
    try {
        model.take();
    } catch (const jcas::error &error) {
        thrown = error.code() == JCAS_ERROR_CONFIG;
    }
    CHECK(thrown);
#endif
}

static void fly(const jcas::model &model)
{
    jcas::sim sim = jcas::sim::create(model).take();
    sim.reset(5).check();
    std::vector<float> actions(model.info().action_len, 0.0f);
    CHECK(sim.step(actions));
    auto refused = sim.step(jcas::span<const float>(actions.data(), 3));
    CHECK(!refused && refused.code() == JCAS_ERROR_LENGTH);
    actions[0] = NAN;
    auto nan = sim.step(actions);
    CHECK(!nan && nan.message() == "actions[0][0] = NaN: must be a number (clipped to -1..1)");
    actions[0] = 0;

    const std::vector<unsigned char> snapshot = sim.save();
    const std::uint64_t hash = sim.hash();
    jcas::sim twin = jcas::sim::create(model).take();
    CHECK(twin.load(snapshot) && twin.hash() == hash);
    CHECK(twin.step_begin(actions) && twin.step_sense() && twin.step_communicate() &&
          twin.step_end());
    CHECK(twin.hash() != hash && twin.fork_from(sim) && twin.hash() == hash);
    jcas::sim moved = std::move(twin);
    CHECK(moved.hash() == hash && twin.get() == nullptr);
    CHECK(moved.episode().t == 1 && moved.metrics().steps == 1 && moved.rewards().size() == 12);
    CHECK(moved.uavs().size() == model.info().uav_count);
    std::vector<jcas_hotspot> hotspots(model.info().hotspot_count);
    CHECK(moved.hotspots(hotspots) && hotspots[0].x == moved.hotspots()[0].x);
}

static void record(const jcas::model &model)
{
    jcas::sim sim = jcas::sim::create(model).take();
    std::string trace;
    const auto append = [&trace](std::string_view bytes) {
        trace += bytes;
        return true;
    };
    const std::vector<float> actions(model.info().action_len, 0.0f);
    CHECK(sim.record_end().code() == JCAS_ERROR_OUT_OF_ORDER);
    CHECK(sim.record(7, [](std::string_view) { return false; }).code() == JCAS_ERROR_SINK);
    CHECK(sim.record(7, append, "nobody"));
    jcas::sim moved = std::move(sim);
    for (int step = 0; step < 20; step++) {
        CHECK(moved.set_battery(1, 500000000000u + static_cast<unsigned>(step)));
        CHECK(moved.step(actions));
    }
    CHECK(moved.record_end() && trace.find("\"policy\":\"nobody\"") != std::string::npos);
    const std::uint64_t hash = moved.hash();
    jcas::sim again = jcas::sim::create(model).take();
    CHECK(*again.verify(trace) == hash);
    auto cut = again.verify(trace.substr(0, 2000));
    CHECK(cut.code() == JCAS_ERROR_CORRUPT && cut.message().find("not a whole trace") == 0);
}

/* A sink that calls back into the simulation that writes to it finds it in use. */
static void refuse_a_simulation_in_use(const jcas::model &model)
{
    jcas::sim sim = jcas::sim::create(model).take();
    const std::vector<float> actions(model.info().action_len, 0.0f);
    int asked = 0;
    const auto sink = [&](std::string_view) {
        const auto stepped = sim.step(actions);
        CHECK(stepped.code() == JCAS_ERROR_BUSY);
        CHECK(stepped.message() == jcas_status_string(JCAS_ERROR_BUSY));
#ifdef JCAS_EXCEPTIONS
        try {
            CHECK(sim.hash() == 0);
            CHECK(false);
        } catch (const jcas::error &error) {
            CHECK(error.code() == JCAS_ERROR_BUSY);
        }
#endif
        asked++;
        return true;
    };
    CHECK(sim.record(7, sink));
    CHECK(sim.step(actions));
    CHECK(sim.record_end() && asked >= 3);
}

static void fly_batch(const jcas::model &model)
{
    jcas::batch batch = jcas::batch::create(model, 3, 2).take();
    const std::vector<std::uint64_t> seeds = {1, 2, 3};
    CHECK(batch.reset(seeds));
    std::vector<float> actions(3 * model.info().action_len, 0.0f);
    for (int step = 0; step < 200; step++)
        CHECK(batch.step(actions));
    CHECK(batch.final_metrics[0].truncated == 1 && batch.final_metrics[0].steps == 100);
    jcas::sim sim = jcas::sim::create(model).take();
    CHECK(batch.copy_to(2, sim) &&
          sim.episode().seed == jcas_derive_seed(jcas_derive_seed(3, 0), 0));
    CHECK(batch.copy_to(3, sim).code() == JCAS_ERROR_ARGUMENT);
}

static void fly_policies(const jcas::model &model)
{
    CHECK(jcas::policy::load(model, {}).code() == JCAS_ERROR_CORRUPT);
    CHECK(!jcas::policy::baseline(model, "swan"));
    jcas::policy policy = jcas::policy::baseline(model, "greedy", "max").take();
    CHECK(policy.sampled(true));
    jcas::sim sim = jcas::sim::create(model).take();
    CHECK(sim.reset(3));
    std::vector<float> actions(model.info().action_len);
    for (jcas_outcome outcome{}; !outcome.terminated && !outcome.truncated;) {
        CHECK(policy.act(sim, actions));
        outcome = sim.step(actions).take();
    }
    CHECK(sim.metrics().confirmed > 0);
    const std::vector<unsigned char> memory = policy.save_memory(sim).take();
    CHECK(!memory.empty() && policy.load_memory(sim, memory) && policy.forget());
    CHECK(policy.load_memory(sim, {memory.data(), 8}).code() == JCAS_ERROR_CORRUPT);
    const std::vector<std::uint64_t> seeds = {8, 9};
    jcas::batch batch = jcas::batch::create(model, 2).take();
    CHECK(policy.act(batch, actions).code() == JCAS_ERROR_LENGTH);
    actions.resize(2 * actions.size());
    CHECK(policy.act(batch, actions));

    CHECK(sim.reset(3) && policy.fork(sim, batch));
    jcas::futures futures(batch.environments());
    CHECK(policy.roll_out(batch, 7, futures) && futures.steps[1] == 7);
    CHECK(futures.returns[0] == futures.returns[1] && futures.metrics[0].steps == 7);
    const double flown = futures.returns[0];
    CHECK(batch.fork(sim, seeds) && batch.roll_out(actions, 1, futures));
    CHECK(futures.steps[0] == 1 && futures.returns[0] != flown);
    CHECK(batch.roll_out(actions, 2, futures).code() == JCAS_ERROR_LENGTH);
}

static void follow_plans(const jcas::model &model)
{
    std::uint64_t heard = 0;
    const auto tell = [&heard](std::uint64_t iterations, double best_steps) {
        heard = iterations;
        return best_steps <= 0 || iterations < 512;
    };
    const jcas_cell hotspots[] = {{0, 1}, {9, 2}, {3, 7}, {11, 11}, {5, 0}};
    CHECK(model.info().hotspot_count == 5);
    CHECK(jcas::plan::tour(model, {hotspots, 4}, 1000).code() == JCAS_ERROR_LENGTH);
    const jcas::plan plan = jcas::plan::tour(model, hotspots, 100000, 3, tell).take();
    const jcas_plan_info &info = plan.info();
    CHECK(info.stopped == 1 && info.iterations == heard && info.seed == 3);
    const std::vector<jcas_cell> cells = plan.cells();
    CHECK(cells.size() == std::size_t{info.uav_count} * (info.step_count + 1));
    CHECK(cells[0].x == 6 && cells[0].y == 6); // the depot
    CHECK(plan.pilot_densities().size() == std::size_t{info.uav_count} * info.step_count);
    const std::string text = plan.to_json();
    CHECK(jcas::plan::from_json(model, text).take().to_json() == text);
    CHECK(jcas::plan::from_json(model, {}).code() == JCAS_ERROR_CORRUPT);
    CHECK(jcas::plan::search(model, 0).take().info().iterations == 0);
    jcas::policy policy = jcas::policy::follow(model, plan).take();
    jcas::sim sim = jcas::sim::create(model).take();
    CHECK(sim.reset(3) && sim.set_hotspots(hotspots));
    std::vector<float> actions(model.info().action_len);
    for (jcas_outcome outcome{}; !outcome.terminated && !outcome.truncated;) {
        CHECK(policy.act(sim, actions));
        outcome = sim.step(actions).take();
    }
    CHECK(sim.metrics().confirmed == 5);
}

int main()
{
    CHECK(jcas::check_abi());
    refuse_configurations();
    {
        jcas::model model = jcas::model::create(jcas::configuration()).take();
        CHECK(model.config().uav_count == 10 && model.radio(0, 0, 0.3)->link_throughput > 1);
        CHECK(!model.radio(99, 0, 0.3));
        fly(model);
        record(model);
        refuse_a_simulation_in_use(model);
        fly_batch(model);
        fly_policies(model);
        follow_plans(model);
        // No object uses the model any more.
        jcas_model *handle = const_cast<jcas_model *>(model.get());
        jcas_sim *sim = nullptr;
        CHECK(jcas_sim_new(handle, &sim) == JCAS_OK &&
              jcas_model_free(handle) == JCAS_ERROR_IN_USE);
        CHECK(jcas_sim_free(sim) == JCAS_OK);
    }
    std::puts("owners own");
    return 0;
}
