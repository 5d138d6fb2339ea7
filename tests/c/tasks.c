/* Batches in the caller's memory: stepped by the caller's tasks, saved and reset in part. The
 * threads of a batch end with the batch. A batch with threads remains usable after a fork. */
#define _POSIX_C_SOURCE 200809L
#include "check.h"

#include <dirent.h>
#include <pthread.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

enum { N = 4, HOTSPOTS = 3, M = 13, TASKS = 5, STEPS = 40 };

static float actions[M * 2 * N], *observations, rewards[M];
static uint8_t terminated[M], truncated[M];
static size_t observed;
static jcas_batch_out out;

static uint64_t flown(jcas_batch *batch)
{
    uint64_t seeds[M], hash;
    for (uint64_t m = 0; m < M; m++)
        seeds[m] = 100 + m;
    OK(jcas_batch_reset(batch, seeds, M, observations, observed, NULL, 0));
    for (int step = 0; step < STEPS; step++) {
        for (int i = 0; i < M * 2 * N; i++)
            actions[i] = (float)((step * 7919 + i * 104729) % 2000) / 1000.0f - 1.0f;
        OK(jcas_batch_step(batch, actions, M * 2 * N, 1, &out));
    }
    OK(jcas_batch_hash(batch, &hash));
    return hash;
}

/* Runs the tasks in every order on this thread, some of them twice. */
static void run_backwards(jcas_task task, void *task_context, uint32_t count, void *context)
{
    CHECK(count == TASKS && *(int *)context == 7);
    for (uint32_t i = count; i-- > 0;) {
        task(task_context, i);
        task(task_context, count - 1);
    }
    task(task_context, count); /* there is none */
}

/* A host that forgets most of its tasks: the step runs them. */
static void run_one(jcas_task task, void *task_context, uint32_t count, void *context)
{
    (void)context;
    task(task_context, count / 2);
}

/* A host that forgets all of its tasks. */
static void run_nothing(jcas_task task, void *task_context, uint32_t count, void *context)
{
    (void)task, (void)task_context, (void)count, (void)context;
}

/* A host that calls back into the batch during its step: each such call is refused. */
static jcas_batch *stepped;

static void run_and_intrude(jcas_task task, void *task_context, uint32_t count, void *context)
{
    uint64_t hash;
    EXPECT(JCAS_ERROR_BUSY, jcas_batch_step(stepped, actions, M * 2 * N, 1, &out));
    EXPECT(JCAS_ERROR_BUSY, jcas_batch_hash(stepped, &hash));
    EXPECT(JCAS_ERROR_BUSY, jcas_batch_free(stepped));
    run_backwards(task, task_context, count, context);
}

/* A step whose runner runs no task is refused, and writes nothing. */
static void refuse_a_runner_that_runs_nothing(const jcas_model *model)
{
    jcas_batch_options options = {.struct_size = sizeof options, .environments = M,
                                  .threads = TASKS, .run = run_nothing};
    size_t size, alignment, length;
    OK(jcas_batch_layout(model, &options, &size, &alignment));
    void *memory = allocated(size);
    jcas_batch *batch;
    OK(jcas_batch_init(memory, size, model, &options, &batch));
    uint64_t before, after;
    char why[100];
    OK(jcas_batch_hash(batch, &before));
    mark(observations, observed * sizeof(float));
    EXPECT(JCAS_ERROR_ARGUMENT, jcas_batch_step(batch, actions, M * 2 * N, 1, &out));
    OK(jcas_batch_message(batch, why, sizeof why, &length));
    CHECK(strcmp(why, "run returned before it had run a task of the step") == 0);
    CHECK(untouched(observations, observed * sizeof(float)));
    OK(jcas_batch_hash(batch, &after));
    CHECK(before == after);
    OK(jcas_batch_free(batch));
    free(memory);
}

/* Without automatic resets, a message names the environment whose episode has ended. */
static void name_the_environment_that_refuses(const jcas_model *model)
{
    jcas_batch *batch;
    jcas_sim *ended;
    jcas_outcome outcome = {.struct_size = sizeof outcome};
    float stay[2 * N] = {0};
    char why[100];
    size_t length;
    OK(jcas_sim_new(model, &ended));
    while (!outcome.terminated && !outcome.truncated)
        OK(jcas_sim_step(ended, stay, 2 * N, &outcome));
    OK(jcas_batch_new(model, M, 2, &batch));
    OK(jcas_batch_set(batch, 5, ended));
    EXPECT(JCAS_ERROR_EPISODE_OVER, jcas_batch_step(batch, actions, M * 2 * N, 0, &out));
    OK(jcas_batch_message(batch, why, sizeof why, &length));
    CHECK(strcmp(why, "environment 5: the episode has ended: reset before the next step") == 0);
    OK(jcas_batch_free(batch));
    OK(jcas_sim_free(ended));
}

