#include "algebra/decompositions.h"

#include <bayesian_icp/exports.h>

#include <limits>
#include <stdexcept>

namespace bayesian_icp {

namespace {

/** Smallest eigenvalue of a matrix of correlations that can be inverted: rounding
 * errors of 1e-15 become 1e-5 of the inverse. */
constexpr double min_correlation_eigenvalue = 1e-10;

/** Of correlations and of their eigenvalues, for rounding errors; covariances of draws
 * are exactly symmetric. */
constexpr double rounding_error = 1e-9;

constexpr const char* frame_characters =
    "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_-./";
/** Seconds are an int32 in ROS. */
constexpr std::int64_t timestamp_limit_ns = (std::int64_t(1) << 31) * 1'000'000'000;

/** Of the matrix of correlations. \param[in] scale standard deviations */
double
leastEigenvalue(const Matrix6d& covariance, const Vector6d& scale)
{
  const Vector6d inverse = (scale.array() > 0.0).select(scale.cwiseInverse(), 1.0);
  const Matrix6d correlation = inverse.asDiagonal() * covariance * inverse.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Matrix6d> solver(correlation,
                                                       Eigen::EigenvaluesOnly);
  return solver.eigenvalues()[0];
}

std::string
complaintAboutNumbers(const Matrix6d& covariance)
{
  if (!covariance.allFinite())
    return "the covariance is not finite";
  if (!(covariance.diagonal().array() >= 0.0).all())
    return "a variance is negative";
  const Vector6d scale = covariance.diagonal().cwiseSqrt();
  const Matrix6d asymmetry = (covariance - covariance.transpose()).cwiseAbs();
  if ((asymmetry.array() > rounding_error * (scale * scale.transpose()).array()).any())
    return "the covariance is not symmetric";
  if (leastEigenvalue(covariance, scale) < -rounding_error)
    return "the covariance has a negative eigenvalue";
  return "";
}

std::string
complaintAboutInverse(const Matrix6d& covariance)
{
  std::string complaint = complaintAboutNumbers(covariance);
  if (!complaint.empty())
    return complaint;
  const Vector6d scale = covariance.diagonal().cwiseSqrt();
  if ((scale.array() == 0.0).any())
    return "the covariance is singular: a variance is zero";
  return leastEigenvalue(covariance, scale) >= min_correlation_eigenvalue
             ? ""
             : "the covariance is singular or nearly so";
}

} // namespace

PoseEstimate::PoseEstimate()
: mean(Vector6d::Constant(std::numeric_limits<double>::quiet_NaN()))
{
  covariances.fill(Matrix6d::Constant(std::numeric_limits<double>::quiet_NaN()));
}

PoseEstimate::PoseEstimate(const Summary& summary)
: status(summary.status)
, mean(summary.mean)
, covariances(summary.covariances)
{}

PoseEstimate::PoseEstimate(const Summary& summary, const Mode& mode)
: status(summary.status == Status::SeveralModes ? Status::Doubtful : summary.status)
, mean(mode.mean)
, covariances(mode.covariances)
{}

const Matrix6d&
PoseEstimate::covariance(CovarianceConvention convention) const
{
  return covariances[static_cast<std::size_t>(convention)];
}

std::string
ExportOptions::validate() const
{
  for (const auto* frame : {&target_frame, &source_frame})
    if (frame->empty() || frame->find_first_not_of(frame_characters) != frame->npos)
      return std::string(frame == &target_frame ? "target_frame" : "source_frame") +
             " must be one or more of A-Z a-z 0-9 _ - . /";
  if (timestamp_ns < 0 || timestamp_ns >= timestamp_limit_ns)
    return "timestamp_ns is " + std::to_string(timestamp_ns) +
           ", but must be from 0 to below 2^31 s";
  if (target_vertex < 0 || source_vertex < 0 || target_vertex == source_vertex)
    return "target_vertex and source_vertex must be different and not negative";
  return "";
}

std::string
complaintAboutExport(const PoseEstimate& estimate,
                     bool needs_information,
                     bool accept_unreliable)
{
  if (estimate.status != Status::Ok && estimate.status != Status::Doubtful &&
      !accept_unreliable)
    return std::string("the status is ") + toString(estimate.status) +
           ", neither ok nor doubtful";
  if (!estimate.mean.allFinite())
    return "the mean pose is not finite";
  for (const Matrix6d& covariance : estimate.covariances) {
    std::string complaint = complaintAboutNumbers(covariance);
    if (!complaint.empty())
      return complaint;
  }
  return needs_information ? complaintAboutInverse(
                                 estimate.covariance(CovarianceConvention::RightSE3))
                           : "";
}

Matrix6d
informationOf(const Matrix6d& covariance)
{
  const std::string complaint = complaintAboutInverse(covariance);
  if (!complaint.empty())
    throw std::invalid_argument(complaint);
  // In units of the deviations, as metres and radians may differ by orders.
  const Vector6d scale = covariance.diagonal().cwiseSqrt().cwiseInverse();
  const Matrix6d correlation = scale.asDiagonal() * covariance * scale.asDiagonal();
  const Matrix6d inverse = correlation.llt().solve(Matrix6d::Identity());
  return (scale * scale.transpose()).cwiseProduct(symmetrized(inverse));
}

} // namespace bayesian_icp
