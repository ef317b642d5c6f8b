#include "patch_fit.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include <nanoflann.hpp>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace bayesian_icp {

using Eigen::Matrix3d;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;
using Eigen::Vector3f;

namespace {

/** A neighbourhood grows to at most this many times num_neighbors to be wider than its
 * noise ... */
constexpr int max_growth_for_noise = 4;
/** ... and to this many to be as wide as ... */
constexpr int max_growth_for_width = 16;
/** ... this ratio of its in-plane standard deviations. */
constexpr double wanted_aspect = 0.35;
/** Patches narrower than this ratio are not usable. */
constexpr double min_aspect = 0.2;
/** A quadric that misses its points by less than this part of the radius is good
 * enough, however exact they are. */
constexpr double negligible_misfit = 1e-3;

/** Points are gathered in a ball and then chosen by their distance in the plane of the
 * surface: a ball prefers, at its rim, points whose noise brings them nearer to its
 * centre, and surfaces would look flatter than they are. */
constexpr double ball_to_neighborhood = 1.5;

constexpr int num_quadric_terms = 6;
constexpr int num_quartic_terms = 15;
/** Points below which the quartic is no test of the quadric. */
constexpr Eigen::Index min_points = 21;

using QuarticTerms = Eigen::Matrix<double, num_quartic_terms, 1>;
using QuarticMatrix = Eigen::Matrix<double, num_quartic_terms, num_quartic_terms>;

/** 1, x, y, x^2, x y, y^2, ... y^4. */
QuarticTerms
quarticTerms(double x, double y)
{
  const double xx = x * x, xy = x * y, yy = y * y;
  QuarticTerms terms;
  terms << 1.0, x, y, xx, xy, yy, xx * x, xx * y, x * yy, yy * y, xx * xx, xx * xy,
      xx * yy, xy * yy, yy * yy;
  return terms;
}

/** Principal axes of a neighbourhood. */
struct PrincipalFrame {
  /** Columns: widest, second, normal. */
  Matrix3d axes;
  /** Standard deviation across the surface [m]. */
  double thickness;
  /** Ratio of the standard deviations in the plane. */
  double aspect;
};

PrincipalFrame
principalFrame(const Matrix3Xd& points)
{
  const Vector3d mean = points.rowwise().mean();
  const Matrix3Xd centred = points.colwise() - mean;
  const Matrix3d covariance =
      centred * centred.transpose() / static_cast<double>(points.cols());
  Eigen::SelfAdjointEigenSolver<Matrix3d> solver;
  solver.computeDirect(covariance);
  PrincipalFrame frame;
  frame.axes << solver.eigenvectors().col(2), solver.eigenvectors().col(1),
      solver.eigenvectors().col(0);
  const Vector3d variances = solver.eigenvalues().cwiseMax(0.0);
  frame.thickness = std::sqrt(variances[0]);
  frame.aspect = variances[2] > 0.0 ? std::sqrt(variances[1] / variances[2]) : 0.0;
  return frame;
}

/** Moments of the regression of heights on quartic terms of the plane, which is scaled
 * to the unit disc. */
struct Regression {
  QuarticMatrix normal_matrix = QuarticMatrix::Zero();
  QuarticTerms moments = QuarticTerms::Zero();
  double squared_heights = 0.0;

