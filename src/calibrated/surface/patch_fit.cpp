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
/** For its thickness, a neighbourhood grows to at most one in so many of the cloud's
 * points. With more, it would reach around the edges of a small object. */
constexpr int points_to_neighborhood = 8;
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

/** Limits of SurfacePatch::has_clear_normal: aspectOf(), and the ratio of the points'
 * spread along the second axis to their thickness. Of planes that face along a
 * corridor, nearly all of those where rings lean across its creases fail these limits
 * or min_evenness; of those on cabinets that 32 or 64 rings cover, 80 to 95 % pass. */
constexpr double min_clear_aspect = 0.55, min_clear_width = 1.5;

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

/** \param[in] plane_normal as in fitPatch() */
PrincipalFrame
principalFrame(const PointRows& points, const Vector3d* plane_normal)
{
  PrincipalFrame frame;
  frame.mean = points.colwise().mean().transpose();
  Matrix3d covariance;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j <= i; ++j)
      covariance(i, j) = covariance(j, i) = ((points.col(i).array() - frame.mean[i]) *
                                             (points.col(j).array() - frame.mean[j]))
                                                .sum();
  covariance /= static_cast<double>(points.rows());
  // The normal of the cloud's plane becomes the widest axis, and is left out.
  if (plane_normal)
    covariance += 2.0 * covariance.trace() * *plane_normal * plane_normal->transpose();
  Eigen::SelfAdjointEigenSolver<Matrix3d> solver;
  solver.computeDirect(covariance);
  // Widest axis first.
  frame.axes = solver.eigenvectors().rowwise().reverse();
  frame.variances = solver.eigenvalues().reverse().cwiseMax(0.0);
  if (plane_normal) {
    frame.axes.col(0) = frame.axes.col(1);
    frame.axes.col(1).setZero();
    frame.variances[0] = frame.variances[1];
    frame.variances[1] = 0.0;
  }
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
  const double scale = 1.0 / local.leftCols<2>().cwiseAbs().maxCoeff();
  Eigen::ArrayXf x = (scale * local.col(0)).cast<float>();
  const Eigen::ArrayXf y = (scale * local.col(1)).cast<float>();
  // Of an ellipse that is filled evenly.
  const double area =
      4.0 * M_PI *
      std::sqrt((x - x.mean()).square().mean() * (y - y.mean()).square().mean());
  const Eigen::Index step = std::max<Eigen::Index>(1, num_points / num_evenness_points);
  double sum = 0.0;
  int count = 0;
  for (Eigen::Index i = 0; i < num_points; i += step, ++count) {
    const float here = x[i];
    x[i] = std::numeric_limits<float>::infinity(); // not a neighbour of itself
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

/** Regression of heights on the terms of the plane up to the fourth degree. The plane
 * is scaled to the unit disc. The first rows of Cholesky's factor are those of the
 * regression on the first terms alone, so one factor tests a quadric against a
 * quartic. */
class Regression {
public:
  static constexpr int degree = 4, num_terms = placeOfTerm(degree + 1, 0);
  static constexpr int num_quadric_terms = placeOfTerm(3, 0);

  /** \param[in] quadric_ridge as in Shape */
  Regression(const PointRows& local, double radius, double quadric_ridge)
  {
    Column moments;
    fillNormalMatrix(sumOfProducts(local, radius, moments));
    const auto num_points = static_cast<double>(local.rows());
    for (int k = 0; k < num_terms; ++k)
      factor_(k, k) += num_points * (k < num_quadric_terms ? quadric_ridge : ridge);
    decompose();
    reduced_moments_ = reduced(moments);
  }

  /** The coefficients of the quadric. NaN if the points do not determine them. */
  Vector6d
  quadric() const
  {
    return factor_.topLeftCorner<num_quadric_terms, num_quadric_terms>()
        .triangularView<Eigen::Lower>()
        .transpose()
        .solve(reduced_moments_.head<num_quadric_terms>());
  }

  /** Sum of the squared heights that the first terms explain. */
  double
  explainedBy(int count) const
  {
    return reduced_moments_.head(count).squaredNorm();
  }

  /** Variance of a coefficient of the quadric, for unit noise. */
  double
  varianceOf(int term) const
  {
    return reduced(Column::Unit(term)).head<num_quadric_terms>().squaredNorm();
  }

private:
  /** A scan line leaves terms of a quartic undetermined. */
  static constexpr double ridge = 1e-9;
  static constexpr int num_product_terms = placeOfTerm(2 * degree + 1, 0);
  /** Columns are filled up, so that all have one number of vectors. */
  static constexpr int column_size = num_terms + 1;
  using Column = Eigen::Matrix<double, column_size, 1>;
  /** The last one is zero, for places that fill columns up. */
  using ProductTerms = Eigen::Matrix<double, num_product_terms + 1, 1>;

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
  static constexpr auto&
  at(Array& array, int place)
  {
    return array[static_cast<std::size_t>(place)];
  }

  /** Products of two terms: those up to twice the degree. Points are taken a block at a
   * time, so that the loops over them are vectorised. */
  static ProductTerms
  sumOfProducts(const PointRows& local, double radius, Column& moments)
  {
    constexpr Eigen::Index block_size = 32;
    using Block = Eigen::Array<double, block_size, 1>;
    Eigen::Array<double, num_lanes, num_product_terms + 1> sums;
    Eigen::Array<double, num_lanes, column_size> moment_sums;
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

  /** For each entry of the normal matrix, the place of its product of terms. */
  static constexpr auto
  placesOfProducts()
  {
    std::array<std::uint8_t, column_size * num_terms> places{};
    for (int p = 0; p <= degree; ++p)
      for (int j = 0; j <= p; ++j) {
        const int column = column_size * placeOfTerm(p, j);
        for (int q = 0; q <= degree; ++q)
          for (int k = 0; k <= q; ++k)
            at(places, column + placeOfTerm(q, k)) =
                static_cast<std::uint8_t>(placeOfTerm(p + q, j + k));
        at(places, column + num_terms) = num_product_terms;
      }
    return places;
  }

  void
  fillNormalMatrix(const ProductTerms& sums)
  {
    static constexpr auto places = placesOfProducts();
    std::transform(places.begin(), places.end(), factor_.data(), [&](int place) {
      return sums[place];
    });
  }

  /** Cholesky's factor, in the lower triangle. If the terms are not independent, a
   * pivot makes all that follows NaN or infinite, variances, too. What is above the
   * diagonal is of no use, but one length for all columns is faster. */
  void
  decompose()
  {
    for (int j = 0; j < num_terms; ++j) {
      Column column = factor_.col(j);
      for (int k = 0; k < j; ++k)
        column -= factor_(j, k) * factor_.col(k);
      factor_.col(j) = column / std::sqrt(column[j]);
    }
  }

  /** L^-1 x. */
  Column
  reduced(Column x) const
  {
    Column result = Column::Zero();
    for (int k = 0; k < num_terms; ++k) {
      result[k] = x[k] / factor_(k, k);
      x -= result[k] * factor_.col(k);
    }
    return result;
  }

  Eigen::Matrix<double, column_size, num_terms> factor_;
  Column reduced_moments_;
};

/** Whether a quadric is good enough, however exact the points are. */
bool
isExact(double radius, double sigma)
{
  return sigma < negligible_misfit * radius;
}

/** F statistic of the quartic's extra terms.
 * \param[in] rss of the quadric */
double
misfit(const Regression& regression,
       const Shape& shape,
       double num_points,
       double squared_heights,
       double rss)
{
  constexpr double least_rss = 1e-18;
  const double quartic_rss = std::max(
      least_rss, squared_heights - regression.explainedBy(Regression::num_terms));
  const double extra_terms = shape.num_quartic_terms - shape.num_quadric_terms;
  return (rss - quartic_rss) / extra_terms /
         (quartic_rss / (num_points - shape.num_quartic_terms));
}

/** Make a patch the quadric of the neighbours in its frame, if they lie on one. */
void
fitQuadric(const PointRows& local,
           const Shape& shape,
           double aspect,
           double evenness,
           const SurfaceModelOptions& options,
           SurfacePatch& patch)
{
  const double centroid_offset = local.leftCols<2>().colwise().mean().norm();
  if (!(aspect >= min_aspect &&
        centroid_offset < options.max_centroid_offset * patch.radius &&
        (shape.is_curve || evenness > min_evenness)))
    return;
  const auto num_points = static_cast<double>(local.rows());
  const Regression regression(local, patch.radius, shape.quadric_ridge);
  const double squared_heights = local.col(2).squaredNorm();
  const double rss = std::max(
      0.0, squared_heights - regression.explainedBy(Regression::num_quadric_terms));
  const double sigma = std::sqrt(rss / (num_points - shape.num_quadric_terms));
  const double slope_variance =
      num_points * std::max(regression.varianceOf(1),
                            shape.is_curve ? 0.0 : regression.varianceOf(2));
  const bool is_quadric =
      slope_variance < max_slope_variance &&
      patch.radius > options.min_radius_to_noise * sigma &&
      (isExact(patch.radius, sigma) ||
       (local.rows() >= shape.min_points &&
        misfit(regression, shape, num_points, squared_heights, rss) <
            shape.max_misfit));
  if (!is_quadric)
    return;
  const Vector6d solution = regression.quadric();
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
  const std::optional<Layer> layer = radius < max_radius_of_layers * frame.thickness()
                                         ? ownLayer(ball, frame)
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
    const bool is_thick =
        patch.radius < options.min_radius_to_noise * frame.thickness();
    const bool is_narrow = aspect < wanted_aspect;
    const int next = 2 * growth, next_count = next * shape.num_neighbors;
    const bool can_flatten =
        is_thick && points_to_neighborhood * next_count <= num_points;
    if (!is_too_wide && (can_flatten || is_narrow) && next <= max_growth &&
        next_count <= num_points)
      continue;
    const auto& squared_distances = workspace.nearest.squared_distances;
    spacing =
        squared_distances.size() > 1 ? std::sqrt(double(squared_distances[1])) : 0.0;
    fitPlane(local, frame.thickness(), aspect, patch);
    const double evenness =
        shape.is_curve || !(aspect >= min_aspect) ? 0.0 : evennessOf(local);
    if (is_too_wide || (shape.is_curve && is_thick))
      patch.kind = PatchKind::None;
    else if (neighbors.rows() > shape.num_quadric_terms && patch.radius > 0.0)
      fitQuadric(local, shape, aspect, evenness, options, patch);
    patch.has_clear_normal =
        patch.isUsable() && aspect > min_clear_aspect && evenness > min_evenness &&
        std::sqrt(frame.variances[1]) > min_clear_width * frame.thickness();
    if (patch.kind == PatchKind::Plane && !shape.is_curve)
      doubtCurve(local, workspace, patch);
    return patch;
  }
}

} // namespace bayesian_icp
