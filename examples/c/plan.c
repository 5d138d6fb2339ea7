/* Plans a search for hidden hotspots, then flies it.
 *
 * With jcas installed and PKG_CONFIG_PATH set, as docs/c.md says:
 *
 *   libdir=$(pkg-config --variable=libdir jcas)
 *   cc plan.c $(pkg-config --cflags --libs jcas) -Wl,-rpath,"$libdir"
 *   ./a.out plan.json
 *
 * The argument is the file that the plan is written to, if there is one; then
 * `jcas simulate --policy plan:plan.json` flies it too.
 */
#include <jcas.h>
#include <stdio.h>
#include <stdlib.h>

#define N 10
#define MISSIONS 100

/* Hears of the progress, and could end the annealing by another value than 0. */
static int32_t tell(uint64_t iterations, double best_steps, void *context)
{
    uint64_t *told = context;
    if (iterations >= *told + 25000) {
        *told = iterations;
        fprintf(stderr, "%6llu moves: %.2f steps\n", (unsigned long long)iterations, best_steps);
    }
    return 0;
}

static int write_plan(const jcas_plan *plan, const char *path)
{
    size_t length = 0;
    if (jcas_plan_to_json(plan, NULL, 0, &length) != JCAS_OK)
        return 1;
    char *text = malloc(length + 1);
    FILE *file = fopen(path, "wb");
    int failed = text == NULL || file == NULL ||
                 jcas_plan_to_json(plan, text, length + 1, &length) != JCAS_OK ||
                 fwrite(text, 1, length, file) != length;
    if (file != NULL && fclose(file) != 0)
        failed = 1;
    free(text);
    return failed;
}

int main(int argc, char **argv)
{
    jcas_config config;
    jcas_model *model;
    jcas_sim *sim;
    jcas_plan *plan;
    jcas_policy *policy;
    char message[256] = "";
    uint64_t told = 0;

    if (jcas_config_preset("search", 6, &config, sizeof config, NULL, 0) != JCAS_OK)
        return 1;
    config.uav_count = N;
    if (jcas_model_new(&config, &model, message, sizeof message) || jcas_sim_new(model, &sim))
        return 1;

    jcas_plan_settings settings = {.struct_size = sizeof settings,
                                   .iterations = 100000,
                                   .seed = 1,
                                   .progress = tell,
                                   .progress_context = &told};
    int32_t status = jcas_plan_search(model, &settings, &plan, message, sizeof message);
    if (status != JCAS_OK) {
        fprintf(stderr, "%s (%s)\n", jcas_status_string(status), message);
        return 1;
    }
    jcas_plan_info info = {.struct_size = sizeof info};
    if (jcas_plan_get_info(plan, &info) || jcas_policy_follow(model, plan, &policy))
        return 1;
    if (argc > 1 && write_plan(plan, argv[1]))
        return 1;
    printf("%.2f steps expected, at least %.2f\n", info.expected_steps, info.bound_steps);

    float actions[2 * N];
    jcas_metrics metrics = {.struct_size = sizeof metrics};
    double steps = 0;
    for (uint64_t mission = 0; mission < MISSIONS; mission++) {
        jcas_outcome outcome = {.struct_size = sizeof outcome};
        if (jcas_sim_reset(sim, jcas_derive_seed(1, mission)) != JCAS_OK)
            return 1;
        while (!outcome.terminated && !outcome.truncated)
            if (jcas_policy_act(policy, sim, actions, 2 * N) ||
                jcas_sim_step(sim, actions, 2 * N, &outcome))
                return 1;
        if (jcas_sim_get_metrics(sim, &metrics) != JCAS_OK)
            return 1;
        steps += metrics.steps;
    }
    printf("%.2f steps flown in the mean of %d missions\n", steps / MISSIONS, MISSIONS);
    printf("the last one: %u of %u hotspots confirmed\n", metrics.confirmed, config.hotspot_count);
    return jcas_policy_free(policy) || jcas_plan_free(plan) || jcas_sim_free(sim) ||
           jcas_model_free(model);
}
