#pragma once

/** \brief Marks what the shared libraries export; everything else is hidden. */
#if defined(_WIN32)
#define BAYESIAN_ICP_EXPORT
#else
#define BAYESIAN_ICP_EXPORT __attribute__((visibility("default")))
#endif
