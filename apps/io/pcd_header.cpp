#include "io/pcd_header.h"

#include "io/errors.h"
#include "io/numbers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string_view>

namespace bayesian_icp::io {

namespace {

constexpr std::array<const char*, 10> keys = {"VERSION",
                                              "FIELDS",
                                              "SIZE",
                                              "TYPE",
                                              "COUNT",
                                              "WIDTH",
                                              "HEIGHT",
                                              "VIEWPOINT",
                                              "POINTS",
                                              "DATA"};

/** Reads the header's lines. PCL needs them in the order of the specification. */
class PcdHeaderReader {
public:
  explicit PcdHeaderReader(InputFile& file) : file_(file) { header_.num_points = none; }

  PcdHeader
  read()
  {
    while (header_.encoding.empty()) {
      if (!file_.readLine(line_))
        fail(last_key_ < 0 ? "has no PCD header" : "the header is cut off");
      const auto items = words(line_, pcd_separators);
      if (items.empty() && !line_.empty())
        fail("a line of the header is blank, but not empty");
      if (!items.empty() && items.front().front() != '#')
        take(items);
    }
    checkComplete();
    return std::move(header_);
  }

private:
  using Words = std::vector<std::string_view>;

  [[noreturn]] void
  fail(const std::string& reason) const
  {
    throw FileError(file_.name, reason);
  }

  [[noreturn]] void
  failInLine() const
  {
    fail("bad line in the header: " + inQuotes(line_));
  }

  void
  take(const Words& items)
  {
    const std::string_view name = items.front() == "COLUMNS" ? "FIELDS" : items.front();
    const auto found = std::find(keys.begin(), keys.end(), name);
    const int key = static_cast<int>(found - keys.begin());
    if (found == keys.end())
      fail(last_key_ < 0 ? "has no PCD header"
                         : "unknown line in the header: " + inQuotes(line_));
    if (key <= last_key_)
      fail(std::string("the header's line ") + *found + " is out of order");
    last_key_ = key;
    takeValues(*found, Words(items.begin() + 1, items.end()));
  }

  void
  takeValues(const std::string& key, const Words& values)
  {
    if (key == "VERSION")
      return;
    if (key == "VIEWPOINT")
      return checkViewpoint(values);
    if (key == "FIELDS")
      takeFields(values);
    else if (key == "SIZE" || key == "TYPE" || key == "COUNT")
      takeFieldProperty(key, values);
    else if (values.size() != 1)
      failInLine();
    else if (key == "DATA")
      takeEncoding(values.front());
    else
      takeNumber(key == "WIDTH"    ? width_
                 : key == "HEIGHT" ? height_
                                   : header_.num_points,
                 values.front());
  }

  void
  checkViewpoint(const Words& values) const
  {
    bool is_good = values.size() == 7;
    float number = 0.0F;
    for (const auto value : values)
      is_good &= readNumber(value, number) && std::isfinite(number);
    if (!is_good)
      failInLine();
  }

  void
  takeFields(const Words& names)
  {
    for (const auto name : names) {
      PcdField field;
      field.name = name;
      header_.fields.push_back(field);
    }
  }

  void
  takeFieldProperty(const std::string& key, const Words& values)
  {
    if (values.size() != header_.fields.size())
      fail("the header has " + std::to_string(header_.fields.size()) + " FIELDS, but " +
           std::to_string(values.size()) + " values in the line " + key);
    for (std::size_t i = 0; i < values.size(); ++i) {
      PcdField& field = header_.fields[i];
      if (key == "TYPE")
        field.type = values[i].size() == 1 ? values[i].front() : '?';
      else if (!readNumber(values[i], key == "SIZE" ? field.size : field.count))
        failInLine();
    }
  }

  void
  takeNumber(std::uint64_t& value, std::string_view text)
  {
    std::uint32_t number = 0;
    if (!readNumber(text, number) || number > std::numeric_limits<std::int32_t>::max())
      failInLine();
    value = number;
  }

  void
  takeEncoding(std::string_view encoding)
  {
    if (encoding != "ascii" && encoding != "binary" && encoding != "binary_compressed")
      fail("unknown encoding " + inQuotes(encoding));
    header_.encoding = encoding;
  }

  void
  checkComplete()
  {
    if (header_.fields.empty())
      fail("the header has no FIELDS");
    for (const PcdField& field : header_.fields)
      checkField(field);
    if (header_.num_points == none)
      fail("the header has no POINTS");
    if (header_.num_points == 0)
      fail("has no points");
    if (width_ != none && height_ != none && width_ * height_ != header_.num_points)
      fail("the header is inconsistent: WIDTH times HEIGHT is " +
           std::to_string(width_ * height_) + ", POINTS is " +
           std::to_string(header_.num_points));
    if ((width_ == none) != (height_ == none))
      fail("the header has WIDTH or HEIGHT, but not both");
  }

  void
  checkField(const PcdField& field) const
  {
    const std::uint32_t size = field.size;
    const bool is_integer = field.type == 'I' || field.type == 'U';
    const bool is_good =
        (is_integer && (size == 1 || size == 2)) ||
        ((is_integer || field.type == 'F') && (size == 4 || size == 8));
    if (!is_good || field.count == 0)
      fail("the header's field " + inQuotes(field.name) +
           " has a bad SIZE, TYPE or COUNT");
    if (field.name == "_" && header_.encoding == "binary_compressed")
      fail("padding fields ('_') in compressed data are not supported");
  }

  static constexpr std::uint64_t none = ~std::uint64_t(0);

  InputFile& file_;
  PcdHeader header_;
  std::uint64_t width_ = none;
  std::uint64_t height_ = none;
  int last_key_ = -1;
  std::string line_;
};

} // namespace

bool
beginsWithPcdKey(std::string_view word)
{
  const auto begins = [word](std::string_view key) { return word.rfind(key, 0) == 0; };
  return begins("COLUMNS") || std::any_of(keys.begin(), keys.end(), begins);
}

PcdHeader
readPcdHeader(InputFile& file)
{
  return PcdHeaderReader(file).read();
}

} // namespace bayesian_icp::io
