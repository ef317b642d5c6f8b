#include "track/registration.h"

#include <bayesian_icp/measurement.h>
#include <bayesian_icp/pipeline.h>

#include <algorithm>

namespace bayesian_icp::app {

Registration
registered(const PreparedCloud& source,
           const PreparedCloud& target,
           const Options& options,
           const ProgressCallback& progress)
{
  bool is_cancelled = false;
  const auto watch = [&](const Progress& done) {
    is_cancelled = is_cancelled || (progress && !progress(done));
    return !is_cancelled;
  };
  PosteriorEstimate estimate =
      estimatePosterior(source, target, options.prior.mean, options, watch);
  Summary& summary = estimate.summary;
  doubtRounding(
      std::max(usualCoordinate(source.points()), usualCoordinate(target.points())),
      options,
      summary);
  Registration result;
  result.status = toString(summary.status);
  result.message = summary.message;
  if (is_cancelled) {
    result.quality = Quality::Cancelled;
    return result;
  }
  std::string complaint = complaintAboutEdge(summary);
  if (complaint.empty()) {
    const PoseMeasurement measurement = withoutPrior(
        PoseEstimate(summary), Prior(options.prior.mean, options.prior.variance));
    complaint = complaintAboutExport(measurement.estimate, false);
    result.edge.num_unmeasured = measurement.num_unmeasured;
    result.edge.pose = {
        measurement.estimate.mean,
        measurement.estimate.covariance(CovarianceConvention::RightSE3)};
  }
  if (!complaint.empty()) {
    result.message += "; not used: " + complaint;
    return result;
  }
  result.quality = Quality::Good;
  if (summary.status == Status::Doubtful) {
    result.quality =
        summary.data.flags.prior_conflict ? Quality::Contradiction : Quality::Doubtful;
    result.edge.pose.covariance *= doubt_factor;
  }
  return result;
}

} // namespace bayesian_icp::app
