#include "plot/gnuplot.h"

#include "plot/temporary_folder.h"

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <utility>

namespace bayesian_icp::plot {

namespace {

/** \p command, with \p script on its standard input.
 * \return whether it ended well */
bool
pipeInto(const std::string& command, const std::string& script)
{
  // A gnuplot that ends early must not end us.
  const auto handler = std::signal(SIGPIPE, SIG_IGN);
  FILE* pipe = popen(command.c_str(), "w");
  bool is_good = pipe != nullptr;
  if (is_good) {
    is_good = std::fwrite(script.data(), 1, script.size(), pipe) == script.size();
    is_good = pclose(pipe) == 0 && is_good;
  }
  std::signal(SIGPIPE, handler);
  return is_good;
}

std::string
contentOf(const std::string& file)
{
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream content;
  content << stream.rdbuf();
  return content.str();
}

/** The first line of gnuplot's complaints that says something. */
std::string
firstComplaint(const std::string& file)
{
  std::istringstream lines(contentOf(file));
  std::string line;
  while (std::getline(lines, line))
    if (line.find_first_not_of(" ^\t") != std::string::npos &&
        line.find("warning") == std::string::npos)
      return ": " + line;
  return "";
}

std::string
svgName(const TemporaryFolder& folder, std::size_t i)
{
  return folder.path() + '/' + std::to_string(i) + ".svg";
}

std::string
scriptOf(const Drawing& drawing, const std::string& file)
{
  return "reset session\nset encoding utf8\nset terminal svg noenhanced rounded size " +
         std::to_string(drawing.width) + ", " + std::to_string(drawing.height) +
         " font 'sans-serif," + std::to_string(drawing.font_size) + "'\nset output " +
         quotedForGnuplot(file) + '\n' + drawing.script + "\nunset output\n";
}

} // namespace

bool
hasGnuplot()
{
  return std::system("gnuplot --version > /dev/null 2>&1") == 0;
}

void
requireGnuplot(const std::string& option)
{
  if (!hasGnuplot())
    throw GnuplotError("is not there, but " + option +
                       " needs it (package gnuplot-nox)");
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
dataBlock(const std::string& name, const std::string& lines)
{
  return '$' + name + " << EOD\n" + lines + "EOD\n";
}

std::string
panelsWithKey(std::size_t num_rows, std::size_t num_columns)
{
  return "set multiplot layout " + std::to_string(num_rows) + ", " +
         std::to_string(num_columns) +
         " margins screen 0.06, 0.83, 0.16, 0.93 spacing screen 0.055, 0.2\n"
         "set key at screen 0.99, 0.95 right top vertical samplen 1 font ',10'\n";
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
  if (!pipeInto("gnuplot", script))
    throw io::FileError(folder, "gnuplot could not draw the plots");
}

std::vector<std::string>
drawSvgs(const std::vector<Drawing>& drawings)
{
  const TemporaryFolder folder;
  std::string script;
  for (std::size_t i = 0; i < drawings.size(); ++i)
    script += scriptOf(drawings[i], svgName(folder, i));
  const std::string complaints = folder.path() + "/complaints";
  // Users' own settings of gnuplot are not for these pictures.
  const bool is_good =
      pipeInto("gnuplot --default-settings 2> '" + complaints + '\'', script);
  if (!is_good)
    throw GnuplotError("could not draw the figures" + firstComplaint(complaints));
  std::vector<std::string> svgs;
  for (std::size_t i = 0; i < drawings.size(); ++i) {
    svgs.push_back(contentOf(svgName(folder, i)));
    if (svgs.back().find("</svg>") == std::string::npos)
      throw GnuplotError("has not drawn all figures");
  }
  return svgs;
}

} // namespace bayesian_icp::plot
