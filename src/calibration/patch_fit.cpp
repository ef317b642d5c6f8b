#include "patch_fit.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>

namespace bayesian_icp {

using Eigen::Matrix3d;
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
/** Neighbourhoods narrower than this ratio are lines. */
constexpr double min_aspect = 0.2;
/** A quadric that misses its points by less than this part of the radius is good
 * enough, however exact they are. */
constexpr double negligible_misfit = 1e-3;

/** Points are gathered in a ball and then chosen by their distance in the plane of the
 * surface: a ball prefers, at its rim, points whose noise brings them nearer to its
 * centre, and surfaces would look flatter than they are. */
constexpr double ball_to_neighborhood = 1.5;

/** A plane has so many points, and is thinner than this part of its radius. */
constexpr Eigen::Index min_plane_points = 8;
constexpr double max_thickness = 0.5;

constexpr int num_quadric_terms = 6;
constexpr int num_quartic_terms = 15;
/** Points below which the quartic is no test of the quadric. */
constexpr Eigen::Index min_points = 21;

using QuarticTerms = Eigen::Matrix<double, num_quartic_terms, 1>;
using QuarticMatrix = Eigen::Matrix<double, num_quartic_terms, num_quartic_terms>;

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
principalFrame(const PointRows& points)
{
  const PointRows centred = points.rowwise() - points.colwise().mean();
  Matrix3d covariance;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j <= i; ++j)
      covariance(i, j) = covariance(j, i) = centred.col(i).dot(centred.col(j));
  covariance /= static_cast<double>(points.rows());
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

/** Place of x^a y^b, a + b = degree, among 1, x, y, x^2, x y, y^2, ... */
constexpr int
placeOfTerm(int degree, int power_of_y)
{
  return degree * (degree + 1) / 2 + power_of_y;
}

/** Normal equations of the regression of heights on quartic terms of the plane, which
 * is scaled to the unit disc. */
struct Regression {
  QuarticMatrix normal_matrix;
  QuarticTerms moments;
  double squared_heights;

  Regression(const PointRows& local, double radius)
  {
    const ProductTerms terms =
        productTerms(local.col(0) / radius, local.col(1) / radius);
    moments = terms.leftCols<num_quartic_terms>().transpose() * local.col(2);
    squared_heights = local.col(2).squaredNorm();
    fillNormalMatrix(terms.colwise().sum());
  }

private:
  static constexpr int max_degree = 4;
  static constexpr int num_product_terms = placeOfTerm(2 * max_degree + 1, 0);
  /** One point a row. */
  using ProductTerms = Eigen::Matrix<double, Eigen::Dynamic, num_product_terms>;

  /** Products of two quartic terms: those up to the eighth degree. */
  static ProductTerms
  productTerms(const Eigen::VectorXd& x, const Eigen::VectorXd& y)
  {
    ProductTerms terms(x.size(), num_product_terms);
    terms.col(0).setOnes();
    for (int degree = 1; degree <= 2 * max_degree; ++degree) {
      const int place = placeOfTerm(degree, 0), lower = placeOfTerm(degree - 1, 0);
      for (int k = 0; k < degree; ++k)
        terms.col(place + k) = x.cwiseProduct(terms.col(lower + k));
      terms.col(place + degree) = y.cwiseProduct(terms.col(place - 1));
    }
    return terms;
  }

