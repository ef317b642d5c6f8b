#include "torture_cases.h"

#include "torture_words.h"

#include <cmath>
#include <limits>

namespace bayesian_icp {
namespace test {

namespace {

constexpr double pi = 3.14159265358979323846;
constexpr double infinity = std::numeric_limits<double>::infinity();

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
       {warned("surfaces disagree"), warned("m from the target"), as_ever}},
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
      {"BatchOne",
       "mini-batches of 1 point",
       usual,
       batch(1),
       {right, warned("did not mix"), as_ever}},
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
       {refused("needs 30"), warned("a plane or a line"), as_ever}},
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
    options.likelihood.measurement_sigma = 0.005;
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
  std::vector<TortureCase> all = tortureCasesOfClouds();
  for (const auto& cases : {casesOfPose(), casesOfOptions()})
    all.insert(all.end(), cases.begin(), cases.end());
  return all;
}

} // namespace test
} // namespace bayesian_icp
