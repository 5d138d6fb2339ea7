/* Threads that share one model with a simulation each, threads that read one simulation, and a
 * batch with worker threads. Every result has to be that of one thread alone. Threads may also use
 * one simulation, batch or policy at once: each call is complete or refused.
 *
 *   threads          all
 *   threads shared   without the batch, whose locks thread checkers cannot see through */
#include "check.h"

#include <pthread.h>
#include <sched.h>

enum { THREADS = 4, STEPS = 60, ENVIRONMENTS = 24 };

struct worker {
    const jcas_model *model;
    const jcas_sim *watched;
    uint64_t seed, hash;
    double return_sum;
};

static float action_of(uint64_t seed, uint32_t step, uint32_t index)
{
    uint64_t bits = (seed + 1) * 2654435761u + step * 40503u + index * 9973u;
    bits ^= bits >> 13;
    bits *= UINT64_C(0x9e3779b97f4a7c15);
    return (float)(bits >> 40) / 8388608.0f - 1.0f;
}

static void fly(struct worker *worker)
{
    jcas_model_info info;
    info.struct_size = sizeof info;
    OK(jcas_model_get_info(worker->model, &info));
    float *actions = ARRAY(float, info.action_len);
    size_t observed = (size_t)info.uav_count * info.observation_len;
    float *observations = ARRAY(float, observed);
    jcas_sim *sim;
    OK(jcas_sim_new(worker->model, &sim));
    OK(jcas_sim_reset(sim, worker->seed));
    jcas_outcome outcome;
    outcome.struct_size = sizeof outcome;
    worker->return_sum = 0;
    for (uint32_t step = 0; step < STEPS; step++) {
        for (uint32_t i = 0; i < info.action_len; i++)
            actions[i] = action_of(worker->seed, step, i);
        OK(jcas_sim_step(sim, actions, info.action_len, &outcome));
        worker->return_sum += outcome.reward;
        OK(jcas_sim_observe(sim, observations, observed));
        uint64_t watched;
        OK(jcas_sim_hash(worker->watched, &watched));
    }
    OK(jcas_sim_hash(sim, &worker->hash));
    OK(jcas_sim_free(sim));
    free(actions);
    free(observations);
}

static void *run(void *worker)
{
    fly((struct worker *)worker);
    return NULL;
}

static void share_a_model(const jcas_model *model)
{
    jcas_sim *watched;
    OK(jcas_sim_new(model, &watched));
    struct worker alone[THREADS], together[THREADS];
    pthread_t threads[THREADS];
    for (int i = 0; i < THREADS; i++) {
        struct worker worker = {model, watched, (uint64_t)i, 0, 0};
        alone[i] = together[i] = worker;
        fly(&alone[i]);
    }
    for (int i = 0; i < THREADS; i++)
        CHECK(pthread_create(&threads[i], NULL, run, &together[i]) == 0);
    for (int i = 0; i < THREADS; i++) {
        CHECK(pthread_join(threads[i], NULL) == 0);
        CHECK(together[i].hash == alone[i].hash);
        CHECK(together[i].return_sum == alone[i].return_sum);
    }
    OK(jcas_sim_free(watched));
}

