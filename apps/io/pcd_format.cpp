#include "io/cloud_format.h"
#include "io/errors.h"
#include "io/numbers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <string_view>
#include <vector>

namespace bayesian_icp::io {

namespace {

using Words = std::vector<std::string_view>;

/** What separates the words of a line, for PCL. */
constexpr const char* separators = " \t\r";

/** First words of the header's lines, in the order in which PCL needs them. */
constexpr std::array<std::string_view, 10> keys = {"VERSION",
                                                   "FIELDS",
                                                   "SIZE",
                                                   "TYPE",
                                                   "COUNT",
                                                   "WIDTH",
                                                   "HEIGHT",
                                                   "VIEWPOINT",
                                                   "POINTS",
                                                   "DATA"};

/** LZF makes at most 264 bytes out of 3. */
constexpr std::uint64_t max_lzf_expansion = 88;

/** One field of every point, as in the lines FIELDS, SIZE, TYPE and COUNT. */
struct PcdField {
  std::string name;
  std::uint32_t size = 0;
  char type = 0;
  std::uint32_t count = 1;
};

/** What the points are and how they are stored. */
struct PcdHeader {
  std::vector<PcdField> fields;
  std::uint64_t num_points = 0;
  /** "ascii", "binary" or "binary_compressed". */
  std::string encoding;

  /** Numbers a point has, padding included. */
  std::uint64_t
  numValues() const
  {
    std::uint64_t sum = 0;
    for (const PcdField& field : fields)
      sum += field.count;
    return sum;
  }

  /** Size of a point in the binary encodings. */
  std::uint64_t
  numBytesPerPoint() const
  {
    std::uint64_t sum = 0;
    for (const PcdField& field : fields)
      sum += std::uint64_t(field.size) * field.count;
    return sum;
  }
};

/** The lines of a header by their first words. */
class PcdLines {
public:
  /** Reads \p file up to the first byte of the points.
   * \throws FileError if the lines are not those of a header */
  explicit PcdLines(InputFile& file) : file_name_(file.name)
  {
    auto next = keys.begin(); // The first that may still come.
    std::string line;
    while (!has("DATA")) {
      if (!file.readLine(line))
        fail(lines_.empty() ? "has no PCD header" : "the header is cut off");
      const Words items = words(line, separators);
      if (items.empty() && !line.empty())
        fail("a line of the header is blank, but not empty");
      if (items.empty() || items.front().front() == '#')
        continue;
      const auto key = std::find(
          keys.begin(), keys.end(), items[0] == "COLUMNS" ? "FIELDS" : items[0]);
      if (key == keys.end())
        fail(lines_.empty() ? "has no PCD header"
                            : "unknown line in the header: " + inQuotes(line));
      if (key < next)
        fail("the header's line " + std::string(*key) + " is out of order");
      next = key + 1;
      lines_[*key] = line;
    }
  }

  bool
  has(std::string_view key) const
  {
    return lines_.count(key) > 0;
  }

  /** What is behind the first word; nothing if there is no such line. */
  Words
  values(std::string_view key) const
  {
    if (!has(key))
      return {};
    const Words items = words(lines_.at(key), separators);
    return {items.begin() + 1, items.end()};
  }

  /** The one value of a line that is there. */
  std::string_view
  value(std::string_view key) const
  {
    if (values(key).size() != 1)
      failInLine(key);
    return values(key).front();
  }

  /** A number of points; nothing if there is no such line. */
  std::optional<std::uint64_t>
  count(std::string_view key) const
  {
    if (!has(key))
      return std::nullopt;
    std::int32_t number = -1;
    if (!readNumber(value(key), number) || number < 0)
      failInLine(key);
    return static_cast<std::uint64_t>(number);
  }

  [[noreturn]] void
  fail(const std::string& reason) const
  {
    throw FileError(file_name_, reason);
  }

