/** \file
 * \brief Ctrl-C as a wish to stop and keep what there is.
 */
#pragma once

namespace bayesian_icp::app {

/** \brief From now on the first SIGINT is only remembered, the second one kills. A
 * SIGINT that is ignored, as in background jobs, stays so. */
void
catchInterrupt();

/** \brief Whether there was a SIGINT. */
bool
wasInterrupted();

} // namespace bayesian_icp::app
