#include "io/cloud_format.h"
#include "io/errors.h"
#include "io/numbers.h"

#include <limits>
#include <map>
#include <string_view>
#include <utility>

namespace bayesian_icp::io {

namespace {

using Words = std::vector<std::string_view>;

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

/** A kind of thing in the file, such as "vertex". */
struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::uint64_t num_properties = 0;
  /** Least number of bytes in the binary formats: an empty list is but its length. */
  std::uint64_t min_bytes = 0;
  bool has_list = false;
};

struct PlyHeader {
  bool is_ascii = false;
  std::vector<PlyElement> elements;
};

class PlyHeaderReader {
public:
  explicit PlyHeaderReader(InputFile& file) : file_(file) {}

  PlyHeader
  read()
  {
    if (!file_.readLine(line_) || words(line_) != Words{"ply"})
      throw FileError(file_.name, "has no PLY header");
    bool is_in_header = true;
    while (is_in_header) {
      if (!file_.readLine(line_))
        throw FileError(file_.name, "the header is cut off");
      const Words items = words(line_);
      if (items == Words{"end_header"})
        is_in_header = false;
      else if (!items.empty() && items[0] != "comment" && items[0] != "obj_info")
        take(items);
    }
    if (!has_format_)
      throw FileError(file_.name, "the header has no format");
    return std::move(header_);
  }

private:
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
    if (!is_good)
      throw FileError(file_.name, "bad line in the header: " + quoted(line_));
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
    header_.elements.push_back(element);
    std::int32_t number = -1;
    const bool is_good = readNumber(count, number) && number >= 0;
    header_.elements.back().count = static_cast<std::uint64_t>(number);
    return is_good;
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
    element.min_bytes += ply_type_sizes.at(items[type]);
    element.has_list |= is_list;
    ++element.num_properties;
    return true;
  }

  InputFile& file_;
  PlyHeader header_;
  bool has_format_ = false;
  std::string line_;
};

const PlyElement&
verticesOf(const PlyHeader& header, const InputFile& file)
{
  const PlyElement* vertices = nullptr;
  for (const PlyElement& element : header.elements) {
    if (element.name != "vertex")
      continue;
    if (vertices != nullptr)
      throw FileError(file.name, "has more than one element 'vertex'");
    vertices = &element;
  }
  if (vertices == nullptr || vertices->count == 0)
    throw FileError(file.name, "has no points");
  if (vertices->has_list)
    throw FileError(file.name, "lists in the element 'vertex' are not supported");
  return *vertices;
}

/** A line of an ASCII body: a point has exactly its numbers, anything else at least
 * one. */
void
checkAsciiLine(const InputFile& file, const PlyElement& element, const Words& values)
{
  double number;
  for (const auto value : values)
    if (!readNumber(value, number))
      throw FileError(file.name, quoted(value) + " is not a number");
  if (!element.has_list && values.size() != element.num_properties)
    throw FileError(file.name,
                    "an element " + quoted(element.name) + " has " +
                        std::to_string(values.size()) + " values in place of " +
                        std::to_string(element.num_properties));
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
    if (element.min_bytes > 0 && element.count > num_left / element.min_bytes)
      throw FileError(file.name,
                      "is cut off, or its header is wrong: it says " +
                          std::to_string(element.count) + " elements " +
                          quoted(element.name) + ", but there is room for " +
                          std::to_string(num_left / element.min_bytes));
    num_left -= element.count * element.min_bytes;
  }
}

} // namespace

std::uint64_t
checkPly(InputFile& file)
{
  const PlyHeader header = PlyHeaderReader(file).read();
  const std::uint64_t num_points = verticesOf(header, file).count;
  if (header.is_ascii)
    checkAsciiBody(file, header);
  else
    checkBinaryBody(file, header);
  return num_points;
}

} // namespace bayesian_icp::io
