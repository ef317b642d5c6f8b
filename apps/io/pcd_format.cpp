#include "io/cloud_format.h"
#include "io/errors.h"
#include "io/numbers.h"
#include "io/pcd_header.h"

#include <cmath>
#include <string_view>
#include <vector>

namespace bayesian_icp::io {

namespace {

/** LZF makes at most 264 bytes out of 3. */
constexpr std::uint64_t max_lzf_expansion = 88;

/** Whether PCL, which reads lines of the header behind DATA as well, finds one at the
 * beginning of the points. Leaves the reading position where it was. */
bool
beginsLikeHeader(InputFile& file)
{
  const auto position = file.stream.tellg();
  std::string line;
  bool may_go_on = true;
  bool is_key = false;
  while (may_go_on) {
    may_go_on = file.readLine(line) || !line.empty();
    const auto items = words(line);
    const bool is_comment = !items.empty() && items.front().front() == '#';
    const bool is_cut = is_comment && line.size() == max_line_length;
    is_key = is_cut || (!items.empty() && beginsWithPcdKey(items.front()));
    may_go_on = may_go_on && !is_key && (line.empty() || is_comment);
  }
  file.stream.clear();
  file.stream.seekg(position);
  return is_key;
}

std::string
cutOff(const PcdHeader& header)
{
  return "is cut off, or its header is wrong: it says " +
         std::to_string(header.num_points) + " points, ";
}

/** Whether PCL can store the number in the field: what an integer cannot hold is
 * undefined there. */
bool
fits(double number, const PcdField& field)
{
  if (field.type == 'F')
    return true;
  const int num_bits = 8 * static_cast<int>(field.size);
  return field.type == 'U' ? number >= 0.0 && number < std::ldexp(1.0, num_bits)
                           : number >= -std::ldexp(1.0, num_bits - 1) &&
                                 number < std::ldexp(1.0, num_bits - 1);
}

/** \return what is wrong with a point, to be said after its number; empty if nothing is
 */
std::string
complaintAboutPoint(const std::vector<std::string_view>& values,
                    const PcdHeader& header)
{
  if (values.size() != header.numValues())
    return " has " + std::to_string(values.size()) + " values in place of " +
           std::to_string(header.numValues());
  auto value = values.begin();
  for (const PcdField& field : header.fields)
    for (std::uint32_t i = 0; i < field.count; ++i, ++value) {
      double number = 0.0;
      if (!readNumber(*value, number))
        return ": " + inQuotes(*value) + " is not a number";
      if (!fits(number, field))
        return ": " + inQuotes(*value) + " does not fit into the integer " +
               inQuotes(field.name);
    }
  return "";
}

/** \throws FileError unless the body has exactly the numbers that the header promises
 */
void
checkAsciiBody(InputFile& file, const PcdHeader& header)
{
  std::uint64_t num_found = 0;
  std::string line;
  while (file.readLine(line)) {
    const auto values = words(line, pcd_separators);
    if (values.empty())
      continue;
    if (++num_found > header.num_points)
      throw FileError(file.name,
                      "has more points than the " + std::to_string(header.num_points) +
                          " of its header");
    const std::string complaint = complaintAboutPoint(values, header);
    if (!complaint.empty())
      throw FileError(file.name, "point " + std::to_string(num_found) + complaint);
  }
  if (num_found < header.num_points)
    throw FileError(file.name,
                    cutOff(header) + "but there are " + std::to_string(num_found));
}

/** \throws FileError unless the compressed block is complete and of the promised size
 */
void
checkCompressedBody(InputFile& file, const PcdHeader& header)
{
  std::uint32_t sizes[2] = {0, 0}; // compressed, uncompressed
  const std::uint64_t num_left = file.numBytesLeft();
  if (num_left < sizeof(sizes) ||
      !file.stream.read(reinterpret_cast<char*>(sizes), sizeof(sizes)) ||
      sizes[0] > num_left - sizeof(sizes))
    throw FileError(file.name, "is cut off: the compressed points are not complete");
  const std::uint64_t size_of_point = header.numBytesPerPoint();
  if (sizes[1] / size_of_point != header.num_points || sizes[1] % size_of_point != 0 ||
      sizes[1] / max_lzf_expansion > sizes[0])
    throw FileError(file.name,
                    cutOff(header) + "which its compressed data cannot hold");
}

} // namespace

std::uint64_t
checkPcd(InputFile& file)
{
  const PcdHeader header = readPcdHeader(file);
  const std::uint64_t num_bytes_per_point = header.numBytesPerPoint();
  const std::uint64_t num_left = file.numBytesLeft();
  if (beginsLikeHeader(file))
    throw FileError(file.name, "the points begin like a line of the header");
  if (header.encoding == "ascii")
    checkAsciiBody(file, header);
  else if (header.encoding == "binary") {
    if (header.num_points > num_left / num_bytes_per_point)
      throw FileError(file.name,
                      cutOff(header) + "but there is room for " +
                          std::to_string(num_left / num_bytes_per_point));
  }
  else
    checkCompressedBody(file, header);
  return header.num_points;
}

} // namespace bayesian_icp::io
