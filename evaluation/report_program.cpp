#include "commands.h"
#include "io/errors.h"
#include "io/numbers.h"
#include "io/program.h"
#include "plot/child_program.h"

#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <vector>

namespace bayesian_icp::evaluate {

namespace {

constexpr char looks_for_packages[] =
    "import sys; from importlib.util import find_spec as f; "
    "sys.exit(not (f('pandas') and f('matplotlib')))";

/** The first Python that has what reports need; empty if none does. */
std::string
pythonForReports()
{
  std::vector<std::string> names = {"python3", "/usr/bin/python3"};
  if (const char* name = std::getenv("PCL_BAYESIAN_ICP_PYTHON"))
    names = {name};
  for (const std::string& name : names)
    if (plot::runChildProgram({name, "-c", looks_for_packages}, "").is_good)
      return name;
  return "";
}

/** Where the Python files are, in the build folder as where the tools are installed. */
std::string
reportProgram()
{
  const auto tools = std::filesystem::read_symlink("/proc/self/exe").parent_path();
  return (tools / BAYESIAN_ICP_REPORT_FROM_TOOLS).lexically_normal().string();
}

std::string
lastLineOf(const std::string& text)
{
  const auto lines = io::words(text, "\n");
  return lines.empty() ? "the report cannot be made" : std::string(lines.back());
}

void
printHelp()
{
  std::cout << R"(Usage: pcl_bayesian_icp_evaluate report FOLDER

Makes report.md, report.html and figures (SVG and PNG) of all studies
whose CSV files are in the folder. It runs Python with pandas and matplotlib
(Debian's packages python3-pandas and python3-matplotlib), and registers and
samples nothing.
Exit codes: 0 success, 2 usage, 3 no report.
)";
}

} // namespace

int
makeReport(const std::string& folder)
{
  const std::string python = pythonForReports();
  if (python.empty()) {
    std::cerr << "The CSV files are complete. The report needs python3-pandas and "
                 "python3-matplotlib; then run: pcl_bayesian_icp_evaluate report "
              << folder << std::endl;
    return io::BadFile;
  }
  // -B: nothing is written where the program is.
  const plot::ProgramResult result =
      plot::runChildProgram({python, "-B", reportProgram(), folder}, "");
  if (!result.is_good)
    throw io::FileError(folder, lastLineOf(result.errors));
  io::print(result.output);
  return 0;
}

int
runReportCommand(int argc, const char* const* argv)
{
  const std::string word = argc == 2 ? argv[1] : "";
  if (word == "--help") {
    printHelp();
    return 0;
  }
  if (word.empty() || word.front() == '-')
    throw io::UsageError("report needs the name of one folder");
  if (!std::filesystem::is_directory(word))
    throw io::FileError(word, "is not a folder");
  return makeReport(word);
}

} // namespace bayesian_icp::evaluate
