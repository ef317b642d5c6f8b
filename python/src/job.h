/** \file
 * \brief An estimate that runs beside the interpreter.
 */
#pragma once

#include <bayesian_icp/pipeline.h>

#include <pybind11/pybind11.h>

#include <functional>

namespace bayesian_icp::python {

/** \brief Takes the callback that it is to call, and returns an estimate. It must own
 * what it needs. */
using Work = std::function<PosteriorEstimate(const ProgressCallback&)>;

/** \brief Run \p work on a thread of its own, without the interpreter's lock.
 *
 * The calling thread passes on signals and progress a few times a second, so a callback
 * costs the chains nothing and is always called where align() was.
 * \param[in] observer None, or called with (steps, total_steps, pose); cancels by False
 * \throws pybind11::error_already_set for a signal, such as KeyboardInterrupt, and for
 * an exception of \p observer; and what \p work throws */
PosteriorEstimate
runBeside(const Work& work, const pybind11::object& observer);

} // namespace bayesian_icp::python
