#include "pipeline_parts.h"

#include <bayesian_icp/measurement.h>

#include <utility>

namespace bayesian_icp {

PosteriorEstimate
failure(Status status, const std::string& message)
{
  PosteriorEstimate estimate;
  estimate.summary.status = status;
  estimate.summary.message = message;
  return estimate;
}

PosteriorEstimate
estimateOf(ChainSet chain_set)
{
  PosteriorEstimate result;
  result.summary = summarize(chain_set);
  result.samples = pooledDraws(chain_set.chains);
  result.chains = std::move(chain_set.chains);
  return result;
}

void
addDoubts(const std::vector<std::string>& doubts, Summary& summary)
{
  if (doubts.empty())
    return;
  const bool is_lowered = summary.status == Status::Ok;
  if (is_lowered)
    summary.status = Status::Doubtful;
  for (std::size_t i = 0; i < doubts.size(); ++i)
    summary.message += (i > 0 ? "; " : is_lowered ? ", but " : "; also ") + doubts[i];
}

PosteriorEstimate
checkArguments(const Eigen::Matrix3Xd& source_points,
               const Vector6d& initial_pose,
               const Options& options)
{
  const std::string complaint = options.validate();
  if (!complaint.empty())
    return failure(Status::InvalidOptions, complaint);
  if (!initial_pose.allFinite())
    return failure(Status::InvalidInput, "the initial guess is not finite");
  if (!source_points.allFinite())
    return failure(Status::InvalidInput, "the source has non-finite points");
  return PosteriorEstimate();
}

Prior
makePrior(const Options& options,
          const Vector6d& initial_pose,
          const Eigen::Matrix3Xd& source_points)
{
  return priorOf(options, initial_pose, source_points.rowwise().mean());
}

} // namespace bayesian_icp
