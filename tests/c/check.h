/* Helpers of the C tests: checks that report their line, and memory that shows any write. */
#ifndef JCAS_TESTS_CHECK_H
#define JCAS_TESTS_CHECK_H

#include <jcas.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define CHECK(condition)                                                                           \
    do {                                                                                           \
        if (!(condition)) {                                                                        \
            fprintf(stderr, "%s:%d: not so: %s\n", __FILE__, __LINE__, #condition);                \
            exit(1);                                                                               \
        }                                                                                          \
    } while (0)

#define EXPECT(wanted, call)                                                                       \
    do {                                                                                           \
        int32_t got_ = (call);                                                                     \
        if (got_ != (wanted)) {                                                                    \
            fprintf(stderr, "%s:%d: %s gave %d (%s), not %d\n", __FILE__, __LINE__, #call,         \
                    (int)got_, jcas_status_string(got_), (int)(wanted));                           \
            exit(1);                                                                               \
        }                                                                                          \
    } while (0)

#define OK(call) EXPECT(JCAS_OK, call)

/* FNV-1a, 64 bits, over the little-endian bytes of floats. */
static inline uint64_t hash_floats(const float *values, size_t count)
{
    uint64_t hash = UINT64_C(0xcbf29ce484222325);
    for (size_t i = 0; i < count; i++) {
        uint32_t bits;
        memcpy(&bits, &values[i], sizeof bits);
        for (int shift = 0; shift < 32; shift += 8)
            hash = (hash ^ ((bits >> shift) & 0xff)) * UINT64_C(0x100000001b3);
    }
    return hash;
}

static inline void *allocated(size_t size)
{
    void *memory = malloc(size > 0 ? size : 1);
    CHECK(memory != NULL);
    return memory;
}

#define ARRAY(type, count) ((type *)allocated(sizeof(type) * (count)))

/* A pattern that no output is likely to hold by chance. */
static inline void mark(void *memory, size_t size)
{
    memset(memory, 0xa5, size);
}

static inline int untouched(const void *memory, size_t size)
{
    const unsigned char *bytes = (const unsigned char *)memory;
    for (size_t i = 0; i < size; i++)
        if (bytes[i] != 0xa5)
            return 0;
    return 1;
}

#endif