  Regression(const Matrix3Xd& local, double radius)
  {
    for (Eigen::Index i = 0; i < local.cols(); ++i) {
      const QuarticTerms terms =
          quarticTerms(local(0, i) / radius, local(1, i) / radius);
      normal_matrix.selfadjointView<Eigen::Lower>().rankUpdate(terms);
      moments += local(2, i) * terms;
      squared_heights += local(2, i) * local(2, i);
    }
    normal_matrix = QuarticMatrix(normal_matrix.selfadjointView<Eigen::Lower>());
  }
};

/** F statistic of the quartic's extra terms. */
double
misfit(const Regression& regression, double quadric_rss, Eigen::Index num_points)
{
  QuarticMatrix matrix = regression.normal_matrix;
  // A scan line leaves some terms undetermined.
  matrix.diagonal().array() += 1e-9 * static_cast<double>(num_points);
  const QuarticTerms solution = matrix.ldlt().solve(regression.moments);
  constexpr double least_rss = 1e-18;
  const double rss = std::max(
      least_rss, regression.squared_heights - solution.dot(regression.moments));
  constexpr double extra_terms = num_quartic_terms - num_quadric_terms;
  return (quadric_rss - rss) / extra_terms /
         (rss / static_cast<double>(num_points - num_quartic_terms));
}

/** Set quadric, sigma and is_usable from the neighbours in the patch's frame. */
void
fitQuadric(const Matrix3Xd& local,
           double aspect,
           const SurfaceModelOptions& options,
           SurfacePatch& patch)
{
  const Eigen::Index num_points = local.cols();
  const Regression regression(local, patch.radius);
  using QuadricMatrix = Eigen::Matrix<double, num_quadric_terms, num_quadric_terms>;
  const QuadricMatrix matrix =
      regression.normal_matrix.topLeftCorner<num_quadric_terms, num_quadric_terms>();
  const Vector6d moments = regression.moments.head<num_quadric_terms>();
  const Vector6d solution = matrix.ldlt().solve(moments);
  const double rss = std::max(0.0, regression.squared_heights - solution.dot(moments));
  const double r = 1.0 / patch.radius;
  patch.quadric = {solution[0],
                   solution[1] * r,
                   solution[2] * r,
                   solution[3] * r * r,
                   solution[4] * r * r,
                   solution[5] * r * r};
  patch.sigma = std::sqrt(rss / static_cast<double>(num_points - num_quadric_terms));
  const double centroid_offset = local.topRows<2>().rowwise().mean().norm();
  const bool is_quadric = patch.sigma < negligible_misfit * patch.radius ||
                          misfit(regression, rss, num_points) < options.max_misfit;
  patch.is_usable = solution.allFinite() && aspect >= min_aspect && is_quadric &&
                    centroid_offset < options.max_centroid_offset * patch.radius &&
                    patch.radius > options.min_radius_to_noise * patch.sigma;
}

/** The \p count points around \p point that are nearest to it in the plane of the
 * surface, relative to it, into workspace.neighbors. */
void
gatherNeighbors(const PointNeighbors& cloud,
                const Vector3f& point,
                int count,
                PatchFitWorkspace& workspace)
{
  cloud.find(point,
             static_cast<std::size_t>(ball_to_neighborhood * count),
             workspace.indices,
             workspace.squared_distances);
  Matrix3Xd ball(3, static_cast<Eigen::Index>(workspace.indices.size()));
  for (Eigen::Index i = 0; i < ball.cols(); ++i)
    ball.col(i) =
        (cloud.points().col(workspace.indices[static_cast<std::size_t>(i)]) - point)
            .cast<double>();
  const Eigen::Matrix<double, 3, 2> plane = principalFrame(ball).axes.leftCols<2>();
  const Eigen::VectorXd squared_distances =
      (plane.transpose() * ball).colwise().squaredNorm();
  auto& order = workspace.order;
  order.resize(workspace.indices.size());
  std::iota(order.begin(), order.end(), Eigen::Index(0));
  count = std::min(count, static_cast<int>(order.size()));
  std::partial_sort(order.begin(),
                    order.begin() + count,
                    order.end(),
                    [&](Eigen::Index a, Eigen::Index b) {
                      return squared_distances[a] < squared_distances[b] ||
                             (squared_distances[a] == squared_distances[b] && a < b);
                    });
  workspace.neighbors.resize(3, count);
  for (int i = 0; i < count; ++i)
    workspace.neighbors.col(i) = ball.col(order[static_cast<std::size_t>(i)]);
}

} // namespace

struct PointNeighbors::Index {
  struct Points {
    const Eigen::Matrix3Xf& matrix;

    std::size_t
    kdtree_get_point_count() const
    {
      return static_cast<std::size_t>(matrix.cols());
    }

    float
    kdtree_get_pt(std::size_t point, std::size_t axis) const
    {
      return matrix(static_cast<Eigen::Index>(axis), static_cast<Eigen::Index>(point));
    }

    template <typename Box>
    bool
    kdtree_get_bbox(Box&) const
    {
      return false;
    }
  };

  explicit Index(const Eigen::Matrix3Xf& points)
  : adaptor{points}
  , tree(3, adaptor, nanoflann::KDTreeSingleIndexAdaptorParams(10))
  {
    tree.buildIndex();
  }

  Points adaptor;
  nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, Points>,
                                      Points,
                                      3,
                                      std::uint32_t>
      tree;
};

PointNeighbors::PointNeighbors(const Eigen::Matrix3Xf& points)
: points_(points)
, index_(std::make_unique<const Index>(points))
{}

PointNeighbors::~PointNeighbors() = default;

void
PointNeighbors::find(const Vector3f& query,
                     std::size_t count,
                     std::vector<std::uint32_t>& indices,
                     std::vector<float>& squared_distances) const
{
  indices.resize(count);
  squared_distances.resize(count);
  const std::size_t found = index_->tree.knnSearch(
      query.data(), count, indices.data(), squared_distances.data());
  indices.resize(found);
  squared_distances.resize(found);
}

SurfacePatch
fitPatch(const PointNeighbors& cloud,
         const Vector3f& point,
         const SurfaceModelOptions& options,
         PatchFitWorkspace& workspace,
         double& spacing)
{
  const int num_points = static_cast<int>(cloud.points().cols());
  SurfacePatch patch;
  patch.origin = patch.centre = point.cast<double>();
  patch.quadric.fill(0.0);
  for (int growth = 1;; growth *= 2) {
    const int count = std::min(growth * options.num_neighbors, num_points);
    gatherNeighbors(cloud, point, count, workspace);
    const Matrix3Xd& neighbors = workspace.neighbors;
    const PrincipalFrame frame = principalFrame(neighbors);
    const Matrix3Xd local = frame.axes.transpose() * neighbors;
    patch.axes = frame.axes;
    patch.radius = std::sqrt(local.topRows<2>().colwise().squaredNorm().maxCoeff());
    const bool is_thick = patch.radius < options.min_radius_to_noise * frame.thickness;
    const bool is_narrow = frame.aspect < wanted_aspect;
    const int next = 2 * growth;
    if (next * options.num_neighbors <= num_points &&
        ((is_thick && next <= max_growth_for_noise) ||
         (is_narrow && next <= max_growth_for_width)))
      continue;
    spacing = workspace.squared_distances.size() > 1
                  ? std::sqrt(double(workspace.squared_distances[1]))
                  : 0.0;
    patch.sigma = frame.thickness;
    patch.is_usable = false;
    if (neighbors.cols() >= min_points && patch.radius > 0.0)
      fitQuadric(local, frame.aspect, options, patch);
    return patch;
  }
}

} // namespace bayesian_icp
