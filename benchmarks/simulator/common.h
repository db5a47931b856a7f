/* What both loops in C have in common: random numbers, targets, rays that meet lines. Names are those of the simulator:
   sim/world/episodes.py and sim/backends/rays.py. */
#include <math.h>
#include <stdint.h>
#include <string.h>

enum { RAYS = 40, PLACE = 7, TRIES = 32 };

typedef struct { float body, step, eye, range, target, cell, skin, overlap, margin, widest; int steps; } Config;
typedef struct {
    int house, time, found, over, episode;
    uint32_t seed[2];
#ifndef DRIVES
    int i, j, heading;
#endif
} Whole;
typedef struct {
    float origin[2], target[2];
#ifdef DRIVES
    float angle;
#endif
} Real;

static inline uint32_t bits(float x) { uint32_t b; memcpy(&b, &x, 4); return b; }

static void philox(const uint32_t seed[2], uint32_t episode, uint32_t counter, uint32_t turn, uint32_t out[4]) {
    uint32_t k0 = seed[0], k1 = seed[1], c0 = episode, c1 = counter, c2 = turn, c3 = 0;
    for (int k = 0; k < 10; k++) {
        uint64_t p0 = 0xD2511F53ull * c0, p1 = 0xCD9E8D57ull * c2;
        uint32_t n0 = (uint32_t)(p1 >> 32) ^ c1 ^ k0, n2 = (uint32_t)(p0 >> 32) ^ c3 ^ k1;
        c0 = n0; c1 = (uint32_t)p1; c2 = n2; c3 = (uint32_t)p0;
        k0 += 0x9E3779B9u; k1 += 0xBB67AE85u;
    }
    out[0] = c0; out[1] = c1; out[2] = c2; out[3] = c3;
}

static inline int below(uint32_t word, int bound) { return (int)(((uint64_t)word * (uint64_t)bound) >> 32); }
static inline float real_of(const int *places, int at) { float x; memcpy(&x, places + at, 4); return x; }
static inline float larger(float a, float b) { return a > b ? a : b; }

static void draw_target(const Config *c, const int *places, Whole *w, Real *r, float apart) {
    int at = 1 + PLACE * w->house, first = places[at + 4], count = places[at + 5];
    float last[2] = {r->target[0], r->target[1]};
    w->found++;
    for (int turn = 1; turn <= TRIES; turn++) {
        uint32_t words[4];
        philox(w->seed, w->episode, w->found, turn, words);
        int place = first + 2 * below(words[0], count);
        for (int k = 0; k < 2; k++) r->target[k] = real_of(places, at + k) + real_of(places, place + k) * c->step;
        if (!(larger(fabsf(r->target[0] - last[0]), fabsf(r->target[1] - last[1])) < apart)) break;
    }
}

static inline void meet(uint32_t *restrict nearest, const float *restrict over, const float *restrict slope,
                        float ahead, float aside, float reach) {
    for (int r = 0; r < RAYS; r++) {
        uint32_t distance = bits(ahead * over[r]);
        uint32_t nearer = distance < nearest[r] ? distance : nearest[r];
        nearest[r] = fabsf(ahead * slope[r] - aside) <= reach ? nearer : nearest[r];
    }
}

static inline void meet_target(uint32_t *restrict nearest, uint32_t *restrict seen, const float *restrict over,
                               const float *restrict slope, float ahead, float aside, float reach) {
    for (int r = 0; r < RAYS; r++) {
        uint32_t distance = bits(ahead * over[r]);
        int hit = (fabsf(ahead * slope[r] - aside) <= reach) & (distance < nearest[r]);
        nearest[r] = hit ? distance : nearest[r];
        seen[r] = hit ? 0x3F800000u : seen[r];
    }
}

/* The target before what rays have met, if it may be seen so far ahead; then all as an observation. */
static inline void write_look(const Config *c, uint32_t *restrict nearest, const float *over_x, const float *slope_x,
                              const float *over_y, const float *slope_y, float ex, float ey, const float target[2],
                              float ahead, float *restrict observation) {
    uint32_t seen[RAYS] = {0};
    float half = c->target / 2, ox = target[0] - ex, oy = target[1] - ey;
    float radius = half * 1.41421356f, away = sqrtf(ox * ox + oy * oy);
    if (ahead > c->widest * away - ((1 + fabsf(c->widest)) * radius + c->margin) && away < c->range + c->margin + radius) {
        float lx = target[0] - half, ly = target[1] - half, hx = target[0] + half, hy = target[1] + half;
        int outside = (lx > ex) | (ly > ey) | (hx < ex) | (hy < ey);
        float rx = outside ? 0.5f * (hx - lx) + c->overlap : -1.0f, ry = outside ? 0.5f * (hy - ly) + c->overlap : -1.0f;
        meet_target(nearest, seen, over_x, slope_x, (lx > ex ? lx : hx) - ex, 0.5f * (ly + hy) - ey, ry);
        meet_target(nearest, seen, over_y, slope_y, (ly > ey ? ly : hy) - ey, 0.5f * (lx + hx) - ex, rx);
    }
    float per = 1 / c->range;
    for (int k = 0; k < RAYS; k++) {
        float distance, is_target;
        memcpy(&distance, &nearest[k], 4);
        memcpy(&is_target, &seen[k], 4);
        observation[2 * k] = distance * per;
        observation[2 * k + 1] = is_target;
    }
}