  [[noreturn]] void
  failInLine(std::string_view key) const
  {
    fail("bad line in the header: " + inQuotes(lines_.at(key)));
  }

private:
  const std::string& file_name_;
  std::map<std::string_view, std::string> lines_;
};

void
checkViewpoint(const PcdLines& lines)
{
  const Words values = lines.values("VIEWPOINT");
  bool is_good = values.size() == 7;
  float number = 0.0F;
  for (const auto value : values)
    is_good &= readNumber(value, number) && std::isfinite(number);
  if (lines.has("VIEWPOINT") && !is_good)
    lines.failInLine("VIEWPOINT");
}

/** Takes one of the lines that have a value for each field. */
void
takeFieldValues(const PcdLines& lines,
                const std::string& key,
                std::vector<PcdField>& fields)
{
  const Words values = lines.values(key);
  if (!lines.has(key))
    return;
  if (values.size() != fields.size())
    lines.fail("the header has " + std::to_string(fields.size()) + " FIELDS, but " +
               std::to_string(values.size()) + " values in the line " + key);
  for (std::size_t i = 0; i < values.size(); ++i)
    if (key == "TYPE")
      fields[i].type = values[i].size() == 1 ? values[i].front() : '?';
    else if (!readNumber(values[i], key == "SIZE" ? fields[i].size : fields[i].count))
      lines.failInLine(key);
}

/** Whether PCL knows fields of this kind. */
bool
isKnown(const PcdField& field)
{
  const bool is_integer = field.type == 'I' || field.type == 'U';
  const bool is_small = field.size == 1 || field.size == 2;
  const bool is_large = field.size == 4 || field.size == 8;
  return field.count > 0 &&
         ((is_integer && is_small) || ((is_integer || field.type == 'F') && is_large));
}

void
checkSizeOfCloud(const PcdLines& lines)
{
  const auto num_points = lines.count("POINTS");
  const auto width = lines.count("WIDTH");
  const auto height = lines.count("HEIGHT");
  if (!num_points)
    lines.fail("the header has no POINTS");
  if (*num_points == 0)
    lines.fail("has no points");
  if (width.has_value() != height.has_value())
    lines.fail("the header has WIDTH or HEIGHT, but not both");
  if (width && *width * *height != *num_points)
    lines.fail("the header is inconsistent: WIDTH times HEIGHT is " +
               std::to_string(*width * *height) + ", POINTS is " +
               std::to_string(*num_points));
}

/** Reads the header, leaving \p file at the first byte of the points.
 * \throws FileError if it is not a complete, consistent PCD header */
PcdHeader
readHeader(InputFile& file)
{
  const PcdLines lines(file);
  PcdHeader header;
  header.encoding = lines.value("DATA");
  if (header.encoding != "ascii" && header.encoding != "binary" &&
      header.encoding != "binary_compressed")
    lines.fail("unknown encoding " + inQuotes(header.encoding));
  for (const auto name : lines.values("FIELDS"))
    header.fields.push_back({std::string(name)});
  if (header.fields.empty())
    lines.fail("the header has no FIELDS");
  for (const char* key : {"SIZE", "TYPE", "COUNT"})
    takeFieldValues(lines, key, header.fields);
  for (const PcdField& field : header.fields) {
    if (!isKnown(field))
      lines.fail("the header's field " + inQuotes(field.name) +
                 " has a bad SIZE, TYPE or COUNT");
    if (field.name == "_" && header.encoding == "binary_compressed")
      lines.fail("padding fields ('_') in compressed data are not supported");
  }
  checkViewpoint(lines);
  checkSizeOfCloud(lines);
  header.num_points = *lines.count("POINTS");
  return header;
}

bool
beginsWithKey(std::string_view word)
{
  const auto begins = [word](std::string_view key) { return word.rfind(key, 0) == 0; };
  return begins("COLUMNS") || std::any_of(keys.begin(), keys.end(), begins);
}

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
    is_key = is_cut || (!items.empty() && beginsWithKey(items.front()));
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
complaintAboutPoint(const Words& values, const PcdHeader& header)
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
    const auto values = words(line, separators);
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
  const PcdHeader header = readHeader(file);
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
