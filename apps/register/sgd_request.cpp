#include "register/sgd_request.h"

#include "io/command_line.h"
#include "io/errors.h"
#include "io/motion.h"
#include "io/numbers.h"
#include "register/option_descriptions.h"

#include <boost/program_options.hpp>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <sstream>
#include <vector>

namespace bayesian_icp::app {

namespace po = boost::program_options;

namespace {

constexpr SgdOptimizer optimizers[] = {SgdOptimizer::FixedStep,
                                       SgdOptimizer::Momentum,
                                       SgdOptimizer::AdaDelta,
                                       SgdOptimizer::Adam,
                                       SgdOptimizer::RmsProp};

/** Options of Bayesian ICP that SGD-ICP has, too. */
constexpr const char* shared_options[] = {"method",
                                          "json",
                                          "quiet",
                                          "output",
                                          "guess",
                                          "max-distance",
                                          "iterations",
                                          "batch-size",
                                          "step-size",
                                          "seed"};

bool
isShared(const std::string& option)
{
  return std::find(std::begin(shared_options), std::end(shared_options), option) !=
         std::end(shared_options);
}

po::variables_map
split(int argc, const char* const* argv)
{
  const po::options_description of_bayesian_icp = describeOptions();
  po::options_description all;
  all.add(of_bayesian_icp).add(describeSgdOptions());
  po::variables_map given = io::splitCommandLine(argc, argv, all, "cloud");
  for (const auto& option : of_bayesian_icp.options()) {
    const std::string& name = option->long_name();
    if (given.count(name) > 0 && !isShared(name))
      throw io::UsageError("--" + name + ": has no effect with method sgd-icp");
  }
  return given;
}

template <typename Number>
void
take(const po::variables_map& given, const std::string& option, Number& number)
{
  if (given.count(option) == 0)
    return;
  const auto& text = given[option].as<std::string>();
  if (!io::readNumber(text, number))
    throw io::UsageError(
        "--" + option + ": " + io::quoted(text) + " is not a " +
        (std::is_integral_v<Number> ? "whole number in its range" : "number"));
}

void
takeOptimizer(const po::variables_map& given, SgdOptimizer& optimizer)
{
  if (given.count("optimizer") == 0)
    return;
  const auto& name = given["optimizer"].as<std::string>();
  std::string names;
  for (const SgdOptimizer candidate : optimizers) {
    if (name == toString(candidate)) {
      optimizer = candidate;
      return;
    }
    names += (names.empty() ? "" : ", ") + std::string(toString(candidate));
  }
  throw io::UsageError("--optimizer: " + io::quoted(name) + " is not one of " + names);
}

void
takeOptions(const po::variables_map& given, SgdRequest& request)
{
  auto& options = request.options;
  takeOptimizer(given, options.optimizer);
  take(given, "step-size", options.step_size);
  take(given, "batch-size", options.batch_size);
  take(given, "iterations", options.max_iterations);
  take(given, "translation-epsilon", options.translation_epsilon);
  take(given, "rotation-epsilon", options.rotation_epsilon);
  take(given, "still-iterations", options.num_still_iterations);
  take(given, "seed", options.seed);
  take(given, "max-distance", request.max_distance);
  options.is_one_to_one = given.count("keep-duplicates") == 0;
  if (given.count("guess") > 0)
    request.guess = io::readMotion("guess", given["guess"].as<std::string>());
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
    throw io::UsageError("--method: " + io::quoted(method) +
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
  const po::variables_map given = split(argc, argv);
  SgdRequest request;
  io::takeClouds(given, "cloud", request.source_file, request.target_file);
  request.output_folder = io::optionText(given, "output");
  request.is_json = given.count("json") > 0;
  request.is_quiet = given.count("quiet") > 0;
  takeOptions(given, request);
  check(given, request);
  return request;
}

po::options_description
describeSgdOptions()
{
  const StochasticGradientIcpOptions defaults;
  po::options_description group("Method sgd-icp only");
  const auto add =
      [&group](const char* name, const char* placeholder, const std::string& help) {
        group.add_options()(
            name, po::value<std::string>()->value_name(placeholder), help.c_str());
      };
  add("optimizer",
      "NAME",
      std::string("Optimizer that turns gradients into steps: fixed, momentum, "
                  "adadelta, adam or rmsprop. (default ") +
          toString(defaults.optimizer) + ")");
  add("translation-epsilon",
      "M",
      "A pose is still while its translation is nearer than this to where it came to "
      "rest [m]. 0 means never. (default " +
          io::textOf(defaults.translation_epsilon) + ")");
  add("rotation-epsilon",
      "RAD",
      "A pose is still only while the sum of the changes of its angles is below this "
      "[rad]. (default " +
          io::textOf(defaults.rotation_epsilon) + ")");
  add("still-iterations",
      "N",
      "Number of consecutive still steps after which the descent has converged. "
      "(default " +
          io::textOf(defaults.num_still_iterations) + ")");
  group.add_options()("keep-duplicates",
                      "Let a target point be in several pairs of a mini-batch. Without "
                      "it, only the pair with the nearest source point counts.");
  return group;
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