/* Returns the batch's states and observations after some steps. */
static uint64_t fly_batch(const jcas_model *model, uint32_t thread_count)
{
    jcas_model_info info;
    info.struct_size = sizeof info;
    OK(jcas_model_get_info(model, &info));
    size_t observed = (size_t)ENVIRONMENTS * info.uav_count * info.observation_len;
    size_t acted = (size_t)ENVIRONMENTS * info.action_len;
    float *observations = ARRAY(float, observed), *finals = ARRAY(float, observed);
    float *actions = ARRAY(float, acted), *global = ARRAY(float, ENVIRONMENTS * info.global_len);
    float rewards[ENVIRONMENTS], *uav_rewards = ARRAY(float, ENVIRONMENTS * info.uav_count);
    uint8_t terminated[ENVIRONMENTS], truncated[ENVIRONMENTS];
    jcas_metrics metrics[ENVIRONMENTS];
    double components[ENVIRONMENTS * 12];
    memset(finals, 0, observed * sizeof(float));
    uint64_t seeds[ENVIRONMENTS];
    for (uint64_t m = 0; m < ENVIRONMENTS; m++)
        seeds[m] = m;

    jcas_batch *batch;
    OK(jcas_batch_new(model, ENVIRONMENTS, thread_count, &batch));
    OK(jcas_batch_reset(batch, seeds, ENVIRONMENTS, observations, observed, global,
                        ENVIRONMENTS * info.global_len));
    jcas_batch_out out;
    memset(&out, 0, sizeof out);
    out.struct_size = sizeof out;
    out.observations = observations, out.observation_count = observed;
    out.rewards = rewards, out.reward_count = ENVIRONMENTS;
    out.terminated = terminated, out.terminated_count = ENVIRONMENTS;
    out.truncated = truncated, out.truncated_count = ENVIRONMENTS;
    out.global = global, out.global_count = ENVIRONMENTS * info.global_len;
    out.components = components, out.component_count = ENVIRONMENTS * 12;
    out.final_observations = finals, out.final_observation_count = observed;
    out.final_metrics = metrics, out.final_metrics_count = ENVIRONMENTS;
    out.metrics_size = sizeof(jcas_metrics);
    out.uav_rewards = uav_rewards, out.uav_reward_count = ENVIRONMENTS * info.uav_count;

    uint64_t hash = 0;
    int ended = 0;
    for (uint32_t step = 0; step < 2 * STEPS; step++) {
        for (size_t i = 0; i < acted; i++)
            actions[i] = action_of(7, step, (uint32_t)i);
        OK(jcas_batch_step(batch, actions, acted, 1, &out));
        hash = hash * 31 + hash_floats(observations, observed);
        hash = hash * 31 + hash_floats(finals, observed);
        hash = hash * 31 + hash_floats(global, ENVIRONMENTS * info.global_len);
        hash = hash * 31 + hash_floats(rewards, ENVIRONMENTS);
        hash = hash * 31 + hash_floats(uav_rewards, ENVIRONMENTS * info.uav_count);
        for (int m = 0; m < ENVIRONMENTS; m++) {
            double sum = 0;
            for (uint32_t i = 0; i < info.uav_count; i++)
                sum += (double)uav_rewards[(uint32_t)m * info.uav_count + i];
            double off = sum / info.uav_count - (double)rewards[m];
            CHECK(off < 1e-4 && off > -1e-4);
        }
        for (int m = 0; m < ENVIRONMENTS; m++) {
            if (terminated[m] || truncated[m]) {
                ended++;
                CHECK(metrics[m].terminated == terminated[m] &&
                      metrics[m].truncated == truncated[m]);
                CHECK(metrics[m].steps > 0 && metrics[m].struct_size == sizeof(jcas_metrics));
            }
        }
    }
    CHECK(ended >= ENVIRONMENTS);
    OK(jcas_batch_free(batch));
    free(observations);
    free(finals);
    free(uav_rewards);
    free(actions);
    free(global);
    return hash;
}

/* An object that several threads use at once, against the contract. */
enum { CALLS = 1000 };

struct intruder {
    jcas_sim *sim;
    jcas_batch *batch;
    jcas_policy *policy;
    const jcas_sim *seen;
    jcas_model_info info;
    uint64_t done, refused;
};

/* Counts a call, which is complete or refused. A refused call yields to the other threads. */
static void count_call(struct intruder *intruder, int32_t status)
{
    CHECK(status == JCAS_OK || status == JCAS_ERROR_BUSY);
    if (status == JCAS_OK) {
        intruder->done++;
    } else {
        intruder->refused++;
        sched_yield();
    }
}

static void *step_one_sim(void *intruder_)
{
    struct intruder *intruder = (struct intruder *)intruder_;
    float *actions = ARRAY(float, intruder->info.action_len);
    jcas_outcome outcome;
    outcome.struct_size = sizeof outcome;
    for (uint32_t call = 0; intruder->done < CALLS; call++) {
        for (uint32_t i = 0; i < intruder->info.action_len; i++)
            actions[i] = action_of(1, call, i);
        count_call(intruder,
                   jcas_sim_step(intruder->sim, actions, intruder->info.action_len, &outcome));
        uint64_t hash;
        int32_t status = jcas_sim_hash(intruder->sim, &hash);
        CHECK(status == JCAS_OK || status == JCAS_ERROR_BUSY);
    }
    free(actions);
    return NULL;
}

