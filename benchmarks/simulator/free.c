/* The step of a body that drives in C, on the very arrays of a world: the bound for its kernel, not a part of it.

   The same algorithm and the same results: free backend, default configuration, autoreset by the next step. See
   sim/backends/free/; names are its. One thread. */
#define DRIVES
#include "common.h"

enum { SECTORS = 8, HEADER = 9, LISTS = 1 + 3 * SECTORS, ENDS = LISTS / 2 + 1, ROW = 6, CONTACTS = 4 };
enum { FIRST_SOLID, SOLIDS, FIRST_LINE, LINES, ACROSS_X, FIRST_CELL, COLUMNS, ROWS, ACROSS };

typedef struct { float step, changes[2], low[2], high[2], corner, never; } Drive;

static const float TURN = 6.283185307179586f;

static inline float least(float a, float b) { return a < b ? a : b; }
static inline float between(float low, float high, float x) { return larger(low, least(high, x)); }

static inline void cosine_sine(float angle, float *cosine, float *sine) {
    float quarter = floorf(angle * 0.6366197723675814f + 0.5f);
    float r = ((angle - quarter * 1.5703125f) - quarter * 4.837512969970703125e-4f) - quarter * 7.549789948768648e-8f;
    float z = r * r;
    float s = ((-1.9515295891e-4f * z + 8.3321608736e-3f) * z - 1.6666654611e-1f) * z * r + r;
    float c = ((2.443315711809948e-5f * z - 1.388731625493765e-3f) * z + 4.166664568298827e-2f) * z * z;
    c += 1.0f - 0.5f * z;
    int turned = (int)quarter;
    float first = turned & 1 ? s : c, second = turned & 1 ? c : s;
    *cosine = (turned + 1) & 2 ? -first : first;
    *sine = turned & 2 ? -second : second;
}

static inline float wrapped(float angle) {
    float around = angle - TURN * floorf(angle * 0.15915494309189535f);
    return around >= 0.0f && around < TURN ? around : 0.0f;
}

static const int *block_of(const Config *c, const float *numbers, const int *indices, int house, const float place[2]) {
    const int *header = indices + house * HEADER;
    float per = 1 / c->cell;
    int x = (int)((place[0] - numbers[2 * house]) * per), y = (int)((place[1] - numbers[2 * house + 1]) * per);
    x = x < header[COLUMNS] - 1 ? x : header[COLUMNS] - 1; x = x > 0 ? x : 0;
    y = y < header[ROWS] - 1 ? y : header[ROWS] - 1; y = y > 0 ? y : 0;
    return indices + indices[header[FIRST_CELL] + y * header[COLUMNS] + x];
}

static int overlaps(const Config *c, const float origin[2], const float target[2]) {
    float half = c->target / 2, reach = c->body / 2 - c->skin;
    float x = larger(fabsf(origin[0] - target[0]) - half, 0.0f), y = larger(fabsf(origin[1] - target[1]) - half, 0.0f);
    return x * x + y * y < reach * reach;
}

static void begin(const Config *c, const int *places, Whole *w, Real *r, float *s) {
    uint32_t words[4];
    w->episode++;
    philox(w->seed, w->episode, 0, 0, words);
    w->house = below(words[0], places[0]);
    int at = 1 + PLACE * w->house;
    w->time = w->found = w->over = 0;
    draw_target(c, places, w, r, -1.0f);
    for (int turn = 1; turn <= TRIES; turn++) {
        philox(w->seed, w->episode, 0, turn, words);
        int place = places[places[at + 2] + below(words[0], places[at + 3])];
        r->origin[0] = real_of(places, at) + (place & 0xFFFF) * c->step;
        r->origin[1] = real_of(places, at + 1) + (place >> 16) * c->step;
        s[0] = s[1] = 0.0f;
        r->angle = (float)(words[1] >> 8) * (float)(6.283185307179586 / 16777216.0);
        if (!overlaps(c, r->origin, r->target)) break;
    }
}

