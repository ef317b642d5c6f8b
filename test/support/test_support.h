// Shared by the core's tests: random poses, synthetic points, a brute-force search,
// central differences and errors in units of a covariance.
#pragma once

#include <bayesian_icp/correspondence.h>
#include <bayesian_icp/pose.h>
#include <bayesian_icp/random.h>

#include <Eigen/Cholesky>

#include <atomic>
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

/** Independent standard normal numbers. */
inline Matrix6d
randomSquare(Random& random)
{
  Matrix6d square;
  for (int k = 0; k < 6; ++k)
    square.col(k) = random.normal6();
  return square;
}

/** Quantiles of chi-square with six degrees of freedom. */
constexpr double chi_square_99 = 16.812, chi_square_999 = 22.458,
                 chi_square_9999 = 27.856;

/** Squared length of an error, in standard deviations. */
inline double
squaredError(const Vector6d& error, const Matrix6d& covariance)
{
  return error.dot(covariance.ldlt().solve(error));
}

/** Squared distance of the true pose from the mean, in standard deviations.
 * \param[in] estimate a Summary or a PoseEstimate */
template <typename Estimate>
double
squaredErrorOf(const Estimate& estimate,
               const Vector6d& truth,
               CovarianceConvention convention = CovarianceConvention::R3xSO3)
{
  return squaredError(poseError(truth, estimate.mean, convention),
                      estimate.covariance(convention));
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

/** A wavy surface of 1 x 0.6 m with noise of its height [m]. */
inline Eigen::Matrix3Xd
wavySurface(std::uint64_t seed,
            Eigen::Index num_points,
            double amplitude,
            double noise = 0.003)
{
  Random random(seed, 0);
  Eigen::Matrix3Xd points = randomPoints(random, num_points);
  for (Eigen::Index i = 0; i < num_points; ++i)
    points(2, i) =
        amplitude * std::sin(9.0 * points(0, i)) * std::cos(8.0 * points(1, i)) +
        noise * random.normal();
  return points;
}

/** The points, moved by \p pose. */
inline Eigen::Matrix3Xd
moved(const Vector6d& pose, const Eigen::Matrix3Xd& points)
{
  Eigen::Matrix3Xd result;
  movePoints(pose, points, result);
  return result;
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

/** Draws by random-walk Metropolis, one in each row.
 * \param[in] energy -log density
 * \param[in] factor L of a covariance L L^T, which only decides how fast it is
 * \param[in] thinning steps from one draw to the next */
inline PoseMatrix
randomWalk(const std::function<double(const Vector6d&)>& energy,
           const Vector6d& start,
           const Matrix6d& factor,
           int num_draws,
           int thinning,
           Random& random)
{
  constexpr int num_burn_in = 500;
  Vector6d position = start;
  double value = energy(position);
  PoseMatrix draws(num_draws, 6);
  for (int i = -num_burn_in; i < num_draws; ++i) {
    for (int step = 0; step < thinning; ++step) {
      const Vector6d proposal = position + 0.95 * (factor * random.normal6());
      const double proposed = energy(proposal);
      if (std::log(1.0 - random.uniform()) < value - proposed) {
        position = proposal;
        value = proposed;
      }
    }
    if (i >= 0)
      draws.row(i) = position.transpose();
  }
  return draws;
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

  /** Largest number of calls of find() at the same time. */
  int
  mostAtOnce() const
  {
    return most_at_once_;
  }

  /** Largest index of a source point that was asked for. */
  std::size_t
  largestIndex() const
  {
    return largest_index_;
  }

  void
  find(const Vector6d& /* pose */,
       const std::vector<std::size_t>& source_indices,
       const Eigen::Matrix3Xd& moved_points,
       Correspondences& correspondences) const override
  {
    const int num_running = ++num_running_;
    raise(most_at_once_, num_running);
    for (const std::size_t index : source_indices)
      raise(largest_index_, index);
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
    --num_running_;
  }

  bool
  isThreadSafe() const override
  {
    return is_thread_safe_;
  }

private:
  template <typename Number>
  static void
  raise(std::atomic<Number>& most, Number number)
  {
    Number known = most;
    while (known < number && !most.compare_exchange_weak(known, number)) {
    }
  }

  Eigen::Matrix3Xd target_;
  double max_distance_;
  bool is_thread_safe_;
  mutable std::atomic<int> num_running_{0}, most_at_once_{0};
  mutable std::atomic<std::size_t> largest_index_{0};
};

} // namespace bayesian_icp::test