  void
  fillNormalMatrix(const Eigen::Matrix<double, 1, num_product_terms>& sums)
  {
    for (int p = 0; p <= max_degree; ++p)
      for (int q = 0; q <= max_degree; ++q)
        for (int j = 0; j <= p; ++j)
          for (int k = 0; k <= q; ++k)
            normal_matrix(placeOfTerm(p, j), placeOfTerm(q, k)) =
                sums[placeOfTerm(p + q, j + k)];
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

/** Make a patch the quadric of the neighbours in its frame, if they lie on one. */
void
fitQuadric(const PointRows& local,
           double aspect,
           const SurfaceModelOptions& options,
           SurfacePatch& patch)
{
  const Eigen::Index num_points = local.rows();
  const Regression regression(local, patch.radius);
  using QuadricMatrix = Eigen::Matrix<double, num_quadric_terms, num_quadric_terms>;
  const QuadricMatrix matrix =
      regression.normal_matrix.topLeftCorner<num_quadric_terms, num_quadric_terms>();
  const Vector6d moments = regression.moments.head<num_quadric_terms>();
  const Vector6d solution = matrix.ldlt().solve(moments);
  const double rss = std::max(0.0, regression.squared_heights - solution.dot(moments));
  const double sigma =
      std::sqrt(rss / static_cast<double>(num_points - num_quadric_terms));
  const double centroid_offset = local.leftCols<2>().colwise().mean().norm();
  // The test of the quadric last: it costs as much as the fit.
  const bool is_quadric =
      solution.allFinite() && aspect >= min_aspect &&
      centroid_offset < options.max_centroid_offset * patch.radius &&
      patch.radius > options.min_radius_to_noise * sigma &&
      (sigma < negligible_misfit * patch.radius ||
       misfit(regression, rss, num_points) < options.max_misfit);
  if (!is_quadric)
    return;
  const double r = 1.0 / patch.radius;
  patch.quadric = {solution[0],
                   solution[1] * r,
                   solution[2] * r,
                   solution[3] * r * r,
                   solution[4] * r * r,
                   solution[5] * r * r};
  patch.sigma = sigma;
  patch.kind = PatchKind::Quadric;
}

/** Make a patch the plane of the neighbours in its frame, if they are a surface at all.
 */
void
fitPlane(const PointRows& local, const PrincipalFrame& frame, SurfacePatch& patch)
{
  const auto num_points = static_cast<double>(local.rows());
  patch.quadric.fill(0.0);
  patch.quadric[0] = local.col(2).mean();
  patch.sigma =
      frame.thickness * std::sqrt(num_points / std::max(1.0, num_points - 3.0));
  const bool is_plane = local.rows() >= min_plane_points && patch.radius > 0.0 &&
                        frame.aspect >= min_aspect &&
                        patch.sigma < max_thickness * patch.radius;
  patch.kind = is_plane ? PatchKind::Plane : PatchKind::None;
}

/** The \p count points around \p point that are nearest to it in the plane of the
 * surface, relative to it, into workspace.neighbors. */
void
gatherNeighbors(const PointNeighbors& cloud,
                const Vector3f& point,
                int count,
                PatchFitWorkspace& workspace)
{
  cloud.find(
      point, static_cast<std::size_t>(ball_to_neighborhood * count), workspace.nearest);
  const auto& indices = workspace.nearest.indices;
  PointRows ball(static_cast<Eigen::Index>(indices.size()), 3);
  for (Eigen::Index i = 0; i < ball.rows(); ++i)
    ball.row(i) = (cloud.points().col(indices[static_cast<std::size_t>(i)]) - point)
                      .cast<double>()
                      .transpose();
  const Matrix3d axes = principalFrame(ball).axes;
  const Eigen::ArrayXd distances = ball.lazyProduct(axes.col(0)).array().square() +
                                   ball.lazyProduct(axes.col(1)).array().square();
  auto& ordered = workspace.ordered;
  ordered.assign(distances.data(), distances.data() + distances.size());
  count = std::min(count, static_cast<int>(ordered.size()));
  std::nth_element(ordered.begin(), ordered.begin() + count - 1, ordered.end());
  const double furthest = ordered[static_cast<std::size_t>(count - 1)];
  workspace.neighbors.resize(count, 3);
  int next = 0;
  for (Eigen::Index i = 0; i < ball.rows() && next < count; ++i)
    if (distances[i] <= furthest)
      workspace.neighbors.row(next++) = ball.row(i);
}

} // namespace

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
  for (int growth = 1;; growth *= 2) {
    const int count = std::min(growth * options.num_neighbors, num_points);
    gatherNeighbors(cloud, point, count, workspace);
    const PointRows& neighbors = workspace.neighbors;
    const PrincipalFrame frame = principalFrame(neighbors);
    const PointRows local = neighbors.lazyProduct(frame.axes);
    patch.axes = frame.axes;
    patch.radius = std::sqrt(local.leftCols<2>().rowwise().squaredNorm().maxCoeff());
    const bool is_thick = patch.radius < options.min_radius_to_noise * frame.thickness;
    const bool is_narrow = frame.aspect < wanted_aspect;
    const int next = 2 * growth;
    if (next * options.num_neighbors <= num_points &&
        ((is_thick && next <= max_growth_for_noise) ||
         (is_narrow && next <= max_growth_for_width)))
      continue;
    const auto& squared_distances = workspace.nearest.squared_distances;
    spacing =
        squared_distances.size() > 1 ? std::sqrt(double(squared_distances[1])) : 0.0;
    fitPlane(local, frame, patch);
    if (neighbors.rows() >= min_points && patch.radius > 0.0)
      fitQuadric(local, frame.aspect, options, patch);
    return patch;
  }
}

} // namespace bayesian_icp
