// Shared by the tests of exports: an estimate with a full covariance, draws about it,
// and what is read from a text.
#pragma once

#include "support/test_support.h"

#include <bayesian_icp/exports.h>
#include <bayesian_icp/pose.h>
#include <bayesian_icp/random.h>

#include <Eigen/Cholesky>

#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace bayesian_icp::test {

constexpr int num_draws = 20000;

/** A covariance of full rank with deviations of about so much in every coordinate. */
inline Matrix6d
someCovariance(double deviation)
{
  Random random(7, 0);
  const Matrix6d factor = randomSquare(random);
  return deviation * deviation / 6.0 *
         (factor * factor.transpose() + Matrix6d::Identity());
}

inline const Vector6d&
meanPoseOfTests()
{
  static const Vector6d mean(2.0, -1.0, 0.5, 0.4, -0.7, 2.5);
  return mean;
}

inline PoseMatrix
drawsAboutMean(double deviation)
{
  Random random(11, 0);
  const Matrix6d L = someCovariance(deviation).llt().matrixL();
  PoseMatrix draws(num_draws, 6);
  for (int i = 0; i < num_draws; ++i) {
    const Vector6d z = random.normal6();
    draws.row(i) =
        poseFromError(L * z, meanPoseOfTests(), CovarianceConvention::RightSE3)
            .transpose();
  }
  return draws;
}

/** What a run with these draws would hand to the exports. */
inline PoseEstimate
estimateOf(const PoseMatrix& draws, const Vector6d& mean = meanPoseOfTests())
{
  PoseEstimate estimate;
  estimate.status = Status::Ok;
  estimate.mean = mean;
  for (std::size_t i = 0; i < 4; ++i)
    estimate.covariances[i] =
        covarianceAbout(estimate.mean, draws, static_cast<CovarianceConvention>(i));
  return estimate;
}

/** Largest difference, in units of the deviations. */
inline double
relativeDifference(const Matrix6d& found, const Matrix6d& expected)
{
  const Vector6d scale = expected.diagonal().cwiseSqrt().cwiseInverse();
  return (scale.asDiagonal() * (found - expected) * scale.asDiagonal())
      .cwiseAbs()
      .maxCoeff();
}

/** The numbers among the words of a text, and in its lists. */
inline std::vector<double>
numbersOf(std::string text)
{
  for (char& character : text)
    if (character == '[' || character == ']' || character == ',')
      character = ' ';
  std::istringstream stream(text);
  std::vector<double> numbers;
  for (std::string word; stream >> word;) {
    std::size_t end = 0;
    try {
      const double number = std::stod(word, &end);
      if (end == word.size())
        numbers.push_back(number);
    }
    catch (const std::invalid_argument&) { // a word
    }
  }
  return numbers;
}

} // namespace bayesian_icp::test
