// Shared by the tests of the PCL class: a scan of a bumpy surface and its moved twin.
#pragma once

#include <bayesian_icp/pose.h>
#include <bayesian_icp/random.h>

#include <pcl/common/transforms.h>
#include <pcl/registration/bayesian_icp.h>
#include <pcl/registration/correspondence_rejection_distance.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <limits>
#include <type_traits>
#include <vector>

namespace pcl::test {

using Cloud = PointCloud<PointXYZ>;
using Icp = IterativeClosestPoint<PointXYZ, PointXYZ>;
using BayesianIcp = BayesianIterativeClosestPoint<PointXYZ, PointXYZ>;
using Estimation = registration::CorrespondenceEstimation<PointXYZ, PointXYZ>;
using Tree = search::KdTree<PointXYZ>;
/** PCL's tree has returned whether it has been built since 1.14. */
using Built = decltype(Tree().setInputCloud(Cloud::ConstPtr()));

constexpr float nan_value = std::numeric_limits<float>::quiet_NaN();

/** Points of a smooth surface of 1 m with bumps, seen twice with noise of 1 mm. */
template <typename PointT>
typename PointCloud<PointT>::Ptr
bumpySurface(std::uint64_t seed, std::size_t num_points = 900)
{
  bayesian_icp::Random random(seed, 0);
  typename PointCloud<PointT>::Ptr cloud(new PointCloud<PointT>);
  for (std::size_t i = 0; i < num_points; ++i) {
    const double x = random.uniform() - 0.5, y = random.uniform() - 0.5;
    const double z = 0.15 * std::sin(7.0 * x) * std::cos(5.0 * y) + 0.1 * x * y;
    PointT point;
    point.x = static_cast<float>(x);
    point.y = static_cast<float>(y);
    point.z = static_cast<float>(z + 0.001 * random.normal());
    cloud->push_back(point);
  }
  return (cloud);
}

inline Cloud::Ptr
cloudOf(const Eigen::Matrix3Xd& points)
{
  Cloud::Ptr cloud(new Cloud);
  for (const auto& point : points.cast<float>().colwise())
    cloud->push_back({point.x(), point.y(), point.z()});
  cloud->is_dense = points.allFinite();
  return (cloud);
}

/** A small source-to-target motion. */
inline bayesian_icp::Vector6d
smallPose()
{
  return {0.03, -0.02, 0.01, 0.04, -0.03, 0.05};
}

/** Source and target of a registration whose truth is smallPose(). */
template <typename PointT>
struct Scans {
  typename PointCloud<PointT>::Ptr source = bumpySurface<PointT>(1);
  typename PointCloud<PointT>::Ptr target = bumpySurface<PointT>(2);

  Scans()
  {
    transformPointCloud(
        *target, *target, bayesian_icp::matrixOf(smallPose()).cast<float>().eval());
  }
};

/** A registration with few draws, so that tests of ICP's part are quick. */
template <typename Registration>
void
useFewSamples(Registration& registration)
{
  auto options = registration.getOptions();
  options.chains.num_draws = 40;
  options.paper.batch_size = 20;
  registration.setOptions(options);
}

/** Algorithm 1, which takes its correspondences from what PCL was given. */
template <typename Registration>
void
usePaper(Registration& registration)
{
  useFewSamples(registration);
  registration.setPreset(bayesian_icp::Preset::Paper);
}

/** Silences PCL's messages for the lifetime of this object (the test provokes them). */
class QuietConsole {
public:
  QuietConsole() { console::setVerbosityLevel(console::L_ALWAYS); }
  ~QuietConsole() { console::setVerbosityLevel(console::L_INFO); }
};

/** Registers \p source to \p target.
 * \return the source, moved */
template <typename Registration, typename CloudPtr>
auto
aligned(Registration& icp,
        const CloudPtr& source,
        const CloudPtr& target,
        const typename Registration::Matrix4& guess = Registration::Matrix4::Identity())
{
  icp.setInputSource(source);
  icp.setInputTarget(target);
  std::decay_t<decltype(*source)> output;
  icp.align(output, guess);
  return (output);
}

/** Two scans, and what becomes of the source. */
class ScansTest : public ::testing::Test {
protected:
  void
  align(Icp& icp, const Eigen::Matrix4f& guess = Eigen::Matrix4f::Identity())
  {
    output = aligned(icp, scans.source, scans.target, guess);
  }

