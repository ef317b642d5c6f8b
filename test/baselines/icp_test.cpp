// ICP without PCL against pcl::IterativeClosestPoint: steps, ends, criteria.
#include "baselines/icp_pair.h"
#include "geometry/twist.h"
#include "support/test_support.h"

#include <Eigen/SVD>

#include <cmath>

namespace bayesian_icp {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using test::Cloud;
using test::IcpPair;
using test::readIcpPair;

/** Half a unit in the last place of a float near 1. */
constexpr double float_rounding = 0x1p-24;

/** How far apart one step of ours and one of PCL's may be from the same pose: both are
 * the best motion for their pairs, and PCL's moved points and distances are rounded to
 * floats, which may change the neighbour of a point or let it through the gate. */
class StepBound {
public:
  StepBound(const IcpPair& pair, const Isometry3d& pose, double gate)
  {
    pcl::search::KdTree<pcl::PointXYZ> tree;
    tree.setInputCloud(pair.target_cloud);
    for (Eigen::Index i = 0; i < pair.source.cols(); ++i)
      add(tree, pair, pair.source.col(i), pose, gate);
    finish();
  }

  /** Of the moved centroid [m]. */
  double translation = 0.0;
  /** Frobenius norm of a difference of rotations. */
  double rotation = 0.0;
  /** Of the points that have pairs, source frame. */
  Vector3d centroid = Vector3d::Zero();

private:
  struct Pair {
    Vector3d source, moved, found;
    /** Of the moved point, of the neighbour; of the pair's being there at all. */
    double moved_error, found_error;
    bool may_be_missing;
  };

  void
  add(const pcl::search::KdTree<pcl::PointXYZ>& tree,
      const IcpPair& pair,
      const Vector3d& source,
      const Isometry3d& pose,
      double gate)
  {
    const Vector3d moved = pose * source;
    const pcl::PointXYZ query(static_cast<float>(moved.x()),
                              static_cast<float>(moved.y()),
                              static_cast<float>(moved.z()));
    constexpr int num_candidates = 12;
    pcl::Indices indices;
    std::vector<float> squares;
    tree.nearestKSearch(query, num_candidates, indices, squares);
    // A row of the rotation has norm 1; three products, three sums and the rounded
    // numbers of the matrix are five roundings of each coordinate, ours is one more.
    const double size = source.norm() + pose.translation().cwiseAbs().maxCoeff();
    const double moved_error = std::sqrt(3.0) * 6.0 * float_rounding * size;
    const double distance = std::sqrt(squares[0]);
    // Three roundings of a square are less than two of its root.
    const double margin = 2.0 * (moved_error + 2.0 * float_rounding * distance);
    if (distance > gate + margin)
      return;
    const auto pointAt = [&](std::size_t k) {
      return Vector3d((*pair.target_cloud)[static_cast<std::size_t>(indices[k])]
                          .getVector3fMap()
                          .cast<double>());
    };
    double found_error = 0.0;
    for (std::size_t k = 1; k < indices.size(); ++k)
      if (std::sqrt(squares[k]) - distance <= margin)
        found_error = std::max(found_error, (pointAt(k) - pointAt(0)).norm());
    pairs_.push_back({source,
                      moved,
                      pointAt(0),
                      moved_error,
                      found_error,
                      std::abs(distance - gate) <= margin});
  }

  void
  finish()
  {
    const auto count = static_cast<double>(pairs_.size());
    Vector3d moved_mean = Vector3d::Zero(), found_mean = Vector3d::Zero();
    for (const Pair& pair : pairs_) {
      centroid += pair.source / count;
      moved_mean += pair.moved / count;
      found_mean += pair.found / count;
    }
    Matrix3d covariance = Matrix3d::Zero();
    double covariance_error = 0.0;
    for (const Pair& pair : pairs_) {
      const Vector3d a = pair.moved - moved_mean, b = pair.found - found_mean;
      covariance += b * a.transpose() / count;
      const double a_error = pair.may_be_missing ? a.norm() : pair.moved_error;
      const double b_error = pair.may_be_missing ? b.norm() : pair.found_error;
      translation += (a_error + b_error) / count;
      covariance_error +=
          (b_error * a.norm() + b.norm() * a_error + a_error * b_error) / count;
    }
    // R. C. Li, New perturbation bounds for the unitary polar factor, 1995; twice that
    // for what is not of first order.
    const Eigen::JacobiSVD<Matrix3d> svd(covariance);
    const double sign = covariance.determinant() < 0.0 ? -1.0 : 1.0;
    const double gap = svd.singularValues()[1] + sign * svd.singularValues()[2];
    rotation = 2.0 * 2.0 * covariance_error / gap;
    translation *= 2.0;
  }