static void refuse_a_batch_in_use(const jcas_model *model, uint64_t expected)
{
    int seven = 7;
    jcas_batch_options options = {.struct_size = sizeof options, .environments = M,
                                  .threads = TASKS, .run = run_and_intrude, .run_context = &seven};
    size_t size, alignment;
    OK(jcas_batch_layout(model, &options, &size, &alignment));
    void *memory = allocated(size);
    OK(jcas_batch_init(memory, size, model, &options, &stepped));
    CHECK(flown(stepped) == expected);
    OK(jcas_batch_free(stepped));
    free(memory);
}

struct errand {
    jcas_task task;
    void *context;
    uint32_t index;
};

static void *run_errand(void *errand_)
{
    struct errand *errand = (struct errand *)errand_;
    errand->task(errand->context, errand->index);
    return NULL;
}

static void run_threads(jcas_task task, void *task_context, uint32_t count, void *context)
{
    pthread_t threads[TASKS];
    struct errand errands[TASKS];
    (void)context;
    for (uint32_t i = 0; i < count; i++) {
        errands[i] = (struct errand){task, task_context, i};
        CHECK(pthread_create(&threads[i], NULL, run_errand, &errands[i]) == 0);
    }
    for (uint32_t i = 0; i < count; i++)
        CHECK(pthread_join(threads[i], NULL) == 0);
}

static void use_tasks(const jcas_model *model, uint64_t expected)
{
    int seven = 7;
    jcas_run_tasks runners[] = {run_backwards, run_one, run_threads, NULL};
    for (int i = 0; i < 4; i++) {
        jcas_batch_options options = {.struct_size = sizeof options,
                                      .environments = M,
                                      .threads = TASKS,
                                      .run = runners[i],
                                      .run_context = &seven};
        size_t size, alignment;
        OK(jcas_batch_layout(model, &options, &size, &alignment));
        CHECK(alignment <= 16);
        void *memory = allocated(size);
        jcas_batch *batch, *again;
        EXPECT(JCAS_ERROR_LENGTH, jcas_batch_init(memory, size - 1, model, &options, &batch));
        OK(jcas_batch_init(memory, size, model, &options, &batch));
        EXPECT(JCAS_ERROR_IN_USE, jcas_batch_init(memory, size, model, &options, &again));
        CHECK(flown(batch) == expected);
        OK(jcas_batch_free(batch));
        free(memory);
    }
}

static void save_and_reset(const jcas_model *model, size_t snapshot_size)
{
    jcas_batch *batch, *twin;
    jcas_sim *sim;
    uint64_t hash, other, seeds[M] = {0}, before, after;
    uint8_t mask[M] = {0};
    size_t size = M * snapshot_size;
    unsigned char *saved = ARRAY(unsigned char, size);
    OK(jcas_batch_new(model, M, 1, &batch));
    OK(jcas_batch_new(model, M, 2, &twin));
    OK(jcas_sim_new(model, &sim));
    hash = flown(batch);
    OK(jcas_batch_save(batch, saved, size));
    OK(jcas_batch_load(twin, saved, size));
    OK(jcas_batch_hash(twin, &other));
    CHECK(hash == other);
    saved[size - 20] ^= 1; /* of the last: none is taken up */
    OK(jcas_batch_step(twin, actions, M * 2 * N, 1, &out));
    OK(jcas_batch_hash(twin, &hash));
    EXPECT(JCAS_ERROR_CORRUPT, jcas_batch_load(twin, saved, size));
    OK(jcas_batch_hash(twin, &other));
    CHECK(hash == other);

    mask[3] = 1, seeds[3] = 77;
    OK(jcas_batch_get(batch, 2, sim));
    OK(jcas_sim_hash(sim, &before));
    mark(observations, observed * sizeof(float));
    OK(jcas_batch_reset_some(batch, mask, M, seeds, M, observations, observed, NULL, 0));
    size_t row = observed / M;
    CHECK(untouched(observations, 3 * row * sizeof(float)));
    CHECK(!untouched(observations + 3 * row, row * sizeof(float)));
    CHECK(untouched(observations + 4 * row, (M - 4) * row * sizeof(float)));
    OK(jcas_batch_get(batch, 2, sim));
    OK(jcas_sim_hash(sim, &after));
    CHECK(before == after);
    OK(jcas_batch_get(batch, 3, sim));
    OK(jcas_sim_hash(sim, &after));
    OK(jcas_sim_reset(sim, 77));
    OK(jcas_sim_hash(sim, &before));
    CHECK(before == after);
    OK(jcas_sim_free(sim));
    OK(jcas_batch_free(batch));
    OK(jcas_batch_free(twin));
    free(saved);
}

