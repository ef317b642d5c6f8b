#include "class/torture_cases.h"

#include "class/torture_words.h"

#include <cmath>
#include <limits>

namespace bayesian_icp {
namespace test {

namespace {

constexpr double pi = 3.14159265358979323846;
constexpr double infinity = std::numeric_limits<double>::infinity();

/** The prior of roll, pitch and yaw is singular there, and tears at modes that come
 * within some 1e-4 rad of the pole: the pose can be 2 mm off. */
const Expectation at_the_pole = {
    Verdict::Warned,
    {{Status::NotMixed, "pitch +-90"}, {Status::Doubtful, "pitch +-90"}}};

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
       {right, right, not_mixed},
       right},
      {"YawMinusPi",
       "yaw just above -pi, guess just below pi",
       turned(pose(0.01, -0.02, 0.015, 0.02, -0.03, -pi + 0.01),
              pose(0, 0, 0, 0, 0, pi - 0.01)),
       unchanged,
       {right, right, not_mixed},
       right},
      {"PitchPlus90",
       "pitch of 90 degrees",
       turned(pose(0.01, -0.02, 0.015, 0, 0.5 * pi, 0),
              pose(0, 0, 0, 0, 0.5 * pi - 0.02, 0)),
       unchanged,
       {at_the_pole, rightButWarned(Status::Doubtful, "pitch +-90"), not_mixed}},
      {"PitchMinus90",
       "pitch of -90 degrees",
       turned(pose(0.01, -0.02, 0.015, 0, -0.5 * pi, 0),
              pose(0, 0, 0, 0, -0.5 * pi + 0.02, 0)),
       unchanged,
       {rightButWarned(Status::NotMixed, "pitch +-90"),
        rightButWarned(Status::Doubtful, "pitch +-90"),
        not_mixed}},
      {"Pitch88",
       "pitch of 88 degrees",
       turned(pose(0.01, -0.02, 0.015, 0, 0.5 * pi - 0.035, 0),
              pose(0, 0, 0, 0, 0.5 * pi - 0.06, 0)),
       unchanged,
       {right, right, not_mixed}},
  };
}

std::vector<TortureCase>
casesOfOptions()
{
  const auto variance = [](double value) {
    return [value](Options& options) { options.prior.variance.setConstant(value); };
  };
  const auto batch = [](int size) {
    return [size](Options& options) {
      options.paper.batch_size = size;
      options.exact.batch_size = size;
    };
  };
  const auto usual = [] { return usualPair(); };
  return {
      {"PriorZero",
       "prior variances of 0",
       usual,
       variance(0.0),
       {refused(Status::InvalidOptions, "must be positive"),
        refused(Status::InvalidOptions, "must be positive"),
        refused(Status::InvalidOptions, "must be positive")}},
      {"PriorInfinite",
       "prior variances of infinity",
       usual,
       variance(infinity),
       {refused(Status::InvalidOptions, "must be finite"), right, not_mixed},
       right},
      {"PriorTiny",
       "prior variances of 1e-12, far from the truth",
       usual,
       variance(1e-12),
       {warned(Status::Doubtful, "surfaces disagree"),
        warned(Status::Doubtful, "m from the target"),
        diverged}},
      {"PriorHuge",
       "prior variances of 1e12",
       usual,
       variance(1e12),
       {right, right, not_mixed}},
      {"BatchZero",
       "mini-batches of 0 points",
       usual,
       batch(0),
       {no_such_option,
        refused(Status::InvalidOptions, "batch_size is 0"),
        refused(Status::InvalidOptions, "batch_size is 0")}},
      {"BatchOne",
       "mini-batches of 1 point",
       usual,
       batch(1),
       {no_such_option, not_mixed, not_mixed}},
      {"BatchHuge",
       "mini-batches of 2^31 - 1 points",
       usual,
       batch(std::numeric_limits<int>::max()),
       {no_such_option, right, not_mixed}},
      {"NoDraws",
       "zero draws",
       usual,
       [](Options& options) { options.chains.num_draws = 0; },
       {refused(Status::InvalidOptions, "num_draws is 0"),
        refused(Status::InvalidOptions, "num_draws is 0"),
        refused(Status::InvalidOptions, "num_draws is 0")}},
      {"OneDraw",
       "one draw of one chain",
       usual,
       [](Options& options) {
         options.chains.num_draws = options.chains.num_chains = 1;
       },
       {not_mixed, not_mixed, not_mixed_or_diverged}},
      {"ThreePoints",
       "a source of three points",
       spoilt([](TorturePair& pair) { pair.source = pair.source.leftCols(3).eval(); }),
       unchanged,
       {refused(Status::InvalidInput, "needs 30"),
        warned(Status::Doubtful, "a plane or a line"),
        not_mixed_or_diverged}},
      {"HalfNaN",
       "every other source point is NaN",
       spoilt([](TorturePair& pair) {
         for (Eigen::Index i = 0; i < pair.source.cols(); i += 2)
           pair.source(1, i) = std::nan("");
       }),
       unchanged,
       {right, right, not_mixed},
       right},
      {"GuessInfinite",
       "a guess that is infinite",
       spoilt([](TorturePair& pair) { pair.guess[0] = infinity; }),
       unchanged,
       {refused(Status::InvalidInput, "not finite"),
        refused(Status::InvalidInput, "not finite"),
        refused(Status::InvalidInput, "not finite")}},
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
  std::vector<TortureCase> all = tortureCasesOfClouds();
  for (const auto& cases : {casesOfPose(), casesOfOptions()})
    all.insert(all.end(), cases.begin(), cases.end());
  return all;
}

} // namespace test
} // namespace bayesian_icp
