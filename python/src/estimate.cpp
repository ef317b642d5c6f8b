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
  if (result.summary.status == Status::InvalidOptions ||
      result.summary.status == Status::InvalidInput)
    throw py::value_error(result.summary.message);
  if (!result.prior.mean().allFinite()) // nothing was sampled with any variance
    result.prior = Prior(result.prior.mean(),
                         result.prior.mean(),
                         Eigen::Vector3d(result.prior.mean().head<3>()));
  // Presets exact and paper search among points of 32 bits.
  double coordinate = 0.0;
  for (const auto& cloud : {source, target})
    if (cloud->is_rounded || options.preset != Preset::Calibrated)
      coordinate = std::max(coordinate, cloud->usual_coordinate);
  doubtRounding(coordinate, options, result.summary);
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
  for (const DataFlag& flag : data_flags)
    if (report.flags.*flag.is_raised)
      names.emplace_back(flag.key);
  return names;
}

void
bindSummary(py::module_& module)
{
  using C = CoordinateSummary;
  py::class_<C>(
      module,
      "CoordinateSummary",
      "Marginal posterior of one coordinate [m, rad]; what is undefined is NaN.")
      .def_readonly("mean",
                    &C::mean,
                    "Mean of this coordinate alone, circular for an angle [m, rad].")
      .def_readonly("standard_deviation",
                    &C::standard_deviation,
                    "About that mean; an angle is wrapped about it [m, rad].")
      .def_readonly("quantile_2_5",
                    &C::quantile_2_5,
                    "2.5 % of the draws are below it; an angle is unwrapped about the "
                    "mean [m, rad].")
      .def_readonly("median", &C::median, "Unwrapped in the same way [m, rad].")
      .def_readonly("quantile_97_5",
                    &C::quantile_97_5,
                    "97.5 % are below it; unwrapped in the same way [m, rad].")
      .def_readonly("rhat", &C::rhat, "R-hat; up to 1.01 is good.")
      .def_readonly(
          "bulk_ess", &C::bulk_ess, "Effective sample size; 400 or more is good.")
      .def_readonly("tail_ess", &C::tail_ess, "The same for the tails.")
      .def_readonly(
          "mcse", &C::mcse, "Monte Carlo standard error of the mean [m, rad].")
      .def("__repr__", [](const C& c) {
        return py::str("<{:.4g}±{:.2g}, rhat {:.3f}, bulk ESS {:.0f}>")
            .format(c.mean, c.standard_deviation, c.rhat, c.bulk_ess);
      });
  using D = DataDirection;
  py::class_<D>(module, "Direction", "One motion and how well it is known.")
      .def_readonly("twist",
                    &D::twist,
                    "(6,) left twist (v, w) about DataReport.centre, target frame [1, "
                    "rad/m]. It moves the source's points by one in root mean square.")
      .def_readonly("standard_deviation",
                    &D::standard_deviation,
                    "Posterior's along the twist, as root mean square displacement of "
                    "the source's points [m]. Times the norm of twist[3:], it is the "
                    "angle of the rotation [rad].")
      .def_readonly("prior_standard_deviation",
                    &D::prior_standard_deviation,
                    "The same of the prior [m].")
      .def_readonly(
          "relative_information",
          &D::relative_information,
          "Information of the clouds along the twist, in units of the prior's: "
          "standard_deviation is prior_standard_deviation / sqrt(1 + this).")
      .def_readonly("observability", &D::observability, "observed, weak or prior_only.")
      .def_readonly("description", &D::description, "The motion in words.")
      .def("__repr__", [](const D& direction) {
        return std::string("<") + toString(direction.observability) + ": " +
               direction.description + ">";
      });
  using R = DataReport;
  py::class_<R>(module, "DataReport", "What the clouds say about the pose.")
      .def_readonly("is_available",
                    &R::is_available,
                    "False for presets exact and paper: all else is then meaningless.")
      .def_readonly("noise_scale",
                    &R::noise_scale,
                    "Standard deviation of a source point's distance to the target's "
                    "surface [m].")
      .def_readonly(
          "residual_scale",
          &R::residual_scale,
          "noise_scale in units of the target's own noise, or of the source's "
          "if the target is far cleaner; normally 1 to 1.5.")
      .def_readonly(
          "effective_patches",
          &R::effective_patches,
          "Number of independent patches of surface with the same information; "
          "about 96 if neighbouring points are independent.")
      .def_readonly("active_fraction",
                    &R::active_fraction,
                    "Share of the source points on the target's surface, 0 to 1.")
      .def_readonly(
          "active_fraction_of_target",
          &R::active_fraction_of_target,
          "Share of the target points on the source's surface, 0 to 1; NaN "
          "if they are not compared, because the source has no usable surface "
          "or is so sparse that its own points say more.")
      .def_readonly("correlation_factor",
                    &R::correlation_factor,
                    "Factor by which correlation between neighbouring points inflates "
                    "the covariance of the score.")
      .def_readonly("degrees_of_freedom",
                    &R::degrees_of_freedom,
                    "nu of Student's t distribution, from which the draws are taken in "
                    "the directions that the clouds determine.")
      .def_readonly("basin_distance",
                    &R::basin_distance,
                    "Mahalanobis distance between the ends of the two starts, without "
                    "prior_only directions.")
      .def_readonly("other_cost_ratio",
                    &R::other_cost_ratio,
                    "Cost at the worse of the two ends, divided by that at the better "
                    "one.")
      .def_readonly(
          "prior_probability",
          &R::prior_probability,
          "Probability of a posterior's mean further from the prior's mean, if "
          "the prior is right, without prior_only directions.")
      .def_readonly("centre",
                    &R::centre,
                    "(3,) centre of the twists: the moved source's centroid, target "
                    "frame [m].")
      .def_readonly(
          "directions", &R::directions, "Six motions (Direction), best known first.")
      .def_property_readonly(
          "flags", &flagsOfReport, "Names of the raised flags, as Result.flags.")
      .def_property_readonly("warnings",
                             &describeFlags,
                             "Each raised flag in words, with number and threshold.")
      .def("__repr__", [](const R& r) {
        if (!r.is_available)
          return py::str("<bayesian_icp.DataReport: only preset calibrated has one>");
        return py::str("<bayesian_icp.DataReport: noise {:.2g} m, {:.0f} patches, "
                       "flags: {}>")
            .format(r.noise_scale, r.effective_patches, flagsOfReport(r));
      });
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
      .def_property_readonly(
          "points",
          [](const Target& target) {
            return Eigen::MatrixX3d(target.prepared.points().transpose());
          },
          "(N, 3) a copy of the points [m].")
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
      .def_property_readonly("num_diverged_chains",
                             [](const E& e) { return e.summary.num_diverged_chains; })
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
