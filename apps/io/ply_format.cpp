#include "io/cloud_format.h"
#include "io/errors.h"
#include "io/numbers.h"

#include <map>
#include <string_view>
#include <utility>
#include <vector>

namespace bayesian_icp::io {

namespace {

using Words = std::vector<std::string_view>;

/** A line `property`. */
struct PlyProperty {
  std::string name;
  /** Of the number or, in a list, of its length. */
  std::string type;
};

/** A kind of thing in the file, such as "vertex". */
struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;
  /** Least number of bytes in the binary formats: an empty list is but its length. */
  std::uint64_t min_bytes = 0;
  bool has_list = false;
};

/** What is in the file, in its order. */
struct PlyHeader {
  bool is_ascii = false;
  std::vector<PlyElement> elements;
  std::uint64_t num_points = 0;
};

/** Sizes of the scalar types [bytes]. */
const std::map<std::string_view, std::uint64_t> ply_type_sizes = {{"char", 1},
                                                                  {"int8", 1},
                                                                  {"uchar", 1},
                                                                  {"uint8", 1},
                                                                  {"short", 2},
                                                                  {"int16", 2},
                                                                  {"ushort", 2},
                                                                  {"uint16", 2},
                                                                  {"int", 4},
                                                                  {"int32", 4},
                                                                  {"uint", 4},
                                                                  {"uint32", 4},
                                                                  {"float", 4},
                                                                  {"float32", 4},
                                                                  {"double", 8},
                                                                  {"float64", 8}};

bool
isByte(const PlyProperty& property, const std::string& name)
{
  return property.name == name &&
         (property.type == "uchar" || property.type == "uint8");
}

/** PCL makes one number of a point's colours, and of other things than these if they do
 * not follow one another. */
bool
areColoursInOrder(const std::vector<PlyProperty>& properties)
{
  bool has_colours = false;
  for (std::size_t i = 0; i < properties.size(); ++i) {
    if (isByte(properties[i], "alpha") && !has_colours)
      return false;
    for (const std::string prefix : {"", "diffuse_"}) {
      if (isByte(properties[i], prefix + "green") ||
          isByte(properties[i], prefix + "blue"))
        return false;
      if (!isByte(properties[i], prefix + "red"))
        continue;
      if (i + 2 >= properties.size() || !isByte(properties[i + 1], prefix + "green") ||
          !isByte(properties[i + 2], prefix + "blue"))
        return false;
      has_colours = true;
      i += 2;
    }
  }
  return true;
}

/** Elements and properties in all; PCL compares each with every other. */
constexpr int max_num_definitions = 1000;

/** Reads the header of a file that PCL reads as it is meant, leaving it at the first
 * byte of the points. */
class PlyHeaderReader {
public:
  explicit PlyHeaderReader(InputFile& file) : file_(file) {}

  /** \throws FileError if it is not a complete, consistent PLY header */
  PlyHeader
  read()
  {
    if (!file_.readLine(line_) || words(line_) != Words{"ply"})
      fail("has no PLY header");
    bool is_in_header = true;
    while (is_in_header) {
      if (!file_.readLine(line_))
        fail("the header is cut off");
      const Words items = words(line_);
      if (items == Words{"end_header"})
        is_in_header = false;
      else if (!items.empty() && items[0] != "comment")
        take(items);
    }
    if (!has_format_)
      fail("the header has no format");
    checkPoints();
    return std::move(header_);
  }

private:
  [[noreturn]] void
  fail(const std::string& reason) const
  {
    throw FileError(file_.name, reason);
  }

  void
  take(const Words& items)
  {
    bool is_good = false;
    if (items[0] == "format" && items.size() == 3)
      is_good = takeFormat(items[1]);
    else if (items[0] == "element" && items.size() == 3)
      is_good = takeElement(items[1], items[2]);
    else if (items[0] == "property" && !header_.elements.empty())
      is_good = takeProperty(items);
    else if (items[0] == "obj_info" && items[0].data() == line_.data())
      is_good = takeInfo(items);
    if (!is_good)
      fail("bad line in the header: " + inQuotes(line_));
    if (items[0] != "obj_info" && ++num_definitions_ > max_num_definitions)
      fail("has more than " + std::to_string(max_num_definitions) + " properties");
  }

