#include "class/torture_cases.h"

#include "support/test_support.h"

#include <bayesian_icp/random.h>

#include <cmath>
#include <limits>

namespace bayesian_icp::test {

namespace {

using Eigen::Matrix3Xd;
using Eigen::Vector3d;

constexpr double pi = 3.14159265358979323846;
constexpr double infinity = std::numeric_limits<double>::infinity();

/** Standard deviation of the points' height [m]. */
constexpr double usual_noise = 0.003;

constexpr Eigen::Index num_source_points = 1000;
constexpr Eigen::Index num_target_points = 4000;

/** The part of the surface that a scan sees [m]. */
struct Region {
  double left, right, front, back;
};
constexpr Region whole = {-0.5, 0.5, -0.3, 0.3};
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

/** Points of the surface with noise of the height [m]. */
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

/** The surface scanned twice, a small motion apart. */
TorturePair
usualPair(double noise = usual_noise)
{
  TorturePair pair;
  pair.truth << 0.01, -0.02, 0.015, 0.02, -0.03, 0.025;
  pair.source = scan(1, num_source_points, inner, noise);
  pair.target = moved(pair.truth, scan(2, num_target_points, whole, noise));
  return pair;
}

/** As usualPair(), in a frame whose origin is \p distance off in x and y [m]. */
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

/** As usualPair(), with height (two dimensions left), or height and width (one),
 * replaced by noise [m]. */
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

using Make = std::function<TorturePair(Options&)>;

TorturePair
usual(Options&)
{
  return usualPair();
}

/** A pair that \p change has spoilt. */
Make
spoilt(const std::function<void(TorturePair&)>& change)
{
  return [change](Options&) {
    TorturePair pair = usualPair();
    change(pair);
    return pair;
  };
}

const Expectation right = {Verdict::Right, {{Status::Ok, "the chains mixed"}}};

Expectation
warned(Status status, const char* reason)
{
  return {Verdict::Warned, {{status, reason}}};
}

Expectation
rightButWarned(Status status, const char* reason)
{
  return {Verdict::RightButWarned, {{status, reason}}};
}

Expectation
refused(Status status, const char* reason)
{
  return {Verdict::Refused, {{status, reason}}};
}

/** The same of all presets. */
std::array<Expectation, 3>
everywhere(const Expectation& expected)
{
  return {expected, expected, expected};
}

const Expectation no_such_option = {Verdict::NoSuchOption, {}};

const Expectation not_mixed = warned(Status::NotMixed, "did not mix");
const Expectation too_short = warned(Status::NotMixed, "draws are too few");

const Expectation diverged = warned(Status::Diverged, "chains diverged");

/** Preset paper's chains are chaotic at its own step size: which of the two it is can
 * depend on the processor's last bits. */
const Expectation not_mixed_or_diverged = {
    Verdict::Warned,
    {{Status::NotMixed, "did not mix"}, {Status::Diverged, "chains diverged"}}};

/** The prior of roll, pitch and yaw is singular there, and tears at modes that come
 * within some 1e-4 rad of the pole: the pose can be 2 mm off. */
const Expectation at_the_pole = {
    Verdict::Warned,
    {{Status::NotMixed, "pitch +-90"}, {Status::Doubtful, "pitch +-90"}}};

/** Another truth and guess. */
Make
turned(const Vector6d& truth, const Vector6d& guess)
{
  return spoilt([truth, guess](TorturePair& pair) {
    pair.guess = guess;
    pair.truth = truth;
    pair.target = moved(truth, scan(2, num_target_points, whole, usual_noise));
  });
}

/** Usual clouds and other options. */
Make
with(const std::function<void(Options&)>& change)
{
  return [change](Options& options) {
    change(options);
    return usualPair();
  };
}

Make
withVariance(double value)
{
  return with([value](Options& o) { o.prior.variance.setConstant(value); });
}

Make
withBatchSize(int size)
{
  return with([size](Options& o) { o.exact.batch_size = o.paper.batch_size = size; });
}

/** All lengths multiplied, in the clouds and in the options. */
Make
scaled(double scale)
{
  return [scale](Options& options) {
    options.paper.scale.measurement_sigma *= scale;
    options.exact.scale.measurement_sigma *= scale;
    options.prior.variance.head<3>() *= scale * scale;
    TorturePair pair = usualPair();
    pair.source *= scale;
    pair.target *= scale;
    pair.truth.head<3>() *= scale;
    pair.noise *= scale;
    return pair;
  };
}

/** Clouds that do not belong together. */
Make
unrelated(const std::function<void(TorturePair&)>& change)
{
  return spoilt([change](TorturePair& pair) {
    change(pair);
    pair.has_truth = false;
  });
}

void
makeEqual(Matrix3Xd& cloud)
{
  cloud.colwise() = Vector3d(0.1, 0.05, 0.0);
}

/** Each point so many times in a row. */
void
repeat(Eigen::Index times, Matrix3Xd& cloud)
{
  Matrix3Xd repeated(3, times * cloud.cols());
  for (Eigen::Index i = 0; i < repeated.cols(); ++i)
    repeated.col(i) = cloud.col(i / times);
  cloud = repeated;
}

} // namespace

Options
tortureOptions(Preset preset)
{
  Options options;
  options.preset = preset;
  options.prior.variance.setConstant(0.01);
  options.prior.frame = PriorFrame::SourceCentroid;
  if (preset == Preset::Exact) {
    options.exact.scale.measurement_sigma = 0.005;
    options.exact.scale.effective_points = 150.0;
    options.exact.max_source_points = 500;
    options.chains.num_draws = 1000;
  }
  if (preset == Preset::Paper)
    options.chains.num_draws = 200;
  return options;
}

Options
smallStepOptions()
{
  Options options = tortureOptions(Preset::Paper);
  options.paper.scale.measurement_sigma = 0.03;
  options.paper.sgld.step_size = 3e-9;
  options.paper.batch_size = 40;
  options.paper.thinning = 10;
  options.paper.num_burn_in = 200;
  options.chains.num_draws = 2000;
  return options;
}

std::vector<TortureCase>
tortureCases()
{
  const Make apart =
      unrelated([](TorturePair& pair) { pair.source.row(0).array() += 100.0; });
  return {
      // Of scale.
      {"Usual", "nothing special", usual, {right, right, not_mixed}, right},
      {"Far10km",
       "both clouds 10 km from the origin",
       [](Options&) { return farPair(1e4); },
       {right, right, diverged}},
      {"Utm",
       "both clouds in UTM coordinates, 1000 km from the origin",
       [](Options&) { return farPair(1e6); },
       {warned(Status::Doubtful, "coordinates of 1e+06 m"),
        warned(Status::Doubtful, "coordinates of 1e+06 m"),
        diverged}},
      {"UtmTarget",
       "target in UTM coordinates, guess accordingly",
       spoilt([](TorturePair& pair) {
         const Vector3d shift(1e6, -1e6, 0.0);
         pair.target.colwise() += shift;
         pair.truth.head<3>() += shift;
         pair.guess.head<3>() = shift;
       }),
       {warned(Status::Doubtful, "coordinates of 1e+06 m"),
        warned(Status::Doubtful, "coordinates of 1e+06 m"),
        not_mixed_or_diverged}},
      {"Millimetres", "an object of 1 mm", scaled(1e-3), {right, right, diverged}},
      {"Kilometre", "a terrain of 1 km", scaled(1e3), {right, right, not_mixed}},

      // Of shape.
      {"SourceEqual",
       "all source points equal",
       unrelated([](TorturePair& pair) { makeEqual(pair.source); }),
       {refused(Status::TooFewCorrespondences, "finite covariance"),
        warned(Status::SeveralModes, "a plane or a line"),
        not_mixed_or_diverged}},
      {"TargetEqual",
       "all target points equal",
       unrelated([](TorturePair& pair) { makeEqual(pair.target); }),
       {refused(Status::TooFewCorrespondences, "no surface"),
        warned(Status::Doubtful, "m from the target"),
        not_mixed_or_diverged}},
      {"BothEqual",
       "all points of both clouds equal",
       spoilt([](TorturePair& pair) {
         pair.truth.setZero();
         makeEqual(pair.source);
         makeEqual(pair.target);
       }),
       {refused(Status::TooFewCorrespondences, "no surface"),
        warned(Status::Doubtful, "a plane or a line"),
        diverged}},
      {"Line",
       "a line, with noise",
       [](Options&) { return flattenedPair(1, usual_noise); },
       {refused(Status::TooFewCorrespondences, "a line to within"), right, diverged}},
      {"ExactLine",
       "a line without noise",
       [](Options&) { return flattenedPair(1, 0.0); },
       {refused(Status::TooFewCorrespondences, "surface"),
        warned(Status::Doubtful, "a plane or a line"),
        diverged}},
      {"Plane",
       "a plane, with noise",
       [](Options&) { return flattenedPair(2, usual_noise); },
       {right, warned(Status::NotMixed, "a plane or a line"), not_mixed_or_diverged}},
      {"ExactPlane",
       "a plane without noise",
       [](Options&) { return flattenedPair(2, 0.0); },
       {warned(Status::Doubtful, "clouds without noise"),
        warned(Status::NotMixed, "a plane or a line"),
        not_mixed_or_diverged}},
      {"Mirrored",
       "the source is mirrored",
       unrelated([](TorturePair& pair) { pair.source.row(0) *= -1.0; }),
       // R-hat is near its bound.
       {Expectation{Verdict::Warned,
                    {{Status::Doubtful, "patches of surface"},
                     {Status::NotMixed, "patches of surface"}}},
        warned(Status::Doubtful, "m from the target"),
        not_mixed_or_diverged}},
      {"Random",
       "two clouds of random points",
       unrelated([](TorturePair& pair) {
         Random random(4, 0);
         for (Matrix3Xd* cloud : {&pair.source, &pair.target})
           for (double& coordinate : cloud->reshaped())
             coordinate = random.uniform() - 0.5;
       }),
       {warned(Status::Doubtful, "hold none"),
        warned(Status::Doubtful, "m from the target"),
        not_mixed_or_diverged}},

      // Of overlap.
      {"OnePoint",
       "the clouds share one point, a corner",
       spoilt([](TorturePair& pair) {
         pair.source = scan(1, num_source_points, {0.0, 0.5, 0.0, 0.3}, usual_noise);
         pair.target =
             moved(pair.truth,
                   scan(2, num_target_points, {-0.5, 0.0, -0.3, 0.0}, usual_noise));
       }),
       {warned(Status::Doubtful, "surfaces disagree"),
        warned(Status::Doubtful, "m from the target"),
        not_mixed}},
      {"Disjoint",
       "the clouds are 100 m apart",
       apart,
       {refused(Status::TooFewCorrespondences, "usable surface"), diverged, diverged}},
      {"DisjointGate",
       "the clouds are 100 m apart, gate 0.1 m",
       [apart](Options& options) {
         options.exact.residual.max_distance = 0.1;
         return apart(options);
       },
       {refused(Status::TooFewCorrespondences, "usable surface"),
        refused(Status::TooFewCorrespondences, "maximum correspondence"),
        refused(Status::TooFewCorrespondences, "maximum correspondence")}},
      {"Identical",
       "the target is the source, noise included",
       spoilt([](TorturePair& pair) {
         pair.truth.setZero();
         pair.target = pair.source = scan(2, num_target_points, whole, usual_noise);
       }),
       {right, right, diverged}},
      {"IdenticalExact",
       "the target is the source, without noise",
       spoilt([](TorturePair& pair) {
         pair.truth.setZero();
         pair.target = pair.source = scan(2, num_target_points, whole, 0.0);
       }),
       {right, right, diverged}},
      {"NoNoise",
       "two scans without noise",
       [](Options&) { return usualPair(0.0); },
       {rightButWarned(Status::Doubtful, "clouds without noise"), right, not_mixed},
       right},
      {"TargetTwice",
       "every target point twice",
       spoilt([](TorturePair& pair) { repeat(2, pair.target); }),
       {right, right, not_mixed}},
      {"TargetHundred",
       "every target point a hundred times",
       spoilt([](TorturePair& pair) { repeat(100, pair.target); }),
       {right, right, not_mixed}},
      {"SourceTen",
       "every source point ten times",
       spoilt([](TorturePair& pair) { repeat(10, pair.source); }),
       {right, right, not_mixed_or_diverged},
       right},

      // Of the pose.
      {"YawPlusPi",
       "yaw just below pi, guess just above -pi",
       turned({0.01, -0.02, 0.015, 0.02, -0.03, pi - 0.01},
              {0, 0, 0, 0, 0, -pi + 0.01}),
       {right, right, not_mixed},
       right},
      {"YawMinusPi",
       "yaw just above -pi, guess just below pi",
       turned({0.01, -0.02, 0.015, 0.02, -0.03, -pi + 0.01},
              {0, 0, 0, 0, 0, pi - 0.01}),
       {right, right, not_mixed},
       right},
      {"PitchPlus90",
       "pitch of 90 degrees",
       turned({0.01, -0.02, 0.015, 0, 0.5 * pi, 0}, {0, 0, 0, 0, 0.5 * pi - 0.02, 0}),
       {at_the_pole, rightButWarned(Status::Doubtful, "pitch +-90"), not_mixed}},
      {"PitchMinus90",
       "pitch of -90 degrees",
       turned({0.01, -0.02, 0.015, 0, -0.5 * pi, 0}, {0, 0, 0, 0, -0.5 * pi + 0.02, 0}),
       {Expectation{Verdict::RightButWarned, at_the_pole.outcomes},
        rightButWarned(Status::Doubtful, "pitch +-90"),
        not_mixed}},
      {"Pitch88",
       "pitch of 88 degrees",
       turned({0.01, -0.02, 0.015, 0, 0.5 * pi - 0.035, 0},
              {0, 0, 0, 0, 0.5 * pi - 0.06, 0}),
       {right, right, not_mixed}},

      // Of options.
      {"PriorZero",
       "prior variances of 0",
       withVariance(0.0),
       everywhere(refused(Status::InvalidOptions, "must be positive"))},
      {"PriorInfinite",
       "prior variances of infinity",
       withVariance(infinity),
       {refused(Status::InvalidOptions, "must be finite"), right, not_mixed},
       right},
      {"PriorTiny",
       "prior variances of 1e-12, far from the truth",
       withVariance(1e-12),
       {warned(Status::Doubtful, "surfaces disagree"),
        warned(Status::Doubtful, "m from the target"),
        diverged}},
      {"PriorHuge",
       "prior variances of 1e12",
       withVariance(1e12),
       {right, right, not_mixed}},
      {"BatchZero",
       "mini-batches of 0 points",
       withBatchSize(0),
       {no_such_option,
        refused(Status::InvalidOptions, "batch_size is 0"),
        refused(Status::InvalidOptions, "batch_size is 0")}},
      {"BatchOne",
       "mini-batches of 1 point",
       withBatchSize(1),
       {no_such_option, not_mixed, not_mixed}},
      {"BatchHuge",
       "mini-batches of 2^31 - 1 points",
       withBatchSize(std::numeric_limits<int>::max()),
       {no_such_option, right, not_mixed}},
      {"NoDraws",
       "zero draws",
       with([](Options& options) { options.chains.num_draws = 0; }),
       everywhere(refused(Status::InvalidOptions, "num_draws is 0"))},
      {"OneDraw",
       "one draw of one chain",
       with([](Options& options) {
         options.chains.num_draws = options.chains.num_chains = 1;
       }),
       everywhere(too_short)},
      {"ThreePoints",
       "a source of three points",
       spoilt([](TorturePair& pair) { pair.source = pair.source.leftCols(3).eval(); }),
       {refused(Status::InvalidInput, "needs 30"),
        warned(Status::Doubtful, "a plane or a line"),
        not_mixed_or_diverged}},
      {"HalfNaN",
       "every other source point is NaN",
       spoilt([](TorturePair& pair) {
         for (Eigen::Index i = 0; i < pair.source.cols(); i += 2)
           pair.source(1, i) = std::nan("");
       }),
       {right, right, not_mixed},
       right},
      {"GuessInfinite",
       "a guess that is infinite",
       spoilt([](TorturePair& pair) { pair.guess[0] = infinity; }),
       everywhere(refused(Status::InvalidInput, "not finite"))},
  };
}

} // namespace bayesian_icp::test
