// Which triangles of a posed mesh can be seen in a picture, and which of its edges are outlines there.
//
// A software rasteriser with samples shades every front face, whatever is nearer: of a person that is more than three
// times what is seen. So the front faces are drawn here first, as distances alone, into a grid of a quarter of the
// picture's pixels; what lies behind it everywhere is left out.
#include "compiled.h"

typedef float Four __attribute__((vector_size(16)));
typedef int32_t Truth __attribute__((vector_size(16)));

// On the grid: x to the right and y up, in cells. near: 1 / w, which is linear on the picture and grows to the eye.
typedef struct { float x, y, near; } Place;
typedef struct { float at_origin, per_x, per_y; } Plane;
typedef struct { int32_t x0, y0, x1, y1; } Cells; // both ends included
typedef enum { BACK, HIDDEN, SEEN, CUT } Side; // a cut face has corners beside or behind the eye

typedef struct {
    const float (*clip)[4]; // clip coordinates by vertex
    const int32_t (*triangle)[3];
    const int32_t (*edge)[4]; // opposite corner of face one, start, end, opposite corner of face two
    const int32_t (*face)[2]; // by edge; no second face: -1
    const int32_t *first; // by run, its first triangle
    Place *place; // by vertex
    uint8_t *side; // by triangle: a Side
    float *grid; // nearest front face by cell; empty: 0
    const float *scene; // what stands before the mesh, in the same way; none: null
    int32_t (*shown)[3]; // out: triangles to draw, run by run
    int32_t (*line)[4]; // out: edges to draw
    int32_t *count; // out: triangles to draw by run, then edges to draw
    int32_t vertices, triangles, edges, runs;
    int32_t columns, rows; // of the grid, columns a multiple of four; 0: hidden faces are not looked for
    float line_cells; // how far an outline reaches from its edge
} Job;

static const float EYE = 0.01f; // nearer than so many metres in front of the eye, a corner has no place on the grid
static const float SLACK = 1.0005f; // a millimetre at two metres: a face does not hide itself
static const Four MIDDLE = {0.5f, 1.5f, 2.5f, 3.5f}; // of four cells side by side

static float least3(float a, float b, float c) { return least(least(a, b), c); }
static float most3(float a, float b, float c) { return most(most(a, b), c); }

