#include "plot/gnuplot.h"

#include "io/output_folder.h"
#include "plot/child_program.h"

#include <ostream>
#include <sstream>

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

constexpr const char* svg_end = "</svg>";
constexpr const char* png_end = "IEND\xae\x42\x60\x82";

/** The documents that follow each other in \p text, which end with each of \p ends in
 * turn. One that is cut off is not among them. */
std::vector<std::string>
documentsOf(const std::string& text, const std::vector<std::string>& ends)
{
  std::vector<std::string> documents;
  std::size_t begin = 0;
  while (true) {
    const std::string& last_word = ends[documents.size() % ends.size()];
    begin = text.find_first_not_of('\n', begin);
    const std::size_t last = text.find(last_word, begin);
    if (last == std::string::npos)
      return documents;
    const std::size_t end = last + last_word.size();
    documents.push_back(text.substr(begin, end - begin));
    begin = end;
  }
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
pictures(const std::string& size, const std::string& plot)
{
  std::string lines;
  for (const std::string terminal : {"svg", "pngcairo"})
    lines += "set terminal " + terminal + " noenhanced size " + size +
             " font 'sans,11' background rgb 'white'\nset output\n" + plot;
  return lines;
}

void
savePictures(const std::string& script,
             const std::vector<std::string>& names,
             const std::string& folder)
{
  const ProgramResult run = runChildProgram({"gnuplot"}, script);
  const auto documents = documentsOf(run.output, {svg_end, png_end});
  if (!run.is_good || documents.size() != 2 * names.size())
    throw io::FileError(
        folder, "gnuplot could not draw the plots" + firstComplaint(run.errors));
  io::OutputFolder files(folder);
  for (std::size_t i = 0; i < documents.size(); ++i)
    files.add(names[i / 2] + (i % 2 == 0 ? ".svg" : ".png"),
              [&](std::ostream& stream) { stream << documents[i]; });
  files.commit();
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
  std::vector<std::string> svgs = documentsOf(run.output, {svg_end});
  if (svgs.size() != drawings.size())
    throw GnuplotError("has not drawn all figures");
  return svgs;
}

} // namespace bayesian_icp::plot
