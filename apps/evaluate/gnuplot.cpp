#include "gnuplot.h"

#include <io/errors.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <utility>

namespace bayesian_icp::evaluate {

void
requireGnuplot()
{
  if (std::system("gnuplot --version > /dev/null 2>&1") != 0)
    throw io::FileError("gnuplot",
                        "is not there, but --plots needs it (package gnuplot-nox)");
}

void
makePlotFolder(const std::string& folder)
{
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error)
    throw io::FileError(folder, "cannot be made: " + error.message());
}

std::string
quotedForGnuplot(const std::string& text)
{
  std::string quoted = "'";
  for (const char character : text)
    quoted += character == '\'' ? std::string("''") : std::string(1, character);
  return quoted + "'";
}

std::string
pictures(const std::string& file, const std::string& size, const std::string& plot)
{
  std::ostringstream lines;
  for (const auto& [terminal, ending] :
       {std::pair<std::string, std::string>{"svg", ".svg"}, {"pngcairo", ".png"}})
    lines << "set terminal " << terminal << " noenhanced size " << size
          << " font 'sans,11' background rgb 'white'\nset output "
          << quotedForGnuplot(file + ending) << '\n'
          << plot << "unset output\n";
  return lines.str();
}

void
runGnuplot(const std::string& script, const std::string& folder)
{
  // A gnuplot that ends early must not end us.
  const auto handler = std::signal(SIGPIPE, SIG_IGN);
  FILE* pipe = popen("gnuplot", "w");
  bool is_good = pipe != nullptr;
  if (is_good) {
    is_good = std::fwrite(script.data(), 1, script.size(), pipe) == script.size();
    is_good = pclose(pipe) == 0 && is_good;
  }
  std::signal(SIGPIPE, handler);
  if (!is_good)
    throw io::FileError(folder, "gnuplot could not draw the plots");
}

} // namespace bayesian_icp::evaluate
