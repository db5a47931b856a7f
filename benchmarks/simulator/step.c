/* The simulator's step in C, on the very arrays of a world: the bound for its kernel, not a part of it.

   The same algorithm and the same results: continuous backend, default configuration, autoreset by the next
   step. See sim/world/episodes.py, sim/backends/continuous/ and sim/backends/rays.py; names are theirs. One thread. */
#include "common.h"

enum { TURN = 15, COUNT = 7 * TURN + RAYS, HEADER = 9, ENDS = 9 };
enum { FIRST_BOX, BOXES, FIRST_PIECE, FLOOR, ROOMS, FIRST_CELL, COLUMNS, ROWS, FIRST_LINE };

static const int WAY[8][2] = {{1, 0}, {1, -1}, {0, -1}, {-1, -1}, {-1, 0}, {-1, 1}, {0, 1}, {1, 1}};

static int overlaps(const Config *c, const float origin[2], int i, int j, const float target[2]) {
    float half = 0.5f * c->body, reach = half + (c->target / 2 - c->skin);
    float x = (origin[0] + i * c->step) + (half - c->eye) - target[0];
    float y = (origin[1] + j * c->step) + (half - c->eye) - target[1];
    return larger(fabsf(x), fabsf(y)) < reach;
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

static void look(const Config *c, const float *table, const float *numbers, const int *indices, const Whole *w,
                 const Real *r, float *restrict observation) {
    float ex = (r->origin[0] + w->i * c->step), ey = (r->origin[1] + w->j * c->step);
    int first = ((8 - w->heading) & 7) * TURN;
    const float *over_x = table + first, *slope_x = over_x + COUNT, *over_y = slope_x + COUNT, *slope_y = over_y + COUNT;
    uint32_t nearest[RAYS];
    for (int k = 0; k < RAYS; k++) nearest[k] = bits(c->range);
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
    float ox = r->target[0] - ex, oy = r->target[1] - ey, length = w->heading & 1 ? 1.41421356f : 1.0f;
    float ahead = (ox * WAY[w->heading][0] + oy * WAY[w->heading][1]) / length;
    write_look(c, nearest, over_x, slope_x, over_y, slope_y, ex, ey, r->target, ahead, observation);
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
