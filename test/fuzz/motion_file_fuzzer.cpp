/** \file
 * \brief Fuzzes motions: poses on the command line, files with a 4x4 matrix, those of
 * data sets, and files of lines.
 */
#include "fuzz_input.h"
#include "io/line_file.h"
#include "io/motion.h"

#include <vector>

namespace {

using namespace bayesian_icp;

std::vector<std::string>
readLines(const std::string& file)
{
  std::vector<std::string> lines;
  const io::LineFile file_of_lines(file, [&lines](const std::string& line) {
    lines.push_back(line);
    return true;
  });
  return lines;
}

void
readAsMotion(const std::string& text)
{
  fuzz::isAccepted([&] {
    const Eigen::Matrix4d motion = io::readMotion("guess", text);
    fuzz::require(!motion.allFinite() || io::complaintAboutMotion(motion).empty(),
                  "motions of finite numbers are rigid");
  });
}

} // namespace

extern "C" int
LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
  const std::string bytes(fuzz::textOf(data, size));
  const std::string file = fuzz::writeInput("motion.txt", bytes);
  readAsMotion(bytes);
  fuzz::isAccepted([&] {
    const Eigen::Matrix4d motion = io::readMatrixFile(file);
    fuzz::require(io::complaintAboutMotion(motion).empty(), "motions are rigid");
  });
  std::vector<std::string> lines;
  if (fuzz::isAccepted([&] { lines = readLines(file); }))
    fuzz::require(readLines(file) == lines, "cutting a file ends");
  return 0;
}
