#include "calibrated/surface/patch_fit.h"

#include "search/bucket_sort.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

namespace bayesian_icp {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Eigen::Vector3f;

namespace {

/** A neighbourhood grows until it is wide enough for its noise and has wanted_aspect,
 * but at most to this multiple of num_neighbors. */
constexpr int max_growth = 16;
/** Smallest aspectOf() at which a neighbourhood stops growing. */
constexpr double wanted_aspect = 0.35;
/** Narrower neighbourhoods are lines. */
constexpr double min_aspect = 0.2;
/** The slopes of a quadric must be known at least as well as from points that evenly
 * fill an ellipse of the smallest aspect. 4 is the variance of a slope in the unit
 * disc, for one point and unit noise. */
constexpr double max_slope_variance = 4.0 / (min_aspect * min_aspect);
/** Smallest ratio of Clark and Evans (1954) of points that cover a quadric: the mean
 * distance of nearest neighbours over that of points scattered at random. Separate scan
 * lines have a smaller ratio, and nothing constrains a quadric between them. */
constexpr double min_evenness = 0.8;
/** Number of points whose nearest neighbours are searched. */
constexpr Eigen::Index num_evenness_points = 32;
/** See isExact(). */
constexpr double negligible_misfit = 1e-3;

/** Number of points gathered in a ball, in units of the neighbourhood. Neighbours are
 * then chosen by their distance in the plane of the surface. At its rim, a ball prefers
 * points whose noise brings them nearer to its centre, and surfaces would look flatter
 * than they are. */
constexpr double ball_to_neighborhood = 1.5;

/** Layers are looked for in a ball with a smaller radius, in units of the points'
 * standard deviation across the surface. In wider ones they are too near each other to
 * matter. */
constexpr double max_radius_of_layers = 16.0;

/** Smallest number of points of a plane, and its largest thickness as a fraction of its
 * radius. */
constexpr Eigen::Index min_plane_points = 8;
constexpr double max_thickness = 0.5;

/** Points with a smaller successionOf() follow a curve. Of sets of 30 scattered points,
 * 2 in a thousand have a smaller one: its deviation is 0.35 (von Neumann 1941). */
constexpr double min_succession = 1.0;
/** Possible error of a plane's slope across the curve that its points follow. */
constexpr double curve_slope_error = 0.03;

/** What is fitted to a neighbourhood. */
struct Shape {
  /** Of a cloud that lies in a plane: no term of y, and no surface to cover. */
  bool is_curve;
  /** Number of points of a neighbourhood. */
  int num_neighbors;
  int num_quadric_terms, num_quartic_terms;
  /** With fewer points, the quartic does not test the quadric, which must be exact. */
  Eigen::Index min_points;
  double max_misfit;
  /** Of the normal matrices, as their share of a point: a scan line leaves terms of a
   * quartic undetermined, and a curve those of y. */
  double quadric_ridge;
};

Shape
surfaceShape(const SurfaceModelOptions& options)
{
  return {false, options.num_neighbors, 6, 15, 21, options.max_misfit, 0.0};
}

/** A curve has as many points on its radius as a surface. Its quartic has two terms
 * more than its parabola; F is as seldom above 4 as that of a surface is above 2.2. */
constexpr Shape curve_shape = {true, 9, 3, 5, 8, 4.0, 1e-9};

/** Principal axes of a neighbourhood. */
struct PrincipalFrame {
  /** Columns: widest, second, normal. The second is zero if the cloud lies in a plane.
   */
  Matrix3d axes;
  /** Standard deviation across the surface [m]. */
  double thickness;
};

/** \param[in] plane_normal as in fitPatch() */
PrincipalFrame
principalFrame(const PointRows& points, const Vector3d* plane_normal)
{
  const Eigen::RowVector3d mean = points.colwise().mean();
  Matrix3d covariance;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j <= i; ++j)
      covariance(i, j) = covariance(j, i) =
          ((points.col(i).array() - mean[i]) * (points.col(j).array() - mean[j])).sum();
  covariance /= static_cast<double>(points.rows());
  // The normal of the cloud's plane becomes the widest axis, and is left out.
  if (plane_normal)
    covariance += 2.0 * covariance.trace() * *plane_normal * plane_normal->transpose();
  Eigen::SelfAdjointEigenSolver<Matrix3d> solver;
  solver.computeDirect(covariance);
  PrincipalFrame frame;
  if (plane_normal)
    frame.axes << solver.eigenvectors().col(1), Vector3d::Zero(),
        solver.eigenvectors().col(0);
  else
    frame.axes << solver.eigenvectors().col(2), solver.eigenvectors().col(1),
        solver.eigenvectors().col(0);
  frame.thickness = std::sqrt(std::max(0.0, solver.eigenvalues()[0]));
  return frame;
}

/** Ratio of the points' spread in the plane, across the parabola along the widest axis
 * that fits them best, to that along the axis. Scan lines are bent. A bent line seems
 * to have a width, but does not determine the slope across it.
 * \param[in] local in the principal frame */
double
aspectOf(const PointRows& local)
{
  const auto x = local.col(0).array() - local.col(0).mean();
  const double spread = x.square().sum();
  if (!(spread > 0.0))
    return 0.0;
  // Second axis and parabola without what a line explains; the axes are uncorrelated.
  const auto y = local.col(1).array() - local.col(1).mean();
  const auto parabola = x.square() - x.square().mean();
  const auto bend = parabola - x * ((parabola * x).sum() / spread);
  const double size = bend.square().sum();
  const double along_bend = (bend * y).sum();
  const double explained = size > 0.0 ? along_bend * along_bend / size : 0.0;
  return std::sqrt(std::max(0.0, y.square().sum() - explained) / spread);
}

/** Von Neumann's (1941) ratio of the points' positions across the widest axis, in their
 * order along it: the mean square of the steps from one to the next over the variance.
 * It is 2 if the points scatter, and near 0 if they follow a curve, however it bends.
 * \param[in] local in the principal frame */
double
successionOf(const PointRows& local, PatchFitWorkspace& workspace)
{
  auto& places = workspace.places;
  places.resize(static_cast<std::size_t>(local.rows()));
  for (std::size_t i = 0; i < places.size(); ++i)
    places[i] = {local(static_cast<Eigen::Index>(i), 0),
                 local(static_cast<Eigen::Index>(i), 1)};
  const double low = local.col(0).minCoeff();
  const double scale = 1.0 / (local.col(0).maxCoeff() - low);
  const auto& ordered = workspace.ordered_places;
  sortInBuckets(
      places,
      [&](const auto& place) {
        return std::isfinite(scale) ? std::min((place.first - low) * scale, 1.0) : 0.0;
      },
      workspace.ordered_places,
      workspace.buckets);
  double sum = 0.0;
  for (std::size_t i = 1; i < ordered.size(); ++i) {
    const double step = ordered[i].second - ordered[i - 1].second;
    sum += step * step;
  }
  const double spread = (local.col(1).array() - local.col(1).mean()).square().sum();
  return spread > 0.0 ? sum / spread : 0.0;
}

/** Clark and Evans' ratio: 1 for points at random, 2 for a square grid, less if they
 * are on lines.
 * \param[in] local in the principal frame */
double
evennessOf(const PointRows& local)
{
  const Eigen::Index num_points = local.rows();
  Eigen::ArrayXd x = local.col(0);
  const auto y = local.col(1).array();
  // Of an ellipse that is filled evenly.
  constexpr double pi = 3.14159265358979323846;
  const double area =
      4.0 * pi *
      std::sqrt((x - x.mean()).square().mean() * (y - y.mean()).square().mean());
  const Eigen::Index step = std::max<Eigen::Index>(1, num_points / num_evenness_points);
  double sum = 0.0;
  int count = 0;
  for (Eigen::Index i = 0; i < num_points; i += step, ++count) {
    const double here = x[i];
    x[i] = std::numeric_limits<double>::infinity(); // not a neighbour of itself
    sum += std::sqrt(((x - here).square() + (y - y[i]).square()).minCoeff());
    x[i] = here;
  }
  return sum / count / (0.5 * std::sqrt(area / static_cast<double>(num_points)));
}

/** Place of x^a y^b, a + b = degree, among 1, x, y, x^2, x y, y^2, ... */
constexpr int
placeOfTerm(int degree, int power_of_y)
{
  return degree * (degree + 1) / 2 + power_of_y;
}

/** Regression of heights on the terms of the plane up to a degree, 2 or 4. The plane is
 * scaled to the unit disc. */
template <int degree>
class Regression {
public:
  static constexpr int num_terms = placeOfTerm(degree + 1, 0);
  using Terms = Eigen::Matrix<double, num_terms, 1>;

