#include "torture_cases.h"

#include <bayesian_icp/random.h>

#include <cmath>
#include <limits>

namespace bayesian_icp {
namespace test {

namespace {

using Eigen::Matrix3Xd;
using Eigen::Vector3d;

constexpr double pi = 3.14159265358979323846;
constexpr double infinity = std::numeric_limits<double>::infinity();
std::function<void(Options&)>
scaledOptions(double scale)
{
  return [scale](Options& options) {
    options.likelihood.measurement_sigma *= scale;
    options.prior.variance.head<3>() *= scale * scale;
  };
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

/** A pair that \p change has spoilt. */
std::function<TorturePair()>
spoilt(const std::function<void(TorturePair&)>& change)
{
  return [change] {
    TorturePair pair = usualPair();
    change(pair);
    return pair;
  };
}

void
unchanged(Options&)
{}

const Expectation right = {Verdict::Right, ""};

Expectation
warned(const char* reason)
{
  return {Verdict::Warned, reason};
}

Expectation
rightButWarned(const char* reason)
{
  return {Verdict::RightButWarned, reason};
}

Expectation
refused(const char* reason)
{
  return {Verdict::Refused, reason};
}

/** Preset paper's chains at its own step size and budget. */
const Expectation as_ever = warned("");

std::vector<TortureCase>
casesOfScale()
{
  return {
      {"Usual",
       "nothing special",
       [] { return usualPair(); },
       unchanged,
       {right, right, as_ever}},
      {"Far10km",
       "both clouds 10 km from the origin",
       [] { return farPair(1e4); },
       unchanged,
       {right, right, as_ever}},
      {"Utm",
       "both clouds in UTM coordinates, 1000 km from the origin",
       [] { return farPair(1e6); },
       unchanged,
       {warned("coordinates of 1e+06 m"), warned("coordinates of 1e+06 m"), as_ever}},
      {"UtmTarget",
       "target in UTM coordinates, guess accordingly",
       spoilt([](TorturePair& pair) {
         const Vector3d shift(1e6, -1e6, 0.0);
         pair.target.colwise() += shift;
         pair.truth.head<3>() += shift;
         pair.guess.head<3>() = shift;
       }),
       unchanged,
       {warned("coordinates of 1e+06 m"), warned("coordinates of 1e+06 m"), as_ever}},
      {"Millimetres",
       "an object of 1 mm",
       [] { return scaledPair(1e-3); },
       scaledOptions(1e-3),
       {right, right, as_ever}},
      {"Kilometre",
       "a terrain of 1 km",
       [] { return scaledPair(1e3); },
       scaledOptions(1e3),
       {right, right, as_ever}},
  };
}

std::vector<TortureCase>
casesOfShape()
{
  return {
      {"SourceEqual",
       "all source points equal",
       spoilt([](TorturePair& pair) {
         makeEqual(pair.source);
         pair.has_truth = false;
       }),
       unchanged,
       {refused("finite covariance"), warned(""), as_ever}},
      {"TargetEqual",
       "all target points equal",
       spoilt([](TorturePair& pair) {
         makeEqual(pair.target);
         pair.has_truth = false;
       }),
       unchanged,
       {refused("no surface"), warned(""), as_ever}},
      {"BothEqual",
       "all points of both clouds equal",
       spoilt([](TorturePair& pair) {
         pair.truth.setZero();
         makeEqual(pair.source);
         makeEqual(pair.target);
       }),
       unchanged,
       {refused("no surface"), warned(""), as_ever}},
      {"Line",
       "a line, with noise",
       [] { return flattenedPair(1, usual_noise); },
       unchanged,
       {right, right, as_ever}},
      {"ExactLine",
       "a line without noise",
       [] { return flattenedPair(1, 0.0); },
       unchanged,
       {refused("surface"), right, as_ever}},
      {"Plane",
       "a plane, with noise",
       [] { return flattenedPair(2, usual_noise); },
       unchanged,
       {right, right, as_ever}},
      {"ExactPlane",
       "a plane without noise",
       [] { return flattenedPair(2, 0.0); },
       unchanged,
       {warned(""), right, as_ever}},
      {"Mirrored",
       "the source is mirrored",
       spoilt([](TorturePair& pair) {
         pair.source.row(0) *= -1.0;
         pair.has_truth = false;
       }),
       unchanged,
       {warned(""), warned(""), as_ever}},
      {"Random",
       "two clouds of random points",
       spoilt([](TorturePair& pair) {
         Random random(4, 0);
         for (Matrix3Xd* cloud : {&pair.source, &pair.target})
           for (Eigen::Index i = 0; i < cloud->size(); ++i)
             cloud->data()[i] = random.uniform() - 0.5;
         pair.has_truth = false;
       }),
       unchanged,
       {warned("hold none"), warned(""), as_ever}},
  };
}

std::vector<TortureCase>
casesOfOverlap()
{
  return {
      {"OnePoint",
       "the clouds share one point, a corner",
       [] {
         TorturePair pair;
         pair.truth = smallMotion();
         pair.source = scan(1, num_source_points, {0.0, 0.5, 0.0, 0.3}, usual_noise);
         pair.target =
             moved(pair.truth,
                   scan(2, num_target_points, {-0.5, 0.0, -0.3, 0.0}, usual_noise));
         return pair;
       },
       unchanged,
       {warned(""), warned(""), as_ever}},
      {"Disjoint",
       "the clouds are 100 m apart",
       spoilt([](TorturePair& pair) {
         pair.source.row(0).array() += 100.0;
         pair.has_truth = false;
       }),
       unchanged,
       {refused("usable surface"), warned(""), as_ever}},
      {"DisjointGate",
       "the clouds are 100 m apart, gate 0.1 m",
       spoilt([](TorturePair& pair) {
         pair.source.row(0).array() += 100.0;
         pair.has_truth = false;
       }),
       [](Options& options) { options.exact.residual.max_distance = 0.1; },
       {refused("maximum correspondence"),
        refused("maximum correspondence"),
        refused("")}},
      {"Identical",
       "the target is the source, noise included",
       spoilt([](TorturePair& pair) {
         pair.truth.setZero();
         pair.target = pair.source = scan(2, num_target_points, whole, usual_noise);
       }),
       unchanged,
       {right, right, as_ever}},
      {"IdenticalExact",
       "the target is the source, without noise",
       spoilt([](TorturePair& pair) {
         pair.truth.setZero();
         pair.target = pair.source = scan(2, num_target_points, whole, 0.0);
       }),
       unchanged,
       {rightButWarned("points lie on the target's surface"), right, as_ever}},
      {"NoNoise",
       "two scans without noise",
       [] { return usualPair(0.0); },
       unchanged,
       {rightButWarned("points lie on the target's surface"), right, as_ever}},
      {"TargetTwice",
       "every target point twice",
       spoilt([](TorturePair& pair) { repeat(2, pair.target); }),
       unchanged,
       {right, right, as_ever}},
      {"TargetHundred",
       "every target point a hundred times",
       spoilt([](TorturePair& pair) { repeat(100, pair.target); }),
       unchanged,
       {right, right, as_ever}},
      {"SourceTen",
       "every source point ten times",
       spoilt([](TorturePair& pair) { repeat(10, pair.source); }),
       unchanged,
       {right, right, as_ever}},
  };
}

std::vector<TortureCase>
casesOfPose()
{
  const auto turned = [](const Vector6d& truth, const Vector6d& guess) {
    return [truth, guess] { return turnedPair(truth, guess); };
  };
  return {
      {"YawPlusPi",
       "yaw just below pi, guess just above -pi",
       turned(pose(0.01, -0.02, 0.015, 0.02, -0.03, pi - 0.01),
              pose(0, 0, 0, 0, 0, -pi + 0.01)),
       unchanged,
       {right, right, as_ever}},
      {"YawMinusPi",
       "yaw just above -pi, guess just below pi",
       turned(pose(0.01, -0.02, 0.015, 0.02, -0.03, -pi + 0.01),
              pose(0, 0, 0, 0, 0, pi - 0.01)),
       unchanged,
       {right, right, as_ever}},
      {"PitchPlus90",
       "pitch of 90 degrees",
       turned(pose(0.01, -0.02, 0.015, 0, 0.5 * pi, 0),
              pose(0, 0, 0, 0, 0.5 * pi - 0.02, 0)),
       unchanged,
       {rightButWarned("pitch +-90"), warned("pitch +-90"), as_ever}},
      {"PitchMinus90",
       "pitch of -90 degrees",
       turned(pose(0.01, -0.02, 0.015, 0, -0.5 * pi, 0),
              pose(0, 0, 0, 0, -0.5 * pi + 0.02, 0)),
       unchanged,
       {rightButWarned("pitch +-90"), warned("pitch +-90"), as_ever}},
      {"Pitch88",
       "pitch of 88 degrees",
       turned(pose(0.01, -0.02, 0.015, 0, 0.5 * pi - 0.035, 0),
              pose(0, 0, 0, 0, 0.5 * pi - 0.06, 0)),
       unchanged,
       {right, right, as_ever}},
  };
}

std::vector<TortureCase>
casesOfOptions()
{
  const auto variance = [](double value) {
    return [value](Options& options) { options.prior.variance.setConstant(value); };
  };
  const auto batch = [](int size) {
    return [size](Options& options) { options.mini_batch.batch_size = size; };
  };
  const auto usual = [] { return usualPair(); };
  return {
      {"PriorZero",
       "prior variances of 0",
       usual,
       variance(0.0),
       {refused("must be positive"),
        refused("must be positive"),
        refused("must be positive")}},
      {"PriorInfinite",
       "prior variances of infinity",
       usual,
       variance(infinity),
       {refused("must be finite"), right, as_ever}},
      {"PriorTiny",
       "prior variances of 1e-12, far from the truth",
       usual,
       variance(1e-12),
       {warned(""), warned(""), as_ever}},
      {"PriorHuge",
       "prior variances of 1e12",
       usual,
       variance(1e12),
       {right, right, as_ever}},
      {"BatchZero",
       "mini-batches of 0 points",
       usual,
       batch(0),
       {refused("batch_size is 0"),
        refused("batch_size is 0"),
        refused("batch_size is 0")}},
      {"BatchOne", "mini-batches of 1 point", usual, batch(1), {right, right, as_ever}},
      {"BatchHuge",
       "mini-batches of 2^31 - 1 points",
       usual,
       batch(std::numeric_limits<int>::max()),
       {right, right, as_ever}},
      {"NoDraws",
       "zero draws",
       usual,
       [](Options& options) { options.chains.num_draws = 0; },
       {refused("num_draws is 0"),
        refused("num_draws is 0"),
        refused("num_draws is 0")}},
      {"OneDraw",
       "one draw of one chain",
       usual,
       [](Options& options) {
         options.chains.num_draws = options.chains.num_chains = 1;
       },
       {warned("did not mix"), warned("did not mix"), as_ever}},
      {"ThreePoints",
       "a source of three points",
       spoilt([](TorturePair& pair) { pair.source = pair.source.leftCols(3).eval(); }),
       unchanged,
       {refused("needs 30"), warned(""), as_ever}},
      {"HalfNaN",
       "every other source point is NaN",
       spoilt([](TorturePair& pair) {
         for (Eigen::Index i = 0; i < pair.source.cols(); i += 2)
           pair.source(1, i) = std::nan("");
       }),
       unchanged,
       {right, right, as_ever}},
      {"GuessInfinite",
       "a guess that is infinite",
       spoilt([](TorturePair& pair) { pair.guess[0] = infinity; }),
       unchanged,
       {refused("not finite"), refused("not finite"), refused("not finite")}},
  };
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
    options.likelihood.measurement_sigma = 0.006;
    options.likelihood.effective_points = 150.0;
    options.exact.max_source_points = 500;
    options.chains.num_draws = 1000;
  }
  if (preset == Preset::Paper)
    options.chains.num_draws = 200;
  return options;
}

std::vector<TortureCase>
tortureCases()
{
  std::vector<TortureCase> all;
  for (const auto& cases : {casesOfScale(),
                            casesOfShape(),
                            casesOfOverlap(),
                            casesOfPose(),
                            casesOfOptions()})
    all.insert(all.end(), cases.begin(), cases.end());
  return all;
}

} // namespace test
} // namespace bayesian_icp
