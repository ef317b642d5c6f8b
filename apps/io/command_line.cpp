#include "io/command_line.h"

#include "io/errors.h"

#include <boost/program_options/parsers.hpp>

#include <set>

namespace bayesian_icp::io {

namespace po = boost::program_options;

po::variables_map
splitCommandLine(int argc,
                 const char* const* argv,
                 const po::options_description& options,
                 const char* positional_name)
{
  po::options_description known;
  std::set<std::string> names;
  for (const auto& option : options.options())
    if (names.insert(option->long_name()).second)
      known.add(option);
  known.add_options()(positional_name, po::value<std::vector<std::string>>());
  po::positional_options_description positional;
  positional.add(positional_name, -1);
  po::variables_map given;
  try {
    po::store(po::command_line_parser(argc, argv)
                  .options(known)
                  .positional(positional)
                  .style(option_style)
                  .run(),
              given);
  }
  catch (const po::error& error) {
    throw UsageError(error.what());
  }
  return given;
}

std::string
optionText(const po::variables_map& given, const std::string& name)
{
  if (given.count(name) == 0)
    return "";
  auto text = given[name].as<std::string>();
  if (text.empty())
    throw UsageError("--" + name + ": the name is empty");
  return text;
}

std::vector<std::string>
optionTexts(const po::variables_map& given, const std::string& name)
{
  return given.count(name) > 0 ? given[name].as<std::vector<std::string>>()
                               : std::vector<std::string>();
}

void
takeClouds(const po::variables_map& given,
           const std::string& name,
           std::string& source_file,
           std::string& target_file)
{
  const std::vector<std::string> clouds = optionTexts(given, name);
  if (clouds.size() < 2)
    throw UsageError("expected a source and a target cloud");
  if (clouds.size() > 2)
    throw UsageError(
        "expected one source and one target cloud, but got a third file: " +
        quoted(clouds[2]));
  source_file = clouds[0];
  target_file = clouds[1];
}

} // namespace bayesian_icp::io