  /** \param[in] ridge added to the squares of the terms, for each point: a scan line
   * leaves some terms undetermined */
  Regression(const PointRows& local, double radius, double ridge)
  {
    Terms moments;
    fillNormalMatrix(sumOfProducts(local, radius, moments));
    factor_.diagonal().array() += ridge * static_cast<double>(local.rows());
    decompose();
    reduced_moments_ = reduced(moments);
  }

  /** NaN if the points do not determine it. */
  Terms
  solution() const
  {
    return factor_.template triangularView<Eigen::Lower>().transpose().solve(
        reduced_moments_);
  }

  /** Sum of the squared heights that the terms explain. */
  double
  explained() const
  {
    return reduced_moments_.squaredNorm();
  }

  /** Variance of a coefficient, for unit noise. */
  double
  varianceOf(int term) const
  {
    return reduced(Terms::Unit(term)).squaredNorm();
  }

private:
  static constexpr int num_product_terms = placeOfTerm(2 * degree + 1, 0);
  using ProductTerms = Eigen::Matrix<double, num_product_terms, 1>;

  /** Products of two terms: those up to twice the degree. Points are taken a block at a
   * time, so that the loops over them are vectorised. */
  static ProductTerms
  sumOfProducts(const PointRows& local, double radius, Terms& moments)
  {
    constexpr Eigen::Index block_size = 32;
    using Block = Eigen::Array<double, block_size, 1>;
    Eigen::Array<double, num_lanes, num_product_terms> sums;
    Eigen::Array<double, num_lanes, num_terms> moment_sums;
    sums.setZero();
    moment_sums.setZero();
    const double scale = 1.0 / radius;
    for (Eigen::Index begin = 0; begin < local.rows(); begin += block_size) {
      const Eigen::Index size = std::min(block_size, local.rows() - begin);
      Block x = Block::Zero(), y = x, z = x;
      x.head(size) = local.col(0).segment(begin, size) * scale;
      y.head(size) = local.col(1).segment(begin, size) * scale;
      z.head(size) = local.col(2).segment(begin, size);
      // The terms of one degree.
      std::array<Block, 2 * degree + 1> terms;
      terms[0].setZero();
      terms[0].head(size).setOnes();
      for (int d = 0; d <= 2 * degree; ++d) {
        if (d > 0)
          at(terms, d) = y * at(terms, d - 1);
        for (int k = 0; k < d; ++k)
          at(terms, k) *= x;
        for (int k = 0; k <= d; ++k) {
          addLanes(at(terms, k), sums.col(placeOfTerm(d, k)));
          if (d <= degree)
            addLanes(at(terms, k) * z, moment_sums.col(placeOfTerm(d, k)));
        }
      }
    }
    moments = moment_sums.colwise().sum().transpose();
    return sums.colwise().sum().transpose();
  }

