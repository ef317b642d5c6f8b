// ICP without PCL against pcl::IterativeClosestPoint: steps, ends, criteria.
#include "baselines/iterative_closest_point.h"
#include "geometry/twist.h"
#include "support/test_support.h"

#include <pcl/io/pcd_io.h>
#include <pcl/registration/icp.h>
#include <pcl/point_types.h>

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>

namespace bayesian_icp {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

using Cloud = pcl::PointCloud<pcl::PointXYZ>;

/** PCL's ICP in double, which moves its cloud in float all the same. */
class PclIcp : public pcl::IterativeClosestPoint<pcl::PointXYZ, pcl::PointXYZ, double> {
public:
  int
  numIterations() const
  {
    return nr_iterations_;
  }
};

using Criteria = pcl::registration::DefaultConvergenceCriteria<double>;

/** Each of our ends, and PCL's state for it. */
constexpr std::pair<IcpStop, int> states[] = {
    {IcpStop::TooFewPairs, Criteria::CONVERGENCE_CRITERIA_NO_CORRESPONDENCES},
    {IcpStop::MaxIterations, Criteria::CONVERGENCE_CRITERIA_ITERATIONS},
    {IcpStop::Transformation, Criteria::CONVERGENCE_CRITERIA_TRANSFORM},
    {IcpStop::AbsoluteFitness, Criteria::CONVERGENCE_CRITERIA_ABS_MSE},
    {IcpStop::RelativeFitness, Criteria::CONVERGENCE_CRITERIA_REL_MSE}};

Eigen::Matrix3Xf
matrixOfCloud(const Cloud& cloud)
{
  return cloud.getMatrixXfMap().topRows<3>();
}

/** Two clouds in PCL's form and in ours. */
struct IcpPair {
  Cloud::Ptr source_cloud;
  Cloud::Ptr target_cloud;
  Eigen::Matrix3Xd source;
  KdTree target;

  IcpPair(const Cloud::Ptr& source_points, const Cloud::Ptr& target_points)
  : source_cloud(source_points)
  , target_cloud(target_points)
  , source(matrixOfCloud(*source_points).cast<double>())
  , target(matrixOfCloud(*target_points))
  {}

  /** PCL's run, in our words. */
  IcpResult
  runPcl(const Isometry3d& start, const IcpOptions& options) const
  {
    PclIcp icp;
    icp.setInputSource(source_cloud);
    icp.setInputTarget(target_cloud);
    icp.setMaximumIterations(options.max_iterations);
    if (std::isfinite(options.max_distance))
      icp.setMaxCorrespondenceDistance(options.max_distance);
    icp.setTransformationEpsilon(options.transformation_epsilon);
    // PCL 1.13 takes the other epsilon's where there is none, and later ones 0.99999.
    icp.setTransformationRotationEpsilon(options.rotation_epsilon > 0.0
                                             ? options.rotation_epsilon
                                             : 1.0 - options.transformation_epsilon);
    icp.setEuclideanFitnessEpsilon(options.euclidean_fitness_epsilon);
    icp.getConvergeCriteria()->setAbsoluteMSE(options.absolute_fitness_epsilon);
    Cloud moved;
    icp.align(moved, start.matrix());
    IcpResult result;
    result.T_target_source = Isometry3d(icp.getFinalTransformation());
    result.num_iterations = icp.numIterations();
    result.has_converged = icp.hasConverged();
    for (const auto& [stop, state] : states)
      if (state == icp.getConvergeCriteria()->getConvergenceState())
        result.stop = stop;
    return result;
  }

  IcpResult
  run(const Isometry3d& start, const IcpOptions& options) const
  {
    return iterativeClosestPoint(source, target, start, options);
  }

  /** Largest distance of a source point moved by one pose from where the other has it.
   */
  double
  distance(const Isometry3d& a, const Isometry3d& b) const
  {
    return (a * source - b * source).colwise().norm().maxCoeff();
  }
};

/** A pair of data/, both clouds thinned to every \p step-th point. */
IcpPair
readIcpPair(const std::string& name, std::size_t step)
{
  const auto read = [&](const std::string& file) {
    Cloud all;
    EXPECT_EQ(pcl::io::loadPCDFile(BAYESIAN_ICP_DATA_DIR "/" + name + "/" + file, all),
              0);
    const auto thinned = pcl::make_shared<Cloud>();
    for (std::size_t i = 0; i < all.size(); i += step)
      thinned->push_back(all[i]);
    return thinned;
  };
  return {read("source.pcd"), read("target.pcd")};
}

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

/** How far apart PCL and we may put a point [m]: floats of a metre resolve 1e-7 m, and
 * one of hundreds of neighbours that rounding swaps moves all by about this. */
constexpr double tolerance = 1e-5;

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
        const Isometry3d ours = pair.run(pose, options).T_target_source;
        const Isometry3d theirs = pair.runPcl(pose, options).T_target_source;
        SCOPED_TRACE(named.name + std::string(", gate ") + std::to_string(named.gate));
        EXPECT_LT(pair.distance(ours, theirs), tolerance);
        EXPECT_GT(pair.distance(ours, pose), 10.0 * tolerance);
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
      EXPECT_LT(pair.distance(ours.T_target_source, theirs.T_target_source), tolerance);
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
