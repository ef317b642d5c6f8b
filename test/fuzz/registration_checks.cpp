#include "registration_classes.h"

#include <Eigen/Eigenvalues>

#include <limits>

namespace bayesian_icp::fuzz {

namespace {

/** Of all results that were checked. */
int num_with_draws = 0;

/** The covariance in units of standard deviations; zero for coordinates whose variance
 * is denormal, and not known to any digit. */
Matrix6d
correlationOf(const Matrix6d& covariance)
{
  Vector6d scale = Vector6d::Zero();
  for (int k = 0; k < 6; ++k)
    if (covariance(k, k) >= std::numeric_limits<double>::min())
      scale[k] = 1.0 / std::sqrt(covariance(k, k));
  return scale.asDiagonal() * covariance * scale.asDiagonal();
}

/** A second moment is symmetric and has no negative eigenvalue, but for rounding: each
 * correlation is a sum of products, of absolute values that add up to at most 1, and so
 * is wrong by one epsilon a draw at most; 6 x 6 of them move an eigenvalue by 6 times
 * that, and finding the eigenvalues by a few epsilons more. */
void
checkSecondMoment(const Matrix6d& covariance, long num_draws)
{
  require(covariance.allFinite(), "a usable posterior has a covariance");
  require((covariance.diagonal().array() >= 0.0).all(), "variances are not negative");
  const double error = std::numeric_limits<double>::epsilon() * double(num_draws + 6);
  const Matrix6d correlation = correlationOf(covariance);
  require((correlation - correlation.transpose()).cwiseAbs().maxCoeff() <= error,
          "a covariance is symmetric");
  const Eigen::SelfAdjointEigenSolver<Matrix6d> solver(correlation,
                                                       Eigen::EigenvaluesOnly);
  require(solver.eigenvalues().minCoeff() >= -6.0 * error,
          "a covariance has no negative direction");
}

} // namespace

void
checkEstimate(const Summary& summary, const PoseMatrix& samples)
{
  require(summary.status != Status::NotRun, "a run has a status");
  require(!summary.message.empty(), "a status has a message");
  require(summary.num_draws == samples.rows(), "draws are counted");
  require(samples.allFinite(), "draws are finite");
  num_with_draws += summary.num_draws > 0 ? 1 : 0;
  if (summary.num_draws == 0)
    require(summary.mean.array().isNaN().all(), "no posterior is NaN");
  else
    require(summary.mean.allFinite(), "the mean of draws is finite");
  for (const Matrix6d& covariance : summary.covariances)
    if (summary.num_draws < 2)
      require(covariance.array().isNaN().all(), "one draw has no covariance");
    else if (hasUsableMean(summary.status))
      checkSecondMoment(covariance, summary.num_draws);
}

void
checkDescent(const RegistrationInput& input, const StochasticGradientIcpResult& result)
{
  require(result.pose.allFinite() || !input.guess.allFinite(),
          "a descent ends at a finite pose");
  require(result.has_converged == (result.end == DescentEnd::Converged),
          "a descent that came to rest says so");
}

} // namespace bayesian_icp::fuzz

extern "C" bool
isCorpusReachingResults()
{
  return bayesian_icp::fuzz::num_with_draws >= 20;
}