  static constexpr Eigen::Index num_lanes = 4;

  /** Add every fourth number. */
  template <typename Numbers, typename Sums>
  static void
  addLanes(const Numbers& numbers, Sums&& sums)
  {
    Eigen::Array<double, num_lanes, 1> lanes = sums;
    for (Eigen::Index i = 0; i < numbers.size(); i += num_lanes)
      lanes += numbers.template segment<num_lanes>(i);
    sums = lanes;
  }

  template <typename Array>
  static auto&
  at(Array& array, int place)
  {
    return array[static_cast<std::size_t>(place)];
  }

  void
  fillNormalMatrix(const ProductTerms& sums)
  {
    for (int p = 0; p <= degree; ++p)
      for (int q = 0; q <= degree; ++q)
        for (int j = 0; j <= p; ++j)
          for (int k = 0; k <= q; ++k)
            factor_(placeOfTerm(p, j), placeOfTerm(q, k)) =
                sums[placeOfTerm(p + q, j + k)];
  }

  /** Cholesky's factor, in the lower triangle. If the terms are not independent, a
   * pivot makes all that follows NaN or infinite, variances, too. */
  void
  decompose()
  {
    for (int k = 0; k < num_terms; ++k) {
      const int below = num_terms - k - 1;
      factor_(k, k) = std::sqrt(factor_(k, k));
      factor_.col(k).tail(below) /= factor_(k, k);
      for (int j = k + 1; j < num_terms; ++j)
        factor_.col(j).tail(num_terms - j) -=
            factor_(j, k) * factor_.col(k).tail(num_terms - j);
    }
  }

