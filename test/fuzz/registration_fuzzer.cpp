/** \file
 * \brief Fuzzes the registration, by the library without PCL and by the PCL classes:
 * any clouds, any options.
 */
#include "fuzz_input.h"
#include "registration_classes.h"

#include <pcl/console/print.h>

#include <algorithm>
#include <cstdlib>
#include <limits>

namespace {

using namespace bayesian_icp;

void
registerByCore(const fuzz::RegistrationInput& input)
{
  const PosteriorEstimate estimate = estimatePosterior(
      input.source, input.target, input.guess, input.options, fuzz::limitSteps(input));
  fuzz::checkEstimate(estimate.summary, estimate.samples);
}

void
registerByMonteCarlo(const fuzz::RegistrationInput& input)
{
  const evaluate::MonteCarloIcpOptions& options = input.monte_carlo;
  const auto runs = evaluate::monteCarloIcp(input.source, input.target, options);
  const int max_runs = std::numeric_limits<int>::max() - std::max(0, options.first_run);
  fuzz::require(int(runs.size()) == std::clamp(options.num_runs, 0, max_runs),
                "every start has a run");
  for (const evaluate::MonteCarloIcpRun& run : runs)
    fuzz::require(!run.has_converged || run.end.allFinite() || !run.start.allFinite(),
                  "ICP converges to a finite pose");
}

} // namespace

extern "C" int
LLVMFuzzerInitialize(int* /*argc*/, char*** /*argv*/)
{
  pcl::console::setVerbosityLevel(pcl::console::L_ALWAYS);
  // libomp forgets memory when a team of threads grows; so each team is a new one.
  return setenv("KMP_HOT_TEAMS_MAX_LEVEL", "0", 1);
}

extern "C" int
LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
  const fuzz::RegistrationInput input = fuzz::registrationInputOf(data, size);
  switch (input.method) {
  case fuzz::Method::Posterior:
    registerByCore(input);
    fuzz::registerByClass<pcl::PointXYZ, float>(input);
    break;
  case fuzz::Method::PosteriorOfNormals:
    fuzz::registerNormalsByClass(input);
    break;
  case fuzz::Method::StochasticGradient:
    fuzz::registerByDescent(input);
    break;
  case fuzz::Method::MonteCarlo:
    registerByMonteCarlo(input);
    break;
  }
  return 0;
}
