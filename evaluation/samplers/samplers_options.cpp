#include "samplers/samplers_options.h"

#include "register/choices.h"

#include <boost/algorithm/string/join.hpp>

#include <algorithm>
#include <cmath>

namespace bayesian_icp::evaluate {

namespace po = boost::program_options;

namespace {

constexpr int max_threads = 64;
constexpr double unlimited = std::numeric_limits<double>::infinity();

double
positiveNumberOf(const std::string& text)
{
  double number = 0.0;
  if (!io::readNumber(text, number) || !(number > 0.0) || !std::isfinite(number))
    io::refuseValue(text, "a positive number");
  return number;
}

Cell
cellOf(const std::string& text)
{
  const auto numbers = split(text, ':');
  if (numbers.size() != 2)
    io::refuseValue(text, "of the form sigma:N");
  return {positiveNumberOf(numbers[0]), positiveNumberOf(numbers[1])};
}

/** An option with several values, separated by commas, each of which \p read reads. */
template <typename Value>
po::typed_value<std::string>*
listOf(const std::string& standard,
       std::vector<Value>& values,
       Value (*read)(const std::string&))
{
  return taken(standard, [&values, read](const std::string& text) {
    values.clear();
    for (const std::string& word : split(text, ','))
      values.push_back(read(word));
  });
}

/** A sampler of the default ones. */
std::string
samplerOf(const std::string& name)
{
  if (!SamplersOptions().wants(name))
    throw io::BadValue(": there is no " + io::inQuotes(name));
  return name;
}

int
numParticlesOf(const std::string& text)
{
  const double number = positiveNumberOf(text);
  if (number != std::floor(number) || number < min_particles || number > 10000.0)
    io::refuseValue(text, "a whole number from 8 to 10000");
  return static_cast<int>(number);
}

constexpr char samplers_help[] = R"(Usage: pcl_bayesian_icp_evaluate samplers [options]

Compares the draws of every sampler with a gold standard: long Metropolis
runs on the same posterior, kept in the cache folder. Every run is a row of
a CSV file: KL divergence of Gaussian moments (gold standard to sampler,
6-D and per coordinate) [nats], Wasserstein-1 distance [standard deviations
of the gold standard] and Kolmogorov-Smirnov distance of the marginals,
largest R-hat, smallest bulk and tail effective sample size (ESS), CPU time
of all threads [s], smallest bulk ESS a second, status. A table of medians
and worst cases goes to the standard output, progress to the standard error.
Results of another build of the samplers have to be deleted by hand.
Exit codes: 0 good, 1 a gold standard did not converge, 2 usage, 3 cannot
read or write a file, or make the report.
)";

po::options_description
describeOptions(SamplersOptions& options)
{
  po::options_description description("Options", 88);
  // clang-format off
  description.add_options()
    ("data", text(options.data_folder),
     "folder with one folder for each scene: source.pcd, target.pcd [m]")
    ("scenes", list(options.scenes), "names of scenes, separated by commas")
    ("cells", listOf("1:6000,0.0015:100,0.0015:1000,0.005:300", options.cells, cellOf),
     "scales of the likelihood as sigma:N, separated by commas: sigma [m], effective "
     "points N")
    ("residual", taken("point-to-point", [&options](const std::string& text) {
       if (!app::readChoice(text, options.residual))
         io::refuseValue(text, app::namesOfChoices(Residual()));
     }),
     ("residual of the energy, for all samplers and the gold standard (paper has its "
      "own): " + app::namesOfChoices(Residual())).c_str())
    ("samplers", listOf(boost::algorithm::join(options.samplers, ","), options.samplers,
                        samplerOf),
     "samplers to compare: exact (preset exact), exact-metropolis (the same with "
     "Metropolis steps), stein-gradient and stein-newton (with Stein steps), paper "
     "(Algorithm 1 at several step sizes; all seeds at the best one), walk and mala "
     "(full batch; covariance and starts from the gold standard)")
    ("particles", listOf("20,50,100", options.particles, numParticlesOf),
     "numbers of particles of the Stein samplers")
    ("step-sizes", listOf("1e-3,1e-4,1e-5,1e-6", options.step_sizes, positiveNumberOf),
     "step sizes alpha of Algorithm 1. Each is also tried times 6000 sigma^2 / N, "
     "which is its value at the paper's scale. Smaller ones are tried as long as they "
     "are better")
    ("seeds", integer(options.num_seeds, 1, 1000),
     "number of runs of each sampler, with seeds 1, 2, ...")
    ("points", integer(options.num_points, 10, 100000000),
     "number of source points, the same for all samplers and the gold standard")
    ("threads", integer(options.num_threads, 1, max_threads),
     "number of threads of the gold standard and the presets")
    ("gold-seconds", positiveNumber(options.gold.max_seconds, unlimited),
     "CPU time after which a gold standard ends, even if it has not converged [s]")
    ("cache", text(options.cache_folder), "folder of the gold standards")
    ("quick", io::flag(options.is_quick),
     "one scene (can), two seeds and 500 points, unless given");
  // clang-format on
  addResultOptions(options.result, description);
  return description;
}

void
makeQuick(const po::variables_map& given, SamplersOptions& options)
{
  if (given["scenes"].defaulted())
    options.scenes = {"can"};
  if (given["seeds"].defaulted())
    options.num_seeds = 2;
  if (given["points"].defaulted())
    options.num_points = 500;
}

} // namespace

bool
SamplersOptions::wants(const std::string& sampler) const
{
  return std::count(samplers.begin(), samplers.end(), sampler) > 0;
}

std::optional<SamplersOptions>
parseSamplersOptions(int argc, const char* const* argv)
{
  SamplersOptions options;
  const auto given = readOptions(argc, argv, describeOptions(options), samplers_help);
  if (!given)
    return std::nullopt;
  if (options.is_quick)
    makeQuick(*given, options);
  options.gold.num_threads = options.num_threads;
  return options;
}

} // namespace bayesian_icp::evaluate
