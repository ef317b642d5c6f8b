#include "io/command_line.h"

#include "io/program.h"

#include <boost/algorithm/string/replace.hpp>
#include <boost/program_options/parsers.hpp>

#include <algorithm>
#include <set>
#include <sstream>

namespace bayesian_icp::io {

namespace po = boost::program_options;

namespace {

/** An argument as a shell takes it back. */
std::string
quotedForShell(const std::string& argument)
{
  const char* harmless = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"
                         "0123456789_@%+=:,./-";
  if (!argument.empty() && argument.find_first_not_of(harmless) == std::string::npos)
    return argument;
  return "'" + boost::replace_all_copy(argument, "'", "'\\''") + '\'';
}

} // namespace

po::variables_map
splitCommandLine(const std::vector<std::string>& arguments,
                 const po::options_description& options,
                 const char* positional_name)
{
  po::options_description known;
  std::set<std::string> names;
  for (const auto& option : options.options())
    if (names.insert(option->long_name()).second)
      known.add(option);
  po::positional_options_description positional;
  if (positional_name != nullptr) {
    known.add_options()(positional_name, po::value<std::vector<std::string>>());
    positional.add(positional_name, -1);
  }
  po::variables_map given;
  try {
    po::store(po::command_line_parser(arguments)
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

void
takeOptions(const po::variables_map& given, const po::options_description& options)
{
  for (const auto& option : options.options())
    if (const auto found = given.find(option->long_name()); found != given.end())
      readOption(found->first,
                 [&] { option->semantic()->notify(found->second.value()); });
}

void
refuseOptions(const po::variables_map& given,
              const std::vector<std::string>& options,
              const std::string& reason)
{
  for (const std::string& option : options)
    if (given.count(option) > 0)
      throw UsageError("--" + option + reason);
}

po::options_description
generalOptions()
{
  po::options_description group("General");
  group.add_options()("help,h", "Show this text.")("version", "Show the version.");
  return group;
}

po::variables_map
readCommandLine(int argc,
                const char* const* argv,
                const po::options_description& options,
                const char* positional_name,
                const ToolText& tool)
{
  po::variables_map given = splitCommandLine(
      {argv + std::min(argc, 1), argv + argc}, options, positional_name);
  if (given.count("help") == 0 && given.count("version") == 0)
    return given;
  std::ostringstream text;
  if (given.count("help") > 0)
    text << tool.usage << options << tool.end;
  else
    text << tool.version << '\n';
  print(text.str());
  throw Answered();
}

void
refuseValue(const std::string& text, const std::string& expected)
{
  throw BadValue(": " + inQuotes(text) + " is not " + expected);
}

po::typed_value<std::string>*
taken(const char* placeholder, const std::function<void(const std::string&)>& take)
{
  return po::value<std::string>()->value_name(placeholder)->notifier(take);
}

po::typed_value<std::string>*
text(const char* placeholder, std::string& value)
{
  return po::value<std::string>(&value)->value_name(placeholder);
}

po::typed_value<std::string>*
fileName(const char* placeholder, std::string& value)
{
  return taken(placeholder, [&value](const std::string& name) {
    if (name.empty())
      throw BadValue(": the name is empty");
    value = name;
  });
}

po::typed_value<bool>*
flag(bool& value)
{
  return po::value<bool>(&value)->zero_tokens();
}

std::vector<std::string>
optionTexts(const po::variables_map& given, const std::string& name)
{
  return given.count(name) > 0 ? given[name].as<std::vector<std::string>>()
                               : std::vector<std::string>();
}

std::string
commandOf(int argc, const char* const* argv)
{
  std::string command;
  for (int i = 0; i < argc; ++i)
    command += (i > 0 ? " " : "") + quotedForShell(argv[i]);
  return command;
}

} // namespace bayesian_icp::io
