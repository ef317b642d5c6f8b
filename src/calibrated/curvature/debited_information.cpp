#include "algebra/decompositions.h"
#include "calibrated/curvature/curvature.h"

#include <algorithm>
#include <cmath>

namespace bayesian_icp {

namespace {

/** From this multiple of the noise threshold on, only the mean of the noise is debited
 * from the information. */
constexpr double full_to_threshold = 3.0;

/** Information to debit for the noise of a secant, whose mean information is \p noise.
 * Below the threshold nothing of the information remains. Far above it, the mean of the
 * noise is debited. In between the debit is linear. */
double
noiseDebit(double information, double noise, double threshold)
{
  const double above =
      (information / noise / threshold - 1.0) / (full_to_threshold - 1.0);
  return noise * (threshold + (1.0 - threshold) * std::clamp(above, 0.0, 1.0));
}

} // namespace

double
noiseThreshold(const Matrix6d& score_covariance, const Matrix6d& noise)
{
  // 99.9 % quantile of a chi-square variate over its mean; z is the normal quantile.
  constexpr double z = 3.09;
  const auto L = score_covariance.llt();
  const Matrix6d half = L.matrixL().solve(noise);
  const Matrix6d whitened = L.matrixL().solve(half.transpose());
  const double sum = whitened.trace(), sum_of_squares = whitened.squaredNorm();
  const double nu =
      sum_of_squares > 0.0 ? std::clamp(sum * sum / sum_of_squares, 1.0, 6.0) : 6.0;
  const double q = 2.0 / (9.0 * nu);
  const double root = 1.0 - q + z * std::sqrt(q);
  return root * root * root;
}

Matrix6d
transferOf(const Matrix6d& directions, const Vector6d& keep)
{
  return directions * keep.cwiseSqrt().asDiagonal() * directions.inverse();
}

DebitedInformation
debitedInformation(const Secants& secants,
                   const Matrix6d& score_covariance,
                   const Vector6d& least_information)
{
  const Eigen::LDLT<Matrix6d> J(score_covariance);
  const Matrix6d HV = secants.curvature * secants.steps;
  DebitedInformation result;
  result.raw = (HV.transpose() * J.solve(HV)).diagonal();
  for (int k = 0; k < 6; ++k) {
    const Matrix6d& noise = secants.noise[static_cast<std::size_t>(k)];
    const double mean_noise = J.solve(noise).trace();
    const double debit = mean_noise > 0.0
                             ? noiseDebit(result.raw[k],
                                          mean_noise,
                                          noiseThreshold(score_covariance, noise))
                             : 0.0;
    const double kept = secants.trust[k] * (result.raw[k] - debit);
    const bool is_held = kept > 0.0 && kept >= least_information[k];
    result.keep[k] = is_held ? kept / result.raw[k] : 0.0;
  }
  result.transfer = transferOf(secants.steps, result.keep);
  const Matrix6d HT = secants.curvature * result.transfer;
  result.information = HT.transpose() * J.solve(HT);
  result.information = symmetrized(result.information);
  return result;
}

} // namespace bayesian_icp
