#include "io/cloud_format.h"
#include "io/errors.h"
#include "io/numbers.h"
#include "io/pcd_header.h"

namespace bayesian_icp::io {

namespace {

/** LZF makes at most 264 bytes out of 3. */
constexpr std::uint64_t max_lzf_expansion = 88;

std::string
cutOff(const PcdHeader& header)
{
  return "is cut off, or its header is wrong: it says " +
         std::to_string(header.num_points) + " points, ";
}

/** \throws FileError unless the body has exactly the numbers that the header promises
 */
void
checkAsciiBody(InputFile& file, const PcdHeader& header)
{
  std::uint64_t num_found = 0;
  std::string line;
  while (file.readLine(line)) {
    const auto values = words(line);
    if (values.empty())
      continue;
    const std::string place = "point " + std::to_string(++num_found);
    if (num_found > header.num_points)
      throw FileError(file.name,
                      "has more points than the " + std::to_string(header.num_points) +
                          " of its header");
    if (values.size() != header.numValues())
      throw FileError(file.name,
                      place + " has " + std::to_string(values.size()) +
                          " values in place of " + std::to_string(header.numValues()));
    double number;
    for (const auto value : values)
      if (!readNumber(value, number))
        throw FileError(file.name, place + ": " + quoted(value) + " is not a number");
  }
  if (num_found < header.num_points)
    throw FileError(file.name,
                    cutOff(header) + "but there are " + std::to_string(num_found));
}

/** \throws FileError unless the compressed block is complete and of the promised size
 */
void
checkCompressedBody(InputFile& file, const PcdHeader& header, std::uint64_t num_bytes)
{
  std::uint32_t sizes[2] = {0, 0}; // compressed, uncompressed
  const std::uint64_t num_left = file.numBytesLeft();
  if (num_left < sizeof(sizes) ||
      !file.stream.read(reinterpret_cast<char*>(sizes), sizeof(sizes)) ||
      sizes[0] > num_left - sizeof(sizes))
    throw FileError(file.name, "is cut off: the compressed points are not complete");
  if (sizes[1] != num_bytes || sizes[1] / max_lzf_expansion > sizes[0])
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
  if (header.encoding == "ascii")
    checkAsciiBody(file, header);
  else if (header.encoding == "binary") {
    if (header.num_points > num_left / num_bytes_per_point)
      throw FileError(file.name,
                      cutOff(header) + "but there is room for " +
                          std::to_string(num_left / num_bytes_per_point));
  }
  else
    checkCompressedBody(file, header, header.num_points * num_bytes_per_point);
  return header.num_points;
}

} // namespace bayesian_icp::io
