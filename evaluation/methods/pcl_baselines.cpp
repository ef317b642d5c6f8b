#include "methods/pcl_baselines.h"

#include <pcl/registration/gicp.h>
#include <pcl/registration/icp.h>

#include <algorithm>

namespace bayesian_icp::evaluate {

using Eigen::Index;
using Eigen::Isometry3d;
using Eigen::Matrix3Xd;
using Eigen::Translation3d;
using Eigen::Vector3d;

namespace {

using Point = pcl::PointXYZ;
using Cloud = pcl::PointCloud<Point>;

/** Steps below which a registration has converged [m, rad], and how many it may take:
 * enough that where it stops is no part of its error. */
constexpr double transformation_epsilon = 1e-5;
constexpr int max_steps = 200;

/** Gradient at which GICP's inner solver stops; PCL's 1e-2 leaves 0.1 mm. */
constexpr double gicp_gradient_tolerance = 1e-4;

Point
pointOf(const Vector3d& p)
{
  return Point(
      static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(p.z()));
}

/** Clouds in PCL's single precision, about their centroids. */
struct CentredClouds {
  explicit CentredClouds(const PclProblem& problem)
  : source_centre(problem.source.rowwise().mean())
  , target_centre(problem.target.rowwise().mean())
  {
    for (Index i = 0; i < problem.source.cols(); ++i)
      whole_source->push_back(pointOf(problem.source.col(i) - source_centre));
    for (Index i = 0; i < problem.target.cols(); ++i)
      target->push_back(pointOf(problem.target.col(i) - target_centre));
    for (const std::size_t column : problem.source_columns)
      source->push_back((*whole_source)[column]);
  }

  Eigen::Matrix4f
  centred(const Isometry3d& pose) const
  {
    const Isometry3d moved =
        Translation3d(-target_centre) * pose * Translation3d(source_centre);
    return moved.matrix().cast<float>();
  }

  Isometry3d
  uncentred(const Eigen::Matrix4f& matrix) const
  {
    Isometry3d pose = Isometry3d::Identity();
    pose.linear() = Eigen::Quaterniond(matrix.topLeftCorner<3, 3>().cast<double>())
                        .normalized()
                        .toRotationMatrix();
    pose.translation() = matrix.topRightCorner<3, 1>().cast<double>();
    return Translation3d(target_centre) * pose * Translation3d(-source_centre);
  }

  Vector3d source_centre;
  Vector3d target_centre;
  Cloud::Ptr whole_source{new Cloud};
  Cloud::Ptr source{new Cloud};
  Cloud::Ptr target{new Cloud};
};

PclFit
align(pcl::Registration<Point, Point>& registration,
      const CentredClouds& clouds,
      const Isometry3d& guess,
      int max_iterations = max_steps)
{
  registration.setMaximumIterations(max_iterations);
  Cloud aligned;
  registration.align(aligned, clouds.centred(guess));
  PclFit fit;
  fit.has_converged = registration.hasConverged();
  fit.pose = clouds.uncentred(registration.getFinalTransformation());
  return fit;
}

/** Shows GICP's planes. */
class OpenGicp : public pcl::GeneralizedIterativeClosestPoint<Point, Point> {
public:
  MatricesVectorPtr
  planesOf(const Cloud::ConstPtr& cloud)
  {
    const pcl::search::KdTree<Point>::Ptr tree(new pcl::search::KdTree<Point>);
    tree->setInputCloud(cloud);
    MatricesVectorPtr planes(new MatricesVector);
    computeCovariances<Point>(cloud, tree, *planes);
    return planes;
  }
};

/** Fewer than the neighbourhood of a plane has. */
bool
hasTooFewPoints(const OpenGicp& gicp, const PclProblem& problem)
{
  return std::min(problem.source.cols(), problem.target.cols()) <
         gicp.getCorrespondenceRandomness();
}

/** Planes at the source points that are registered. */
OpenGicp::MatricesVectorPtr
chosen(const OpenGicp::MatricesVector& planes, const std::vector<Eigen::Index>& columns)
{
  OpenGicp::MatricesVectorPtr result(new OpenGicp::MatricesVector);
  for (const std::size_t column : columns)
    result->push_back(planes[column]);
  return result;
}

/** GICP's weights at its result. */
void
matchPlanes(const CentredClouds& clouds,
            const OpenGicp::MatricesVector& source_planes,
            const OpenGicp::MatricesVector& target_planes,
            GicpFit& result)
{
  pcl::search::KdTree<Point> tree;
  tree.setInputCloud(clouds.target);
  const Eigen::Matrix3d R = result.fit.pose.linear();
  pcl::Indices nearest(1);
  std::vector<float> squared_distance(1);
  for (Index i = 0; i < result.moved.cols(); ++i) {
    tree.nearestKSearch(pointOf(result.moved.col(i) - clouds.target_centre),
                        1,
                        nearest,
                        squared_distance);
    result.covariances.push_back(target_planes[static_cast<std::size_t>(nearest[0])] +
                                 R * source_planes[static_cast<std::size_t>(i)] *
                                     R.transpose());
  }
}

} // namespace

PclFit
fitPclIcp(const PclProblem& problem)
{
  const CentredClouds clouds(problem);
  pcl::IterativeClosestPoint<Point, Point> icp;
  icp.setInputSource(clouds.source);
  icp.setInputTarget(clouds.target);
  icp.setTransformationEpsilon(transformation_epsilon *
                               transformation_epsilon); // PCL's is a squared length
  return align(icp, clouds, problem.guess);
}

PclFit
fitPclGicpAsIs(const PclProblem& problem)
{
  constexpr int max_iterations = 50;
  OpenGicp gicp;
  if (hasTooFewPoints(gicp, problem))
    return {false, problem.guess};
  const CentredClouds clouds(problem);
  gicp.setInputSource(clouds.whole_source);
  gicp.setInputTarget(clouds.target);
  return align(gicp, clouds, problem.guess, max_iterations);
}

GicpFit
fitPclGicp(const PclProblem& problem)
{
  GicpFit result;
  OpenGicp gicp;
  if (hasTooFewPoints(gicp, problem))
    return result;
  const CentredClouds clouds(problem);
  const auto source_planes =
      chosen(*gicp.planesOf(clouds.whole_source), problem.source_columns);
  const auto target_planes = gicp.planesOf(clouds.target);
  gicp.setInputSource(clouds.source);
  gicp.setInputTarget(clouds.target);
  gicp.setSourceCovariances(source_planes);
  gicp.setTargetCovariances(target_planes);
  gicp.setTransformationEpsilon(transformation_epsilon);
  gicp.setRotationEpsilon(transformation_epsilon);
  gicp.setTranslationGradientTolerance(gicp_gradient_tolerance);
  gicp.setRotationGradientTolerance(gicp_gradient_tolerance);
  result.fit = align(gicp, clouds, problem.guess);
  result.moved.resize(3, static_cast<Index>(problem.source_columns.size()));
  for (Index i = 0; i < result.moved.cols(); ++i)
    result.moved.col(i) =
        result.fit.pose * problem.source.col(static_cast<Index>(
                              problem.source_columns[static_cast<std::size_t>(i)]));
  matchPlanes(clouds, *source_planes, *target_planes, result);
  return result;
}

} // namespace bayesian_icp::evaluate
