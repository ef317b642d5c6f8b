/** \file
 * \brief The parts of the extension bayesian_icp._core.
 */
#pragma once

#include <pybind11/pybind11.h>

namespace bayesian_icp::python {

/** \brief Options and what they are made of. */
void
bindOptions(pybind11::module_& module);

/** \brief Target, estimate() and the result. */
void
bindEstimate(pybind11::module_& module);

/** \brief Poses, conventions, diagnostics and exports. */
void
bindPosesAndExports(pybind11::module_& module);

} // namespace bayesian_icp::python
