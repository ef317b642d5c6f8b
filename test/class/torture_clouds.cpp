#include "class/torture_clouds.h"

#include <bayesian_icp/pose.h>
#include <bayesian_icp/random.h>

#include <Eigen/LU>

#include <cmath>

namespace bayesian_icp::test {

using Eigen::Matrix3Xd;

namespace {

constexpr Region inner = {-0.4, 0.4, -0.24, 0.24};

/** Waves that do not repeat themselves, and a bump: no motion and no mirror maps the
 * surface to itself. */
double
height(double x, double y)
{
  const double bump = std::exp(-(std::pow(x - 0.2, 2) + std::pow(y - 0.1, 2)) / 0.005);
  return 0.06 * std::sin(9.0 * x + 4.0 * x * x + 0.7) *
             std::cos(8.0 * y + 3.0 * y * y + 0.3) +
         0.08 * x * y + 0.08 * bump;
}

} // namespace

Vector6d
smallMotion()
{
  return {0.01, -0.02, 0.015, 0.02, -0.03, 0.025};
}

Matrix3Xd
scan(std::uint64_t seed, Eigen::Index num_points, const Region& region, double noise)
{
  Random random(seed, 0);
  Matrix3Xd points(3, num_points);
  for (Eigen::Index i = 0; i < num_points; ++i) {
    const double x = region.left + (region.right - region.left) * random.uniform();
    const double y = region.front + (region.back - region.front) * random.uniform();
    points.col(i) << x, y, height(x, y) + noise * random.normal();
  }
  return points;
}

TorturePair
usualPair(double noise)
{
  TorturePair pair;
  pair.truth = smallMotion();
  pair.source = scan(1, num_source_points, inner, noise);
  pair.target = moved(pair.truth, scan(2, num_target_points, whole, noise));
  return pair;
}

TorturePair
farPair(double distance)
{
  TorturePair pair = usualPair();
  Eigen::Matrix4d shift = Eigen::Matrix4d::Identity();
  shift.topRightCorner<3, 1>() << distance, -distance, 0.0;
  for (Matrix3Xd* cloud : {&pair.source, &pair.target})
    cloud->colwise() += shift.topRightCorner<3, 1>();
  pair.truth = poseOf(shift * matrixOf(pair.truth) * shift.inverse());
  return pair;
}

TorturePair
scaledPair(double scale)
{
  TorturePair pair = usualPair();
  pair.source *= scale;
  pair.target *= scale;
  pair.truth.head<3>() *= scale;
  pair.noise *= scale;
  return pair;
}

TorturePair
turnedPair(const Vector6d& truth, const Vector6d& guess)
{
  TorturePair pair = usualPair();
  pair.guess = guess;
  pair.truth = truth;
  pair.target = moved(truth, scan(2, num_target_points, whole, usual_noise));
  return pair;
}

TorturePair
flattenedPair(int num_dimensions, double noise)
{
  TorturePair pair = usualPair();
  pair.num_free_axes = num_dimensions;
  Matrix3Xd target = scan(2, num_target_points, whole, 0.0);
  Random random(3, 0);
  for (Matrix3Xd* cloud : {&pair.source, &target})
    for (Eigen::Index i = 0; i < cloud->cols(); ++i)
      for (int k = num_dimensions; k < 3; ++k)
        (*cloud)(k, i) = noise * random.normal();
  pair.target = moved(pair.truth, target);
  return pair;
}

} // namespace bayesian_icp::test
