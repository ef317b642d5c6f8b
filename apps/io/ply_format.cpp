#include "io/cloud_format.h"
#include "io/errors.h"
#include "io/numbers.h"
#include "io/ply_header.h"

#include <string_view>

namespace bayesian_icp::io {

namespace {

using Words = std::vector<std::string_view>;

/** A line of an ASCII body: a point has exactly its numbers, anything else at least
 * one. */
void
checkAsciiLine(const InputFile& file, const PlyElement& element, const Words& values)
{
  double number;
  for (const auto value : values)
    if (!readNumber(value, number))
      throw FileError(file.name, inQuotes(value) + " is not a number");
  if (!element.has_list && values.size() != element.properties.size())
    throw FileError(file.name,
                    "an element " + inQuotes(element.name) + " has " +
                        std::to_string(values.size()) + " values in place of " +
                        std::to_string(element.properties.size()));
}

void
checkAsciiBody(InputFile& file, const PlyHeader& header)
{
  std::string line;
  for (const PlyElement& element : header.elements) {
    for (std::uint64_t i = 0; i < element.count; ++i) {
      do {
        if (!file.readLine(line))
          throw FileError(file.name,
                          "is cut off: its header says " +
                              std::to_string(element.count) + " elements '" +
                              element.name + "', but there are " + std::to_string(i));
      }
      while (words(line).empty());
      checkAsciiLine(file, element, words(line));
    }
  }
}

void
checkBinaryBody(InputFile& file, const PlyHeader& header)
{
  std::uint64_t num_left = file.numBytesLeft();
  for (const PlyElement& element : header.elements) {
    if (element.count > 0 && element.count > num_left / element.min_bytes)
      throw FileError(file.name,
                      "is cut off, or its header is wrong: it says " +
                          std::to_string(element.count) + " elements " +
                          inQuotes(element.name) + ", but there is room for " +
                          std::to_string(num_left / element.min_bytes));
    num_left -= element.count * element.min_bytes;
  }
}

} // namespace

std::uint64_t
checkPly(InputFile& file)
{
  const PlyHeader header = readPlyHeader(file);
  if (header.is_ascii)
    checkAsciiBody(file, header);
  else
    checkBinaryBody(file, header);
  return header.num_points;
}

} // namespace bayesian_icp::io
