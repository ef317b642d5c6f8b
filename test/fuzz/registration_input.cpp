#include "registration_input.h"

#include <bayesian_icp/random.h>

#include <fuzzer/FuzzedDataProvider.h>

#include <array>
#include <cmath>
#include <limits>

namespace bayesian_icp::fuzz {

namespace {

using Bytes = FuzzedDataProvider;

constexpr int max_num_odd_points = 12;

/** A number that has broken something before, or any. */
double
oddNumber(Bytes& bytes)
{
  using Limits = std::numeric_limits<double>;
  using FloatLimits = std::numeric_limits<float>;
  static const std::array<double, 22> numbers = {0.0,
                                                 -0.0,
                                                 1.0,
                                                 -1.0,
                                                 M_PI,
                                                 -M_PI_2,
                                                 1e-9,
                                                 1e6,
                                                 1e17,
                                                 1e18,
                                                 -1e19,
                                                 1e30,
                                                 -1e30,
                                                 FloatLimits::denorm_min(),
                                                 FloatLimits::max(),
                                                 Limits::denorm_min(),
                                                 Limits::min(),
                                                 Limits::max(),
                                                 Limits::lowest(),
                                                 Limits::infinity(),
                                                 -Limits::infinity(),
                                                 Limits::quiet_NaN()};
  const auto choice = bytes.ConsumeIntegral<std::uint8_t>();
  if (choice < numbers.size())
    return numbers[choice];
  if (choice < 128)
    return bytes.ConsumeIntegral<std::int16_t>() * 1e-3;
  return bytes.ConsumeFloatingPoint<double>();
}

/** From \p least to \p most, or far out. */
int
oddCount(Bytes& bytes, int least, int most)
{
  return bytes.ConsumeIntegral<std::uint8_t>() % 8 > 0
             ? bytes.ConsumeIntegralInRange(least, most)
             : bytes.PickValueInArray({-1, 0, std::numeric_limits<int>::max()});
}

Vector6d
oddVector(Bytes& bytes)
{
  Vector6d vector;
  for (double& number : vector)
    number = oddNumber(bytes);
  return vector;
}

/** A point of one of a few shapes about as large as 1 m. */
Eigen::Vector3d
pointOfShape(int shape, Random& random)
{
  Eigen::Vector3d point(random.uniform(), random.uniform(), random.uniform());
  switch (shape) {
  case 0: // the faces of a cube
    point[static_cast<Eigen::Index>(random.index(3))] =
        random.index(2) == 0 ? 0.0 : 1.0;
    return point;
  case 1: // a plane
    return {point[0], point[1], 0.0};
  case 2: // a line
    return point[0] * Eigen::Vector3d(1.0, 1.0, -1.0);
  case 3: // one point
    return {1.0, 2.0, 3.0};
  case 4: // a few points, many times each
    return (3.0 * point).array().floor();
  case 5: // a sphere
    return (point - Eigen::Vector3d::Constant(0.5)).normalized();
  default: // no surface
    return point;
  }
}

Eigen::Matrix3Xd
cloudOf(Bytes& bytes, int max_num_points)
{
  const int num_points =
      max_num_points - bytes.ConsumeIntegralInRange(0, max_num_points);
  const int shape = bytes.ConsumeIntegralInRange(0, 6);
  Random random(bytes.ConsumeIntegral<std::uint8_t>(), 0);
  const double noise = bytes.ConsumeBool() ? 0.01 : 0.0;
  const bool is_odd = bytes.ConsumeBool();
  const double scale = is_odd ? oddNumber(bytes) : 1.0;
  const double offset = is_odd ? oddNumber(bytes) : 0.0;
  Eigen::Matrix3Xd cloud(3, num_points);
  for (int i = 0; i < num_points; ++i) {
    const Eigen::Vector3d error(random.normal(), random.normal(), random.normal());
    const Eigen::Vector3d point = pointOfShape(shape, random) + noise * error;
    cloud.col(i) = (scale * point).array() + offset;
  }
  const int num_odd = bytes.ConsumeIntegralInRange(0, max_num_odd_points);
  for (int i = 0; i < std::min(num_odd, num_points); ++i)
    for (int k = 0; k < 3; ++k)
      cloud(k, i) = oddNumber(bytes);
  return cloud;
}

template <typename Choice>
Choice
choiceOf(Bytes& bytes, int num_choices)
{
  return static_cast<Choice>(bytes.ConsumeIntegralInRange(0, num_choices - 1));
}

/** Gives \p change bytes for every field whose bit is set. */
class FieldChanger {
public:
  explicit FieldChanger(Bytes& bytes)
  : bytes_(bytes)
  , fields_(bytes.ConsumeIntegral<std::uint32_t>())
  {}

  /** \return whether it is changed */
  bool
  operator()(double& number)
  {
    return changeBy([&] { number = oddNumber(bytes_); });
  }

  bool
  operator()(Vector6d& vector)
  {
    return changeBy([&] { vector = oddVector(bytes_); });
  }

  bool
  operator()(int& count, int least, int most)
  {
    return changeBy([&] { count = oddCount(bytes_, least, most); });
  }

private:
  template <typename Change>
  bool
  changeBy(const Change& change)
  {
    const bool is_changed = (fields_ & 1U) != 0;
    fields_ >>= 1U;
    if (is_changed)
      change();
    return is_changed;
  }