  std::vector<Pair> pairs_;
};

Isometry3d
someStart(Random& random, double range)
{
  Vector6d pose;
  for (int k = 0; k < 6; ++k)
    pose[k] = range * (2.0 * random.uniform() - 1.0);
  return isometryOf(pose);
}

struct Case {
  const char* name;
  std::size_t step;
  double gate;
  /** Of the starts [m, rad]; with a gate, so near that there are pairs. */
  double range;
};

constexpr double no_gate = std::numeric_limits<double>::infinity();

/** Far fewer points than the files have: PCL takes seconds for those. */
const Case cases[] = {{"can", 8, no_gate, 0.1},
                      {"can", 8, 0.05, 0.05},
                      {"mug", 10, no_gate, 0.1},
                      {"mug", 10, 0.05, 0.05},
                      {"table_top", 25, no_gate, 0.1},
                      {"table_top", 25, 0.2, 0.1}};

} // namespace

TEST(Icp, StepsAreThoseOfPcl)
{
  Random random(3, 0);
  for (const Case& named : cases) {
    const IcpPair pair = readIcpPair(named.name, named.step);
    IcpOptions options;
    options.max_distance = named.gate;
    options.max_iterations = 1;
    for (int run = 0; run < 3; ++run) {
      Isometry3d pose = someStart(random, named.range);
      // From there, on the way, and near the fixed point.
      for (const int num_iterations : {2, 10, 500}) {
        const StepBound bound(pair, pose, named.gate);
        const Isometry3d ours = pair.run(pose, options).T_target_source;
        const Isometry3d theirs = pair.runPcl(pose, options).T_target_source;
        SCOPED_TRACE(named.name + std::string(", gate ") + std::to_string(named.gate));
        EXPECT_LT((ours.linear() - theirs.linear()).norm(), bound.rotation);
        EXPECT_LT((ours * bound.centroid - theirs * bound.centroid).norm(),
                  bound.translation);
        // Far from the fixed point the bound is small beside the step.
        if (num_iterations < 500) {
          EXPECT_GT((ours * bound.centroid - pose * bound.centroid).norm(),
                    10.0 * bound.translation);
        }
        IcpOptions on = options;
        on.max_iterations = num_iterations;
        pose = pair.run(pose, on).T_target_source;
      }
    }
  }
}

TEST(Icp, RunsEndWherePclsDo)
{
  Random random(4, 0);
  for (const Case& named : cases) {
    const IcpPair pair = readIcpPair(named.name, named.step);
    IcpOptions options;
    options.max_distance = named.gate;
    options.max_iterations = 300;
    options.transformation_epsilon = 1e-8;
    for (int run = 0; run < 3; ++run) {
      SCOPED_TRACE(named.name + std::string(", gate ") + std::to_string(named.gate));
      const Isometry3d start = someStart(random, named.range);
      const IcpResult ours = pair.run(start, options);
      const IcpResult theirs = pair.runPcl(start, options);
      EXPECT_EQ(ours.num_iterations, theirs.num_iterations);
      EXPECT_EQ(ours.stop, theirs.stop);
      EXPECT_TRUE(ours.has_converged);
      EXPECT_TRUE(theirs.has_converged);
      // Every step adds to the difference.
      const StepBound bound(pair, ours.T_target_source, named.gate);
      EXPECT_LT(
          (ours.T_target_source.linear() - theirs.T_target_source.linear()).norm(),
          ours.num_iterations * bound.rotation);
      EXPECT_LT((ours.T_target_source * bound.centroid -
                 theirs.T_target_source * bound.centroid)
                    .norm(),
                ours.num_iterations * bound.translation);
    }
  }
}