  bool
  takeFormat(std::string_view format)
  {
    header_.is_ascii = format == "ascii";
    const bool is_good = header_.is_ascii || format == "binary_little_endian" ||
                         format == "binary_big_endian";
    return is_good && !std::exchange(has_format_, true);
  }

  bool
  takeElement(std::string_view name, std::string_view count)
  {
    PlyElement element;
    element.name = name;
    if (!readCount(count, element.count))
      return false;
    if (name == "vertex" && num_columns_ * num_rows_ == 0) {
      num_columns_ = element.count;
      num_rows_ = 1;
    }
    header_.elements.push_back(std::move(element));
    return true;
  }

  bool
  takeProperty(const Words& items)
  {
    PlyElement& element = header_.elements.back();
    const bool is_list = items.size() == 5 && items[1] == "list";
    const std::size_t type = is_list ? 2 : 1;
    if ((!is_list && items.size() != 3) || ply_type_sizes.count(items[type]) == 0 ||
        (is_list && ply_type_sizes.count(items[3]) == 0))
      return false;
    for (const PlyProperty& other : element.properties)
      if (other.name == items.back())
        fail("two properties are called " + inQuotes(items.back()));
    element.min_bytes += ply_type_sizes.at(items[type]);
    element.has_list |= is_list;
    element.properties.push_back({std::string(items.back()), std::string(items[type])});
    return true;
  }

  /** The width and height of the cloud, which PCL believes. */
  bool
  takeInfo(const Words& items)
  {
    if (items.size() < 2 || (items[1] != "num_cols" && items[1] != "num_rows"))
      return true;
    std::uint64_t& number = items[1] == "num_cols" ? num_columns_ : num_rows_;
    return items.size() == 3 && readCount(items[2], number);
  }

  static bool
  readCount(std::string_view text, std::uint64_t& count)
  {
    std::int32_t number = -1;
    if (!readNumber(text, number) || number < 0)
      return false;
    count = static_cast<std::uint64_t>(number);
    return true;
  }

  void
  checkPoints()
  {
    for (const PlyElement& element : header_.elements) {
      if (element.count > 0 && element.properties.empty())
        fail("an element " + inQuotes(element.name) + " has no properties");
      if (element.name != "vertex")
        continue;
      if (header_.num_points > 0)
        fail("has more than one element 'vertex'");
      header_.num_points = element.count;
      checkVertices(element);
    }
    if (header_.num_points == 0)
      fail("has no points");
    if (num_columns_ * num_rows_ != header_.num_points)
      fail("the header is inconsistent: num_cols times num_rows is " +
           std::to_string(num_columns_ * num_rows_) + ", the number of points is " +
           std::to_string(header_.num_points));
    for (const PlyElement& element : header_.elements)
      if (element.name == "range_grid" && element.count != header_.num_points)
        fail("a range grid with gaps is not supported");
  }

  void
  checkVertices(const PlyElement& vertices) const
  {
    if (vertices.has_list)
      fail("lists in the element 'vertex' are not supported");
    if (!areColoursInOrder(vertices.properties))
      fail(
          "the colours of the points are not red, green, blue and alpha in this order");
  }

  InputFile& file_;
  PlyHeader header_;
  /** As PCL works them out. */
  std::uint64_t num_columns_ = 0;
  std::uint64_t num_rows_ = 0;
  int num_definitions_ = 0;
  bool has_format_ = false;
  std::string line_;
};

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
  const PlyHeader header = PlyHeaderReader(file).read();
  if (header.is_ascii)
    checkAsciiBody(file, header);
  else
    checkBinaryBody(file, header);
  return header.num_points;
}

} // namespace bayesian_icp::io