  Bytes& bytes_;
  std::uint32_t fields_;
};

Options
optionsOf(Bytes& bytes)
{
  Options options;
  options.preset = choiceOf<Preset>(bytes, 3);
  options.prior.frame = choiceOf<PriorFrame>(bytes, 2);
  options.paper.sampling = choiceOf<MiniBatchSampling>(bytes, 2);
  options.exact.steps = choiceOf<ExactSteps>(bytes, 5);
  options.exact.residual.residual = choiceOf<Residual>(bytes, 3);
  options.exact.residual.regularization = choiceOf<CovarianceRegularization>(bytes, 3);
  options.exact.residual.kernel = choiceOf<RobustKernel>(bytes, 3);
  options.chains.num_chains = bytes.PickValueInArray({2, 1, 3, 4, 5, 0});
  options.chains.num_draws = 400 - bytes.ConsumeIntegralInRange(0, 400);
  options.chains.seed = bytes.ConsumeIntegral<std::uint8_t>();
  options.chains.num_threads = 1;
  FieldChanger change(bytes);
  LikelihoodScale scale;
  change(scale.effective_points);
  change(scale.measurement_sigma);
  options.paper.scale = options.exact.scale = scale;
  change(options.prior.mean);
  change(options.prior.variance);
  SgldOptions& sgld = options.paper.sgld;
  if (change(options.paper.batch_size, 1, 100))
    options.exact.batch_size = options.paper.batch_size;
  if (change(sgld.step_size))
    options.exact.max_step_size = sgld.step_size;
  change(sgld.decay_rate);
  change(sgld.lambda_rms);
  change(sgld.noise_factor);
  change(sgld.block_decay_factor);
  change(sgld.block_decay_start);
  change(sgld.block_decay_interval, 1, 100);
  if (change(options.paper.num_burn_in, 1, 50))
    options.exact.num_burn_in = options.calibrated.num_burn_in =
        options.paper.num_burn_in;
  if (change(options.paper.thinning, 1, 20))
    options.exact.thinning = options.calibrated.thinning = options.paper.thinning;
  if (change(options.paper.initial_spread))
    options.exact.initial_spread = options.paper.initial_spread;
  change(options.exact.residual.kernel_width);
  if (change(options.exact.residual.max_distance))
    options.paper.max_distance = options.exact.residual.max_distance;
  change(options.exact.max_source_points, 1, 100);
  change(options.calibrated.max_source_points, min_calibrated_points, 100);
  change(options.calibrated.num_mode_points, min_calibrated_points, 100);
  return options;
}

/** Any, but what is asked for takes memory: 5 MB for 100 000 draws. */
void
makeOdd(Bytes& bytes, ChainOptions& chains)
{
  constexpr int largest_int = std::numeric_limits<int>::max();
  chains.num_chains = oddCount(bytes, 1, 20);
  chains.num_draws = bytes.PickValueInArray({-1, 0, 1, 20, 500, 100000});
  chains.num_threads = bytes.PickValueInArray({1, 2, 0, -1, largest_int});
}

StochasticGradientIcpOptions
descentOf(Bytes& bytes)
{
  StochasticGradientIcpOptions descent;
  descent.optimizer = choiceOf<SgdOptimizer>(bytes, 5);
  descent.is_one_to_one = bytes.ConsumeBool();
  descent.seed = bytes.ConsumeIntegral<std::uint8_t>();
  FieldChanger change(bytes);
  change(descent.step_size);
  change(descent.batch_size, 1, 100);
  change(descent.max_iterations, 1, 200);
  change(descent.translation_epsilon);
  change(descent.rotation_epsilon);
  change(descent.num_still_iterations, 1, 10);
  return descent;
}

evaluate::MonteCarloIcpOptions
monteCarloOf(Bytes& bytes)
{
  evaluate::MonteCarloIcpOptions monte_carlo;
  monte_carlo.seed = bytes.ConsumeIntegral<std::uint8_t>();
  monte_carlo.num_runs = bytes.ConsumeIntegralInRange(-1, 20);
  monte_carlo.num_threads = bytes.PickValueInArray({1, 2});
  monte_carlo.max_iterations = bytes.ConsumeIntegralInRange(-1, 20);
  FieldChanger change(bytes);
  change(monte_carlo.mean);
  change(monte_carlo.half_range);
  change(monte_carlo.first_run, 0, 100);
  change(monte_carlo.max_distance);
  return monte_carlo;
}

/** What the bytes behind the clouds say; nothing if there are none. */
void
widen(Bytes& bytes, RegistrationInput& input)
{
  if (bytes.ConsumeBool())
    input.options.prior.frame = choiceOf<PriorFrame>(bytes, 3);
  if (bytes.ConsumeBool())
    makeOdd(bytes, input.options.chains);
  if (!bytes.ConsumeBool()) {
    input.source = input.source.cast<float>().cast<double>();
    input.target = input.target.cast<float>().cast<double>();
  }
  input.method = choiceOf<Method>(bytes, 4);
  if (input.method == Method::StochasticGradient)
    input.descent = descentOf(bytes);
  if (input.method == Method::MonteCarlo)
    input.monte_carlo = monteCarloOf(bytes);
}

} // namespace

RegistrationInput
registrationInputOf(const std::uint8_t* data, std::size_t size)
{
  Bytes bytes(data, size);
  RegistrationInput input;
  input.options = optionsOf(bytes);
  input.icp_iterations = bytes.ConsumeIntegralInRange(0, 10);
  input.is_reciprocal = bytes.ConsumeBool();
  input.use_mean = bytes.ConsumeBool();
  if (bytes.ConsumeBool())
    input.gate = oddNumber(bytes);
  if (bytes.ConsumeBool())
    input.guess = oddVector(bytes);
  input.max_num_steps = bytes.PickValueInArray({5000, 50, 200});
  const int max_num_points = input.options.preset == Preset::Calibrated ? 80 : 40;
  input.target = cloudOf(bytes, max_num_points);
  input.source = bytes.ConsumeBool() ? input.target : cloudOf(bytes, max_num_points);
  widen(bytes, input);
  return input;
}

} // namespace bayesian_icp::fuzz
