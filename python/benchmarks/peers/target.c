/* A fleet that steers to goals, written anew from the rules of PufferLib's Ocean environment
 * `target`. 15 agents turn and change their speed in a plane. 7 goals move elsewhere when they are
 * reached. Every agent observes 48 reals: the offset of each goal and each agent, its heading, its
 * last reward and its position. The program computes kinematics and distances only, so it shows the
 * cost of a step without a model. It holds none of PufferLib's source.
 *
 *   cc -O2 target.c -lm && ./a.out SECONDS ENVIRONMENTS
 *
 * prints agent-steps per second of processor time.
 */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { AGENTS = 15, GOALS = 7, OBSERVED = 2 * GOALS + 2 * AGENTS + 4, ACTION_SETS = 8 };

static const float WIDTH = 1080, HEIGHT = 720, REACH = 32, FASTEST = 20, TURN = 0.0833f,
                   QUICKEN = 1;

typedef struct {
    float x, y, heading, speed, reward;
} agent;

typedef struct {
    float x, y;
} goal;

typedef struct {
    agent agents[AGENTS];
    goal goals[GOALS];
    uint32_t random;
} world;

static float uniform(uint32_t *state)
{
    *state ^= *state << 13;
    *state ^= *state >> 17;
    *state ^= *state << 5;
    return (float)(*state >> 8) / 16777216.0f;
}

static float within(float value, float low, float high)
{
    return value < low ? low : value > high ? high : value;
}

static void place(world *w, goal *g)
{
    g->x = uniform(&w->random) * WIDTH;
    g->y = uniform(&w->random) * HEIGHT;
}

static void begin(world *w, uint32_t seed)
{
    w->random = seed;
    for (int j = 0; j < GOALS; j++)
        place(w, &w->goals[j]);
    for (int i = 0; i < AGENTS; i++) {
        agent *a = &w->agents[i];
        *a = (agent){uniform(&w->random) * WIDTH, uniform(&w->random) * HEIGHT, 0, 0, 0};
        a->heading = uniform(&w->random) * 6.2831853f;
    }
}

/* An action is one of nine turns and one of five changes of speed. The middle ones change
 * nothing. */
static void step(world *w, const uint8_t *actions, float *observations, float *rewards)
{
    for (int i = 0; i < AGENTS; i++) {
        agent *a = &w->agents[i];
        a->heading = fmodf(a->heading + (float)(actions[2 * i] - 4) * TURN, 6.2831853f);
        a->speed = within(a->speed + (float)(actions[2 * i + 1] - 2) * QUICKEN, -FASTEST, FASTEST);
        a->x = within(a->x + a->speed * cosf(a->heading), 0, WIDTH);
        a->y = within(a->y + a->speed * sinf(a->heading), 0, HEIGHT);
        a->reward = 0;
        for (int j = 0; j < GOALS; j++) {
            goal *g = &w->goals[j];
            float dx = g->x - a->x, dy = g->y - a->y;
            if (dx * dx + dy * dy < REACH * REACH) {
                a->reward = 1;
                place(w, g);
            }
        }
        rewards[i] = a->reward;
    }
    for (int i = 0; i < AGENTS; i++) {
        const agent *a = &w->agents[i];
        float *seen = observations + i * OBSERVED;
        for (int j = 0; j < GOALS; j++) {
            *seen++ = (w->goals[j].x - a->x) / WIDTH;
            *seen++ = (w->goals[j].y - a->y) / HEIGHT;
        }
        for (int k = 0; k < AGENTS; k++) {
            *seen++ = (w->agents[k].x - a->x) / WIDTH;
            *seen++ = (w->agents[k].y - a->y) / HEIGHT;
        }
        *seen++ = a->heading / 6.2831853f;
        *seen++ = a->reward;
        *seen++ = a->x / WIDTH;
        *seen++ = a->y / HEIGHT;
    }
}

int main(int argc, char **argv)
{
    double seconds = argc > 1 ? strtod(argv[1], NULL) : 1;
    size_t count = argc > 2 ? strtoul(argv[2], NULL, 10) : 256;
    size_t acting = count * 2 * AGENTS;
    world *worlds = calloc(count, sizeof *worlds);
    uint8_t *actions = malloc(ACTION_SETS * acting);
    float *observations = calloc(count * AGENTS * OBSERVED, sizeof *observations);
    float *rewards = calloc(count * AGENTS, sizeof *rewards);
    if (!worlds || !actions || !observations || !rewards)
        return 1;
    uint32_t random = 1;
    for (size_t i = 0; i < ACTION_SETS * acting; i++)
        actions[i] = (uint8_t)(uniform(&random) * (i % 2 ? 5 : 9));
    for (size_t m = 0; m < count; m++)
        begin(&worlds[m], (uint32_t)m + 1);

    clock_t begun = clock(), now = begun;
    size_t steps = 0;
    while ((double)(now - begun) < seconds * CLOCKS_PER_SEC) {
        const uint8_t *chosen = actions + steps % ACTION_SETS * acting;
        for (size_t m = 0; m < count; m++)
            step(&worlds[m], chosen + m * 2 * AGENTS, observations + m * AGENTS * OBSERVED,
                 rewards + m * AGENTS);
        steps++;
        now = clock();
    }
    printf("%.0f\n", (double)(steps * count * AGENTS) / ((double)(now - begun) / CLOCKS_PER_SEC));
    return 0;
}
