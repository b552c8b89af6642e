#include "compiled.h"

_Alignas(16) unsigned char parameters[256];