static int threads_of_this_process(void)
{
    DIR *folder = opendir("/proc/self/task");
    if (folder == NULL)
        return 1;
    int count = -2; /* "." and ".." */
    while (readdir(folder) != NULL)
        count++;
    closedir(folder);
    return count;
}

/* A joined thread remains in /proc for another moment: the kernel wakes the joining thread before
 * it removes the entry. */
static int only_this_thread_is_left(void)
{
    for (int tries = 0; tries < 1000; tries++) {
        if (threads_of_this_process() == 1)
            return 1;
        nanosleep(&(struct timespec){.tv_nsec = 1000000}, NULL);
    }
    return 0;
}

static void threads_end(const jcas_model *model)
{
    for (int i = 0; i < 100; i++) {
        jcas_batch *batch;
        OK(jcas_batch_new(model, M, 4, &batch));
        OK(jcas_batch_step(batch, actions, M * 2 * N, 1, &out));
        OK(jcas_batch_free(batch));
        CHECK(only_this_thread_is_left());
    }
}

static void fork_with_threads(jcas_model *model, uint64_t expected)
{
    jcas_batch *batch;
    OK(jcas_batch_new(model, M, 4, &batch));
    CHECK(flown(batch) == expected);
    pid_t child = fork();
    CHECK(child >= 0);
    if (child == 0) {
        uint64_t hash;
        jcas_batch *own;
        alarm(60);
        EXPECT(JCAS_ERROR_FORKED, jcas_batch_step(batch, actions, M * 2 * N, 1, &out));
        OK(jcas_batch_hash(batch, &hash));
        CHECK(hash == expected);
        OK(jcas_batch_free(batch));
        OK(jcas_batch_new(model, M, 4, &own));
        CHECK(flown(own) == expected);
        OK(jcas_batch_free(own));
        OK(jcas_model_free(model));
        _exit(0);
    }
    int status;
    CHECK(waitpid(child, &status, 0) == child);
    CHECK(WIFEXITED(status) && WEXITSTATUS(status) == 0);
    CHECK(flown(batch) == expected);
    OK(jcas_batch_free(batch));
}

int main(void)
{
    jcas_config config;
    jcas_model *model;
    jcas_batch *batch;
    jcas_model_info info = {.struct_size = sizeof info};
    OK(jcas_config_default(&config, sizeof config));
    config.uav_count = N;
    config.hotspot_count = HOTSPOTS;
    config.horizon_steps = 15;
    OK(jcas_model_new(&config, &model, NULL, 0));
    OK(jcas_model_get_info(model, &info));
    observed = (size_t)M * N * info.observation_len;
    observations = ARRAY(float, observed);
    out = (jcas_batch_out){.struct_size = sizeof out,
                           .observations = observations, .observation_count = observed,
                           .rewards = rewards, .reward_count = M,
                           .terminated = terminated, .terminated_count = M,
                           .truncated = truncated, .truncated_count = M};
    OK(jcas_batch_new(model, M, 1, &batch));
    uint64_t expected = flown(batch);
    OK(jcas_batch_free(batch));
    use_tasks(model, expected);
    refuse_a_batch_in_use(model, expected);
    refuse_a_runner_that_runs_nothing(model);
    name_the_environment_that_refuses(model);
    save_and_reset(model, info.snapshot_size);
    threads_end(model);
    fork_with_threads(model, expected);
    OK(jcas_model_free(model));
    free(observations);
    puts("tasks, snapshots, threads and forks agree");
    return 0;
}
