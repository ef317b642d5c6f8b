#include "study/option_values.h"

#include "commands.h"
#include "io/folders.h"
#include "io/numbers.h"

#include <boost/algorithm/string/join.hpp>

#include <algorithm>
#include <filesystem>
#include <thread>

namespace bayesian_icp::evaluate {

namespace po = boost::program_options;

po::typed_value<std::string>*
taken(const std::string& standard, const std::function<void(const std::string&)>& take)
{
  return po::value<std::string>()->default_value(standard)->notifier(take);
}

po::typed_value<std::string>*
text(std::string& value)
{
  return po::value<std::string>(&value)->default_value(value);
}

po::typed_value<std::string>*
outputName(const std::string& kind, std::string& value)
{
  return taken(value, [kind, &value](const std::string& name) {
    if (name.empty())
      throw io::BadValue(" needs the name of a " + kind);
    value = name;
  });
}

po::typed_value<std::string>*
list(std::vector<std::string>& words)
{
  return taken(boost::algorithm::join(words, ","),
               [&words](const std::string& text) { words = wordsOf(text); });
}

po::typed_value<double>*
positiveNumber(double& value, double most)
{
  return po::value<double>()
      ->default_value(value, io::textOf(value))
      ->notifier([&value, most](double number) {
        if (!(number > 0.0) || number > most)
          throw io::BadValue(" must be positive");
        value = number;
      });
}

po::typed_value<int>*
threads(int& value)
{
  constexpr int max_threads = 256;
  return po::value<int>()->default_value(0)->notifier([&value](int number) {
    requireWithin(number, 0, max_threads);
    const int num_cores = static_cast<int>(std::thread::hardware_concurrency());
    value = number > 0 ? number : std::max(1, num_cores);
  });
}

void
requireWithin(int value, int least, int most)
{
  if (value < least || value > most)
    throw io::BadValue(" is " + std::to_string(value) + ", but must be in [" +
                       std::to_string(least) + ", " + std::to_string(most) + "]");
}

std::vector<std::string>
wordsOf(const std::string& list)
{
  std::vector<std::string> words;
  for (const std::string_view word : io::splitAt(',', list))
    if (!word.empty() && std::find(words.begin(), words.end(), word) == words.end())
      words.emplace_back(word);
  return words;
}

void
requireKnown(const std::vector<std::string>& asked,
             const std::vector<std::string>& known)
{
  for (const std::string& name : asked)
    if (std::find(known.begin(), known.end(), name) == known.end())
      throw io::BadValue(": there is no " + io::inQuotes(name) + ", but " +
                         boost::algorithm::join(known, " "));
}

int
ResultOptions::report() const
{
  return has_report ? makeReport(io::folderOf(file)) : 0;
}

void
addResultOptions(ResultOptions& result,
                 po::options_description& description,
                 const char* file_help)
{
  // clang-format off
  description.add_options()
    ("output", outputName("file", result.file), file_help)
    ("report", io::flag(result.has_report)->notifier([&result](bool) {
       if (std::filesystem::path(result.file).extension() != ".csv")
         throw io::BadValue(" reads files whose names end in .csv, but --output is " +
                            io::inQuotes(result.file));
     }),
     "also make a report, with figures, of all results in that folder")
    ("help", "show this text");
  // clang-format on
}

po::variables_map
readOptions(int argc,
            const char* const* argv,
            const po::options_description& description,
            const std::string& help,
            const char* positional_name)
{
  po::variables_map given = io::readCommandLine(
      argc, argv, description, positional_name, {"", help + '\n', ""});
  io::takeOptions(given, description);
  return given;
}

} // namespace bayesian_icp::evaluate