static float twice_area(Place a, Place b, Place c) {
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

static Plane plane(Place a, Place b, Place c) {
    float share = 1.0f / twice_area(a, b, c), u = b.near - a.near, v = c.near - a.near;
    float per_x = (u * (c.y - a.y) - v * (b.y - a.y)) * share, per_y = (v * (b.x - a.x) - u * (c.x - a.x)) * share;
    return (Plane){a.near - per_x * a.x - per_y * a.y, per_x, per_y};
}

// Cells whose middle is in the box, and so many more around them; columns from a multiple of four.
static Cells cells(const Job *job, float x0, float y0, float x1, float y1, float around) {
    Cells found = {
        (int32_t)clamp(ceilf(x0 - 0.5f - around), 0.0f, (float)job->columns),
        (int32_t)clamp(ceilf(y0 - 0.5f - around), 0.0f, (float)job->rows),
        (int32_t)clamp(floorf(x1 - 0.5f + around), -1.0f, (float)(job->columns - 1)),
        (int32_t)clamp(floorf(y1 - 0.5f + around), -1.0f, (float)(job->rows - 1)),
    };
    found.x0 &= ~3;
    return found;
}

static Cells cells_of(const Job *job, Place a, Place b, Place c, float around) {
    return cells(job, least3(a.x, b.x, c.x), least3(a.y, b.y, c.y), most3(a.x, b.x, c.x), most3(a.y, b.y, c.y), around);
}

static Side side_of(const Job *job, const int32_t *corner) {
    const float *a = job->clip[corner[0]], *b = job->clip[corner[1]], *c = job->clip[corner[2]];
    if (least3(a[3], b[3], c[3]) < EYE) return CUT;
    return twice_area(job->place[corner[0]], job->place[corner[1]], job->place[corner[2]]) > 0.0f ? SEEN : BACK;
}

// Draw a front face into the grid.
static void cover(const Job *job, Place a, Place b, Place c) {
    Cells box = cells_of(job, a, b, c, 0.0f);
    Plane at = plane(a, b, c);
    for (int32_t x = box.x0; x <= box.x1; x += 4) {
        Four px = MIDDLE + (float)x;
        float py = (float)box.y0 + 0.5f;
        // On the inner side of all three edges.
        Four ab = (b.x - a.x) * (py - a.y) - (b.y - a.y) * (px - a.x);
        Four bc = (c.x - b.x) * (py - b.y) - (c.y - b.y) * (px - b.x);
        Four ca = (a.x - c.x) * (py - c.y) - (a.y - c.y) * (px - c.x);
        Four near = at.at_origin + at.per_x * px + at.per_y * py;
        for (int32_t y = box.y0; y <= box.y1; y++) {
            Four *cell = (Four *)(void *)&job->grid[y * job->columns + x];
            Truth nearer = (ab >= 0.0f) & (bc >= 0.0f) & (ca >= 0.0f) & (near > *cell);
            *cell = (Four)(((Truth)near & nearer) | ((Truth)*cell & ~nearer));
            ab += b.x - a.x, bc += c.x - b.x, ca += a.x - c.x, near += at.per_y;
        }
    }
}

// Whether a plane, kept between two distances, is nowhere farther than the grid in some of the cells.
static bool shows(const Job *job, Cells box, Plane at, float low, float high) {
    Four least_near = (Four){0} + low * SLACK, most_near = (Four){0} + high * SLACK;
    for (int32_t x = box.x0; x <= box.x1; x += 4) {
        Four near = (at.at_origin + at.per_x * (MIDDLE + (float)x) + at.per_y * ((float)box.y0 + 0.5f)) * SLACK;
        for (int32_t y = box.y0; y <= box.y1; y++) {
            const Four *cell = (const Four *)(const void *)&job->grid[y * job->columns + x];
            Four here = __builtin_wasm_max_f32x4(least_near, __builtin_wasm_min_f32x4(most_near, near));
            if (__builtin_wasm_any_true_v128((Truth)(here >= *cell))) return true;
            near += at.per_y * SLACK;
        }
    }
    return false;
}

// The middles around a face are looked at too: what is seen of it between two middles is seen from one of them.
static bool face_shows(const Job *job, const int32_t *corner) {
    Place a = job->place[corner[0]], b = job->place[corner[1]], c = job->place[corner[2]];
    Cells box = cells_of(job, a, b, c, 1.0f);
    return shows(job, box, plane(a, b, c), least3(a.near, b.near, c.near), most3(a.near, b.near, c.near));
}

// Whether something within an outline's reach is farther than its edge: only there is it drawn.
static bool line_shows(const Job *job, Place a, Place b) {
    float reach = job->line_cells + 1.0f, near = most(a.near, b.near) * SLACK;
    Cells box = cells(job, least(a.x, b.x), least(a.y, b.y), most(a.x, b.x), most(a.y, b.y), reach);
    float dx = b.x - a.x, dy = b.y - a.y, share = 1.0f / most(sqrtf(dx * dx + dy * dy), 1e-6f);
    for (int32_t x = box.x0; x <= box.x1; x += 4) {
        Four away = ((MIDDLE + ((float)x - a.x)) * dy - ((float)box.y0 + 0.5f - a.y) * dx) * share;
        for (int32_t y = box.y0; y <= box.y1; y++) {
            const Four *cell = (const Four *)(const void *)&job->grid[y * job->columns + x];
            if (__builtin_wasm_any_true_v128((away <= reach) & (away >= -reach) & (*cell <= near))) return true;
            away -= dx * share;
        }
    }
    return false;
}

static bool is_front(const Job *job, int32_t face) { return face >= 0 && job->side[face] != BACK; }

// An outline lies between a front and a back face; that of a hidden face may look out from behind what hides it.
static bool is_line(const Job *job, int32_t number) {
    const int32_t *face = job->face[number], *edge = job->edge[number];
    bool one = is_front(job, face[0]), other = is_front(job, face[1]);
    if (one == other) return false;
    int32_t front = one ? face[0] : face[1];
    return job->columns == 0 || job->side[front] == CUT || line_shows(job, job->place[edge[1]], job->place[edge[2]]);
}

EXPORT(find) {
    const Job *job = PARAMETERS(Job);
    bool hide = job->columns > 0;
    float half_width = hide ? (float)job->columns * 0.5f : 1.0f, half_height = hide ? (float)job->rows * 0.5f : 1.0f;
    for (int32_t i = 0; i < job->vertices; i++) {
        const float *clip = job->clip[i];
        float near = 1.0f / clip[3];
        job->place[i] = (Place){(clip[0] * near + 1.0f) * half_width, (clip[1] * near + 1.0f) * half_height, near};
    }
    size_t grid_bytes = (size_t)(job->columns * job->rows) * sizeof(float);
    if (job->scene) memcpy(job->grid, job->scene, grid_bytes);
    else memset(job->grid, 0, grid_bytes);
    for (int32_t i = 0; i < job->triangles; i++) {
        const int32_t *corner = job->triangle[i];
        job->side[i] = side_of(job, corner);
        if (hide && job->side[i] == SEEN)
            cover(job, job->place[corner[0]], job->place[corner[1]], job->place[corner[2]]);
    }
    int32_t shown = 0;
    for (int32_t run = 0; run < job->runs; run++) {
        int32_t end = run + 1 < job->runs ? job->first[run + 1] : job->triangles, before = shown;
        for (int32_t i = job->first[run]; i < end; i++) {
            if (job->side[i] == BACK) continue;
            if (hide && job->side[i] == SEEN && !face_shows(job, job->triangle[i])) {
                job->side[i] = HIDDEN;
                continue;
            }
            memcpy(job->shown[shown++], job->triangle[i], sizeof *job->shown);
        }
        job->count[run] = shown - before;
    }
    int32_t lines = 0;
    for (int32_t i = 0; i < job->edges; i++)
        if (is_line(job, i)) memcpy(job->line[lines++], job->edge[i], sizeof *job->line);
    job->count[job->runs] = lines;
}
