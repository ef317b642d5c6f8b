/** \file
 * \brief Scans of one surface, whole and spoilt, for the tests at the edge of what can
 * be registered.
 */
#pragma once

#include "support/test_support.h"

#include <bayesian_icp/pose.h>

#include <cstdint>

namespace bayesian_icp::test {

/** Standard deviation of the points' height [m]. */
constexpr double usual_noise = 0.003;

/** Two clouds [m] and the pose between them. */
struct TorturePair {
  Eigen::Matrix3Xd source;
  Eigen::Matrix3Xd target;
  Vector6d guess = Vector6d::Zero();
  Vector6d truth = Vector6d::Zero();
  /** Whether there is a pose that is right: not where the clouds do not belong
   * together. */
  bool has_truth = true;
  /** Noise of a usual scan of this size [m]. */
  double noise = usual_noise;
  /** Along so many of the source's first axes nothing holds it. */
  int num_free_axes = 0;
};

constexpr Eigen::Index num_source_points = 1000;
constexpr Eigen::Index num_target_points = 4000;

/** The part of the surface that a scan sees [m]. */
struct Region {
  double left, right, front, back;
};
constexpr Region whole = {-0.5, 0.5, -0.3, 0.3};

/** \brief The truth of most pairs. */
Vector6d
smallMotion();

/** \brief Points of the surface with noise of the height [m]. */
Eigen::Matrix3Xd
scan(std::uint64_t seed, Eigen::Index num_points, const Region& region, double noise);

/** \brief The surface scanned twice, smallMotion() apart. */
TorturePair
usualPair(double noise = usual_noise);

/** \brief As usualPair(), in a frame whose origin is \p distance off in x and y [m]. */
TorturePair
farPair(double distance);

/** \brief As usualPair(), with all lengths multiplied. */
TorturePair
scaledPair(double scale);

/** \brief As usualPair() with another truth and guess. */
TorturePair
turnedPair(const Vector6d& truth, const Vector6d& guess);

/** \brief As usualPair(), with height (two dimensions left), or height and width (one),
 * replaced by noise [m]. */
TorturePair
flattenedPair(int num_dimensions, double noise);

} // namespace bayesian_icp::test
