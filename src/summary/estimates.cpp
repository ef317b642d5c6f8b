#include "summary/estimates.h"

#include "sampler/median.h"
#include "summary/plain_text.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <utility>

namespace bayesian_icp {

namespace {

/** Near the poles roll and yaw are one angle, and covariances of angles are useless. */
std::vector<std::string>
doubtsAboutAngles(const Summary& summary)
{
  /** Standard deviations within which the draws are. */
  constexpr double reach = 3.0;
  /** Draws that reach further have all attitudes: other doubts are more important
   * [rad].
   */
  constexpr double max_distance = 0.5;
  const Eigen::Matrix3d rotation =
      summary.covariance(CovarianceConvention::R3xSO3).bottomRightCorner<3, 3>();
  if (!rotation.allFinite())
    return {};
  const double largest_variance =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(rotation, Eigen::EigenvaluesOnly)
          .eigenvalues()
          .maxCoeff();
  const double distance = M_PI_2 - std::abs(summary.mean[4]);
  if (distance > max_distance ||
      distance > reach * std::sqrt(std::max(largest_variance, 0.0)))
    return {};
  return {
      formatted("the draws reach pitch +-90 degrees (%.2f rad from the mean), where "
                "roll and yaw are one angle: their covariance, R-hat and quantiles "
                "mean little, take the covariance in R3xSO3",
                distance)};
}

} // namespace

PosteriorEstimate
failure(Status status, const std::string& message)
{
  PosteriorEstimate estimate;
  estimate.summary.status = status;
  estimate.summary.message = message;
  return estimate;
}

PosteriorEstimate
estimateOf(ChainSet chain_set, const Prior& prior)
{
  PosteriorEstimate result;
  result.summary = summarize(chain_set);
  if (result.summary.num_draws > 0)
    result.prior = prior;
  addDoubts(doubtsAboutAngles(result.summary), result.summary);
  result.samples = pooledDraws(chain_set.chains);
  result.chains = std::move(chain_set.chains);
  return result;
}

double
usualCoordinate(const Eigen::Matrix3Xd& points)
{
  std::vector<double> largest;
  for (const auto& point : points.colwise())
    if (point.allFinite())
      largest.push_back(point.cwiseAbs().maxCoeff());
  return medianOf(std::move(largest));
}

void
doubtRounding(double coordinate, const Options& options, Summary& summary)
{
  // Share of the rounding in the variance of a distance from which on it matters.
  constexpr double max_share = 0.1;
  const LikelihoodScale& stated =
      options.preset == Preset::Exact ? options.exact.scale : options.paper.scale;
  const double noise =
      summary.data.is_available ? summary.data.noise_scale : stated.measurement_sigma;
  const auto kept = static_cast<float>(coordinate);
  const double step =
      double(std::nextafter(kept, std::numeric_limits<float>::infinity())) - kept;
  // A step has a variance of step^2 / 12, in the source and in the target.
  if (summary.num_chains == 0 || !(step * step / 6.0 >= max_share * noise * noise))
    return;
  addDoubts(
      {formatted("coordinates of %.3g m are kept to %.2g m only, in 32 bits, which "
                 "matters against a noise of %.2g m: move the clouds towards the "
                 "origin",
                 coordinate,
                 step,
                 noise)},
      summary);
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

std::optional<PosteriorEstimate>
refusalOf(const Eigen::Matrix3Xd& source_points,
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
  return std::nullopt;
}

} // namespace bayesian_icp
