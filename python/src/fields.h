/** \file
 * \brief Structures of options as classes of Python.
 */
#pragma once

#include <pybind11/pybind11.h>

#include <string>

namespace bayesian_icp::python {

/** \brief Binds the fields of a structure of options, one after the other. */
template <typename Struct>
class Fields {
public:
  Fields(pybind11::module_& module, const char* name, const char* doc)
  : class_(module, name, doc)
  {
    class_.def(pybind11::init<>(), "All options at their defaults.");
    class_.def(pybind11::init<const Struct&>(), pybind11::arg("other"), "A copy.");
  }

  /** \brief Other than def_readwrite(), a bad value is refused with the field's name.
   */
  template <typename Value>
  Fields&
  add(const char* name, Value Struct::*field, const char* doc)
  {
    class_.def_property(
        name,
        pybind11::cpp_function([field](Struct& self) -> Value& { return self.*field; },
                               pybind11::return_value_policy::reference_internal),
        [field, name](Struct& self, const pybind11::object& value) {
          try {
            self.*field = value.cast<Value>();
          }
          catch (const pybind11::value_error& error) {
            throw pybind11::value_error(std::string(name) + ": " + error.what());
          }
          catch (const pybind11::cast_error&) {
            throw pybind11::type_error(std::string(name) + " is " +
                                       std::string(pybind11::repr(value)) +
                                       ", which it cannot be: see help() of its class");
          }
        },
        doc);
    return *this;
  }

  pybind11::class_<Struct>&
  get()
  {
    return class_;
  }

private:
  pybind11::class_<Struct> class_;
};

} // namespace bayesian_icp::python
