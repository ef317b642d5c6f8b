#include "plot/gnuplot.h"

#include "plot/child_program.h"

#include <sstream>
#include <utility>

namespace bayesian_icp::plot {

namespace {

/** The first line of gnuplot's complaints that says something. */
std::string
firstComplaint(const std::string& errors)
{
  std::istringstream lines(errors);
  std::string line;
  while (std::getline(lines, line))
    if (line.find_first_not_of(" ^\t") != std::string::npos &&
        line.find("warning") == std::string::npos)
      return ": " + line;
  return "";
}

std::string
scriptOf(const Drawing& drawing)
{
  return "reset session\nset encoding utf8\nset terminal svg noenhanced rounded size " +
         std::to_string(drawing.width) + ", " + std::to_string(drawing.height) +
         " font 'sans-serif," + std::to_string(drawing.font_size) + "'\nset output\n" +
         drawing.script + '\n';
}

/** The SVG documents that follow each other in \p text. */
std::vector<std::string>
documentsOf(const std::string& text)
{
  const std::string last_tag = "</svg>";
  std::vector<std::string> documents;
  std::size_t begin = 0, end = 0;
  while ((end = text.find(last_tag, begin)) != std::string::npos) {
    end += last_tag.size();
    documents.push_back(text.substr(begin, end - begin));
    begin = end;
  }
  return documents;
}

} // namespace

bool
hasGnuplot()
{
  return runChildProgram({"gnuplot", "--version"}, "").is_good;
}

void
requireGnuplot(const std::string& option)
{
  if (!hasGnuplot())
    throw GnuplotError("is not there, but " + option +
                       " needs it (package gnuplot-nox)");
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
  const ProgramResult run = runChildProgram({"gnuplot"}, script);
  if (!run.is_good)
    throw io::FileError(
        folder, "gnuplot could not draw the plots" + firstComplaint(run.errors));
}

std::vector<std::string>
drawSvgs(const std::vector<Drawing>& drawings)
{
  std::string script;
  for (const Drawing& drawing : drawings)
    script += scriptOf(drawing);
  // Users' own settings of gnuplot are not for these pictures.
  const ProgramResult run = runChildProgram({"gnuplot", "--default-settings"}, script);
  if (!run.is_good)
    throw GnuplotError("could not draw the figures" + firstComplaint(run.errors));
  std::vector<std::string> svgs = documentsOf(run.output);
  if (svgs.size() != drawings.size())
    throw GnuplotError("has not drawn all figures");
  return svgs;
}

} // namespace bayesian_icp::plot
