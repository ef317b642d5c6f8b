#define BAYESIAN_ICP_EXTERN
#include "algebra/decompositions.h"
