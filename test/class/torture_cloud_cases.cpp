// Clouds of odd scale, shape and overlap.
#include "class/torture_words.h"

#include <bayesian_icp/random.h>

namespace bayesian_icp {
namespace test {

namespace {

using Eigen::Matrix3Xd;
using Eigen::Vector3d;

std::function<void(Options&)>
scaledOptions(double scale)
{
  return [scale](Options& options) {
    options.paper.scale.measurement_sigma *= scale;
    options.exact.scale.measurement_sigma *= scale;
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

std::vector<TortureCase>
casesOfScale()
{
  return {
      {"Usual",
       "nothing special",
       [] { return usualPair(); },
       unchanged,
       {right, right, not_mixed},
       right},
      {"Far10km",
       "both clouds 10 km from the origin",
       [] { return farPair(1e4); },
       unchanged,
       {right, right, diverged}},
      {"Utm",
       "both clouds in UTM coordinates, 1000 km from the origin",
       [] { return farPair(1e6); },
       unchanged,
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
       unchanged,
       {warned(Status::Doubtful, "coordinates of 1e+06 m"),
        warned(Status::Doubtful, "coordinates of 1e+06 m"),
        not_mixed_or_diverged}},
      {"Millimetres",
       "an object of 1 mm",
       [] { return scaledPair(1e-3); },
       scaledOptions(1e-3),
       {right, right, diverged}},
      {"Kilometre",
       "a terrain of 1 km",
       [] { return scaledPair(1e3); },
       scaledOptions(1e3),
       {right, right, not_mixed}},
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
       {refused(Status::TooFewCorrespondences, "finite covariance"),
        warned(Status::SeveralModes, "a plane or a line"),
        not_mixed_or_diverged}},
      {"TargetEqual",
       "all target points equal",
       spoilt([](TorturePair& pair) {
         makeEqual(pair.target);
         pair.has_truth = false;
       }),
       unchanged,
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
       unchanged,
       {refused(Status::TooFewCorrespondences, "no surface"),
        warned(Status::Doubtful, "a plane or a line"),
        diverged}},
      {"Line",
       "a line, with noise",
       [] { return flattenedPair(1, usual_noise); },
       unchanged,
       {refused(Status::TooFewCorrespondences, "a line to within"), right, diverged}},
      {"ExactLine",
       "a line without noise",
       [] { return flattenedPair(1, 0.0); },
       unchanged,
       {refused(Status::TooFewCorrespondences, "surface"),
        warned(Status::Doubtful, "a plane or a line"),
        diverged}},
      {"Plane",
       "a plane, with noise",
       [] { return flattenedPair(2, usual_noise); },
       unchanged,
       {right, warned(Status::NotMixed, "a plane or a line"), not_mixed_or_diverged}},
      {"ExactPlane",
       "a plane without noise",
       [] { return flattenedPair(2, 0.0); },
       unchanged,
       {warned(Status::Doubtful, "clouds without noise"),
        warned(Status::NotMixed, "a plane or a line"),
        not_mixed_or_diverged}},
      {"Mirrored",
       "the source is mirrored",
       spoilt([](TorturePair& pair) {
         pair.source.row(0) *= -1.0;
         pair.has_truth = false;
       }),
       unchanged,
       {warned(Status::Doubtful, "patches of surface"),
        warned(Status::Doubtful, "m from the target"),
        not_mixed_or_diverged}},
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
       {warned(Status::Doubtful, "hold none"),
        warned(Status::Doubtful, "m from the target"),
        not_mixed_or_diverged}},
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
       {warned(Status::Doubtful, "surfaces disagree"),
        warned(Status::Doubtful, "m from the target"),
        not_mixed}},
      {"Disjoint",
       "the clouds are 100 m apart",
       spoilt([](TorturePair& pair) {
         pair.source.row(0).array() += 100.0;
         pair.has_truth = false;
       }),
       unchanged,
       {refused(Status::TooFewCorrespondences, "usable surface"), diverged, diverged}},
      {"DisjointGate",
       "the clouds are 100 m apart, gate 0.1 m",
       spoilt([](TorturePair& pair) {
         pair.source.row(0).array() += 100.0;
         pair.has_truth = false;
       }),
       [](Options& options) { options.exact.residual.max_distance = 0.1; },
       {refused(Status::TooFewCorrespondences, "usable surface"),
        refused(Status::TooFewCorrespondences, "maximum correspondence"),
        refused(Status::TooFewCorrespondences, "maximum correspondence")}},
      {"Identical",
       "the target is the source, noise included",
       spoilt([](TorturePair& pair) {
         pair.truth.setZero();
         pair.target = pair.source = scan(2, num_target_points, whole, usual_noise);
       }),
       unchanged,
       {right, right, diverged}},
      {"IdenticalExact",
       "the target is the source, without noise",
       spoilt([](TorturePair& pair) {
         pair.truth.setZero();
         pair.target = pair.source = scan(2, num_target_points, whole, 0.0);
       }),
       unchanged,
       {right, right, diverged}},
      {"NoNoise",
       "two scans without noise",
       [] { return usualPair(0.0); },
       unchanged,
       {right, right, not_mixed},
       right},
      {"TargetTwice",
       "every target point twice",
       spoilt([](TorturePair& pair) { repeat(2, pair.target); }),
       unchanged,
       {right, right, not_mixed}},
      {"TargetHundred",
       "every target point a hundred times",
       spoilt([](TorturePair& pair) { repeat(100, pair.target); }),
       unchanged,
       {right, right, not_mixed}},
      {"SourceTen",
       "every source point ten times",
       spoilt([](TorturePair& pair) { repeat(10, pair.source); }),
       unchanged,
       {right, right, not_mixed_or_diverged},
       right},
  };
}

} // namespace

std::vector<TortureCase>
tortureCasesOfClouds()
{
  std::vector<TortureCase> all = casesOfScale();
  for (const auto& cases : {casesOfShape(), casesOfOverlap()})
    all.insert(all.end(), cases.begin(), cases.end());
  return all;
}

} // namespace test
} // namespace bayesian_icp
