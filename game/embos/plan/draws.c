// Random numbers that depend on nothing but (key, purpose, event): see game/embos/draws.py.
#include "plan.h"

static uint64_t mix(uint64_t x) {
    x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9u;
    x = (x ^ (x >> 27)) * 0x94D049BB133111EBu;
    return x ^ (x >> 31);
}

// The first `count` draws in (0, 1) of an event, at most 8.
void uniform(uint64_t key, uint64_t purpose, int64_t event, int count, double *draws) {
    uint64_t counter = (uint64_t)event * 64 + purpose * 8;
    for (int i = 0; i < count; i++) {
        uint64_t bits = mix(mix(key ^ ((counter + 1 + i) * 0x9E3779B97F4A7C15u)));
        draws[i] = ((double)(bits >> 11) + 0.5) * 0x1p-53;
    }
}

// A log-normal factor with mean 1; sigma of its logarithm, 0: exactly 1.
double spread_factor(const Tables *t, double draw, double sigma) {
    int low = 0, high = t->quantiles - 1;
    double normal;
    if (draw <= t->share[low]) {
        normal = t->normal[low];
    } else if (draw >= t->share[high]) {
        normal = t->normal[high];
    } else {
        while (high - low > 1) {
            int middle = (low + high) / 2;
            if (t->share[middle] <= draw) low = middle;
            else high = middle;
        }
        double slope = (t->normal[high] - t->normal[low]) / (t->share[high] - t->share[low]);
        normal = slope * (draw - t->share[low]) + t->normal[low];
    }
    return exp(sigma * normal - 0.5 * sigma * sigma);
}
