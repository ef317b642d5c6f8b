#include "study/option_values.h"

#include "io/errors.h"

#include <boost/program_options/parsers.hpp>
#include <boost/program_options/positional_options.hpp>

#include <algorithm>
#include <sstream>
#include <thread>

namespace bayesian_icp::evaluate {

namespace po = boost::program_options;

po::typed_value<std::string>*
textOption(const char* standard)
{
  return po::value<std::string>()->default_value(standard);
}

po::typed_value<int>*
intOption(int standard)
{
  return po::value<int>()->default_value(standard);
}

po::variables_map
readCommandLine(int argc,
                const char* const* argv,
                const po::options_description& options)
{
  namespace style = po::command_line_style;
  po::variables_map given;
  po::store(po::command_line_parser(argc, argv)
                .options(options)
                .positional(po::positional_options_description())
                .style(style::unix_style & ~style::allow_guessing)
                .run(),
            given);
  return given;
}

std::vector<std::string>
split(const std::string& text, char separator)
{
  std::vector<std::string> items;
  std::istringstream stream(text);
  for (std::string item; std::getline(stream, item, separator);)
    items.push_back(item);
  return items;
}

int
integerWithin(const po::variables_map& given,
              const std::string& name,
              int least,
              int most)
{
  const int value = given[name].as<int>();
  if (value < least || value > most)
    throw io::UsageError("--" + name + " is " + std::to_string(value) +
                         ", but must be in [" + std::to_string(least) + ", " +
                         std::to_string(most) + "]");
  return value;
}

std::uint64_t
seedOf(const po::variables_map& given, const std::string& name)
{
  constexpr int max_seed = 1000000000;
  return static_cast<std::uint64_t>(integerWithin(given, name, 0, max_seed));
}

int
numThreadsOf(const po::variables_map& given)
{
  constexpr int max_threads = 256;
  const int num_threads = integerWithin(given, "threads", 0, max_threads);
  return num_threads > 0
             ? num_threads
             : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

} // namespace bayesian_icp::evaluate
