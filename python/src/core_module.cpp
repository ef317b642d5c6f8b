#include "bindings.h"

PYBIND11_MODULE(_core, module)
{
  module.doc() = "The core of Bayesian ICP; use it by the package bayesian_icp.";
  module.attr("__version__") = BAYESIAN_ICP_VERSION;
  bayesian_icp::python::bindOptions(module);
  bayesian_icp::python::bindEstimate(module);
  bayesian_icp::python::bindPosesAndExports(module);
}