  /** L^-1 x. */
  Terms
  reduced(Terms x) const
  {
    for (int k = 0; k < num_terms; ++k) {
      x[k] /= factor_(k, k);
      x.tail(num_terms - k - 1) -= x[k] * factor_.col(k).tail(num_terms - k - 1);
    }
    return x;
  }

  Eigen::Matrix<double, num_terms, num_terms> factor_;
  Terms reduced_moments_;
};

/** Whether a quadric is good enough, however exact the points are. */
bool
isExact(double radius, double sigma)
{
  return sigma < negligible_misfit * radius;
}

/** F statistic of the quartic's extra terms. */
double
misfit(const PointRows& local,
       const Shape& shape,
       double radius,
       double squared_heights,
       double quadric_rss)
{
  constexpr double ridge = 1e-9, least_rss = 1e-18;
  const Regression<4> quartic(local, radius, ridge);
  const double rss = std::max(least_rss, squared_heights - quartic.explained());
  const double extra_terms = shape.num_quartic_terms - shape.num_quadric_terms;
  return (quadric_rss - rss) / extra_terms /
         (rss / static_cast<double>(local.rows() - shape.num_quartic_terms));
}

/** Make a patch the quadric of the neighbours in its frame, if they lie on one. */
void
fitQuadric(const PointRows& local,
           const Shape& shape,
           double aspect,
           const SurfaceModelOptions& options,
           SurfacePatch& patch)
{
  const double centroid_offset = local.leftCols<2>().colwise().mean().norm();
  if (!(aspect >= min_aspect &&
        centroid_offset < options.max_centroid_offset * patch.radius))
    return;
  const auto num_points = static_cast<double>(local.rows());
  const Regression<2> quadric(local, patch.radius, shape.quadric_ridge);
  const double squared_heights = local.col(2).squaredNorm();
  const double rss = std::max(0.0, squared_heights - quadric.explained());
  const double sigma = std::sqrt(rss / (num_points - shape.num_quadric_terms));
  const double slope_variance =
      num_points *
      std::max(quadric.varianceOf(1), shape.is_curve ? 0.0 : quadric.varianceOf(2));
  // The costliest tests are last.
  const bool is_quadric =
      slope_variance < max_slope_variance &&
      patch.radius > options.min_radius_to_noise * sigma &&
      (isExact(patch.radius, sigma) || local.rows() >= shape.min_points) &&
      (shape.is_curve || evennessOf(local) > min_evenness) &&
      (isExact(patch.radius, sigma) ||
       misfit(local, shape, patch.radius, squared_heights, rss) < shape.max_misfit);
  if (!is_quadric)
    return;
  const Vector6d solution = quadric.solution();
  if (!solution.allFinite())
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
fitPlane(const PointRows& local, double thickness, double aspect, SurfacePatch& patch)
{
  const auto num_points = static_cast<double>(local.rows());
  patch.quadric.fill(0.0);
  patch.quadric[0] = local.col(2).mean();
  patch.sigma = thickness * std::sqrt(num_points / std::max(1.0, num_points - 3.0));
  const bool is_plane = local.rows() >= min_plane_points && patch.radius > 0.0 &&
                        aspect >= min_aspect &&
                        patch.sigma < max_thickness * patch.radius;
  patch.kind = is_plane ? PatchKind::Plane : PatchKind::None;
}

/** Widen the noise of a plane whose points follow a curve, because the plane may lean
 * across it. */
void
doubtCurve(const PointRows& local, PatchFitWorkspace& workspace, SurfacePatch& patch)
{
  patch.follows_curve = successionOf(local, workspace) < min_succession;
  if (patch.follows_curve)
    patch.sigma = std::hypot(patch.sigma, curve_slope_error * patch.radius);
}

/** The \p count points nearest to \p point, relative to it, into workspace.ball. */
void
gatherBall(const PointNeighbors& cloud,
           const Vector3f& point,
           double count,
           PatchFitWorkspace& workspace)
{
  cloud.find(point, static_cast<std::size_t>(count), workspace.nearest);
  const auto& indices = workspace.nearest.indices;
  PointRows& ball = workspace.ball;
  ball.resize(static_cast<Eigen::Index>(indices.size()), 3);
  for (Eigen::Index i = 0; i < ball.rows(); ++i)
    ball.row(i) = (cloud.points().col(indices[static_cast<std::size_t>(i)]) - point)
                      .cast<double>()
                      .transpose();
}

/** The \p count points around \p point that are nearest to it in the plane of the
 * surface, relative to it, into workspace.neighbors. If there are two layers, they are
 * in that of \p point. */
void
gatherNeighbors(const PointNeighbors& cloud,
                const Vector3f& point,
                const Vector3d* plane_normal,
                int count,
                PatchFitWorkspace& workspace)
{
  const double wanted = ball_to_neighborhood * count;
  gatherBall(cloud, point, wanted, workspace);
  PointRows& ball = workspace.ball;
  const PrincipalFrame frame = principalFrame(ball, plane_normal);
  Matrix3d axes = frame.axes;
  const double radius = std::sqrt(double(workspace.nearest.squared_distances.back()));
  const std::optional<Layer> layer = radius < max_radius_of_layers * frame.thickness
                                         ? ownLayer(ball, axes)
                                         : std::nullopt;
  if (layer) {
    const auto num_both = static_cast<double>(ball.rows());
    keepLayer(*layer, ball);
    const double share = static_cast<double>(ball.rows()) / num_both;
    gatherBall(cloud, point, wanted / share, workspace);
    keepLayer(*layer, ball);
    axes = principalFrame(ball, plane_normal).axes;
  }
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

bool
isExactQuadric(const SurfacePatch& patch)
{
  return patch.kind == PatchKind::Quadric && isExact(patch.radius, patch.sigma);
}

SurfacePatch
fitPatch(const PointNeighbors& cloud,
         const Vector3f& point,
         const Vector3d* plane_normal,
         double max_radius,
         const SurfaceModelOptions& options,
         PatchFitWorkspace& workspace,
         double& spacing)
{
  const int num_points = static_cast<int>(cloud.points().cols());
  const Shape shape = plane_normal ? curve_shape : surfaceShape(options);
  SurfacePatch patch;
  patch.origin = patch.centre = point.cast<double>();
  for (int growth = 1;; growth *= 2) {
    const int count = std::min(growth * shape.num_neighbors, num_points);
    gatherNeighbors(cloud, point, plane_normal, count, workspace);
    const PointRows& neighbors = workspace.neighbors;
    const PrincipalFrame frame = principalFrame(neighbors, plane_normal);
    const PointRows local = neighbors.lazyProduct(frame.axes);
    const double aspect = shape.is_curve ? 1.0 : aspectOf(local);
    patch.axes = frame.axes;
    patch.radius = std::sqrt(local.leftCols<2>().rowwise().squaredNorm().maxCoeff());
    const bool is_too_wide = patch.radius > max_radius;
    const bool is_thick = patch.radius < options.min_radius_to_noise * frame.thickness;
    const bool is_narrow = aspect < wanted_aspect;
    const int next = 2 * growth;
    if (!is_too_wide && (is_thick || is_narrow) && next <= max_growth &&
        next * shape.num_neighbors <= num_points)
      continue;
    const auto& squared_distances = workspace.nearest.squared_distances;
    spacing =
        squared_distances.size() > 1 ? std::sqrt(double(squared_distances[1])) : 0.0;
    fitPlane(local, frame.thickness, aspect, patch);
    if (is_too_wide || (shape.is_curve && is_thick))
      patch.kind = PatchKind::None;
    else if (neighbors.rows() > shape.num_quadric_terms && patch.radius > 0.0)
      fitQuadric(local, shape, aspect, options, patch);
    if (patch.kind == PatchKind::Plane && !shape.is_curve)
      doubtCurve(local, workspace, patch);
    return patch;
  }
}

} // namespace bayesian_icp
