/** \file
 * \brief The parts of the extension bayesian_icp._core, and how values of the core look
 * in Python: enumerations are their short names, `automatic` is None.
 */
#pragma once

#include <bayesian_icp/data_report.h>
#include <bayesian_icp/options.h>
#include <bayesian_icp/summary.h>

#include <pybind11/eigen.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <string>
#include <type_traits>
#include <vector>

namespace bayesian_icp::python {

/** \brief Options and what they are made of. */
void
bindOptions(pybind11::module_& module);

/** \brief Target, estimate() and the result. */
void
bindEstimate(pybind11::module_& module);

} // namespace bayesian_icp::python

namespace pybind11::detail {

/** An enumeration of the core, whose values are 0, 1, ..., by its short names. */
template <typename Enum>
struct type_caster<
    Enum,
    std::void_t<std::enable_if_t<std::is_enum_v<Enum>>, decltype(toString(Enum()))>> {
  PYBIND11_TYPE_CASTER(Enum, const_name("str"));

  bool
  load(handle source, bool)
  {
    std::vector<std::string> names;
    for (int i = 0;; ++i) {
      const std::string found = toString(static_cast<Enum>(i));
      // Beyond the last value there is no new name.
      if (found == "unknown" ||
          std::find(names.begin(), names.end(), found) != names.end())
        break;
      names.push_back(found);
      if (source.equal(pybind11::str(found))) {
        value = static_cast<Enum>(i);
        return true;
      }
    }
    throw value_error(std::string(repr(source)) + " is none of " +
                      std::string(pybind11::str(pybind11::cast(names))));
  }

  static handle
  cast(Enum choice, return_value_policy, handle)
  {
    return pybind11::str(toString(choice)).release();
  }
};

template <typename T>
struct type_caster<bayesian_icp::Automatic<T>> {
  PYBIND11_TYPE_CASTER(bayesian_icp::Automatic<T>,
                       const_name("Optional[") + make_caster<T>::name +
                           const_name("]"));

  bool
  load(handle source, bool convert)
  {
    make_caster<T> given;
    if (!source.is_none() && !given.load(source, convert))
      return false;
    value = source.is_none() ? bayesian_icp::Automatic<T>()
                             : bayesian_icp::Automatic<T>(cast_op<T&>(given));
    return true;
  }

  static handle
  cast(const bayesian_icp::Automatic<T>& option, return_value_policy, handle parent)
  {
    if (!option.isGiven())
      return none().release();
    const handle value =
        make_caster<T>::cast(option.valueOr(T()), return_value_policy::copy, parent);
    if (hasattr(value, "flags")) // whoever writes into this copy would change nothing
      value.attr("flags").attr("writeable") = false;
    return value;
  }
};

} // namespace pybind11::detail