/* The share of a way after which a disc touches a solid, how it leans, and how deep it is in. */
static float touches(const Config *c, const Drive *d, const float *solid, const float place[2], const float way[2],
                     float normal[2], float *depth) {
    float radius = c->body / 2, u = solid[2], v = solid[3];
    float half[2] = {solid[4], solid[5]}, x = place[0] - solid[0], y = place[1] - solid[1];
    float own[2] = {x * u + y * v, y * u - x * v}, away[2];
    for (int k = 0; k < 2; k++) away[k] = own[k] - between(-half[k], half[k], own[k]);
    float near = away[0] * away[0] + away[1] * away[1], length = way[0] * way[0] + way[1] * way[1];
    float reach = radius + sqrtf(length), share = d->never, lean[2] = {0, 0};
    *depth = 0.0f;
    if (near < reach * reach) {
        float inner = radius - c->skin, outer = radius - c->skin / 2;
        float along[2] = {way[0] * u + way[1] * v, way[1] * u - way[0] * v};
        if (near < outer * outer) {
            float distance = sqrtf(near);
            if (distance > 0.0f) {
                lean[0] = away[0] / distance, lean[1] = away[1] / distance;
            } else {
                float inward[2] = {half[0] - fabsf(own[0]), half[1] - fabsf(own[1])};
                int k = inward[0] < inward[1] ? 0 : 1;
                lean[k] = own[k] >= 0.0f ? 1.0f : -1.0f, distance = -inward[k];
            }
            *depth = outer - distance;
            float further = along[0] * lean[0] + along[1] * lean[1];
            if (further < 0.0f && distance + further < inner) share = 0.0f;
        } else {
            for (int k = 0; k < 2; k++) {
                if (along[k] == 0.0f) continue;
                float sign = along[k] < 0.0f ? 1.0f : -1.0f;
                float at = (sign * (half[k] + outer) - own[k]) / along[k], in = (sign * (half[k] + inner) - own[k]) / along[k];
                float across = own[1 - k] + in * along[1 - k];
                if (at >= 0.0f && at < share && in <= 1.0f && fabsf(across) <= half[1 - k]) share = at;
            }
            for (int k = 0; k < 4; k++) {
                float start[2] = {own[0] - half[0] * (k & 1 ? 1.0f : -1.0f), own[1] - half[1] * (k & 2 ? 1.0f : -1.0f)};
                float ahead = start[0] * along[0] + start[1] * along[1], square = start[0] * start[0] + start[1] * start[1];
                float beyond = square - outer * outer, within = square - inner * inner;
                float under = ahead * ahead - length * within;
                if (ahead < 0.0f && under >= 0.0f) {
                    float at = beyond / (sqrtf(ahead * ahead - length * beyond) - ahead);
                    if (at >= 0.0f && at < share && within <= sqrtf(under) - ahead) share = at;
                }
            }
            if (share <= 1.0f) {
                float leaned[2];
                for (int k = 0; k < 2; k++) {
                    float there = own[k] + share * along[k];
                    leaned[k] = there - between(-half[k], half[k], there);
                }
                float size = larger(1e-12f, sqrtf(leaned[0] * leaned[0] + leaned[1] * leaned[1]));
                lean[0] = leaned[0] / size, lean[1] = leaned[1] / size;
            }
        }
    }
    normal[0] = lean[0] * u - lean[1] * v, normal[1] = lean[0] * v + lean[1] * u;
    return share;
}

static void slide(const Config *c, const Drive *d, const float *numbers, const int *indices, int house,
                  const float origin[2], const float way[2], float moved[2]) {
    const uint16_t *ends = (const uint16_t *)block_of(c, numbers, indices, house, origin), *list = ends + 2 * ENDS;
    const float *solids = numbers + indices[house * HEADER + FIRST_SOLID];
    float left[2] = {way[0], way[1]}, last[2] = {0, 0};
    moved[0] = moved[1] = 0.0f;
    for (int turn = 0; turn < CONTACTS; turn++) {
        float share = d->never, normal[2] = {0, 0}, depth = 0.0f;
        float place[2] = {origin[0] + moved[0], origin[1] + moved[1]};
        for (int k = 0; k < ends[1]; k++) {
            float leaned[2], inside;
            float at = touches(c, d, solids + ROW * list[k], place, left, leaned, &inside);
            if (at < share || (at == share && at < d->never && inside > depth))
                share = at, normal[0] = leaned[0], normal[1] = leaned[1], depth = inside;
        }
        if (share > 1.0f) {
            moved[0] += left[0], moved[1] += left[1];
            return;
        }
        float out = least(depth, c->skin);
        for (int k = 0; k < 2; k++) {
            moved[k] += share * left[k] + out * normal[k];
            left[k] = (1.0f - share) * left[k];
        }
        float inward = least(0.0f, left[0] * normal[0] + left[1] * normal[1]);
        for (int k = 0; k < 2; k++) left[k] -= inward * normal[k];
        if (left[0] * last[0] + left[1] * last[1] < -d->corner * sqrtf(left[0] * left[0] + left[1] * left[1])) return;
        last[0] = normal[0], last[1] = normal[1];
    }
}