static void *step_one_batch(void *intruder_)
{
    struct intruder *intruder = (struct intruder *)intruder_;
    size_t acted = (size_t)ENVIRONMENTS * intruder->info.action_len;
    size_t observed =
        (size_t)ENVIRONMENTS * intruder->info.uav_count * intruder->info.observation_len;
    float *actions = ARRAY(float, acted), *observations = ARRAY(float, observed);
    float rewards[ENVIRONMENTS];
    uint8_t terminated[ENVIRONMENTS], truncated[ENVIRONMENTS];
    jcas_batch_out out;
    memset(&out, 0, sizeof out);
    out.struct_size = sizeof out;
    out.observations = observations, out.observation_count = observed;
    out.rewards = rewards, out.reward_count = ENVIRONMENTS;
    out.terminated = terminated, out.terminated_count = ENVIRONMENTS;
    out.truncated = truncated, out.truncated_count = ENVIRONMENTS;
    for (uint32_t call = 0; intruder->done < CALLS / 10; call++) {
        for (size_t i = 0; i < acted; i++)
            actions[i] = action_of(2, call, (uint32_t)i);
        count_call(intruder, jcas_batch_step(intruder->batch, actions, acted, 1, &out));
    }
    free(actions);
    free(observations);
    return NULL;
}

static void *fly_one_policy(void *intruder_)
{
    struct intruder *intruder = (struct intruder *)intruder_;
    float *actions = ARRAY(float, intruder->info.action_len);
    while (intruder->done < CALLS)
        count_call(intruder, jcas_policy_act(intruder->policy, intruder->seen, actions,
                                             intruder->info.action_len));
    free(actions);
    return NULL;
}

/* Lets every thread make its calls. */
static void intrude(const struct intruder *shared, void *(*task)(void *))
{
    struct intruder intruders[THREADS];
    pthread_t threads[THREADS];
    uint64_t refused = 0;
    for (int i = 0; i < THREADS; i++) {
        intruders[i] = *shared;
        CHECK(pthread_create(&threads[i], NULL, task, &intruders[i]) == 0);
    }
    for (int i = 0; i < THREADS; i++) {
        CHECK(pthread_join(threads[i], NULL) == 0);
        refused += intruders[i].refused;
    }
    printf("%llu calls refused\n", (unsigned long long)refused);
}

static void share_one_object(const jcas_model *model, const jcas_model *long_model, int with_batch)
{
    struct intruder shared;
    memset(&shared, 0, sizeof shared);
    shared.info.struct_size = sizeof shared.info;
    OK(jcas_model_get_info(model, &shared.info));

    /* Each completed step counts, and no other. */
    OK(jcas_sim_new(long_model, &shared.sim));
    intrude(&shared, step_one_sim);
    jcas_episode episode;
    episode.struct_size = sizeof episode;
    OK(jcas_sim_get_episode(shared.sim, &episode));
    CHECK(episode.t == THREADS * CALLS);
    OK(jcas_sim_free(shared.sim));

    jcas_sim *seen;
    OK(jcas_sim_new(model, &seen));
    shared.seen = seen;
    OK(jcas_policy_baseline(model, "greedy", NULL, &shared.policy, NULL, 0));
    intrude(&shared, fly_one_policy);
    OK(jcas_policy_free(shared.policy));
    OK(jcas_sim_free(seen));

    for (uint32_t threads = 1; with_batch && threads < 3; threads++) {
        OK(jcas_batch_new(model, ENVIRONMENTS, threads, &shared.batch));
        intrude(&shared, step_one_batch);
        uint64_t hash;
        OK(jcas_batch_hash(shared.batch, &hash));
        OK(jcas_batch_free(shared.batch));
    }
}

int main(int count, char **arguments)
{
    jcas_config config;
    OK(jcas_config_default(&config, sizeof config));
    config.uav_count = 6;
    config.horizon_steps = STEPS;
    config.quorum = 1;
    jcas_model *model;
    OK(jcas_model_new(&config, &model, NULL, 0));
    share_a_model(model);
    config.horizon_steps = THREADS * CALLS + 1;
    config.quorum = config.uav_count;
    jcas_model *long_model;
    OK(jcas_model_new(&config, &long_model, NULL, 0));
    int with_batch = count < 2 || strcmp(arguments[1], "shared") != 0;
    share_one_object(model, long_model, with_batch);
    OK(jcas_model_free(long_model));
    if (with_batch) {
        uint64_t alone = fly_batch(model, 1);
        CHECK(fly_batch(model, 2) == alone);
        CHECK(fly_batch(model, 5) == alone);
        CHECK(fly_batch(model, 0) == alone);
    }
    OK(jcas_model_free(model));
    puts("threads agree with one");
    return 0;
}