  Scans<PointXYZ> scans;
  Cloud output;
  QuietConsole quiet;
};

/** A tree that searches by itself, and counts, as KdTreeNanoflann of PCL 1.15.1 does:
 * it derives from PCL's tree and has null where that one has its FLANN. */
struct OwnSearch : Tree {
  using Tree::nearestKSearch;
  using Tree::radiusSearch;

  OwnSearch() { tree_.reset(); }

  Built
  setInputCloud(const Cloud::ConstPtr& cloud,
                const IndicesConstPtr& indices = IndicesConstPtr()) override
  {
    ++num_builds;
    input_ = cloud;
    indices_ = indices;
    return (searched.setInputCloud(cloud, indices));
  }

  int
  nearestKSearch(const PointXYZ& point,
                 int k,
                 Indices& indices,
                 std::vector<float>& squared_distances) const override
  {
    ++num_queries;
    return (searched.nearestKSearch(point, k, indices, squared_distances));
  }

  int
  radiusSearch(const PointXYZ& point,
               double radius,
               Indices& indices,
               std::vector<float>& squared_distances,
               unsigned int max_nn = 0) const override
  {
    return (searched.radiusSearch(point, radius, indices, squared_distances, max_nn));
  }

  Tree searched;
  int num_builds = 0;
  mutable std::atomic<std::size_t> num_queries{0};
};

/** Distances along z count ten times. */
struct TenfoldHeights : PointRepresentation<PointXYZ> {
  TenfoldHeights() { nr_dimensions_ = 3; }
  void
  copyToFloatArray(const PointXYZ& point, float* out) const override
  {
    out[0] = point.x;
    out[1] = point.y;
    out[2] = 10.0f * point.z;
  }
};

/** The default estimation, counting how often it is asked, and about how many points.
 */
struct CountingEstimation : Estimation {
  void
  determineCorrespondences(Correspondences& pairs, double max_distance) override
  {
    ++num_calls;
    num_points += input_->size();
    Estimation::determineCorrespondences(pairs, max_distance);
  }

  int num_calls = 0;
  std::size_t num_points = 0;
};

/** Every \p step-th point from \p first to the one before \p end. */
inline IndicesPtr
everyNth(index_t first, index_t end, index_t step = 1)
{
  const IndicesPtr indices(new Indices);
  for (index_t i = first; i < end; i += step)
    indices->push_back(i);
  return (indices);
}

inline registration::CorrespondenceRejectorDistance::Ptr
rejectorBeyond(float max_distance)
{
  const auto rejector =
      pcl::make_shared<registration::CorrespondenceRejectorDistance>();
  rejector->setMaximumDistance(max_distance);
  return (rejector);
}

/** Up to a few roundings of numbers below 1 m. */
inline void
expectMoved(const Cloud& actual, const Cloud& source, const Eigen::Matrix4f& motion)
{
  Cloud expected;
  transformPointCloud(source, expected, motion);
  ASSERT_EQ(actual.size(), expected.size());
  for (std::size_t i = 0; i < actual.size(); ++i)
    ASSERT_LT((actual[i].getVector3fMap() - expected[i].getVector3fMap()).norm(),
              1e-6f);
}

inline void
expectSamePoints(const Cloud& actual, const Cloud& expected)
{
  ASSERT_EQ(actual.size(), expected.size());
  for (std::size_t i = 0; i < actual.size(); ++i)
    ASSERT_EQ(actual[i].getVector4fMap(), expected[i].getVector4fMap());
}

} // namespace pcl::test
