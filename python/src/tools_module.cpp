/** \file
 * \brief The extension bayesian_icp._tools: what the programs have and the core has
 * not, with PCL and Boost. It is imported when it is first used.
 */
#include "io/cloud_file.h"
#include "io/errors.h"
#include "io/output_folder.h"
#include "plot/gnuplot.h"
#include "points.h"
#include "report/report_html.h"
#include "simulate/command_line.h"

#include <bayesian_icp/pipeline.h>

#include <pybind11/eigen.h>
#include <pybind11/stl.h>

#include <filesystem>
#include <string>
#include <utility>

namespace py = pybind11;

namespace bayesian_icp::python {

namespace {

using RowMajorPoints = Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor>;

RowMajorPoints
readPoints(const std::string& path)
{
  RowMajorPoints points;
  std::string note;
  {
    const py::gil_scoped_release release;
    const io::CloudFile cloud = io::readCloud(path);
    points = io::finitePoints(cloud).transpose();
    note = io::noteOfLostDigits(cloud);
  }
  constexpr int caller_of_read_pcd = 2;
  if (!note.empty() &&
      PyErr_WarnEx(PyExc_UserWarning, note.c_str(), caller_of_read_pcd) != 0)
    throw py::error_already_set();
  return points;
}

/** The options of the command line of the simulator, which checks and explains them. */
py::tuple
simulate(const std::vector<std::string>& arguments)
{
  std::vector<const char*> words = {"simulate"};
  for (const std::string& argument : arguments)
    words.push_back(argument.c_str());
  simulator::ScanPair pair;
  {
    const py::gil_scoped_release release;
    pair = simulator::simulate(
        simulator::parseCommandLine(static_cast<int>(words.size()), words.data())
            .options);
  }
  return py::make_tuple(RowMajorPoints(pair.source.transpose()),
                        RowMajorPoints(pair.target.transpose()),
                        pair.T_target_source);
}

/** Name, description and unobservable motions of each scene. */
std::vector<std::array<std::string, 3>>
scenes()
{
  std::vector<std::array<std::string, 3>> list;
  for (const std::string& name : simulator::sceneNames()) {
    const simulator::Scene scene = simulator::makeScene(name);
    list.push_back({name, scene.description, scene.unobservable});
  }
  return list;
}

io::CloudFile
cloudOf(const py::object& points, const std::string& name, Eigen::Index num_points)
{
  const Points given = pointsOf(points, name);
  if (given.xyz.cols() != num_points)
    throw py::value_error(name + " has " + std::to_string(given.xyz.cols()) +
                          " points, but the one that was registered had " +
                          std::to_string(num_points));
  io::CloudFile cloud;
  cloud.file = name;
  cloud.points = given.xyz.cast<float>();
  cloud.num_finite = static_cast<std::size_t>(cloud.points.cols());
  if (cloud.num_finite > 0)
    cloud.largest_coordinate = given.xyz.cwiseAbs().maxCoeff();
  return cloud;
}

void
writeReport(const PosteriorEstimate& estimate,
            const Options& options,
            const Vector6d& guess,
            double seconds,
            const std::string& path,
            const py::object& source,
            const py::object& target,
            const std::pair<Eigen::Index, Eigen::Index>& num_points)
{
  if (estimate.summary.num_draws == 0)
    throw py::value_error("there are no draws to report: " + estimate.summary.message);
  app::Run run;
  run.source = cloudOf(source, "source", num_points.first);
  run.target = cloudOf(target, "target", num_points.second);
  run.settings.options = options;
  run.settings.guess = matrixOf(guess);
  run.settings.use_mean = true;
  run.result.has_icp = false;
  run.result.summary = estimate.summary;
  run.result.chains = estimate.chains;
  run.result.final_matrix = matrixOf(estimate.summary.mean);
  run.result.is_final_the_mean = true;
  run.result.sampling_seconds = seconds;
  const py::gil_scoped_release release;
  const std::string page =
      reportHtml(run,
                 "bayesian_icp.align(source=source, target=target, "
                 "init_T_target_source=guess, options=options)");
  const std::filesystem::path file = std::filesystem::absolute(path);
  io::OutputFolder folder(file.parent_path().string());
  folder.add(file.filename().string(), page);
  folder.commit();
}

} // namespace

} // namespace bayesian_icp::python

PYBIND11_MODULE(_tools, module)
{
  using namespace bayesian_icp;
  module.doc() = "Readers, report and simulator; use them by the package bayesian_icp.";
  py::module_::import("bayesian_icp._core"); // whose classes are arguments here
  py::register_local_exception_translator([](std::exception_ptr failure) {
    try {
      std::rethrow_exception(std::move(failure));
    }
    catch (const io::FileError& error) {
      // The name of a file need not be UTF-8.
      const auto text =
          py::reinterpret_steal<py::object>(PyUnicode_DecodeFSDefault(error.what()));
      PyErr_SetObject(PyExc_OSError, text.ptr());
    }
    catch (const io::UsageError& error) {
      PyErr_SetString(PyExc_ValueError, error.what());
    }
  });
  io::silencePcl();
  module.def("read_points", &python::readPoints, py::arg("path"));
  module.def("simulate", &python::simulate, py::arg("arguments"));
  module.def("scenes", &python::scenes);
  module.def("write_report",
             &python::writeReport,
             py::arg("estimate"),
             py::arg("options"),
             py::arg("guess"),
             py::arg("seconds"),
             py::arg("path"),
             py::arg("source"),
             py::arg("target"),
             py::arg("num_points"));
}