TEST(Icp, EveryCriterionIsPcls)
{
  const IcpPair pair = readIcpPair("mug", 10);
  const Isometry3d start = isometryOf(0.05 * Vector6d::Ones());
  const auto expectSame = [&](const IcpOptions& options, IcpStop stop) {
    IcpResult ours = pair.run(start, options);
    const IcpResult theirs = pair.runPcl(start, options);
    EXPECT_EQ(ours.stop, stop) << toString(ours.stop);
    EXPECT_EQ(theirs.stop, stop) << toString(theirs.stop);
    EXPECT_EQ(ours.num_iterations, theirs.num_iterations) << toString(stop);
    EXPECT_EQ(ours.has_converged, theirs.has_converged) << toString(stop);
    return ours;
  };
  expectSame(IcpOptions(), IcpStop::MaxIterations);
  IcpOptions options;
  options.max_iterations = 0;
  EXPECT_EQ(expectSame(options, IcpStop::MaxIterations).num_iterations, 1);

  options.max_iterations = 300;
  options.transformation_epsilon = 1e-7;
  expectSame(options, IcpStop::Transformation);
  // The cosine alone decides when it is given.
  options.rotation_epsilon = 1.0 - 1e-9;
  options.transformation_epsilon = 1e-4;
  expectSame(options, IcpStop::Transformation);

  options.rotation_epsilon = 0.0;
  options.transformation_epsilon = 0.0;
  options.euclidean_fitness_epsilon = 0.01;
  expectSame(options, IcpStop::RelativeFitness);
  options.absolute_fitness_epsilon = 1e-5;
  expectSame(options, IcpStop::AbsoluteFitness);

  options.max_distance = 1e-6;
  const IcpResult lost = expectSame(options, IcpStop::TooFewPairs);
  EXPECT_FALSE(lost.has_converged);
  EXPECT_EQ(lost.num_iterations, 0);
  EXPECT_EQ(lost.T_target_source.matrix(), start.matrix());
}

TEST(Icp, TheGateIsInclusive)
{
  const auto source = pcl::make_shared<Cloud>(), target = pcl::make_shared<Cloud>();
  for (const auto& [x, y] : {std::pair(0.f, 0.f), {2.f, 0.f}, {0.f, 2.f}, {2.f, 2.f}}) {
    source->push_back({x, y, 0.f});
    target->push_back({x, y, 0.25f});
  }
  const IcpPair pair(source, target);
  IcpOptions options;
  options.max_distance = 0.25;
  EXPECT_TRUE(pair.run(Isometry3d::Identity(), options).has_converged);
  EXPECT_TRUE(pair.runPcl(Isometry3d::Identity(), options).has_converged);
  // Squared and rounded to float this would be the same gate again.
  options.max_distance = std::nextafter(0.25, 0.0);
  EXPECT_FALSE(pair.run(Isometry3d::Identity(), options).has_converged);
  EXPECT_FALSE(pair.runPcl(Isometry3d::Identity(), options).has_converged);
}

TEST(Icp, FarCoordinatesKeepTheirDigits)
{
  // At 2^20 m a float still has steps of 1/8 m: points on a grid of these are exact.
  Random random(5, 0);
  const Vector3d far(0x1p20, -0x1p20, 0x1p19);
  Eigen::Matrix3Xd source(3, 200);
  for (Eigen::Index i = 0; i < source.cols(); ++i)
    for (int k = 0; k < 3; ++k)
      source(k, i) = far[k] + std::floor(400.0 * random.uniform());
  const KdTree target(source.cast<float>());
  Isometry3d start = Isometry3d::Identity();
  start.translation() = Vector3d(0.25, -0.125, 0.25);
  const IcpResult result = iterativeClosestPoint(source, target, start);
  // Double rounding of the coordinates, and of the rotation times their size.
  const double tolerance = 64.0 * 0x1p-53 * far.norm();
  EXPECT_LT((result.T_target_source * far - far).norm(), tolerance);
}

TEST(Icp, OneTargetPointTurnsNothing)
{
  Random random(6, 0);
  const Eigen::Matrix3Xd source = test::randomPoints(random, 50);
  const KdTree target(Eigen::Matrix3Xf(Eigen::Vector3f(0.3f, -0.7f, 1.1f)));
  const Isometry3d start = isometryOf(0.4 * Vector6d::Ones());
  const Isometry3d end = iterativeClosestPoint(source, target, start).T_target_source;
  EXPECT_LT((end.linear() - start.linear()).norm(), 1e-14);
  EXPECT_LT(
      (end * Vector3d(source.rowwise().mean()) - target.points().col(0).cast<double>())
          .norm(),
      1e-14);
}

TEST(Icp, NothingToMatchIsNotConverged)
{
  const KdTree target(Eigen::Matrix3Xf::Random(3, 20));
  const auto run = [&](const Eigen::Matrix3Xd& source, const Isometry3d& start) {
    return iterativeClosestPoint(source, target, start);
  };
  EXPECT_FALSE(run(Eigen::Matrix3Xd(3, 0), Isometry3d::Identity()).has_converged);
  EXPECT_FALSE(run(Eigen::Matrix3Xd::Zero(3, 2), Isometry3d::Identity()).has_converged);
  Isometry3d broken = Isometry3d::Identity();
  broken.translation().x() = std::nan("");
  const IcpResult result = run(Eigen::Matrix3Xd::Random(3, 20), broken);
  EXPECT_FALSE(result.has_converged);
  EXPECT_EQ(result.num_iterations, 0);
  EXPECT_TRUE(std::isinf(result.mean_squared_distance));
}

} // namespace bayesian_icp
