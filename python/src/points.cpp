#include "points.h"

#include <bayesian_icp/pipeline.h>

#include <pybind11/numpy.h>

namespace py = pybind11;

namespace bayesian_icp::python {

namespace {

std::string
shapeOf(const py::array& array)
{
  return py::str(py::tuple(array.attr("shape")));
}

py::array
arrayOf(py::handle cloud, const std::string& name)
{
  const bool is_holder =
      !py::isinstance<py::array>(cloud) && py::hasattr(cloud, "points");
  const py::object points =
      is_holder ? cloud.attr("points") : py::reinterpret_borrow<py::object>(cloud);
  const py::module_ masked = py::module_::import("numpy.ma");
  if (py::bool_(masked.attr("is_masked")(points)))
    throw py::value_error(name + " has masked points; give the others alone, as in "
                                 "cloud[~cloud.mask.any(axis=1)].data");
  py::object as_array;
  try {
    as_array = py::module_::import("numpy").attr("asarray")(points);
  }
  catch (py::error_already_set& error) {
    if (!error.matches(PyExc_ValueError)) // lists of several lengths are no array
      throw;
  }
  const auto array = py::reinterpret_steal<py::array>(as_array.release());
  const char kind = array ? array.dtype().kind() : 'O';
  if (kind != 'f' && kind != 'i' && kind != 'u') {
    const bool is_array = py::isinstance<py::array>(cloud);
    const py::str given = is_array ? py::str(array.dtype())
                                   : py::str(py::type::of(cloud).attr("__name__"));
    throw py::type_error(name + (is_array ? " has the dtype " : " is of type ") +
                         std::string(given) + ", but must be an array of real numbers");
  }
  if (array.ndim() != 2 || array.shape(1) != 3)
    throw py::value_error(name + " has the shape " + shapeOf(array) +
                          ", but must have (N, 3): each row is a point");
  return array;
}

/** The one copy of the points: NumPy writes into the memory of the matrix. */
Eigen::Matrix3Xd
copyOf(const py::array& array)
{
  Eigen::Matrix3Xd points(3, array.shape(0));
  const py::array_t<double> memory(
      {array.shape(0), py::ssize_t(3)}, points.data(), py::none());
  py::module_::import("numpy").attr("copyto")(memory, array);
  return points;
}

} // namespace

Points
pointsOf(py::handle cloud, const std::string& name)
{
  const py::array array = arrayOf(cloud, name);
  Points points;
  points.xyz = copyOf(array);
  for (Eigen::Index i = 0; i < points.xyz.cols(); ++i)
    if (!points.xyz.col(i).allFinite())
      throw py::value_error(
          py::str("{0}[{1}] is {2!r}, but points must be finite; "
                  "{0}[numpy.isfinite({0}).all(axis=1)] has those that are")
              .format(name, i, array[py::int_(i)]));
  points.is_rounded = array.dtype().kind() == 'f' && array.itemsize() < 8;
  points.usual_coordinate = usualCoordinate(points.xyz);
  return points;
}

} // namespace bayesian_icp::python
