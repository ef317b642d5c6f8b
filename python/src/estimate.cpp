#include "bindings.h"
#include "converters.h"
#include "job.h"
#include "points.h"

#include <bayesian_icp/measurement.h>
#include <bayesian_icp/pipeline.h>

#include <pybind11/numpy.h>

#include <algorithm>
#include <memory>
#include <tuple>
#include <utility>

namespace py = pybind11;

namespace bayesian_icp::python {

namespace {

/** A cloud that is prepared once. */
class Target {
public:
  explicit Target(Points points)
  : is_rounded(points.is_rounded)
  , usual_coordinate(points.usual_coordinate)
  , prepared(std::move(points.xyz))
  {}

  const bool is_rounded;
  const double usual_coordinate;
  const PreparedCloud prepared;
};

/** Says what the status InvalidOptions or InvalidInput says as an exception. */
void
refuseMisuse(const Summary& summary)
{
  if (summary.status == Status::InvalidOptions ||
      summary.status == Status::InvalidInput)
    throw py::value_error(summary.message);
}

PosteriorEstimate
estimate(const std::shared_ptr<const Target>& source,
         const std::shared_ptr<const Target>& target,
         const Vector6d& guess,
         const Options& options,
         const py::object& observer)
{
  const std::string complaint = options.validate();
  if (!complaint.empty())
    throw py::value_error(complaint);
  PosteriorEstimate result = runBeside(
      [=](const ProgressCallback& progress) {
        return estimatePosterior(
            source->prepared, target->prepared, guess, options, progress);
      },
      observer);
  refuseMisuse(result.summary);
  if (!result.prior.mean().allFinite()) // nothing was sampled with any variance
    result.prior = Prior(result.prior.mean(),
                         result.prior.mean(),
                         Eigen::Vector3d(result.prior.mean().head<3>()));
  // Presets exact and paper search among points of 32 bits.
  if (source->is_rounded || target->is_rounded || options.preset != Preset::Calibrated)
    doubtRounding(std::max(source->usual_coordinate, target->usual_coordinate),
                  options,
                  result.summary);
  return result;
}

/** Draws of the chains that did not diverge, cut to the shortest: (chains, draws, 6).
 */
py::array_t<double>
samplesOf(const PosteriorEstimate& estimate)
{
  std::vector<const PoseMatrix*> chains;
  for (const Chain& chain : estimate.chains)
    if (!chain.diverged)
      chains.push_back(&chain.draws);
  Eigen::Index num_draws = chains.empty() ? 0 : chains.front()->rows();
  for (const PoseMatrix* draws : chains)
    num_draws = std::min(num_draws, draws->rows());
  py::array_t<double> samples({static_cast<py::ssize_t>(chains.size()),
                               static_cast<py::ssize_t>(num_draws),
                               py::ssize_t(6)});
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, 6, Eigen::RowMajor>;
  for (std::size_t c = 0; c < chains.size(); ++c)
    Eigen::Map<RowMajor>(samples.mutable_data() +
                             static_cast<Eigen::Index>(c) * num_draws * 6,
                         num_draws,
                         6) = chains[c]->topRows(num_draws);
  return samples;
}

/** A failed estimate has no prior. */
PoseEstimate
gaussianOf(const Prior& prior)
{
  return prior.mean().allFinite() ? estimateOf(prior) : PoseEstimate();
}

/** Posterior, weight and chains of each mode. */
std::vector<std::tuple<PoseEstimate, double, std::vector<int>>>
modesOf(const PosteriorEstimate& estimate)
{
  std::vector<std::tuple<PoseEstimate, double, std::vector<int>>> modes;
  for (const Mode& mode : estimate.summary.modes)
    modes.emplace_back(PoseEstimate(estimate.summary, mode), mode.weight, mode.chains);
  return modes;
}

std::vector<std::string>
flagsOfReport(const DataReport& report)
{
  std::vector<std::string> names;
  const auto add = [&names](bool is_raised, const char* name) {
    if (is_raised)
      names.emplace_back(name);
  };
  const DataFlags& flags = report.flags;
  add(flags.wrong_basin, "wrong_basin");
  add(flags.low_support, "low_support");
  add(flags.few_patches, "few_patches");
  add(flags.misfit, "misfit");
  add(flags.no_information, "no_information");
  add(flags.prior_conflict, "prior_conflict");
  return names;
}

void
bindSummary(py::module_& module)
{
  using C = CoordinateSummary;
  py::class_<C>(
      module, "CoordinateSummary", "Marginal posterior of one coordinate [m, rad].")
      .def_readonly("mean", &C::mean)
      .def_readonly("standard_deviation", &C::standard_deviation)
      .def_readonly("quantile_2_5", &C::quantile_2_5)
      .def_readonly("median", &C::median)
      .def_readonly("quantile_97_5", &C::quantile_97_5)
      .def_readonly("rhat", &C::rhat)
      .def_readonly("bulk_ess", &C::bulk_ess)
      .def_readonly("tail_ess", &C::tail_ess)
      .def_readonly("mcse", &C::mcse);
  using D = DataDirection;
  py::class_<D>(module, "Direction", "One motion and how well it is known.")
      .def_readonly("twist", &D::twist, "(6,) about the moved centroid [1, rad/m].")
      .def_readonly("standard_deviation", &D::standard_deviation, "Posterior [m].")
      .def_readonly("prior_standard_deviation", &D::prior_standard_deviation, "[m]")
      .def_readonly("relative_information", &D::relative_information)
      .def_readonly("observability", &D::observability, "observed, weak or prior_only.")
      .def_readonly("description", &D::description, "The motion in words.")
      .def("__repr__", [](const D& direction) {
        return std::string("<") + toString(direction.observability) + ": " +
               direction.description + ">";
      });
  using R = DataReport;
  py::class_<R>(module, "DataReport", "What the clouds say about the pose.")
      .def_readonly("is_available", &R::is_available)
      .def_readonly("noise_scale", &R::noise_scale)
      .def_readonly("residual_scale", &R::residual_scale)
      .def_readonly("effective_patches", &R::effective_patches)
      .def_readonly("active_fraction", &R::active_fraction)
      .def_readonly("active_fraction_of_target", &R::active_fraction_of_target)
      .def_readonly("correlation_factor", &R::correlation_factor)
      .def_readonly("degrees_of_freedom", &R::degrees_of_freedom)
      .def_readonly("basin_distance", &R::basin_distance)
      .def_readonly("other_cost_ratio", &R::other_cost_ratio)
      .def_readonly("prior_probability", &R::prior_probability)
      .def_readonly("centre", &R::centre)
      .def_readonly("directions", &R::directions)
      .def_property_readonly("flags", &flagsOfReport)
      .def_property_readonly("warnings", &describeFlags);
}

} // namespace

void
bindEstimate(py::module_& module)
{
  bindSummary(module);
  py::class_<Target, std::shared_ptr<Target>>(
      module,
      "Target",
      "A cloud that is prepared once and used many times, as target or source.\n\n"
      "Parameters\n----------\n"
      "points : array_like, (N, 3)\n"
      "    Finite points [m], or an open3d.geometry.PointCloud.\n"
      "name : str\n"
      "    Of the cloud, in the texts of errors.\n\n"
      "Raises\n------\n"
      "TypeError\n    If they are not real numbers.\n"
      "ValueError\n    If the shape is not (N, 3), or a point is not finite.")
      .def(py::init([](const py::object& points, const std::string& name) {
             return std::make_shared<Target>(pointsOf(points, name));
           }),
           py::arg("points"),
           py::arg("name") = "target")
      .def("__len__",
           [](const Target& target) { return target.prepared.points().cols(); })
      .def("__repr__", [](const Target& target) {
        return "<bayesian_icp.Target of " +
               std::to_string(target.prepared.points().cols()) + " points>";
      });

  using P = PoseEstimate;
  py::class_<P>(module, "PoseEstimate", "Mean and covariances of a pose.")
      .def_readonly("status", &P::status)
      .def_readonly("mean", &P::mean, py::return_value_policy::copy)
      .def("covariance", &P::covariance, py::arg("convention"));
  py::class_<Prior>(module, "Prior", "The prior that was sampled with.")
      .def_property_readonly("estimate", &gaussianOf)
      .def_property_readonly("variance",
                             [](const Prior& p) { return Vector6d(p.variance()); })
      .def_property_readonly("reference_point", [](const Prior& p) {
        return Eigen::Vector3d(p.referencePoint());
      });
  module.def(
      "without_prior",
      [](const P& posterior, const Prior& prior) {
        const PoseMeasurement measurement = withoutPrior(posterior, prior);
        return std::pair(measurement.estimate, measurement.num_unmeasured);
      },
      py::arg("posterior"),
      py::arg("prior"));

  using E = PosteriorEstimate;
  py::class_<E>(module, "Estimate", "Draws and their summary.")
      .def_property_readonly("posterior",
                             [](const E& e) { return PoseEstimate(e.summary); })
      .def_readonly("prior", &E::prior)
      .def_property_readonly("message", [](const E& e) { return e.summary.message; })
      .def_property_readonly("coordinates",
                             [](const E& e) { return e.summary.coordinates; })
      .def_property_readonly("num_chains",
                             [](const E& e) { return e.summary.num_chains; })
      .def_property_readonly("num_diverged_chains",
                             [](const E& e) { return e.summary.num_diverged_chains; })
      .def_property_readonly("num_draws",
                             [](const E& e) { return e.summary.num_draws; })
      .def_property_readonly("modes", &modesOf)
      .def_property_readonly("data", [](const E& e) { return e.summary.data; })
      .def_property_readonly("samples", &samplesOf)
      .def(
          "chain",
          [](const E& e, py::ssize_t index) {
            if (index < 0 || index >= static_cast<py::ssize_t>(e.chains.size()))
              throw py::index_error(
                  "index is " + std::to_string(index) + ", but there are " +
                  std::to_string(e.chains.size()) + " chains, from 0 on");
            return e.chains[static_cast<std::size_t>(index)].draws;
          },
          py::arg("index"));
  module.def("estimate",
             &estimate,
             py::arg("source"),
             py::arg("target"),
             py::arg("guess"),
             py::arg("options"),
             py::arg("observer"));
}

} // namespace bayesian_icp::python