static int drive(const Config *c, const Drive *d, const float *numbers, const int *indices, Whole *w, Real *r,
                 float *s, const float action[2]) {
    float speeds[2] = {s[0], s[1]}, cosine, sine, unused, bent, moved[2];
    for (int k = 0; k < 2; k++)
        speeds[k] += between(-d->changes[k], d->changes[k], between(d->low[k], d->high[k], action[k]) - speeds[k]);
    float half = (float)(0.5 * (double)0.1) * speeds[1];
    cosine_sine(r->angle + half, &cosine, &sine);
    cosine_sine(half, &unused, &bent);
    float chord = fabsf(half) < 1e-2f ? 1.0f - half * half / 6.0f : bent / half;
    float length = d->step * speeds[0] * chord, way[2] = {length * cosine, length * -sine};
    slide(c, d, numbers, indices, w->house, r->origin, way, moved);
    float off[2] = {moved[0] - way[0], moved[1] - way[1]};
    int blocked = off[0] * off[0] + off[1] * off[1] > (float)((double)1e-5 * 1e-5);
    if (blocked) speeds[0] *= between(0.0f, 1.0f, (moved[0] * cosine + moved[1] * -sine) / length);
    r->origin[0] += moved[0], r->origin[1] += moved[1];
    s[0] = speeds[0], s[1] = speeds[1];
    r->angle = wrapped(r->angle + 2.0f * half);
    return blocked;
}

static inline void cross(const float *restrict along, const float *restrict aside, float *restrict over,
                         float *restrict slope) {
    for (int k = 0; k < RAYS; k++) {
        over[k] = 1.0f / (fabsf(along[k]) < 1e-30f ? 1e-30f : along[k]);
        slope[k] = aside[k] * over[k];
    }
}

static void look(const Config *c, const float *table, const float *numbers, const int *indices, const Whole *w,
                 const Real *r, float *restrict observation) {
    float ex = r->origin[0], ey = r->origin[1], cosine, sine;
    float east[RAYS], south[RAYS], over_x[RAYS], slope_x[RAYS], over_y[RAYS], slope_y[RAYS];
    uint32_t nearest[RAYS];
    cosine_sine(r->angle, &cosine, &sine);
    for (int k = 0; k < RAYS; k++) {
        east[k] = cosine * table[k] - sine * table[RAYS + k];
        south[k] = -(sine * table[k] + cosine * table[RAYS + k]);
        nearest[k] = bits(c->range);
    }
    cross(east, south, over_x, slope_x);
    cross(south, east, over_y, slope_y);
    const uint16_t *ends = (const uint16_t *)block_of(c, numbers, indices, w->house, r->origin), *list = ends + 2 * ENDS;
    const uint16_t *row = ends + 1 + 3 * ((int)floorf(r->angle * 1.2732395447351628f + 0.5f) % SECTORS);
    const float *lines = numbers + indices[w->house * HEADER + FIRST_LINE];
    for (int k = row[0]; k < row[1]; k++) {
        const float *l = lines + ROW * list[k];
        meet(nearest, over_x, slope_x, l[0] - ex, l[1] - ey, l[4]);
    }
    for (int k = row[1]; k < row[2]; k++) {
        const float *l = lines + ROW * list[k];
        meet(nearest, over_y, slope_y, l[1] - ey, l[0] - ex, l[4]);
    }
    for (int k = row[2]; k < row[3]; k++) {
        const float *l = lines + ROW * list[k];
        float u = l[2], v = l[3], over[RAYS], slope[RAYS];
        for (int j = 0; j < RAYS; j++) {
            float part = south[j] * u - east[j] * v;
            over[j] = 1.0f / (fabsf(part) < 1e-30f ? 1e-30f : part);
            slope[j] = (east[j] * u + south[j] * v) * over[j];
        }
        meet(nearest, over, slope, (l[1] - ey) * u - (l[0] - ex) * v, (l[0] - ex) * u + (l[1] - ey) * v, l[4]);
    }
    float ahead = (r->target[0] - ex) * cosine - (r->target[1] - ey) * sine;
    write_look(c, nearest, over_x, slope_x, over_y, slope_y, ex, ey, r->target, ahead, observation);
}

void step(const Config *c, const Drive *d, const float *table, const float *numbers, const int *indices, const int *places,
          Real *reals, Whole *wholes, float *speeds, const float *action, float *observation, float *reward, uint8_t *flags, int count) {
    for (int e = 0; e < count; e++) {
        Whole *w = wholes + e;
        Real *r = reals + e;
        float *s = speeds + 2 * e;
        int picked = 0, truncated = 0, hit = 0;
        if (w->over) {
            begin(c, places, w, r, s);
        } else {
            hit = drive(c, d, numbers, indices, w, r, s, action + 2 * e);
            picked = overlaps(c, r->origin, r->target);
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
