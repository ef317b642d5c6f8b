#define BAYESIAN_ICP_EXTERN
#include "geometry/decompositions.h"
