/** \file
 * \brief Ctrl-C (SIGINT) and `kill` (SIGTERM) as a wish to stop and keep what there is.
 */
#pragma once

namespace bayesian_icp::io {

/** \brief From now on the first SIGINT or SIGTERM is only remembered, the second one
 * kills. A signal that is ignored, as SIGINT in background jobs, stays so. */
void
catchInterrupt();

/** \brief Whether there was a SIGINT or SIGTERM. */
bool
wasInterrupted();

} // namespace bayesian_icp::io
