/* The simulator's step in C, on the very arrays of a world: the bound for its kernel, not a part of it.

   The same algorithm and the same results: continuous backend, default configuration, autoreset by the next
   step. See sim/world/episodes.py, sim/backends/continuous/ and sim/backends/rays.py; names are theirs. One thread. */
#include <math.h>
#include <stdint.h>
#include <string.h>

enum { RAYS = 40, TURN = 15, COUNT = 7 * TURN + RAYS, HEADER = 9, ENDS = 9, PLACE = 7, TRIES = 32 };
enum { FIRST_BOX, BOXES, FIRST_PIECE, FLOOR, ROOMS, FIRST_CELL, COLUMNS, ROWS, FIRST_LINE };

static const int WAY[8][2] = {{1, 0}, {1, -1}, {0, -1}, {-1, -1}, {-1, 0}, {-1, 1}, {0, 1}, {1, 1}};

typedef struct { float body, step, eye, range, target, cell, skin, overlap, margin, widest; int steps; } Config;
typedef struct { int i, j, heading, house, time, found, over, episode; uint32_t seed[2]; } Whole;
typedef struct { float origin[2], target[2]; } Real;

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

static int overlaps(const Config *c, const float origin[2], int i, int j, const float target[2]) {
    float half = 0.5f * c->body, reach = half + (c->target / 2 - c->skin);
    float x = (origin[0] + i * c->step) + (half - c->eye) - target[0];
    float y = (origin[1] + j * c->step) + (half - c->eye) - target[1];
    return larger(fabsf(x), fabsf(y)) < reach;
}

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

static void begin(const Config *c, const int *places, Whole *w, Real *r) {
    uint32_t words[4];
    w->episode++;
    philox(w->seed, w->episode, 0, 0, words);
    w->house = below(words[0], places[0]);
    int at = 1 + PLACE * w->house;
    r->origin[0] = real_of(places, at);
    r->origin[1] = real_of(places, at + 1);
    w->time = w->found = w->over = 0;
    draw_target(c, places, w, r, -1.0f);
    for (int turn = 1; turn <= TRIES; turn++) {
        philox(w->seed, w->episode, 0, turn, words);
        int place = places[places[at + 2] + below(words[0], places[at + 3])];
        w->i = place & 0xFFFF; w->j = place >> 16; w->heading = below(words[1], 8);
        if (!overlaps(c, r->origin, w->i, w->j, r->target)) break;
    }
}

static int cell_of(const float *numbers, const int *indices, int house, float px, float py, float per) {
    const int *header = indices + house * HEADER;
    int x = (int)((px - numbers[2 * house]) * per), y = (int)((py - numbers[2 * house + 1]) * per);
    x = x < header[COLUMNS] - 1 ? x : header[COLUMNS] - 1; x = x > 0 ? x : 0;
    y = y < header[ROWS] - 1 ? y : header[ROWS] - 1; y = y > 0 ? y : 0;
    return indices[header[FIRST_CELL] + y * header[COLUMNS] + x];
}

static int blocked(const Config *c, const float *numbers, const int *indices, const Whole *w, const Real *r, int i, int j) {
    float half = 0.5f * c->body, shift = half - c->eye;
    float px = (r->origin[0] + w->i * c->step) + shift, py = (r->origin[1] + w->j * c->step) + shift;
    float qx = (r->origin[0] + i * c->step) + shift, qy = (r->origin[1] + j * c->step) + shift;
    float dx = fabsf(qx - px), dy = fabsf(qy - py);
    const uint16_t *ends = (const uint16_t *)(indices + cell_of(numbers, indices, w->house, px, py, 1 / c->cell));
    const uint16_t *lists = ends + 2 * ENDS;
    const float *boxes = numbers + indices[w->house * HEADER + FIRST_BOX];
    int result = 0;
    for (int k = 0; k < ends[1]; k++) {
        const float *b = boxes + 4 * lists[k];
        float x = 0.5f * (px + qx - b[0] - b[2]), y = 0.5f * (py + qy - b[1] - b[3]);
        float width = 0.5f * (b[2] - b[0]) + half - c->skin, height = 0.5f * (b[3] - b[1]) + half - c->skin;
        int near = (fabsf(x) < width + 0.5f * dx) & (fabsf(y) < height + 0.5f * dy);
        result |= near & (fabsf((qx - px) * y - (qy - py) * x) <= dx * height + dy * width);
    }
    return result;
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

static void look(const Config *c, const float *table, const float *numbers, const int *indices, const Whole *w,
                 const Real *r, float *restrict observation) {
    float ex = (r->origin[0] + w->i * c->step), ey = (r->origin[1] + w->j * c->step);
    int first = ((8 - w->heading) & 7) * TURN;
    const float *over_x = table + first, *slope_x = over_x + COUNT, *over_y = slope_x + COUNT, *slope_y = over_y + COUNT;
    uint32_t nearest[RAYS], seen[RAYS];
    for (int k = 0; k < RAYS; k++) nearest[k] = bits(c->range), seen[k] = 0;
    const uint16_t *ends = (const uint16_t *)(indices + cell_of(numbers, indices, w->house, ex, ey, 1 / c->cell));
    const uint16_t *lists = ends + 2 * ENDS, *row = ends + 1 + 2 * w->heading;
    const float *lines = numbers + indices[w->house * HEADER + FIRST_LINE];
    for (int k = row[0]; k < row[1]; k++) {
        const float *l = lines + 4 * lists[k];
        meet(nearest, over_x, slope_x, l[0] - ex, l[1] - ey, l[2]);
    }
    for (int k = row[1]; k < row[2]; k++) {
        const float *l = lines + 4 * lists[k];
        meet(nearest, over_y, slope_y, l[0] - ey, l[1] - ex, l[2]);
    }
    float half = c->target / 2, ox = r->target[0] - ex, oy = r->target[1] - ey;
    float radius = half * 1.41421356f, away = sqrtf(ox * ox + oy * oy);
    float length = w->heading & 1 ? 1.41421356f : 1.0f;
    float ahead = (ox * WAY[w->heading][0] + oy * WAY[w->heading][1]) / length;
    if (ahead > c->widest * away - ((1 + fabsf(c->widest)) * radius + c->margin) && away < c->range + c->margin + radius) {
        float lx = r->target[0] - half, ly = r->target[1] - half, hx = r->target[0] + half, hy = r->target[1] + half;
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

void step(const Config *c, const float *table, const float *numbers, const int *indices, const int *places, Real *reals,
          Whole *wholes, const int64_t *action, float *observation, float *reward, uint8_t *flags, int count) {
    for (int e = 0; e < count; e++) {
        Whole *w = wholes + e;
        Real *r = reals + e;
        int picked = 0, truncated = 0, hit = 0;
        if (w->over) {
            begin(c, places, w, r);
        } else {
            if (action[e] == 2) {
                int i = w->i + WAY[w->heading][0], j = w->j + WAY[w->heading][1];
                hit = blocked(c, numbers, indices, w, r, i, j);
                if (!hit) w->i = i, w->j = j;
            } else {
                w->heading = (w->heading + (action[e] == 0 ? 1 : 7)) & 7;
            }
            picked = overlaps(c, r->origin, w->i, w->j, r->target);
            w->time++;
            w->over = truncated = w->time >= c->steps;
            if (picked) draw_target(c, places, w, r, c->target + c->body);
        }
        reward[e] = picked;
        flags[e] = 0;
        flags[count + e] = truncated;
        flags[2 * count + e] = hit;
        look(c, table, numbers, indices, w, r, observation + 2 * RAYS * e);
    }
}
