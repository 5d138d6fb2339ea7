/* Flies an episode with the library of an FMU and writes what it comes to.
 *
 *   fly_unit LIBRARY TOKEN SEED_REFERENCE POLICY_REFERENCE HASH_REFERENCE CONFIRMED_REFERENCE
 *
 * The token and the value references are those of modelDescription.xml. */
#include <inttypes.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#ifdef _WIN32
#include <windows.h>
#define OPEN(path) ((void *)LoadLibraryA(path))
#define FIND(library, name) ((void *)GetProcAddress((HMODULE)(library), name))
#else
#include <dlfcn.h>
#define OPEN(path) dlopen(path, RTLD_NOW)
#define FIND(library, name) dlsym(library, name)
#endif

#define STEPS 60
#define STEP_S 10.0

typedef void *instance;
typedef uint32_t reference;
typedef instance instantiate_fn(const char *, const char *, const char *, bool, bool, bool, bool,
                                const reference *, size_t, void *, void *, void *);
typedef int set_u64_fn(instance, const reference *, size_t, const uint64_t *, size_t);
typedef int get_u64_fn(instance, const reference *, size_t, uint64_t *, size_t);
typedef int get_u32_fn(instance, const reference *, size_t, uint32_t *, size_t);
typedef int set_string_fn(instance, const reference *, size_t, const char *const *, size_t);
typedef int enter_fn(instance, bool, double, double, bool, double);
typedef int exit_fn(instance);
typedef int step_fn(instance, double, double, bool, bool *, bool *, bool *, double *);
typedef void free_fn(instance);

static void *library;

static void *find(const char *name)
{
    void *found = FIND(library, name);
    if (found == NULL) {
        fprintf(stderr, "the library has no %s\n", name);
        exit(1);
    }
    return found;
}

static void check(int status, const char *call)
{
    if (status != 0) {
        fprintf(stderr, "%s: status %d\n", call, status);
        exit(1);
    }
}

static reference number(const char *text)
{
    return (reference)strtoul(text, NULL, 10);
}

int main(int argc, char **argv)
{
    const uint64_t seed_value = 7;
    const char *policy_value = "teams";
    uint64_t hash_value;
    uint32_t confirmed_value;
    if (argc != 7 || (library = OPEN(argv[1])) == NULL) {
        fprintf(stderr, "fly_unit LIBRARY TOKEN SEED POLICY HASH CONFIRMED\n");
        return 2;
    }
    const reference seed = number(argv[3]), policy = number(argv[4]);
    const reference hash = number(argv[5]), confirmed = number(argv[6]);
    instance unit = ((instantiate_fn *)find("fmi3InstantiateCoSimulation"))(
        "fleet", argv[2], NULL, false, false, false, false, NULL, 0, NULL, NULL, NULL);
    if (unit == NULL) {
        fprintf(stderr, "the unit refuses the token %s\n", argv[2]);
        return 1;
    }
    check(((set_u64_fn *)find("fmi3SetUInt64"))(unit, &seed, 1, &seed_value, 1), "seed");
    check(((set_string_fn *)find("fmi3SetString"))(unit, &policy, 1, &policy_value, 1), "policy");
    check(((enter_fn *)find("fmi3EnterInitializationMode"))(unit, false, 0, 0, false, 0), "enter");
    check(((exit_fn *)find("fmi3ExitInitializationMode"))(unit), "exit");
    for (int step = 0; step < STEPS; step++) {
        bool event, terminate, early;
        double last;
        check(((step_fn *)find("fmi3DoStep"))(unit, STEP_S * step, STEP_S, true, &event, &terminate,
                                              &early, &last),
              "step");
    }
    check(((get_u64_fn *)find("fmi3GetUInt64"))(unit, &hash, 1, &hash_value, 1), "hash");
    check(((get_u32_fn *)find("fmi3GetUInt32"))(unit, &confirmed, 1, &confirmed_value, 1),
          "confirmed");
    printf("%" PRIu32 " hotspots confirmed, state hash %016" PRIx64 "\n", confirmed_value,
           hash_value);
    ((free_fn *)find("fmi3FreeInstance"))(unit);
    return 0;
}
