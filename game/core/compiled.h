// What every compiled loop begins with; see game/core/compiled.py.
#pragma once

#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

// A function that Python calls: no arguments, no result.
#define EXPORT(name) __attribute__((export_name(#name))) void name(void)

// What Python has written for the present call, as the function's own struct. 256 bytes: see Machine.
extern _Alignas(16) unsigned char parameters[256];
#define PARAMETERS(type) ((const type *)(const void *)parameters)

static inline float least(float a, float b) { return a < b ? a : b; }
static inline float most(float a, float b) { return a > b ? a : b; }
static inline float clamp(float x, float low, float high) { return least(most(x, low), high); }
