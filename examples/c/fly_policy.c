/* Flies a mission with a trained policy, for which its file of weights is enough.
 *
 * With jcas installed and PKG_CONFIG_PATH set, as docs/c.md says:
 *
 *   libdir=$(pkg-config --variable=libdir jcas)
 *   cc fly_policy.c $(pkg-config --cflags --libs jcas) -Wl,-rpath,"$libdir"
 *   ./a.out policies/mission/policy.safetensors
 *
 * The argument may also name a baseline: random, untrained, greedy, teams, squads, line or answer.
 *
 * The mission is the first of `jcas simulate --seed 1 --uavs 15 --hotspots 7 --policy POLICY`, bit
 * for bit.
 */
#include <jcas.h>
#include <inttypes.h>
#include <stdio.h>

#define N 15
#define HOTSPOTS 7
#define FILE_MAX (1 << 20)

static unsigned char bytes[FILE_MAX];

int main(int argc, char **argv)
{
    jcas_config config;
    jcas_model *model;
    jcas_sim *sim;
    jcas_policy *policy;
    char message[256] = "";
    const char *name = argc > 1 ? argv[1] : "teams";

    jcas_config_default(&config, sizeof config);
    config.uav_count = N;
    config.hotspot_count = HOTSPOTS;
    if (jcas_model_new(&config, &model, message, sizeof message) || jcas_sim_new(model, &sim))
        return 1;

    FILE *file = fopen(name, "rb");
    size_t length = file ? fread(bytes, 1, sizeof bytes, file) : 0;
    int32_t status =
        file ? jcas_policy_load(model, bytes, length, &policy, message, sizeof message)
             : jcas_policy_baseline(model, name, NULL, &policy, message, sizeof message);
    if (file)
        fclose(file);
    if (status != JCAS_OK) {
        fprintf(stderr, "%s: %s (%s)\n", name, jcas_status_string(status), message);
        return 1;
    }

    float actions[2 * N];
    jcas_outcome outcome = {.struct_size = sizeof outcome};
    if (jcas_sim_reset(sim, jcas_derive_seed(1, 0)) != JCAS_OK)
        return 1;
    while (!outcome.terminated && !outcome.truncated)
        if (jcas_policy_act(policy, sim, actions, 2 * N) ||
            jcas_sim_step(sim, actions, 2 * N, &outcome))
            return 1;

    jcas_metrics metrics = {.struct_size = sizeof metrics};
    uint64_t hash;
    if (jcas_sim_get_metrics(sim, &metrics) || jcas_sim_hash(sim, &hash))
        return 1;
    printf("%u of %d hotspots known to all after %u steps, state 0x%016" PRIx64 "\n",
           metrics.informed, HOTSPOTS, metrics.steps, hash);
    return jcas_policy_free(policy) || jcas_sim_free(sim) || jcas_model_free(model);
}
