// Shared by the core's tests: random poses, synthetic points, a brute-force search and
// central differences.
#pragma once

#include <bayesian_icp/correspondence.h>
#include <bayesian_icp/pose.h>
#include <bayesian_icp/random.h>

#include <cmath>
#include <functional>
#include <limits>

namespace bayesian_icp::test {

/** Uniform position within +-2 m, angles within the given share of their full range. */
inline Vector6d
randomPose(Random& random, double share_of_range = 1.0)
{
  const double pi = std::acos(-1.0);
  Vector6d pose;
  for (int k = 0; k < 6; ++k)
    pose[k] = 2.0 * random.uniform() - 1.0;
  pose.head<3>() *= 2.0;
  pose[3] *= pi * share_of_range;
  pose[4] *= 0.5 * pi * share_of_range;
  pose[5] *= pi * share_of_range;
  return pose;
}

/** Points in a box of 1 x 0.6 x 0.3 m about \p centre. */
inline Eigen::Matrix3Xd
randomPoints(Random& random,
             Eigen::Index num_points,
             const Eigen::Vector3d& centre = Eigen::Vector3d::Zero())
{
  const Eigen::Vector3d size(1.0, 0.6, 0.3);
  Eigen::Matrix3Xd points(3, num_points);
  for (Eigen::Index i = 0; i < num_points; ++i)
    for (int k = 0; k < 3; ++k)
      points(k, i) = centre[k] + size[k] * (random.uniform() - 0.5);
  return points;
}

/** Gradient of \p f by central differences; the error is of order step^2. */
inline Vector6d
centralDifferences(const std::function<double(const Vector6d&)>& f,
                   const Vector6d& pose,
                   double step = 1e-5)
{
  Vector6d gradient;
  for (int k = 0; k < 6; ++k) {
    const Vector6d h = step * Vector6d::Unit(k);
    gradient[k] = (f(pose + h) - f(pose - h)) / (2.0 * step);
  }
  return gradient;
}

/** Exact nearest neighbours by looking at every target point. */
class BruteForceSearch : public CorrespondenceSearch {
public:
  explicit BruteForceSearch(
      const Eigen::Matrix3Xd& target,
      double max_distance = std::numeric_limits<double>::infinity(),
      bool is_thread_safe = true)
  : target_(target)
  , max_distance_(max_distance)
  , is_thread_safe_(is_thread_safe)
  {}

  void
  find(const Vector6d& /* pose */,
       const std::vector<std::size_t>& /* source_indices */,
       const Eigen::Matrix3Xd& moved_points,
       Correspondences& correspondences) const override
  {
    correspondences.clear();
    for (Eigen::Index i = 0; i < moved_points.cols(); ++i) {
      Eigen::Index nearest = 0;
      const double squared_distance = (target_.colwise() - moved_points.col(i))
                                          .colwise()
                                          .squaredNorm()
                                          .minCoeff(&nearest);
      if (std::sqrt(squared_distance) <= max_distance_)
        correspondences.push_back({static_cast<std::size_t>(i), target_.col(nearest)});
    }
  }

  bool
  isThreadSafe() const override
  {
    return is_thread_safe_;
  }

private:
  Eigen::Matrix3Xd target_;
  double max_distance_;
  bool is_thread_safe_;
};

} // namespace bayesian_icp::test
