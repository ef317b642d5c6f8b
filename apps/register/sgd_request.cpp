#include "register/sgd_request.h"

#include "io/command_line.h"
#include "io/motion.h"
#include "register/command_line.h"

#include <boost/program_options.hpp>

#include <cmath>
#include <sstream>

namespace bayesian_icp::app {

namespace po = boost::program_options;

namespace {

constexpr SgdOptimizer optimizers[] = {SgdOptimizer::FixedStep,
                                       SgdOptimizer::Momentum,
                                       SgdOptimizer::AdaDelta,
                                       SgdOptimizer::Adam,
                                       SgdOptimizer::RmsProp};

void
takeOptimizer(const std::string& name, SgdOptimizer& optimizer)
{
  std::string names;
  for (const SgdOptimizer candidate : optimizers) {
    if (name == toString(candidate)) {
      optimizer = candidate;
      return;
    }
    names += (names.empty() ? "" : ", ") + std::string(toString(candidate));
  }
  io::refuseValue(name, "one of " + names);
}

/** Options of Bayesian ICP that SGD-ICP has, too. */
po::options_description
sharedOptions(SgdRequest& request)
{
  auto& options = request.options;
  po::options_description shared;
  // clang-format off
  shared.add_options()
    ("method", po::value<std::string>())
    ("json", io::flag(request.is_json))
    ("quiet", io::flag(request.is_quiet))
    ("output", io::fileName("", request.output_folder))
    ("guess", io::taken("", [&request](const std::string& text) {
       request.guess = io::readMotion("guess", text);
     }))
    ("max-distance", io::number("", request.max_distance))
    ("iterations", io::number("", options.max_iterations))
    ("batch-size", io::number("", options.batch_size))
    ("step-size", io::number("", options.step_size))
    ("seed", io::number("", options.seed));
  // clang-format on
  return shared;
}

po::variables_map
split(int argc,
      const char* const* argv,
      const po::options_description& own,
      const po::options_description& shared)
{
  Request ignored;
  const po::options_description of_bayesian_icp = describeOptions(ignored);
  po::options_description all;
  all.add(of_bayesian_icp).add(own);
  po::variables_map given = io::splitCommandLine(argc, argv, all, "cloud");
  for (const auto& option : of_bayesian_icp.options()) {
    const std::string& name = option->long_name();
    if (given.count(name) > 0 && shared.find_nothrow(name, false) == nullptr)
      throw io::UsageError("--" + name + ": has no effect with method sgd-icp");
  }
  return given;
}

/** The options that only SGD-ICP has; they fill \p request. */
po::options_description
describeSgdOptions(SgdRequest& request)
{
  auto& options = request.options;
  const auto withDefault = [](const char* help, const std::string& value) {
    return std::string(help) + " (default " + value + ")";
  };
  po::options_description group("Method sgd-icp only");
  // clang-format off
  group.add_options()
    ("optimizer", io::taken("NAME", [&options](const std::string& name) {
       takeOptimizer(name, options.optimizer);
     }),
     withDefault("Optimizer that turns gradients into steps: fixed, momentum, adadelta, "
                 "adam or rmsprop.", toString(options.optimizer)).c_str())
    ("translation-epsilon", io::number("M", options.translation_epsilon),
     withDefault("A pose is still while its translation is nearer than this to where it "
                 "came to rest [m]. 0 means never.",
                 io::textOf(options.translation_epsilon)).c_str())
    ("rotation-epsilon", io::number("RAD", options.rotation_epsilon),
     withDefault("A pose is still only while the sum of the changes of its angles is "
                 "below this [rad].", io::textOf(options.rotation_epsilon)).c_str())
    ("still-iterations", io::number("N", options.num_still_iterations),
     withDefault("Number of consecutive still steps after which the descent has "
                 "converged.", io::textOf(options.num_still_iterations)).c_str())
    ("keep-duplicates",
     "Let a target point be in several pairs of a mini-batch. Without it, only the "
     "pair with the nearest source point counts.");
  // clang-format on
  return group;
}

/** The option that a complaint of validate() speaks of. */
std::string
optionOf(const std::string& complaint)
{
  const std::string field = complaint.substr(0, complaint.find(' '));
  if (field == "max_iterations")
    return "--iterations";
  if (field == "num_still_iterations")
    return "--still-iterations";
  std::string option = "--" + field;
  for (char& character : option)
    if (character == '_')
      character = '-';
  return option;
}

void
check(const po::variables_map& given, const SgdRequest& request)
{
  if (request.is_json && request.is_quiet)
    throw io::UsageError("--json and --quiet exclude each other");
  if (!(request.max_distance > 0.0))
    throw io::UsageError("--max-distance: is " + io::textOf(request.max_distance) +
                         ", but must be positive (m)");
  if (!request.guess.allFinite())
    throw io::UsageError("--guess: must be finite");
  if (given.count("step-size") > 0) {
    if (request.options.optimizer == SgdOptimizer::AdaDelta)
      throw io::UsageError("--step-size: has no effect with optimizer adadelta");
    if (std::isnan(request.options.step_size))
      throw io::UsageError("--step-size: is nan, but must be positive and finite");
  }
  const std::string complaint = request.options.validate();
  if (!complaint.empty())
    throw io::UsageError(optionOf(complaint) + ": " + complaint);
}

} // namespace

bool
isSgdIcpAskedFor(int argc, const char* const* argv)
{
  po::options_description known;
  known.add_options()("method", po::value<std::string>());
  known.add_options()("help,h", "")("version", "");
  const po::options_description own = describeSgdOptions();
  known.add(own);
  po::variables_map given;
  try {
    po::store(po::command_line_parser(argc, argv)
                  .options(known)
                  .style(io::option_style)
                  .allow_unregistered()
                  .run(),
              given);
  }
  catch (const po::error& error) {
    throw io::UsageError(error.what());
  }
  if (given.count("help") > 0 || given.count("version") > 0)
    return false;
  const std::string method = given.count("method") > 0
                                 ? given["method"].as<std::string>()
                                 : std::string("bayesian-icp");
  if (method != "bayesian-icp" && method != "sgd-icp")
    throw io::UsageError("--method: " + io::inQuotes(method) +
                         " is not bayesian-icp or sgd-icp");
  if (method == "sgd-icp")
    return true;
  for (const auto& option : own.options())
    if (given.count(option->long_name()) > 0)
      throw io::UsageError("--" + option->long_name() +
                           ": has no effect with method bayesian-icp");
  return false;
}

SgdRequest
parseSgdCommandLine(int argc, const char* const* argv)
{
  SgdRequest request;
  const po::options_description own = describeSgdOptions(request);
  const po::options_description shared = sharedOptions(request);
  const po::variables_map given = split(argc, argv, own, shared);
  io::takeClouds(given, "cloud", request.source_file, request.target_file);
  io::takeOptions(given, shared);
  io::takeOptions(given, own);
  request.options.is_one_to_one = given.count("keep-duplicates") == 0;
  check(given, request);
  return request;
}

po::options_description
describeSgdOptions()
{
  SgdRequest ignored;
  return describeSgdOptions(ignored);
}

std::string
aboutSgdIcp()
{
  const StochasticGradientIcpOptions defaults;
  std::ostringstream text;
  text << R"(
Method sgd-icp finds a pose by stochastic gradient descent, and no posterior.
Of the options above it uses --guess, --max-distance, --seed, --json, --quiet
and --output (aligned.pcd and sgd_icp.json). It also uses, with defaults of its
own, --iterations ()"
       << defaults.max_iterations << "), --batch-size (" << defaults.batch_size
       << ") and --step-size\n(";
  for (const SgdOptimizer optimizer : optimizers)
    if (optimizer != SgdOptimizer::AdaDelta)
      text << toString(optimizer) << ' ' << defaultStepSize(optimizer)
           << (optimizer == SgdOptimizer::RmsProp ? "; adadelta has none" : ", ");
  text << R"(). Other
options are errors. The exit code is 0 if the descent came to rest, else 1.
)";
  return text.str();
}

} // namespace bayesian_icp::app
