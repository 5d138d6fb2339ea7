/* One model with a simulation and a batch, and the pointers that every abuse test needs. */
#ifndef JCAS_TESTS_ABUSE_COMMON_H
#define JCAS_TESTS_ABUSE_COMMON_H

#include "check.h"

struct subject {
    jcas_config config;
    jcas_model *model, *other_model;
    jcas_model_info info;
    jcas_sim *sim, *other_sim;
    jcas_batch *batch;
};

enum { ENVIRONMENTS = 2 };

/* Memory that is no handle, but as large as one. */
extern uint64_t not_a_handle[4096];
#define FOREIGN(type) ((type *)(void *)not_a_handle)

/* The same address plus one byte. */
#define ASKEW(type, pointer) ((type *)(void *)((char *)(pointer) + 1))

void abuse_configurations(struct subject *subject);
void abuse_models(struct subject *subject);
void abuse_simulations(struct subject *subject);
void abuse_parts(struct subject *subject);
void abuse_reading(struct subject *subject);
void abuse_observation_fields(struct subject *subject);
void abuse_snapshots(struct subject *subject);
void abuse_batches(struct subject *subject);

#endif
